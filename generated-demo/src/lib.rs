//! What the compiler prints for shipped tables of every class of arm, committed to be read.
//!
//! Each module is the output of `dhc generate NAME --lang rust`, byte for byte; a test (`snapshots` in `tests/`) sees to
//! that, and under test every warning is an error here. The programs in `src/bin` use the macro, which compiles the
//! same tables anew.

#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(test, deny(warnings, missing_docs, clippy::pedantic))]

/// The arm of `robots/crane_x7.toml`.
#[rustfmt::skip]
pub mod crane_x7;
/// The arm of `robots/crane_x7_2r.toml`.
#[rustfmt::skip]
pub mod crane_x7_2r;
/// The arm of `robots/crx10ia_l.toml`.
#[rustfmt::skip]
pub mod crx10ia_l;
/// The arm of `robots/elbow3r.toml`.
#[rustfmt::skip]
pub mod elbow3r;
/// The arm of `robots/manocha_canny.toml`.
#[rustfmt::skip]
pub mod manocha_canny;
/// The arm of `robots/mycobot.toml`.
#[rustfmt::skip]
pub mod mycobot;
/// The arm of `robots/panda.toml`.
#[rustfmt::skip]
pub mod panda;
/// The arm of `robots/planar2r.toml`.
#[rustfmt::skip]
pub mod planar2r;
/// The arm of `robots/puma560.toml`.
#[rustfmt::skip]
pub mod puma560;
/// The arm of `robots/rtm2r.toml`.
#[rustfmt::skip]
pub mod rtm2r;
/// The arm of `robots/scara.toml`.
#[rustfmt::skip]
pub mod scara;
/// The arm of `robots/stanford.toml`.
#[rustfmt::skip]
pub mod stanford;
/// The arm of `robots/uarm_swift_pro.toml`.
#[rustfmt::skip]
pub mod uarm_swift_pro;
/// The arm of `robots/ur5.toml`.
#[rustfmt::skip]
pub mod ur5;
/// The arm of `robots/ur5e.toml`.
#[rustfmt::skip]
pub mod ur5e;
/// The arm of `robots/vs068.toml`.
#[rustfmt::skip]
pub mod vs068;
