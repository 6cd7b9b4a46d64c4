//! A myCobot that is not there, as far as the real one is known.
//!
//! It answers after 8 to 15 ms, moves at finite speed and acceleration, refuses goals outside its limits and latches
//! the joint as an error, acknowledges moves but does not make them while an error is latched or the power is off, is
//! silent about angles then, queues goals or replaces them (fresh mode), and computes coordinates from the kinematics
//! of the table it is made of.
//!
//! Where the real arm was not measured it does the simplest thing: the speed byte is a percentage of the greatest speed
//! of the joint that has the longest way, the others leave and arrive with it, each by a trapezoid, and a move to
//! coordinates goes there in joint space.

mod answer;
mod arm;

use std::collections::VecDeque;
use std::fmt;
use std::time::Duration;

use dh_runtime::Kinematics;

use super::{Frame, FrameReader, Model};
use crate::clock::Time;
use crate::driver::{JointMap, MapError};
use crate::simulate::SimulatedDevice;

use arm::Arm;

/// After a gap of this length within a frame, the rest of it does not come any more.
const GAP: Duration = Duration::from_millis(100);
/// The soonest reply; the latest comes [`REPLY_SPREAD`] later.
const REPLY: Duration = Duration::from_millis(8);
const REPLY_SPREAD: Duration = Duration::from_millis(7);
/// What a USB converter adds on an M5.
const USB_LATENCY: Duration = Duration::from_millis(2);

/// A simulated myCobot 280: a [`SimulatedDevice`].
pub struct SimulatedMyCobot<'k> {
    model: Model,
    kinematics: Box<dyn Kinematics + Send + 'k>,
    time_scale: f64,
    arm: Arm,
    reader: FrameReader,
    now: Time,
    last_byte: Time,
    replies: VecDeque<(Time, Vec<u8>)>,
    requests: u64,
    color: [u8; 3],
}

impl fmt::Debug for SimulatedMyCobot<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut lines = f.debug_struct("SimulatedMyCobot");
        lines.field("robot", &self.kinematics.name()).field("model", &self.model).field("arm", &self.arm);
        lines.finish_non_exhaustive()
    }
}

impl<'k> SimulatedMyCobot<'k> {
    /// An arm of this table, powered and at rest where all joints are zero, or as near as their servos get.
    ///
    /// # Errors
    /// Where the table has other than six joints, or one that no servo moves.
    pub fn new(kinematics: Box<dyn Kinematics + Send + 'k>, model: Model) -> Result<Self, MapError> {
        let map = JointMap::of_table(&*kinematics)?;
        let joints = super::six(&map)?;
        Ok(Self {
            model,
            kinematics,
            time_scale: 1.0,
            arm: Arm::new(joints),
            reader: FrameReader::default(),
            now: Time::START,
            last_byte: Time::START,
            replies: VecDeque::new(),
            requests: 0,
            color: [0; 3],
        })
    }

    /// With motors that are so many times as fast; delays stay as they are. A driver of this crate does not believe in
    /// motors that are faster than their table says.
    pub fn with_time_scale(mut self, scale: f64) -> Self {
        self.time_scale = scale;
        self
    }

    /// Puts it at these joint values (rad), at rest.
    pub fn place(&mut self, q: &[f64; 6]) {
        self.arm.place(q);
    }

    /// Latches an error, as a collision does: it brakes, and does not move until the error is cleared.
    pub fn latch(&mut self, code: u8) {
        self.arm.latch(code);
    }

    /// Where its joints are (rad).
    pub fn positions(&self) -> [f64; 6] {
        self.arm.positions()
    }

    /// Where its joints are going (rad); where they are if they rest.
    pub fn goals(&self) -> [f64; 6] {
        self.arm.goals()
    }

    /// Whether a joint moves.
    pub fn is_moving(&self) -> bool {
        self.arm.is_moving()
    }

    /// Whether it has power and torque on all joints.
    pub fn is_holding(&self) -> bool {
        self.arm.is_holding()
    }

    /// The LED's red, green and blue.
    pub fn color(&self) -> [u8; 3] {
        self.color
    }

    /// How far the gripper is open, in percent.
    pub fn gripper(&self) -> u8 {
        self.arm.gripper_value()
    }

    /// How many requests have arrived whole.
    pub fn requests(&self) -> u64 {
        self.requests
    }

    /// When the next reply leaves: each takes a time of its own, always the same ones in the same order, and none
    /// overtakes another.
    fn reply_time(&self) -> Time {
        let spread = REPLY_SPREAD.mul_f64((self.requests * 5 % 8) as f64 / 7.0);
        let latency = if self.model == Model::M5 { USB_LATENCY } else { Duration::ZERO };
        let last = self.replies.back().map_or(Time::START, |(time, _)| *time);
        (self.now + REPLY + spread + latency).max(last)
    }

    /// A request that has arrived whole.
    fn take(&mut self, request: &Frame) {
        self.requests += 1;
        if let Some(reply) = self.answer(request) {
            let time = self.reply_time();
            self.replies.push_back((time, reply.encode()));
        }
    }
}

impl SimulatedDevice for SimulatedMyCobot<'_> {
    fn receive(&mut self, bytes: &[u8], now: Time) {
        self.advance(now);
        if now.since(self.last_byte) > GAP {
            while let Some(request) = self.reader.next_after_gap() {
                self.take(&request);
            }
        }
        self.last_byte = now;
        self.reader.push(bytes);
        while let Some(request) = self.reader.next_frame() {
            self.take(&request);
        }
    }

    fn advance(&mut self, now: Time) {
        self.arm.advance(now.since(self.now).mul_f64(self.time_scale));
        self.now = self.now.max(now);
    }

    fn next_send(&self) -> Option<Time> {
        self.replies.front().map(|(time, _)| *time)
    }

    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        self.replies.front().filter(|(time, _)| *time <= now)?;
        self.replies.pop_front().map(|(_, bytes)| bytes)
    }
}
