//! The compiler from Denavit-Hartenberg tables to kinematics code.
//!
//! Modules in the order in which the data flows.

/// Stage 2: rows -> a checked robot in SI units.
pub mod model;
/// Stage 3: model -> equations.
pub mod symbolic;
/// Stage 4: equations -> functions as ordered, named scalar steps.
pub mod plan;
