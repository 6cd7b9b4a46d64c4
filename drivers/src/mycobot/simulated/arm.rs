//! The mechanics: joints, their goals, power, torque and the gripper. Angles are degrees of the device.

use std::collections::VecDeque;
use std::time::Duration;

use super::super::refusal::{ANGLES, Range, within};
use crate::driver::DeviceJoint;
use crate::simulate::Trapezoid;

/// What is assumed where the table says nothing: deg/s, and seconds to full speed.
const MAX_VELOCITY: f64 = 160.0;
const TIME_TO_SPEED: f64 = 0.25;
/// Percent a second of the gripper at full speed, and percent a second squared.
const GRIPPER_SPEED: f64 = 150.0;
const GRIPPER_ACCELERATION: f64 = 600.0;
/// A joint that has hardly any way goes at this part of the leading one's speed.
const LEAST_PART: f64 = 0.01;
/// How near to a goal counts as there (deg).
const IN_POSITION: f64 = 0.05;

/// One goal of all joints.
#[derive(Debug, Clone, Copy)]
struct Goal {
    angles: [f64; 6],
    /// Percent.
    speed: u8,
}

/// One joint.
#[derive(Debug)]
struct Axis {
    map: DeviceJoint,
    motor: Trapezoid,
    /// deg/s
    full_speed: f64,
    /// deg/s²
    full_acceleration: f64,
    limits: Range,
    torque: bool,
}

impl Axis {
    fn new(map: &DeviceJoint, range: Range) -> Self {
        let degrees = map.scale.abs();
        let full_speed = map.max_velocity.map_or(MAX_VELOCITY, |velocity| velocity * degrees);
        let full_acceleration = map.max_acceleration.map(|acceleration| acceleration * degrees);
        let full_acceleration = full_acceleration.unwrap_or(full_speed / TIME_TO_SPEED);
        let rest = map.to_device(0.0).clamp(range.0, range.1);
        let motor = Trapezoid::at(rest, full_speed, full_acceleration);
        Self { map: map.clone(), motor, full_speed, full_acceleration, limits: range, torque: true }
    }

    /// How long the way to an angle (deg) takes at full speed (s).
    fn time_to(&self, angle: f64) -> f64 {
        (angle - self.motor.position).abs() / self.full_speed
    }
}

/// The arm without its protocol.
#[derive(Debug)]
pub(super) struct Arm {
    axes: [Axis; 6],
    power: bool,
    paused: Option<Goal>,
    /// Whether a new goal replaces the one before.
    pub(super) fresh: bool,
    /// Whether it may be moved by hand.
    pub(super) free: bool,
    queue: VecDeque<Goal>,
    /// Percent, of the last goal.
    speed: u8,
    /// The latched error; 0 is none.
    error: u8,
    gripper: Trapezoid,
}

impl Arm {
    pub(super) fn new(joints: &[DeviceJoint; 6]) -> Self {
        let mut ranges = ANGLES.into_iter();
        let axes = joints.each_ref().map(|joint| Axis::new(joint, ranges.next().unwrap_or_default()));
        Self {
            axes,
            power: true,
            paused: None,
            fresh: true,
            free: false,
            queue: VecDeque::new(),
            speed: 100,
            error: 0,
            gripper: Trapezoid::at(100.0, GRIPPER_SPEED, GRIPPER_ACCELERATION),
        }
    }

    /// Goes on for a while. Queued goals begin when the one before is reached; time is cut finely enough for that.
    pub(super) fn advance(&mut self, duration: Duration) {
        self.gripper.advance(duration.as_secs_f64());
        let mut left = duration.as_secs_f64();
        while left > 0.0 {
            let step = if self.queue.is_empty() { left } else { left.min(1e-3) };
            for axis in &mut self.axes {
                axis.motor.advance(step);
            }
            left -= step;
            if !self.is_moving()
                && self.paused.is_none()
                && let Some(goal) = self.queue.pop_front()
            {
                self.pursue(goal);
            }
        }
    }

    pub(super) fn place(&mut self, q: &[f64; 6]) {
        self.queue.clear();
        for (axis, value) in self.axes.iter_mut().zip(q) {
            axis.motor.position = axis.map.to_device(*value);
            axis.motor.freeze();
        }
    }

    /// Takes a goal: checks it, and pursues or queues it. Without power, with a latched error or in free mode nothing
    /// happens, though the request is acknowledged.
    pub(super) fn go(&mut self, angles: [f64; 6], speed: u8) {
        if !self.power || self.error != 0 || self.free {
            return;
        }
        let beyond = self.axes.iter().zip(angles).position(|(axis, angle)| !within(angle, axis.limits));
        if let Some(joint) = beyond {
            self.error = joint as u8 + 1;
            return;
        }
        let goal = Goal { angles, speed: speed.clamp(1, 100) };
        if self.fresh {
            self.queue.clear();
            self.paused = None;
            self.pursue(goal);
        } else if self.queue.is_empty() && !self.is_moving() && self.paused.is_none() {
            self.pursue(goal);
        } else {
            self.queue.push_back(goal);
        }
    }

    /// All joints leave and arrive together; on the way from another goal they turn as fast as they can.
    fn pursue(&mut self, goal: Goal) {
        self.speed = goal.speed;
        let longest =
            self.axes.iter().zip(goal.angles).map(|(axis, angle)| axis.time_to(angle)).fold(0.0, f64::max);
        let moving = self.is_moving();
        for (axis, angle) in self.axes.iter_mut().zip(goal.angles).filter(|(axis, _)| axis.torque) {
            let part = if longest > 0.0 { (axis.time_to(angle) / longest).max(LEAST_PART) } else { 1.0 };
            axis.motor.goal = angle;
            axis.motor.max_velocity = axis.full_speed * part * f64::from(goal.speed) / 100.0;
            axis.motor.max_acceleration = axis.full_acceleration * if moving { 1.0 } else { part };
        }
    }

    pub(super) fn pause(&mut self) {
        if self.paused.is_none() {
            self.paused = Some(Goal { angles: self.goal_angles(), speed: self.speed });
            self.brake();
        }
    }

    pub(super) fn resume(&mut self) {
        if let Some(goal) = self.paused.take() {
            self.pursue(goal);
        }
    }

    pub(super) fn is_paused(&self) -> bool {
        self.paused.is_some()
    }

    pub(super) fn stop(&mut self) {
        self.queue.clear();
        self.paused = None;
        self.brake();
    }

    fn brake(&mut self) {
        for axis in &mut self.axes {
            axis.motor.brake();
        }
    }

    pub(super) fn latch(&mut self, code: u8) {
        self.stop();
        self.error = code;
    }

    pub(super) fn error(&self) -> u8 {
        self.error
    }

    pub(super) fn clear_error(&mut self) {
        self.error = 0;
    }

    pub(super) fn has_power(&self) -> bool {
        self.power
    }

    pub(super) fn set_power(&mut self, on: bool) {
        self.power = on;
        self.set_torque(0, on);
    }

    /// Torque of joint 1 to 6, or of all with 0. There is none without power.
    pub(super) fn set_torque(&mut self, joint: usize, on: bool) {
        if !on {
            self.queue.clear();
            self.paused = None;
        }
        for (number, axis) in (1..).zip(&mut self.axes) {
            if joint == 0 || joint == number {
                axis.torque = on && self.power;
                if !axis.torque {
                    axis.motor.freeze();
                }
            }
        }
    }

    pub(super) fn torque(&self) -> [bool; 6] {
        self.axes.each_ref().map(|axis| axis.torque)
    }

    pub(super) fn is_holding(&self) -> bool {
        self.power && self.torque().iter().all(|torque| *torque)
    }

    pub(super) fn is_moving(&self) -> bool {
        self.axes.iter().any(|axis| axis.motor.is_moving())
    }

    /// Whether all joints are at these angles (deg).
    pub(super) fn is_at(&self, angles: &[f64; 6]) -> bool {
        self.axes.iter().zip(angles).all(|(axis, angle)| (axis.motor.position - angle).abs() <= IN_POSITION)
    }

    /// deg
    pub(super) fn angles(&self) -> [f64; 6] {
        self.axes.each_ref().map(|axis| axis.motor.position)
    }

    /// deg
    pub(super) fn goal_angles(&self) -> [f64; 6] {
        self.axes.each_ref().map(|axis| axis.motor.goal)
    }

    /// deg/s
    pub(super) fn velocities(&self) -> [f64; 6] {
        self.axes.each_ref().map(|axis| axis.motor.velocity)
    }

    /// rad
    pub(super) fn positions(&self) -> [f64; 6] {
        self.axes.each_ref().map(|axis| axis.map.from_device(axis.motor.position))
    }

    /// rad
    pub(super) fn goals(&self) -> [f64; 6] {
        self.axes.each_ref().map(|axis| axis.map.from_device(axis.motor.goal))
    }

    /// Joint values (rad) of device angles (deg).
    pub(super) fn joint_values(&self, angles: &[f64; 6]) -> [f64; 6] {
        let mut q = *angles;
        for (value, axis) in q.iter_mut().zip(&self.axes) {
            *value = axis.map.from_device(*value);
        }
        q
    }

    /// Device angles (deg) of joint values (rad).
    pub(super) fn device_angles(&self, q: &[f64]) -> [f64; 6] {
        let mut angles = [0.0; 6];
        for (angle, (axis, value)) in angles.iter_mut().zip(self.axes.iter().zip(q)) {
            *angle = axis.map.to_device(*value);
        }
        angles
    }

    /// The limits of joint 1 to 6 (deg).
    pub(super) fn limits_of(&self, joint: usize) -> Option<Range> {
        joint.checked_sub(1).and_then(|index| self.axes.get(index)).map(|axis| axis.limits)
    }

    /// The same, to be written.
    pub(super) fn limits(&mut self, joint: usize) -> Option<&mut Range> {
        joint.checked_sub(1).and_then(|index| self.axes.get_mut(index)).map(|axis| &mut axis.limits)
    }

    /// Percent, at a percentage of full speed.
    pub(super) fn set_gripper(&mut self, value: f64, speed: u8) {
        self.gripper.goal = value;
        self.gripper.max_velocity = GRIPPER_SPEED * f64::from(speed.clamp(1, 100)) / 100.0;
    }

    pub(super) fn release_gripper(&mut self) {
        self.gripper.freeze();
    }

    pub(super) fn gripper_value(&self) -> u8 {
        self.gripper.position.round().clamp(0.0, 100.0) as u8
    }

    pub(super) fn is_gripper_moving(&self) -> bool {
        self.gripper.is_moving()
    }
}
