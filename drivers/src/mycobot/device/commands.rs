//! What the arm has besides joints that go somewhere: power, errors, LED, gripper, limits, versions.

use dh_runtime::{Frame as Pose, Limits};

use super::MyCobot;
use crate::driver::{Cause, DriverError};
use crate::mycobot::Model;
use crate::mycobot::command::Command as C;
use crate::mycobot::readings::Readings;
use crate::mycobot::reply::{ArmError, Reply};
use crate::mycobot::request::{GripperState, Request};

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

impl MyCobot {
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

    /// Whether a new goal replaces the one before (true, what [`Driver::torque`](crate::Driver::torque) sets) or waits until that is reached.
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
}
