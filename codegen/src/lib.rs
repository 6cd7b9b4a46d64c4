//! The compiler from Denavit-Hartenberg tables to kinematics code.
//!
//! Modules in the order in which the data flows.

// Codes, messages and labelled spans; the one renderer of them.
pub mod diagnostic;
// 1: text -> rows as written, every value with its span. Knows TOML, no geometry.
pub mod table;
// 2: rows -> a checked robot in SI units.
pub mod model;
