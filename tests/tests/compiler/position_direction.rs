//! A point with the direction of the tool's z axis, five joints: which classes of arms have a closed form, and that every
//! target that joint values give has solutions that meet it, these joint values among them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::branch::check;
use super::classes::{Random, modified_rows, table};
use dh_codegen::compile;
use dh_codegen::emit::text;
use dh_codegen::plan::{Agreement, FunctionKind, Step};
use dh_codegen::verify::Level;
use dh_core::{Frame, Kinematics, Seed, SolutionSet, Target, TargetKind, residual_tolerance};
use dh_tests::engine;
use dh_tests::oracle::Oracle;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::sync::LazyLock;

/// Rows as in [`super::classes`]. The axis of the tool meets that of the last joint in the origin of the last row's frame, or
/// `beside` it, anywhere along that axis.
const CLASSES: &[(&str, &str, bool, bool)] = &[
    ("three parallel axes, the next two meet", "LTL L0L L0L 0TL 00L", false, true),
    ("three parallel axes above a first one that meets them", "0TL L00 L00 0T0 00L", false, true),
    ("three parallel axes, reversed and coupled", "LTL -L0L CL0L C0TL -00L", false, true),
    ("axes 4, 5 and the tool's meet, an elbow before", "LTL L0L LTL 0TL 000", false, false),
    ("axes 4, 5 and the tool's meet, the elbow in a plane", "0TL L00 0T0 0TL 000", false, false),
    ("a slide before axes that meet", "0TL LT0 P0T 0TL 000", false, false),
];

/// In place of what `table` writes: a tool whose axis is oblique, or at a right angle to the last joint's, and whose point is
/// along that axis from where it meets that of the last joint.
fn with_tool(text: &str, square: bool, beside: bool, random: &mut Random) -> String {
    let rows = text.split("\n[tool]").next().unwrap_or(text);
    let degrees = if square { [90.0, 0.0, 0.0] } else { [0; 3].map(|_| 20.0 + 50.0 * random.unit()) };
    let [(sr, cr), (sp, cp), (sy, cy)] = degrees.map(|angle: f64| angle.to_radians().sin_cos());
    let axis = [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr];
    let (along, foot) = (random.length(), if beside { random.length() } else { 0.0 });
    let [x, y, z] = axis.map(|entry| entry * along);
    format!("{rows}\n[tool]\nxyz = [{x}, {y}, {}]\nrpy = {degrees:?}\n{ENTRY}", z + foot)
}

const ENTRY: &str = "\n[[ik]]\nname = \"aim\"\ntarget = \"position_direction\"\n";

/// The tables of a class: both conventions, square and oblique tools, and rows that are held behind the last joint.
fn tables(rows: &str, skew: bool, beside: bool, random: &mut Random) -> Vec<String> {
    let drawn = table(rows, skew, random);
    let mut tables = Vec::new();
    for square in [true, false] {
        let text = with_tool(&drawn, square, beside, random);
        tables.push(modified_rows(&text));
        if beside {
            let held = format!("\n[[joint]]\nfixed = 35\nd = {}\n\n[tool]", random.length());
            tables.push(text.replace("\n[tool]", &held));
        }
        tables.push(text);
    }
    tables
}

/// A table of a class, with its oracle and its interpreter.
struct Arm {
    class: &'static str,
    text: String,
    oracle: Oracle,
    engine: Box<dyn Kinematics + Send + Sync>,
}

/// Compiled once for all tests.
static ARMS: LazyLock<Vec<Arm>> = LazyLock::new(|| {
    let mut random = Random(11);
    let mut arms = Vec::new();
    for (class, rows, skew, beside) in CLASSES {
        for text in tables(rows, *skew, *beside, &mut random) {
            let (oracle, engine) = (Oracle::read(&text).unwrap(), engine::interpreter(&text).unwrap());
            arms.push(Arm { class, text, oracle, engine });
        }
    }
    arms
});

#[test]
fn classes_of_five_joints_have_a_closed_form_that_another_method_confirms() {
    let mut random = Random(20_261_123);
    for (class, rows, skew, beside) in CLASSES {
        for table in tables(rows, *skew, *beside, &mut random) {
            let output = compile(&table, Level::Full).output.unwrap();
            let aim = output.plan.functions.iter().find(|f| f.kind == FunctionKind::Inverse(Some(0)));
            let aim = aim.unwrap_or_else(|| panic!("{class}\n{table}"));
            let at_once = |step: &Step| matches!(step, Step::General { .. } | Step::Descents { .. });
            assert!(!aim.steps.iter().any(at_once), "{class}\n{table}");
            let Some(Agreement { method, poses, agreed, .. }) = &aim.agreement else {
                panic!("{class}\n{table}")
            };
            assert_eq!(poses, agreed, "{class}: {method}\n{table}");
            let options = text::Options { part: text::Part::InverseKinematics, numeric: false };
            let equations = text::print(&output.model, &output.plan, &options);
            assert!(equations.contains("left open: how the tool is turned about its z axis"), "{equations}");
        }
    }
}

fn target_of(pose: &[[f64; 4]; 4]) -> Target {
    let [x, y, z, _] = *pose;
    let rows = [x, y, z].map(|[a, b, c, p]| ([a, b, c], p));
    let frame = Frame { rotation: rows.map(|row| row.0), translation: rows.map(|row| row.1) };
    Target::of_frame(TargetKind::PositionDirection, &frame)
}

/// Solves for the point and direction at `q`, which solutions may miss by so much; how far the nearest solution is.
fn there_and_back(arm: &dyn Kinematics, oracle: &Oracle, q: &[f64], most: f64) -> Result<f64, String> {
    let pose = oracle.fk(q);
    let mut set = SolutionSet::new();
    arm.ik_into("aim", &target_of(&pose), &mut set).map_err(|error| error.to_string())?;
    let mut nearest = f64::INFINITY;
    for solution in set.iter() {
        let found = oracle.fk(solution.q);
        for (row, wanted) in found.iter().zip(&pose) {
            let off = (row[2] - wanted[2]).abs().max((row[3] - wanted[3]).abs());
            if off > most {
                return Err(format!("{:?} misses by {off:e}", solution.q));
            }
        }
        let joints = solution.q.iter().zip(q).zip(&oracle.chain().joints);
        let apart = joints.map(|((a, b), row)| {
            let turns = !oracle.chain().rows[*row].prismatic;
            if turns { ((a - b + PI).rem_euclid(2.0 * PI) - PI).abs() } else { (a - b).abs() }
        });
        nearest = nearest.min(apart.fold(0.0, f64::max));
    }
    Ok(nearest)
}

#[test]
fn every_point_and_direction_of_an_arm_is_solved() {
    let mut random = Random(11);
    for Arm { class, text, oracle, engine } in ARMS.iter() {
        let chain = oracle.chain();
        for number in 0..90 {
            let joints = chain.joints.iter().map(|&row| match (chain.rows[row].prismatic, number % 3) {
                (true, _) => random.unit() - 0.5,
                (false, 0) => PI * random.symmetric(),
                (false, 1) => FRAC_PI_4 * (8.0 * random.unit()).floor(),
                _ => 2.0 * FRAC_PI_4 * (4.0 * random.unit()).floor() + 1e-7 * random.symmetric(),
            });
            let q: Vec<f64> = joints.collect();
            // Beside singular poses, solutions are what misses a target by no more than this.
            let most = if number % 3 == 2 { residual_tolerance::<f64>() * oracle.reach() } else { 2e-11 };
            let nearest = there_and_back(engine.as_ref(), oracle, &q, most);
            let nearest = nearest.unwrap_or_else(|error| panic!("{class} at {q:?}: {error}\n{text}"));
            assert!(number % 3 != 0 || nearest < 1e-7, "{class} at {q:?}: {nearest:e}\n{text}");
        }
    }
}

/// A seed that is a solution is found, though the target leaves a joint free.
#[test]
fn a_seed_is_found_where_axes_are_aligned() {
    let mut random = Random(17);
    for Arm { class, text, oracle, engine } in ARMS.iter() {
        for _ in 0..60 {
            let q: Vec<f64> = (0..engine.dof())
                .map(|_| match random.unit() {
                    any if any < 0.4 => any * 2.0,
                    any => ((any * 20.0).floor() - 12.0) * FRAC_PI_4,
                })
                .collect();
            let target = target_of(&oracle.fk(&q));
            let mut set = SolutionSet::new();
            engine
                .ik_seeded_into("aim", &target, &[], Some(Seed::new(&q)), &mut set)
                .unwrap_or_else(|error| panic!("{class} at {q:?}: {error}\n{text}"));
            let apart = |found: &[f64]| {
                let joints = found.iter().zip(&q).map(|(a, b)| (a - b + PI).rem_euclid(2.0 * PI) - PI);
                joints.fold(0.0, |most: f64, apart| most.max(apart.abs()))
            };
            let nearest = set.iter().map(|solution| apart(solution.q)).fold(f64::INFINITY, f64::min);
            // Double roots are known to half of the digits.
            assert!(nearest < 1e-5, "{class} at {q:?}: {nearest:e}\n{text}");
        }
    }
}

/// Signs change at singularities only.
#[test]
fn branches_stay_along_paths() {
    let mut random = Random(23);
    for (class, rows, skew, beside) in CLASSES {
        let text = with_tool(&table(rows, *skew, &mut random), false, *beside, &mut random);
        let mut seen = 0;
        for text in [modified_rows(&text), text] {
            let arm = engine::interpreter(&text).unwrap();
            assert!(
                arm.problems().iter().any(|info| info.name == "aim" && info.branch.len() == 3),
                "{class}"
            );
            let walked = check(&*arm, &mut random, 8, 1);
            seen += walked.unwrap_or_else(|error| panic!("{class}, {error}\n{text}")).steps;
        }
        assert!(seen > 50, "{class}: {seen}");
    }
}

/// The last joint turns about the tool's axis: no target says anything of it.
#[test]
fn an_arm_whose_last_joint_only_turns_the_tool_is_refused() {
    let mut random = Random(3);
    let rows = table("LTL L0L L0L 0TL 00L", false, &mut random);
    let rows = rows.split("\n[tool]").next().unwrap();
    let compilation = compile(&format!("{rows}\n[tool]\nxyz = [0, 0, 0.1]\n{ENTRY}"), Level::Full);
    let text = format!("{:?}", compilation.diagnostics);
    assert!(text.contains("4 of the 5 ways"), "{text}");
    assert!(text.contains("J5 by itself moves nothing of it: hold it by a constraint"), "{text}");
    assert!(text.contains("a target with 4 rows: `position_yaw`"), "{text}");
    assert!(text.contains("or prescribe the whole `pose`"), "{text}");
}

/// An arm of six whose tool is square to the last axis, its last joint given: where that is a quarter turn and the arm stretched,
/// what is missing vanishes to third order.
const SQUARE_TOOL: &str = "[robot]\nname = \"square\"\nconvention = \"standard\"\nunits = { length = \"m\", angle = \"deg\" }\n\
    [[joint]]\nd = 0.09\nalpha = 90\n[[joint]]\na = -0.425\n[[joint]]\na = -0.392\n[[joint]]\nd = 0.109\nalpha = 90\n\
    [[joint]]\nd = 0.0947\nalpha = -90\n[[joint]]\n[tool]\nxyz = [0.0, 0.1, 0.05]\nrpy = [0, 90, 0]\n\
    [[ik]]\nname = \"aim\"\ntarget = \"position_direction\"\nfree = [\"J6\"]\n";

#[test]
fn a_target_that_is_met_to_third_order_has_its_solution() {
    let compiled = compile(SQUARE_TOOL, Level::Full);
    let plan = &compiled.output.unwrap().plan;
    let aim = plan.functions.iter().find(|f| f.kind == FunctionKind::Inverse(Some(0))).unwrap();
    assert!(matches!(aim.steps.as_slice(), [Step::General { .. }]), "{:?}", compiled.diagnostics);
    let (oracle, arm) = (Oracle::read(SQUARE_TOOL).unwrap(), engine::interpreter(SQUARE_TOOL).unwrap());
    for quarters in [
        [-1.0, -1.0, 0.0, 1.0, -1.0, -1.0],
        [1.0, -1.0, 0.0, 1.0, -1.0, -1.0],
        [0.0, -1.0, 0.0, 1.0, -1.0, -1.0],
    ] {
        let q = quarters.map(|quarters| quarters * FRAC_PI_2);
        let mut set = SolutionSet::new();
        arm.ik_at_into("aim", &target_of(&oracle.fk(&q)), &q[5..], &mut set).unwrap();
        let nearest = set.nearest(&q).unwrap();
        assert!(set.iter().all(|solution| solution.residual() < 1e-9), "{q:?}: {set:?}");
        assert!(nearest.q.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-3), "{q:?}: {set:?}");
    }
}
