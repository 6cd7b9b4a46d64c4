use crate::model::{Convention, JointKind, Linear, Model, Problem, Target};
use crate::symbolic::fixtures::{angle, mycobot, puma560, robot, ur5};

/// Constraints of (row, coefficient) and a constant in degrees.
fn problem(target: Target, constraints: &[(&[(usize, f64)], f64)]) -> Problem {
    let linear = |(terms, degrees): &(&[(usize, f64)], f64)| Linear {
        terms: terms.to_vec(),
        constant: angle(*degrees),
        text: String::new(),
        span: 0..0,
    };
    Problem {
        name: "test".to_string(),
        target,
        constraints: constraints.iter().map(linear).collect(),
        filters: Vec::new(),
        free: Vec::new(),
        span: 0..0,
        line: 1,
    }
}

/// Derives, plans and verifies a problem on many poses; the steps' unknowns and equations, line by line.
fn solved(mut model: Model, problem: Problem) -> String {
    model.problems = vec![problem];
    let (plan, unsolved) = crate::plan::build(&model);
    assert_eq!(unsolved, []);
    let mut diagnostics = crate::diagnostic::Diagnostics::default();
    let (plan, report) = crate::verify::verify(&model, plan, crate::verify::Level::Full, &mut diagnostics);
    let failures: Vec<_> = report.functions.iter().filter_map(|function| function.failure.clone()).collect();
    assert_eq!(failures, Vec::<String>::new());
    let inverse = plan.functions.last().unwrap();
    let stages = inverse.stages.iter();
    let lines: Vec<String> = stages.map(|stage| format!("{}: {}", stage.unknown, stage.equation)).collect();
    format!("{}\n", lines.join("\n"))
}

fn tool_down() -> Vec<(&'static [(usize, f64)], f64)> {
    vec![(&[(3, 1.0), (1, 1.0), (2, 1.0)], 90.0), (&[(4, 1.0)], -90.0), (&[(5, 1.0), (0, -1.0)], 0.0)]
}

#[test]
fn mycobot_with_its_tool_down_is_the_published_derivation() {
    let steps = solved(mycobot(), problem(Target::Position, &tool_down()));
    expect_test::expect![[r"
        theta1: py c1 - px s1 = -d4
        theta3: 2 a2 a3 c3 = z0^2 + x1^2 - a3^2 - a2^2
        theta2: (a3 c3 + a2) c2 - a3 s3 s2 = x1; a3 s3 c2 + (a3 c3 + a2) s2 = z0
    "]]
    .assert_eq(&steps);
}

#[test]
fn more_of_a_pose_may_be_prescribed() {
    solved(mycobot(), problem(Target::PositionYaw, &tool_down()[..2]));
    let constraints: &[(&[(usize, f64)], f64)] =
        &[(&[(3, 1.0), (1, 1.0), (2, 1.0)], -90.0), (&[(4, 1.0)], -90.0), (&[(5, 1.0)], 0.0)];
    solved(ur5(), problem(Target::Position, constraints));
    solved(ur5(), problem(Target::PositionYaw, &constraints[..2]));
}

/// d, a and alpha (deg) of joints whose axes 3, 4 and 5 meet in a point; what lies between the first two is given.
fn spherical_elbow(a: f64, alpha: f64) -> Model {
    let rows = [
        [0.3, a, alpha, 0.0],
        [0.1, 0.4, 90.0, 0.0],
        [0.2, 0.0, 90.0, 0.0],
        [0.0, 0.0, -90.0, 0.0],
        [0.25, 0.15, 90.0, 0.0],
        [0.1, 0.0, 0.0, 0.0],
    ];
    robot(Convention::Standard, &rows)
}

#[test]
fn three_axes_that_meet_between_others_come_last() {
    // Axes 1 and 2 are parallel.
    let steps = solved(spherical_elbow(0.35, 0.0), problem(Target::Pose, &[]));
    expect_test::expect![[r"
        theta6: (a5 r31 + d5 r32) c6 - (a5 r32 - d5 r31) s6 = z0
        theta2: 2 a1 a2 c2 + 2 a1 d3 s2 = n0_2
        theta1: (a2 c2 + a1 + d3 s2) c1 - (a2 s2 - d3 c2) s1 = x0; (a2 s2 - d3 c2) c1 + (a2 c2 + a1 + d3 s2) s1 = y0
        theta4: c4 = -zy1
        theta3: s4 c3 = -zx1; s4 s3 = -zz0
        theta5: c5 = xx4_2; s5 = -xz3
    "]].assert_eq(&steps);
    // They meet.
    let steps = solved(spherical_elbow(0.0, 90.0), problem(Target::Pose, &[]));
    assert_eq!(steps.lines().filter(|line| line.starts_with("theta")).count(), 6);
}

#[test]
fn two_equations_in_two_angles_make_a_quartic() {
    let steps = solved(spherical_elbow(0.35, 90.0), problem(Target::Pose, &[]));
    let first = steps.lines().next().unwrap();
    expect_test::expect![
        "theta6: (k + l c6 - m s6)^2 + (k_2 + l_2 c6 - m_2 s6)^2 = (a1 (2 d3^2 + 2 a2^2))^2"
    ]
    .assert_eq(first);
}

#[test]
fn planar_arms_have_both_elbows() {
    let two = robot(Convention::Standard, &[[0.0, 0.16, 0.0, 0.0], [0.0, 0.12, 0.0, 0.0]]);
    solved(two, problem(Target::Xy, &[]));
    let three = [[0.0, 0.16, 0.0, 0.0], [0.0, 0.12, 0.0, 10.0], [0.0, 0.05, 0.0, 0.0]];
    solved(robot(Convention::Standard, &three), problem(Target::XyYaw, &[]));
    solved(robot(Convention::Modified, &three), problem(Target::XyYaw, &[]));
}

#[test]
fn sliding_joints_are_solved_for() {
    let rows = [[0.3, 0.25, 0.0, 0.0], [0.0, 0.2, 180.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.1, 0.0, 0.0, 0.0]];
    solved(sliding(robot(Convention::Standard, &rows), &[2]), problem(Target::PositionYaw, &[]));
    let stanford = [[0.4, 0.0, -90.0, 0.0], [0.15, 0.0, 90.0, 0.0], [0.0, 0.0, 0.0, 0.0]];
    solved(sliding(robot(Convention::Standard, &stanford), &[2]), problem(Target::Position, &[]));
    let cylinder = [[0.2, 0.0, 0.0, 0.0], [0.0, 0.0, -90.0, 0.0], [0.1, 0.0, 0.0, 0.0]];
    solved(sliding(robot(Convention::Standard, &cylinder), &[1, 2]), problem(Target::Position, &[]));
    let gantry = [[0.0, 0.0, -90.0, -90.0], [0.0, 0.0, -90.0, -90.0], [0.0, 0.0, 0.0, 0.0]];
    solved(sliding(robot(Convention::Standard, &gantry), &[0, 1, 2]), problem(Target::Position, &[]));
}

#[test]
fn elbow_arms_reach_points_with_every_offset() {
    for shoulder in [0.0, 0.05] {
        for side in [0.0, 0.1] {
            let rows = [[0.3, shoulder, 90.0, 0.0], [side, 0.2, 0.0, 0.0], [0.0, 0.25, 0.0, 0.0]];
            solved(robot(Convention::Standard, &rows), problem(Target::Position, &[]));
            let mut coupled = robot(Convention::Standard, &rows);
            coupled.rows[2].terms = vec![(1, -1.0), (2, 1.0)];
            solved(coupled, problem(Target::Position, &[]));
        }
    }
    let puma: &[(&[(usize, f64)], f64)] = &[(&[(3, 1.0)], 0.0), (&[(4, 1.0)], 0.0), (&[(5, 1.0)], 0.0)];
    solved(puma560(), problem(Target::Position, puma));
}

#[test]
fn wrists_are_turned_and_pointed() {
    let straight = [[0.3, 0.0, 90.0, 0.0], [0.0, 0.0, -90.0, 0.0], [0.0, 0.0, 0.0, 0.0]];
    solved(robot(Convention::Standard, &straight), problem(Target::Rotation, &[]));
    let proximal = [[0.3, 0.0, 0.0, 0.0], [0.0, 0.0, 90.0, 0.0], [0.0, 0.0, -90.0, 0.0]];
    solved(robot(Convention::Modified, &proximal), problem(Target::Rotation, &[]));
    let skew = [[0.3, 0.0, 60.0, 10.0], [0.0, 0.0, -50.0, 0.0], [0.0, 0.0, 0.0, 0.0]];
    solved(robot(Convention::Standard, &skew), problem(Target::Rotation, &[]));
    let held: &[(&[(usize, f64)], f64)] = &[(&[(0, 1.0)], 10.0), (&[(1, 1.0)], 30.0), (&[(2, 1.0)], 0.0)];
    solved(puma560(), problem(Target::Rotation, held));
    let pan_tilt = [[0.3, 0.1, 90.0, 0.0], [0.0, 0.0, 90.0, 0.0]];
    solved(robot(Convention::Standard, &pan_tilt), problem(Target::Direction, &[]));
}

fn sliding(mut model: Model, rows: &[usize]) -> Model {
    for row in rows {
        model.rows[*row].kind = JointKind::Prismatic;
    }
    model.windings.retain(|winding| !rows.contains(&winding.joint));
    model
}

#[test]
fn following_by_a_fraction_is_refused() {
    let rows = [[0.0, 0.3, 0.0, 0.0], [0.0, 0.25, 0.0, 0.0], [0.0, 0.1, 0.0, 0.0]];
    let half: &[(&[(usize, f64)], f64)] = &[(&[(2, 1.0), (0, -0.5)], 0.0)];
    let refusal = super::derive(&robot(Convention::Standard, &rows), &problem(Target::Xy, half)).unwrap_err();
    assert!(matches!(refusal, super::Refusal::ByFraction { times: Some(2), .. }), "{refusal:?}");
}
