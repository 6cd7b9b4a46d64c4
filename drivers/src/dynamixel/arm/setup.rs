//! Finding the servos of a table, and seeing whether they are set up for it.

use super::state::Seen;
use super::{Arm, Servo, Settings, Torque};
use crate::driver::{Cause, DeviceJoint, DriverError, JointMap};
use crate::dynamixel::bus::{Bus, servo_name};
use crate::dynamixel::control_table::{
    ACCELERATION_UNIT, DRIVE_MODE, EXTENDED_POSITION_MODE, MAX_POSITION, MIN_POSITION, Model, OPERATING_MODE,
    POSITION_MODE, PROFILE_ACCELERATION, Register, STATUS_RETURN, TICKS_PER_TURN, VELOCITY_LIMIT,
    VELOCITY_UNIT,
};
use crate::dynamixel::packet::MAX_ID;
use std::f64::consts::TAU;
use std::time::Duration;

pub(super) const NAME: &str = "connect";
/// How much faster than the joint's greatest velocity a servo may go to catch up with a stream.
const CATCHING_UP: f64 = 1.2;
/// The shortest period of a stream.
const SHORTEST: Duration = Duration::from_millis(10);
/// Bit of the drive mode: profiles are given as times.
const TIMED_PROFILES: i64 = 4;

/// Calls the joint by its name where the bus knows only an id.
pub(super) fn named(map: &JointMap, mut error: DriverError) -> DriverError {
    let joint = map.joints.iter().find(|joint| {
        u8::try_from(joint.id).is_ok_and(|id| error.joint.as_deref() == Some(servo_name(id).as_str()))
    });
    error.joint = joint.map(|joint| joint.name.clone()).or(error.joint);
    error
}

pub(super) fn connect(mut bus: Bus, mut map: JointMap, settings: Settings) -> Result<Arm, DriverError> {
    let port = bus.port().name().to_owned();
    let refused = |joint: &DeviceJoint, cause| {
        Err(DriverError::new(port.as_str(), NAME, cause).of_joint(joint.name.as_str()))
    };
    let mut ids = Vec::new();
    for (index, joint) in map.joints.iter().enumerate() {
        match own_id(joint, map.joints.iter().take(index)) {
            Ok(id) => ids.push(id),
            Err(cause) => return refused(joint, cause),
        }
    }
    // Servos that don't answer writes couldn't say that they refuse one.
    let answering = ids.iter().map(|id| (*id, STATUS_RETURN.bytes(2))).collect::<Vec<_>>();
    bus.sync_write(STATUS_RETURN.address, &answering)?;
    let mut servos = Vec::new();
    for (joint, id) in map.joints.iter().zip(&ids) {
        let found = find(&mut bus, joint, *id, settings).map_err(|error| named(&map, error))?;
        match found {
            Ok(servo) => servos.push(servo),
            Err(cause) => return refused(joint, cause),
        }
    }
    for (joint, (_, fastest)) in map.joints.iter_mut().zip(&servos) {
        joint.max_velocity = Some(joint.max_velocity.map_or(*fastest, |table| table.min(*fastest)));
    }
    let servos: Vec<Servo> = servos.into_iter().map(|(servo, _)| servo).collect();
    let period = settings.period.unwrap_or_else(|| period(&bus, servos.len()));
    let (torque, seen) = (Torque::Off, Seen::default());
    let attached = Vec::new();
    Ok(Arm {
        bus,
        map,
        servos,
        attached,
        settings,
        period,
        torque,
        armed: None,
        braking: true,
        fault: None,
        seen,
    })
}

/// The id of a servo, which must be one of the protocol and none of the others'.
pub(super) fn own_id<'j>(
    joint: &DeviceJoint,
    mut others: impl Iterator<Item = &'j DeviceJoint>,
) -> Result<u8, Cause> {
    let id = u8::try_from(joint.id).ok().filter(|id| *id <= MAX_ID);
    let range = Cause::OutsideRange { value: joint.id.into(), min: 0.0, max: MAX_ID.into() };
    let id = id.ok_or(range)?;
    match others.find(|other| other.id == joint.id) {
        Some(other) => Err(Cause::IdTaken { id: joint.id, of: other.name.clone() }),
        None => Ok(id),
    }
}

/// As often as the line allows: a goal for each servo and a read of their state, and a quarter more.
fn period(bus: &Bus, servos: usize) -> Duration {
    // Overhead of a group write, five bytes a goal; overhead of a group read, an id each; 31 bytes a state.
    let wire = bus.wire_time((14 + 5 * servos) + (14 + servos) + 31 * servos);
    let delays = Duration::from_micros(500) * servos as u32;
    let whole = (wire.mul_f64(1.25) + delays).as_secs_f64() * 1e3;
    SHORTEST.max(Duration::from_millis(whole.ceil() as u64 + 2))
}

/// The servo of a joint and the greatest velocity (rad/s or m/s) that it allows; or why it is not the one.
pub(super) fn find(
    bus: &mut Bus,
    joint: &DeviceJoint,
    id: u8,
    settings: Settings,
) -> Result<Result<(Servo, f64), Cause>, DriverError> {
    let number = bus.ping(id)?.model;
    let expected = || joint.model.clone().unwrap_or_else(|| "an X servo".to_owned());
    let Some(model) = Model::by_number(number) else {
        return Ok(Err(Cause::WrongModel { expected: expected(), got: format!("model number {number}") }));
    };
    if joint.model.as_deref().is_some_and(|name| Model::by_name(name) != Some(model)) {
        return Ok(Err(Cause::WrongModel { expected: expected(), got: model.name.to_owned() }));
    }
    let modes = bus.read(id, DRIVE_MODE.address, 2)?.data;
    let limits = bus.read(id, VELOCITY_LIMIT.address, 12)?.data;
    let mode = |register| Register::value_in(register, &modes, DRIVE_MODE.address);
    let limit = |register| Register::value_in(register, &limits, VELOCITY_LIMIT.address);
    let (Some(drive), Some(operating)) = (mode(&DRIVE_MODE), mode(&OPERATING_MODE)) else {
        return Ok(Err(Cause::Garbled));
    };
    let (Some(fastest), Some(min), Some(max)) =
        (limit(&VELOCITY_LIMIT), limit(&MIN_POSITION), limit(&MAX_POSITION))
    else {
        return Ok(Err(Cause::Garbled));
    };
    let differ = |what, needed: i64, allowed: i64| {
        Ok(Err(Cause::LimitsDiffer { what, needed: needed as f64, allowed: allowed as f64 }))
    };
    if drive & TIMED_PROFILES != 0 {
        return differ("drive mode", drive & !TIMED_PROFILES, drive);
    }
    let own = match operating {
        POSITION_MODE => (min, max),
        EXTENDED_POSITION_MODE => (-1_048_575, 1_048_575),
        _ => return differ("operating mode", POSITION_MODE, operating),
    };
    // What the joint's limits need, in ticks.
    if let Some(limits) = joint.limits() {
        let (a, b) = (joint.to_device(limits.min).round() as i64, joint.to_device(limits.max).round() as i64);
        let (low, high) = (a.min(b), a.max(b));
        if low < own.0 {
            return differ("min position limit", low, own.0);
        }
        if high > own.1 {
            return differ("max position limit", high, own.1);
        }
    }
    let goals = joint
        .range
        .map_or(own, |range| (own.0.max(range.min.ceil() as i64), own.1.min(range.max.floor() as i64)));
    // Radians of the servo's shaft per radian (or metre) of the joint.
    let gear = joint.scale.abs() * TAU / TICKS_PER_TURN;
    let in_units = |value: f64, unit: f64| (value * gear / unit).ceil().clamp(1.0, 32767.0) as i64;
    let velocity =
        joint.max_velocity.map_or(fastest, |v| in_units(v * CATCHING_UP, VELOCITY_UNIT).min(fastest));
    let braking = in_units(joint.max_acceleration.unwrap_or(settings.braking), ACCELERATION_UNIT)
        .min(PROFILE_ACCELERATION.range.1);
    Ok(Ok((Servo { id, model, goals, velocity, braking }, fastest as f64 * VELOCITY_UNIT / gear)))
}
