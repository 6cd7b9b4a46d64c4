//! Spherical-roll-spherical arms by their arm angle, against what the oracle's axes say of shoulder, elbow and wrist.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking"
)]

use dh_core::{Frame, IkError, Kinematics, SolutionSet, Target};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross([a, b, c]: Vector, [x, y, z]: Vector) -> Vector {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

/// a + factor * b
fn plus(a: Vector, factor: f64, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + factor * b[i])
}

fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

struct Arm {
    oracle: Oracle,
    engine: Box<dyn Kinematics + Send + Sync>,
}

/// What the oracle says of a joint vector.
struct Seen {
    /// rad
    angle: f64,
    /// How far the elbow is from the line to the wrist, and the wrist from the first axis (m).
    bent: f64,
    off_axis: f64,
}

impl Arm {
    fn new(text: &str) -> Self {
        Self { oracle: Oracle::read(text).unwrap(), engine: engine::interpreter(text).unwrap() }
    }

    fn target(&self, q: &[f64]) -> Target {
        let rows = self.oracle.fk(q);
        let rotation = [0, 1, 2].map(|i| [rows[i][0], rows[i][1], rows[i][2]]);
        Target::Pose(Frame { rotation, translation: [0, 1, 2].map(|i| rows[i][3]) })
    }

    fn seen(&self, q: &[f64]) -> Seen {
        let rows = self.oracle.fk(q);
        let tool: Vector = [0, 1, 2].map(|i| rows[i][3]);
        let lines: Vec<(Vector, Vector)> = self
            .oracle
            .jacobian(q)
            .into_iter()
            .map(|[vx, vy, vz, x, y, z]| (plus(tool, 1.0, cross([x, y, z], [vx, vy, vz])), [x, y, z]))
            .collect();
        // Of two lines, the point of the first that is nearest to the other.
        let meeting = |(p, u): (Vector, Vector), (r, v): (Vector, Vector)| {
            let n = cross(u, v);
            plus(p, dot(cross(plus(r, -1.0, p), v), n) / dot(n, n), u)
        };
        let (shoulder, wrist) = (meeting(lines[0], lines[1]), meeting(lines[5], lines[6]));
        let (point, axis) = lines[3];
        let elbow = plus(point, dot(plus(shoulder, -1.0, point), axis), axis);
        let line = plus(wrist, -1.0, shoulder);
        let along = line.map(|x| x / norm(line));
        let across = |v: Vector| plus(v, -dot(v, along), along);
        let (zero, own) = (across(lines[0].1), across(plus(elbow, -1.0, shoulder)));
        Seen {
            angle: dot(along, cross(zero, own)).atan2(dot(zero, own)),
            bent: norm(own),
            off_axis: norm(zero) * norm(line),
        }
    }

    fn by_arm_angle(&self, problem: &str, target: &Target, angle: f64) -> Result<SolutionSet, IkError> {
        let mut set = SolutionSet::new();
        self.engine.ik_by_arm_angle_into(problem, target, angle, &mut set)?;
        Ok(set)
    }
}

fn turned(x: f64) -> f64 {
    (x + PI).rem_euclid(TAU) - PI
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| turned(a - b).abs()).fold(0.0, f64::max)
}

/// Shoulder, elbow and wrist with these twists (degrees) and an elbow off its link; problems that leave other joints to the caller.
fn drawn(convention: &str, elbow: f64, twists: [f64; 6]) -> String {
    use std::fmt::Write;
    let lengths =
        [(0.34, 0.0), (0.0, 0.0), (0.41, elbow), (0.0, -elbow), (0.39, 0.0), (0.0, 0.0), (0.08, 0.03)];
    let mut text = format!(
        "[robot]\nname = \"drawn\"\nconvention = \"{convention}\"\nunits = {{ length = \"m\", angle = \"deg\" }}\n"
    );
    for (row, (d, a)) in lengths.into_iter().enumerate() {
        let (a, alpha) = if convention == "standard" {
            (a, twists.get(row).copied().unwrap_or(20.0))
        } else {
            let before = row.checked_sub(1);
            (before.map_or(0.0, |row| lengths[row].1), before.map_or(0.0, |row| twists[row]))
        };
        let (direction, offset) = if row % 3 == 1 { (-1, 15 * row) } else { (1, 30) };
        writeln!(
            text,
            "[[joint]]\nd = {d}\na = {a}\nalpha = {alpha}\ndirection = {direction}\noffset = {offset}"
        )
        .unwrap();
    }
    for joint in [1, 2, 5, 7] {
        writeln!(text, "[[ik]]\nname = \"by_j{joint}\"\ntarget = \"pose\"\nfree = [\"J{joint}\"]").unwrap();
    }
    text.push_str("[base]\nxyz = [0.1, 0.2, 0.3]\nrpy = [40, 50, 60]\n[tool]\nxyz = [0.01, -0.02, 0.1]\nrpy = [10, 20, 30]\n");
    text
}

const RIGHT: [f64; 6] = [-90.0, 90.0, -90.0, 90.0, -90.0, 90.0];

fn arms() -> Vec<Arm> {
    let mut arms: Vec<Arm> = ["iiwa14", "sia20d", "crane_x7"]
        .iter()
        .map(|name| Arm::new(dh_robots::table(name).unwrap()))
        .collect();
    arms.push(Arm::new(&drawn("standard", 0.0, RIGHT)));
    arms.push(Arm::new(&drawn("modified", 0.045, RIGHT)));
    arms.push(Arm::new(&drawn("standard", 0.03, [-90.0, 80.0, -100.0, 75.0, -90.0, 60.0])));
    arms
}

fn problems(arm: &Arm) -> impl Iterator<Item = &str> {
    arm.engine.problems().iter().map(|info| info.name).filter(|name| {
        arm.engine.redundancy(name).is_some_and(|redundancy| redundancy.spherical_roll_spherical.is_some())
    })
}

/// The same joint values on every run.
fn runner() -> TestRunner {
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(ProptestConfig::with_cases(64), random)
}

#[test]
fn the_joints_of_a_pose_are_found_by_their_arm_angle() {
    for (number, arm) in arms().iter().enumerate() {
        assert_eq!(problems(arm).count(), if number < 3 { 1 } else { 5 });
        let joints = proptest::array::uniform7(-PI..PI);
        let runs = |q: [f64; 7]| {
            let (seen, target) = (arm.seen(&q), arm.target(&q));
            for problem in problems(arm) {
                let own = arm.engine.arm_angle(problem, &q).unwrap().unwrap();
                prop_assert!(turned(own - seen.angle).abs() < 1e-9, "{own}, {}", seen.angle);
                let found = arm.by_arm_angle(problem, &target, own).unwrap();
                prop_assert!(found.iter().any(|solution| apart(solution.q, &q) < 1e-7), "{problem} {q:?}");
                for solution in found.iter() {
                    prop_assert!(solution.position_error < 1e-12 && solution.rotation_error < 1e-12);
                    prop_assert!(turned(arm.seen(solution.q).angle - own).abs() < 1e-6);
                }
            }
            Ok(())
        };
        runner().run(&joints, runs).unwrap();
    }
}

/// Shoulder, elbow and wrist bent one way or the other are eight solutions.
#[test]
fn an_arm_angle_leaves_eight_solutions() {
    let arm = Arm::new(dh_robots::table("iiwa14").unwrap());
    let target = arm.target(&[0.3, 0.5, -0.4, -1.2, 0.7, 0.9, 0.2]);
    for step in 0..64 {
        let angle = TAU * f64::from(step) / 64.0 - PI;
        let found = arm.by_arm_angle("pose", &target, angle).unwrap();
        assert_eq!(found.len(), 8, "{angle}");
    }
}

/// Quarter turns and their neighbours: straight and folded arms, wrists on the first axis, axes on one line.
#[test]
fn special_poses_have_solutions_at_every_arm_angle() {
    for (number, arm) in arms().iter().enumerate() {
        let steps = proptest::array::uniform7((-2..=2i32, 0..6usize));
        let runs = |steps: [(i32, usize); 7]| {
            let off = [0.0, 0.0, 0.0, 1e-9, 1e-6, 0.3];
            let q = steps.map(|(turns, by)| FRAC_PI_2 * f64::from(turns) + off[by]);
            let (seen, target) = (arm.seen(&q), arm.target(&q));
            for problem in problems(arm) {
                let own = arm.engine.arm_angle(problem, &q).unwrap().unwrap();
                if seen.bent > 1e-6 && seen.off_axis > 1e-6 {
                    prop_assert!(turned(own - seen.angle).abs() < 1e-9, "{own}, {}", seen.angle);
                }
                for angle in [own, 0.0, 1.0, -PI, FRAC_PI_2] {
                    match arm.by_arm_angle(problem, &target, angle) {
                        Ok(found) => {
                            prop_assert!(found.iter().all(|solution| solution.rotation_error < 1e-7));
                        }
                        // Axes that aren't at right angles leave some arm angles out, but not the arm's own.
                        Err(error) => {
                            prop_assert!(number == 5 && angle != own, "{problem} {q:?} {angle}: {error}");
                        }
                    }
                }
            }
            Ok(())
        };
        runner().run(&steps, runs).unwrap();
    }
}
