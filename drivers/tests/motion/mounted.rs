//! Tools and bases known only at run time: what is solved, and how arms move under them.

use super::checked::{every, planner};
use super::devices::{cobot, good, servos};
use super::{Crane, CraneX7, MyCobot, Planar};
use dh_drivers::Driver;
use dh_drivers::motion::{Move, Robot};
use dh_drivers::mycobot;
use dh_runtime::{Frame, IkError, Kinematics, Mounted, SolutionSet, Target, TargetKind};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

fn tool() -> impl Strategy<Value = Frame> {
    let place = [-0.04..0.04, -0.04..0.04, -0.08..0.08];
    (place, [-1.0..1.0, -1.0..1.0, -1.0..1.0]).prop_map(|(place, turn)| Frame::from_rpy(place, turn))
}

fn base() -> impl Strategy<Value = Frame> {
    ([-0.5..0.5, -0.5..0.5, -0.5..0.5], [-3.0..3.0, -1.5..1.5, -3.0..3.0])
        .prop_map(|(place, turn)| Frame::from_rpy(place, turn))
}

/// How far two sets of joint values are apart, whole turns aside.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| 2.0 * ((a - b) / 2.0).sin().abs()).fold(0.0, f64::max)
}

/// Every solution meets the target and keeps the problem's constraints; `q`, which the target was made from, is found.
fn solved(
    arm: &dyn Kinematics,
    tool: Frame,
    base: Frame,
    problem: &str,
    q: &[f64],
    keeps: impl Fn(&[f64]) -> f64,
) -> bool {
    let mounted = Mounted::new(arm).with_tool(tool).with_base(base);
    let target = Target::Position(mounted.fk(q).unwrap().translation);
    let mut found = SolutionSet::new();
    if mounted.ik_into(problem, &target, &mut found).is_err() {
        return false;
    }
    for solution in found.iter() {
        let (off, _) = target.errors(&mounted.fk(solution.q).unwrap());
        assert!(off < 1e-11 && solution.position_error == off, "{off}");
        assert!(keeps(solution.q) < 1e-9, "{:?}", solution.q);
    }
    found.iter().any(|solution| apart(solution.q, q) < 1e-7)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// The forearm is held, so that the hand's rotation is the same everywhere: no solution is missed.
    #[test]
    fn a_tool_that_is_held_down_finds_its_joint_values(
        [q1, q2, q3] in [-1.5..1.5_f64, -1.9..1.9, -2.5..2.5], tool in tool(), base in base(),
    ) {
        prop_assume!(q3.abs() > 0.05);
        let q = [q1, q2, q3, -FRAC_PI_2 - q2 - q3, 0.0, q1];
        let held = |q: &[f64]| apart(&[q[3], q[4], q[5]], &[-FRAC_PI_2 - q[1] - q[2], 0.0, q[0]]);
        prop_assert!(solved(&MyCobot, tool, base, "tool_down", &q, held));
    }
}

/// The hand prolongs the forearm and turns with it: nothing is missed.
#[test]
fn a_tool_that_turns_with_the_arm_finds_all() {
    let (mut found, mut all) = (0, 0);
    let mut random = 5_u64;
    let mut draw = |min: f64, max: f64| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        min + (random >> 11) as f64 / (1_u64 << 53) as f64 * (max - min)
    };
    for _ in 0..400 {
        let q = [draw(-2.9, 2.9), draw(-1.5, 1.5), 0.0, draw(-2.7, -0.2), 0.0, 0.0, 0.0];
        let tool = Frame::from_translation([draw(-0.05, 0.05), draw(-0.05, 0.05), draw(0.0, 0.12)]);
        let held = |q: &[f64]| apart(&[q[2], q[4], q[5], q[6]], &[0.0; 4]);
        all += 1;
        found += u32::from(solved(&CraneX7, tool, Frame::IDENTITY, "planar", &q, held));
    }
    assert_eq!(found, all);
}

/// A line of the point of a gripper that the table does not know.
#[test]
fn lines_are_those_of_the_mounted_tool() {
    let mounted = Mounted::new(&MyCobot).with_tool(Frame::from_rpy([0.0, 0.02, 0.06], [0.0, 0.0, 0.4]));
    let planner = planner(&mounted, every(10));
    let at = |z| Target::Position([0.15, -0.1, z]);
    let checked = planner
        .plan(
            &[-0.2, -0.3, -1.8, 0.6, 0.0, -0.2],
            &[Move::nearest("tool_down", at(0.12)), Move::line("tool_down", at(0.03))],
        )
        .unwrap();
    for (_, command) in checked.commands(1) {
        let [x, y, _] = mounted.fk(command.positions()).unwrap().translation;
        assert!((x - 0.15).abs() < 2e-5 && (y + 0.1).abs() < 2e-5, "{x} {y}");
    }
    let end = mounted.fk(checked.goal(1).unwrap()).unwrap();
    assert!((end.translation[2] - 0.03).abs() < 1e-9 && (end.z_axis()[2] + 1.0).abs() < 1e-9);
}

#[test]
fn what_cannot_be_reached_with_the_tool_is_said() {
    let mut out = SolutionSet::new();
    let longer = Mounted::new(&Crane).with_tool(Frame::from_translation([0.1, 0.0, 0.0]));
    let far = longer.ik_into("xy", &Target::Xy([3.0, 0.0]), &mut out);
    let Err(IkError::Failed { position_error, .. }) = far else { panic!("{far:?}") };
    let reach = longer.fk(&[0.0; 2]).unwrap().translation[0];
    assert!((position_error - (3.0 - reach)).abs() < 1e-6, "{position_error} with {reach}");
    // Beyond what the arm reaches without it.
    let target = Target::Xy([0.55, 0.05]);
    assert!(Kinematics::ik_into(&Crane, "xy", &target, &mut out).is_err());
    longer.ik_into("xy", &target, &mut out).unwrap();
    assert_eq!(out.len(), 2);
    let expected = TargetKind::Xy;
    let yaw = Target::XyYaw { position: [0.3, 0.1], yaw: 0.2 };
    assert_eq!(longer.ik_into("xy", &yaw, &mut out), Err(IkError::WrongTarget { expected }));
}

/// A tool that turns the hand, and a base that stands aslant.
fn aslant() -> [Frame; 2] {
    let tool = Frame::from_rpy([0.01, -0.02, 0.03], [0.3, -0.4, 0.5]);
    [tool, Frame::from_rpy([0.3, -0.2, 0.1], [0.2, -0.3, 1.0])]
}

/// Moves joints, to a target, along a line and along a curve, between the targets at these joint values: what was planned
/// is a line, and the device ends where it should.
fn driven(arm: &dyn Kinematics, driver: Box<dyn Driver>, problem: &str, places: &[&[f64]; 4]) {
    let info = arm.problems().iter().find(|info| info.name == problem).unwrap();
    let [first, second, third, fourth] = places.map(|q| Target::of_frame(info.target, &arm.fk(q).unwrap()));
    let mut robot = Robot::new(arm, driver).unwrap();
    let moves = [
        Move::joints(places[0]),
        Move::nearest(problem, second),
        Move::line(problem, first),
        Move::curve(problem, vec![second, third, fourth]),
    ];
    let checked = robot.plan(&moves).unwrap();
    let at = |q: &[f64]| arm.fk(q).unwrap();
    for (step, target) in [first, second, first, fourth].into_iter().enumerate() {
        let (position, rotation) = target.errors(&at(checked.goal(step).unwrap()));
        assert!(position < 1e-9 && rotation < 1e-9, "{problem}: {position:e} m, {rotation:e} rad");
    }
    // In what the problem prescribes of a place, the line is straight.
    let flat = matches!(info.target, TargetKind::Xy);
    let place = |q: &[f64]| {
        let [x, y, z] = at(q).translation;
        [x, y, if flat { 0.0 } else { z }]
    };
    let minus = |[a, b, c]: [f64; 3], [d, e, f]: [f64; 3]| [a - d, b - e, c - f];
    let dot = |[a, b, c]: [f64; 3], [d, e, f]: [f64; 3]| a * d + b * e + c * f;
    let from = place(checked.goal(1).unwrap());
    let whole = minus(place(checked.goal(2).unwrap()), from);
    for (_, command) in checked.commands(2) {
        let way = minus(place(command.positions()), from);
        let part = dot(way, whole) / dot(whole, whole);
        let aside = minus(way, whole.map(|x| x * part));
        assert!(dot(aside, aside).sqrt() < 1e-4, "{problem}: {aside:?}");
    }
    robot.go(&moves).unwrap();
    let (position, rotation) = fourth.errors(&at(&robot.state().positions()));
    assert!(position < 2e-3 && rotation < 5e-3, "{problem}: {position} m, {rotation} rad");
}

#[test]
fn every_kind_of_move_is_made_under_a_run_time_tool_and_base() {
    let [tool, base] = aslant();
    let cobot_places: [&[f64]; 4] = [
        &[-0.2, -0.3, -1.8, 2.1 - FRAC_PI_2, 0.0, -0.2],
        &[0.1, -0.4, -1.6, 2.0 - FRAC_PI_2, 0.0, 0.1],
        &[0.2, -0.5, -1.5, 2.0 - FRAC_PI_2, 0.0, 0.2],
        &[0.3, -0.4, -1.6, 2.0 - FRAC_PI_2, 0.0, 0.3],
    ];
    for base in [Frame::IDENTITY, base] {
        let arm = Mounted::new(&MyCobot).with_tool(tool).with_base(base);
        for problem in ["tool_down", "pose"] {
            let (_, driver) = cobot(mycobot::Model::Pi, good());
            driven(&arm, driver, problem, &cobot_places);
        }
    }
    // On a base that is tilted, x and y hang on how the arm stands.
    let places: [&[f64]; 4] = [&[0.3, 0.8], &[0.35, 0.82], &[0.4, 0.85], &[0.42, 0.82]];
    let arm = Mounted::new(&Planar).with_tool(tool).with_base(base);
    let (_, driver) = servos(&Planar, places[0], 57_600, good());
    driven(&arm, driver, "xy", &places);
    // The hand turns with the arm.
    let at = |q1, q2, q4| [q1, q2, 0.0, q4, 0.0, 0.0, 0.0];
    let places = [at(0.1, -0.3, -1.4), at(0.13, -0.32, -1.35), at(0.15, -0.35, -1.3), at(0.17, -0.35, -1.32)];
    let arm = Mounted::new(&CraneX7).with_tool(tool);
    let (_, driver) = servos(&CraneX7, &places[0], 3_000_000, good());
    driven(&arm, driver, "planar", &places.each_ref().map(<[f64; 7]>::as_slice));
}
