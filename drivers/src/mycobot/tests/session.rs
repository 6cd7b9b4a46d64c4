//! A good line.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use dh_runtime::Kinematics;

use super::super::{ArmError, GripperState, Model, MyCobot, Request, SimulatedMyCobot};
use super::{Arm, Bench, FULL, TENTH, apart};
use crate::clock::{Clock, Time, VirtualClock};
use crate::driver::{Cause, Driver, JointMap, Pace, Watchdog};
use crate::motion::Command;
use crate::simulate::{SimulatedDevice, SimulatedPort};

#[test]
fn it_goes_where_it_is_told_and_says_so() {
    for model in [Model::Pi, Model::M5] {
        let mut bench = Bench::new(model);
        assert_eq!(bench.driver.pace(), Pace::PointToPoint);
        assert_eq!(bench.driver.watchdog(Some(Duration::from_millis(100))).unwrap(), Watchdog::None);
        bench.driver.torque(true).unwrap();
        assert!(bench.driver.is_powered().unwrap());

        let goal = [20.0, -51.17, -123.8, 84.96, 0.005, -12.08];
        let before = bench.clock.now();
        bench.driver.send(&Bench::goal(goal, 50.0)).unwrap();
        assert!(bench.device().device.is_moving());
        assert!(bench.driver.is_moving().unwrap());
        bench.pass(Duration::from_millis(300));
        let state = bench.driver.read_state().unwrap();
        assert_eq!(state.joints[2].moving, Some(true));
        let arrived = bench.arrive();
        // 123.8 degrees at 80 a second.
        assert!(bench.clock.now().since(before) > Duration::from_millis(1500));
        let goal = goal.map(f64::to_radians);
        assert!(apart(&arrived, &goal) < TENTH, "{arrived:?}");
        assert!(apart(&bench.device().device.positions(), &goal) < TENTH);
        assert!(bench.driver.is_in_position(&goal).unwrap());
        assert!(!bench.driver.is_in_position(&[0.0; 6]).unwrap());

        let flange = bench.driver.coordinates().unwrap();
        let expected = Kinematics::fk_flange(&Arm, &goal).unwrap();
        assert!(apart(&flange.translation, &expected.translation) < 1e-4, "{flange:?}");
        for (row, expected) in flange.rotation.iter().zip(&expected.rotation) {
            assert!(apart(row, expected) < 1e-3, "{flange:?}");
        }
    }
}

#[test]
fn the_rest_of_the_commands() {
    let mut bench = Bench::new(Model::M5);
    let driver = &mut bench.driver;
    driver.set_color([1, 2, 3]).unwrap();
    assert_eq!(driver.gripper_opening().unwrap(), 100);
    driver.set_gripper(GripperState::Closed, 100).unwrap();
    assert!(driver.is_gripper_moving().unwrap());
    driver.set_gripper_opening(40, 50).unwrap();
    let versions = driver.versions().unwrap();
    assert_eq!((versions.system, versions.base), (6.5, Some(2.4)));
    assert!(driver.fresh_mode().unwrap());
    driver.set_fresh_mode(false).unwrap();
    assert!(!driver.fresh_mode().unwrap());
    // 168 degrees of the device are 258 of joint 1, whose zero is -90.
    let limits = driver.joint_limits(0).unwrap();
    assert!((limits.min.to_degrees() + 78.0).abs() < 1e-9 && (limits.max.to_degrees() - 258.0).abs() < 1e-9);
    let limits = driver.joint_limits(4).unwrap();
    assert!((limits.min.to_degrees() + 155.0).abs() < 1e-9 && (limits.max.to_degrees() - 160.0).abs() < 1e-9);
    assert_eq!(driver.error_information().unwrap(), None);
    bench.pass(Duration::from_secs(2));
    assert_eq!(bench.driver.gripper_opening().unwrap(), 40);
    assert!(!bench.driver.is_gripper_moving().unwrap());
    assert_eq!(bench.device().device.color(), [1, 2, 3]);

    // A Pi has no base to ask, and is not asked.
    let mut bench = Bench::new(Model::Pi);
    assert_eq!(bench.driver.versions().unwrap().base, None);
    assert_eq!(bench.driver.line().repeated, 0);
}

#[test]
fn it_pauses_goes_on_and_stops() {
    let mut bench = Bench::new(Model::Pi);
    bench.driver.torque(true).unwrap();
    let goal = [60.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    bench.driver.send(&Bench::goal(goal, 20.0)).unwrap();
    bench.pass(Duration::from_millis(500));
    bench.driver.pause().unwrap();
    assert!(bench.driver.is_paused().unwrap());
    let halted = bench.arrive();
    assert!(halted[0] > TENTH && halted[0] < 1.0, "{halted:?}");
    bench.driver.resume().unwrap();
    assert!(!bench.driver.is_paused().unwrap());
    assert!(apart(&bench.arrive(), &goal.map(f64::to_radians)) < TENTH);

    bench.driver.send(&Bench::goal([0.0; 6], 20.0)).unwrap();
    bench.pass(Duration::from_millis(500));
    bench.driver.stop().unwrap();
    let stopped = bench.arrive();
    assert!(stopped[0] > 0.5 && stopped[0] < 60_f64.to_radians() - TENTH, "{stopped:?}");
    assert!(bench.device().device.is_holding());
}

/// The leading joint goes as fast as it may, to the percent below; the others arrive with it.
#[test]
fn the_leading_joint_has_its_speed_and_the_others_arrive_with_it() {
    let mut bench = Bench::new(Model::Pi);
    bench.driver.torque(true).unwrap();
    let velocities = vec![0.2795 * FULL, -0.559 * FULL, 0.0, 0.0, 0.0, 0.0];
    let goal = [0.6, -1.2, 0.0, 0.0, 0.0, 0.0];
    bench.driver.send(&Command::for_test(Arm.fingerprint(), goal.to_vec(), velocities)).unwrap();
    let mut fastest = [0.0_f64; 6];
    let mut before = bench.device().device.positions();
    for _ in 0..200 {
        bench.pass(Duration::from_millis(10));
        let now = bench.device().device.positions();
        assert!((now[1] + 2.0 * now[0]).abs() < 1e-3, "no straight line in joint space: {now:?}");
        for (fastest, (now, before)) in fastest.iter_mut().zip(now.iter().zip(before)) {
            *fastest = fastest.max((now - before).abs() / 0.01);
        }
        before = now;
    }
    assert!(apart(&before, &goal) < TENTH);
    assert!((fastest[1] / FULL - 0.55).abs() < 1e-6, "{fastest:?}");
    assert!((fastest[0] / FULL - 0.275).abs() < 1e-3, "{fastest:?}");
}

/// Nothing of what is refused reaches the arm, and each refusal names what it is about.
#[test]
fn what_is_refused_sends_no_byte() {
    let mut bench = Bench::new(Model::Pi);
    bench.driver.torque(true).unwrap();
    let requests = bench.device().device.requests();
    let fingerprint = Arm.fingerprint();
    let slow = vec![1e-3; 6];
    let six = vec![0.0; 6];
    let fast = vec![1.0; 6];
    let refused = |command: Command, message: &str, bench: &mut Bench| {
        let error = bench.driver.send(&command).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    };
    // Joint 1 is sent 90 degrees less: -175, where the arm takes -168.
    refused(
        Bench::goal([-85.0, 0.0, 0.0, 0.0, 0.0, 0.0], 20.0),
        "simulated, J1, send_angles: -175",
        &mut bench,
    );
    refused(Bench::goal([0.0, 0.0, 0.0, 0.0, 161.0, 0.0], 20.0), "J5", &mut bench);
    refused(Bench::goal([0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0], 20.0), "J3", &mut bench);
    refused(
        Command::for_test(fingerprint ^ 1, six.clone(), fast.clone()),
        "checked for the table",
        &mut bench,
    );
    refused(
        Command::for_test(fingerprint, vec![0.0; 5], fast.clone()),
        "5 joint values where there are 6",
        &mut bench,
    );
    refused(Command::for_test(fingerprint, six.clone(), slow), "is not in 1 to 100", &mut bench);
    refused(Command::for_test(fingerprint, six, vec![f64::NAN; 6]), "NaN is not in 1 to 100", &mut bench);
    assert!(bench.driver.is_in_position(&[9.0; 6]).is_err());
    assert!(bench.driver.set_gripper_opening(101, 10).is_err());
    assert!(bench.driver.set_gripper(GripperState::Open, 101).is_err());
    assert!(bench.driver.joint_limits(6).is_err());
    assert!(bench.driver.joint_limits(usize::MAX).is_err());
    assert_eq!(bench.device().device.requests(), requests);
    assert_eq!(bench.driver.line().strays + bench.driver.line().garbage, 0);
}

#[test]
fn latched_errors_are_told_and_nothing_is_sent_until_they_are_cleared() {
    let mut bench = Bench::new(Model::Pi);
    bench.driver.torque(true).unwrap();
    bench.driver.send(&Bench::goal([50.0; 6], 10.0)).unwrap();
    bench.pass(Duration::from_millis(400));
    bench.device().device.latch(17);
    let stopped = bench.arrive();
    assert!(apart(&stopped, &[50_f64.to_radians(); 6]) > 0.1);
    let state = bench.driver.read_state().unwrap();
    assert_eq!(state.fault.map(|fault| fault.code), Some(17));
    let error = bench.driver.send(&Bench::goal([0.0; 6], 10.0)).unwrap_err();
    assert_eq!(error.to_string(), "simulated, send_angles: fault: collision protection (17)");
    bench.driver.clear_faults().unwrap();
    bench.driver.send(&Bench::goal([0.0; 6], 50.0)).unwrap();
    assert!(apart(&bench.arrive(), &[0.0; 6]) < TENTH);

    // The arm's own limits may be narrower than the table's: its refusal is an acknowledgement and a latched error.
    let narrow = Request::set_joint_limit(super::super::Command::SetJointMax, 3, 30.0).unwrap();
    bench.driver.link.begin(Duration::from_secs(1));
    bench.driver.link.acknowledge(&narrow).unwrap();
    let error = bench.driver.send(&Bench::goal([0.0, 0.0, 40.0, 0.0, 0.0, 0.0], 20.0)).unwrap_err();
    assert_eq!(error.to_string(), "simulated, J3, send_angles: fault: beyond its limit (3)");
    assert_eq!(bench.driver.error_information().unwrap(), Some(ArmError::Limit(3)));
    let state = bench.driver.read_state().unwrap();
    assert_eq!(state.first_fault().map(|(joint, _)| joint), Some(Some(2)));
    assert!(apart(&bench.device().device.positions(), &[0.0; 6]) < TENTH);
}

#[test]
fn without_power_or_torque_it_does_not_move() {
    let mut bench = Bench::new(Model::Pi);
    bench.driver.torque(true).unwrap();
    bench.driver.torque(false).unwrap();
    assert!(!bench.device().device.is_holding());
    let error = bench.driver.send(&Bench::goal([10.0; 6], 20.0)).unwrap_err();
    assert_eq!(error.cause, Cause::TorqueOff);

    // A joint without torque is moved by hand: it is read all the same.
    bench.device().device.place(&[0.3; 6]);
    assert!(apart(&bench.driver.read_state().unwrap().positions(), &[0.3; 6]) < TENTH);

    bench.driver.power_off().unwrap();
    assert!(!bench.driver.is_powered().unwrap());
    let start = bench.clock.now();
    let error = bench.driver.read_state().unwrap_err();
    assert_eq!((error.command, error.cause), ("get_angles", Cause::PowerOff));
    assert!(bench.clock.now().since(start) <= Duration::from_secs(4));

    bench.driver.torque(true).unwrap();
    bench.driver.send(&Bench::goal([10.0; 6], 20.0)).unwrap();
    assert!(apart(&bench.arrive(), &[10_f64.to_radians(); 6]) < TENTH);
}

/// At rest it says how hot its servos are; what it cannot say is not asked for again.
#[test]
fn temperatures_are_told_at_rest() {
    let mut bench = Bench::new(Model::Pi);
    let temperatures = |state: crate::driver::State| -> Vec<Option<f64>> {
        state.joints.iter().map(|joint| joint.temperature).collect()
    };
    let told = [31.0, 32.0, 32.0, 31.0, 30.0, 30.0].map(Some);
    assert_eq!(temperatures(bench.driver.read_state().unwrap()), told);
    let requests = |bench: &Bench| bench.device().device.requests();
    let before = requests(&bench);
    assert_eq!(temperatures(bench.driver.read_state().unwrap()), told);
    let plain = requests(&bench) - before;
    bench.pass(Duration::from_secs(3));
    let before = requests(&bench);
    bench.driver.read_state().unwrap();
    assert_eq!(requests(&bench) - before, plain + 1, "asked for again after a while, and not each time");
}

/// Deaf until a time.
#[derive(Debug)]
struct Starting<D>(D, Time);

impl<D: SimulatedDevice> SimulatedDevice for Starting<D> {
    fn receive(&mut self, bytes: &[u8], now: Time) {
        if now >= self.1 {
            self.0.receive(bytes, now);
        }
    }
    fn advance(&mut self, now: Time) {
        self.0.advance(now);
    }
    fn next_send(&self) -> Option<Time> {
        self.0.next_send()
    }
    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        self.0.send(now)
    }
}

/// Opening its port starts an M5 anew: it is waited for. A Pi that is silent is silent.
#[test]
fn an_m5_that_starts_is_waited_for() {
    for (model, waits) in [(Model::M5, true), (Model::Pi, false)] {
        let clock = Arc::new(VirtualClock::new());
        let arm = SimulatedMyCobot::new(Box::new(Arm), model).unwrap();
        let device = Starting(arm, Time::START + Duration::from_millis(1_600));
        let port = SimulatedPort::new(Arc::new(Mutex::new(device)), Arc::clone(&clock) as Arc<dyn Clock>);
        let joints = JointMap::of_table(&Arm).unwrap();
        let mut driver = MyCobot::new(Box::new(port), joints, model).unwrap();
        let outcome = driver.read_state();
        assert_eq!(outcome.is_ok(), waits, "{outcome:?}");
        assert!(clock.now().since_start() < Duration::from_millis(2_500));
    }
}
