//! Test equipment that more than one test uses: an oracle that shares nothing with the compiler, a generator of random
//! tables, nearly special ones (`near/`), and the worked examples of `cases/`.
//!
//! Nothing here but [`engine`] may name the compiler; a test (`layering`) sees to it. What agrees with the oracle then agrees with the
//! format as its reference describes it, and not with our own reading of it twice.

pub mod cases;
pub mod chain;
pub mod double_double;
pub mod engine;
pub mod expression;
pub mod matrix;
pub mod near;
pub mod oracle;
pub mod random;

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;
