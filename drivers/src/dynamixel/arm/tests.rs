use super::{Arm, Settings};
use crate::clock::{Clock, Time, VirtualClock};
use crate::driver::{Cause, DeviceJoint, Driver, Effort, JointMap, Pace, Watchdog};
use crate::dynamixel::control_table::{
    BUS_WATCHDOG, DRIVE_MODE, MAX_POSITION, MODELS, OPERATING_MODE, STATUS_RETURN, TORQUE, WATCHDOG_TRIPPED,
};
use crate::dynamixel::{Bus, ServoSpec, SimulatedBus, Timing};
use crate::motion::Command;
use crate::simulate::{Faults, Faulty, Injected, SimulatedDevice, SimulatedPort};
use dh_runtime::{JointKind, Limits};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

mod attached;

const FINGERPRINT: u64 = 0x1234;

/// A turning joint of an XL430, and of an XM540 that counts the other way round.
fn map() -> JointMap {
    let joint = |name: &str, id, sign: f64, model: usize| DeviceJoint {
        name: name.to_owned(),
        kind: JointKind::Revolute,
        table_limits: Some(Limits { min: -FRAC_PI_2, max: FRAC_PI_2 }),
        max_velocity: Some(2.0),
        max_acceleration: None,
        id,
        scale: sign * 4096.0 / TAU,
        zero: 2048.0,
        range: Some(Limits { min: 0.0, max: 4095.0 }),
        model: Some(MODELS[model].name.to_owned()),
    };
    JointMap { fingerprint: FINGERPRINT, joints: vec![joint("J1", 1, 1.0, 0), joint("J2", 7, -1.0, 2)] }
}

/// A driver, and what it drives.
struct Bench {
    clock: Arc<VirtualClock>,
    device: Shared,
    arm: Arm,
}

fn device() -> Faulty<SimulatedBus> {
    let servo = |id, model: usize| ServoSpec { id, model: &MODELS[model], baud: 1_000_000, position: 2048.0 };
    Faulty::new(SimulatedBus::new([servo(1, 0), servo(7, 2)]), Faults::default(), 1)
}

type Shared = Arc<Mutex<Faulty<SimulatedBus>>>;

fn connect(device: Faulty<SimulatedBus>) -> (Arc<VirtualClock>, Shared, Result<Arm, Cause>) {
    let clock = Arc::new(VirtualClock::new());
    let device = Arc::new(Mutex::new(device));
    let port = SimulatedPort::new(device.clone(), clock.clone());
    let bus = Bus::new(Box::new(port), Timing::default());
    let arm =
        Arm::connect(bus, map(), Settings { period: Some(Duration::from_millis(10)), ..Settings::default() });
    (clock, device, arm.map_err(|error| error.cause))
}

fn command(q: [f64; 2]) -> Command {
    Command::for_test(FINGERPRINT, q.to_vec(), vec![0.0; 2])
}

impl Bench {
    fn new() -> Self {
        let (clock, device, arm) = connect(device());
        let mut arm = arm.unwrap();
        arm.torque(true).unwrap();
        Self { clock, device, arm }
    }

    fn device(&self) -> MutexGuard<'_, Faulty<SimulatedBus>> {
        let mut device = self.device.lock().unwrap();
        device.advance(self.clock.now());
        device
    }

    /// Joint values as the simulated servos have them.
    fn q(&self) -> Vec<f64> {
        let device = self.device();
        let servos = device.device.servos().iter();
        servos.zip(&map().joints).map(|(servo, joint)| joint.from_device(servo.position())).collect()
    }

    fn at_rest(&self) -> bool {
        self.device().device.servos().iter().all(|servo| servo.velocity() == 0.0)
    }

    /// Streams along a straight line at 1 rad/s or less, and reads along.
    fn stream(&mut self, from: [f64; 2], to: [f64; 2]) -> Result<(), crate::DriverError> {
        let length = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        let steps = (length / 0.01).ceil() as u32;
        let mut time = self.clock.now();
        for step in 1..=steps {
            let part = f64::from(step) / f64::from(steps);
            let q = [0, 1].map(|joint| from[joint] + part * (to[joint] - from[joint]));
            self.arm.send(&command(q))?;
            self.arm.read_state()?;
            time += Duration::from_millis(10);
            self.clock.sleep_until(time);
        }
        Ok(())
    }
}

#[test]
fn streams_to_where_it_is_told() {
    let mut bench = Bench::new();
    assert_eq!(bench.arm.pace(), Pace::Stream { period: Duration::from_millis(10) });
    assert_eq!(bench.arm.joints().joints[0].max_velocity, Some(2.0));
    bench.stream([0.0, 0.0], [0.7, -1.2]).unwrap();
    let moving = bench.arm.read_state().unwrap();
    // The second joint goes at about 1 rad/s towards less; its servo counts the other way, its signs are the joint's.
    let second = moving.joints[1];
    assert!((second.velocity.unwrap() + 1.0).abs() < 0.4, "{second:?}");
    assert!(matches!(second.effort, Some(Effort::Current(current)) if current < 0.0), "{second:?}");
    assert!(matches!(moving.joints[0].effort, Some(Effort::Load(load)) if load > 0.0), "{moving:?}");
    assert_eq!(second.moving, Some(true));
    for _ in 0..50 {
        bench.clock.advance(Duration::from_millis(10));
        bench.arm.read_state().unwrap();
    }
    let state = bench.arm.read_state().unwrap();
    for (joint, goal) in state.joints.iter().zip([0.7, -1.2]) {
        assert!((joint.position - goal).abs() <= 0.5 * TAU / 4096.0 + 1e-12, "{joint:?}");
        assert_eq!((joint.velocity, joint.moving, joint.fault), (Some(0.0), Some(false), None));
        assert_eq!(joint.temperature, Some(30.0));
    }
    assert_eq!(state.stamp, bench.clock.now());
}

#[test]
fn refused_commands_send_no_byte() {
    let mut bench = Bench::new();
    let frames = bench.device().injected.frames;
    let refusals = [
        (Command::for_test(1, vec![0.0; 2], vec![0.0; 2]), "OtherRobot"),
        (Command::for_test(FINGERPRINT, vec![0.0; 3], vec![0.0; 3]), "Length"),
        (command([0.0, f64::NAN]), "OutsideRange"),
        (command([PI, 0.0]), "OutsideRange"),
    ];
    for (command, expected) in refusals {
        let error = bench.arm.send(&command).unwrap_err();
        assert!(format!("{:?}", error.cause).starts_with(expected), "{error}");
    }
    assert_eq!(bench.device().injected.frames, frames);
    bench.arm.torque(false).unwrap();
    let frames = bench.device().injected.frames;
    assert_eq!(bench.arm.send(&command([0.0, 0.0])).unwrap_err().cause, Cause::TorqueOff);
    assert_eq!(bench.device().injected.frames, frames);
    assert!(bench.arm.watchdog(Some(Duration::from_secs(3))).is_err());
    assert_eq!(bench.device().injected.frames, frames);
}

/// As if the program were killed: not a word any more in the middle of a move.
#[test]
fn a_silent_host_leaves_the_arm_stopped() {
    let mut bench = Bench::new();
    assert_eq!(
        bench.arm.watchdog(Some(Duration::from_millis(130))).unwrap(),
        Watchdog::Device(Duration::from_millis(140))
    );
    bench.stream([0.0, 0.0], [0.4, 0.0]).unwrap();
    // A goal far away, which would take half a second.
    bench.arm.send(&command([-0.8, 0.0])).unwrap();
    bench.clock.advance(Duration::from_millis(250));
    assert!(bench.at_rest());
    let stopped = bench.q();
    assert!(stopped[0] < 0.3 && stopped[0] > -0.5, "{stopped:?}");
    bench.clock.advance(Duration::from_secs(1));
    assert_eq!(bench.q(), stopped);
    assert_eq!(bench.device().device.servos()[0].get(&BUS_WATCHDOG), WATCHDOG_TRIPPED);
    assert_eq!(bench.device().device.servos()[0].get(&TORQUE), 1);
    // The host comes back to itself and must not jump to where it would be by now.
    assert_eq!(bench.arm.send(&command([0.5, 0.0])).unwrap_err().cause, Cause::Interrupted);
    bench.clock.advance(Duration::from_secs(1));
    assert!((bench.q()[0] - stopped[0]).abs() < 0.001);
    bench.arm.torque(true).unwrap();
    bench.stream([stopped[0], 0.0], [0.0, 0.0]).unwrap();
}

#[test]
fn stops_by_decelerating_and_holds() {
    let mut bench = Bench::new();
    bench.arm.send(&command([1.5, -1.5])).unwrap();
    bench.clock.advance(Duration::from_millis(150));
    let (before, velocity) = (bench.q(), bench.arm.read_state().unwrap().joints[0].velocity.unwrap());
    assert!(velocity > 2.0);
    bench.arm.stop().unwrap();
    bench.clock.advance(Duration::from_secs(2));
    assert!(bench.at_rest());
    // v²/(2a) and what was travelled while the servos were told.
    let (after, braking) = (bench.q(), velocity * velocity / 20.0);
    assert!(
        (after[0] - before[0] - braking).abs() < 0.1 && after[0] - before[0] > 0.9 * braking,
        "{before:?} {after:?}"
    );
    // The watchdog is disarmed: a pause is no interruption.
    bench.stream([after[0], after[1]], [0.0, 0.0]).unwrap();
}

#[test]
fn latched_errors_are_told_and_in_the_way() {
    let mut bench = Bench::new();
    bench.stream([0.0, 0.0], [0.2, 0.2]).unwrap();
    bench.device().device.servo_mut(7).unwrap().latch(0b10_0000);
    let state = bench.arm.read_state().unwrap();
    let (joint, fault) = state.first_fault().unwrap();
    assert_eq!((joint, fault.code, fault.meaning), (Some(1), 0b10_0000, "overload"));
    let error = bench.arm.send(&command([0.3, 0.3])).unwrap_err();
    assert_eq!((error.joint.as_deref(), &error.cause), (Some("J2"), &Cause::Fault(*fault)));
    assert!(matches!(bench.arm.torque(true).unwrap_err().cause, Cause::Fault(_)));
    bench.arm.clear_faults().unwrap();
    assert_eq!(bench.arm.send(&command([0.3, 0.3])).unwrap_err().cause, Cause::TorqueOff);
    bench.arm.torque(true).unwrap();
    let state = bench.arm.read_state().unwrap();
    assert_eq!(state.first_fault(), None);
}

#[test]
fn comes_back_when_the_device_does() {
    let mut bench = Bench::new();
    bench.stream([0.0, 0.0], [0.3, 0.0]).unwrap();
    let now = bench.clock.now();
    bench.device().unplug(now, now + Duration::from_secs(1));
    for _ in 0..3 {
        let error = bench.arm.read_state().unwrap_err();
        assert_eq!(
            error.to_string(),
            "sync read: simulated is not there: is the device plugged in and powered?"
        );
    }
    bench.clock.advance(Duration::from_secs(2));
    assert!(bench.at_rest());
    bench.arm.read_state().unwrap();
    assert_eq!(bench.arm.send(&command([0.3, 0.0])).unwrap_err().cause, Cause::Interrupted);
    bench.arm.torque(true).unwrap();
    bench.stream([0.3, 0.0], [0.0, 0.0]).unwrap();
}

/// 10,000 commands and readings on a line where 5 % of all frames suffer: readings are right, nothing takes longer than
/// it may, and whenever the driver gives up the arm comes to rest and stays there.
#[test]
fn a_bad_line_leads_nobody_astray() {
    for (seed, delay) in [(5, 25), (6, 120)] {
        let mut bench = Bench::new();
        bench.device().faults = Faults::evenly(0.05, Duration::from_millis(delay));
        bench.device().injected = Injected::default();
        bench.device().seed(seed);
        let (mut given_up, mut readings) = (0, 0);
        let mut step = 0;
        while step < 5_000 {
            step += 1;
            let (before, angle) = (bench.clock.now(), f64::from(step) / 100.0);
            let q = [0.8 * angle.sin(), 0.5 * (1.3 * angle).sin()];
            let outcome = bench.arm.send(&command(q)).and_then(|()| bench.arm.read_state());
            let took = bench.clock.now() - before;
            // Reading, giving up and stopping: six exchanges of three attempts at the most.
            assert!(took < Duration::from_secs(2), "{took:?}");
            bench.clock.sleep_until(before + Duration::from_millis(10));
            match outcome {
                Ok(state) => {
                    readings += 1;
                    let really = bench.q();
                    for (joint, really) in state.joints.iter().zip(really) {
                        // At most 2.4 rad/s since the reading was taken.
                        assert!((joint.position - really).abs() < 0.02 + 2.4 * took.as_secs_f64() + 0.024);
                    }
                }
                Err(error) => {
                    given_up += 1;
                    bench.clock.advance(Duration::from_secs(1));
                    let rest = bench.q();
                    assert!(bench.at_rest(), "after {error}");
                    bench.clock.advance(Duration::from_secs(1));
                    assert_eq!(bench.q(), rest, "after {error}");
                    assert_eq!(
                        bench.arm.send(&command(q)).unwrap_err().cause,
                        Cause::Interrupted,
                        "after {error}"
                    );
                    while bench.arm.torque(true).is_err() {}
                    // Back to the path, slowly enough.
                    let held = [rest[0], rest[1]];
                    while bench.stream(held, q).is_err() {
                        while bench.arm.torque(true).is_err() {}
                    }
                }
            }
        }
        let injected = bench.device().injected;
        println!("late up to {delay} ms: {readings} readings, given up {given_up} times, {injected:?}");
        assert!(injected.total() > 500 && readings > 4_900 && given_up < 100);
    }
}

/// A goal far away, and a line that loses most of what passes: the driver tries to stop the arm, may fail half-way, and
/// falls silent. Wherever it failed, the arm comes to rest, and not in the goal.
#[test]
fn whatever_is_lost_the_arm_stops() {
    let mut failures = 0;
    for seed in 0..300 {
        let mut bench = Bench::new();
        bench.device().seed(seed);
        bench.arm.send(&command([-1.5, 1.5])).unwrap();
        bench.arm.watchdog(None).unwrap();
        bench.clock.advance(Duration::from_secs(1));
        // Three radians, which take 1.25 s.
        bench.arm.send(&command([1.5, -1.5])).unwrap();
        bench.clock.advance(Duration::from_millis(100));
        bench.device().faults = Faults { drop: 0.1 * (seed % 10) as f64, ..Faults::default() };
        let asked = bench.arm.read_state().and_then(|_| bench.arm.stop());
        failures += u32::from(asked.is_err());
        bench.clock.advance(Duration::from_secs(2));
        let (rest, q) = (bench.at_rest(), bench.q());
        assert!(rest && q[0] < 1.45 && q[1] > -1.45, "seed {seed}: {q:?} after {asked:?}");
        bench.device().faults = Faults::default();
        bench.arm.torque(true).unwrap();
        let held = bench.q();
        assert!((held[0] - q[0]).abs() < 0.01 && (held[1] - q[1]).abs() < 0.01, "{q:?} {held:?}");
        bench.clock.advance(Duration::from_secs(1));
        // Goals are whole ticks.
        let moved = bench.q().iter().zip(&held).map(|(now, held)| (now - held).abs()).fold(0.0, f64::max);
        assert!(moved <= 0.5 * TAU / 4096.0 + 1e-12, "torque that comes on moves the arm by {moved}");
    }
    assert!((50..250).contains(&failures), "{failures}");
}

#[test]
fn a_servo_that_started_anew_is_noticed() {
    let mut bench = Bench::new();
    bench.clock.advance(Duration::from_secs(3));
    bench.stream([0.0, 0.0], [0.3, 0.0]).unwrap();
    let now = bench.clock.now();
    bench.device().device.power(false, now);
    bench.device().device.power(true, now);
    bench.clock.advance(Duration::from_millis(250));
    bench.arm.read_state().unwrap();
    assert_eq!(bench.arm.send(&command([0.3, 0.0])).unwrap_err().cause, Cause::Interrupted);
}

#[test]
fn other_servos_than_the_tables_are_refused() {
    let change = |change: fn(&mut SimulatedBus)| {
        let mut device = device();
        change(&mut device.device);
        connect(device).2.err()
    };
    assert_eq!(change(|_| ()), None);
    // J2 needs ticks 1024 to 3072.
    let limits = change(|bus| set(bus, &MAX_POSITION, 3000));
    assert_eq!(
        limits,
        Some(Cause::LimitsDiffer { what: "max position limit", needed: 3072.0, allowed: 3000.0 })
    );
    assert!(matches!(change(|bus| set(bus, &OPERATING_MODE, 1)), Some(Cause::LimitsDiffer { .. })));
    assert_eq!(change(|bus| set(bus, &OPERATING_MODE, 4)), None);
    assert_eq!(change(|bus| set(bus, &STATUS_RETURN, 1)), None);
    assert!(matches!(change(|bus| bus.power(false, Time::START)), Some(Cause::Silent { .. })));
    assert!(matches!(change(|bus| set(bus, &DRIVE_MODE, 4)), Some(Cause::LimitsDiffer { .. })));
    let other = connect(Faulty::new(
        SimulatedBus::new([1, 7].map(|id| ServoSpec {
            id,
            model: &MODELS[0],
            baud: 1_000_000,
            position: 2048.0,
        })),
        Faults::default(),
        1,
    ));
    let expected = Cause::WrongModel { expected: "XM540-W270".into(), got: "XL430-W250".into() };
    assert_eq!(other.2.err(), Some(expected));
}

fn set(bus: &mut SimulatedBus, register: &super::Register, value: i64) {
    bus.servo_mut(7).unwrap().set(register, value);
}
