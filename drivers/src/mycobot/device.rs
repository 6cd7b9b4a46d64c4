//! The driver.

mod commands;

pub use commands::Versions;

use std::sync::Arc;
use std::time::Duration;

use dh_runtime::Limits;

use super::command::Command as C;
use super::link::{LineCounts, Link};
use super::readings::Readings;
use super::refusal::{ANGLES, Refusal};
use super::reply::{ArmError, Reply};
use super::request::Request;
use super::{Model, six};
use crate::clock::{Clock, Time};
use crate::driver::{
    Attachment, AttachmentUnit, Cause, Driver, DriverError, Fault, JointMap, MapError, Pace, State, Watchdog,
};
use crate::motion::Command;
use crate::port::Port;

/// No call takes longer, but [`Driver::torque`], which waits for the servos to start ([`STARTING`]).
const CALL: Duration = Duration::from_secs(3);
/// How long servos take to start after they got power.
const STARTING: Duration = Duration::from_secs(10);
/// How long a stop is insisted on.
const STOPPING: Duration = Duration::from_secs(2);
/// How long to wait between two looks at servos that start.
const STARTING_LOOK: Duration = Duration::from_millis(200);
/// Opening the port of an M5 may start it anew. Its maker's client waits a second and a half for it; here it is asked
/// until it answers, for so long at most.
const OPENING: Duration = Duration::from_secs(4);
/// How often temperatures are asked for, of an arm at rest: they are not what a move should wait for.
const TEMPERATURES: Duration = Duration::from_secs(2);
/// What its gripper is called, and its speed in percent where none is given.
const GRIPPER: &str = "gripper";
const GRIPPER_SPEED: u8 = 50;
/// What a joint does at a speed of 100 %, where the table does not say (rad/s): the maker's 160 degrees a second.
const FULL_SPEED: f64 = 160.0 * std::f64::consts::PI / 180.0;

/// A myCobot 280: a [`Driver`] that is told goals and goes there by itself.
///
/// The protocol has no checksum and no sequence number. What is done about it: one request is in flight, and the line
/// is quiet before the next; values outside the limits, or that the joint could not have reached since the last ones,
/// are rejected; what something depends on is read until two readings agree; moves by an amount are never sent again
/// (and none is sent at all: goals are absolute). Still, a request that is corrupted into another valid one is carried
/// out as it arrives. Therefore arrival is judged by readings against the goal, never by an acknowledgement.
///
/// The arm has one speed for all joints, in percent. What that is of, and how joints share it, its maker does not say;
/// taken for granted is that the joint with the longest way (in time) goes at this part of the table's greatest speed,
/// and that the others arrive with it. A command's velocities are reached by that joint, rounded down to a percent.
///
/// Nothing stops the arm when the program dies: there is no watchdog, and it goes on to its last goal.
#[derive(Debug)]
pub struct MyCobot {
    pub(super) link: Link,
    joints: JointMap,
    model: Model,
    readings: Readings,
    /// It may be on its way: a goal was sent, and no reading since has found it at rest.
    moving: bool,
    /// It was away: torque must be switched on anew.
    interrupted: bool,
    torque: Option<bool>,
    /// It has answered since the port was opened.
    met: bool,
    temperatures: Temperatures,
}

/// Temperatures of the servos (°C).
#[derive(Debug, Clone, Copy)]
enum Temperatures {
    Unasked,
    /// When they were asked for, and what they were.
    Told(Time, [u8; 6]),
    /// This firmware does not tell them.
    Untold,
}

impl MyCobot {
    /// The arm on this port. Nothing is sent yet.
    ///
    /// The joints' servos take angles in degrees of the device; where the map says nothing else, the range of each is
    /// what the maker's client takes.
    ///
    /// # Errors
    /// Where there are other than six joints.
    pub fn new(port: Box<dyn Port>, mut joints: JointMap, model: Model) -> Result<Self, MapError> {
        six(&joints)?;
        for (joint, (min, max)) in joints.joints.iter_mut().zip(ANGLES) {
            let taken = Limits { min, max };
            joint.range = Some(match joint.range {
                Some(range) => range.intersection(&taken).unwrap_or(taken),
                None => taken,
            });
        }
        let full_speeds = joints
            .joints
            .iter()
            .map(|joint| joint.max_velocity.filter(|velocity| *velocity > 0.0).unwrap_or(FULL_SPEED));
        let readings = Readings::new(full_speeds.collect());
        Ok(Self {
            link: Link::new(port),
            joints,
            model,
            readings,
            moving: false,
            interrupted: false,
            torque: None,
            met: false,
            temperatures: Temperatures::Unasked,
        })
    }

    /// What happened on the line so far.
    pub fn line(&self) -> LineCounts {
        self.link.counts
    }

    /// Does something within the time of one call. Comes back first if the device was away; stops the arm if it may be
    /// moving and this fails.
    fn call<T>(&mut self, act: impl FnOnce(&mut Self) -> Result<T, DriverError>) -> Result<T, DriverError> {
        self.call_within(CALL, act)
    }

    fn call_within<T>(
        &mut self,
        time: Duration,
        act: impl FnOnce(&mut Self) -> Result<T, DriverError>,
    ) -> Result<T, DriverError> {
        if self.link.is_gone() {
            self.come_back()?;
        }
        self.meet();
        self.link.begin(time);
        let result = act(self);
        if result.is_err() && self.moving && !self.link.is_gone() {
            // What went wrong is told; whether this went right shows when something is asked next.
            let _ = self.halt();
        }
        result
    }

    /// Waits for an M5 that starts. Where it does not answer at all, whatever is asked next says so.
    fn meet(&mut self) {
        if self.met || self.model != Model::M5 {
            return;
        }
        self.link.begin(OPENING);
        let clock = self.link.clock();
        let deadline = clock.now() + OPENING;
        while !self.link.is_gone() && clock.now() < deadline {
            if self.link.ask(&Request::plain(C::IsPowerOn), Reply::flag).is_ok() {
                self.met = true;
                return;
            }
        }
    }

    /// Opens the port anew. The arm may have gone on meanwhile: it is stopped, and moves when torque is switched on.
    fn come_back(&mut self) -> Result<(), DriverError> {
        self.link.reopen("open")?;
        (self.interrupted, self.met) = (true, false);
        self.readings.forget();
        self.halt().or_else(|_| {
            self.meet();
            self.halt()
        })
    }

    fn halt(&mut self) -> Result<(), DriverError> {
        self.link.begin(STOPPING);
        self.link.insist(&Request::plain(C::Stop))?;
        self.moving = false;
        Ok(())
    }

    fn confirm(&mut self, command: C) -> Result<bool, DriverError> {
        let byte = self.link.confirm(&Request::plain(command), |reply| reply.flag().map(u8::from))?;
        Ok(byte == 1)
    }

    fn device_angles(&self, q: &[f64]) -> [f64; 6] {
        let mut angles = [f64::NAN; 6];
        for (angle, (joint, value)) in angles.iter_mut().zip(self.joints.joints.iter().zip(q)) {
            *angle = joint.to_device(*value);
        }
        angles
    }

    /// A refusal as an error of the joint that it is about.
    fn checked(&self, command: C, request: Result<Request, Refusal>) -> Result<Request, DriverError> {
        request.map_err(|refusal| {
            let (joint, value, (min, max)) = match refusal {
                Refusal::Joint { joint } => (None, joint as f64, (1.0, 6.0)),
                Refusal::Angle { joint, value, range } => (Some(joint), value, range),
                Refusal::Coordinate { value, range, .. } => (None, value, range),
                Refusal::Increment { joint, value } => (Some(joint), value, (-327.67, 327.67)),
                Refusal::Speed { value, min } => (None, f64::from(value), (f64::from(min), 100.0)),
                Refusal::Gripper { value } => (None, f64::from(value), (0.0, 100.0)),
            };
            let error =
                DriverError::new(self.link.name(), command.name(), Cause::OutsideRange { value, min, max });
            let name =
                joint.and_then(|joint| self.joints.joints.get(joint - 1)).map(|joint| joint.name.clone());
            DriverError { joint: name, ..error }
        })
    }

    /// The request for a goal, checked: the right arm, six values that it takes, a speed that it has.
    fn goal(&self, command: &Command) -> Result<Request, DriverError> {
        let error = |cause| DriverError::new(self.link.name(), C::SendAngles.name(), cause);
        if command.fingerprint() != self.joints.fingerprint {
            let (expected, got) = (self.joints.fingerprint, command.fingerprint());
            return Err(error(Cause::OtherRobot { expected, got }));
        }
        if command.positions().len() != 6 || command.velocities().len() != 6 {
            let got = command.positions().len();
            return Err(error(Cause::Length { expected: 6, got }));
        }
        let angles = self.device_angles(command.positions());
        for (joint, angle) in self.joints.joints.iter().zip(angles) {
            let Some(Limits { min, max }) = joint.range else { continue };
            // What converting radians to degrees leaves is no transgression.
            if !(min - 1e-9..=max + 1e-9).contains(&angle) {
                let cause = Cause::OutsideRange { value: angle, min, max };
                return Err(error(cause).of_joint(joint.name.clone()));
            }
        }
        // Where nothing is to move, any speed will do.
        let still = command.velocities().iter().all(|velocity| *velocity == 0.0);
        let percent = if still { 1.0 } else { self.readings.percent(command.velocities()) };
        if !(1.0..=f64::INFINITY).contains(&percent) {
            return Err(error(Cause::OutsideRange { value: percent, min: 1.0, max: 100.0 }));
        }
        self.checked(C::SendAngles, Request::send_angles(&angles, percent.min(100.0) as u8))
    }

    /// An arm without power knows no angles; that it is silent about them says less than why. One that moves has power,
    /// and has to be stopped first.
    fn without_power(&mut self, error: DriverError) -> DriverError {
        let silent = matches!(error.cause, Cause::Silent { .. }) && error.command == C::GetAngles.name();
        if silent && !self.moving && self.confirm(C::IsPowerOn).is_ok_and(|power| !power) {
            return DriverError { cause: Cause::PowerOff, ..error };
        }
        error
    }

    fn read_temperatures(&mut self, state: &mut State) {
        let due = match self.temperatures {
            Temperatures::Unasked => true,
            Temperatures::Told(then, _) => state.stamp.since(then) >= TEMPERATURES,
            Temperatures::Untold => false,
        };
        if due {
            let told = self.link.ask(&Request::plain(C::GetServoTemps), Reply::bytes::<6>);
            self.temperatures = match (told, self.temperatures) {
                (Ok(degrees), _) => Temperatures::Told(state.stamp, degrees),
                // What it told once it can tell: the line was bad.
                (Err(_), told @ Temperatures::Told(..)) => told,
                (Err(_), _) => Temperatures::Untold,
            };
        }
        if let Temperatures::Told(_, degrees) = self.temperatures {
            for (joint, degrees) in state.joints.iter_mut().zip(degrees) {
                joint.temperature = Some(f64::from(degrees));
            }
        }
    }

    /// The latched fault, if there is one.
    fn fault(&mut self) -> Result<Option<ArmError>, DriverError> {
        let request = Request::plain(C::GetErrorInformation);
        match self.link.ask(&request, Reply::byte)? {
            0 => Ok(None),
            _ => self.link.confirm(&request, Reply::byte).map(ArmError::of_code),
        }
    }

    /// Fails where a fault is latched.
    fn without_fault(&mut self) -> Result<(), DriverError> {
        let Some(fault) = self.fault()? else { return Ok(()) };
        let cause = Cause::Fault(Fault { code: fault.code(), meaning: fault.meaning() });
        let error = DriverError::new(self.link.name(), C::SendAngles.name(), cause);
        let joint = fault.joint().and_then(|index| self.joints.joints.get(index));
        Err(DriverError { joint: joint.map(|joint| joint.name.clone()), ..error })
    }

    fn torque_on(&mut self) -> Result<(), DriverError> {
        self.link.acknowledge(&Request::plain(C::PowerOn))?;
        let clock = self.link.clock();
        // Servos that start say nothing for a while.
        let patience = clock.now() + STARTING / 2;
        while let Err(error) = self.link.ask(&Request::plain(C::GetAngles), Reply::angles) {
            if self.link.is_gone() || clock.now() >= patience {
                return Err(error);
            }
            clock.sleep_until(clock.now() + STARTING_LOOK);
        }
        // Where it is, it stays: goals from before are forgotten.
        self.link.acknowledge(&Request::plain(C::Stop))?;
        self.moving = false;
        self.link.acknowledge(&Request::switch(C::SetFreshMode, true))?;
        self.switch_torque(&Request::focus_all(), true)?;
        self.interrupted = false;
        Ok(())
    }

    /// Switches torque and asks whether it is switched.
    fn switch_torque(&mut self, request: &Request, on: bool) -> Result<(), DriverError> {
        self.link.acknowledge(request)?;
        let asked = self.link.confirm(&Request::plain(C::IsAllServoEnable), |reply| {
            Ok(u8::from(reply.payload().iter().all(|enabled| *enabled == 1)))
        })?;
        if (asked == 1) != on {
            let meaning = "the servos' torque is not what it was switched to";
            return Err(self.link.error(request, Cause::Refused { code: asked, meaning }));
        }
        self.torque = Some(on);
        Ok(())
    }
}

impl Driver for MyCobot {
    fn name(&self) -> &str {
        self.link.name()
    }

    fn clock(&self) -> Arc<dyn Clock> {
        self.link.clock()
    }

    fn joints(&self) -> &JointMap {
        &self.joints
    }

    fn pace(&self) -> Pace {
        Pace::PointToPoint
    }

    fn read_state(&mut self) -> Result<State, DriverError> {
        self.call(|arm| {
            let holding = arm.torque != Some(false);
            let state = arm.readings.state(&mut arm.link, &arm.joints, holding);
            let mut state = state.map_err(|error| arm.without_power(error))?;
            let moving = state.joints.iter().any(|joint| joint.moving == Some(true));
            arm.moving &= moving;
            if !moving {
                arm.read_temperatures(&mut state);
            }
            if let Some(fault) = arm.fault()? {
                let latched = Some(Fault { code: fault.code(), meaning: fault.meaning() });
                match fault.joint().and_then(|index| state.joints.get_mut(index)) {
                    Some(joint) => joint.fault = latched,
                    None => state.fault = latched,
                }
            }
            Ok(state)
        })
    }

    fn torque(&mut self, on: bool) -> Result<(), DriverError> {
        self.call_within(STARTING, |arm| {
            if on {
                arm.torque_on()
            } else {
                arm.moving = false;
                arm.switch_torque(&Request::release_all(false), false)
            }
        })
    }

    fn send(&mut self, command: &Command) -> Result<(), DriverError> {
        let request = self.goal(command)?;
        self.call(|arm| {
            if arm.interrupted {
                return Err(arm.link.error(&request, Cause::Interrupted));
            }
            arm.without_fault()?;
            if arm.torque == Some(false) || !arm.confirm(C::IsPowerOn)? {
                return Err(arm.link.error(&request, Cause::TorqueOff));
            }
            arm.moving = true;
            arm.readings.expect(command.velocities());
            arm.link.acknowledge(&request)?;
            // A goal that it does not take is acknowledged like any other, and latched as a fault.
            arm.without_fault()
        })
    }

    fn stop(&mut self) -> Result<(), DriverError> {
        if self.link.is_gone() { self.come_back() } else { self.halt() }
    }

    fn clear_faults(&mut self) -> Result<(), DriverError> {
        self.call(|arm| arm.link.acknowledge(&Request::plain(C::ClearErrorInformation)))
    }

    fn attachments(&self) -> Vec<Attachment> {
        let range = Limits { min: 0.0, max: 100.0 };
        vec![Attachment { name: GRIPPER.to_owned(), unit: AttachmentUnit::Percent, range }]
    }

    fn move_attachment(&mut self, name: &str, value: f64) -> Result<(), DriverError> {
        let error =
            |cause| DriverError::new(self.link.name(), C::SetGripperValue.name(), cause).of_joint(name);
        if name != GRIPPER {
            return Err(error(Cause::Unsupported));
        }
        if !(0.0..=100.0).contains(&value) {
            return Err(error(Cause::OutsideRange { value, min: 0.0, max: 100.0 }));
        }
        self.set_gripper_opening(value.round() as u8, GRIPPER_SPEED)
    }

    fn read_attachment(&mut self, name: &str) -> Result<f64, DriverError> {
        if name != GRIPPER {
            let error = DriverError::new(self.link.name(), C::GetGripperValue.name(), Cause::Unsupported);
            return Err(error.of_joint(name));
        }
        self.gripper_opening().map(f64::from)
    }

    fn watchdog(&mut self, _timeout: Option<Duration>) -> Result<Watchdog, DriverError> {
        Ok(Watchdog::None)
    }
}
