//! Nearly special arms: the closed form of the arm that was meant, corrected, finds what the general chain finds, and all
//! that poses were made from; generated code has the bits of the interpreter.

#![expect(clippy::unwrap_used, reason = "a table of this test that cannot be compiled is a failure")]

use dh_codegen::plan::eval::{Event, Program};
use dh_codegen::plan::{self, FunctionKind, Plan, Step};
use dh_codegen::verify::Level;
use dh_codegen::{Output, compile};
use dh_core::{FULL_POSE, Frame, Kinematics, SolutionSet, Target};
use dh_runtime::dh_robot;
use dh_runtime::nalgebra::Matrix6;
use dh_tests::engine;
use dh_tests::engine::everything::computed;
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_2, PI};

#[dh_robot("../../near/ur5_tilted.toml")]
struct Tilted;

#[dh_robot("../../near/parallels_tilted.toml")]
struct Parallels;

/// The same numbers on every run.
struct Random(u64);

impl Random {
    /// In -1 ... 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// d, a, alpha (m, quarter turns) of every row.
type Rows = [(f64, f64, f64); 6];

/// Three parallel axes; a spherical wrist behind parallel axes; one behind axes that meet; one behind skew ones. Three parallel
/// axes and a spherical joint beside three general ones, by quartics.
const CLASSES: [(&str, Rows); 6] = [
    (
        "three parallel axes",
        [
            (0.09, 0.0, 1.0),
            (0.0, -0.43, 0.0),
            (0.0, -0.39, 0.0),
            (0.11, 0.0, 1.0),
            (0.095, 0.0, -1.0),
            (0.08, 0.0, 0.0),
        ],
    ),
    (
        "spherical wrist, parallel shoulder",
        [
            (0.4, 0.025, -1.0),
            (0.0, 0.455, 0.0),
            (0.0, 0.035, -1.0),
            (0.42, 0.0, 1.0),
            (0.0, 0.0, -1.0),
            (0.08, 0.0, 0.0),
        ],
    ),
    (
        "spherical wrist, offset shoulder",
        [
            (0.67, 0.0, -1.0),
            (0.15, 0.43, 0.0),
            (0.02, -0.02, 1.0),
            (0.43, 0.0, -1.0),
            (0.0, 0.0, 1.0),
            (0.0, 0.0, 0.0),
        ],
    ),
    (
        "spherical shoulder",
        [
            (0.3, 0.0, 1.0),
            (0.0, 0.0, -1.0),
            (0.45, 0.03, 1.0),
            (0.0, 0.4, 0.0),
            (0.05, 0.1, 1.0),
            (0.1, 0.0, 0.0),
        ],
    ),
    (
        "three parallel axes beside general ones",
        [
            (0.1, 0.11, 1.0),
            (-0.23, 0.25, 1.0),
            (-0.23, 0.05, 0.6),
            (0.0, 0.25, 0.0),
            (0.0, 0.3, 0.0),
            (0.31, 0.25, 1.0),
        ],
    ),
    (
        "spherical joint beside general ones",
        [
            (0.3, 0.1, 0.7),
            (0.0, 0.0, 1.0),
            (0.0, 0.0, -1.0),
            (0.3, 0.35, 0.45),
            (0.1, 0.2, -0.6),
            (0.2, 0.0, 0.0),
        ],
    ),
];

/// A table whose numbers are off by up to this much (rad, m).
fn table(rows: &[(f64, f64, f64)], off: f64, random: &mut Random) -> String {
    let rows = rows.iter().enumerate().map(|(index, (d, a, quarters))| {
        let [theta, d, a, alpha, beta] =
            [0.0, *d, *a, quarters * FRAC_PI_2, 0.0].map(|x| x + off * random.next());
        // Along nearly parallel axes an offset is Hayati's beta.
        let along = if *quarters == 0.0 && index < rows.len() - 1 {
            format!("beta = {beta:?}")
        } else {
            format!("d = {d:?}")
        };
        format!("\n[[joint]]\noffset = {theta:?}\na = {a:?}\nalpha = {alpha:?}\n{along}\n")
    });
    format!("[robot]\nname = \"Nearly\"\nconvention = \"standard\"\n{}", rows.collect::<String>())
}

fn frame_of([x, y, z, _]: &[[f64; 4]; 4]) -> Frame {
    let rows = [x, y, z].map(|[a, b, c, p]| ([*a, *b, *c], *p));
    Frame { rotation: rows.map(|row| row.0), translation: rows.map(|row| row.1) }
}

fn compiled(text: &str) -> Output {
    compile(text, Level::Quick).output.unwrap()
}

/// The same arm by the general chain alone.
fn general(output: &Output) -> Plan {
    let mut plan = output.plan.clone();
    plan.functions.retain(|function| !matches!(function.kind, FunctionKind::Inverse(_)));
    plan.functions.push(plan::general(&output.model, None).unwrap());
    plan
}

fn is_near(plan: &Plan) -> bool {
    plan.functions.iter().any(|function| matches!(function.steps[..], [Step::Near { .. }]))
}

/// The greatest difference of two sets of joint angles, whole turns aside.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| ((a - b + PI).rem_euclid(2.0 * PI) - PI).abs());
    differences.fold(0.0, f64::max)
}

/// Joint angles at random; every third time one of them is next to a multiple of a quarter turn.
fn joints(random: &mut Random, number: usize) -> Vec<f64> {
    let mut q: Vec<f64> = (0..6).map(|_| PI * random.next()).collect();
    if number % 3 == 2 {
        let near = [0.1, 0.03, 0.01][number / 3 % 3];
        q[number / 9 % 6] = FRAC_PI_2 * (2.0 * random.next()).round() + near * random.next();
    }
    q
}

/// Poses for each table.
const POSES: usize = 100;

#[test]
fn what_a_pose_was_made_from_is_found_by_the_arm_that_was_meant() {
    let mut random = Random(11);
    let mut solved = Vec::new();
    for (class, rows) in &CLASSES {
        for off in [1e-9, 1e-7, 1e-5, 1e-4, 1e-3] {
            let text = table(rows, off, &mut random);
            let oracle = Oracle::read(&text).unwrap();
            let output = compiled(&text);
            let program = Program::new(&output.model, &output.plan).unwrap();
            let arm = program.interpreter().unwrap();
            let (mut fallen, mut missed) = (0, Vec::new());
            for number in 0..POSES {
                let q = joints(&mut random, number);
                let pose = oracle.fk(&q);
                let (mut set, mut fell) = (SolutionSet::new(), false);
                let answer =
                    arm.trace_ik(FULL_POSE, &Target::Pose(frame_of(&pose)), &[], None, &mut set, |event| {
                        fell |= matches!(event, Event::Stage { stage, .. } if stage.rows == 0b11_1111);
                    });
                fallen += usize::from(fell);
                let mut nearest = f64::INFINITY;
                for solution in set.iter() {
                    let found = oracle.fk(solution.q);
                    let miss = found.iter().flatten().zip(pose.iter().flatten());
                    let miss = miss.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(fell || miss < 1e-12, "{class}, {off:e} at {q:?}: misses by {miss:e}\n{text}");
                    nearest = nearest.min(apart(solution.q, &q));
                }
                if nearest > 1e-6 {
                    missed.push((q, answer));
                }
            }
            assert!(missed.is_empty(), "{class}, {off:e}: {missed:?}\n{text}");
            if is_near(&output.plan) {
                solved.push((*class, off, fallen));
            }
        }
    }
    // Where what was meant is that near, the general chain is the exception.
    for (class, _) in &CLASSES {
        for (off, most) in [(1e-9, POSES / 50), (1e-7, POSES / 20), (1e-5, POSES / 20), (1e-4, POSES / 20)] {
            let usual = solved.iter().any(|(own, at, fallen)| own == class && *at == off && *fallen <= most);
            assert!(usual, "{class}, {off:e}: {solved:?}");
        }
    }
}

#[test]
fn solutions_are_those_of_the_general_chain() {
    let mut random = Random(12);
    for (class, rows) in &CLASSES {
        for off in [1e-6, 1e-4] {
            let text = table(rows, off, &mut random);
            let output = compiled(&text);
            let plans = [output.plan.clone(), general(&output)];
            let programs = plans.each_ref().map(|plan| Program::<f64>::new(&output.model, plan).unwrap());
            let [near, general] = programs.each_ref().map(|program| program.interpreter().unwrap());
            for _ in 0..30 {
                let q: Vec<f64> = (0..6).map(|_| PI * random.next()).collect();
                let target = Target::Pose(near.fk(&q).unwrap());
                let mut sets = [SolutionSet::new(), SolutionSet::new()];
                let [ours, theirs] = &mut sets;
                near.ik_into(FULL_POSE, &target, ours).unwrap();
                general.ik_into(FULL_POSE, &target, theirs).unwrap();
                for solution in theirs.iter() {
                    let known = ours.iter().any(|own| apart(own.q, solution.q) < 1e-6);
                    assert!(known, "{class}, {off:e} at {q:?}: {:?} is lost\n{text}", solution.q);
                }
            }
        }
    }
}

/// The sign of the determinant of the Jacobian.
fn is_turned_over(jacobian: &[[f64; 6]]) -> bool {
    let matrix = Matrix6::from_iterator(jacobian.iter().flatten().copied());
    matrix.full_piv_lu().determinant() < 0.0
}

#[test]
fn branches_are_the_signs_of_the_determinant_by_whatever_way_a_solution_was_found() {
    let mut random = Random(14);
    for (class, rows) in &CLASSES {
        let text = table(rows, 1e-4, &mut random).replacen("offset", "couple = { J2 = -1 }\noffset", 3);
        let text = text.replacen("couple = { J2 = -1 }\n", "direction = -1\n", 1);
        let text = text.replacen("couple = { J2 = -1 }\n", "", 1);
        assert!(text.contains("direction") && text.contains("couple"));
        let oracle = Oracle::read(&text).unwrap();
        let output = compiled(&text);
        assert!(is_near(&output.plan), "{class}");
        let program = Program::<f64>::new(&output.model, &output.plan).unwrap();
        let arm = program.interpreter().unwrap();
        let words = arm.problems()[0].branch;
        let [determinant] = words else { panic!("{class}: {words:?}") };
        for number in 0..POSES {
            let q = joints(&mut random, number);
            let target = Target::Pose(frame_of(&oracle.fk(&q)));
            let mut set = SolutionSet::new();
            arm.ik_into(FULL_POSE, &target, &mut set).unwrap();
            let found = set.iter().any(|solution| apart(solution.q, &q) < 1e-6);
            assert!(found, "{class} at {q:?}\n{text}");
            for solution in set.iter() {
                // By the joint angles of the rows, of which one is reversed.
                let negative = !is_turned_over(&oracle.jacobian(solution.q));
                let minus = solution.branch.is_plus(determinant) == Some(false);
                assert_eq!(minus, negative, "{class} at {:?}\n{text}", solution.q);
            }
        }
    }
}

/// A spherical shoulder, an elbow, a spherical wrist: d, a, alpha (m, quarter turns).
const SEVEN: [(f64, f64, f64); 7] = [
    (0.36, 0.0, -1.0),
    (0.0, 0.0, 1.0),
    (0.42, 0.0, 1.0),
    (0.0, 0.0, -1.0),
    (0.4, 0.0, -1.0),
    (0.0, 0.0, 1.0),
    (0.126, 0.0, 0.0),
];

#[test]
fn nearly_spherical_wrists_behind_seven_joints_are_solved_as_what_was_meant() {
    let mut random = Random(15);
    for off in [1e-8, 1e-5] {
        let text = table(&SEVEN, off, &mut random);
        let oracle = Oracle::read(&text).unwrap();
        let output = compiled(&text);
        assert!(is_near(&output.plan), "{off:e}");
        let program = Program::<f64>::new(&output.model, &output.plan).unwrap();
        let arm = program.interpreter().unwrap();
        let free = arm.problems()[0].free;
        for _ in 0..POSES {
            let q: Vec<f64> = (0..7).map(|_| PI * random.next()).collect();
            let given: Vec<f64> = free.iter().map(|joint| q[*joint]).collect();
            let target = Target::Pose(frame_of(&oracle.fk(&q)));
            let mut set = SolutionSet::new();
            arm.ik_at_into(FULL_POSE, &target, &given, &mut set).unwrap();
            let found = set.iter().any(|solution| apart(solution.q, &q) < 1e-6);
            assert!(found, "{off:e} at {q:?}\n{text}");
        }
    }
}

#[test]
fn single_precision_finds_what_it_can_tell_apart() {
    let mut random = Random(16);
    let (mut found, mut asked) = (0, 0);
    for (class, rows) in &CLASSES {
        let text = table(rows, 1e-4, &mut random);
        let oracle = Oracle::read(&text).unwrap();
        let output = compiled(&text);
        let program = Program::<f32>::new(&output.model, &output.plan).unwrap();
        let arm = program.interpreter().unwrap();
        for _ in 0..40 {
            let q: Vec<f64> = (0..6).map(|_| PI * random.next()).collect();
            let rounded: Vec<f32> = q.iter().map(|x| *x as f32).collect();
            let target = Target::Pose(arm.fk(&rounded).unwrap());
            let mut set = SolutionSet::new();
            arm.ik_into(FULL_POSE, &target, &mut set)
                .unwrap_or_else(|error| panic!("{class} at {q:?}: {error}"));
            let exact = oracle.fk(&q);
            let wide = |q: &[f32]| q.iter().map(|x| f64::from(*x)).collect::<Vec<_>>();
            for solution in set.iter() {
                let pose = oracle.fk(&wide(solution.q));
                let miss = pose.iter().flatten().zip(exact.iter().flatten()).map(|(a, b)| (a - b).abs());
                let miss = miss.fold(0.0, f64::max);
                assert!(miss < 5e-3, "{class} at {q:?}: {:?} misses by {miss:e}", solution.q);
            }
            found += usize::from(set.iter().any(|solution| apart(&wide(solution.q), &q) < 1e-2));
            asked += 1;
        }
    }
    assert!(found * 100 >= asked * 98, "{found} of {asked}");
}

#[test]
fn generated_code_has_the_bits_of_the_interpreter() {
    same_bits(&Tilted, include_str!("../../near/ur5_tilted.toml"));
    same_bits(&Parallels, include_str!("../../near/parallels_tilted.toml"));
}

fn same_bits(arm: &dyn Kinematics, text: &str) {
    assert!(is_near(&compiled(text).plan));
    let interpreter = engine::interpreter(text).unwrap();
    let mut random = Random(13);
    for number in 0..60 {
        let q = joints(&mut random, number);
        let tool = arm.fk(&q).unwrap();
        assert_eq!(computed(arm, &q, tool), computed(&*interpreter, &q, tool), "{q:?}");
    }
    // Far away there is nothing, by either.
    let mut far = Frame::IDENTITY;
    far.translation[0] = 3.0;
    assert_eq!(computed(arm, &[0.0; 6], far), computed(&*interpreter, &[0.0; 6], far));
}

/// Axes 4 to 6 are all but parallel to axis 2 where joint 3 is at a quarter turn, and a curve of solutions of the arm that was meant has a
/// few points left. Poses beside the target had none of them.
#[test]
fn what_is_left_of_a_curve_is_found_from_places_all_over() {
    let text = include_str!("../../near/parallels_tilted.toml");
    let oracle = Oracle::read(text).unwrap();
    let mut random = Random(17);
    for number in 0..200 {
        let mut q: Vec<f64> = (0..6).map(|_| FRAC_PI_2 * (2.0 * random.next()).round()).collect();
        if number % 2 == 0 {
            q[number / 2 % 6] = PI * random.next();
        }
        let pose = oracle.fk(&q);
        let mut set = SolutionSet::new();
        let answer = Parallels.ik_into(FULL_POSE, &Target::Pose(frame_of(&pose)), &mut set);
        assert!(answer.is_ok(), "{q:?}: {answer:?}");
        for solution in set.iter() {
            let found = oracle.fk(solution.q);
            let miss = found.iter().flatten().zip(pose.iter().flatten()).map(|(a, b)| (a - b).abs());
            let miss = miss.fold(0.0, f64::max);
            assert!(miss < 3e-10, "{q:?}: {:?} misses by {miss:e}", solution.q);
        }
    }
}
