//! Tools known only at run time: problems that hold the hand's point and leave its rotation to the table.

use super::checked::{every, planner};
use super::{Crane, CraneX7, MyCobot};
use dh_drivers::motion::Move;
use dh_runtime::{Frame, IkError, Kinematics, Mounted, MountingFrame, SolutionSet, Target};
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

/// The hand prolongs the forearm and turns with it: what is found is right, and little is missed.
#[test]
fn a_tool_that_turns_with_the_arm_finds_nearly_all() {
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
    println!("{found} of {all}");
    assert!(found * 100 >= all * 97, "{found} of {all}");
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
    assert!(matches!(far, Err(IkError::Unreachable { .. })), "{far:?}");
    // Beyond what the arm reaches without it.
    let target = Target::Xy([0.55, 0.05]);
    assert!(Kinematics::ik_into(&Crane, "xy", &target, &mut out).is_err());
    longer.ik_into("xy", &target, &mut out).unwrap();
    assert_eq!(out.len(), 2);
    // A direction cannot be taken through a tool that turns it.
    let turned = Mounted::new(&Crane).with_tool(Frame::from_rpy([0.1, 0.0, 0.0], [0.0, 0.0, 0.5]));
    let yaw = Target::XyYaw { position: [0.3, 0.1], yaw: 0.2 };
    let refused = IkError::Mounting { frame: MountingFrame::Tool, target: yaw.kind() };
    assert_eq!(turned.ik_into("xy", &yaw, &mut out), Err(refused));
}
