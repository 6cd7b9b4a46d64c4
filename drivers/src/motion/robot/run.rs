//! Making moves that were checked.

use super::feedback::Trail;
use super::{Progress, Robot};
use crate::driver::{Driver, Pace, State};
use crate::motion::checked::{Checked, Leg};
use crate::motion::command::Command;
use crate::motion::error::MotionError;
use std::time::Duration;

/// So near to a goal on the way, the next one is sent (as a part of the tolerance for having strayed): 0.04 rad, 4 mm.
const PASSING: f64 = 0.2;

/// A goal may take so many times as long as it should.
const PATIENCE: f64 = 3.0;

/// A stop on the path takes so many times as long as the joints would need alone: what they are decelerating by already
/// comes on top.
const GENTLE: f64 = 2.0;

impl<D: Driver> Robot<'_, D> {
    /// Makes moves that were checked, one after the other, each to rest in its goal. Torque is switched on if it was not.
    ///
    /// # Errors
    /// [`MotionError::NotAtStart`] where the arm is not where they begin, before anything moves. Later, what stops the
    /// arm on its way: it was told to stop then, and holds.
    pub fn run(
        &mut self,
        checked: &Checked,
        watch: &mut dyn FnMut(&Progress<'_>),
    ) -> Result<(), MotionError> {
        if self.stop.is_set() {
            return Err(MotionError::Stopped);
        }
        let Some(start) = checked.start().map(<[f64]>::to_vec) else {
            return Ok(());
        };
        let fingerprint = self.arm().fingerprint();
        let mut commands = checked.legs.iter().flat_map(|leg| &leg.commands);
        let other = commands.any(|command| command.fingerprint() != fingerprint);
        if other || checked.origin != self.planner.origin() {
            return Err(MotionError::OtherArm);
        }
        let seen = self.read()?.positions();
        self.no_fault()?;
        if let Some((index, _)) = self.furthest_beyond(&seen, &start, &self.settings.start) {
            let value = |q: &[f64]| q.get(index).copied().unwrap_or(f64::NAN);
            let joint = self.joint_name(index);
            return Err(MotionError::NotAtStart { joint, actual: value(&seen), expected: value(&start) });
        }
        if !self.torque {
            self.hold()?;
        }
        self.watchdog = self.driver.watchdog(Some(self.settings.watchdog))?;
        self.under_way = true;
        let outcome = self.legs(checked, watch);
        let outcome = outcome.or_else(|error| self.after(error));
        if self.under_way {
            return outcome;
        }
        // At rest there is nothing to stop, and whoever comes next need not talk all the time.
        let disarmed = self.driver.watchdog(None);
        outcome.and(disarmed.map(|_| ()).map_err(MotionError::Driver))
    }

    fn legs(&mut self, checked: &Checked, watch: &mut dyn FnMut(&Progress<'_>)) -> Result<(), MotionError> {
        let duration = checked.duration();
        let mut before = 0.0;
        for (step, leg) in checked.legs.iter().enumerate() {
            let mut tell = |state: &State, elapsed: f64, arrived: bool| {
                let (steps, elapsed, goal) = (checked.legs.len(), before + elapsed, leg.goal());
                watch(&Progress { step, steps, elapsed, duration, arrived, goal, state });
            };
            self.held = None;
            self.under_way = true;
            match self.driver.pace() {
                Pace::Stream { period } => self.stream(leg, period, &mut tell)?,
                Pace::PointToPoint => self.goals(leg, &mut tell)?,
            }
            self.held = Some(leg.goal().to_vec());
            self.under_way = false;
            before += leg.times.last().copied().unwrap_or(0.0);
        }
        Ok(())
    }

    /// Setpoints, one a period. One that comes late delays all that follow: none is skipped, and none hurried.
    fn stream(
        &mut self,
        leg: &Leg,
        period: Duration,
        tell: &mut dyn FnMut(&State, f64, bool),
    ) -> Result<(), MotionError> {
        let clock = self.driver.clock();
        let lately = self.settings.lag.as_secs_f64() / period.as_secs_f64();
        let mut trail = Trail::new(&leg.start, lately.ceil() as usize);
        let mut due = clock.now();
        for (index, (command, time)) in leg.commands.iter().zip(&leg.times).enumerate() {
            clock.sleep_until(due);
            if self.stop.is_set() {
                return self.brake(leg, index, period, &mut trail);
            }
            self.send(command)?;
            due = (due + period).max(clock.now());
            trail.push(command.positions());
            self.watch_arm(&trail)?;
            tell(&self.state, *time, false);
        }
        let duration = leg.times.last().copied().unwrap_or(0.0);
        let settling = self.settings.settling;
        self.wait_for_arrival(leg.goal(), &trail, settling, &mut |state, arrived| {
            tell(state, duration, arrived);
        })
    }

    /// Slows down on the path, from the setpoint before this one on, and says that it did.
    fn brake(
        &mut self,
        leg: &Leg,
        index: usize,
        period: Duration,
        trail: &mut Trail,
    ) -> Result<(), MotionError> {
        let clock = self.driver.clock();
        let Some(last) = index.checked_sub(1).and_then(|last| leg.commands.get(last)) else {
            self.under_way = false;
            return Err(MotionError::Stopped);
        };
        let speeds = last.velocities().iter().zip(self.planner.dynamics());
        let needed = speeds.map(|(speed, limits)| speed.abs() / limits.acceleration).fold(0.0, f64::max);
        let count = (GENTLE * needed / period.as_secs_f64()).ceil().max(1.0);
        let (mut place, mut due) = (index as f64 - 1.0, clock.now());
        for step in 1..=count as usize {
            let rate = 1.0 - step as f64 / count;
            place += rate;
            let command = leg.between(place, rate);
            clock.sleep_until(due);
            self.send(&command)?;
            due = (due + period).max(clock.now());
            trail.push(command.positions());
            self.watch_arm(trail)?;
        }
        let end = leg.between(place, 0.0);
        self.wait_for_rest()?;
        self.held = Some(end.positions().to_vec());
        Err(MotionError::Stopped)
    }

    /// Goals, each sent when the arm is near the one before.
    fn goals(&mut self, leg: &Leg, tell: &mut dyn FnMut(&State, f64, bool)) -> Result<(), MotionError> {
        let mut trail = Trail::new(&leg.start, 3);
        let mut then = 0.0;
        for (command, time) in leg.commands.iter().zip(&leg.times) {
            if self.stop.is_set() {
                return Err(MotionError::Stopped);
            }
            self.send(command)?;
            trail.push(command.positions());
            let allowed = Duration::from_secs_f64(PATIENCE * (time - then)) + self.settings.settling;
            let is_last = *time >= leg.times.last().copied().unwrap_or(0.0);
            let from = then;
            let mut tell = |state: &State, part: f64, arrived: bool| {
                tell(state, from + part * (time - from), arrived);
            };
            if is_last {
                let start = self.state.positions();
                let goal = command.positions();
                let mut seen =
                    |state: &State, arrived: bool| tell(state, part_of_way(&start, goal, state), arrived);
                self.wait_for_arrival(goal, &trail, allowed, &mut seen)?;
            } else {
                self.wait_for_passing(command, &trail, allowed)?;
                tell(&self.state, 1.0, false);
            }
            then = *time;
        }
        Ok(())
    }

    /// Waits until the arm is near a goal on the way.
    fn wait_for_passing(
        &mut self,
        command: &Command,
        trail: &Trail,
        allowed: Duration,
    ) -> Result<(), MotionError> {
        let begun = self.now();
        let goal = command.positions();
        let mut near = self.settings.following;
        near.revolute *= PASSING;
        near.prismatic *= PASSING;
        loop {
            self.watch_arm(trail)?;
            let off = self.furthest_beyond(&self.state.positions(), goal, &near);
            let Some((index, _)) = off else {
                return Ok(());
            };
            if self.stop.is_set() {
                return Err(MotionError::Stopped);
            }
            let waited = self.now().since(begun);
            if waited >= allowed {
                let value = |q: &[f64]| q.get(index).copied().unwrap_or(f64::NAN);
                let (actual, goal) = (value(&self.state.positions()), value(goal));
                return Err(MotionError::NotArrived { joint: self.joint_name(index), actual, goal, waited });
            }
            self.pause();
        }
    }

    /// Something has ended a run: stops the arm, unless it is at rest, and waits for that.
    fn after(&mut self, error: MotionError) -> Result<(), MotionError> {
        if !self.under_way {
            return Err(error);
        }
        self.held = None;
        // A device that was away, or that gave up by itself, wants torque to be switched on anew.
        self.torque = false;
        match self.driver.stop() {
            Ok(()) => {
                // Where nothing is heard of the arm, it was told to stop at least; dropping the robot tells it again.
                let _ = self.wait_for_rest();
                Err(error)
            }
            Err(stop) => {
                let (first, stop) = (Box::new(error), Box::new(stop));
                Err(MotionError::NotStopped { first, stop, watchdog: self.watchdog })
            }
        }
    }
}

/// How much of its way the joint with the longest way has made.
fn part_of_way(start: &[f64], goal: &[f64], state: &State) -> f64 {
    let ways = start.iter().zip(goal).zip(&state.joints);
    let longest = ways.max_by(|((a, b), _), ((c, d), _)| (*b - *a).abs().total_cmp(&(*d - *c).abs()));
    longest.map_or(1.0, |((start, goal), seen)| {
        let way = goal - start;
        if way == 0.0 { 1.0 } else { ((seen.position - start) / way).clamp(0.0, 1.0) }
    })
}
