//! Stage 5: printers of a plan. They decide nothing: what is computed, in which order and under which names, stands in
//! the plan.
//!
//! To add a language: a module here with one entry, `print(&Model, &Plan, &Options) -> String`, that walks
//! [`plan::Step`](crate::plan::Step) and [`plan::Scalar`](crate::plan::Scalar), prints every operation where the tree
//! has it (or the results are no longer those of the interpreter), and leaves out what no output needs.

/// Rust: a file for `dhc generate` and build scripts, or items for a struct that carries the attribute.
pub mod rust;
/// Plain text: the equations as a textbook writes them.
pub mod text;
