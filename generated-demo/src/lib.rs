//! What the compiler prints for every shipped table, committed to be read.
//!
//! Each module is the output of `dhc generate NAME --lang rust`, byte for byte; a test (`snapshots` in `tests/`) sees to
//! that, and under test every warning is an error here. The programs in `src/bin` use the macro, which compiles the
//! same tables anew.

#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(test, deny(warnings, missing_docs, clippy::pedantic))]

/// RT Corporation CRANE-X7.
#[rustfmt::skip]
pub mod crane_x7;
/// RT Corporation CRANE-X7 planar.
#[rustfmt::skip]
pub mod crane_x7_2r;
/// Elbow 3R.
#[rustfmt::skip]
pub mod elbow3r;
/// Elephant Robotics myCobot 280 Pi.
#[rustfmt::skip]
pub mod mycobot;
/// Franka Emika Panda.
#[rustfmt::skip]
pub mod panda;
/// Planar 2R.
#[rustfmt::skip]
pub mod planar2r;
/// Unimation Puma 560.
#[rustfmt::skip]
pub mod puma560;
/// RT-middleware 2R.
#[rustfmt::skip]
pub mod rtm2r;
/// Adept Cobra 600.
#[rustfmt::skip]
pub mod scara;
/// UFACTORY uArm Swift Pro.
#[rustfmt::skip]
pub mod uarm_swift_pro;
/// Universal Robots UR5.
#[rustfmt::skip]
pub mod ur5;
/// Universal Robots UR5e.
#[rustfmt::skip]
pub mod ur5e;
/// DENSO VS-068.
#[rustfmt::skip]
pub mod vs068;
