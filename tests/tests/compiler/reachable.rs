//! The nearest target that can be reached, where the one asked for can't be.

use dh_core::{FULL_POSE, Frame, Limits, SolutionSet, Target};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use std::f64::consts::PI;

/// Two links of 0.3 and 0.2 m about the same axis, without limits: a ring.
const RING: &str = "[robot]\nname = \"ring\"\nconvention = \"standard\"\n[[joint]]\na = 0.3\n[[joint]]\na = 0.2\n\
    [[ik]]\nname = \"xy\"\ntarget = \"xy\"\n";

/// The same, of which the first joint stops at 0.5 rad, and the second one stays where it is.
const STOPPED: &str = "[robot]\nname = \"stopped\"\nconvention = \"standard\"\n[[joint]]\na = 0.3\nlimits = [-0.5, 0.5]\n\
    [[joint]]\na = 0.2\nlimits = [-1e-9, 1e-9]\n[[ik]]\nname = \"xy\"\ntarget = \"xy\"\n";

#[test]
fn the_nearest_point_of_a_ring_is_on_the_line_to_its_middle() {
    let arm = engine::interpreter(RING).unwrap();
    for (radius, nearest) in [(0.7, 0.5), (5.0, 0.5), (0.04, 0.1), (0.3, 0.3)] {
        for step in 0..12 {
            let (sin, cos) = (f64::from(step) * PI / 6.0 + 0.1).sin_cos();
            let found = arm.nearest_reachable("xy", &Target::Xy([radius * cos, radius * sin]), None).unwrap();
            let [x, y, _] = found.tool.translation;
            let off = (x - nearest * cos).hypot(y - nearest * sin);
            assert!(off < 1e-6, "at {radius} m: {off:e} m off");
            assert!((found.position_error - f64::abs(radius - nearest)).abs() < 1e-9);
        }
    }
}

#[test]
fn limits_are_kept() {
    let arm = engine::interpreter(STOPPED).unwrap();
    let found = arm.nearest_reachable("xy", &Target::Xy([0.1, 0.6]), Some(&[-0.4, 0.0])).unwrap();
    let [q1, q2] = found.q() else { panic!("two joints") };
    assert!(*q1 <= 0.5 && *q1 > 0.5 - 1e-9 && q2.abs() <= 1e-9, "{q1} {q2}");
}

#[test]
fn limits_on_sums_are_kept_too() {
    let text = "[robot]\nname = \"sum\"\nconvention = \"standard\"\n[[joint]]\na = 0.3\nlimits = [-1.5, 1.5]\n\
        [[joint]]\na = 0.3\nlimits = [-2.5, 2.5]\n[[limit]]\nof = { J1 = 1, J2 = 1 }\nrange = [0, 0.3]\n\
        [[ik]]\nname = \"xy\"\ntarget = \"xy\"\n";
    let arm = engine::interpreter(text).unwrap();
    for target in [[0.0, 1.2], [0.5, -0.4], [-0.7, 0.1]] {
        let found = arm.nearest_reachable("xy", &Target::Xy(target), None).unwrap();
        let [q1, q2] = found.q() else { panic!("two joints") };
        assert!((0.0..=0.3).contains(&(q1 + q2)) && q1.abs() <= 1.5 && q2.abs() <= 2.5, "{q1} {q2}");
        // No joint values that are allowed come nearer.
        let steps = |limit: f64| (-60..=60).map(move |k| limit * f64::from(k) / 60.0);
        let all = steps(1.5).flat_map(|q1| steps(2.5).map(move |q2| [q1, q2]));
        for q in all.filter(|q| (0.0..=0.3).contains(&(q[0] + q[1]))) {
            let [x, y, _] = arm.fk(&q).unwrap().translation;
            let off = (x - target[0]).hypot(y - target[1]);
            assert!(off >= found.position_error - 1e-6, "{q:?} is nearer");
        }
    }
}

#[test]
fn half_a_turn_off_is_as_far_as_can_be() {
    // A wrist that tilts by 60 degrees at most.
    let text = "[robot]\nname = \"tilt\"\nconvention = \"standard\"\n[[joint]]\nalpha = \"-pi/2\"\nlimits = [-3, 3]\n\
        [[joint]]\nalpha = \"pi/2\"\nlimits = [\"-pi/3\", \"pi/3\"]\n[[ik]]\nname = \"dir\"\ntarget = \"direction\"\n";
    let arm = engine::interpreter(text).unwrap();
    for direction in [[0.0, 0.0, -1.0], [0.0, 0.001, -1.0]] {
        let found = arm.nearest_reachable("dir", &Target::Direction(direction), None).unwrap();
        assert!(
            (found.rotation_error - 2.0 * PI / 3.0).abs() < 2e-3,
            "{direction:?}: {}",
            found.rotation_error
        );
    }
}

#[test]
fn joints_without_limits_make_no_needless_turns() {
    let arm = engine::shipped("jaco2").unwrap();
    let target = Target::Pose(Frame::from_translation([5.0, 0.0, 0.0]));
    let found = arm.nearest_reachable(FULL_POSE, &target, None).unwrap();
    for (value, joint) in found.q().iter().zip(arm.joints()) {
        assert!(joint.limits.is_some() || value.abs() <= PI + 1e-9, "{} {:?}", joint.name, found.q());
    }
}

/// The same numbers on every run.
struct Random(u64);

impl Random {
    /// In -1 ... 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 23) - 1.0
    }
}

/// Poses that can be reached are their own nearest; of those that can't, no pose of joint values nearby, or drawn at
/// random, is nearer than the one found.
#[test]
fn nothing_nearby_is_nearer() {
    let mut random = Random(5);
    for name in ["ur5", "puma560", "crx10ia_l", "panda", "irb120"] {
        let (oracle, arm) = (Oracle::shipped(name).unwrap(), engine::shipped(name).unwrap());
        let whole = Limits { min: -PI, max: PI };
        let limits: Vec<_> = arm.joints().iter().map(|joint| joint.limits.unwrap_or(whole)).collect();
        let frame = |q: &[f64]| {
            let [x, y, z, _] = oracle.fk(q);
            let rows = [x, y, z].map(|[a, b, c, p]| ([a, b, c], p));
            Frame { rotation: rows.map(|row| row.0), translation: rows.map(|row| row.1) }
        };
        let mut any = || -> Vec<f64> {
            let inside = |l: &Limits| l.min + f64::midpoint(random.next(), 1.0) * (l.max - l.min);
            limits.iter().map(inside).collect()
        };
        // The way from frame to frame in the middle of the limits: the measure of lengths.
        let mut frames = [Frame::IDENTITY; 16];
        let middle: Vec<f64> = arm.joints().iter().map(|j| j.limits.map_or(0.0, |l| l.middle())).collect();
        let count = arm.frames_into(&middle, &mut frames).unwrap();
        frames[count] = arm.fk(&middle).unwrap();
        let size: f64 = frames[..=count]
            .windows(2)
            .map(|pair| {
                let [a, b] = [pair[0].translation, pair[1].translation];
                a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
            })
            .sum();
        for number in 0..6 {
            let mut pose = frame(&any());
            let reached = arm.nearest_reachable(FULL_POSE, &Target::Pose(pose), None).unwrap();
            assert!(reached.position_error < 1e-6 && reached.rotation_error < 1e-6, "{name}: {reached:?}");
            pose.translation = pose.translation.map(|x| x * (3.0 + f64::from(number)));
            let target = Target::Pose(pose);
            let found = arm.nearest_reachable(FULL_POSE, &target, None).unwrap();
            let mut set = SolutionSet::new();
            // What was found can be asked for.
            arm.ik_within(FULL_POSE, &Target::Pose(found.tool), Some(found.q()), &mut set).unwrap();
            let miss = |q: &[f64]| {
                let (position, rotation) = target.errors(&frame(q));
                (position / size).powi(2) + rotation.powi(2)
            };
            let least = miss(found.q());
            for number in 0..300 {
                let any = any();
                let away = [1.0, 0.03, 0.001][number % 3];
                let between = any.iter().zip(found.q()).map(|(any, own)| own + away * (any - own));
                let q: Vec<f64> = between.zip(&limits).map(|(value, limits)| limits.clamp(value)).collect();
                assert!(miss(&q) > (1.0 - 1e-9) * least, "{name}: {:e} at {q:?}", 1.0 - miss(&q) / least);
            }
        }
    }
}

#[test]
fn the_workspace_is_kept() {
    let text = "[robot]\nname = \"kept\"\nconvention = \"standard\"\n[workspace]\nz_min = 0.1\n\
        keep_out = [{ min = [0.3, -0.2, 0.2], max = [0.6, 0.2, 2] }]\n\
        [[joint]]\nd = 0.3\nalpha = \"pi/2\"\nlimits = [-1, 1]\n[[joint]]\na = 0.4\nlimits = [-1.2, 1.7]\n\
        [[joint]]\na = 0.3\nlimits = [0, 2.6]\n[[ik]]\nname = \"pos\"\ntarget = \"position\"\n";
    let arm = engine::interpreter(text).unwrap();
    for target in [[0.4, 0.1, 0.4], [0.45, 0.0, 0.5], [0.0, 0.0, 0.8], [0.5, 0.1, -0.1], [0.2, 0.1, 0.1]] {
        let found = arm.nearest_reachable("pos", &Target::Position(target), None).unwrap();
        assert!(arm.rules().check(found.q(), found.tool.translation).is_ok(), "{target:?}: {found:?}");
        // No joint values that are allowed come nearer.
        let steps = |[min, max]: [f64; 2]| (0..=50).map(move |k| min + (max - min) * f64::from(k) / 50.0);
        for q1 in steps([-1.0, 1.0]) {
            for q2 in steps([-1.2, 1.7]) {
                for q3 in steps([0.0, 2.6]) {
                    let q = [q1, q2, q3];
                    let point = arm.fk(&q).unwrap().translation;
                    let off: f64 = point.iter().zip(target).map(|(a, b)| (a - b) * (a - b)).sum();
                    let nearer = off.sqrt() < found.position_error - 1e-6;
                    assert!(!nearer || arm.rules().check(&q, point).is_err(), "{target:?}: {q:?} is nearer");
                }
            }
        }
    }
}

#[test]
fn limits_and_workspace_are_kept_however_far_the_target_is() {
    let text = "[robot]\nname = \"far\"\nconvention = \"standard\"\n[workspace]\nz_max = 0.5\n\
        [[joint]]\nd = 0.3\nalpha = \"pi/2\"\nlimits = [-1, 1]\n[[joint]]\na = 0.4\nlimits = [-0.3, 1.7]\n\
        [[joint]]\na = 0.3\nlimits = [0, 2.6]\n[[limit]]\nof = { J2 = 1, J3 = 1 }\nrange = [-0.2, 2]\n\
        [[ik]]\nname = \"pos\"\ntarget = \"position\"\n";
    let arm = engine::interpreter(text).unwrap();
    for target in
        [[0.1, 0.0, 30.0], [0.3, 0.1, 200.0], [-20.0, 0.0, 20.0], [-200.0, 0.0, 3.0], [9.0, 9.0, 0.6]]
    {
        let found = arm.nearest_reachable("pos", &Target::Position(target), None).unwrap();
        assert!(arm.rules().check(found.q(), found.tool.translation).is_ok(), "{target:?}: {found:?}");
    }
}

/// Constraints of the table's problem hold at what is found.
#[test]
fn constraints_are_kept() {
    let arm = engine::shipped("mycobot").unwrap();
    for target in [[0.5, 0.1, 0.2], [0.0, 0.0, 0.6], [-0.3, -0.4, -0.1]] {
        let found = arm.nearest_reachable("tool_down", &Target::Position(target), None).unwrap();
        let q = found.q();
        // theta = q + (0, 90, 0, 90, -90, 0) degrees, see `inverse`.
        let down = (q[1] + q[2] + q[3] + PI / 2.0).sin().abs();
        assert!(down < 1e-6 && q[4].abs() < 1e-6 && (q[5] - q[0]).sin().abs() < 1e-6, "{q:?}");
        for (value, joint) in q.iter().zip(arm.joints()) {
            let limits = joint.limits.unwrap();
            assert!(limits.min <= *value && *value <= limits.max, "{} {q:?}", joint.name);
        }
        assert!(found.position_error > 0.01);
    }
}
