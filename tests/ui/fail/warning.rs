//! Warnings of the table are warnings, which can be errors, and can be turned off.

#![deny(deprecated)]

use dh_runtime::dh_robot;

#[dh_robot("warning.toml")]
struct Arm;

#[dh_robot("warning.toml", warnings = "off")]
struct Quiet;

fn main() {
    println!("{:?} {:?}", Arm.fk(&[0.0; 2]), Quiet.fk(&[0.0; 2]));
}
