//! What code generated from Denavit-Hartenberg tables needs, and what its users import: traits, solution sets, errors,
//! numeric kernels.
//!
//! Lengths are metres and angles radians everywhere. No heap, no panic, no standard library.
//!
//! Features, both on by default: `macro` re-exports the attribute macro, `nalgebra` gives poses and Jacobians
//! nalgebra's types.
#![no_std]
#![forbid(unsafe_code)]

pub use dh_core::*;
#[cfg(feature = "macro")]
pub use dh_macro::dh_robot;
#[cfg(feature = "nalgebra")]
pub use nalgebra;
#[cfg(feature = "nalgebra")]
pub use nalgebra::{Point2, Point3, Rotation3, UnitVector3};
