//! Where the arm is, while it moves and when it comes to rest.

use super::Robot;
use crate::clock::Time;
use crate::driver::{Driver, State};
use crate::motion::error::MotionError;
use std::collections::VecDeque;
use std::time::Duration;

/// Where the arm was sent lately: it should be between these places.
#[derive(Debug)]
pub(super) struct Trail {
    places: VecDeque<Vec<f64>>,
    length: usize,
}

impl Trail {
    /// Remembers so many places, of which this is the first.
    pub(super) fn new(start: &[f64], length: usize) -> Self {
        Self { places: VecDeque::from([start.to_vec()]), length: length.max(2) }
    }

    /// It was sent there now.
    pub(super) fn push(&mut self, place: &[f64]) {
        if self.places.len() == self.length {
            self.places.pop_front();
        }
        self.places.push_back(place.to_vec());
    }

    /// Least and greatest value of a joint (rad or m).
    fn range(&self, joint: usize) -> (f64, f64) {
        let values = self.places.iter().filter_map(|place| place.get(joint).copied());
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), x| (min.min(x), max.max(x)))
    }
}

impl<D: Driver> Robot<'_, D> {
    pub(super) fn now(&self) -> Time {
        self.driver.clock().now()
    }

    /// Asks where the arm is, and whether that is where it should be. An answer that stays away is forgiven until it
    /// has been away too long.
    ///
    /// # Errors
    /// Faults, feedback that is lost, an arm that strays.
    pub(super) fn watch_arm(&mut self, trail: &Trail) -> Result<(), MotionError> {
        match self.driver.read_state() {
            Ok(state) => self.state = state,
            Err(last) => {
                let lost = self.now().since(self.state.stamp);
                if lost >= self.settings.feedback {
                    return Err(MotionError::FeedbackLost { lost, last: Box::new(last) });
                }
                return Ok(());
            }
        }
        self.no_fault()?;
        self.on_trail(trail)
    }

    /// # Errors
    /// A fault that has latched.
    pub(super) fn no_fault(&self) -> Result<(), MotionError> {
        match self.state.first_fault() {
            Some((joint, fault)) => {
                let joint = joint.map(|index| self.joint_name(index));
                Err(MotionError::Fault { joint, fault: *fault })
            }
            None => Ok(()),
        }
    }

    fn on_trail(&self, trail: &Trail) -> Result<(), MotionError> {
        let mut worst: Option<(f64, MotionError)> = None;
        let joints = self.state.joints.iter().zip(self.arm().joints()).enumerate();
        for (index, (seen, joint)) in joints {
            let (min, max) = trail.range(index);
            let (actual, tolerance) = (seen.position, self.settings.following.of(joint.kind));
            let off = (min - actual).max(actual - max);
            // What is no number has strayed.
            let strayed = off.is_nan() || off > tolerance;
            if strayed && worst.as_ref().is_none_or(|(most, _)| off / tolerance > *most) {
                let joint = self.joint_name(index);
                worst = Some((off / tolerance, MotionError::Strayed { joint, actual, min, max, tolerance }));
            }
        }
        worst.map_or(Ok(()), |(_, error)| Err(error))
    }

    /// Whether the arm was at rest when it was last seen; `before` is what was seen before that.
    pub(super) fn is_at_rest(&self, before: Option<&State>) -> bool {
        let joints = self.state.joints.iter().zip(self.arm().joints()).enumerate();
        joints.into_iter().all(|(index, (seen, joint))| {
            let least = self.settings.rest.of(joint.kind);
            let still = match (seen.velocity, before) {
                (Some(velocity), _) => velocity.abs() <= least,
                (None, Some(before)) => {
                    let seconds = self.state.stamp.since(before.stamp).as_secs_f64();
                    let moved =
                        before.joints.get(index).map(|before| (seen.position - before.position).abs());
                    seconds > 0.0 && moved.is_some_and(|moved| moved <= least * seconds)
                }
                (None, None) => false,
            };
            still && seen.moving != Some(true)
        })
    }

    /// Waits until the arm is at rest in the goal.
    ///
    /// # Errors
    /// Where it isn't so long after now; and what [`Robot::watch_arm`] sees.
    pub(super) fn wait_for_arrival(
        &mut self,
        goal: &[f64],
        trail: &Trail,
        allowed: Duration,
        seen: &mut dyn FnMut(&State, bool),
    ) -> Result<(), MotionError> {
        let begun = self.now();
        let mut before: Option<State> = None;
        loop {
            self.watch_arm(trail)?;
            let news = before.as_ref().is_none_or(|before| before.stamp < self.state.stamp);
            let off = self.furthest_beyond(&self.state.positions(), goal, &self.settings.arrival);
            if news && off.is_none() && self.is_at_rest(before.as_ref()) {
                seen(&self.state, true);
                return Ok(());
            }
            seen(&self.state, false);
            let waited = self.now().since(begun);
            if waited >= allowed {
                let index = off.map_or(0, |(index, _)| index);
                let value = |q: &[f64]| q.get(index).copied().unwrap_or(f64::NAN);
                let (actual, goal) = (value(&self.state.positions()), value(goal));
                return Err(MotionError::NotArrived { joint: self.joint_name(index), actual, goal, waited });
            }
            if self.stop.is_set() {
                return Err(MotionError::Stopped);
            }
            before = Some(self.state.clone());
            self.pause();
        }
    }

    /// Waits until the arm is at rest, wherever that is.
    ///
    /// # Errors
    /// Where it doesn't come to rest, or nothing is heard of it.
    pub(super) fn wait_for_rest(&mut self) -> Result<(), MotionError> {
        let begun = self.now();
        let mut before: Option<State> = None;
        loop {
            match self.driver.read_state() {
                Ok(state) => self.state = state,
                Err(last) => {
                    let lost = self.now().since(self.state.stamp);
                    if lost >= self.settings.feedback {
                        return Err(MotionError::FeedbackLost { lost, last: Box::new(last) });
                    }
                }
            }
            let news = before.as_ref().is_none_or(|before| before.stamp < self.state.stamp);
            if news && self.is_at_rest(before.as_ref()) {
                self.under_way = false;
                return Ok(());
            }
            let waited = self.now().since(begun);
            if waited >= self.settings.settling {
                let fastest = self.state.joints.iter().enumerate().max_by(|(_, a), (_, b)| {
                    a.velocity.unwrap_or(0.0).abs().total_cmp(&b.velocity.unwrap_or(0.0).abs())
                });
                let (index, actual) = fastest.map_or((0, f64::NAN), |(index, joint)| (index, joint.position));
                let joint = self.joint_name(index);
                return Err(MotionError::NotArrived { joint, actual, goal: actual, waited });
            }
            before = Some(self.state.clone());
            self.pause();
        }
    }

    /// Waits until it is time to ask again.
    pub(super) fn pause(&self) {
        let clock = self.driver.clock();
        clock.sleep_until(clock.now() + self.settings.poll);
    }
}
