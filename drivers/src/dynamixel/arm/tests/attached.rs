//! Servos that are no joints.

use super::{MODELS, map};
use crate::clock::{Clock, VirtualClock};
use crate::driver::{Cause, DeviceJoint, Driver, DriverError};
use crate::dynamixel::arm::{Arm, Settings};
use crate::dynamixel::control_table::ID;
use crate::dynamixel::{Bus, ServoSpec, SimulatedBus, Timing};
use crate::simulate::SimulatedPort;
use dh_runtime::Limits;
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// The two joints of [`map`] and a third servo, with id 9.
struct Bench {
    clock: Arc<dyn Clock>,
    device: Arc<Mutex<SimulatedBus>>,
}

impl Bench {
    fn new() -> Self {
        let servo =
            |id, model: usize| ServoSpec { id, model: &MODELS[model], baud: 1_000_000, position: 2048.0 };
        let device = SimulatedBus::new([servo(1, 0), servo(7, 2), servo(9, 1)]);
        Self { clock: Arc::new(VirtualClock::new()), device: Arc::new(Mutex::new(device)) }
    }

    fn connect(&self, attachments: Vec<DeviceJoint>) -> Result<Arm, DriverError> {
        let port = SimulatedPort::new(Arc::clone(&self.device), Arc::clone(&self.clock));
        let arm = Arm::connect(Bus::new(Box::new(port), Timing::default()), map(), Settings::default());
        arm.unwrap().with_attachments(attachments)
    }

    fn driven(&self) -> [bool; 3] {
        [1, 7, 9].map(|id| self.device.lock().unwrap().servo(id).unwrap().is_driven())
    }

    fn latch(&self, id: u8) {
        self.device.lock().unwrap().servo_mut(id).unwrap().latch(0b10_0000);
    }

    /// The hand is pulled off: nobody has its id any more.
    fn pull_off(&self) {
        self.device.lock().unwrap().servo_mut(9).unwrap().set(&ID, 20);
    }
}

fn attached(name: &str, id: u32) -> DeviceJoint {
    DeviceJoint {
        name: name.to_owned(),
        id,
        model: None,
        table_limits: None,
        range: Some(Limits { min: 1000.0, max: 3000.0 }),
        ..map().joints[0].clone()
    }
}

fn hand(id: u32) -> DeviceJoint {
    attached("hand", id)
}

/// A hand of one servo: moved by itself, within its own range, with a torque of its own; one that is not there is left out.
#[test]
fn what_is_attached_is_moved_by_itself() {
    let bench = Bench::new();
    assert!(bench.connect(vec![hand(30)]).unwrap().attachments().is_empty());
    let mut arm = bench.connect(vec![hand(9)]).unwrap();
    let [attachment] = <[_; 1]>::try_from(Driver::attachments(&arm)).unwrap();
    assert!((attachment.range.max - 952.0 * TAU / 4096.0).abs() < 1e-9, "{attachment:?}");
    let position = || bench.device.lock().unwrap().servo(9).unwrap().position();
    let error = arm.move_attachment("hand", 2.0).unwrap_err();
    assert!(matches!(error.cause, Cause::OutsideRange { value, .. } if value > 3000.0), "{error}");
    assert_eq!(arm.move_attachment("foot", 0.1).unwrap_err().cause, Cause::Unsupported);
    assert_eq!((bench.driven(), position()), ([false; 3], 2048.0));
    arm.move_attachment("hand", 0.5).unwrap();
    bench.clock.sleep_until(bench.clock.now() + Duration::from_secs(2));
    assert!((arm.read_attachment("hand").unwrap() - 0.5).abs() < TAU / 4096.0);
    assert_eq!(bench.driven(), [false, false, true]);
    arm.torque(false).unwrap();
    assert_eq!(bench.driven(), [false; 3]);
}

#[test]
fn an_id_that_is_taken_is_told_with_whose_it_is() {
    let bench = Bench::new();
    for (attachments, name, id, of) in [
        (vec![hand(7)], "hand", 7, "J2"),
        (vec![hand(9), attached("lamp", 9)], "lamp", 9, "hand"),
        // Whether the first is there makes no difference.
        (vec![hand(30), attached("lamp", 30)], "lamp", 30, "hand"),
    ] {
        let error = bench.connect(attachments).unwrap_err();
        assert_eq!(
            (error.joint.as_deref(), &error.cause),
            (Some(name), &Cause::IdTaken { id, of: of.to_owned() })
        );
    }
    let error = bench.connect(vec![hand(253)]).unwrap_err();
    assert!(matches!(error.cause, Cause::OutsideRange { max: 252.0, .. }), "{error}");
    let mut twice = map();
    twice.joints[1].id = 1;
    let port = SimulatedPort::new(Arc::clone(&bench.device), Arc::clone(&bench.clock));
    let bus = Bus::new(Box::new(port), Timing::default());
    let error = Arm::connect(bus, twice, Settings::default()).unwrap_err();
    assert_eq!(error.joint.as_deref(), Some("J2"));
    assert_eq!(error.cause, Cause::IdTaken { id: 1, of: "J1".to_owned() });
}

/// The joints, which have no fault, hold on meanwhile.
#[test]
fn a_fault_of_what_is_attached_is_forgotten_too() {
    let bench = Bench::new();
    let mut arm = bench.connect(vec![hand(9)]).unwrap();
    arm.torque(true).unwrap();
    arm.move_attachment("hand", 0.5).unwrap();
    bench.latch(9);
    let error = arm.move_attachment("hand", 0.0).unwrap_err();
    assert!(error.joint.as_deref() == Some("hand") && matches!(error.cause, Cause::Fault(_)), "{error}");
    arm.clear_faults().unwrap();
    assert_eq!(bench.driven(), [true, true, false]);
    arm.send(&super::command([0.0; 2])).unwrap();
    arm.move_attachment("hand", 0.0).unwrap();
    assert_eq!(bench.driven(), [true; 3]);
}

#[test]
fn a_hand_that_was_pulled_off_is_in_nobodys_way() {
    let bench = Bench::new();
    let mut arm = bench.connect(vec![hand(9)]).unwrap();
    arm.torque(true).unwrap();
    bench.pull_off();
    let driven = || [1, 7].map(|id| bench.device.lock().unwrap().servo(id).unwrap().is_driven());
    bench.latch(7);
    arm.clear_faults().unwrap();
    arm.torque(true).unwrap();
    arm.torque(false).unwrap();
    assert_eq!(driven(), [false; 2]);
    // It is known to be off, not interrupted.
    assert_eq!(arm.send(&super::command([0.0; 2])).unwrap_err().cause, Cause::TorqueOff);
}
