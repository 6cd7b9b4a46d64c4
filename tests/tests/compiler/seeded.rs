//! Solutions near a seed where the target leaves a joint free: the joint is at the seed's value, and so the seed itself is
//! found wherever it is a solution.

use dh_core::{FULL_POSE, Frame, IkError, Kinematics, Seed, SolutionSet, Target};
use dh_runtime::nalgebra::{SMatrix, SVector};
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

/// Where the arm is next to straight, or the wrist next to the first axis, the steps before leave more than rounding of an
/// aligned wrist.
#[test]
fn an_aligned_wrist_is_free_wherever_the_arm_is() {
    let mut random = Random(11);
    let mut bent = 0;
    for name in ["puma560", "irb120", "kr6_r900", "tx2_60"] {
        let (oracle, arm) = (Oracle::shipped(name).unwrap(), engine::shipped(name).unwrap());
        for _ in 0..1500 {
            let mut q: Vec<f64> = (0..6).map(|_| PI * (2.0 * random.unit() - 1.0)).collect();
            q[4] = 0.0;
            let mut set = SolutionSet::new();
            let seed = Some(Seed::new(&q));
            arm.ik_seeded_into(FULL_POSE, &target_of(&oracle, &q), &[], seed, &mut set).unwrap();
            let nearest = set.nearest(&q).unwrap();
            let found = apart(nearest.q, &q) < 1e-6 && nearest.free.is_some();
            // A joint next to a double root is known to half of the digits; what it leaves of the wrist is an angle.
            assert!(found || nearest.q[4].abs() > 1e-11, "{name} at {q:?}: {:?}", nearest.q);
            bent += u32::from(!found);
        }
    }
    assert!(bent <= 3, "{bent} of 6000");
}

/// A spherical wrist behind an elbow, upper arm and forearm of 0.4 and 0.35 m.
const ELBOW_AND_WRIST: &str = "[robot]\nname = \"elbow\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n\
    [[joint]]\nd = 0.3\nalpha = -90\n[[joint]]\na = 0.4\n[[joint]]\nd = 0.05\nalpha = -90\n[[joint]]\nd = 0.35\nalpha = 90\n\
    [[joint]]\nalpha = -90\n[[joint]]\nd = 0.1\n";

/// Next to the stretched elbow, what steps leave of an aligned wrist is far more than rounding: it is marked all the same, and a
/// seed that is a solution is found.
#[test]
fn an_aligned_wrist_is_free_next_to_a_stretched_elbow() {
    let mut random = Random(12);
    let (oracle, arm) =
        (Oracle::read(ELBOW_AND_WRIST).unwrap(), engine::interpreter(ELBOW_AND_WRIST).unwrap());
    for gap in [0.0, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3] {
        for _ in 0..40 {
            let mut q: Vec<f64> = (0..6).map(|_| PI * (2.0 * random.unit() - 1.0)).collect();
            (q[2], q[4]) = (-FRAC_PI_2 + gap, 0.0);
            let target = target_of(&oracle, &q);
            let mut set = SolutionSet::new();
            arm.ik_seeded_into(FULL_POSE, &target, &[], Some(Seed::new(&q)), &mut set).unwrap();
            let nearest = set.nearest(&q).unwrap();
            let known = 1e-6 + 3e-15 / f64::max(gap, 1e-9);
            assert!(apart(nearest.q, &q) < known, "{gap:e} at {q:?}: {:?}", nearest.q);
            assert!(nearest.free.is_some(), "{gap:e} at {q:?}: {:?}", nearest.q);
            // Elbows that are nearer to each other are one curve up to rounding, or next to one.
            if !(1e-9..1e-4).contains(&gap) {
                arm.ik_into(FULL_POSE, &target, &mut set).unwrap();
                let marked = set.iter().filter(|solution| solution.free.is_some()).count();
                assert!((1..=2).contains(&marked), "{gap:e} at {q:?}: {set:?}");
            }
        }
    }
}

/// With the tool straight down in the plane of the first axis an equation of the last joint says nothing, but the arm stands
/// still: others say it.
#[test]
fn a_solution_that_stands_alone_is_not_marked() {
    let arm = engine::shipped("iiwa14").unwrap();
    let rotation = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    let target = Target::Pose(Frame { rotation, translation: [-0.4, 0.0, -0.186] });
    let mut set = SolutionSet::new();
    arm.ik_at_into(FULL_POSE, &target, &[0.0], &mut set).unwrap();
    assert!(set.len() > 1 && set.iter().all(|solution| solution.free.is_none()));
    // Stretched out upwards, joints 1, 3, 5 and 7 are on one line.
    let target = target_of(&Oracle::shipped("iiwa14").unwrap(), &[0.3, 0.0, 0.0, 0.0, 0.2, 0.0, 0.1]);
    arm.ik_at_into(FULL_POSE, &target, &[0.0], &mut set).unwrap();
    assert!(set.iter().all(|solution| solution.free.is_some()));
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

/// Axes 4 and 6 are one where theta5 is half a turn, and meet in no point otherwise: an arm without a closed form.
const OFFSET_WRIST: &str = "[robot]\nname = \"offset wrist\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n\
    [[joint]]\nd = 0.4\na = 0.05\nalpha = -90\n[[joint]]\na = 0.4\n[[joint]]\na = 0.05\nalpha = -90\n\
    [[joint]]\nd = 0.4\na = 0.1\nalpha = 90\n[[joint]]\na = 0.1\nalpha = -90\n[[joint]]\nd = 0.1\n";

#[test]
fn a_curve_of_solutions_is_marked_where_all_joints_are_found_at_once() {
    let (oracle, arm) = (Oracle::read(OFFSET_WRIST).unwrap(), engine::interpreter(OFFSET_WRIST).unwrap());
    let mut random = Random(3);
    let mut set = SolutionSet::new();
    for number in 0..40 {
        let mut q = [0; 6].map(|_| PI * (2.0 * random.unit() - 1.0));
        if number % 2 == 0 {
            q = q.map(|value| (value / FRAC_PI_2).round() * FRAC_PI_2);
        }
        q[4] = PI;
        let target = target_of(&oracle, &q);
        arm.ik_into(FULL_POSE, &target, &mut set).unwrap();
        let marked = set.iter().filter(|solution| solution.free.is_some()).count();
        assert!((1..=8).contains(&marked), "{q:?}: {marked} of {} are free", set.len());
        assert_eq!(set.dropped(), 0, "{q:?}");
        arm.ik_within(FULL_POSE, &target, Some(&q), &mut set).unwrap();
        let nearest = set.nearest(&q).unwrap();
        assert!(apart(nearest.q, &q) < 1e-6, "{q:?}: {:?}", nearest.q);
        assert!(nearest.free.is_some(), "{q:?}");
        for solution in set.iter() {
            let off = apart(oracle.fk(solution.q).as_flattened(), oracle.fk(&q).as_flattened());
            assert!(off < 1e-9, "{q:?}: {off:e}");
        }
    }
    // Nothing is free anywhere else.
    for _ in 0..40 {
        let q = [0; 6].map(|_| PI * (2.0 * random.unit() - 1.0));
        arm.ik_into(FULL_POSE, &target_of(&oracle, &q), &mut set).unwrap();
        assert!(set.iter().all(|solution| solution.free.is_none()), "{q:?}");
    }
}

/// Whether the arm can move from there while its tool stays, by the oracle's poses alone.
fn moves_by_itself(oracle: &Oracle, q: &[f64; 6]) -> bool {
    let pose = |q: &[f64; 6]| SVector::<f64, 16>::from_iterator(oracle.fk(q).as_flattened().iter().copied());
    let jacobian = |q: &[f64; 6]| {
        let column = |joint: usize| {
            let at = |step: f64| {
                let mut q = *q;
                q[joint] += step;
                pose(&q)
            };
            (at(1e-6) - at(-1e-6)) / 2e-6
        };
        SMatrix::<f64, 16, 6>::from_columns(&[0, 1, 2, 3, 4, 5].map(column)).svd(true, true)
    };
    let target = pose(q);
    // To the tool's pose by the shortest way, and how far it stays off.
    let back = |mut q: [f64; 6]| {
        for _ in 0..40 {
            let step = jacobian(&q).solve(&(target - pose(&q)), 1e-3);
            let Ok(step) = step else { return (q, f64::INFINITY) };
            q.iter_mut().zip(&step).for_each(|(value, change)| *value += change);
        }
        (q, (target - pose(&q)).amax())
    };
    let here = jacobian(q);
    let Some(rows) = here.v_t else { return false };
    let idle = (0..6).filter(|&row| here.singular_values[row] < 1e-6);
    idle.flat_map(|row| [(row, 1.0), (row, -1.0)]).any(|(row, side)| {
        [0.03, 0.08].iter().all(|&length| {
            let mut moved = *q;
            moved
                .iter_mut()
                .zip(rows.row(row).iter())
                .for_each(|(value, part)| *value += side * length * part);
            let (end, off) = back(moved);
            let gone: f64 = (0..6).map(|joint| side * (end[joint] - q[joint]) * rows[(row, joint)]).sum();
            off < 1e-11 && gone > 0.7 * length
        })
    })
}

#[test]
fn wherever_the_arm_moves_by_itself_a_solution_is_marked() {
    let mut random = Random(9);
    let (mut idle, mut all) = (0, 0);
    for name in ["crx10ia_l", "jaco2", "manocha_canny", "gofa5", "offset wrist"] {
        let text = dh_robots::table(name).unwrap_or(OFFSET_WRIST);
        let (oracle, arm) = (Oracle::read(text).unwrap(), engine::interpreter(text).unwrap());
        let mut set = SolutionSet::new();
        for _ in 0..40 {
            let q = [0; 6].map(|_| FRAC_PI_2 * (4.0 * random.unit() - 2.0).round());
            all += 1;
            if moves_by_itself(&oracle, &q) {
                idle += 1;
                arm.ik_into(FULL_POSE, &target_of(&oracle, &q), &mut set).unwrap();
                assert!(set.iter().any(|solution| solution.free.is_some()), "{name} at {q:?}");
            }
        }
    }
    assert!(idle > 20 && idle < all, "{idle} of {all}");
}
