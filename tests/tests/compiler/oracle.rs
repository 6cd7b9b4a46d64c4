//! The oracle against numbers that were computed apart from this project, and against published ones.

#![expect(clippy::unwrap_used, reason = "a broken table or case is a broken test")]

use dh_tests::cases::{self, elements, numbers, radians};
use dh_tests::matrix::quaternion_of;
use dh_tests::oracle::Oracle;
use serde_json::Value;

/// Greatest difference, with the sign of a quaternion at w = 0 left open.
fn difference(left: &[f64], right: &[f64]) -> f64 {
    let worst = |sign: f64| left.iter().zip(right).map(|(a, b)| (a - sign * b).abs()).fold(0.0, f64::max);
    if left.len() == 4 { worst(1.0).min(worst(-1.0)) } else { worst(1.0) }
}

fn position(pose: &[[f64; 4]; 4], scale: f64) -> [f64; 3] {
    [pose[0][3] * scale, pose[1][3] * scale, pose[2][3] * scale]
}

#[test]
fn mycobot_positions_to_a_billionth_of_a_millimetre() {
    let oracle = Oracle::shipped("mycobot").unwrap();
    let case = cases::mycobot();
    let poses = elements(&case["fk"]);
    assert_eq!(poses.len(), 6);
    for entry in poses {
        let pose = oracle.fk(&radians(&numbers(&entry["joints_deg"])));
        let found = position(&pose, 1000.0);
        assert!(difference(&found, &numbers(&entry["position_mm"])) < 1e-9, "{entry}");
        // With w near 0 the case's own quaternions, roots of a trace, have eight digits.
        assert!(difference(&quaternion_of(&pose), &numbers(&entry["quaternion_xyzw"])) < 1e-7, "{entry}");
        // Published to a hundred-millionth, one of them to five digits behind the point.
        assert!(difference(&found, &numbers(&entry["published_mm"])) < 1e-6, "{entry}");
    }
}

#[test]
fn mycobot_tool_down_solutions_reach_their_targets() {
    let oracle = Oracle::shipped("mycobot").unwrap();
    let case = cases::mycobot();
    let solved = elements(&case["tool_down"]["ik"]);
    assert_eq!(solved.len(), 9);
    for entry in solved {
        let pose = oracle.fk(&radians(&numbers(&entry["joints_deg"])));
        assert!(difference(&position(&pose, 1000.0), &numbers(&entry["position_mm"])) < 1e-9, "{entry}");
        assert!((pose[2][2] + 1.0).abs() < 1e-14, "the tool points down: {entry}");
    }
}

fn agree_in_metres(name: &str, case: &Value) {
    let oracle = Oracle::shipped(name).unwrap();
    let poses = elements(&case["fk"]);
    assert_eq!(poses.len(), 40);
    for entry in poses {
        let pose = oracle.fk(&numbers(&entry["joints_rad"]));
        assert!(difference(&position(&pose, 1.0), &numbers(&entry["position_m"])) < 1e-14, "{entry}");
        assert!(difference(&quaternion_of(&pose), &numbers(&entry["quaternion_xyzw"])) < 1e-11, "{entry}");
    }
    let zero = oracle.fk(&vec![0.0; oracle.dof()]);
    for (row, given) in zero.iter().zip(elements(&case["flange_at_zero"])) {
        assert!(difference(row, &numbers(given)) < 1e-15, "{name} at zero");
    }
}

#[test]
fn crane_x7_poses() {
    agree_in_metres("crane_x7", &cases::crane_x7());
}

#[test]
fn vs068_poses() {
    agree_in_metres("vs068", &cases::vs068());
}

#[test]
fn planar_arms() {
    let oracle = Oracle::shipped("planar2r").unwrap();
    let case = cases::planar2r();
    for entry in elements(&case["cases"]) {
        for q in ["joints_rad", "elbow_down_rad", "elbow_up_rad"] {
            let pose = oracle.fk(&numbers(&entry[q]));
            assert!(
                difference(&position(&pose, 1.0)[..2], &numbers(&entry["position_m"])) < 1e-14,
                "{entry}"
            );
        }
    }
    let oracle = Oracle::shipped("rtm2r").unwrap();
    let case = cases::rtm2r();
    for entry in elements(&case["ik"]) {
        for q in elements(&entry["solutions_deg"]) {
            let pose = oracle.fk(&radians(&numbers(q)));
            assert!(
                difference(&position(&pose, 1.0)[..2], &numbers(&entry["position_m"])) < 1e-14,
                "{entry}"
            );
        }
    }
}

#[test]
fn crane_x7_square_in_the_plane_and_in_the_full_arm() {
    let plane = Oracle::shipped("crane_x7_2r").unwrap();
    let arm = Oracle::shipped("crane_x7").unwrap();
    let case = cases::crane_x7_2r();
    let square = elements(&case["square"]);
    assert_eq!(square.len(), 4);
    for corner in square {
        let (target, theta) = (numbers(&corner["position_m"]), numbers(&corner["theta_rad"]));
        assert!(difference(&position(&plane.fk(&theta), 1.0)[..2], &target) < 1e-14, "{corner}");

        let down = corner["wrist_down_theta6_rad"].as_f64().unwrap();
        let q = [0.0, theta[0] - std::f64::consts::FRAC_PI_2, 0.0, theta[1], 0.0, down, 0.0];
        // Frame 7 lies in the wrist centre, the tool 19 mm further along the hand.
        let wrist = position(&arm.fk_flange(&q), 1.0);
        assert!(difference(&wrist, &[target[0], 0.0, 0.105 + target[1]]) < 1e-14, "{corner}");
        let tool = arm.fk(&q);
        assert!((tool[2][2] + 1.0).abs() < 1e-14, "the hand points down: {corner}");
        assert!((tool[2][3] - wrist[2] + 0.019).abs() < 1e-15, "{corner}");
    }
}

/// Rows against numbers of their sources at poses that anybody can check.
#[test]
fn published_poses_of_the_other_arms() {
    let at = |name: &str, pose: &str| {
        let oracle = Oracle::shipped(name).unwrap();
        let q = oracle.chain().poses.iter().find(|(known, _)| known == pose).unwrap().1.clone();
        oracle.fk(&q)
    };
    // Stretched out along -x, one arm beside the other.
    let ur5 = at("ur5", "zero");
    assert!(difference(&position(&ur5, 1.0), &[-0.81725, -0.19145, -0.005_491]) < 1e-12);
    let ur5e = at("ur5e", "zero");
    assert!(difference(&position(&ur5e, 1.0), &[-0.8172, -0.2329, 0.0628]) < 1e-12);
    // Straight up: a3 lies across. Then both arms at 45 degrees, tool forward.
    let puma = at("puma560", "ready");
    assert!(difference(&position(&puma, 1.0), &[0.0203, -0.15005, 0.672 + 2.0 * 0.4318]) < 1e-12);
    let puma = at("puma560", "nominal");
    assert!(difference(&position(&puma, 1.0), &[0.5963, -0.15005, 0.65765]) < 1e-5);
    // The maker's start pose: flange over x = 0.3069, 0.5903 up, pointing down.
    let panda = at("panda", "ready");
    assert!(difference(&position(&panda, 1.0), &[0.3069, 0.0, 0.5903]) < 5e-5);
    assert!((panda[2][2] + 1.0).abs() < 1e-15);
    let scara = at("scara", "zero");
    assert!(difference(&position(&scara, 1.0), &[0.6, 0.0, 0.387]) < 1e-15);
    assert_eq!(scara[2][2], -1.0);
    // Firmware's formula: stretch = 142.07 cos l + 158.81 cos u + 13.2 + 56.65, height likewise, over x at base 90.
    let uarm = at("uarm_swift_pro", "reach");
    let (l, u) = (60_f64.to_radians(), 30_f64.to_radians());
    let stretch = 142.07 * l.cos() + 158.81 * u.cos() + 13.2 + 56.65;
    let height = 106.6 + 142.07 * l.sin() - 158.81 * u.sin() - 74.55;
    assert!(difference(&position(&uarm, 1000.0), &[stretch, 0.0, height]) < 1e-12);
    assert!(difference(&uarm[0][..3], &[1.0, 0.0, 0.0]) < 1e-15, "level, and the hand straight");
}

#[test]
fn jacobians_are_derivatives() {
    for name in dh_robots::names() {
        let oracle = Oracle::shipped(name).unwrap();
        let q: Vec<f64> = (0..oracle.dof()).map(|i| 0.3 + 0.37 * i as f64).collect();
        let pose = oracle.fk(&q);
        for (joint, column) in oracle.jacobian(&q).iter().enumerate() {
            let step = 1e-6;
            let moved = |by: f64| {
                let mut q = q.clone();
                q[joint] += by;
                oracle.fk(&q)
            };
            let (plus, minus) = (moved(step), moved(-step));
            let slope = |i: usize, j: usize| (plus[i][j] - minus[i][j]) / (2.0 * step);
            // dR R^T is the cross product matrix of the angular velocity.
            let spin = |i: usize, j: usize| (0..3).map(|k| slope(i, k) * pose[j][k]).sum::<f64>();
            let numeric = [slope(0, 3), slope(1, 3), slope(2, 3), spin(2, 1), spin(0, 2), spin(1, 0)];
            assert!(difference(&numeric, column) < 1e-8, "{name}, joint {joint}: {numeric:?} {column:?}");
        }
    }
}
