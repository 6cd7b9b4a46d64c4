//! The full pose of arms drawn at random, class by class, there and back against the oracle: every pose that joint values
//! give has solutions that meet it, on the lattice of eighths of a turn too, and those joint values are among them wherever
//! the arm is not singular.

use super::classes::{CLASSES, Random, modified_rows, table};
use dh_codegen::compile;
use dh_codegen::plan::{Function, Step};
use dh_codegen::verify::Level;
use dh_core::{FULL_POSE, Frame, Kinematics, SolutionSet, Target, residual_tolerance};
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

/// Where the tool of five joints is upright, its direction says nothing of the first one, but the place of the wrist does.
#[test]
fn five_joints_are_found_where_one_equation_says_nothing() {
    let mut random = Random(7);
    for name in ["wx250", "xarm5", "uarm_swift_pro"] {
        let arm = engine::shipped(name).unwrap();
        let oracle = Oracle::shipped(name).unwrap();
        let joints = arm.dof();
        let mut upright = 0;
        for number in 0..200 {
            let mut q: Vec<f64> = (0..joints).map(|_| PI * random.symmetric()).collect();
            if let [_, q2, q3, q4, _] = q.as_mut_slice() {
                *q4 = 2.0 * FRAC_PI_4 * f64::from(number % 4) - *q2 - *q3;
            }
            let [x, y, ..] = oracle.fk(&q);
            upright += usize::from(x[2].hypot(y[2]) < 1e-12);
            let nearest = there_and_back(&*arm, &oracle, &q, CLOSED).unwrap();
            assert!(nearest < 1e-7, "{name} at {q:?}: {nearest:e}");
        }
        assert!(upright >= 100, "{name}: {upright}");
    }
}

/// Beside three parallel axes, the axis in the middle of the others may become parallel to them: its twists are equal. Where it does,
/// roots of a quartic have met, and joints are free; next to that, they know few digits. A parallel elbow folded there, too.
#[test]
fn where_a_fourth_axis_becomes_parallel_there_are_solutions() {
    let mut random = Random(31);
    for (rows, middle, elbow) in [
        ("L0L L0L LTL LTL LTL 00L", 3, 1),
        ("LTL L0L L0L LTL LTL 00L", 4, 2),
        ("LTL LTL LTL L0L L0L 00L", 2, 4),
    ] {
        for twist in ["90", "-90", "35"] {
            let text: Vec<String> = table(rows, false, &mut random)
                .lines()
                .map(|line| match line.strip_prefix("alpha = ") {
                    Some("90" | "-90") => format!("alpha = {twist}"),
                    _ => line.to_owned(),
                })
                .collect();
            let text = text.join("\n");
            let oracle = Oracle::read(&text).unwrap();
            let arm = engine::interpreter(&text).unwrap();
            let output = compile(&text, Level::Quick).output.unwrap();
            let closed =
                |function: &Function| function.steps.iter().any(|step| matches!(step, Step::Solve { .. }));
            assert!(output.plan.functions.iter().any(closed), "{text}");
            for number in 0..400 {
                let mut q = [(); 6].map(|()| match number % 2 {
                    0 => PI * random.symmetric(),
                    _ => 2.0 * FRAC_PI_4 * (4.0 * random.unit()).floor(),
                });
                let beside = |random: &mut Random| match number % 3 {
                    0 => 0.0,
                    _ => 10_f64.powf(-1.0 - 11.0 * random.unit()),
                };
                q[middle] = if number % 5 < 3 { PI } else { 0.0 } + beside(&mut random);
                if number % 4 == 3 {
                    q[elbow] = beside(&mut random);
                }
                let found = there_and_back(&*arm, &oracle, &q, ITERATED * oracle.reach().max(1.0));
                found.unwrap_or_else(|error| panic!("{q:?}: {error}\n{text}"));
            }
        }
    }
}

/// Fewer joints than a pose prescribes: equations that follow from others, and say nothing where these still do.
const FEWER_JOINTS: &[(&str, &str, bool)] = &[
    ("elbow in a plane with the first axis", "0TL L00 L00 0T0 00L", false),
    ("elbow beside the first axis", "LTL L0L L00 LT0 L0L", false),
    ("elbow and a wrist's three axes", "0TL L00 0T0 0T0 00L", false),
    ("an elbow of four joints", "LTL L0L L00 L00", false),
    ("three joints, skew", "LTL LTL LTL", true),
    ("two joints", "LTL LTL", true),
    ("a slide among five", "0TL L00 P0T 0T0 00L", false),
];

/// No closed form: one has a polynomial, of the others none is found.
const SLIDES_BETWEEN: &[(&str, &str, bool)] = &[
    ("a slide between turns", "LTL PLT LTL LTL LTL 00L", true),
    ("two slides between turns", "LTL LTL PLT LTL PLT 00L", true),
];

#[test]
fn every_pose_has_its_solutions() {
    let mut random = Random(20_240_607);
    let with = |classes: &'static [_], most: f64| classes.iter().map(move |class| (class, most));
    let classes = with(CLASSES, CLOSED).chain(with(SLIDES_BETWEEN, ITERATED));
    // What misses a pose that prescribes too much by less than this is a solution.
    for ((class, rows, skew), most) in classes.chain(with(FEWER_JOINTS, residual_tolerance())) {
        for modified in [false, true] {
            // A modified row's length and twist are those before its joint: the first ones are the base's.
            let text = table(rows, *skew, &mut random);
            let text = if modified { modified_rows(&text) } else { text };
            let oracle = Oracle::read(&text).unwrap();
            let arm = engine::interpreter(&text).unwrap();
            let most = if most > CLOSED { most * oracle.reach().max(1.0) } else { most };
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
