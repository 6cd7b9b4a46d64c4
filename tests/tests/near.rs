//! Nearly special arms: the closed form of the arm that was meant, corrected, finds what the general chain finds, and all
//! that poses were made from; generated code has the bits of the interpreter.

#![expect(clippy::unwrap_used, reason = "a table of this test that cannot be compiled is a failure")]

mod everything;

use dh_codegen::plan::eval::{Event, Program};
use dh_codegen::plan::{self, FunctionKind, Plan, Step};
use dh_codegen::verify::Level;
use dh_codegen::{Output, compile};
use dh_core::{FULL_POSE, Frame, Kinematics, SolutionSet, Target};
use dh_runtime::dh_robot;
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use everything::computed;
use std::f64::consts::{FRAC_PI_2, PI};

#[dh_robot("../near/ur5_tilted.toml")]
struct Tilted;

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

/// Three parallel axes; a spherical wrist behind parallel axes; one behind axes that meet; one behind skew ones.
const CLASSES: [(&str, Rows); 4] = [
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
];

/// A table whose numbers are off by up to this much (rad, m).
fn table(rows: &Rows, off: f64, random: &mut Random) -> String {
    let mut text = String::from("[robot]\nname = \"Nearly\"\nconvention = \"standard\"\n");
    for (index, (d, a, quarters)) in rows.iter().enumerate() {
        let [theta, d, a, alpha, beta] =
            [0.0, *d, *a, quarters * FRAC_PI_2, 0.0].map(|x| x + off * random.next());
        text += &format!("\n[[joint]]\noffset = {theta:?}\na = {a:?}\nalpha = {alpha:?}\n");
        // Along nearly parallel axes an offset is Hayati's beta.
        text += &if *quarters == 0.0 && index < 5 {
            format!("beta = {beta:?}\n")
        } else {
            format!("d = {d:?}\n")
        };
    }
    text
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
const POSES: usize = 300;

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
                // What the general chain misses next to its singular poses is not lost here.
                if nearest > 1e-6 && !fell {
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
        for (off, most) in [(1e-9, POSES / 50), (1e-7, POSES / 20), (1e-5, POSES / 5)] {
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
            for _ in 0..100 {
                let q: Vec<f64> = (0..6).map(|_| PI * random.next()).collect();
                let target = Target::Pose(near.fk(&q).unwrap());
                let mut sets = [SolutionSet::new(), SolutionSet::new()];
                let mut fell = false;
                let [ours, theirs] = &mut sets;
                near.trace_ik(FULL_POSE, &target, &[], None, ours, |event| {
                    fell |= matches!(event, Event::Stage { stage, .. } if stage.rows == 0b11_1111);
                })
                .unwrap();
                general.ik_into(FULL_POSE, &target, theirs).unwrap();
                for solution in theirs.iter() {
                    let known = ours.iter().any(|own| apart(own.q, solution.q) < 1e-6);
                    assert!(fell || known, "{class}, {off:e} at {q:?}: {:?} is lost\n{text}", solution.q);
                }
            }
        }
    }
}

#[test]
fn generated_code_has_the_bits_of_the_interpreter() {
    let text = include_str!("../near/ur5_tilted.toml");
    assert!(is_near(&compiled(text).plan));
    let interpreter = engine::interpreter(text).unwrap();
    let mut random = Random(13);
    for number in 0..60 {
        let q = joints(&mut random, number);
        let tool = Tilted.fk(&q.clone().try_into().unwrap());
        let tool = Frame::from(tool);
        assert_eq!(computed(&Tilted, &q, tool), computed(&*interpreter, &q, tool), "{q:?}");
    }
    // Far away there is nothing, by either.
    let mut far = Frame::IDENTITY;
    far.translation[0] = 3.0;
    assert_eq!(computed(&Tilted, &[0.0; 6], far), computed(&*interpreter, &[0.0; 6], far));
}
