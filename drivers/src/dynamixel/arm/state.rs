//! What servos tell of themselves, in SI.

use super::{Arm, Servo, Torque};
use crate::clock::Time;
use crate::driver::{DeviceJoint, DriverError, Effort, JointState, State};
use crate::dynamixel::bus::Answer;
use crate::dynamixel::control_table::{
    ACCELERATION_UNIT, CURRENT_UNIT, LOAD_UNIT, MOVING, PRESENT_LOAD, PRESENT_POSITION, PRESENT_VELOCITY,
    REALTIME_TICK, Register, TEMPERATURE, TICKS_PER_TURN, TORQUE, VELOCITY_UNIT,
};
use crate::dynamixel::status::hardware_fault;
use std::f64::consts::TAU;
use std::time::Duration;

/// What was read before.
#[derive(Debug, Default)]
pub(super) struct Seen {
    /// When the servos' clocks showed what (ms).
    ticks: Option<(Time, Vec<i64>)>,
    /// When they were how hot (°C): it is asked for less often.
    temperatures: Option<(Time, Vec<i64>)>,
    /// Every other read is a byte longer, so that no answer can be taken for the one before it.
    odd: bool,
}

/// How often temperatures are read.
const TEMPERATURES: Duration = Duration::from_secs(1);
/// How far a servo's clock may be from what it should show (ms), besides 2 % of the time passed.
const TICK_TOLERANCE: f64 = 250.0;
/// After so long the clocks have nothing to tell: they begin again every 32.768 s.
const TICKS_TELL: Duration = Duration::from_secs(10);

/// From the servo's units of velocity to ticks per second.
const TICK_RATE: f64 = VELOCITY_UNIT * TICKS_PER_TURN / TAU;

/// Where the servo comes to rest at the soonest (ticks), of the registers of velocity and position.
pub(super) fn rest(data: &[u8], servo: &Servo) -> i64 {
    let at = PRESENT_VELOCITY.address;
    let position = PRESENT_POSITION.value_in(data, at).unwrap_or(0);
    let velocity = PRESENT_VELOCITY.value_in(data, at).unwrap_or(0) as f64 * TICK_RATE;
    let deceleration = ACCELERATION_UNIT * TICKS_PER_TURN / TAU * servo.braking.max(1) as f64;
    position + (velocity * velocity.abs() / (2.0 * deceleration)).round() as i64
}

fn joint_state(data: &[u8], joint: &DeviceJoint, servo: &Servo) -> JointState {
    let value = |register| Register::value_in(register, data, REALTIME_TICK.address);
    let load = value(&PRESENT_LOAD).unwrap_or(0) as f64 * joint.scale.signum();
    JointState {
        position: joint.from_device(value(&PRESENT_POSITION).unwrap_or(0) as f64),
        velocity: value(&PRESENT_VELOCITY).map(|velocity| velocity as f64 * TICK_RATE / joint.scale),
        effort: Some(if servo.model.has_current {
            Effort::Current(load * CURRENT_UNIT)
        } else {
            Effort::Load(load * LOAD_UNIT)
        }),
        temperature: None,
        moving: value(&MOVING).map(|moving| moving != 0),
        fault: None,
    }
}

impl Arm {
    /// Everything at once, and what follows from it.
    pub(super) fn present(&mut self) -> Result<State, DriverError> {
        let ids = self.ids();
        self.seen.odd = !self.seen.odd;
        let end = PRESENT_POSITION.address + PRESENT_POSITION.size;
        let length = end - REALTIME_TICK.address + u16::from(self.seen.odd);
        let answers = self.bus.sync_read(&ids, REALTIME_TICK.address, length);
        let answers = answers.map_err(|error| self.named(error))?;
        let stamp = self.bus.port().clock().now();
        let joints = answers.iter().zip(&self.map.joints).zip(&self.servos);
        let mut joints: Vec<JointState> =
            joints.map(|((answer, joint), servo)| joint_state(&answer.data, joint, servo)).collect();
        self.compare_ticks(stamp, &answers)?;
        self.read_temperatures(stamp)?;
        let temperatures = self.seen.temperatures.iter().flat_map(|(_, values)| values);
        for (joint, temperature) in joints.iter_mut().zip(temperatures) {
            joint.temperature = Some(*temperature as f64);
        }
        self.fault = None;
        if answers.iter().any(|answer| answer.alert) {
            for (place, (joint, bits)) in joints.iter_mut().zip(self.latched()?).enumerate() {
                joint.fault = hardware_fault(bits);
                self.fault = self.fault.or(joint.fault.map(|fault| (place, fault)));
            }
        }
        Ok(State { stamp, joints, fault: None })
    }

    /// A servo whose clock shows something else than it should has started anew, perhaps: then its torque is off.
    fn compare_ticks(&mut self, now: Time, answers: &[Answer]) -> Result<(), DriverError> {
        let at = REALTIME_TICK.address;
        let ticks = answers.iter().filter_map(|answer| REALTIME_TICK.value_in(&answer.data, at)).collect();
        let before = self.seen.ticks.replace((now, ticks));
        let (Some((then, before)), Some((_, ticks))) = (before, &self.seen.ticks) else { return Ok(()) };
        let passed = now - then;
        let milliseconds = passed.as_secs_f64() * 1e3;
        let period = (REALTIME_TICK.range.1 + 1) as f64;
        let off = |(tick, before): (&i64, &i64)| {
            let error = *tick as f64 - *before as f64 - milliseconds;
            (error - (error / period).round() * period).abs() > TICK_TOLERANCE + 0.02 * milliseconds
        };
        let doubtful = passed > TICKS_TELL || ticks.iter().zip(&before).any(off);
        if doubtful && self.torque == Torque::On && self.read_all(&TORQUE)?.contains(&0) {
            self.torque = Torque::Interrupted;
        }
        Ok(())
    }

    fn read_temperatures(&mut self, now: Time) -> Result<(), DriverError> {
        let due = self.seen.temperatures.as_ref().is_none_or(|(then, _)| now - *then >= TEMPERATURES);
        if due {
            self.seen.temperatures = Some((now, self.read_all(&TEMPERATURE)?));
        }
        Ok(())
    }
}
