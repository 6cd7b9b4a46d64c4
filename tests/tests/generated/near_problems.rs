//! Nearly special arms, and problems that don't prescribe the whole pose: what was meant is solved and corrected, whatever the
//! target, with constraints that are kept as the table has them.

#![expect(clippy::unwrap_used, reason = "a table of this test that cannot be compiled is a failure")]

use dh_codegen::diagnostic::Style;
use dh_codegen::plan::eval::Program;
use dh_codegen::plan::{self, Function, FunctionKind, Plan, Step};
use dh_codegen::verify::Level;
use dh_codegen::{Output, compile};
use dh_core::{
    Branch, BranchBit, Frame, IkError, Kinematics, ProblemInfo, Rule, SolutionSet, Target, TargetKind,
};
use dh_runtime::dh_robot;
use dh_tests::engine;
use dh_tests::engine::everything::computed;
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_2, PI};

mod crowds;

#[dh_robot("../../near/five_tilted.toml")]
struct Five;

/// The same numbers on every run.
struct Random(u64);

impl Random {
    /// In -1 ... 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Whether it slides, d, a, alpha (m, quarter turns), offset (quarter turns).
type Row = (bool, f64, f64, f64, f64);

const YOUBOT_LIKE: [Row; 5] = [
    (false, 0.147, 0.033, 1.0, 0.0),
    (false, 0.0, 0.155, 0.0, 0.0),
    (false, 0.0, 0.135, 0.0, 0.0),
    (false, 0.0, 0.02, 1.0, 1.0),
    (false, 0.2175, 0.0, 0.0, 0.0),
];

/// An arm and a problem of it, with its twists off by angles.
struct Case {
    name: &'static str,
    rows: &'static [Row],
    /// By how much of what the arm is off by each twist is.
    tilts: &'static [f64],
    /// xyz, and by how much of that the tool is turned about x.
    tool: Option<([f64; 3], f64)>,
    target: &'static str,
    constraints: &'static [&'static str],
    /// Joint values that the constraints determine, from the others.
    keep: fn(&mut [f64]),
}

const CASES: [Case; 7] = [
    Case {
        name: "parallel axes 1e-8 and more off, a tool to the side",
        rows: &[
            (false, 0.2, 0.0, 1.0, 0.0),
            (false, 0.0, 0.19, 0.0, 0.0),
            (false, 0.0, 0.139, 0.0, 0.0),
            (false, 0.0, 0.0, -1.0, -1.0),
            (false, 0.19, 0.0, 0.0, 0.0),
        ],
        tilts: &[1.0, 1.0, -0.5, 0.0, 0.0],
        tool: Some(([0.1, 0.0, 0.05], 0.0)),
        target: "position_direction",
        constraints: &[],
        keep: |_| {},
    },
    Case {
        name: "a tool that is nearly straight",
        rows: &YOUBOT_LIKE,
        tilts: &[0.0; 5],
        tool: Some(([0.02, 0.03, 0.05], 1.0)),
        target: "position_direction",
        constraints: &[],
        keep: |_| {},
    },
    Case {
        name: "both",
        rows: &[
            (false, 0.364, 0.016, -1.0, 0.0),
            (false, 0.0, 0.221, 0.0, 0.0),
            (false, 0.0, 0.221, 0.0, 0.0),
            (false, 0.0, 0.0, -1.0, -1.0),
            (false, 0.145, 0.0, 0.0, 0.0),
        ],
        tilts: &[0.3, -1.0, 0.7, 0.2, 0.0],
        tool: Some(([0.03, 0.02, 0.1], -1.0)),
        target: "position_direction",
        constraints: &[],
        keep: |_| {},
    },
    Case {
        name: "SCARA",
        rows: &[
            (false, 0.3, 0.3, 0.0, 0.0),
            (false, 0.0, 0.25, 2.0, 0.0),
            (true, 0.0, 0.0, 0.0, 0.0),
            (false, 0.05, 0.0, 0.0, 0.0),
        ],
        tilts: &[1.0, 0.6, -1.0, 0.0],
        tool: None,
        target: "position_yaw",
        constraints: &[],
        keep: |_| {},
    },
    Case {
        name: "an arm of three joints and its slide",
        rows: &[(false, 0.3, 0.3, 0.0, 0.0), (false, 0.0, 0.25, 2.0, 0.0), (true, 0.0, 0.0, 0.0, 0.0)],
        tilts: &[1.0, 0.6, 0.0],
        tool: None,
        target: "position",
        constraints: &[],
        keep: |_| {},
    },
    Case {
        name: "a planar arm",
        rows: &[(false, 0.0, 0.3, 0.0, 0.0), (false, 0.0, 0.25, 0.0, 0.0), (false, 0.0, 0.1, 0.0, 0.0)],
        tilts: &[1.0, -1.0, 0.0],
        tool: None,
        target: "xy_yaw",
        constraints: &[],
        keep: |_| {},
    },
    Case {
        name: "a hand that is kept level",
        rows: &YOUBOT_LIKE,
        tilts: &[0.0, 1.0, 1.0, 0.0, 0.0],
        tool: Some(([0.03, 0.02, 0.1], 0.0)),
        target: "position",
        constraints: &["theta5 = 0.25", "theta2 + theta3 + theta4 = pi/3"],
        keep: |q| {
            // theta4 = q4 + a quarter turn
            q[3] = PI / 3.0 - q[1] - q[2] - FRAC_PI_2;
            q[4] = 0.25;
        },
    },
];

impl Case {
    fn table(&self, off: f64) -> String {
        let rows = self.rows.iter().zip(self.tilts).map(|((slides, d, a, quarters, turned), tilt)| {
            let [alpha, theta] = [quarters * FRAC_PI_2 + tilt * off, turned * FRAC_PI_2];
            let own = if *slides {
                "type = \"prismatic\"\nlimits = [0, 0.4]".to_owned()
            } else {
                format!("d = {d:?}\noffset = {theta:?}")
            };
            format!("\n[[joint]]\na = {a:?}\nalpha = {alpha:?}\n{own}\n")
        });
        let tool =
            self.tool.map(|(xyz, turn)| format!("\n[tool]\nxyz = {xyz:?}\nrpy = [{:?}, 0, 0]\n", turn * off));
        format!(
            "[robot]\nname = \"{}\"\nconvention = \"standard\"\n{}{}\n[[ik]]\nname = \"problem\"\ntarget = \"{}\"\nconstraints = {:?}\n",
            self.name,
            rows.collect::<String>(),
            tool.unwrap_or_default(),
            self.target,
            self.constraints
        )
    }

    /// Joint values that keep the constraints.
    fn joints(&self, mut next: impl FnMut() -> f64) -> Vec<f64> {
        let rows = self.rows.iter();
        let mut q: Vec<f64> =
            rows.map(|(slides, ..)| if *slides { 0.2 + 0.05 * next() } else { PI * next() }).collect();
        (self.keep)(&mut q);
        q
    }

    fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let turn = |x: f64| ((x + PI).rem_euclid(2.0 * PI) - PI).abs();
        let pairs = a.iter().zip(b).zip(self.rows);
        pairs
            .map(|((a, b), (slides, ..))| if *slides { (a - b).abs() } else { turn(a - b) })
            .fold(0.0, f64::max)
    }

    /// The solutions of what joint values reach, each of which reaches it and keeps the constraints.
    fn solutions(&self, arm: &dyn Kinematics, oracle: &Oracle, q: &[f64], tolerance: f64) -> SolutionSet {
        let target = Target::of_frame(problem_of(arm).target, &frame_of(&oracle.fk(q)));
        let mut set = SolutionSet::new();
        let answer = arm.ik_into("problem", &target, &mut set);
        assert_eq!(answer, Ok(()), "{} at {q:?}", self.name);
        for solution in set.iter() {
            let (position, rotation) = target.errors(&frame_of(&oracle.fk(solution.q)));
            assert!(position.max(rotation) < tolerance, "{}: {:?} misses", self.name, solution.q);
            let mut kept = solution.q.to_vec();
            (self.keep)(&mut kept);
            assert!(self.apart(&kept, solution.q) < 1e-12, "{}: {:?} keeps nothing", self.name, solution.q);
        }
        set
    }
}

fn problem_of(arm: &dyn Kinematics) -> ProblemInfo<'_> {
    *arm.problems().iter().find(|problem| problem.name == "problem").unwrap()
}

fn frame_of([x, y, z, _]: &[[f64; 4]; 4]) -> Frame {
    let rows = [x, y, z].map(|[a, b, c, p]| ([*a, *b, *c], *p));
    Frame { rotation: rows.map(|row| row.0), translation: rows.map(|row| row.1) }
}

fn compiled(text: &str) -> Output {
    let compilation = compile(text, Level::Quick);
    let said = compilation.diagnostics.render(text, "table.toml", Style::Plain);
    assert!(compilation.diagnostics.is_empty(), "{text}\n{said}");
    compilation.output.unwrap()
}

fn is_of_problem(function: &Function) -> bool {
    matches!(function.kind, FunctionKind::Inverse(Some(_)))
}

fn is_near(plan: &Plan) -> bool {
    let near = |function: &Function| matches!(function.steps[..], [Step::Near { .. }]);
    plan.functions.iter().filter(|function| is_of_problem(function)).all(near)
}

const OFF: [f64; 3] = [1e-8, 1e-5, 1e-3];

/// Poses for each table.
const POSES: usize = 30;

#[test]
fn what_a_target_was_made_from_is_found_by_the_arm_that_was_meant() {
    let mut random = Random(21);
    for case in &CASES {
        for off in OFF {
            let text = case.table(off);
            let (oracle, output) = (Oracle::read(&text).unwrap(), compiled(&text));
            assert!(is_near(&output.plan), "{}, {off:e}\n{text}", case.name);
            let program = Program::new(&output.model, &output.plan).unwrap();
            let arm = program.interpreter().unwrap();
            for _ in 0..POSES {
                let q = case.joints(|| random.next());
                let set = case.solutions(&arm, &oracle, &q, 1e-11);
                let nearest = set.iter().map(|found| case.apart(found.q, &q)).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-6, "{}, {off:e}: {nearest:e} from {q:?}\n{text}", case.name);
            }
        }
    }
}

#[test]
fn solutions_and_their_branches_are_those_of_the_table_solved_at_once() {
    let mut random = Random(22);
    for case in &CASES {
        for off in [1e-5, 1e-3] {
            let text = case.table(off);
            let (oracle, output) = (Oracle::read(&text).unwrap(), compiled(&text));
            let mut other = output.plan.clone();
            other.functions.retain(|function| !is_of_problem(function));
            other.functions.push(plan::at_once(&output.model, Some(0)).unwrap());
            let programs = [&output.plan, &other].map(|plan| Program::new(&output.model, plan).unwrap());
            let [near, once] = programs.each_ref().map(|program| program.interpreter().unwrap());
            let words = [&near, &once].map(|arm| problem_of(arm).branch.to_vec());
            // The chain of six joints finds these twice, with either sign.
            let labelled = case.target != "position" || !case.constraints.is_empty();
            for _ in 0..8 {
                let q = case.joints(|| random.next());
                let [ours, theirs] = [&near, &once].map(|arm| case.solutions(arm, &oracle, &q, 1e-9));
                assert_eq!(ours.len(), theirs.len(), "{}, {off:e} at {q:?}\n{text}", case.name);
                for solution in theirs.iter() {
                    let known = ours.iter().find(|own| case.apart(own.q, solution.q) < 1e-6);
                    let known = known.unwrap_or_else(|| panic!("{} at {q:?}: {:?}", case.name, solution.q));
                    let plus = |branch: Branch, words: &[BranchBit]| {
                        words.iter().map(|word| branch.is_plus(word)).collect::<Vec<_>>()
                    };
                    let [own, other] = [(known.branch, &words[0]), (solution.branch, &words[1])]
                        .map(|(branch, words)| plus(branch, words));
                    assert!(
                        (own == other && own.len() == 1) || !labelled,
                        "{}, {off:e}: {own:?}, {other:?}, {words:?} {known:?}, {solution:?}\n{text}",
                        case.name
                    );
                }
            }
        }
    }
}

/// Where the arm that was meant is singular: joints that are free there, or roots that have met, in all ways.
#[test]
fn targets_of_quarter_turns_have_solutions() {
    for case in &CASES {
        for off in [1e-8, 1e-4] {
            let text = case.table(off);
            let (oracle, output) = (Oracle::read(&text).unwrap(), compiled(&text));
            let program = Program::new(&output.model, &output.plan).unwrap();
            let arm = program.interpreter().unwrap();
            let turning = case.rows.iter().filter(|(slides, ..)| !slides).count();
            // Every eleventh: what is left out is as good.
            for number in (0..4_usize.pow(turning as u32)).step_by(11) {
                let mut rest = number;
                let q = case.joints(|| {
                    let quarter = rest % 4;
                    rest /= 4;
                    quarter as f64 / 2.0 - 0.5
                });
                let set = case.solutions(&arm, &oracle, &q, 2e-10);
                assert!(!set.is_empty(), "{}, {off:e} at {q:?}", case.name);
            }
        }
    }
}

#[test]
fn generated_code_has_the_bits_of_the_interpreter() {
    let text = include_str!("../../near/five_tilted.toml");
    assert!(is_near(&compiled(text).plan));
    let interpreter = engine::interpreter(text).unwrap();
    let mut random = Random(23);
    for number in 0..60 {
        let mut q: Vec<f64> = (0..5).map(|_| PI * random.next()).collect();
        if number % 3 == 0 {
            q = q.iter().map(|x| FRAC_PI_2 * (x / FRAC_PI_2).round()).collect();
        }
        let tool = Frame::from(Five.fk(&q.clone().try_into().unwrap()));
        assert_eq!(computed(&Five, &q, tool), computed(&*interpreter, &q, tool), "{q:?}");
    }
}

/// Conditions are asked of the solutions, not of those of the arm that was meant.
#[test]
fn conditions_keep_those_solutions_of_which_they_hold() {
    let mut random = Random(24);
    let mut refused = 0;
    for _ in 0..200 {
        let q: [f64; 5] = std::array::from_fn(|_| PI * random.next());
        let target = Target::of_frame(TargetKind::PositionDirection, &Frame::from(Five.fk(&q)));
        let mut all = SolutionSet::new();
        Five.ik_into("pointing", &target, &mut all).unwrap();
        let holds = |q: &[f64]| q[2] <= 1e-9 && q[0] > -FRAC_PI_2 && q[0] < PI / 4.0;
        let wanted: Vec<&[f64]> = all.iter().map(|found| found.q).filter(|q| holds(q)).collect();
        let mut set = SolutionSet::new();
        match Five.ik_into("elbow_up", &target, &mut set) {
            Ok(()) => assert_eq!(set.iter().map(|found| found.q).collect::<Vec<_>>(), wanted, "{q:?}"),
            Err(IkError::Forbidden { rule: Rule::Where { .. } }) => {
                assert!(wanted.is_empty(), "{q:?}");
                refused += 1;
            }
            Err(error) => panic!("{q:?}: {error}"),
        }
    }
    assert!((1..100).contains(&refused), "{refused}");
}
