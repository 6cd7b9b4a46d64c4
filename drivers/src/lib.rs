//! Devices that move robots: ports, protocols, drivers, simulated devices, motion.
//!
//! A table says which servos an arm has; any [`Kinematics`](dh_runtime::Kinematics) of it and a [`Driver`] move it.
//! Values are radians, metres, seconds, amperes and degrees Celsius everywhere but inside a driver, which converts at
//! its edge by the table's servo map.
//!
//! Each module names only those above it, but that a driver takes [`Command`]s, which motion alone can make:
//!
//! | module | what |
//! | --- | --- |
//! | [`clock`] | time, real or virtual |
//! | [`port`] | bytes to and from a device, each with a deadline |
//! | [`driver`] | what motion knows of a device: [`Driver`], its joints, state and errors |
//! | [`simulate`] | devices that are not there: their line, the dynamics of their motors, faults |
//! | [`unit`] | what one arm out of many has of its own: zeros and signs of its servos |
//! | [`motion`] | checks, profiles and moves |
//!
//! Nothing here panics, waits without a deadline, or spins while it waits.
#![forbid(unsafe_code)]

pub mod clock;
pub mod connect;
pub mod driver;
pub mod dynamixel;
pub mod motion;
pub mod mycobot;
pub mod port;
pub mod simulate;
pub mod unit;
mod wheels;
mod workspace_edge;

pub use driver::{Driver, DriverError};
pub use motion::Command;
pub use wheels::wheel_speeds;
pub use workspace_edge::workspace_edge;
