//! The driver.

use std::sync::Arc;
use std::time::Duration;

use dh_runtime::{Frame as Pose, Limits};

use super::command::Command as C;
use super::link::{LineCounts, Link};
use super::readings::Readings;
use super::refusal::{ANGLES, Refusal};
use super::reply::{ArmError, Reply};
use super::request::{GripperState, Request};
use super::{Model, six};
use crate::clock::Clock;
use crate::driver::{Cause, Driver, DriverError, Fault, JointMap, MapError, Pace, State, Watchdog};
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
/// What a joint does at a speed of 100 %, where the table does not say (rad/s): the maker's 160 degrees a second.
const FULL_SPEED: f64 = 160.0 * std::f64::consts::PI / 180.0;

/// The firmware's versions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Versions {
    /// Of the firmware.
    pub system: f64,
    /// Of its modification.
    pub modification: u8,
    /// Of an M5's base; a Pi has none.
    pub base: Option<f64>,
}

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
        })
    }

    /// What happened on the line so far.
    pub fn line(&self) -> LineCounts {
        self.link.counts
    }

    /// Whether the servos have power.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn is_powered(&mut self) -> Result<bool, DriverError> {
        self.call(|arm| arm.confirm(C::IsPowerOn))
    }

    /// Cuts the power of the servos: the arm falls, and does not say where it is until it has power again.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn power_off(&mut self) -> Result<(), DriverError> {
        self.torque = Some(false);
        self.call(|arm| arm.link.acknowledge(&Request::plain(C::PowerOff)))
    }

    /// What the arm has latched, with the index of the joint where it is a joint's.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn error_information(&mut self) -> Result<Option<ArmError>, DriverError> {
        self.call(|arm| {
            arm.link.confirm(&Request::plain(C::GetErrorInformation), Reply::byte).map(ArmError::of_code)
        })
    }

    /// Forgets what is latched, so that it moves again.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn clear_error(&mut self) -> Result<(), DriverError> {
        self.call(|arm| arm.link.acknowledge(&Request::plain(C::ClearErrorInformation)))
    }

    /// Whether a new goal replaces the one before (true, what [`Driver::torque`] sets) or waits until that is reached.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn set_fresh_mode(&mut self, fresh: bool) -> Result<(), DriverError> {
        self.call(|arm| arm.link.acknowledge(&Request::switch(C::SetFreshMode, fresh)))
    }

    /// The same, read.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn fresh_mode(&mut self) -> Result<bool, DriverError> {
        self.call(|arm| arm.confirm(C::GetFreshMode))
    }

    /// Halts on the way; the goal is kept for [`resume`](Self::resume).
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn pause(&mut self) -> Result<(), DriverError> {
        self.call(|arm| arm.link.acknowledge(&Request::plain(C::Pause)))
    }

    /// Goes on to the goal that it was halted on the way to.
    ///
    /// # Errors
    /// [`DriverError`]; [`Cause::Interrupted`] where it was away meanwhile.
    pub fn resume(&mut self) -> Result<(), DriverError> {
        self.call(|arm| {
            let request = Request::plain(C::Resume);
            if arm.interrupted {
                return Err(arm.link.error(&request, Cause::Interrupted));
            }
            arm.moving = true;
            arm.link.acknowledge(&request)
        })
    }

    /// Whether it is halted.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn is_paused(&mut self) -> Result<bool, DriverError> {
        self.call(|arm| arm.confirm(C::IsPaused))
    }

    /// Whether it moves.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn is_moving(&mut self) -> Result<bool, DriverError> {
        self.call(|arm| arm.confirm(C::IsMoving))
    }

    /// Whether the arm itself says that it is at these joint values (rad).
    ///
    /// # Errors
    /// [`DriverError`]; values that it does not take are refused before anything is sent.
    pub fn is_in_position(&mut self, q: &[f64; 6]) -> Result<bool, DriverError> {
        let request = self.checked(C::IsInPosition, Request::at_angles(&self.device_angles(q)))?;
        self.call(|arm| arm.link.confirm(&request, |reply| reply.flag().map(u8::from)).map(|byte| byte == 1))
    }

    /// The flange as the arm's own firmware computes it, in the frame that it calls its base (m).
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn coordinates(&mut self) -> Result<Pose, DriverError> {
        let [x, y, z, rx, ry, rz] = self.call(|arm| Readings::coordinates(&mut arm.link))?;
        Ok(Pose::from_rpy([x, y, z].map(|mm| mm / 1000.0), [rx, ry, rz].map(f64::to_radians)))
    }

    /// The limits that the device has for a joint, by its index (rad).
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn joint_limits(&mut self, index: usize) -> Result<Limits, DriverError> {
        let joint = index.saturating_add(1);
        let min = self.checked(C::GetJointMin, Request::of_joint(C::GetJointMin, joint))?;
        let max = self.checked(C::GetJointMax, Request::of_joint(C::GetJointMax, joint))?;
        let (min, max) = self.call(|arm| {
            Ok((Readings::joint_limit(&mut arm.link, &min)?, Readings::joint_limit(&mut arm.link, &max)?))
        })?;
        let of = |angle| self.joints.joints.get(index).map_or(f64::NAN, |joint| joint.from_device(angle));
        Ok(Limits { min: of(min).min(of(max)), max: of(min).max(of(max)) })
    }

    /// The LED's red, green and blue.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn set_color(&mut self, [red, green, blue]: [u8; 3]) -> Result<(), DriverError> {
        self.call(|arm| arm.link.acknowledge(&Request::set_color(red, green, blue)))
    }

    /// Opens, closes or releases the gripper, at a speed in percent.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn set_gripper(&mut self, state: GripperState, speed: u8) -> Result<(), DriverError> {
        let request = self.checked(C::SetGripperState, Request::gripper_state(state, speed, None))?;
        self.call(|arm| arm.link.acknowledge(&request))
    }

    /// The gripper to an opening, at a speed, both in percent.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn set_gripper_opening(&mut self, opening: u8, speed: u8) -> Result<(), DriverError> {
        let request = self.checked(C::SetGripperValue, Request::gripper_value(opening, speed, None))?;
        self.call(|arm| arm.link.acknowledge(&request))
    }

    /// How far the gripper is open, in percent.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn gripper_opening(&mut self) -> Result<u8, DriverError> {
        self.call(|arm| arm.link.confirm(&Request::get_gripper_value(None), Reply::byte))
    }

    /// Whether the gripper moves.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn is_gripper_moving(&mut self) -> Result<bool, DriverError> {
        self.call(|arm| arm.confirm(C::IsGripperMoving))
    }

    /// The firmware's versions.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn versions(&mut self) -> Result<Versions, DriverError> {
        self.call(|arm| {
            let version = |byte: u8| f64::from(byte) / 10.0;
            let system = arm.link.confirm(&Request::plain(C::GetSystemVersion), Reply::byte).map(version)?;
            let modification = arm.link.confirm(&Request::plain(C::GetModifyVersion), Reply::byte)?;
            let base = match arm.model {
                Model::Pi => None,
                Model::M5 => {
                    Some(arm.link.confirm(&Request::plain(C::GetBasicVersion), Reply::byte).map(version)?)
                }
            };
            Ok(Versions { system, modification, base })
        })
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
        self.link.begin(time);
        let result = act(self);
        if result.is_err() && self.moving && !self.link.is_gone() {
            // What went wrong is told; whether this went right shows when something is asked next.
            let _ = self.halt();
        }
        result
    }

    /// Opens the port anew. The arm may have gone on meanwhile: it is stopped, and moves when torque is switched on.
    fn come_back(&mut self) -> Result<(), DriverError> {
        self.link.reopen("open")?;
        self.interrupted = true;
        self.readings.forget();
        self.halt()
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
            let mut state = arm.readings.state(&mut arm.link, &arm.joints, holding)?;
            arm.moving &= state.joints.iter().any(|joint| joint.moving == Some(true));
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

    fn watchdog(&mut self, _timeout: Option<Duration>) -> Result<Watchdog, DriverError> {
        Ok(Watchdog::None)
    }
}
