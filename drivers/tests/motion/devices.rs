//! The same robots on the simulated devices, through their protocols.

use super::{CraneX7, MyCobot, Planar};
use dh_drivers::Driver;
use dh_drivers::clock::{Clock, VirtualClock};
use dh_drivers::driver::JointMap;
use dh_drivers::dynamixel::control_table::Model as ServoModel;
use dh_drivers::dynamixel::{self, Bus, ServoSpec, SimulatedBus, Timing};
use dh_drivers::motion::{Defaults, MotionError, Move, Robot};
use dh_drivers::mycobot::{self, SimulatedMyCobot};
use dh_drivers::simulate::{Faults, Faulty, SimulatedPort};
use dh_runtime::{Kinematics, Target};
use std::sync::{Arc, Mutex};
use std::time::Duration;

const TICK: f64 = std::f64::consts::TAU / 4096.0;

pub(crate) type Servos = Arc<Mutex<Faulty<SimulatedBus>>>;

/// An arm of simulated servos at these joint values, on a line as good as `faults` lets it be.
pub(crate) fn servos(
    arm: &dyn Kinematics,
    q: &[f64],
    baud: u32,
    faults: Faults,
) -> (Servos, Box<dyn Driver>) {
    let map = JointMap::of_table(arm).unwrap();
    let specs = map.joints.iter().zip(q).map(|(joint, q)| ServoSpec {
        id: u8::try_from(joint.id).unwrap(),
        model: ServoModel::by_name(joint.model.as_deref().unwrap()).unwrap(),
        baud,
        position: joint.to_device(*q),
    });
    let device = Arc::new(Mutex::new(Faulty::new(SimulatedBus::new(specs), faults, 7)));
    let clock: Arc<dyn Clock> = Arc::new(VirtualClock::new());
    let port = SimulatedPort::new(Arc::clone(&device), clock);
    let bus = Bus::new(Box::new(port), Timing::default());
    let driver = dynamixel::Arm::connect(bus, map, dynamixel::Settings::default()).unwrap();
    (device, Box::new(driver))
}

pub(crate) fn good() -> Faults {
    Faults::default()
}

/// How far the servos are from these joint values, in ticks at most.
fn ticks_off(arm: &dyn Kinematics, device: &Servos, q: &[f64]) -> f64 {
    let map = JointMap::of_table(arm).unwrap();
    let device = device.lock().unwrap();
    let off = map.joints.iter().zip(q).map(|(joint, q)| {
        let servo = device.device.servo(u8::try_from(joint.id).unwrap()).unwrap();
        (servo.position() - joint.to_device(*q)).abs()
    });
    off.fold(0.0, f64::max)
}

#[test]
fn two_servos_end_within_two_ticks() {
    let (device, driver) = servos(&Planar, &[0.0, 0.0], 57_600, good());
    let mut robot = Robot::new(&Planar, driver).unwrap();
    let test = Planar::POSES.iter().find(|pose| pose.name == "test").unwrap();
    robot.go(&[Move::joints(test.q)]).unwrap();
    assert!(ticks_off(&Planar, &device, test.q) <= 1.0);
    let third = std::f64::consts::FRAC_PI_3;
    robot.go(&[Move::joints(&[third, -third])]).unwrap();
    assert!(ticks_off(&Planar, &device, &[third, -third]) <= 2.0);
    let at = |x, y| Target::Xy([x, y]);
    robot
        .go(&[Move::nearest("xy_elbow_up", at(0.2, 0.1)), Move::line("xy_elbow_up", at(0.1, 0.15))])
        .unwrap();
    let tool = robot.arm().fk(&robot.state().positions()).unwrap();
    let [x, y, _] = tool.translation;
    assert!((x - 0.1).hypot(y - 0.15) < 2.0 * TICK * 0.28, "{x} {y}");
}

#[test]
fn a_stroke_in_a_second_and_a_half() {
    let (device, driver) = servos(&Planar, &[1.4, -1.4], 57_600, good());
    let fast = Defaults { revolute_velocity: 4.0, ..Defaults::default() };
    let mut robot = Robot::new(&Planar, driver).unwrap();
    let slow = robot.plan(&[Move::joints(&[0.0, 0.0]).within(1.5)]).unwrap_err();
    assert!(slow.to_string().contains("longer than 1.500 s"), "{slow}");
    robot = robot.with_defaults(&fast);
    let clock = robot.driver().clock();
    let begun = clock.now();
    robot.go(&[Move::joints(&[0.0, 0.0]).within(1.5)]).unwrap();
    assert!(clock.now() - begun < Duration::from_millis(1500), "{:?}", clock.now() - begun);
    assert!(ticks_off(&Planar, &device, &[0.0, 0.0]) <= 1.0);
}

#[test]
fn seven_servos_at_three_megabaud_make_a_line_with_the_wrist_down() {
    let start = [0.0, -0.3, 0.0, -1.9, 0.0, 2.2 - std::f64::consts::PI, 0.0];
    let (device, driver) = servos(&CraneX7, &start, 3_000_000, good());
    let mut robot = Robot::new(&CraneX7, driver).unwrap();
    let at = |x, y, z| Target::Position([x, y, z]);
    let corners = [at(0.3, 0.1, 0.15), at(0.3, -0.1, 0.15), at(0.3, -0.1, 0.25), at(0.3, 0.1, 0.25)];
    let mut moves = vec![Move::nearest("wrist_down", corners[0])];
    moves.extend(corners[1..].iter().map(|corner| Move::line("wrist_down", *corner).speed(0.08)));
    let mut seen = Vec::new();
    robot
        .go_watched(&moves, &mut |progress| {
            if progress.arrived {
                seen.push((progress.goal.to_vec(), progress.state.positions()));
            }
        })
        .unwrap();
    assert_eq!(seen.len(), 4);
    for ((goal, seen), corner) in seen.iter().zip(corners) {
        assert!(goal.iter().zip(seen).all(|(a, b)| (a - b).abs() <= 2.0 * TICK), "{goal:?} {seen:?}");
        let Target::Position([x, y, z]) = corner else { unreachable!() };
        let [tx, ty, tz] = Kinematics::fk(&CraneX7, seen).unwrap().translation;
        assert!((tx - x).abs().max((ty - y).abs()).max((tz - z).abs()) < 2e-3, "{tx} {ty} {tz}");
    }
    drop(device);
}

#[test]
fn a_bad_line_does_not_bring_the_servos_to_a_wrong_place() {
    let faults = Faults::evenly(0.05, Duration::from_millis(20));
    let (device, driver) = servos(&Planar, &[0.0, 0.0], 1_000_000, faults);
    let mut robot = Robot::new(&Planar, driver).unwrap();
    let (mut done, mut broken) = (0, 0);
    for turn in 0..12 {
        let goal = if turn % 2 == 0 { [1.0, -1.2] } else { [-0.5, 0.4] };
        match robot.go(&[Move::joints(&goal)]) {
            Ok(()) => {
                done += 1;
                assert!(ticks_off(&Planar, &device, &goal) <= 2.0);
            }
            // It gave up: the arm stands then, wherever it is, and can be sent off again.
            Err(error) => {
                broken += 1;
                assert!(!matches!(error, MotionError::NotStopped { .. }), "{error}");
                assert!(device.lock().unwrap().device.servo(1).unwrap().velocity() == 0.0, "{error}");
            }
        }
    }
    println!("{done} done, {broken} given up");
    assert!(done >= 6, "{done} done, {broken} given up");
}

#[test]
fn servos_whose_line_is_pulled_stop_and_go_on_when_it_is_back() {
    let (device, driver) = servos(&Planar, &[0.0, 0.0], 1_000_000, good());
    let mut robot = Robot::new(&Planar, driver).unwrap();
    let now = robot.driver().clock().now();
    device.lock().unwrap().unplug(now + Duration::from_millis(800), now + Duration::from_secs(5));
    let error = robot.go(&[Move::joints(&[2.0, -2.0])]).unwrap_err();
    let stopped = ticks_off(&Planar, &device, &[2.0, -2.0]);
    assert!(stopped > 100.0, "{error}");
    let clock = robot.driver().clock();
    clock.sleep_until(now + Duration::from_secs(6));
    robot.go(&[Move::joints(&[2.0, -2.0])]).unwrap();
    assert!(ticks_off(&Planar, &device, &[2.0, -2.0]) <= 2.0);
}

pub(crate) type Cobot = Arc<Mutex<Faulty<SimulatedMyCobot<'static>>>>;

pub(crate) fn cobot(model: mycobot::Model, faults: Faults) -> (Cobot, Box<dyn Driver>) {
    let device = SimulatedMyCobot::new(Box::new(MyCobot), model).unwrap();
    let device = Arc::new(Mutex::new(Faulty::new(device, faults, 3)));
    let clock: Arc<dyn Clock> = Arc::new(VirtualClock::new());
    let port = Box::new(SimulatedPort::new(Arc::clone(&device), clock));
    let map = JointMap::of_table(&MyCobot).unwrap();
    (device, Box::new(mycobot::MyCobot::new(port, map, model).unwrap()))
}

fn degrees_off(device: &Cobot, q: &[f64]) -> f64 {
    let at = device.lock().unwrap().device.positions();
    at.iter().zip(q).map(|(a, b)| (a - b).abs().to_degrees()).fold(0.0, f64::max)
}

#[test]
fn a_mycobot_ends_within_a_tenth_of_a_degree() {
    for model in [mycobot::Model::Pi, mycobot::Model::M5] {
        let (device, driver) = cobot(model, good());
        let mut robot = Robot::new(&MyCobot, driver).unwrap().with_poses(&MyCobot::POSES);
        let plate = MyCobot::POSES.iter().find(|pose| pose.name == "above_plate").unwrap();
        robot.go(&[Move::joints(plate.q).slowed(0.5)]).unwrap();
        assert!(degrees_off(&device, plate.q) <= 0.1);
        let at = |x, y, z| Target::Position([x, y, z]);
        robot
            .go(&[
                Move::nearest("tool_down", at(0.15, -0.1, 0.05)),
                Move::line("tool_down", at(0.15, -0.1, 0.15)),
                Move::nearest("tool_down", at(0.1, -0.15, 0.15)),
                Move::line("tool_down", at(0.1, -0.15, 0.05)),
            ])
            .unwrap();
        let stands = robot.stands();
        assert!(degrees_off(&device, &stands) <= 0.1);
        let [x, y, z] = Kinematics::fk(&MyCobot, &stands).unwrap().translation;
        assert!((x - 0.1).abs().max((y + 0.15).abs()).max((z - 0.05).abs()) < 1e-6);
        let rest = MyCobot::POSES.iter().find(|pose| pose.safe).unwrap();
        robot.go(&[Move::joints(rest.q)]).unwrap();
        robot.release().unwrap();
        assert!(!device.lock().unwrap().device.is_holding());
    }
}

#[test]
fn a_refused_move_sends_a_mycobot_no_request() {
    let (device, driver) = cobot(mycobot::Model::Pi, good());
    let mut robot = Robot::new(&MyCobot, driver).unwrap();
    let requests = device.lock().unwrap().device.requests();
    let low = Move::nearest("tool_down", Target::Position([0.15, -0.1, 0.01]));
    for wrong in [Move::joints(&[2.0; 6]), low, Move::joints(&[0.1; 6]).slowed(2.0)] {
        assert!(matches!(robot.go(&[wrong]), Err(MotionError::Refused(_))));
    }
    assert_eq!(device.lock().unwrap().device.requests(), requests);
}

#[test]
fn a_collision_stops_a_mycobot() {
    let (device, driver) = cobot(mycobot::Model::Pi, good());
    let mut robot = Robot::new(&MyCobot, driver).unwrap();
    let goal = [1.2, -0.6, 1.0, -0.4, 0.6, -0.9];
    let collides = device.clone();
    let error = robot.go_watched(&[Move::joints(&goal).slowed(0.3)], &mut |progress| {
        if progress.elapsed > 0.5 {
            collides.lock().unwrap().device.latch(17);
        }
    });
    let error = error.unwrap_err();
    assert!(error.to_string().contains("17"), "{error}");
    assert!(!device.lock().unwrap().device.is_moving() && degrees_off(&device, &goal) > 1.0);
}

#[test]
fn a_bad_line_does_not_bring_a_mycobot_to_a_wrong_place() {
    let (device, driver) = cobot(mycobot::Model::Pi, Faults::evenly(0.05, Duration::from_millis(20)));
    let mut robot = Robot::new(&MyCobot, driver).unwrap();
    let (mut done, mut broken) = (0, 0);
    for turn in 0..12 {
        let goal =
            if turn % 2 == 0 { [0.5, -0.6, 1.0, -0.4, 0.6, -0.9] } else { [-0.5, 0.1, -1.0, 0.4, 0.0, 0.2] };
        let asked = [Move::joints(&goal).slowed(0.5)];
        match robot.go(&asked) {
            Ok(()) => {
                done += 1;
                assert!(degrees_off(&device, &goal) <= 0.1);
            }
            Err(error) => {
                broken += 1;
                println!("{error}");
                assert!(
                    !device.lock().unwrap().device.is_moving()
                        || matches!(error, MotionError::NotStopped { .. }),
                    "{error}"
                );
                // A goal that was broken into one beyond the limits is refused, and latched.
                let cleared = (0..5).any(|_| robot.clear_faults().is_ok());
                assert!(cleared, "{error}");
            }
        }
    }
    println!("{done} done, {broken} given up");
    assert!(done >= 6, "{done} done, {broken} given up");
}
