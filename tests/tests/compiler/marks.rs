//! Marks of free joints against the oracle: a joint is marked where it can be moved with the target kept, and nowhere else.

use dh_core::{FULL_POSE, SolutionSet, Target};
use dh_runtime::nalgebra::{SMatrix, SVector};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_2, PI};

use super::classes::Random;

type Matrix = [[f64; 4]; 4];

fn column(pose: &Matrix, place: usize) -> [f64; 3] {
    [0, 1, 2].map(|row| pose[row][place])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// A target of a kind that a tool frame meets.
fn target_of(kind: &str, pose: &Matrix) -> Target {
    let [position, direction] = [column(pose, 3), column(pose, 2)];
    let beyond = [0, 1, 2].map(|i| position[i] + 0.37 * direction[i]);
    let rotation = [0, 1, 2].map(|row| [pose[row][0], pose[row][1], pose[row][2]]);
    let yaw = pose[1][0].atan2(pose[0][0]);
    match kind {
        "position" => Target::Position(position),
        "rotation" => Target::Rotation(rotation),
        "direction" => Target::Direction(direction),
        "lookat" => Target::Lookat(beyond),
        "ray" => Target::Ray { position: beyond, direction },
        "position_direction" => Target::PositionDirection { position, direction },
        "position_yaw" => Target::PositionYaw { position, yaw },
        _ => Target::Pose(dh_core::Frame { rotation, translation: position }),
    }
}

/// What a tool frame misses of it.
fn missing(target: &Target, pose: &Matrix) -> Vec<f64> {
    let [x, z, p] = [0, 2, 3].map(|place| column(pose, place));
    let rows = |rotation: &[[f64; 3]; 3]| -> Vec<f64> {
        (0..9).map(|i| pose[i / 3][i % 3] - rotation[i / 3][i % 3]).collect()
    };
    match target {
        Target::Position(position) => minus(p, *position).to_vec(),
        Target::Rotation(rotation) => rows(rotation),
        Target::Direction(direction) => minus(z, *direction).to_vec(),
        Target::Lookat(position) => cross(z, minus(*position, p)).to_vec(),
        Target::Ray { position, direction } => {
            [cross(*direction, minus(p, *position)), minus(z, *direction)].concat()
        }
        Target::PositionDirection { position, direction } => {
            [minus(p, *position), minus(z, *direction)].concat()
        }
        Target::PositionYaw { position, yaw } => {
            let aside = x[1] * yaw.cos() - x[0] * yaw.sin();
            [&minus(p, *position)[..], &[aside]].concat()
        }
        Target::Pose(frame) => [rows(&frame.rotation), minus(p, frame.translation).to_vec()].concat(),
        _ => unreachable!("no such target here"),
    }
}

fn difference(target: &Target, oracle: &Oracle, q: &[f64]) -> SVector<f64, 12> {
    let own = missing(target, &oracle.fk(q));
    SVector::from_fn(|row, _| own.get(row).copied().unwrap_or(0.0))
}

/// How it changes with each joint.
fn slopes(target: &Target, oracle: &Oracle, q: &[f64]) -> SMatrix<f64, 12, 6> {
    let mut columns: SMatrix<f64, 12, 6> = SMatrix::zeros();
    for joint in 0..q.len() {
        let at = |step: f64| {
            let mut x = q.to_vec();
            x[joint] += step;
            difference(target, oracle, &x)
        };
        let slope: SVector<f64, 12> = (at(1e-6) - at(-1e-6)) / 2e-6;
        columns.set_column(joint, &slope);
    }
    columns
}

/// NaN, by which nothing is met, where there is none.
fn solved(step: Result<SVector<f64, 6>, &str>) -> SVector<f64, 6> {
    step.unwrap_or(SVector::from_element(f64::NAN))
}

/// Whether others can make up for a joint that is moved a little, by Newton's method in them alone.
fn is_free(oracle: &Oracle, target: &Target, q: &[f64], joint: usize) -> bool {
    // If not at first, then not at all.
    let mut columns = slopes(target, oracle, q);
    let own = columns.column(joint).into_owned();
    columns.fill_column(joint, 0.0);
    let svd = columns.svd(true, true);
    if (columns * solved(svd.solve(&own, 1e-5)) - own).amax() > 1e-3 {
        return false;
    }
    // Next to a double root solutions are not known any better.
    let met = 1e-11 + 2.0 * difference(target, oracle, q).amax();
    // Where more than one has to be made up for by the same joints, one alone may do it.
    let alone = (0..q.len()).filter(|other| *other != joint).map(Some);
    let tries = [None].into_iter().chain(alone).flat_map(|only| [(0.002, only), (-0.002, only)]);
    tries.into_iter().any(|(moved, only)| {
        let mut x = q.to_vec();
        x[joint] += moved;
        for _ in 0..6 {
            let error = difference(target, oracle, &x);
            if error.amax() < 1e-12 {
                break;
            }
            let mut columns = slopes(target, oracle, &x);
            let fixed =
                (0..x.len()).filter(|other| *other == joint || only.is_some_and(|only| only != *other));
            fixed.for_each(|other| columns.fill_column(other, 0.0));
            let step = solved(columns.svd(true, true).solve(&error, 1e-5));
            x.iter_mut().zip(step.iter()).for_each(|(x, step)| *x -= step);
        }
        difference(target, oracle, &x).amax() < met && x.iter().zip(q).all(|(a, b)| (a - b).abs() < 0.05)
    })
}

/// Joint values of which most are at a multiple of a quarter turn.
fn lattice(random: &mut Random, oracle: &Oracle) -> Vec<f64> {
    let chain = oracle.chain();
    let value = |row: &usize| {
        let any = PI * (2.0 * random.unit() - 1.0);
        match random.unit() {
            _ if chain.rows[*row].prismatic => 0.3 + 0.1 * random.unit(),
            part if part < 0.7 => (any / FRAC_PI_2).round() * FRAC_PI_2,
            _ => any,
        }
    };
    chain.joints.iter().map(value).collect()
}

/// Says how many solutions are marked of how many.
fn compare(name: &str, text: &str, problem: &str, kind: &str, poses: usize) -> Result<[usize; 2], String> {
    let (arm, oracle) = (engine::interpreter(text)?, Oracle::read(text)?);
    let mut random = Random(23);
    let mut counts = [0; 2];
    for _ in 0..poses {
        let q = lattice(&mut random, &oracle);
        let target = target_of(kind, &oracle.fk(&q));
        let mut set = SolutionSet::new();
        arm.ik_into(problem, &target, &mut set)
            .map_err(|error| format!("{name}, {kind}, at {q:?}: {error}"))?;
        for solution in set.iter() {
            let free: Vec<usize> =
                (0..q.len()).filter(|joint| is_free(&oracle, &target, solution.q, *joint)).collect();
            let marked = solution.free.map(|row| oracle.chain().joints.iter().position(|own| *own == row));
            let agrees =
                marked.map_or(free.is_empty(), |joint| joint.is_some_and(|joint| free.contains(&joint)));
            assert!(
                agrees,
                "{name}, {kind}, at {q:?}: {:?}, {:?}; free are {free:?}",
                solution.q, solution.free
            );
            counts[usize::from(marked.is_some())] += 1;
        }
    }
    Ok(counts)
}

fn arm(rows: &[&str], kinds: &[&str]) -> String {
    let head =
        "[robot]\nname = \"arm\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n";
    let rows = rows.iter().map(|row| format!("[[joint]]\n{row}\n"));
    let problems = kinds.iter().map(|kind| format!("[[ik]]\nname = \"to_{kind}\"\ntarget = \"{kind}\"\n"));
    [head.to_owned()].into_iter().chain(rows).chain(problems).collect()
}

/// Where a step of a derivation has nothing to say of its joint, others may: only where the arm can move is a joint free.
#[test]
fn a_joint_of_any_problem_is_marked_where_it_can_move() {
    let arms: [(&str, &[&str], &[&str]); 5] = [
        (
            "3R",
            &["d = 0.3\na = 0.1\nalpha = 90", "d = 0.1\na = 0.4\nalpha = -90", "d = 0.05\na = 0.3"],
            &["position"],
        ),
        ("elbow", &["d = 0.3\nalpha = 90", "a = 0.4", "a = 0.3"], &["position"]),
        ("2R", &["d = 0.1\na = 0.1\nalpha = 90", "d = 0.1\na = 0.1\nalpha = 90"], &["direction", "lookat"]),
        ("wrist", &["d = 0.1\nalpha = -90", "d = 0.1\nalpha = 90", "d = 0.1"], &["rotation"]),
        (
            "SCARA",
            &["d = 0.2\na = 0.325", "a = 0.275\nalpha = 180", "", "type = \"prismatic\""],
            &["position_yaw"],
        ),
    ];
    for (name, rows, kinds) in arms {
        for kind in kinds {
            let counts = compare(name, &arm(rows, kinds), &format!("to_{kind}"), kind, 60).unwrap();
            let any = !matches!((name, *kind), ("3R" | "SCARA", _) | (_, "lookat"));
            assert!(counts[0] > 0 && (counts[1] > 0) == any, "{name} {kind}: {counts:?}");
        }
    }
}

#[test]
fn a_joint_of_a_full_pose_is_marked_where_it_can_move() {
    for name in ["puma560", "ur5e", "irb120", "stanford", "vs068", "tx2_60", "lite6"] {
        let counts = compare(name, dh_robots::table(name).unwrap(), FULL_POSE, "pose", 10).unwrap();
        assert!(counts.iter().all(|count| *count > 0), "{name}: {counts:?}");
    }
}

/// Upright with an aligned wrist: a curve passes where two solutions have met, on an arm that is short beside its reach.
#[test]
fn a_joint_is_marked_where_solutions_have_met_on_a_curve() {
    let rows = [
        "d = 0.25\nalpha = -90",
        "d = 0.4\nalpha = 90",
        "type = \"prismatic\"",
        "alpha = -90",
        "alpha = 90",
        "d = 0.25",
    ];
    let text = arm(&rows, &[]);
    let (arm, oracle) = (engine::interpreter(&text).unwrap(), Oracle::read(&text).unwrap());
    let mut random = Random(5);
    for _ in 0..20 {
        let q = [2.0 * random.unit(), 0.0, 0.4, 2.0 * random.unit(), 0.0, 2.0 * random.unit()];
        let mut set = SolutionSet::new();
        arm.ik_into(FULL_POSE, &target_of("pose", &oracle.fk(&q)), &mut set).unwrap();
        assert!(set.iter().all(|solution| solution.free.is_some()), "{q:?}: {set:?}");
    }
}

/// The first and the last axis are both upright, and the arm is stretched: all joints are found at once, and a curve passes where
/// solutions have met.
#[test]
fn a_curve_of_solutions_is_listed_once() {
    let rows = ["d = 0.07\nalpha = 90", "a = 0.146", "a = 0.187", "alpha = 90\noffset = 90", "d = 0.1"];
    let tool = "[tool]\nxyz = [0.03, 0.04, 0.1]\nrpy = [30, 20, 10]\n";
    let text = arm(&rows, &["position_direction"]) + tool;
    let (arm, oracle) = (engine::interpreter(&text).unwrap(), Oracle::read(&text).unwrap());
    for q in [
        [0.3, -1.0, 0.0, 0.0, -1.0],
        [0.0, -1.0, 0.0, 0.0, -1.0],
        [2.0, 1.0, 0.0, 0.0, -1.0],
        [2.0, -1.0, 2.0, 0.0, -1.0],
    ] {
        let q = q.map(|quarters| quarters * FRAC_PI_2);
        let target = target_of("position_direction", &oracle.fk(&q));
        let mut set = SolutionSet::new();
        arm.ik_into("to_position_direction", &target, &mut set).unwrap();
        let marked = set.iter().filter(|solution| solution.free.is_some()).count();
        assert!((1..=2).contains(&marked) && set.len() <= 8, "{q:?}: {set:?}");
    }
}

/// An arm that is nearly special: axis 1 is parallel to three others where joint 2 is at 0, and points of the curve filled the list,
/// unmarked, with no room for what else there is.
#[test]
fn a_curve_of_a_nearly_special_arm_is_listed_once() {
    let rows = [
        "a = 0.003\nalpha = 90",
        "a = 0.28\nd = 0.22\nalpha = 90",
        "a = 0.29\nd = 0.26\nalpha = 180",
        "a = 0.22\nd = 0.2",
        "a = 0.09\nalpha = 90",
        "a = 0.2\nd = 0.06\nalpha = -90",
    ];
    let text = arm(&rows, &["pose"]);
    let (arm, oracle) = (engine::interpreter(&text).unwrap(), Oracle::read(&text).unwrap());
    let mut random = Random(23);
    for _ in 0..40 {
        let mut q = [(); 6].map(|()| 2.0 * PI * (random.unit() - 0.5));
        q[1] = 0.0;
        let mut set = SolutionSet::new();
        arm.ik_into("to_pose", &target_of("pose", &oracle.fk(&q)), &mut set).unwrap();
        let marked = set.iter().filter(|solution| solution.free.is_some()).count();
        assert!((1..=2).contains(&marked) && set.len() <= 8, "{q:?}: {set:?}");
    }
}

/// Three joints solve a position as six whose last three stand for the orientation: where these were in one plane, points of a
/// curve were listed unmarked, and regular solutions lost.
#[test]
fn what_only_the_chain_has_neither_hides_curves_nor_loses_solutions() {
    let mut random = Random(31);
    let folded = arm(&["d = 0.3\na = 0.1\nalpha = 90", "a = 0.4\nalpha = -90", "a = 0.4"], &["position"]);
    let (folded, oracle) = (engine::interpreter(&folded).unwrap(), Oracle::read(&folded).unwrap());
    let mut told = 0;
    for _ in 0..50 {
        // The third link lies on the second, whichever way that points: two curves that have met.
        let q = [2.0 * PI * (random.unit() - 0.5), 2.0 * PI * (random.unit() - 0.5), PI];
        let mut set = SolutionSet::new();
        folded.ik_into("to_position", &target_of("position", &oracle.fk(&q)), &mut set).unwrap();
        assert!(set.iter().any(|solution| solution.free.is_some()), "{q:?}: {set:?}");
        told += usize::from(set.iter().all(|solution| solution.free.is_some()));
    }
    assert!(told >= 42, "{told} of 50");
    let skew = ["d = 0.3\na = 0.25\nalpha = 90", "a = 0.4\nalpha = -90", "d = 0.4\na = 0.4"];
    let text = arm(&skew, &["position"]);
    let (skew, oracle) = (engine::interpreter(&text).unwrap(), Oracle::read(&text).unwrap());
    for number in 0..2000 {
        let q = match number {
            0 => [2.704_951_545_404_51, 1.708_860_999_512_529_5, -0.075_042_534_233_841_16],
            _ => [(); 3].map(|()| 2.0 * PI * (random.unit() - 0.5)),
        };
        let mut set = SolutionSet::new();
        skew.ik_into("to_position", &target_of("position", &oracle.fk(&q)), &mut set).unwrap();
        let apart = |found: &[f64]| {
            let away = found.iter().zip(q).map(|(a, b)| ((a - b + PI).rem_euclid(2.0 * PI) - PI).abs());
            away.fold(0.0, f64::max)
        };
        let nearest = set.iter().map(|solution| apart(solution.q)).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-5 && set.len() <= 5, "{nearest:e} from {q:?}: {set:?}");
    }
}
