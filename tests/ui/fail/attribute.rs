//! Mistakes in the attribute itself, and things that it cannot stand on.

use dh_runtime::dh_robot;

#[dh_robot]
struct NoTable;

#[dh_robot(mycobot)]
struct NoString;

#[dh_robot("scara", scalar = "f16", precision = "high", warnings)]
struct Options;

#[dh_robot("scara")]
enum Arm {
    Left,
}

fn main() {
    println!("{:?}", Options.fk(&[0.0; 4]));
    let _ = (NoTable, NoString, Arm::Left);
}
