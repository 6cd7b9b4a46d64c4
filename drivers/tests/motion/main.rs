//! Motion, from goals to a device in memory.

#![expect(clippy::unwrap_used, reason = "tests")]

mod checked;
mod devices;
mod memory;
mod mounted;
mod pose;
mod profile;
mod robot;

use dh_runtime::dh_robot;

#[dh_robot("mycobot")]
struct MyCobot;

#[dh_robot("planar2r")]
struct Planar;

#[dh_robot("crane_x7")]
struct CraneX7;

#[dh_robot("crane_x7_2r")]
struct Crane;

#[dh_robot("cell.toml", warnings = "off")] // about a servo that is meant to leave less
struct Cell;

/// The same, with joints that accelerate at once.
#[dh_robot("sudden.toml", warnings = "off")]
struct Sudden;
