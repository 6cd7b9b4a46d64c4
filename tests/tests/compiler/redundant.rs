//! Arms with seven joints against the oracle: free joints, sweeps, intervals, and the nearest solution.
//!
//! Tables are drawn: spherical-roll-spherical arms, arms with a spherical shoulder and an offset elbow and wrist, and six
//! joints on a rail, in both conventions, with directions, offsets and limits.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking"
)]

use dh_core::{FULL_POSE, Frame, IkError, Kinematics, Limits, SWEEP_SAMPLES, SolutionSet, Target};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use proptest::prelude::*;
use proptest::test_runner::{TestCaseResult, TestRunner};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write;
use std::sync::LazyLock;

/// A table with its oracle and its interpreter.
struct Arm {
    oracle: Oracle,
    engine: Box<dyn Kinematics + Send + Sync>,
}

impl Arm {
    fn new(text: &str) -> Self {
        Self { oracle: Oracle::read(text).unwrap(), engine: engine::interpreter(text).unwrap() }
    }

    fn target(&self, q: &[f64]) -> Target {
        let [x, y, z, _] = self.oracle.fk(q);
        let [x, y, z] = [x, y, z].map(|[a, b, c, p]| ([a, b, c], p));
        Target::Pose(Frame { rotation: [x.0, y.0, z.0], translation: [x.1, y.1, z.1] })
    }

    fn free(&self) -> usize {
        self.engine.redundancy(FULL_POSE).expect("a full pose").joint
    }

    /// By how much the oracle's pose of some joint values misses that of others (m, or entries of the rotation).
    fn miss(&self, q: &[f64], wanted: &[f64]) -> f64 {
        let (own, other) = (self.oracle.fk(q), self.oracle.fk(wanted));
        let pairs = own.as_flattened().iter().zip(other.as_flattened());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// Joint values from numbers in 0 .. 1, within the limits.
    fn inside(&self, x: &[f64]) -> Vec<f64> {
        let value = |(joint, x): (&dh_core::Joint<'_>, &f64)| match joint.limits {
            Some(limits) => limits.min + x * (limits.max - limits.min),
            None => TAU * (x - 0.5),
        };
        self.engine.joints().iter().zip(x).map(value).collect()
    }

    fn at(&self, target: &Target, free: f64) -> Result<SolutionSet, IkError> {
        let mut set = SolutionSet::new();
        self.engine.ik_at_into(FULL_POSE, target, &[free], &mut set)?;
        Ok(set)
    }
}

fn travel(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Greatest difference of two joint vectors, whole turns of joints that turn aside.
fn apart(arm: &Arm, a: &[f64], b: &[f64]) -> f64 {
    let joints = arm.engine.joints().iter().map(|joint| joint.kind == dh_core::JointKind::Revolute);
    let apart = |((a, b), turns): ((&f64, &f64), bool)| {
        if turns { ((a - b + PI).rem_euclid(TAU) - PI).abs() } else { (a - b).abs() }
    };
    a.iter().zip(b).zip(joints).map(apart).fold(0.0, f64::max)
}

/// Rows of (d, a, alpha in degrees), the row's number and whether it slides.
fn table(
    convention: &str,
    rows: &[(f64, f64, f64)],
    slide: Option<usize>,
    limits: bool,
    twist: &[bool],
) -> String {
    let mut text = format!(
        "[robot]\nname = \"drawn\"\nconvention = \"{convention}\"\nunits = {{ length = \"m\", angle = \"deg\" }}\n"
    );
    for (row, (d, a, alpha)) in rows.iter().enumerate() {
        let turned = twist.get(row).copied().unwrap_or(false);
        let (direction, offset) = if turned { (-1, 90) } else { (1, 0) };
        if slide == Some(row) {
            writeln!(
                text,
                "[[joint]]\ntype = \"prismatic\"\ntheta = 0\na = {a}\nalpha = {alpha}\nlimits = [-0.8, 0.9]"
            )
        } else {
            writeln!(
                text,
                "[[joint]]\nd = {d}\na = {a}\nalpha = {alpha}\ndirection = {direction}\noffset = {offset}{}",
                if limits {
                    format!("\nlimits = [{}, {}]", -100 - 10 * row as i64, 120 + 5 * row)
                } else {
                    String::new()
                }
            )
        }
        .unwrap();
    }
    text.push_str("[tool]\nxyz = [0.01, -0.02, 0.1]\nrpy = [10, 20, 30]\n");
    text
}

/// Spherical shoulder, elbow with or without offset, spherical wrist.
fn spherical_roll_spherical(elbow: f64, limits: bool, twist: &[bool]) -> String {
    let rows = [
        (0.34, 0.0, -90.0),
        (0.0, 0.0, 90.0),
        (0.4, elbow, -90.0),
        (0.0, -elbow, 90.0),
        (0.39, 0.0, -90.0),
        (0.0, 0.0, 90.0),
        (0.08, 0.0, 0.0),
    ];
    table("standard", &rows, None, limits, twist)
}

/// The Panda's pattern.
fn offset_wrist(limits: bool, twist: &[bool]) -> String {
    let rows = [
        (0.3, 0.0, 0.0),
        (0.0, 0.0, -90.0),
        (0.32, 0.0, 90.0),
        (0.0, 0.08, 90.0),
        (0.38, -0.08, -90.0),
        (0.0, 0.0, 90.0),
        (0.1, 0.09, 90.0),
    ];
    table("modified", &rows, None, limits, twist)
}

/// An arm with a spherical wrist on a rail along x.
fn on_a_rail(limits: bool, twist: &[bool]) -> String {
    let rows = [
        (0.0, 0.0, 90.0),
        (0.4, 0.1, -90.0),
        (0.0, 0.45, 0.0),
        (0.0, 0.03, -90.0),
        (0.42, 0.0, 90.0),
        (0.0, 0.0, -90.0),
        (0.08, 0.0, 0.0),
    ];
    table("standard", &rows, Some(0), limits, twist)
}

fn drawn(twist: &[bool]) -> Vec<Arm> {
    let texts = [
        spherical_roll_spherical(0.0, true, twist),
        spherical_roll_spherical(0.04, false, twist),
        offset_wrist(true, twist),
        on_a_rail(true, twist),
    ];
    texts.iter().map(|text| Arm::new(text)).collect()
}

/// Compiled once for all tests.
static ARMS: LazyLock<Vec<Arm>> = LazyLock::new(|| {
    let mut arms = drawn(&[false; 7]);
    arms.extend(drawn(&[true, false, true, true, false, false, true]));
    arms
});

fn for_all(cases: u32, holds: impl Fn(&Arm, &[f64], &[f64]) -> TestCaseResult) {
    for arm in ARMS.iter() {
        let mut runner = TestRunner::new(ProptestConfig::with_cases(cases));
        let numbers = (prop::array::uniform7(0.01..0.99), prop::array::uniform7(0.01..0.99));
        runner.run(&numbers, |(x, y)| holds(arm, &x, &y)).unwrap();
    }
}

#[test]
fn the_joints_of_a_pose_are_found_at_their_free_joint() {
    for_all(60, |arm, x, _| {
        let q = arm.inside(x);
        let found = arm.at(&arm.target(&q), q[arm.free()]).unwrap();
        for solution in found.iter() {
            prop_assert!(arm.miss(solution.q, &q) < 1e-8, "{:?} misses that of {q:?}", solution.q);
            prop_assert!(
                (solution.q[arm.free()] - q[arm.free()]).rem_euclid(TAU).min(1.0) < 1e-12
                    || (q[arm.free()] - solution.q[arm.free()]).rem_euclid(TAU) < 1e-12
            );
        }
        let nearest = found.iter().map(|s| apart(arm, s.q, &q)).fold(f64::INFINITY, f64::min);
        prop_assert!(nearest < 1e-6, "{q:?} is {nearest:e} from the solutions");
        Ok(())
    });
}

#[test]
fn a_sweep_says_how_many_there_are_whatever_room_there_is() {
    for arm in ARMS.iter() {
        let q = arm.inside(&[0.4, 0.6, 0.3, 0.7, 0.45, 0.3, 0.8]);
        let target = arm.target(&q);
        let redundancy = arm.engine.redundancy(FULL_POSE).unwrap();
        assert_eq!(redundancy.samples().count(), SWEEP_SAMPLES);
        let limits = arm.engine.joints()[redundancy.joint].limits;
        assert!(redundancy.samples().all(|v| limits.is_none_or(|limits| limits.contains(v))));
        let counted: usize =
            redundancy.samples().map(|v| arm.at(&target, v).map_or(0, |set| set.len())).sum();
        let mut set = SolutionSet::new();
        arm.engine.ik_into(FULL_POSE, &target, &mut set).unwrap();
        assert_eq!(set.len() + set.dropped(), counted);
        assert!(set.iter().all(|solution| arm.miss(solution.q, &q) < 1e-8));
    }
}

/// The best of the allowed solutions at many values of the free joint.
fn densest(arm: &Arm, target: &Target, seed: &[f64], steps: u32) -> f64 {
    let joint = &arm.engine.joints()[arm.free()];
    let Limits { min, max } = joint.limits.unwrap_or(Limits { min: -PI, max: PI });
    let mut best = f64::INFINITY;
    for step in 0..=steps {
        let value = min + (max - min) * f64::from(step) / f64::from(steps);
        let Ok(mut set) = arm.at(target, value) else { continue };
        let point = |q: &[f64]| arm.engine.rules_point(q).unwrap();
        if set.within(&arm.engine.rules(), point, Some(seed)).is_ok() {
            best = set.iter().map(|solution| travel(solution.q, seed)).fold(best, f64::min);
        }
    }
    best
}

fn nearest(arm: &Arm, target: &Target, seed: &[f64]) -> Result<Vec<f64>, IkError> {
    let mut set = SolutionSet::new();
    arm.engine.ik_within(FULL_POSE, target, Some(seed), &mut set)?;
    let distances: Vec<f64> = set.iter().map(|solution| travel(solution.q, seed)).collect();
    assert!(distances.is_sorted(), "{distances:?}");
    Ok(set.get(0).unwrap().q.to_vec())
}

#[test]
fn the_nearest_is_no_farther_than_the_joints_of_the_pose_or_a_dense_sweep() {
    for_all(8, |arm, x, y| {
        let q = arm.inside(x);
        let target = arm.target(&q);
        for near in [0.02, 0.3] {
            let seed: Vec<f64> = q.iter().zip(y).map(|(q, y)| q + near * (y - 0.5)).collect();
            let found = nearest(arm, &target, &seed).unwrap();
            prop_assert!(arm.miss(&found, &q) < 1e-9);
            prop_assert!(arm.engine.check(&found).is_ok());
            let distance = travel(&found, &seed);
            prop_assert!(distance <= travel(&q, &seed) + 1e-9, "{found:?} for {q:?}, seed {seed:?}");
            let best = densest(arm, &target, &seed, 150);
            prop_assert!(distance <= best + 1e-9, "{distance} against {best} for {q:?}, seed {seed:?}");
        }
        Ok(())
    });
}

/// The joints turn all the way round on this curve while the free one moves by 0.03 rad, a quarter of the distance of two
/// samples.
#[test]
fn a_curve_between_two_samples_of_the_free_joint_is_found() {
    let arm = Arm::new(&offset_wrist(true, &[true, false, true, true, false, false, true]));
    let q = [-1.70693, -1.87885, -1.14262, -1.08752, 0.89064, 1.9304, -2.73842];
    let seed = [-1.64075, -2.02585, -1.28962, -1.02153, 0.88768, 1.7834, -2.88542];
    assert_eq!(arm.free(), 6);
    let found = nearest(&arm, &arm.target(&q), &seed).unwrap();
    assert!(arm.miss(&found, &q) < 1e-9 && arm.engine.check(&found).is_ok());
    let (distance, known) = (travel(&found, &seed), travel(&q, &seed));
    assert!(distance < known, "{distance} against {known}");
}

#[test]
fn a_seed_that_is_a_solution_is_returned() {
    for_all(30, |arm, x, _| {
        let q = arm.inside(x);
        let tool = arm.engine.fk(&q).unwrap();
        prop_assert_eq!(nearest(arm, &Target::Pose(tool), &q).unwrap(), q);
        Ok(())
    });
}

/// A free joint that stays where it is has one sample, whatever the target.
#[test]
fn a_free_joint_may_have_one_value() {
    let text = dh_robots::table("panda").unwrap().split("[poses]").next().unwrap();
    let (before, after) = text.split_once("name = \"J7\"").unwrap();
    let arm = Arm::new(&format!("{before}name = \"J7\"{}", after.replace("[-2.8973, 2.8973]", "[0, 0]")));
    assert_eq!(arm.engine.joints()[arm.free()].limits, Some(Limits { min: 0.0, max: 0.0 }));
    let q = [0.3, -0.5, 0.4, -1.9, 0.2, 1.7, 0.0];
    let target = arm.target(&q);
    let found = nearest(&arm, &target, &q.map(|q| q + 0.2)).unwrap();
    assert!(arm.miss(&found, &q) < 1e-9 && found[6] == 0.0, "{found:?}");
    let Target::Pose(pose) = target else { unreachable!() };
    let far = Target::Pose(Frame { translation: [2.0; 3], ..pose });
    assert!(nearest(&arm, &far, &q).is_err());
}

/// What narrow limits leave lies between the few samples of an arm without a closed form, and far from the seed.
#[test]
fn a_far_seed_does_not_hide_what_is_allowed() {
    let q = [80.78418, 14.907_915, -98.87311, 11.13875, 146.91786, -41.502_877, 126.373_991];
    let mut text = dh_robots::table("rizon4").unwrap().split("[poses]").next().unwrap().to_owned();
    for (limits, q) in
        ["[-165, 165]", "[-135, 135]", "[-175, 175]", "[-112, 159]", "[-175, 175]", "[-85, 265]"]
            .iter()
            .zip(q)
    {
        // The first that is left: those before it were replaced.
        text = text.replacen(limits, &format!("[{}, {}]", q - 15.0, q + 15.0), 1);
    }
    let (arm, q) = (Arm::new(&text), q.map(f64::to_radians));
    let seed = [-51.9, 89.7, 72.35, 60.35, -33.36, 36.64, -155.96].map(f64::to_radians);
    let found = nearest(&arm, &arm.target(&q), &seed).unwrap();
    assert!(arm.miss(&found, &q) < 1e-9, "{found:?}");
    for (value, joint) in found.iter().zip(arm.engine.joints()) {
        let Limits { min, max } = joint.limits.unwrap();
        assert!(min <= *value && *value <= max, "{} {found:?}", joint.name);
    }
}

/// Joints at multiples of a quarter turn, where axes are aligned and the arm is stretched.
#[test]
fn singular_poses_have_solutions_and_a_nearest_one() {
    for arm in ARMS.iter() {
        for number in (0..128_u32).step_by(5) {
            let quarter = |joint: u32| f64::from((number >> joint) & 1) * FRAC_PI_2;
            let mut q: Vec<f64> = (0..7).map(quarter).collect();
            for (value, joint) in q.iter_mut().zip(arm.engine.joints()) {
                *value = joint.limits.map_or(*value, |limits| limits.clamp(*value));
            }
            let target = arm.target(&q);
            let found = arm.at(&target, q[arm.free()]).unwrap_or_else(|error| panic!("{q:?}: {error}"));
            for solution in found.iter() {
                assert!(arm.miss(solution.q, &q) < 1e-6, "{q:?}");
                assert_eq!(solution.q[arm.free()], q[arm.free()], "as it was given, {q:?}");
            }
            let seed: Vec<f64> = q.iter().map(|q| q + 1e-3).collect();
            let near = nearest(arm, &target, &seed).unwrap_or_else(|error| panic!("{q:?}: {error}"));
            assert!(arm.miss(&near, &q) < 1e-6, "{q:?}");
        }
    }
}

#[test]
fn intervals_are_where_limits_are_kept() {
    for arm in ARMS.iter() {
        for x in [[0.4, 0.6, 0.3, 0.7, 0.45, 0.3, 0.8], [0.2, 0.5, 0.6, 0.3, 0.7, 0.6, 0.4]] {
            let target = arm.target(&arm.inside(&x));
            let redundancy = arm.engine.redundancy(FULL_POSE).unwrap();
            let point = |q: &[f64; 7]| arm.engine.rules_point(q).unwrap();
            let allowed = |value: f64| {
                let mut set = arm.at(&target, value).ok()?;
                set.within(&arm.engine.rules(), |q| arm.engine.rules_point(q).unwrap(), None).ok()
            };
            let at = |value: f64| {
                let mut solutions = None::<dh_core::Solutions<7>>;
                for found in arm.at(&target, value)?.iter() {
                    let q = <[f64; 7]>::try_from(found.q).unwrap();
                    let one = dh_core::Solution {
                        q,
                        position_error: 0.0,
                        rotation_error: 0.0,
                        free: None,
                        branch: dh_core::Branch::UNKNOWN,
                    };
                    match &mut solutions {
                        Some(solutions) => solutions.push(one, arm.engine.rules().windings),
                        None => solutions = Some(dh_core::Solutions::one(one)),
                    }
                }
                solutions.ok_or(IkError::NotFinite)
            };
            let mut intervals = [Limits { min: 0.0, max: 0.0 }; 32];
            let count = redundancy.intervals(at, point, &mut intervals);
            assert!(count > 0 && count <= intervals.len());
            for (index, Limits { min, max }) in intervals[..count].iter().enumerate() {
                assert!(min <= max && (index == 0 || intervals[index - 1].max < *min));
                assert!(allowed(*min).is_some() && allowed(*max).is_some(), "{min} {max}");
                let step = (max - min) / 4.0;
                assert!((1..4).filter(|k| allowed(min + f64::from(*k) * step).is_some()).count() >= 2);
            }
        }
    }
}

/// A joint that the table leaves to the caller, whichever it is, with constraints and other targets besides.
#[test]
fn tables_name_their_free_joints() {
    let arm =
        |entry: &str| Arm::new(&format!("{}{entry}", spherical_roll_spherical(0.0, false, &[false; 7])));
    for (joint, name) in ["J1", "J2", "J3", "J5", "J6", "J7"].iter().enumerate() {
        let joint = if joint > 2 { joint + 1 } else { joint };
        let arm = arm(&format!("[[ik]]\nname = \"held\"\ntarget = \"pose\"\nfree = [\"{name}\"]\n"));
        let q = [0.3, -0.5, 0.7, 1.1, -0.4, 0.6, 0.2];
        let mut set = SolutionSet::new();
        arm.engine.ik_at_into("held", &arm.target(&q), &[q[joint]], &mut set).unwrap();
        assert!(set.iter().any(|solution| apart(&arm, solution.q, &q) < 1e-9), "{name}");
        assert!(set.iter().all(|solution| arm.miss(solution.q, &q) < 1e-9), "{name}");
        let wrong = arm.engine.ik_at_into("held", &arm.target(&q), &[], &mut set);
        assert!(matches!(wrong, Err(IkError::Length(_))) && set.is_empty());
    }
    let straight =
        spherical_roll_spherical(0.0, false, &[false; 7]).replace("[0.01, -0.02, 0.1]", "[0, 0, 0.1]");
    let arm = Arm::new(&format!(
        "{straight}[[ik]]\nname = \"reach\"\ntarget = \"position\"\nfree = [\"J3\"]\n\
         constraints = [\"q5 = 0\", \"q6 = 0\", \"q7 = 20\"]\n"
    ));
    let q = [0.3, -0.5, 0.7, 1.1, 0.0, 0.0, PI / 9.0];
    let Target::Pose(pose) = arm.target(&q) else { unreachable!() };
    let mut set = SolutionSet::new();
    arm.engine.ik_at_into("reach", &Target::Position(pose.translation), &[0.7], &mut set).unwrap();
    assert!(set.iter().any(|solution| apart(&arm, solution.q, &q) < 1e-9));
    assert!(set.iter().all(|solution| (solution.q[6] - q[6]).abs() < 1e-12));
}
