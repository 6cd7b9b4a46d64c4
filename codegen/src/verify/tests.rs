use super::{Level, Report, verify};
use crate::diagnostic::Diagnostics;
use crate::model::{Convention, JointKind, Model, Target};
use crate::plan::fixtures::{
    PLANAR_2R, PLANAR_2R_CONSTANTS, SCARA, SCARA_CONSTANTS, angle, linear, plan, planar_2r, problem, robot,
    row, scara,
};
use crate::plan::{FunctionKind, Plan};

fn run(model: &Model, text: &str, constants: &[(&str, f64)], level: Level) -> (Plan, Report, Diagnostics) {
    let mut diagnostics = Diagnostics::default();
    let (plan, report) = verify(model, plan(constants, text), level, &mut diagnostics);
    (plan, report, diagnostics)
}

/// The functions that are left out when the plan says something else in one place.
fn refused(model: &Model, text: &str, constants: &[(&str, f64)], from: &str, to: &str) -> Vec<String> {
    assert!(text.contains(from), "{from}");
    let mutated = text.replacen(from, to, 1);
    let (_, quick, warnings) = run(model, &mutated, constants, Level::Quick);
    let (left, report, _) = run(model, &mutated, constants, Level::Full);
    let failed = |report: &Report| -> Vec<String> {
        let failed = report.functions.iter().filter(|function| function.failure.is_some());
        failed.map(|function| function.name.clone()).collect()
    };
    assert_eq!(left.functions.len() + failed(&report).len(), report.functions.len());
    assert_eq!(failed(&quick), failed(&report), "both levels see it");
    assert_eq!(warnings.len(), failed(&quick).len());
    assert!(!warnings.has_errors());
    failed(&report)
}

#[test]
fn sound_plans_pass() {
    for level in [Level::Quick, Level::Full] {
        for (model, text, constants, count) in
            [(planar_2r(), PLANAR_2R, PLANAR_2R_CONSTANTS, 6), (scara(), SCARA, SCARA_CONSTANTS, 7)]
        {
            let (plan, report, diagnostics) = run(&model, text, constants, level);
            let failures: Vec<_> =
                report.functions.iter().filter_map(|function| function.failure.clone()).collect();
            assert!(failures.is_empty(), "{failures:?}");
            assert!(diagnostics.is_empty());
            assert_eq!((plan.functions.len(), report.functions.len()), (count, count));
            for function in &report.functions {
                let poses = if level == Level::Full { 200 } else { 16 };
                assert!(function.poses >= poses, "{}: {} poses", function.name, function.poses);
                assert!(function.position_error < 1e-12 && function.rotation_error < 1e-12);
                let Some(inverse) = &function.inverse else { continue };
                assert_eq!(inverse.originals, inverse.originals_found);
                assert!(inverse.solutions[1] > 0 && inverse.solutions.get(3).is_none());
                assert!(inverse.originals >= poses - 1);
                let branches = if function.name == "ik_all_point_left" { 1 } else { 2 };
                assert!(inverse.solutions[branches] >= poses - 1);
            }
        }
    }
}

#[test]
fn mutations_of_forward_functions_are_caught() {
    let model = planar_2r();
    for (from, to, expected) in [
        // Each in `fk` first, on which every inverse problem relies.
        ("a1 * c1 + a2 * c12", "a1 * c1 - a2 * c12", &["fk", "ik_all_point"][..]),
        ("a1 * s1 + a2 * s12", "a2 * s1 + a2 * s12", &["fk", "ik_all_point"]),
        ("out c12, -s12", "out c12, s12", &["fk", "ik_all_point"]),
        ("out -(a1 * s1)", "out a1 * s1", &["jacobian"]),
        ("-(a2 * s12), a2 * c12, 0, 0, 0, 1", "-(a2 * s12), a2 * c12, 0, 0, 0, 0", &["jacobian"]),
        ("-py, px, 0", "-py, px, 0.001", &["fk_jacobian"]),
        ("x1 + a2 * c12", "x1 + a1 * c12", &["frames"]),
        ("out c1, -s1", "out c1, -s1 / 0 * 0", &["frames"]),
    ] {
        assert_eq!(refused(&model, PLANAR_2R, PLANAR_2R_CONSTANTS, from, to), expected, "{from} -> {to}");
    }
    let model = scara();
    for (from, to, expected) in [
        ("out 0, 0, -1, 0", "out 0, 0, 1, 0", &["jacobian"][..]),
        ("z3 - d4", "z3 + d4", &["frames"]),
        (
            "a1 * s1 + a2 * s12, 0, 0, -1, d1 - q3 - d4",
            "a1 * s1 + a2 * s12, 0, 0, -1, d1 - q3",
            &["fk_flange"],
        ),
    ] {
        assert_eq!(refused(&model, SCARA, SCARA_CONSTANTS, from, to), expected, "{from} -> {to}");
    }
}

#[test]
fn mutations_of_inverse_problems_are_caught() {
    let model = planar_2r();
    for (from, to) in [
        // A sign, a coefficient, a coordinate.
        ("pair length(x, -y, px", "pair length(x, y, px"),
        ("trig area(2 * a1 * a2", "trig area(a1 * a2"),
        ("- a2 * a2)", "+ a2 * a2)"),
        ("accept theta1, theta2", "accept theta1, -theta2"),
        // An unknown that is none; no candidates at all.
        ("trig area(2 * a1 * a2, 0, px * px + py * py - a1 * a1 - a2 * a2)", "linear ratio(1, 1)"),
        ("      accept theta1, theta2", "      k = 0"),
    ] {
        assert_eq!(
            refused(&model, PLANAR_2R, PLANAR_2R_CONSTANTS, from, to),
            ["ik_all_point"],
            "{from} -> {to}"
        );
    }
    let model = scara();
    for (from, to, expected) in [
        ("r11, s12, -c12, r21", "r11, s12, -c12, r12 / 2", "ik_all"),
        ("linear length(1, d1 - d4 - pz)", "linear length(1, d1 - pz)", "ik_all"),
        ("accept theta1, theta2, d3, theta1 + theta2", "accept theta1, theta2, d3, theta1", "ik_all_point"),
        ("accept theta1, theta2, d3, theta1 + theta2", "accept theta1, theta2, d3, theta2", "ik_all_point"),
    ] {
        assert_eq!(refused(&model, SCARA, SCARA_CONSTANTS, from, to), [expected], "{from} -> {to}");
    }
    // A constant of the plan that is not the table's ends every function that uses it.
    let wrong = [("d1", 0.4), ("a1", 0.325), ("a2", 0.276), ("d4", 0.05)];
    let (left, ..) = run(&model, SCARA, &wrong, Level::Quick);
    assert_eq!(left.functions.len(), 0);
}

#[test]
fn a_missing_branch_is_named_with_numbers() {
    // theta9 = theta2 - pi/2 in (-pi, pi]: for theta2 < -pi/2 a turn more, of which half is too much for theta1. What
    // else there is is right.
    let model = planar_2r();
    let missing = PLANAR_2R.replace(
        "      accept theta1, theta2",
        "      for theta9 = pair ratio(1, 0, s2, 0, 1, -c2)
        half = (theta9 - theta2 + 1.5707963267948966) / 2
        accept theta1 + half, theta2",
    );
    let (left, report, diagnostics) = run(&model, &missing, PLANAR_2R_CONSTANTS, Level::Quick);
    assert_eq!((left.functions.len(), diagnostics.len()), (5, 1));
    let failure = report.functions[5].failure.clone().unwrap();
    assert!(failure.starts_with("a branch is missing: the nearest solution is "), "{failure}");
    assert!(failure.contains("asked for the pose at q = ["), "{failure}");
    let drawn = diagnostics.sorted()[0];
    assert!(drawn.message.starts_with("`ik_all_point` is left out") && drawn.labels.len() == 1);
}

#[test]
fn invalid_functions_are_left_out_alone() {
    let mut broken = plan(SCARA_CONSTANTS, SCARA);
    broken.functions[2].outputs.pop();
    let mut diagnostics = Diagnostics::default();
    let (left, report) = verify(&scara(), broken, Level::Quick, &mut diagnostics);
    assert_eq!(left.functions.len(), 6);
    assert_eq!(report.functions[2].failure.as_deref(), Some("the function has 24 outputs, its plan 23"));
}

#[test]
fn modified_rows_couplings_and_held_rows_are_judged_by_their_own_axes() {
    // Modified: each row moves before it turns. The second joint is geared: theta2 = q2 - q1 / 2.
    let mut model = planar_2r();
    model.convention = Convention::Modified;
    model.rows[1].terms.push((0, -0.5));
    model.tool.xyz = [0.0, 0.1, 0.0];
    model.problems.clear();
    let text = "
jacobian: q1 q2
  s1 c1 = sincos q1
  s12 c12 = sincos q1 / 2 + q2
  px = a2 * c1 - 0.1 * s12
  py = a2 * s1 + 0.1 * c12
  vx = -0.1 * c12
  vy = -0.1 * s12
  out -(a2 * s1) + vx / 2, a2 * c1 + vy / 2, 0, 0, 0, 0.5
  out vx, vy, 0, 0, 0, 1
";
    let (left, report, _) = run(&model, text, PLANAR_2R_CONSTANTS, Level::Full);
    assert_eq!(left.functions.len(), 1, "{report:?}");
    // A held row in front moves nothing by itself, and a slide is along its axis.
    model.rows[1].kind = JointKind::Prismatic;
    let (left, ..) = run(&model, text, PLANAR_2R_CONSTANTS, Level::Quick);
    assert!(left.functions.is_empty());
}

#[test]
fn constraints_with_fractions_hold_modulo_what_turns_make_of_them() {
    // theta2 = theta1 / 2: a turn of the first joint moves the right-hand side by half a turn.
    let mut model = planar_2r();
    let constraint = linear(&[(1, 1.0), (0, -0.5)], angle(0));
    model.problems = vec![problem("geared", Target::Xy, vec![constraint], Vec::new())];
    let constraints = super::constraints::Constraints::of(&model, model.problems.first());
    assert_eq!(constraints.independent.len(), 1);
    let mut q = vec![0.3, 0.7];
    constraints.complete(&mut q);
    assert!(constraints.excess(&q) < 1e-15 && (q[1] * 2.0 - q[0]).abs() < 1e-15, "{q:?}");
    assert!(constraints.excess(&[0.3, 0.15 + std::f64::consts::PI]) < 1e-15);
    assert!((constraints.excess(&[0.3, 0.25]) - 0.1).abs() < 1e-15);
    let rate = constraints.direction(constraints.independent[0], 2);
    assert!((rate[1] * 2.0 - rate[0]).abs() < 1e-15);
    assert_eq!(super::name(&model, &FunctionKind::Inverse(Some(0)), &[]), "ik_all_geared");
    assert_eq!(super::name(&model, &FunctionKind::Inverse(Some(0)), &[1]), "ik_at_geared");
}

#[test]
fn forward_functions_of_the_compiler_pass() {
    let rows = [
        (0.089_159, 0.0, 90),
        (0.0, -0.425, 0),
        (0.0, -0.392_25, 0),
        (0.109_15, 0.0, 90),
        (0.094_65, 0.0, -90),
        (0.0823, 0.0, 0),
    ];
    let ur5 = rows.into_iter().enumerate().map(|(index, (d, a, alpha))| row(index, d, a, alpha)).collect();
    for model in [robot(ur5), planar_2r(), scara()] {
        let mut diagnostics = Diagnostics::default();
        let (_, report) = verify(&model, crate::plan::build(&model).0, Level::Full, &mut diagnostics);
        for function in &report.functions {
            assert_eq!(function.failure, None, "{}", function.name);
            if function.inverse.is_some() {
                continue;
            }
            assert!(function.position_error < 1e-14 && function.rotation_error < 1e-14);
        }
        assert!(report.functions.len() >= 5 && diagnostics.is_empty());
    }
}

#[test]
fn random_poses_take_every_side_of_any_three_joints() {
    let rows = (0..6).map(|index| row(index, 0.1, 0.2, 90)).collect();
    let model = robot(rows);
    let constraints = super::constraints::Constraints::of(&model, None);
    let poses = super::poses::poses(&model, &constraints, Level::Quick, 1.0, |_| true);
    for [one, two, three] in [[0, 1, 2], [1, 2, 4], [2, 4, 5], [0, 3, 5]] {
        let side = |q: &Vec<f64>| [one, two, three].map(|joint| q[joint] > 0.0);
        let sides: std::collections::HashSet<[bool; 3]> = poses[..16].iter().map(side).collect();
        assert_eq!(sides.len(), 8);
    }
}
