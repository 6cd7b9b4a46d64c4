//! A table that is not TOML.

use dh_runtime::dh_robot;

#[dh_robot("broken.toml")]
struct Arm;

fn main() {
    println!("{:?}", Arm.fk(&[0.0]));
}
