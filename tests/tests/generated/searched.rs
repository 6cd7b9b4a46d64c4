//! Problems that neither a closed form nor a chain of six joints solves: rows that follow others by couplings, and targets
//! that are no pose. What is searched for is found: against the oracle, against a longer search, where solutions form a
//! curve, and in generated code.

use dh_codegen::compile;
use dh_codegen::plan::eval::Program;
use dh_codegen::plan::{FunctionKind, Step};
use dh_codegen::verify::Level;
use dh_core::{FULL_POSE, Frame, IkError, Kinematics, Seed, SolutionSet, Target, TargetKind};
use dh_runtime::dh_robot;
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::fmt::Write;

#[dh_robot("searched/palletiser.toml", warnings = "off")]
struct Palletiser;

#[dh_robot("searched/linked.toml", scalar = "f32", warnings = "off")]
struct Linked;

/// The same numbers on every run.
struct Random(u64);

impl Random {
    /// In -1 ... 1.
    fn symmetric(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((self.0 >> 40) as u32) / f64::from(1_u32 << 23) - 1.0
    }
}

/// A table of as many rows, one of which may follow the row before it by a factor, and may be a slide.
fn table(rows: usize, follower: Option<(usize, f64)>, slide: Option<usize>, random: &mut Random) -> String {
    let mut text = "[robot]\nname = \"drawn\"\nconvention = \"standard\"\n".to_owned();
    for row in 0..rows {
        let [a, d, alpha, theta] = [0.5, 0.4, 2.6, 3.0].map(|size| size * random.symmetric());
        text.push_str("[[joint]]\n");
        if slide == Some(row) {
            let _ = writeln!(text, "type = \"prismatic\"\na = {a}\nalpha = {alpha}\ntheta = {theta}");
            continue;
        }
        let _ = writeln!(text, "a = {a}\nd = {d}\nalpha = {alpha}");
        match follower.filter(|(place, _)| *place == row) {
            Some((_, factor)) => {
                let _ = writeln!(text, "fixed = {theta}\ncouple = {{ J{row} = {factor} }}");
            }
            None => {
                let _ = writeln!(text, "offset = {theta}");
            }
        }
    }
    text
}

fn frame_of(pose: &[[f64; 4]; 4]) -> Frame {
    let [x, y, z, _] = *pose;
    let rows = [x, y, z].map(|[a, b, c, p]| ([a, b, c], p));
    Frame { rotation: rows.map(|row| row.0), translation: rows.map(|row| row.1) }
}

/// What of a tool frame a target prescribes; what is looked at is half a metre ahead.
fn target_of(kind: TargetKind, tool: &Frame) -> Target {
    match kind {
        TargetKind::Lookat => Target::Lookat(tool.transform_point([0.0, 0.0, 0.5])),
        _ => Target::of_frame(kind, tool),
    }
}

/// Rows, the one that follows with its factor, a slide, the target, and constraints.
type Class = (usize, Option<(usize, f64)>, Option<usize>, TargetKind, &'static str);

const CLASSES: &[Class] = &[
    (4, Some((2, -1.0)), None, TargetKind::Position, ""),
    (4, Some((1, 2.0)), None, TargetKind::Position, ""),
    (4, Some((2, -0.5)), None, TargetKind::Rotation, ""),
    (4, Some((2, 1.0)), Some(3), TargetKind::Position, ""),
    (3, None, None, TargetKind::XyYaw, ""),
    (2, None, None, TargetKind::Xy, ""),
    (3, Some((1, 0.5)), None, TargetKind::Direction, ""),
    (3, Some((2, 1.5)), None, TargetKind::Lookat, ""),
    (5, Some((2, -1.0)), None, TargetKind::Ray, ""),
    (5, Some((2, -1.0)), None, TargetKind::PositionYaw, ""),
    (6, Some((3, -1.0)), None, TargetKind::PositionDirection, ""),
    (7, Some((4, -1.0)), None, TargetKind::Pose, ""),
    (
        6,
        None,
        None,
        TargetKind::Position,
        "\"theta2 + theta3 + theta4 = 1\", \"theta5 = theta1\", \"theta6 = 0.3\"",
    ),
];

/// A table of a class, with its problem `p`.
fn drawn(&(rows, follower, slide, kind, constraints): &Class, random: &mut Random) -> String {
    let problem = if kind == TargetKind::Pose { FULL_POSE.to_owned() } else { "p".to_owned() };
    let constraints =
        if constraints.is_empty() { String::new() } else { format!("constraints = [{constraints}]\n") };
    let text = table(rows, follower, slide, random);
    format!("{text}[[ik]]\nname = \"{problem}\"\ntarget = \"{kind}\"\n{constraints}")
}

/// Joint values of a class; those of the only class with constraints keep them.
fn joints(class: &Class, oracle: &Oracle, number: usize, random: &mut Random) -> Vec<f64> {
    let chain = oracle.chain();
    let slides = |joint: usize| chain.joints.get(joint).is_some_and(|row| chain.rows[*row].prismatic);
    let mut q: Vec<f64> = (0..oracle.dof())
        .map(|joint| match number % 4 {
            _ if slides(joint) => 0.5 * random.symmetric(),
            3 => FRAC_PI_4 * (4.0 * random.symmetric()).floor(),
            _ => PI * random.symmetric(),
        })
        .collect();
    if !class.4.is_empty() {
        // The rows' values at q = 0 are offsets, which the table has.
        let at_zero: Vec<f64> = chain.rows.iter().map(|row| row.theta.to_f64()).collect();
        let theta = |joint: usize, q: &[f64]| q[joint] + at_zero[joint];
        q[3] = 1.0 - theta(1, &q) - theta(2, &q) - at_zero[3];
        q[4] = theta(0, &q) - at_zero[4];
        q[5] = 0.3 - at_zero[5];
    }
    q
}

/// The greatest difference of joint values, of which angles come back after some turns.
fn apart(oracle: &Oracle, class: &Class, left: &[f64], right: &[f64]) -> f64 {
    let chain = oracle.chain();
    let mut greatest = 0.0_f64;
    for (joint, (a, b)) in left.iter().zip(right).enumerate() {
        let row = chain.joints[joint];
        // The row before one that follows by a half comes back after two turns.
        let follows = class.1.filter(|(place, factor)| row + 1 == *place && factor.fract() != 0.0);
        let period = if follows.is_some() { 2.0 * TAU } else { TAU };
        let off = a - b;
        let off = if chain.rows[row].prismatic { off } else { off - period * (off / period).round() };
        greatest = greatest.max(off.abs());
    }
    greatest
}

/// Every arm of a class drawn at random, solved through the interpreter.
#[test]
fn joint_values_are_found_again() {
    let mut random = Random(11);
    for class in CLASSES {
        for _ in 0..2 {
            let text = drawn(class, &mut random);
            let (oracle, arm) = (Oracle::read(&text).unwrap(), engine::interpreter(&text).unwrap());
            let info = arm.problems().iter().find(|info| info.target == class.3);
            let info = info.unwrap_or_else(|| panic!("{class:?} is not solved\n{text}"));
            let (mut asked, mut found) = (0, 0);
            for number in 0..24 {
                let q = joints(class, &oracle, number, &mut random);
                let tool = frame_of(&oracle.fk(&q));
                let target = target_of(class.3, &tool);
                let mut set = SolutionSet::new();
                arm.ik_into(info.name, &target, &mut set)
                    .unwrap_or_else(|error| panic!("{class:?} at {q:?}: {error}\n{text}"));
                for solution in set.iter() {
                    let (position, rotation) = target.errors(&frame_of(&oracle.fk(solution.q)));
                    assert!(
                        position < 1e-9 && rotation < 1e-9,
                        "{class:?} at {q:?}: {position:e} {rotation:e}"
                    );
                }
                let nearest = set.iter().map(|solution| apart(&oracle, class, solution.q, &q));
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                // A multiple of an eighth of a turn may be singular.
                if number % 4 != 3 {
                    asked += 1;
                    found += usize::from(nearest < 1e-7);
                }
            }
            assert_eq!(found, asked, "{class:?}\n{text}");
        }
    }
}

/// Joint values, and the row of the joint that is free.
type Found<S> = (Vec<S>, Option<usize>);

/// All solutions.
fn solutions<S: dh_core::Float>(
    arm: &dyn Kinematics<S>,
    problem: &str,
    target: &Target<S>,
    seed: Option<Seed<'_, S>>,
) -> Result<Vec<Found<S>>, IkError<S>> {
    let mut set = SolutionSet::new();
    arm.ik_seeded_into(problem, target, &[], seed, &mut set)?;
    Ok(set.iter().map(|solution| (solution.q.to_vec(), solution.free)).collect())
}

#[test]
fn a_longer_search_finds_nothing_more() {
    let mut random = Random(5);
    let (mut more, mut all) = (0, 0);
    for class in CLASSES {
        let text = drawn(class, &mut random);
        let output = compile(&text, Level::Quick).output.unwrap();
        let mut long = output.plan.clone();
        let mut searched = false;
        for function in long.functions.iter_mut().filter(|f| matches!(f.kind, FunctionKind::Inverse(_))) {
            for step in &mut function.steps {
                if let Step::Descents { chain, .. } = step {
                    chain.patience *= 8;
                    searched = true;
                }
            }
        }
        // Two joints that bring a point over another one have a quartic: nothing to search longer for.
        let closed = matches!(class, (2, None, None, TargetKind::Xy, _));
        assert_eq!(searched, !closed, "{class:?} is solved otherwise\n{text}");
        let programs = [&output.plan, &long].map(|plan| Program::new(&output.model, plan).unwrap());
        let [arm, patient] = programs.each_ref().map(|program| program.interpreter().unwrap());
        let oracle = Oracle::read(&text).unwrap();
        let problem = if class.3 == TargetKind::Pose { FULL_POSE } else { "p" };
        for number in 0..6 {
            let q = joints(class, &oracle, 4 * number, &mut random);
            let target = target_of(class.3, &frame_of(&oracle.fk(&q)));
            let own = solutions(&arm, problem, &target, None).unwrap().len();
            let longer = solutions(&patient, problem, &target, None).unwrap().len();
            assert!(longer >= own);
            more += longer - own;
            all += longer;
        }
    }
    // One in a thousand that is as rare as the rarest may be missed.
    assert!(more == 0 && all > 200, "{more} of {all} solutions are missed");
}

/// Where the tool stands on the first axis, that joint is free: it is at the seed's value, and said to be free.
#[test]
fn a_joint_that_a_target_leaves_free_is_said_to_be() {
    let mut random = Random(3);
    let mut text = table(4, Some((2, -1.0)), None, &mut random);
    let tool = frame_of(&Oracle::read(&text).unwrap().fk(&[0.0; 3]));
    let [x, y, z] = tool.inverse().transform_point([0.0, 0.0, 0.35]);
    let _ = writeln!(text, "[tool]\nxyz = [{x}, {y}, {z}]\n[[ik]]\nname = \"p\"\ntarget = \"position\"");
    let arm = engine::interpreter(&text).unwrap();
    let target = Target::Position([0.0, 0.0, 0.35]);
    let seed = [0.7, 0.02, -0.01];
    let found = solutions(&*arm, "p", &target, Some(Seed::new(&seed))).unwrap();
    let near =
        found.iter().find(|(q, _)| (q[0] - 0.7).abs() < 1e-6 && q[1].abs() < 1e-6 && q[2].abs() < 1e-6);
    assert_eq!(near.map(|(_, free)| *free), Some(Some(0)), "{found:?}\n{text}");
    // Without a seed there is one of that curve all the same.
    let found = solutions(&*arm, "p", &target, None).unwrap();
    let there: Vec<_> = found.iter().filter(|(q, _)| q[1].abs() < 1e-6 && q[2].abs() < 1e-6).collect();
    assert!(there.len() == 1 && there[0].1 == Some(0), "{found:?}");
}

#[test]
fn what_is_out_of_reach_is_said_to_be() {
    let mut random = Random(3);
    let mut text = table(4, Some((2, -1.0)), None, &mut random);
    text.push_str("[[ik]]\nname = \"p\"\ntarget = \"position\"\n");
    let arm = engine::interpreter(&text).unwrap();
    let refused = solutions(&*arm, "p", &Target::Position([9.0, 0.0, 0.0]), None);
    assert!(matches!(refused, Err(IkError::Unreachable { excess, .. }) if excess > 1.0), "{refused:?}");
}

#[test]
fn generated_code_gives_the_bits_of_the_interpreter() {
    let mut random = Random(8);
    let text = include_str!("searched/palletiser.toml");
    let interpreter = engine::interpreter(text).unwrap();
    for problem in [FULL_POSE, "place", "place_ahead"] {
        for _ in 0..12 {
            let q: Vec<f64> = (0..4).map(|_| PI * random.symmetric()).collect();
            let kind = if problem == FULL_POSE { TargetKind::Pose } else { TargetKind::PositionYaw };
            let target = target_of(kind, &Palletiser.fk(&[q[0], q[1], q[2], q[3]]).into());
            let theirs = solutions(&*interpreter, problem, &target, None);
            assert_eq!(solutions(&Palletiser, problem, &target, None), theirs, "{problem} at {q:?}");
            assert!(theirs.is_ok() || problem == "place_ahead");
        }
    }
    // In f32 a target is known to a few digits only; the search is in f64.
    let arm = Linked;
    for _ in 0..6 {
        let q: [f32; 6] = std::array::from_fn(|_| (PI * random.symmetric()) as f32);
        let target: Target<f32> = Target::Pose(arm.fk(&q).into());
        let found = solutions(&arm, FULL_POSE, &target, None).unwrap();
        let apart = |other: &[f32]| {
            q.iter()
                .zip(other)
                .map(|(a, b)| f64::from(a - b))
                .fold(0.0_f64, |most, off| most.max((off - TAU * (off / TAU).round()).abs()))
        };
        assert!(found.iter().any(|(other, _)| apart(other) < 2e-2), "{q:?}: {found:?}");
    }
}

/// A table of rows without joints of its own, with an `[[ik]]` entry.
fn with_problem(rows: &str, problem: &str) -> String {
    format!("[robot]\nname = \"flat\"\nconvention = \"standard\"\n{rows}[[ik]]\nname = \"p\"\n{problem}")
}

/// What is said of a table.
fn said(text: &str) -> String {
    compile(text, Level::Quick).diagnostics.render(text, "flat.toml", dh_codegen::diagnostic::Style::Plain)
}

fn is_solved(text: &str) -> bool {
    let output = compile(text, Level::Quick).output;
    output.is_some_and(|output| output.unsolved.iter().all(|unsolved| unsolved.problem.is_none()))
}

/// What no target of this kind can determine is refused, and what could be is named.
#[test]
fn arms_that_are_singular_everywhere_are_told_so() {
    let row = "[[joint]]\na = 0.3\n";
    let three = row.repeat(3);
    let refused = said(&with_problem(&three, "target = \"position\"\n"));
    assert!(
        refused.contains("J1, J2 and J3 move the tool in 2 of the 3 ways that `position` prescribes"),
        "{refused}"
    );
    assert!(refused.contains("can meet another target: `xy_yaw`"), "{refused}");
    assert!(is_solved(&with_problem(&three, "target = \"xy_yaw\"\n")));

    // What is tied to others need not be held with them.
    let four = row.repeat(4);
    let tied = |more: &str| format!("{more}constraints = [\"q1 + q2 + q3 + q4 = 0\"");
    let refused = said(&with_problem(&four, &format!("target = \"position\"\n{}]\n", tied(""))));
    assert!(refused.contains("J1, J2, J3 and J4 move the tool in 2 of the 3 ways"), "{refused}");
    assert!(
        refused.contains(
            "hold 1 of them, or leave 1 to the caller (`free`), and prescribe a target with 2 rows"
        ),
        "{refused}"
    );
    assert!(is_solved(&with_problem(&four, &format!("target = \"xy\"\n{}, \"q1 = 0.2\"]\n", tied("")))));

    // A joint that the caller gives doesn't move.
    let five = row.repeat(5);
    let given = tied("target = \"position\"\nfree = [\"J5\"]\n");
    let refused = said(&with_problem(&five, &format!("{given}]\n")));
    assert!(refused.contains("J1, J2, J3 and J4 move the tool in 2 of the 3 ways"), "{refused}");
}

/// Each reason has its own words, and what they say to write instead is solved.
#[test]
fn followers_that_no_search_takes_are_told_why() {
    let rows = |slides: bool, factor: &str| {
        let second = if slides { "type = \"prismatic\"\n" } else { "" };
        format!(
            "[[joint]]\na = 0.3\nalpha = 1.2\n[[joint]]\n{second}a = 0.2\nalpha = 0.7\n\
             [[joint]]\na = 0.3\nalpha = 1.0\nfixed = 0\ncouple = {{ J2 = {factor} }}\n[[joint]]\na = 0.4\nalpha = 0.3\n"
        )
    };
    let position = "target = \"position\"\n";

    let refused = said(&with_problem(&rows(true, "2"), position));
    assert!(refused.contains("`J3`, an angle, follows `J2`, a length"), "{refused}");
    assert!(refused.contains("hold `J2` by a constraint"), "{refused}");
    assert!(is_solved(&with_problem(&rows(true, "2"), "target = \"xy\"\nconstraints = [\"d2 = 0.1\"]\n")));

    let refused = said(&with_problem(&rows(false, "0.37"), position));
    assert!(
        refused.contains("`J3` follows `J2` by a factor of 0.37: not even 24 whole turns of `J2`"),
        "{refused}"
    );
    assert!(refused.contains("a fraction with a denominator of up to 24"), "{refused}");
    assert!(is_solved(&with_problem(&rows(false, "1.5"), position)));
    assert!(is_solved(&with_problem(&rows(false, "0.37"), "target = \"xy\"\nfree = [\"J2\"]\n")));

    let four: String =
        ["1.2", "0.7", "1.0", "0.3"].map(|alpha| format!("[[joint]]\na = 0.3\nalpha = {alpha}\n")).concat();
    let tied =
        |constraint: &str| with_problem(&four, &format!("{position}constraints = [\"{constraint}\"]\n"));
    let refused = said(&tied("theta2 = 1.5 * theta3"));
    assert!(
        refused.contains("the constraint `theta2 = 1.5 * theta3` has a factor that is no whole number"),
        "{refused}"
    );
    assert!(refused.contains("multiply it by 2"), "{refused}");
    assert!(is_solved(&tied("2 * theta2 = 3 * theta3")));
}
