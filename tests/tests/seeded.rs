//! Solutions near a seed where the target leaves a joint free: the joint is at the seed's value, and so the seed itself is
//! found wherever it is a solution.

use dh_core::{FULL_POSE, Frame, IkError, Kinematics, SolutionSet, Target};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_2, PI};

/// The same numbers on every run.
struct Random(u64);

impl Random {
    /// In 0 ... 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 24)
    }
}

fn target_of(oracle: &Oracle, q: &[f64]) -> Target {
    let [x, y, z, _] = oracle.fk(q);
    let rows = [x, y, z].map(|[a, b, c, p]| ([a, b, c], p));
    Target::Pose(Frame { rotation: rows.map(|row| row.0), translation: rows.map(|row| row.1) })
}

/// The greatest difference of two sets of joint values.
fn apart(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Joint values of which each third is at a multiple of a quarter turn, so that axes are aligned, and the others anywhere.
fn lattice(random: &mut Random, arm: &dyn Kinematics) -> Vec<f64> {
    let value = |joint: &dh_core::Joint<'_>| {
        let limits = joint.limits.unwrap_or(dh_core::Limits { min: -PI, max: PI });
        let (min, max) = (limits.min.max(-PI), limits.max.min(PI));
        let any = min + random.unit() * (max - min);
        let quarters = (any / FRAC_PI_2).round() * FRAC_PI_2;
        if random.unit() < 0.6 && quarters > min && quarters < max { quarters } else { any }
    };
    arm.joints().iter().map(value).collect()
}

/// Arms of every way in which a full pose is solved in closed form.
const ARMS: [&str; 9] =
    ["puma560", "ur5e", "irb120", "stanford", "vs068", "tx2_60", "lite6", "kr6_r900", "gp7"];

#[test]
fn a_seed_that_is_a_solution_is_found_though_the_target_leaves_joints_free() {
    let mut random = Random(7);
    for name in ARMS {
        let (oracle, arm) = (Oracle::shipped(name).unwrap(), engine::shipped(name).unwrap());
        let mut free = 0;
        for _ in 0..300 {
            let q = lattice(&mut random, &*arm);
            let target = target_of(&oracle, &q);
            let mut set = SolutionSet::new();
            match arm.ik_within(FULL_POSE, &target, Some(&q), &mut set) {
                // The seed keeps the limits of its joints, but perhaps not the other rules.
                Err(IkError::Forbidden { .. }) if arm.check(&q).is_err() => continue,
                outcome => outcome.unwrap_or_else(|error| panic!("{name} at {q:?}: {error}")),
            }
            free += u32::from(set.iter().any(|solution| solution.free.is_some()));
            let nearest = set.nearest(&q).unwrap();
            // An arm that is straight is at a double root, which is known to half of the digits.
            assert!(apart(nearest.q, &q) < 1e-5, "{name} at {q:?}: {:?}", nearest.q);
            let off = oracle.fk(nearest.q);
            let off = apart(off.as_flattened(), oracle.fk(&q).as_flattened());
            assert!(off < 1e-9, "{name} at {q:?}: {off:e}");
        }
        assert!(free > 20, "{name}: {free} poses left a joint free");
    }
}

/// Axes 4 and 6 are aligned, and their joints stop at 100 degrees: of the sum of 150 degrees, neither can take all.
const STOPS: &str = "[robot]\nname = \"stops\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n\
    [[joint]]\nd = 0.4\nalpha = 90\nlimits = [-80, 80]\n[[joint]]\na = 0.4\nlimits = [-80, 0]\n[[joint]]\nalpha = 90\nlimits = [0, 90]\n\
    [[joint]]\nd = 0.4\nalpha = -90\nlimits = [-100, 100]\n[[joint]]\nalpha = 90\n[[joint]]\nd = 0.1\nlimits = [-100, 100]\n";

#[test]
fn a_free_joint_goes_aside_for_the_limits_of_another() {
    let (oracle, arm) = (Oracle::read(STOPS).unwrap(), engine::interpreter(STOPS).unwrap());
    let q = [0.3, -0.7, 1.1, 75_f64.to_radians(), 0.0, 75_f64.to_radians()];
    let target = target_of(&oracle, &q);
    let mut set = SolutionSet::new();
    for seed in
        [None, Some([0.0; 6]), Some([0.3, -0.7, 1.1, 1.7, 0.0, 1.7]), Some([0.0, 0.0, 0.0, -1.7, 0.0, 0.0])]
    {
        arm.ik_within(FULL_POSE, &target, seed.as_ref().map(<[f64; 6]>::as_slice), &mut set).unwrap();
        assert!(!set.is_empty() && set.iter().all(|solution| arm.check(solution.q).is_ok()));
        assert!(set.iter().any(|solution| solution.free.is_some()), "{seed:?}");
    }
}

/// Both links are of one length: at the axis of the first joint, it may have any value.
const FOLDED: &str = "[robot]\nname = \"folded\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n\
    [[joint]]\na = 0.5\noffset = 30\ndirection = -1\n[[joint]]\na = 0.5\n\
    [[ik]]\nname = \"xy\"\ntarget = \"xy\"\n";

#[test]
fn a_problem_of_the_table_takes_the_value_of_the_seed() {
    let arm = engine::interpreter(FOLDED).unwrap();
    let mut set = SolutionSet::new();
    for first in [-2.9, -1.0, 0.0, 0.4, 3.1] {
        arm.ik_within("xy", &Target::Xy([0.0; 2]), Some(&[first, 3.0]), &mut set).unwrap();
        let solution = set.nearest(&[first, 3.0]).unwrap();
        assert_eq!(solution.free, Some(0));
        assert!(apart(solution.q, &[first, PI]) < 1e-12, "{first}: {:?}", solution.q);
    }
}
