//! The worked examples of `cases/`, each number, through the compiler.

#![expect(clippy::unwrap_used, reason = "a broken case is a broken test")]

use dh_core::{Axis, FULL_POSE, Frame, IkError, Kinematics, Rule, SolutionSet, Target, Violation};
use dh_tests::cases::{self, elements, numbers, radians};
use dh_tests::engine;
use serde_json::Value;
use std::f64::consts::{FRAC_PI_2, PI};

/// A billionth of a degree.
const ANGLE: f64 = 1e-9 * PI / 180.0;

fn greatest(differences: impl Iterator<Item = f64>) -> f64 {
    differences.map(f64::abs).fold(0.0, f64::max)
}

/// Greatest difference of two sets of angles, whole turns apart or not.
fn apart(left: &[f64], right: &[f64]) -> f64 {
    assert_eq!(left.len(), right.len());
    greatest(left.iter().zip(right).map(|(a, b)| (a - b + PI).rem_euclid(2.0 * PI) - PI))
}

fn metres(millimetres: &Value) -> [f64; 3] {
    numbers(millimetres).iter().map(|x| x / 1000.0).collect::<Vec<_>>().try_into().unwrap()
}

fn solve(arm: &dyn Kinematics, problem: &str, target: &Target) -> Result<Vec<Vec<f64>>, IkError> {
    let mut set = SolutionSet::new();
    arm.ik_into(problem, target, &mut set)?;
    for solution in set.iter() {
        assert!(solution.residual() < 1e-9, "{problem}: {solution:?}");
        let (position, rotation) = target.validate().unwrap().errors(&arm.fk(solution.q).unwrap());
        assert!(position.max(rotation) < 1e-9, "{problem}: {solution:?}");
    }
    Ok(set.iter().map(|solution| solution.q.to_vec()).collect())
}

fn solve_within(arm: &dyn Kinematics, problem: &str, target: &Target) -> Result<Vec<Vec<f64>>, IkError> {
    let mut set = SolutionSet::new();
    arm.ik_within(problem, target, None, &mut set)?;
    assert!(!set.is_empty(), "never empty");
    for solution in set.iter() {
        assert!(arm.check(solution.q).is_ok(), "{problem}: {solution:?}");
    }
    Ok(set.iter().map(|solution| solution.q.to_vec()).collect())
}

fn contains(solutions: &[Vec<f64>], q: &[f64], tolerance: f64) -> bool {
    solutions.iter().any(|solution| apart(solution, q) < tolerance)
}

fn quaternions_agree(frame: &Frame, given: &Value, tolerance: f64) {
    let (found, given) = (frame.quaternion(), numbers(given));
    let off = |sign: f64| greatest(found.iter().zip(&given).map(|(a, b)| a - sign * b));
    assert!(off(1.0).min(off(-1.0)) < tolerance, "{found:?} {given:?}");
}

#[test]
fn mycobot_forward() {
    let arm = engine::shipped("mycobot").unwrap();
    for entry in elements(&cases::mycobot()["fk"]) {
        let q = radians(&numbers(&entry["joints_deg"]));
        let frame = arm.fk(&q).unwrap();
        for key in ["position_mm", "published_mm"] {
            let off =
                greatest(frame.translation.iter().zip(metres(&entry[key])).map(|(a, b)| (a - b) * 1000.0));
            assert!(off < if key == "position_mm" { 1e-9 } else { 1e-6 }, "{key}: {entry}");
        }
        // With w near 0 the case's own quaternions, roots of a trace, have eight digits.
        quaternions_agree(&frame, &entry["quaternion_xyzw"], 1e-7);
        assert!(arm.check(&q).is_ok(), "{entry}");
    }
}

/// The joints that a pose breaks (0-based), and whether it is too low.
fn broken(arm: &dyn Kinematics, q: &[f64]) -> (Vec<usize>, bool) {
    let Err(violations) = arm.check(q) else { return (Vec::new(), false) };
    let joint = |violation| match violation {
        Violation::OutsideLimits { joint, .. } => Some(joint),
        _ => None,
    };
    let low = |violation| matches!(violation, Violation::Forbidden(Rule::Bound { bound, .. }) if bound.axis == Axis::Z);
    (violations.iter().filter_map(joint).collect(), violations.iter().any(low))
}

#[test]
fn mycobot_refused_poses() {
    let arm = engine::shipped("mycobot").unwrap();
    let case = cases::mycobot();
    let poses: Vec<_> =
        elements(&case["rejected"]).iter().map(|pose| radians(&numbers(&pose["joints_deg"]))).collect();
    assert_eq!(poses.len(), 3);
    assert_eq!(broken(&*arm, &poses[0]), (vec![], true), "below the floor, and nothing else");
    let height = arm.fk(&poses[0]).unwrap().translation[2] * 1000.0;
    assert!((height - case["rejected"][0]["position_mm"][2].as_f64().unwrap()).abs() < 1e-9);
    assert_eq!(broken(&*arm, &poses[1]).0, [0, 5], "the first and the last joint");
    assert_eq!(broken(&*arm, &poses[2]).0, [2, 3]);
}

#[test]
fn mycobot_tool_down() {
    let arm = engine::shipped("mycobot").unwrap();
    for entry in elements(&cases::mycobot()["tool_down"]["ik"]) {
        let target = Target::Position(metres(&entry["position_mm"]));
        let given = radians(&numbers(&entry["joints_deg"]));
        let both = solve(&*arm, "tool_down", &target).unwrap();
        assert!(contains(&both, &given, ANGLE), "{entry} {both:?}");
        // With the other shoulder the forearm would have to reach past d5 backwards: too far at these targets.
        assert_eq!(both.len(), 2, "two elbows: {both:?}");
        let up = solve(&*arm, "tool_down_elbow_up", &target).unwrap();
        assert!(contains(&up, &given, ANGLE), "{entry} {up:?}");
        assert!(up.iter().all(|q| q[2] <= 0.0), "{up:?}");
        assert_eq!(entry["inside_limits"], true);
        let usable = solve_within(&*arm, "tool_down_elbow_up", &target).unwrap();
        assert_eq!(usable.len(), 1, "{usable:?}");
        assert!(greatest(usable[0].iter().zip(&given).map(|(a, b)| a - b)) < ANGLE, "{entry} {usable:?}");
    }
}

#[test]
fn mycobot_tool_down_errors() {
    let arm = engine::shipped("mycobot").unwrap();
    let case = cases::mycobot();
    let errors = elements(&case["tool_down"]["errors"]);
    assert_eq!(errors.len(), 2);
    for (index, entry) in errors.iter().enumerate() {
        let target = Target::Position(metres(&entry["position_mm"]));
        for problem in ["tool_down", "tool_down_elbow_up"] {
            let error = solve(&*arm, problem, &target).unwrap_err();
            let right = match index {
                // The plane of the arm passes the first axis at d4: no turn of joint 1 makes up for that.
                0 => matches!(error, IkError::Singular { joint: 0, gap } if (gap - 0.06639).abs() < 1e-12),
                _ => matches!(error, IkError::Unreachable { .. }),
            };
            assert!(right, "{entry}: {error}");
        }
    }
}

#[test]
fn mycobot_sends_what_the_device_expects() {
    let arm = engine::shipped("mycobot").unwrap();
    let given = cases::mycobot();
    assert_eq!(given["device"]["device_angle_deg"], "J - [90,0,0,0,0,0]");
    for (joint, shift) in arm.joints().iter().zip([90.0, 0.0, 0.0, 0.0, 0.0, 0.0]) {
        let sent = joint.servo.unwrap().to_device(30_f64.to_radians());
        assert!((sent - (30.0 - shift)).abs() < 1e-12, "{}: {sent}", joint.name);
    }
}

#[test]
fn mycobot_plate_transport() {
    let arm = engine::shipped("mycobot").unwrap();
    let case = cases::mycobot();
    let waypoints = elements(&case["plate_transport"]["waypoints_mm"]);
    assert_eq!(waypoints.len(), 4);
    for waypoint in waypoints {
        let usable = solve_within(&*arm, "tool_down_elbow_up", &Target::Position(metres(waypoint))).unwrap();
        let tool = arm.fk(&usable[0]).unwrap();
        assert!((tool.rotation[2][2] + 1.0).abs() < 1e-12, "the tool points down");
    }
}

fn xy(value: &Value) -> Target {
    Target::Xy(numbers(value).try_into().unwrap())
}

#[test]
fn planar2r_both_elbows() {
    let arm = engine::shipped("planar2r").unwrap();
    let case = cases::planar2r();
    assert_eq!(elements(&case["cases"]).len(), 20);
    for entry in elements(&case["cases"]) {
        let target = xy(&entry["position_m"]);
        let (down, up) = (numbers(&entry["elbow_down_rad"]), numbers(&entry["elbow_up_rad"]));
        let both = solve(&*arm, "xy", &target).unwrap();
        assert_eq!(both.len(), 2, "{entry}");
        for (problem, given) in [("xy_elbow_down", &down), ("xy_elbow_up", &up)] {
            assert!(contains(&both, given, 1e-12), "{entry} {both:?}");
            let one = solve(&*arm, problem, &target).unwrap();
            assert_eq!(one.len(), 1, "{entry}");
            assert!(apart(&one[0], given) < 1e-12, "{entry} {one:?}");
        }
    }
}

#[test]
fn planar2r_out_of_reach_and_at_its_edge() {
    let arm = engine::shipped("planar2r").unwrap();
    let case = cases::planar2r();
    for target in elements(&case["unreachable_m"]) {
        let error = solve(&*arm, "xy", &xy(target)).unwrap_err();
        assert!(matches!(error, IkError::Unreachable { excess, .. } if excess > 0.0), "{target}: {error}");
    }
    for (entry, elbow) in elements(&case["singular_m"]).iter().zip([0.0, PI]) {
        let solutions = solve(&*arm, "xy", &xy(entry)).unwrap();
        assert!(!solutions.is_empty());
        // Both elbows meet here; an angle is known to the root of the rounding.
        assert!(solutions.iter().all(|q| apart(&q[1..], &[elbow]) < 1e-7), "{entry} {solutions:?}");
    }
}

#[test]
fn planar2r_ticks() {
    let arm = engine::shipped("planar2r").unwrap();
    let case = cases::planar2r();
    for entry in elements(&case["servo"]["ticks"]) {
        let [angle, ticks] = numbers(entry)[..] else { panic!("{entry}") };
        for joint in arm.joints() {
            let servo = joint.servo.unwrap();
            // The course cuts the fraction off.
            assert!((servo.to_device(angle) - ticks).abs() < 1.0, "{entry}");
            let range = servo.range.unwrap();
            assert_eq!((range.min, range.max), (0.0, 4095.0));
        }
    }
}

#[test]
fn rtm2r_both_elbows() {
    let arm = engine::shipped("rtm2r").unwrap();
    let case = cases::rtm2r();
    assert_eq!(elements(&case["ik"]).len(), 5);
    for entry in elements(&case["ik"]) {
        let both = solve(&*arm, "xy", &xy(&entry["position_m"])).unwrap();
        assert_eq!(both.len(), 2, "{entry}");
        for given in elements(&entry["solutions_deg"]) {
            assert!(contains(&both, &radians(&numbers(given)), ANGLE), "{entry} {both:?}");
        }
    }
}

#[test]
fn crane_x7_square() {
    let (plane, arm) = (engine::shipped("crane_x7_2r").unwrap(), engine::shipped("crane_x7").unwrap());
    let case = cases::crane_x7_2r();
    for (index, corner) in elements(&case["square"]).iter().enumerate() {
        let (given, theta) = (numbers(&corner["position_m"]), numbers(&corner["theta_rad"]));
        let usable = solve_within(&*plane, "xy", &xy(&corner["position_m"])).unwrap();
        assert_eq!(usable.len(), 1, "the elbow bends one way: {usable:?}");
        assert!(apart(&usable[0], &theta) < 1e-12, "{corner} {usable:?}");

        // The same in the full arm, hand down: the tool is 19 mm below the wrist centre.
        let down = corner["wrist_down_theta6_rad"].as_f64().unwrap();
        let q = [0.0, theta[0] - FRAC_PI_2, 0.0, theta[1], 0.0, down, 0.0];
        let target = Target::Position([given[0], 0.0, 0.105 + given[1] - 0.019]);
        let all = solve(&*arm, "wrist_down", &target).unwrap();
        assert!(contains(&all, &q, 1e-12), "{corner} {all:?}");
        if index == 2 {
            // The third corner bends the wrist past its limit of a quarter turn.
            let error = solve_within(&*arm, "wrist_down", &target).unwrap_err();
            assert!(matches!(error, IkError::OutsideLimits { .. }), "{error}");
        }
    }
}

#[test]
fn crane_x7_as_a_planar_arm() {
    let arm = engine::shipped("crane_x7").unwrap();
    let q = [0.4, -0.2, 0.0, -1.3, 0.0, 0.0, 0.0];
    let target = Target::Position(arm.fk(&q).unwrap().translation);
    assert!(contains(&solve(&*arm, "planar", &target).unwrap(), &q, 1e-12));
    assert!(contains(&solve_within(&*arm, "planar", &target).unwrap(), &q, 1e-12));
}

#[test]
fn crane_x7_forward_and_servos() {
    let arm = engine::shipped("crane_x7").unwrap();
    let case = cases::crane_x7();
    forward_in_metres(&*arm, &case);
    let ids = elements(&case["servos"]["ids_of_joints"]);
    for ((joint, id), limits) in arm.joints().iter().zip(ids).zip(elements(&case["limits_rad"])) {
        let servo = joint.servo.unwrap();
        assert_eq!(servo.id.map(u64::from), id.as_u64());
        let model = if servo.id == Some(3) {
            &case["servos"]["models"]["3"]
        } else {
            &case["servos"]["models"]["others"]
        };
        assert_eq!(servo.model, model.as_str());
        assert!((servo.to_device(PI) - servo.to_device(-PI) - 4096.0).abs() < 1e-9);
        assert!((servo.zero - 2048.0).abs() < 1e-9);
        assert_eq!(joint.max_velocity, case["servos"]["max_velocity_rad_s"].as_f64());
        let own = joint.limits.unwrap();
        assert_eq!(vec![own.min, own.max], numbers(limits));
    }
}

fn forward_in_metres(arm: &dyn Kinematics, case: &Value) {
    assert_eq!(elements(&case["fk"]).len(), 40);
    for entry in elements(&case["fk"]) {
        let frame = arm.fk(&numbers(&entry["joints_rad"])).unwrap();
        let off = greatest(frame.translation.iter().zip(numbers(&entry["position_m"])).map(|(a, b)| a - b));
        assert!(off < 1e-14, "{entry}");
        quaternions_agree(&frame, &entry["quaternion_xyzw"], 1e-11);
    }
}

#[test]
fn vs068_there_and_back() {
    let arm = engine::shipped("vs068").unwrap();
    let case = cases::vs068();
    forward_in_metres(&*arm, &case);
    for entry in elements(&case["fk"]) {
        let q = numbers(&entry["joints_rad"]);
        let target = Target::Pose(arm.fk(&q).unwrap());
        let all = solve(&*arm, FULL_POSE, &target).unwrap();
        assert!(all.len() <= 8, "a spherical wrist has at most eight: {all:?}");
        assert!(contains(&all, &q, 1e-9), "{entry} {all:?}");
        assert!(contains(&solve_within(&*arm, FULL_POSE, &target).unwrap(), &q, 1e-9), "{entry}");
    }
}
