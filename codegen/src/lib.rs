//! The compiler from Denavit-Hartenberg tables to kinematics code.
//!
//! Modules in the order in which the data flows.

/// Codes, messages and labelled spans; the one renderer of them.
pub mod diagnostic;
/// Stage 1: text -> rows as written, every value with its span. Knows TOML, no geometry.
pub mod table;
/// Stage 2: rows -> a checked robot in SI units.
pub mod model;
/// Stage 3: model -> equations.
pub mod symbolic;
/// Stage 4: equations -> functions as ordered, named scalar steps, and the interpreter of these.
pub mod plan;
/// Every function of a plan against plain products of the table's matrices.
pub mod verify;
/// Stage 5: printers.
pub mod emit;
