//! Motions from rest to rest in the least time under limits of velocity, acceleration and jerk, all joints together.
//!
//! The profiles are rsruckig's \[Berscheid, Kröger 2021\].

use super::dynamics::Dynamics;
use rsruckig::prelude::{
    DataArrayOrVec, InputParameter, Ruckig, RuckigResult, Synchronization, ThrowErrorHandler, Trajectory,
};

/// A motion of several joints from rest to rest that starts and ends at the same time for all of them.
///
/// It lasts as long as the slowest joint needs alone. The joints keep to a straight line (in joint space) where that
/// costs no time; else each has a profile of its own.
#[derive(Debug, Clone)]
pub struct Profile {
    start: Vec<f64>,
    goal: Vec<f64>,
    trajectory: Option<Trajectory<0>>,
    duration: f64,
}

/// Why there is no profile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProfileError(String);

impl std::fmt::Display for ProfileError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "no profile: {}", self.0)
    }
}

impl std::error::Error for ProfileError {}

/// rsruckig's parameter for stepping, which is not used here: only whole trajectories are asked for.
const UNUSED_PERIOD: f64 = 0.01;

impl Profile {
    /// From `start` to `goal` (rad or m) under the limits, which are one a joint like both.
    ///
    /// # Errors
    /// Where limits are not positive, or numbers not finite.
    pub fn new(start: &[f64], goal: &[f64], dynamics: &[Dynamics]) -> Result<Self, ProfileError> {
        let refuse = |message: String| Err(ProfileError(message));
        let count = start.len();
        if goal.len() != count || dynamics.len() != count {
            return refuse(format!("{count} joints, {} goals, {} limits", goal.len(), dynamics.len()));
        }
        if !start.iter().chain(goal).all(|value| value.is_finite()) {
            return refuse("a joint value is not finite".to_owned());
        }
        if let Some(joint) = dynamics.iter().position(|limits| !limits.is_usable()) {
            return refuse(format!("joint {} may not move: a limit is 0 or not finite", joint + 1));
        }
        if start == goal {
            return Ok(Self { start: start.to_vec(), goal: goal.to_vec(), trajectory: None, duration: 0.0 });
        }
        let vector = |values: &mut dyn Iterator<Item = f64>| {
            let mut vector = DataArrayOrVec::new(Some(count), 0.0);
            vector.iter_mut().zip(values).for_each(|(to, from)| *to = from);
            vector
        };
        let mut input = InputParameter::<0>::new(Some(count));
        input.synchronization = Synchronization::Phase;
        input.current_position = vector(&mut start.iter().copied());
        input.target_position = vector(&mut goal.iter().copied());
        input.max_velocity = vector(&mut dynamics.iter().map(|limits| limits.velocity));
        input.max_acceleration = vector(&mut dynamics.iter().map(|limits| limits.acceleration));
        input.max_jerk = vector(&mut dynamics.iter().map(|limits| limits.jerk));
        let mut trajectory = Trajectory::<0>::new(Some(count));
        let mut generator = Ruckig::<0, ThrowErrorHandler>::new(Some(count), UNUSED_PERIOD);
        match generator.calculate(&input, &mut trajectory) {
            Ok(RuckigResult::Working | RuckigResult::Finished) => {}
            Ok(other) => return refuse(format!("{other:?}")),
            Err(error) => return refuse(error.to_string()),
        }
        let duration = trajectory.get_duration();
        if !(duration.is_finite() && duration >= 0.0) {
            return refuse(format!("its duration would be {duration}"));
        }
        Ok(Self { start: start.to_vec(), goal: goal.to_vec(), trajectory: Some(trajectory), duration })
    }

    /// How long it takes (s).
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// When the first joint's jerk changes (s), ascending; its start and end included.
    pub(super) fn phases(&self) -> Vec<f64> {
        let mut sections = self.trajectory.iter().flat_map(Trajectory::get_profiles);
        let first = sections.find_map(|section| section.first());
        let changes = first.into_iter().flat_map(|profile| profile.t_sum);
        let inside = changes.filter(|time| 0.0 < *time && *time < self.duration);
        [0.0].into_iter().chain(inside).chain([self.duration]).collect()
    }

    /// Velocity, acceleration and jerk of the first joint at a time (s) after its start.
    pub(super) fn derivatives(&self, time: f64) -> [f64; 3] {
        let Some(trajectory) = &self.trajectory else {
            return [0.0; 3];
        };
        let zero = || DataArrayOrVec::new(Some(self.goal.len()), 0.0);
        let (mut velocity, mut acceleration, mut jerk) = (zero(), zero(), zero());
        let outputs = (&mut Some(&mut velocity), &mut Some(&mut acceleration), &mut Some(&mut jerk));
        trajectory.at_time(time, &mut None, outputs.0, outputs.1, outputs.2, &mut None);
        [velocity, acceleration, jerk].map(|vector| vector.first().copied().unwrap_or(0.0))
    }

    /// Positions (rad or m) and velocities (per s) at a time (s) after its start.
    pub fn at(&self, time: f64) -> (Vec<f64>, Vec<f64>) {
        let rest = || vec![0.0; self.goal.len()];
        let Some(trajectory) = &self.trajectory else {
            return (self.goal.clone(), rest());
        };
        if time >= self.duration {
            return (self.goal.clone(), rest());
        }
        if time <= 0.0 {
            return (self.start.clone(), rest());
        }
        let mut position = DataArrayOrVec::new(Some(self.goal.len()), 0.0);
        let mut velocity = position.clone();
        let (position_out, velocity_out) = (&mut Some(&mut position), &mut Some(&mut velocity));
        trajectory.at_time(time, position_out, velocity_out, &mut None, &mut None, &mut None);
        (position.iter().copied().collect(), velocity.iter().copied().collect())
    }
}
