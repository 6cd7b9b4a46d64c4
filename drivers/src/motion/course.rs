//! Joints over time, before they are checked.

use super::dynamics::Dynamics;
use super::profile::{Profile, ProfileError};
use super::spline::Spline;
use super::timing::{self, Timing};
use crate::driver::Pace;

/// Velocities are looked at so often (s), and at least so many times.
const LOOK_PERIOD: f64 = 0.02;
const LEAST_LOOKS: f64 = 8.0;

/// Joints over time.
pub(super) enum Course {
    /// All joints at once.
    Joints(Profile),
    /// Along a path: the way over time, and the joints by the way.
    Path { timing: Timing, joints: Spline },
}

impl Course {
    /// All joints at once from one place to another. Where a device makes its own profiles its joints leave and arrive
    /// together, in a straight line; a stream takes no more time than the slowest joint needs.
    pub(super) fn between(
        start: &[f64],
        goal: &[f64],
        dynamics: &[Dynamics],
        pace: Pace,
    ) -> Result<Self, ProfileError> {
        let profile = Profile::new(start, goal, dynamics)?;
        let line = Spline::through(vec![0.0, 1.0], vec![start.to_vec(), goal.to_vec()]);
        Ok(match line.filter(|_| pace == Pace::PointToPoint && start != goal) {
            Some(joints) => Self::Path { timing: timing::straight(start, goal, dynamics)?, joints },
            None => Self::Joints(profile),
        })
    }

    /// How long it takes (s).
    pub(super) fn duration(&self) -> f64 {
        match self {
            Course::Joints(profile) => profile.duration(),
            Course::Path { timing, .. } => timing.duration(),
        }
    }

    /// Positions (rad or m) and velocities (per s) at a time (s) after its start.
    pub(super) fn at(&self, time: f64) -> (Vec<f64>, Vec<f64>) {
        match self {
            Course::Joints(profile) => profile.at(time),
            Course::Path { timing, joints } => {
                let (way, speed) = timing.at(time);
                let at = joints.at(way);
                (at.value, at.first.iter().map(|slope| slope * speed).collect())
            }
        }
    }

    /// How fast each joint goes at most between two times (s); 0 where it ends where it began.
    pub(super) fn fastest<'a>(
        &self,
        from: f64,
        to: f64,
        ends: impl Iterator<Item = (&'a f64, &'a f64)>,
    ) -> Vec<f64> {
        let looks = ((to - from) / LOOK_PERIOD).ceil().max(LEAST_LOOKS) as usize;
        let mut fastest: Vec<f64> =
            ends.map(|(start, end)| if start == end { f64::NAN } else { 0.0 }).collect();
        for look in 0..=looks {
            let (_, velocities) = self.at(from + (to - from) * look as f64 / looks as f64);
            for (fastest, velocity) in fastest.iter_mut().zip(velocities) {
                if velocity.abs() > *fastest {
                    *fastest = velocity.abs();
                }
            }
        }
        fastest.into_iter().map(|velocity| if velocity.is_nan() { 0.0 } else { velocity }).collect()
    }
}
