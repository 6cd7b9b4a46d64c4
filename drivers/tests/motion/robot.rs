//! Runs, stops and faults.

use super::memory::{Memory, STREAM};
use super::{Crane, MyCobot, Planar};
use dh_drivers::Driver;
use dh_drivers::clock::{Clock, Time};
use dh_drivers::driver::{Fault, Pace};
use dh_drivers::motion::{MotionError, Move, Planner, Reason, Robot};
use dh_runtime::{Frame, Kinematics, Mounted, Target};
use std::time::Duration;

const TWO_TICKS: f64 = 2.0 * std::f64::consts::TAU / 4096.0;

fn seconds(time: f64) -> Time {
    Time::START + Duration::from_secs_f64(time)
}

fn assert_near(q: &[f64], goal: &[f64], tolerance: f64) {
    assert!(q.iter().zip(goal).all(|(a, b)| (a - b).abs() <= tolerance), "{q:?} is not {goal:?}");
}

#[test]
fn all_joints_get_there_together_streaming_and_by_goals() {
    for pace in [STREAM, Pace::PointToPoint] {
        let driver = Memory::new(&MyCobot, pace, &[0.0; 6]);
        let arm = driver.arm.clone();
        let mut robot = Robot::new(&MyCobot, driver).unwrap();
        let goal = [0.5, -0.6, 1.2, -0.3, 0.4, -0.2];
        let mut told = Vec::new();
        robot
            .go_watched(&[Move::joints(&goal), Move::joints(&[0.0; 6])], &mut |progress| {
                told.push((progress.step, progress.elapsed, progress.arrived));
            })
            .unwrap();
        assert_near(&arm.lock().unwrap().positions(), &[0.0; 6], TWO_TICKS);
        assert!(!arm.lock().unwrap().moves());
        assert_eq!(robot.stands(), [0.0; 6]);
        assert_eq!(arm.lock().unwrap().watchdog, None);
        // Progress never goes back, and both arrivals are told.
        assert!(told.windows(2).all(|pair| pair[0].1 <= pair[1].1 + 1e-9), "{told:?}");
        assert_eq!(told.iter().filter(|(.., arrived)| *arrived).count(), 2);
        assert_eq!(arm.lock().unwrap().stops, 0);
        drop(robot);
        assert_eq!(arm.lock().unwrap().stops, 0, "an arm at rest is left alone");
    }
}

#[test]
fn a_table_s_problem_is_solved_and_followed_in_a_line() {
    for pace in [STREAM, Pace::PointToPoint] {
        let start = [-0.2, -0.9, -2.0, 1.4, 0.0, -0.2];
        let driver = Memory::new(&MyCobot, pace, &start);
        let arm = driver.arm.clone();
        let mut robot = Robot::new(&MyCobot, driver).unwrap();
        let at = |x, y, z| Target::Position([x, y, z]);
        robot
            .go(&[
                Move::nearest("tool_down", at(0.15, -0.1, 0.15)),
                Move::line("tool_down", at(0.15, -0.1, 0.05)),
                Move::line("tool_down", at(0.15, -0.1, 0.15)),
                Move::curve("tool_down", vec![at(0.15, 0.0, 0.12), at(0.13, 0.1, 0.15)]),
            ])
            .unwrap();
        let tool = Kinematics::fk(&MyCobot, &arm.lock().unwrap().positions()).unwrap();
        let off =
            tool.translation.iter().zip([0.13, 0.1, 0.15]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 2e-4, "{pace:?}: {off}");
        assert!((tool.z_axis()[2] + 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_line_that_is_made_of_goals_is_one_to_a_millimetre() {
    let driver = Memory::new(&MyCobot, Pace::PointToPoint, &[-0.2, -0.9, -2.0, 1.4, 0.0, -0.2]);
    let mut robot = Robot::new(&MyCobot, driver).unwrap();
    let at = |x, y, z| Target::Position([x, y, z]);
    robot.go(&[Move::nearest("tool_down", at(0.15, -0.12, 0.1))]).unwrap();
    let checked = robot.plan(&[Move::line("tool_down", at(0.15, 0.12, 0.1))]).unwrap();
    let mut here = checked.start().unwrap().to_vec();
    let goals: Vec<Vec<f64>> = checked.commands(0).map(|(_, command)| command.positions().to_vec()).collect();
    assert!((3..40).contains(&goals.len()), "{}", goals.len());
    for goal in goals {
        for part in 0..=20 {
            let part = f64::from(part) / 20.0;
            let q: Vec<f64> = here.iter().zip(&goal).map(|(a, b)| a + part * (b - a)).collect();
            let [x, _, z] = Kinematics::fk(&MyCobot, &q).unwrap().translation;
            assert!((x - 0.15).hypot(z - 0.1) < 1.05e-3, "{x} {z}");
        }
        here = goal;
    }
}

#[test]
fn a_refusal_sends_nothing_at_all() {
    let driver = Memory::new(&MyCobot, STREAM, &[0.0; 6]);
    let arm = driver.arm.clone();
    let mut robot = Robot::new(&MyCobot, driver).unwrap();
    let before = arm.lock().unwrap().calls;
    let down = |z| Target::Position([0.15, -0.1, z]);
    let moves = [
        Move::joints(&[1.6, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Move::joints(&[0.0; 5]),
        Move::joints(&[f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Move::joints(&[0.1; 6]).slowed(0.0),
        Move::joints(&[0.2; 6]).slowed(1e-5),
        Move::joints(&[1.0; 6]).within(0.1),
        Move::nearest("tool_down", down(0.01)),
        Move::nearest("tool_up", down(0.1)),
        Move::nearest("tool_down", Target::Xy([0.1, 0.1])),
        Move::line("tool_down", down(0.1)),
    ];
    for wrong in moves {
        // A good move before a bad one is not made either.
        for moves in [vec![wrong.clone()], vec![Move::joints(&[0.1; 6]), wrong.clone()]] {
            let error = robot.go(&moves).unwrap_err();
            assert!(matches!(error, MotionError::Refused(_)), "{wrong:?}: {error}");
        }
    }
    assert_eq!(arm.lock().unwrap().calls, before);
    drop(robot);
    assert_eq!(arm.lock().unwrap().stops, 0);
}

#[test]
fn a_refusal_says_which_move_sample_joint_and_rule() {
    let driver = Memory::new(&MyCobot, STREAM, &[0.0; 6]);
    let robot = Robot::new(&MyCobot, driver).unwrap();
    let refusal = robot.plan(&[Move::joints(&[0.1; 6]), Move::joints(&[1.6; 6])]).unwrap_err();
    assert_eq!(refusal.step, 1);
    let Reason::OutsideLimits { joint, value, max, .. } = &refusal.reason else { panic!("{refusal}") };
    assert_eq!((joint.index, &*joint.name, *value), (0, "J1", 1.6));
    assert!((max - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    // Everything that is wrong there is said.
    assert_eq!(refusal.also.len(), 1, "{refusal}");
    let Reason::OutsideLimits { joint, .. } = &refusal.also[0] else { panic!("{refusal}") };
    assert!(
        &*joint.name == "J6" && refusal.to_string().contains("; joint 6 (J6) would be at 1.6"),
        "{refusal}"
    );
    // Both ends are above the floor, what is between them is not.
    let down = [0.3, -1.6, 0.5, 0.4, 0.0, 0.3];
    let up = [-0.3, -1.6, -1.9, -1.1, 0.0, 0.3];
    assert!(MyCobot.check(&down).is_ok() && MyCobot.check(&up).is_ok());
    let start = robot.planner().plan(&down, &[Move::joints(&up)]).unwrap_err();
    let sample = start.sample.unwrap();
    assert!(matches!(start.reason, Reason::Forbidden(_)), "{start}");
    assert!(0 < sample.index && sample.index + 1 < sample.count && 0.0 < sample.part && sample.part < 1.0);
}

#[test]
fn an_arm_that_was_moved_by_hand_is_planned_for_anew() {
    let driver = Memory::new(&Planar, STREAM, &[0.0; 2]);
    let arm = driver.arm.clone();
    let mut robot = Robot::new(&Planar, driver).unwrap();
    let checked = robot.plan(&[Move::joints(&[0.5, 0.5])]).unwrap();
    arm.lock().unwrap().motors[0].position = -0.4;
    arm.lock().unwrap().motors[0].goal = -0.4;
    let error = robot.run(&checked, &mut |_| {}).unwrap_err();
    assert!(matches!(&error, MotionError::NotAtStart { joint, .. } if joint.index == 0), "{error}");
    assert!(arm.lock().unwrap().sent.is_empty() && !arm.lock().unwrap().torque);
    robot.go(&[Move::joints(&[0.5, 0.5])]).unwrap();
    assert_near(&arm.lock().unwrap().positions(), &[0.5, 0.5], 1e-9);
    assert!(arm.lock().unwrap().sent[0].1[0] < -0.39);
}

#[test]
fn what_was_checked_for_another_arm_is_not_made() {
    let driver = Memory::new(&Planar, STREAM, &[0.0; 2]);
    let arm = driver.arm.clone();
    let joints = driver.joints().clone();
    let mut robot = Robot::new(&Planar, driver).unwrap();
    let moves = [Move::joints(&[0.5, 0.5])];
    let start = [0.0; 2];
    let longer = Mounted::new(&Planar).with_tool(Frame::from_rpy([0.05, 0.0, 0.0], [0.0; 3]));
    let elsewhere = Mounted::new(&Planar).with_base(Frame::from_rpy([0.0, 0.0, 0.1], [0.0; 3]));
    let others: [(&dyn Kinematics, Pace); 3] =
        [(&longer, STREAM), (&elsewhere, STREAM), (&Planar, Pace::PointToPoint)];
    for (other, pace) in others {
        let checked = Planner::new(other, &joints, pace).unwrap().plan(&start, &moves).unwrap();
        assert_eq!(robot.run(&checked, &mut |_| {}), Err(MotionError::OtherArm));
    }
    // With all joints at 0 a longer tool and a base that stands further on have the tool in the same place.
    let further = Mounted::new(&Planar).with_base(Frame::from_rpy([0.05, 0.0, 0.0], [0.0; 3]));
    assert_eq!(Kinematics::fk(&longer, &[0.0; 2]), Kinematics::fk(&further, &[0.0; 2]));
    let checked = Planner::new(&further, &joints, STREAM).unwrap().plan(&start, &moves).unwrap();
    let mut longer = Robot::new(&longer, Memory::new(&Planar, STREAM, &[0.0; 2])).unwrap();
    assert_eq!(longer.run(&checked, &mut |_| {}), Err(MotionError::OtherArm));
    assert!(arm.lock().unwrap().sent.is_empty());
    let own = Planner::new(&Planar, &joints, STREAM).unwrap().plan(&start, &moves).unwrap();
    robot.run(&own, &mut |_| {}).unwrap();
}

/// Half a second into a long move something happens; the arm stands still afterwards, and well short of the goal.
fn disturbed(pace: Pace, disturb: impl FnOnce(&mut super::memory::Arm)) -> (MotionError, usize) {
    let driver = Memory::new(&Crane, pace, &[0.2, -0.2]);
    let (arm, clock) = (driver.arm.clone(), driver.virtual_clock());
    disturb(&mut arm.lock().unwrap());
    let mut robot = Robot::new(&Crane, driver).unwrap();
    let error = robot.go(&[Move::joints(&[2.8, -2.6]).slowed(0.3)]).unwrap_err();
    let mut arm = arm.lock().unwrap();
    // Whatever the driver did last, the device is seen to come to rest by itself.
    let now = clock.now() + Duration::from_secs(2);
    arm.silent_from = None;
    clock.sleep_until(now);
    drop(robot_state(&mut arm, now));
    assert!(!arm.moves(), "{error}");
    assert!(arm.positions()[1] > -2.0, "{:?}", arm.positions());
    let stops = arm.stops;
    drop(arm);
    drop(robot);
    (error, stops)
}

fn robot_state(arm: &mut super::memory::Arm, now: Time) -> Vec<f64> {
    arm.look(now);
    arm.positions()
}

#[test]
fn a_fault_stops_the_arm() {
    let fault = Fault { code: 32, meaning: "overload" };
    for pace in [STREAM, Pace::PointToPoint] {
        let (error, stops) = disturbed(pace, |arm| arm.fault = Some((seconds(0.5), 1, fault)));
        assert!(
            matches!(&error, MotionError::Fault { joint: Some(joint), fault: seen } if joint.index == 1 && *seen == fault),
            "{error}"
        );
        assert_eq!(stops, 1);
    }
}

#[test]
fn lost_feedback_stops_the_arm() {
    for pace in [STREAM, Pace::PointToPoint] {
        let (error, stops) = disturbed(pace, |arm| arm.silent_from = Some(seconds(0.5)));
        let lost = match &error {
            MotionError::FeedbackLost { lost, .. } => *lost,
            // A stream hears of it when it sends.
            MotionError::Driver(_) => Duration::ZERO,
            other => panic!("{other}"),
        };
        let allowed = if pace == STREAM { 600 } else { 1100 };
        assert!(lost < Duration::from_millis(allowed), "{lost:?}");
        assert!(stops >= 1);
    }
}

#[test]
fn an_answer_now_and_then_that_is_lost_does_no_harm() {
    for pace in [STREAM, Pace::PointToPoint] {
        let driver = Memory::new(&Planar, pace, &[0.0; 2]);
        let arm = driver.arm.clone();
        let mut robot = Robot::new(&Planar, driver).unwrap();
        arm.lock().unwrap().lossy = Some(5);
        robot.run(&robot.plan(&[Move::joints(&[1.0, -1.0])]).unwrap(), &mut |_| {}).unwrap();
        assert_near(&arm.lock().unwrap().positions(), &[1.0, -1.0], 1e-9);
    }
}

#[test]
fn a_joint_that_is_stuck_stops_the_arm() {
    let (error, stops) = disturbed(STREAM, |arm| arm.stuck = Some((seconds(0.5), 1)));
    let MotionError::Strayed { joint, actual, max, tolerance, .. } = &error else { panic!("{error}") };
    assert_eq!(joint.index, 1);
    assert!(actual - max > *tolerance || max - actual > -*tolerance, "{error}");
    assert_eq!(stops, 1);
    let (error, stops) = disturbed(Pace::PointToPoint, |arm| arm.stuck = Some((seconds(0.5), 1)));
    assert!(matches!(&error, MotionError::NotArrived { joint, .. } if joint.index == 1), "{error}");
    assert_eq!(stops, 1);
}

#[test]
fn an_arm_that_does_not_hear_is_said_to_move_on() {
    let (error, _) = disturbed(STREAM, |arm| {
        arm.silent_from = Some(seconds(0.5));
        arm.deaf = true;
    });
    assert!(matches!(error, MotionError::NotStopped { .. }), "{error}");
}

#[test]
fn a_stop_on_request_is_gentle_and_on_the_path() {
    let driver = Memory::new(&Crane, STREAM, &[0.2, -0.2]);
    let arm = driver.arm.clone();
    let mut robot = Robot::new(&Crane, driver).unwrap();
    let stop = robot.stop_handle();
    let moves = [Move::joints(&[2.8, -2.6])];
    let path: Vec<Vec<f64>> =
        robot.plan(&moves).unwrap().commands(0).map(|(_, command)| command.positions().to_vec()).collect();
    let error = robot.go_watched(&moves, &mut |progress| {
        if progress.elapsed > 0.4 {
            stop.stop();
        }
    });
    assert_eq!(error, Err(MotionError::Stopped));
    let sent = arm.lock().unwrap().sent.clone();
    let limits = robot.planner().dynamics()[0];
    for three in sent.windows(3) {
        let speed = |a: &(Time, Vec<f64>), b: &(Time, Vec<f64>)| (b.1[0] - a.1[0]) / 0.01;
        let acceleration = (speed(&three[1], &three[2]) - speed(&three[0], &three[1])) / 0.01;
        assert!(acceleration.abs() < 1.6 * limits.acceleration, "{acceleration}");
    }
    // Every setpoint lies on the straight line of the path.
    let (start, end) = ([0.2, -0.2], path.last().unwrap());
    let slope = (end[1] - start[1]) / (end[0] - start[0]);
    assert!(sent.iter().all(|(_, q)| (q[1] - start[1] - slope * (q[0] - start[0])).abs() < 1e-6));
    assert_eq!(arm.lock().unwrap().stops, 0, "no emergency");
    assert!(!arm.lock().unwrap().moves() && arm.lock().unwrap().torque);
    // It stays where it is until it is allowed to move again, and then goes on from there.
    assert_eq!(robot.go(&moves), Err(MotionError::Stopped));
    assert_eq!(arm.lock().unwrap().sent.len(), sent.len());
    stop.clear();
    robot.go(&moves).unwrap();
    assert_near(&arm.lock().unwrap().positions(), &[2.8, -2.6], 1e-9);
}

#[test]
fn a_stop_on_request_holds_a_device_with_profiles_of_its_own() {
    let driver = Memory::new(&Crane, Pace::PointToPoint, &[0.2, -0.2]);
    let arm = driver.arm.clone();
    let mut robot = Robot::new(&Crane, driver).unwrap();
    let stop = robot.stop_handle();
    let error = robot.go_watched(&[Move::joints(&[2.8, -2.6]).slowed(0.3)], &mut |progress| {
        if progress.state.stamp > seconds(0.5) {
            stop.stop();
        }
    });
    assert_eq!(error, Err(MotionError::Stopped));
    let arm = arm.lock().unwrap();
    assert!(arm.stops == 1 && !arm.moves() && arm.torque && arm.positions()[0] < 2.0);
}

#[test]
fn a_robot_that_is_dropped_on_its_way_stops() {
    for pace in [STREAM, Pace::PointToPoint] {
        let driver = Memory::new(&Crane, pace, &[0.2, -0.2]);
        let (arm, clock) = (driver.arm.clone(), driver.virtual_clock());
        let went = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            let mut robot = Robot::new(&Crane, driver).unwrap();
            let _ = robot.go_watched(&[Move::joints(&[2.8, -2.6]).slowed(0.3)], &mut |progress| {
                assert!(progress.state.stamp < seconds(0.5), "the program dies");
            });
        }));
        assert!(went.is_err());
        let mut arm = arm.lock().unwrap();
        assert_eq!(arm.stops, 1);
        arm.look(clock.now() + Duration::from_secs(2));
        assert!(!arm.moves() && arm.torque && arm.positions()[0] < 2.0);
    }
}

#[test]
fn torque_goes_only_in_a_safe_pose_or_when_asked_for() {
    let start = MyCobot::POSES[0].q;
    let driver = Memory::new(&MyCobot, STREAM, start);
    let arm = driver.arm.clone();
    let mut robot = Robot::new(&MyCobot, driver).unwrap().with_poses(&MyCobot::POSES);
    robot.hold().unwrap();
    let error = robot.release().unwrap_err();
    let MotionError::NotSafe { nearest: Some((pose, _)), .. } = &error else { panic!("{error}") };
    assert_eq!(pose, "rest");
    assert!(arm.lock().unwrap().torque);
    let rest = MyCobot::POSES.iter().find(|pose| pose.safe).unwrap();
    robot.go(&[Move::joints(rest.q)]).unwrap();
    robot.release().unwrap();
    assert!(!arm.lock().unwrap().torque);
    robot.go(&[Move::joints(start)]).unwrap();
    assert!(arm.lock().unwrap().torque, "a move switches it on");
    robot.release_anywhere().unwrap();
    assert!(!arm.lock().unwrap().torque);
}
