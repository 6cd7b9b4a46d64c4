//! From checked joint values to goals.

use super::Arm;
use crate::driver::{Cause, DriverError};
use crate::dynamixel::control_table::{GOAL_POSITION, PROFILE_ACCELERATION, PROFILE_VELOCITY};
use crate::motion::Command;

/// What errors call it.
pub(super) const NAME: &str = "goal position";

impl Arm {
    /// The goals (ticks) of a command, one a joint.
    pub(super) fn goals(&self, command: &Command) -> Result<Vec<i64>, DriverError> {
        let (expected, got) = (self.map.fingerprint, command.fingerprint());
        if expected != got {
            return Err(self.error(NAME, None, Cause::OtherRobot { expected, got }));
        }
        let (expected, got) = (self.servos.len(), command.positions().len());
        if expected != got {
            return Err(self.error(NAME, None, Cause::Length { expected, got }));
        }
        let joints = self.map.joints.iter().zip(&self.servos).zip(command.positions()).enumerate();
        let goal = |(place, ((joint, servo), q)): (usize, ((&_, &super::Servo), &f64))| {
            let joint: &crate::driver::DeviceJoint = joint;
            let value = joint.to_device(*q).round();
            let (min, max) = (servo.goals.0 as f64, servo.goals.1 as f64);
            if (min..=max).contains(&value) {
                return Ok(value as i64);
            }
            Err(self.error(NAME, Some(place), Cause::OutsideRange { value, min, max }))
        };
        joints.map(goal).collect()
    }

    /// Writes goals to all servos at once.
    pub(super) fn follow(&mut self, goals: &[i64]) -> Result<(), DriverError> {
        if self.braking {
            let profile = |servo: &super::Servo| {
                [PROFILE_ACCELERATION.bytes(0), PROFILE_VELOCITY.bytes(servo.velocity)].concat()
            };
            let data: Vec<Vec<u8>> = self.servos.iter().map(profile).collect();
            self.write_all(NAME, PROFILE_ACCELERATION.address, &data)?;
            self.braking = false;
        }
        let goals = self.servos.iter().zip(goals).map(|(servo, goal)| (servo.id, GOAL_POSITION.bytes(*goal)));
        let goals: Vec<(u8, Vec<u8>)> = goals.collect();
        self.bus.sync_write(GOAL_POSITION.address, &goals).map_err(|error| self.named(error))
    }
}
