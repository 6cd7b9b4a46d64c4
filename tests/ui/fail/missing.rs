//! A table that is not there, and a shipped one that is not shipped.

use dh_runtime::dh_robot;

#[dh_robot("mycobt.toml")]
struct Lost;

#[dh_robot("mycobto")]
struct Unknown;

fn main() {
    let pose = Lost.fk(&[0.0; 6]);
    let tip = Unknown.fk(&[0.0; 6]).translation.vector - pose.translation.vector;
    println!("{tip} {}", Lost.jacobian(&[0.0; 6]));
}
