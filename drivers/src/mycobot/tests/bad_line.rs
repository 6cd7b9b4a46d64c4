//! A bad line: frames dropped, late, split, corrupted and doubled, and a plug pulled.

use std::time::Duration;

use super::super::{Model, MyCobot};
use super::{Arm, Bench, FULL, TENTH, apart};
use crate::clock::{Clock, Time};
use crate::driver::{Cause, Driver, DriverError};
use crate::motion::Command;
use crate::port::PortErrorKind;
use crate::simulate::Faults;
use dh_runtime::Kinematics;

/// No call takes longer, the stop of an arm that is given up on included.
const LONGEST: Duration = Duration::from_millis(5_600);

/// Joint values of the table (rad), evenly spread and repeatable.
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn goal(&mut self) -> Vec<f64> {
        [70.0, 100.0, 130.0, 100.0, 100.0, 80.0]
            .map(|degrees| (2.0 * self.unit() - 1.0) * f64::to_radians(degrees))
            .to_vec()
    }
}

/// What came of the operations.
#[derive(Debug, Default)]
struct Outcome {
    operations: usize,
    /// Calls that failed, and of those the ones that found the arm moving.
    failed: usize,
    given_up: usize,
    /// Readings of a resting arm that were wrong, and of a moving one that were further off than a joint goes between
    /// two readings.
    wrong_at_rest: usize,
    wrong_on_the_way: usize,
    /// Requests that the arm carried out otherwise than they were sent: goals, colours.
    goals_corrupted: usize,
    colors_corrupted: usize,
    /// Goals that the driver said were reached, and of those the ones that the arm was not at.
    arrived: usize,
    arrived_elsewhere: usize,
    longest: Duration,
}

/// Ten thousand operations on a line that spoils one frame in twenty.
///
/// What may slip through without a checksum: a corrupted request that is another valid one. It is found by what is read
/// afterwards: the goal counts as reached only where two readings of a resting arm say so, and is sent anew where they
/// say something else. What may not: a wrong reading of an arm at rest, an arm that goes on after the driver gave up, a
/// call that hangs.
#[test]
fn ten_thousand_operations_on_a_bad_line() {
    let mut bench = Bench::new(Model::Pi);
    bench.device().faults = Faults::evenly(0.05, Duration::from_millis(400));
    let mut outcome = Outcome::default();
    let mut draw = Draw(7);
    while outcome.operations < 10_000 {
        if operation(&mut bench, &mut outcome, |driver| driver.torque(true)).is_none()
            || operation(&mut bench, &mut outcome, Driver::clear_faults).is_none()
        {
            continue;
        }
        let goal = draw.goal();
        // Some are slow, some as fast as it goes.
        let command = Command::for_test(Arm.fingerprint(), goal.clone(), vec![FULL * (0.1 + draw.unit()); 6]);
        for _ in 0..4 {
            let sent = operation(&mut bench, &mut outcome, |driver| driver.send(&command));
            if sent.is_some() && apart(&bench.device().device.goals(), &goal) > TENTH {
                outcome.goals_corrupted += 1;
            }
            if sent.is_none() || reached(&mut bench, &mut outcome, &goal) != Some(false) {
                break;
            }
        }
        let color = [1.0, 2.0, 3.0].map(|_| (draw.unit() * 256.0) as u8);
        if operation(&mut bench, &mut outcome, |driver| driver.set_color(color)).is_some() {
            outcome.colors_corrupted += usize::from(bench.device().device.color() != color);
        }
    }
    let line = bench.driver.line();
    let injected = bench.device().injected;
    println!("{outcome:?}\n{line:?}\n{injected:?}");
    assert!(injected.total() > 800, "{injected:?}");
    assert_eq!(outcome.wrong_at_rest, 0, "{outcome:?}");
    assert_eq!(outcome.wrong_on_the_way, 0, "{outcome:?}");
    assert_eq!(outcome.arrived_elsewhere, 0, "{outcome:?}");
    assert!(outcome.arrived > 100, "{outcome:?}");
    assert!(outcome.goals_corrupted < outcome.operations / 500, "{outcome:?}");
    assert!(outcome.failed < outcome.operations / 50, "{outcome:?}");
    assert!(line.rejected > 10 && line.repeated > 100 && line.strays > 10, "{line:?}");
    assert!(outcome.longest <= LONGEST, "{outcome:?}");
}

/// One call. Failures are counted; where the arm was moving, it must not be any more.
fn operation<T>(
    bench: &mut Bench,
    outcome: &mut Outcome,
    call: impl FnOnce(&mut MyCobot) -> Result<T, DriverError>,
) -> Option<T> {
    outcome.operations += 1;
    let start = bench.clock.now();
    let moving = bench.device().device.is_moving();
    let result = call(&mut bench.driver);
    outcome.longest = outcome.longest.max(bench.clock.now().since(start));
    if let Err(error) = &result {
        outcome.failed += 1;
        if moving {
            outcome.given_up += 1;
            // Full speed, and braking from it, takes a quarter of a second.
            bench.pass(Duration::from_millis(300));
            assert!(!bench.device().device.is_moving(), "it moves after {error}");
        }
        assert!(error.to_string().starts_with("simulated, "), "{error}");
    }
    result.ok()
}

/// Reads until the arm rests: whether it is at the goal. `None` where a reading fails.
fn reached(bench: &mut Bench, outcome: &mut Outcome, goal: &[f64]) -> Option<bool> {
    loop {
        let before = bench.device().device.positions();
        let start = bench.clock.now();
        let state = operation(bench, outcome, Driver::read_state)?;
        let after = bench.device().device.positions();
        let positions = state.positions();
        let rests = state.joints.iter().all(|joint| joint.moving == Some(false));
        // What a joint went meanwhile, and what a reading of a moving one may be off.
        let slack = if rests { TENTH / 2.0 } else { FULL * 0.1 + 1.2_f64.to_radians() };
        let wrong = positions.iter().zip(before.iter().zip(&after)).any(|(read, (before, after))| {
            !(before.min(*after) - slack..=before.max(*after) + slack).contains(read)
        });
        match (wrong, rests) {
            (true, true) => outcome.wrong_at_rest += 1,
            (true, false) => outcome.wrong_on_the_way += 1,
            _ => {}
        }
        if rests {
            let there = apart(&positions, goal) < TENTH;
            if there {
                outcome.arrived += 1;
                outcome.arrived_elsewhere += usize::from(apart(&after, goal) > TENTH);
            }
            return Some(there);
        }
        assert!(bench.clock.now().since(start) < LONGEST);
        bench.pass(Duration::from_millis(40));
    }
}

/// The plug is pulled while it moves, and put back: the call fails and says so, the next that finds it back stops the
/// arm, and nothing moves it until torque is switched on anew.
#[test]
fn it_comes_back_by_itself_and_does_not_move_until_told() {
    let mut bench = Bench::new(Model::Pi);
    bench.driver.torque(true).unwrap();
    let goal = Bench::goal([80.0, 0.0, 0.0, 0.0, 0.0, 0.0], 10.0);
    bench.driver.send(&goal).unwrap();
    bench.pass(Duration::from_millis(300));
    let pulled = bench.clock.now();
    bench.device().unplug(pulled, pulled + Duration::from_secs(1));
    for _ in 0..3 {
        let error = bench.driver.read_state().unwrap_err();
        assert!(matches!(&error.cause, Cause::Port(error) if error.kind == PortErrorKind::Gone), "{error}");
    }
    // Nothing stops a myCobot whose program is gone.
    assert!(bench.device().device.is_moving());
    bench.pass(Duration::from_secs(1));
    let state = bench.driver.read_state().unwrap();
    assert!(state.joints[0].position < 50_f64.to_radians());
    bench.pass(Duration::from_millis(300));
    assert!(!bench.device().device.is_moving());
    let error = bench.driver.send(&goal).unwrap_err();
    assert_eq!(error.cause, Cause::Interrupted);
    assert_eq!(bench.driver.resume().unwrap_err().cause, Cause::Interrupted);
    bench.driver.torque(true).unwrap();
    bench.driver.send(&goal).unwrap();
    assert!((bench.arrive()[0] - 80_f64.to_radians()).abs() < TENTH);
}

/// A line that swallows everything: the arm cannot be stopped, and the driver says so in time.
#[test]
fn silence_is_told_in_time() {
    let mut bench = Bench::new(Model::Pi);
    bench.driver.torque(true).unwrap();
    bench.driver.send(&Bench::goal([80.0, 0.0, 0.0, 0.0, 0.0, 0.0], 10.0)).unwrap();
    bench.device().faults = Faults { drop: 1.0, ..Faults::default() };
    let start = bench.clock.now();
    let error = bench.driver.read_state().unwrap_err();
    assert!(
        matches!(error.cause, Cause::Silent { waited } if waited > Duration::from_millis(700)),
        "{error}"
    );
    assert!(matches!(bench.driver.stop().unwrap_err().cause, Cause::Silent { .. }));
    assert!(bench.clock.now().since(start) < LONGEST);
    // It is heard again: the stop that is tried several times gets through.
    bench.device().faults = Faults { drop: 0.6, ..Faults::default() };
    bench.driver.stop().unwrap();
    bench.pass(Duration::from_millis(300));
    assert!(!bench.device().device.is_moving());
}

/// A line that is never quiet: a call still ends.
#[test]
fn a_line_that_babbles_is_no_reason_to_hang() {
    #[derive(Debug)]
    struct Babbler(Time);
    impl crate::simulate::SimulatedDevice for Babbler {
        fn receive(&mut self, _: &[u8], _: Time) {}
        fn advance(&mut self, _: Time) {}
        fn next_send(&self) -> Option<Time> {
            Some(self.0)
        }
        fn send(&mut self, now: Time) -> Option<Vec<u8>> {
            (self.0 <= now).then(|| {
                self.0 += Duration::from_millis(1);
                b"\xfe\xfe\x0e\x21\xfe".to_vec()
            })
        }
    }
    let clock = std::sync::Arc::new(crate::clock::VirtualClock::new());
    let device = std::sync::Arc::new(std::sync::Mutex::new(Babbler(Time::START)));
    let port = crate::simulate::SimulatedPort::new(device, clock.clone());
    let joints = crate::driver::JointMap::of_table(&Arm).unwrap();
    let mut driver = MyCobot::new(Box::new(port), joints, Model::Pi).unwrap();
    let error = driver.read_state().unwrap_err();
    assert_eq!(error.cause, Cause::Garbled);
    assert!(clock.now().since_start() <= Duration::from_secs(4), "{:?}", clock.now());
}
