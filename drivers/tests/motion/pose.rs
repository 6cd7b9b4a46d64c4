//! Moves of the full pose, with as many joints as it takes and with one more.

use super::checked::{assert_kept, every, planner};
use super::memory::{Memory, STREAM};
use super::{CraneX7, MyCobot};
use dh_drivers::driver::Pace;
use dh_drivers::motion::{Checked, Move, Robot};
use dh_runtime::{FULL_POSE, Frame, Kinematics, Target, rotation_error};
use proptest::prelude::*;

/// That the tool is on the straight way from one pose to another at every command, turns as far as it travels, and ends
/// there.
fn assert_straight(arm: &dyn Kinematics, checked: &Checked, from: &Frame, to: &Frame) {
    let way = |a: &Frame, b: &Frame| -> f64 {
        (0..3).map(|i| (b.translation[i] - a.translation[i]).powi(2)).sum::<f64>().sqrt()
    };
    let (length, turn) = (way(from, to), rotation_error(&from.rotation, &to.rotation));
    for (_, command) in checked.commands(0) {
        let tool = arm.fk(command.positions()).unwrap();
        let along: f64 = (0..3)
            .map(|i| (tool.translation[i] - from.translation[i]) * (to.translation[i] - from.translation[i]))
            .sum();
        let made = along / length;
        let off = (way(from, &tool).powi(2) - made.powi(2)).max(0.0).sqrt();
        assert!(off < 1.1e-5, "{off}");
        let turned = rotation_error(&from.rotation, &tool.rotation);
        assert!((turned - turn * made / length).abs() < 3e-4, "{turned} {turn} {made} {length}");
    }
    let end = arm.fk(checked.goal(0).unwrap()).unwrap();
    let (position, rotation) = Target::Pose(*to).errors(&end);
    assert!(position < 1e-9 && rotation < 1e-8, "{position} {rotation}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn a_line_of_poses_is_straight_and_turns_evenly(
        parts in [0.1..0.9, 0.1..0.9, 0.1..0.9, 0.1..0.9, 0.1..0.9, 0.1..0.9],
        step in [-0.05..0.05, -0.05..0.05, -0.05..0.05],
        turn in [-0.3..0.3, -0.3..0.3, -0.3..0.3],
    ) {
        let planner = planner(&MyCobot, every(10));
        let joints = MyCobot.joints().iter().zip(parts);
        let start: Vec<f64> = joints.map(|(joint, part)| {
            let limits = joint.limits.unwrap();
            limits.min + part * (limits.max - limits.min)
        }).collect();
        prop_assume!(Kinematics::check(&MyCobot, &start).is_ok());
        let here = Kinematics::fk(&MyCobot, &start).unwrap();
        let goal = here * Frame::from_rpy(step, turn);
        // Paths that are mostly travel: their way is counted in metres.
        prop_assume!(step.iter().map(|x| x * x).sum::<f64>().sqrt() > 0.06);
        if let Ok(checked) = planner.plan(&start, &[Move::line(FULL_POSE, Target::Pose(goal))]) {
            assert_kept(&MyCobot, &checked, planner.dynamics());
            assert_straight(&MyCobot, &checked, &here, &goal);
        }
    }
}

#[test]
fn an_arm_with_a_joint_too_many_keeps_to_the_line_too() {
    let start = [0.3, -0.4, 0.5, -1.7, 0.3, -0.8, 0.2];
    let here = Kinematics::fk(&CraneX7, &start).unwrap();
    let mut goal = here;
    goal.translation[0] += 0.05;
    goal.translation[2] -= 0.08;
    let line = [Move::line(FULL_POSE, Target::Pose(goal))];
    for pace in [every(10), Pace::PointToPoint] {
        let planner = planner(&CraneX7, pace);
        let checked = planner.plan(&start, &line).unwrap();
        assert_kept(&CraneX7, &checked, planner.dynamics());
        if pace == every(10) {
            assert_straight(&CraneX7, &checked, &here, &goal);
        }
    }
}

#[test]
fn to_a_pose_and_back() {
    let start = [0.3, -0.5, 0.9, -0.6, 0.4, 0.2];
    let driver = Memory::new(&MyCobot, STREAM, &start);
    let mut robot = Robot::new(&MyCobot, driver).unwrap();
    let here = robot.arm().fk(&start).unwrap();
    let mut there = here * Frame::from_rpy([0.0; 3], [0.05, 0.05, -0.1]);
    there.translation[2] -= 0.04;
    robot.go(&[Move::pose(there), Move::pose(here)]).unwrap();
    let (position, rotation) = Target::Pose(here).errors(&robot.arm().fk(&robot.stands()).unwrap());
    assert!(position < 1e-9 && rotation < 1e-8, "{position} {rotation}");
}
