//! Names of the table are text, whatever stands in them; names of the user's are left alone.
#![deny(warnings, missing_docs)]
#![allow(dead_code, reason = "what is here has but to have a name")]
#![allow(clippy::unwrap_used, reason = "a test")]

use dh_runtime::dh_robot;

/// Has the name of a type that the generated code uses.
#[dh_robot("names.toml")]
struct Frame;

/// Has the name of a constant of the table.
#[dh_robot("names.toml")]
struct A2;

// None of these may meet what is generated.
struct Joint;
struct Solutions;
type Result = ();
type Option = ();
const REACH: () = ();
fn forward_kinematics() {}
fn solve_type() {}

#[test]
fn names_do_not_meet() {
    assert_eq!(Frame::NAME, "*/ \"Arm\" \\ {x} | `y` [z] <b>");
    assert_eq!(Frame::JOINTS.map(|joint| joint.name), ["t1", "\"q\" | \\", "関節"]);
    assert_eq!(A2.fk(&[0.0; 3]), Frame.fk(&[0.0; 3]));
    for solution in &A2.ik_all_type(&dh_runtime::Point2::new(0.6, 0.1)).unwrap() {
        let tool = A2.fk(&solution.q).translation;
        assert!((tool.x - 0.6).abs() < 1e-12 && (tool.y - 0.1).abs() < 1e-12);
    }
}
