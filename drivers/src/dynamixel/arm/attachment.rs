//! Servos that are no joints: a gripper's, mostly.

use super::{Arm, Servo, setup};
use crate::driver::{Attachment, AttachmentUnit, Cause, DeviceJoint, Driver, DriverError};
use crate::dynamixel::bus::{Answer, Bus};
use crate::dynamixel::control_table::{
    GOAL_POSITION, HARDWARE_ERROR, PRESENT_POSITION, PROFILE_ACCELERATION, PROFILE_VELOCITY, TORQUE,
};
use crate::dynamixel::status::hardware_fault;
use dh_runtime::Limits;

/// How fast one moves where its table does not say (rad/s or m/s).
const CALM: f64 = 1.0;

/// One of them, as it was found.
#[derive(Debug)]
pub(super) struct Attached {
    joint: DeviceJoint,
    servo: Servo,
}

impl Arm {
    /// With servos besides those of the joints, which are moved one by one and checked against their own range only. One
    /// that does not answer is not there: grippers come off.
    ///
    /// # Errors
    /// [`DriverError`]: an id that is taken or none, another model than the table says, another mode than a position's.
    pub fn with_attachments(mut self, attachments: Vec<DeviceJoint>) -> Result<Self, DriverError> {
        let port = self.name().to_owned();
        let all = attachments.clone();
        for (index, mut joint) in attachments.into_iter().enumerate() {
            let name = joint.name.clone();
            let refused =
                |cause| Err(DriverError::new(port.as_str(), setup::NAME, cause).of_joint(name.as_str()));
            let others = self.map.joints.iter().chain(all.iter().take(index));
            let id = match setup::own_id(&joint, others) {
                Ok(id) => id,
                Err(cause) => return refused(cause),
            };
            joint.max_velocity = joint.max_velocity.or(Some(CALM));
            match setup::find(&mut self.bus, &joint, id, self.settings) {
                Ok(Ok((servo, _))) => self.attached.push(Attached { joint, servo }),
                Ok(Err(cause)) => return refused(cause),
                Err(error) if matches!(error.cause, Cause::Silent { .. }) => {}
                Err(error) => return Err(error.of_joint(name)),
            }
        }
        Ok(self)
    }

    pub(super) fn attachments(&self) -> Vec<Attachment> {
        let attachment = |Attached { joint, servo }: &Attached| {
            let (a, b) = (joint.from_device(servo.goals.0 as f64), joint.from_device(servo.goals.1 as f64));
            let range = Limits { min: a.min(b), max: a.max(b) };
            Attachment { name: joint.name.clone(), unit: AttachmentUnit::Angle, range }
        };
        self.attached.iter().map(attachment).collect()
    }

    fn attached(&self, command: &'static str, name: &str) -> Result<(DeviceJoint, Servo), DriverError> {
        let found = self.attached.iter().find(|attached| attached.joint.name == name);
        let found = found.map(|attached| (attached.joint.clone(), attached.servo));
        found.ok_or_else(|| self.error(command, None, Cause::Unsupported).of_joint(name))
    }

    pub(super) fn move_attached(&mut self, name: &str, value: f64) -> Result<(), DriverError> {
        let command = "move attachment";
        let (joint, servo) = self.attached(command, name)?;
        let goal = joint.to_device(value).round();
        let (min, max) = (servo.goals.0 as f64, servo.goals.1 as f64);
        if !(min..=max).contains(&goal) {
            return Err(self
                .error(command, None, Cause::OutsideRange { value: goal, min, max })
                .of_joint(name));
        }
        let outcome = self.drive_attached(command, servo, goal as i64);
        outcome.map_err(|error| self.named(error).of_joint(name))
    }

    fn drive_attached(&mut self, command: &'static str, servo: Servo, goal: i64) -> Result<(), DriverError> {
        let id = servo.id;
        let latched = self.bus.read(id, HARDWARE_ERROR.address, HARDWARE_ERROR.size)?;
        if let Some(fault) = HARDWARE_ERROR.value(&latched.data).and_then(|bits| hardware_fault(bits as u8)) {
            return Err(self.error(command, None, Cause::Fault(fault)));
        }
        let driven = self.bus.read(id, TORQUE.address, TORQUE.size)?;
        if TORQUE.value(&driven.data) == Some(0) {
            // Where it is, before torque makes it go to some goal of the past.
            let here = self.bus.read(id, PRESENT_POSITION.address, PRESENT_POSITION.size)?;
            let here = PRESENT_POSITION.value(&here.data).unwrap_or(goal).clamp(servo.goals.0, servo.goals.1);
            self.bus.write(id, GOAL_POSITION.address, &GOAL_POSITION.bytes(here))?;
            self.bus.write(id, TORQUE.address, &TORQUE.bytes(1))?;
        }
        let profile = [
            PROFILE_ACCELERATION.bytes(servo.braking),
            PROFILE_VELOCITY.bytes(servo.velocity),
            GOAL_POSITION.bytes(goal),
        ];
        self.bus.write(id, PROFILE_ACCELERATION.address, &profile.concat()).map(|_| ())
    }

    pub(super) fn read_attached(&mut self, name: &str) -> Result<f64, DriverError> {
        let command = "read attachment";
        let (joint, servo) = self.attached(command, name)?;
        let answer = self.bus.read(servo.id, PRESENT_POSITION.address, PRESENT_POSITION.size);
        let answer = answer.map_err(|error| self.named(error).of_joint(name))?;
        let ticks = PRESENT_POSITION.value(&answer.data);
        let ticks = ticks.ok_or_else(|| self.error(command, None, Cause::Garbled).of_joint(name))?;
        Ok(joint.from_device(ticks as f64))
    }

    /// Switches the torque of all of them off; on it comes with the next move.
    pub(super) fn release_attached(&mut self) -> Result<(), DriverError> {
        self.each_attached(|bus, id| there(bus.write(id, TORQUE.address, &TORQUE.bytes(0))).map(|_| ()))
    }

    /// Starts those anew that have latched a hardware error.
    pub(super) fn clear_attached(&mut self) -> Result<(), DriverError> {
        self.each_attached(|bus, id| {
            let latched = there(bus.read(id, HARDWARE_ERROR.address, HARDWARE_ERROR.size))?;
            if latched.is_some_and(|latched| HARDWARE_ERROR.value(&latched.data) != Some(0)) {
                bus.reboot(id)?;
                bus.await_servo(id)?;
            }
            Ok(())
        })
    }

    fn each_attached(
        &mut self,
        act: impl Fn(&mut Bus, u8) -> Result<(), DriverError>,
    ) -> Result<(), DriverError> {
        let all: Vec<_> = self.attached.iter().map(|one| (one.servo.id, one.joint.name.clone())).collect();
        for (id, name) in all {
            act(&mut self.bus, id).map_err(|error| self.named(error).of_joint(name))?;
        }
        Ok(())
    }
}

/// The answer of one that is still there: what is silent was taken off since it was found.
fn there(outcome: Result<Answer, DriverError>) -> Result<Option<Answer>, DriverError> {
    match outcome {
        Err(error) if matches!(error.cause, Cause::Silent { .. }) => Ok(None),
        outcome => outcome.map(Some),
    }
}
