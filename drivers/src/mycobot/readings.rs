//! What is read of the arm, and whether it can be believed.

use std::time::Duration;

use super::command::Command as C;
use super::link::Link;
use super::refusal::ANGLES;
use super::reply::Reply;
use super::request::Request;
use crate::clock::Time;
use crate::driver::{Cause, DriverError, JointMap, JointState, State};

/// How far beyond what the arm takes a joint can be read (deg).
const BEYOND: f64 = 2.0;
/// How far two readings of a joint at rest may be apart (deg): the last digit may round either way.
const AT_REST: f64 = 0.015;
/// The same after so many pairs that differed: a servo may hunt by one of its ticks, which are 0.09.
const TICK: f64 = 0.1;
const HUNTING: usize = 2;
/// How far readings of a moving joint may be apart beyond what it travels (deg).
const MOVING: f64 = 1.0;
/// How far two readings of the coordinates may be apart, of an arm on its way too (mm, deg).
const ALIKE_LENGTH: f64 = 30.0;
const ALIKE_ANGLE: f64 = 15.0;
/// Two readings that took longer than this say little of a moving joint: another is taken, as long as there are any.
const PAIR: Duration = Duration::from_millis(150);
/// How many readings are taken at most until two agree.
const READINGS: usize = 5;
/// Two states further apart than this tell no velocity (s).
const VELOCITY_SPAN: f64 = 1.0;

/// Angles (deg) and when they were true: at some time between the two.
#[derive(Debug, Clone, Copy)]
struct Reading {
    asked: Time,
    answered: Time,
    angles: [f64; 6],
}

/// Readings so far and how fast joints can go.
#[derive(Debug)]
pub(super) struct Readings {
    /// rad/s at 100 %, one a joint.
    full_speeds: Vec<f64>,
    /// The speed of the present goal as a part of the full ones.
    speed: f64,
    last: Option<Reading>,
}

impl Readings {
    pub(super) fn new(full_speeds: Vec<f64>) -> Self {
        Self { full_speeds, speed: 1.0, last: None }
    }

    /// The device was away: nothing is known of where it is.
    pub(super) fn forget(&mut self) {
        self.last = None;
        self.speed = 1.0;
    }

    /// The speed that the leading joint is given for these velocities (rad/s), in percent of its full speed: the arm
    /// has one speed for all joints. Not a whole number, and not a number where a velocity is none.
    pub(super) fn percent(&self, velocities: &[f64]) -> f64 {
        let parts = velocities.iter().zip(&self.full_speeds).map(|(velocity, full)| velocity.abs() / full);
        let greatest = parts.fold(0.0, |greatest: f64, part| if part <= greatest { greatest } else { part });
        // What rounding took from 20 % makes it no 19.
        100.0 * greatest + 1e-9
    }

    /// From now on joints go at most this fast (rad/s), once they have come down from how fast they go now.
    pub(super) fn expect(&mut self, velocities: &[f64]) {
        self.speed = self.speed.max((self.percent(velocities) / 100.0).clamp(0.01, 1.0));
    }

    /// The state of all joints. At rest two readings in a row must be alike; on the way they must lie no further apart
    /// than the joints go, and the last ones no further from those of the call before.
    ///
    /// A joint without torque may be moved by hand: it needs no reason to be elsewhere.
    pub(super) fn state(
        &mut self,
        link: &mut Link,
        joints: &JointMap,
        holding: bool,
    ) -> Result<State, DriverError> {
        let request = Request::plain(C::IsMoving);
        let mut moved = link.ask(&request, Reply::flag)?;
        let mut first = Self::reading(link, joints)?;
        let (mut differed, mut apart) = (0, Apart { joint: 0, first: 0.0, second: 0.0 });
        for attempt in 1..READINGS {
            let second = Self::reading(link, joints)?;
            // That it rests is said twice.
            let moves = link.ask(&request, Reply::flag)?;
            let moving = moved || moves;
            if attempt + 1 < READINGS && second.answered.since(first.asked) > PAIR {
                (first, moved) = (second, moves);
                continue;
            }
            let (speed, slack) = match (holding, moving) {
                (false, _) => (1.0, MOVING),
                (true, true) => (self.speed, MOVING),
                (true, false) => (0.0, if differed < HUNTING { AT_REST } else { TICK }),
            };
            let last = self.last.filter(|_| holding);
            let jump = last.and_then(|last| self.apart(&last, &second, joints, 1.0, MOVING));
            match self.apart(&first, &second, joints, speed, slack).or(jump) {
                None => return Ok(self.accept(&second, moving, joints)),
                Some(difference) => apart = difference,
            }
            link.counts.rejected += 1;
            differed += 1;
            (first, moved) = (second, moves);
        }
        self.forget();
        let Apart { joint, first, second } = apart;
        let error = link.error(&Request::plain(C::GetAngles), Cause::Unconfirmed { first, second });
        Err(match joints.joints.get(joint) {
            Some(joint) => error.of_joint(joint.name.clone()),
            None => error,
        })
    }

    /// x, y, z (mm), rx, ry, rz (deg), of which two readings in a row say nearly the same.
    pub(super) fn coordinates(link: &mut Link) -> Result<[f64; 6], DriverError> {
        let request = Request::plain(C::GetCoords);
        let alike = |a: &[f64; 6], b: &[f64; 6]| {
            let mut limits = [ALIKE_LENGTH, ALIKE_LENGTH, ALIKE_LENGTH].into_iter();
            a.iter().zip(b).all(|(a, b)| match limits.next() {
                Some(limit) => (a - b).abs() <= limit,
                None => ((a - b + 180.0).rem_euclid(360.0) - 180.0).abs() <= ALIKE_ANGLE,
            })
        };
        link.agreeing(&request, Reply::coordinates, alike)?.map_err(|([first, ..], [second, ..])| {
            let (first, second) = (first / 1000.0, second / 1000.0);
            link.error(&request, Cause::Unconfirmed { first, second })
        })
    }

    /// A limit of a joint (deg).
    pub(super) fn joint_limit(link: &mut Link, request: &Request) -> Result<f64, DriverError> {
        let limit = link.agreeing(request, Reply::joint_limit, |a, b| a == b)?;
        limit.map_err(|(first, second)| {
            let (first, second) = (first.to_radians(), second.to_radians());
            link.error(request, Cause::Unconfirmed { first, second })
        })
    }

    /// One reading of the angles, within what a joint can have.
    fn reading(link: &mut Link, joints: &JointMap) -> Result<Reading, DriverError> {
        let (request, clock) = (Request::plain(C::GetAngles), link.clock());
        let mut beyond = None;
        for _ in 0..READINGS {
            let asked = clock.now();
            let angles = link.ask(&request, Reply::angles)?;
            let out = angles
                .iter()
                .zip(ANGLES)
                .position(|(angle, (min, max))| !(min - BEYOND..=max + BEYOND).contains(angle));
            let Some(joint) = out else { return Ok(Reading { asked, answered: clock.now(), angles }) };
            link.counts.rejected += 1;
            let value = angles.get(joint).copied().unwrap_or_default();
            // The same joint at the same place twice: it is there.
            if beyond == Some((joint, value)) {
                break;
            }
            beyond = Some((joint, value));
        }
        let (joint, value) = beyond.unwrap_or_default();
        let (min, max) = ANGLES.get(joint).copied().unwrap_or_default();
        let error = link.error(&request, Cause::OutsideRange { value, min, max });
        Err(match joints.joints.get(joint) {
            Some(joint) => error.of_joint(joint.name.clone()),
            None => error,
        })
    }

    /// The first joint that cannot have got from one reading to the other at this part of its full speed, give or take
    /// the slack (deg).
    fn apart(&self, a: &Reading, b: &Reading, joints: &JointMap, speed: f64, slack: f64) -> Option<Apart> {
        let seconds = b.answered.since(a.asked).as_secs_f64();
        let pairs = a.angles.iter().zip(&b.angles).zip(joints.joints.iter().zip(&self.full_speeds));
        let mut apart = pairs.enumerate().filter_map(|(joint, ((first, second), (map, full)))| {
            let travel = full * speed * seconds * map.scale.abs() + slack;
            let (first, second) = (*first, *second);
            ((first - second).abs() > travel).then(|| {
                let (first, second) = (map.from_device(first), map.from_device(second));
                Apart { joint, first, second }
            })
        });
        apart.next()
    }

    /// Takes a confirmed reading for the state.
    fn accept(&mut self, reading: &Reading, moving: bool, joints: &JointMap) -> State {
        let last = self.last.replace(*reading);
        let last = last.map(|last| (last.angles, reading.answered.since(last.answered).as_secs_f64()));
        let last = last.filter(|(_, seconds)| (1e-3..=VELOCITY_SPAN).contains(seconds));
        if !moving {
            self.speed = 0.0;
        }
        let states = joints.joints.iter().zip(reading.angles).enumerate().map(|(index, (joint, angle))| {
            let before = last.and_then(|(angles, seconds)| Some((*angles.get(index)?, seconds)));
            let velocity = before.map(|(before, seconds)| (angle - before) / joint.scale / seconds);
            JointState {
                position: joint.from_device(angle),
                velocity,
                moving: Some(moving),
                ..JointState::default()
            }
        });
        State { stamp: reading.answered, joints: states.collect(), fault: None }
    }
}

/// Two values of one joint (rad) that do not go together.
#[derive(Debug, Clone, Copy)]
struct Apart {
    joint: usize,
    first: f64,
    second: f64,
}
