//! Every problem of every shipped table, there and back: the target of known joint values, made by the oracle, gives
//! these values again, and whatever else it gives reaches the target by the oracle too.

use dh_core::{Kinematics, ProblemInfo, SolutionSet, Target, TargetKind};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use std::f64::consts::{FRAC_PI_2, PI};

/// Joint values that keep the constraints of a problem, from free ones in -1 ... 1.
type Constrain = fn([f64; 7]) -> Vec<f64>;

/// (table, problem, its constraints, written out once more by hand)
const PROBLEMS: &[(&str, &str, Constrain)] = &[
    ("crane_x7", "planar", |x| vec![PI * x[0], PI * x[1], 0.0, PI * x[2], 0.0, 0.0, 0.0]),
    ("crane_x7", "wrist_down", |x| {
        vec![PI * x[0], PI * x[1], 0.0, PI * x[2], 0.0, -PI - PI * (x[1] + x[2]), 0.0]
    }),
    ("crane_x7_2r", "xy", |x| vec![PI * x[0], PI * x[1]]),
    ("crane_x7_2r", "xy_elbow_up", |x| vec![PI * x[0], -PI * x[1].abs()]),
    ("cylindrical", "reach", |x| vec![PI * x[0], x[1], x[2], 0.0, 0.0, 0.0]),
    ("elbow3r", "position", |x| vec![PI * x[0], PI * x[1], PI * x[2]]),
    ("elbow3r", "position_elbow_up", |x| vec![PI * x[0], PI * x[1], -PI * x[2].abs()]),
    // theta = q + (0, 90, 0, 90, -90, 0) degrees.
    ("mycobot", "tool_down", |x| {
        vec![PI * x[0], PI * x[1], PI * x[2], -FRAC_PI_2 - PI * (x[1] + x[2]), 0.0, PI * x[0]]
    }),
    ("mycobot", "tool_down_elbow_up", |x| {
        let q3 = -PI * x[2].abs();
        vec![PI * x[0], PI * x[1], q3, -FRAC_PI_2 - PI * x[1] - q3, 0.0, PI * x[0]]
    }),
    ("panda", "tool_down", |x| {
        vec![PI * x[0], PI * x[1], 0.0, PI * x[2], 0.0, PI * (x[1] - x[2]), PI * x[3]]
    }),
    ("planar2r", "xy", |x| vec![PI * x[0], PI * x[1]]),
    ("planar2r", "xy_elbow_up", |x| vec![PI * x[0], -PI * x[1].abs()]),
    ("planar2r", "xy_elbow_down", |x| vec![PI * x[0], PI * x[1].abs()]),
    ("puma560", "tool_down", |x| {
        vec![PI * x[0], PI * x[1], PI * x[2], 0.0, -PI - PI * (x[1] + x[2]), PI * x[3]]
    }),
    ("rh6frh5520", "place", |x| vec![PI * x[0], PI * x[1], 0.2 * x[2], PI * x[3]]),
    ("rtm2r", "xy", |x| vec![PI * x[0], PI * x[1]]),
    ("rtm2r", "xy_elbow_right", |x| vec![PI * x[0], PI * x[1].abs()]),
    ("rtm2r", "xy_elbow_left", |x| vec![PI * x[0], -PI * x[1].abs()]),
    ("scara", "place", |x| vec![PI * x[0], PI * x[1], 0.2 * x[2], PI * x[3]]),
    ("uarm_swift_pro", "place", |x| vec![PI * x[0], PI * x[1], PI * x[2], PI * x[3]]),
    ("ur5", "tool_down", |x| {
        vec![PI * x[0], PI * x[1], PI * x[2], -FRAC_PI_2 - PI * (x[1] + x[2]), -FRAC_PI_2, PI * x[3]]
    }),
    ("ur5e", "tool_down", |x| {
        vec![PI * x[0], PI * x[1], PI * x[2], -FRAC_PI_2 - PI * (x[1] + x[2]), -FRAC_PI_2, PI * x[3]]
    }),
    ("vs068", "tool_down", |x| {
        vec![PI * x[0], PI * x[1], PI * x[2], 0.0, PI - PI * (x[1] + x[2]), PI * x[3]]
    }),
];

fn target_of(kind: TargetKind, pose: &[[f64; 4]; 4]) -> Option<Target> {
    let position = [pose[0][3], pose[1][3], pose[2][3]];
    Some(match kind {
        TargetKind::Position => Target::Position(position),
        TargetKind::PositionYaw => Target::PositionYaw { position, yaw: pose[1][0].atan2(pose[0][0]) },
        TargetKind::Xy => Target::Xy([pose[0][3], pose[1][3]]),
        _ => return None,
    })
}

/// Greatest difference of two sets of joint values, where whole turns of a revolute joint count for nothing.
fn apart(oracle: &Oracle, left: &[f64], right: &[f64]) -> f64 {
    let chain = oracle.chain();
    let joints = chain.joints.iter().map(|&row| chain.rows[row].prismatic);
    let differences = left.iter().zip(right).zip(joints).map(|((a, b), prismatic)| {
        if prismatic { (a - b).abs() } else { ((a - b + PI).rem_euclid(2.0 * PI) - PI).abs() }
    });
    differences.fold(0.0, f64::max)
}

/// Numbers that a target of this kind prescribes.
fn prescribed(kind: TargetKind, pose: &[[f64; 4]; 4]) -> Vec<f64> {
    match kind {
        TargetKind::Xy => vec![pose[0][3], pose[1][3]],
        TargetKind::PositionYaw => vec![pose[0][3], pose[1][3], pose[2][3], pose[0][0], pose[1][0]],
        _ => vec![pose[0][3], pose[1][3], pose[2][3]],
    }
}

fn there_and_back(
    engine: &dyn Kinematics,
    oracle: &Oracle,
    problem: &ProblemInfo<'_>,
    q: &[f64],
) -> Result<(), String> {
    let pose = oracle.fk(q);
    let target = target_of(problem.target, &pose).ok_or("a kind of target without a test")?;
    let mut set = SolutionSet::new();
    engine.ik_into(problem.name, &target, &mut set).map_err(|error| format!("{error} for {q:?}"))?;
    let expected = prescribed(problem.target, &pose);
    for solution in set.iter() {
        let found = prescribed(problem.target, &oracle.fk(solution.q));
        let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if !(off < 1e-9 && solution.residual() < 1e-9) {
            return Err(format!("{:?} misses by {off:e} of {q:?}", solution.q));
        }
    }
    let nearest = set.iter().map(|solution| apart(oracle, solution.q, q)).fold(f64::INFINITY, f64::min);
    // Close to a singular pose, joint values are known to the root of the rounding only.
    if nearest < 1e-7 { Ok(()) } else { Err(format!("{q:?} is not among the solutions: {nearest:e} off")) }
}

#[test]
fn every_problem_gives_back_the_joints_that_made_its_target() {
    for name in dh_robots::names() {
        let (oracle, engine) = (Oracle::shipped(name).unwrap(), engine::shipped(name).unwrap());
        for problem in engine.problems().iter().filter(|problem| problem.name != dh_core::FULL_POSE) {
            let constrain =
                PROBLEMS.iter().find(|(table, known, _)| (*table, *known) == (name, problem.name));
            let (_, _, constrain) =
                constrain.unwrap_or_else(|| panic!("{name}: {} has no test", problem.name));
            let free = prop::array::uniform7(-0.99..0.99);
            let mut runner = TestRunner::new(ProptestConfig::with_cases(100));
            runner
                .run(&free, |x| {
                    there_and_back(&*engine, &oracle, problem, &constrain(x))
                        .map_err(|error| TestCaseError::fail(format!("{name}, {}: {error}", problem.name)))
                })
                .unwrap();
        }
    }
}

#[test]
fn every_entry_of_a_table_is_a_problem_of_the_arm() {
    for &(name, problem, _) in PROBLEMS {
        let engine = engine::shipped(name).unwrap();
        assert!(engine.problems().iter().any(|known| known.name == problem), "{name}: {problem}");
    }
}

/// theta1 = q1 + 90 degrees: what `where` says of q1 is judged on q1 in (-pi, pi], not on theta1.
#[test]
fn where_speaks_of_q_where_it_is_written_so() {
    let text = "[robot]\nname = \"w\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n\
        [[joint]]\noffset = 90\na = 1\n[[joint]]\na = 1\n\
        [[ik]]\nname = \"p\"\ntarget = \"xy\"\nwhere = [\"q1 <= 0\"]\n\
        [[ik]]\nname = \"all\\u0031\"\ntarget = \"xy\"\n";
    let arm = engine::interpreter(text).unwrap();
    for step in 0..72 {
        let angle = f64::from(step) * PI / 36.0 + 0.01;
        let target = Target::Xy([1.3 * angle.cos(), 1.3 * angle.sin()]);
        let first = |problem: &str| {
            let mut found = SolutionSet::new();
            let answer = arm.ik_into(problem, &target, &mut found);
            let mut joints: Vec<f64> =
                found.iter().filter_map(|solution| solution.q.first().copied()).collect();
            joints.sort_by(f64::total_cmp);
            (answer, joints)
        };
        let (_, every) = first("all1");
        let (answer, kept) = first("p");
        let wanted: Vec<f64> = every.into_iter().filter(|q1| *q1 <= 0.0).collect();
        assert_eq!(kept, wanted);
        assert_eq!(answer.is_err(), wanted.is_empty());
    }
}
