//! The full pose of arms drawn at random, class by class, there and back against the oracle: every pose that joint values
//! give has solutions that meet it, on the lattice of eighths of a turn too, and those joint values are among them wherever
//! the arm is not singular.

use super::classes::{CLASSES, Random, modified_rows, table};
use dh_core::{FULL_POSE, Frame, Kinematics, SolutionSet, Target};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_4, PI};

fn frame_of(pose: &[[f64; 4]; 4]) -> Frame {
    let [x, y, z, _] = *pose;
    let rows = [x, y, z].map(|[a, b, c, p]| ([a, b, c], p));
    Frame { rotation: rows.map(|row| row.0), translation: rows.map(|row| row.1) }
}

/// What a solution in closed form may miss a pose by (m, rad); and one by Newton's method next to a double root (reaches, rad),
/// where it is held to be one from here on.
const CLOSED: f64 = 2e-11;
const ITERATED: f64 = 1e-10;

/// Solves for the pose at `q`; says what is wrong, else how far the nearest solution is.
fn there_and_back(arm: &dyn Kinematics, oracle: &Oracle, q: &[f64], most: f64) -> Result<f64, String> {
    let pose = oracle.fk(q);
    let mut set = SolutionSet::new();
    arm.ik_into(FULL_POSE, &Target::Pose(frame_of(&pose)), &mut set).map_err(|error| error.to_string())?;
    let chain = oracle.chain();
    let mut nearest = f64::INFINITY;
    for solution in set.iter() {
        let found = oracle.fk(solution.q);
        let off = found.iter().flatten().zip(pose.iter().flatten()).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f64::max);
        if off > most {
            return Err(format!("{:?} misses by {off:e}", solution.q));
        }
        let joints = solution.q.iter().zip(q).zip(&chain.joints);
        let apart = joints.map(|((a, b), row)| {
            let turns = !chain.rows[*row].prismatic;
            if turns { ((a - b + PI).rem_euclid(2.0 * PI) - PI).abs() } else { (a - b).abs() }
        });
        nearest = nearest.min(apart.fold(0.0, f64::max));
    }
    Ok(nearest)
}

/// Two of eight are a twentieth of a radian apart, where the polynomials have no more digits to tell them apart.
#[test]
fn solutions_that_nearly_meet_are_all_found() {
    let arm = engine::shipped("manocha_canny").unwrap();
    let oracle = Oracle::shipped("manocha_canny").unwrap();
    let q = [-90.0, 90.0, 0.0, 180.0, -90.0, -90.0].map(f64::to_radians);
    assert!(there_and_back(&*arm, &oracle, &q, CLOSED).unwrap() < 1e-6);
}

/// No closed form: one has a polynomial, of the others none is found.
const SLIDES_BETWEEN: &[(&str, &str, bool)] = &[
    ("a slide between turns", "LTL PLT LTL LTL LTL 00L", true),
    ("two slides between turns", "LTL LTL PLT LTL PLT 00L", true),
];

#[test]
fn every_pose_has_its_solutions() {
    let mut random = Random(20_240_607);
    let in_closed_form = CLASSES.iter().map(|class| (class, true));
    let classes = in_closed_form.chain(SLIDES_BETWEEN.iter().map(|class| (class, false)));
    for ((class, rows, skew), closed) in classes {
        for modified in [false, true] {
            // A modified row's length and twist are those before its joint: the first ones are the base's.
            let text = table(rows, *skew, &mut random);
            let text = if modified { modified_rows(&text) } else { text };
            let oracle = Oracle::read(&text).unwrap();
            let arm = engine::interpreter(&text).unwrap();
            let most = if closed { CLOSED } else { ITERATED * oracle.reach().max(1.0) };
            assert!(arm.problems().iter().any(|problem| problem.name == FULL_POSE), "{class}\n{text}");
            let slides: Vec<bool> =
                oracle.chain().joints.iter().map(|&row| oracle.chain().rows[row].prismatic).collect();
            for number in 0..60 {
                let q: Vec<f64> = slides
                    .iter()
                    .map(|slides| match (slides, number % 3) {
                        (true, _) => random.unit() - 0.5,
                        (false, 0) => PI * (2.0 * random.unit() - 1.0),
                        (false, 1) => FRAC_PI_4 * (8.0 * random.unit()).floor(),
                        _ => 2.0 * FRAC_PI_4 * (4.0 * random.unit()).floor() + 1e-7 * (random.unit() - 0.5),
                    })
                    .collect();
                let nearest = there_and_back(&*arm, &oracle, &q, most);
                let nearest = nearest.unwrap_or_else(|error| panic!("{class} at {q:?}: {error}\n{text}"));
                assert!(number % 3 != 0 || nearest < 1e-7, "{class} at {q:?}: {nearest:e}\n{text}");
            }
        }
    }
}
