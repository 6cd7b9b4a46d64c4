//! How fast a joint may move.

use dh_runtime::{Joint, JointKind};

/// Greatest velocity, acceleration and jerk of one joint, each the same both ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dynamics {
    /// rad/s or m/s
    pub velocity: f64,
    /// rad/s² or m/s²
    pub acceleration: f64,
    /// rad/s³ or m/s³
    pub jerk: f64,
}

/// What joints may do where their table does not say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Defaults {
    /// Velocity of joints that turn (rad/s).
    pub revolute_velocity: f64,
    /// Velocity of joints that slide (m/s).
    pub prismatic_velocity: f64,
    /// How long a joint takes to its greatest velocity at constant acceleration (s): acceleration = velocity / this.
    pub velocity_time: f64,
    /// How long it takes to its greatest acceleration (s): jerk = acceleration / this.
    pub acceleration_time: f64,
}

impl Default for Defaults {
    /// 1 rad/s or 0.1 m/s, reached in a quarter of a second, at an acceleration that is reached in a tenth.
    fn default() -> Self {
        Self { revolute_velocity: 1.0, prismatic_velocity: 0.1, velocity_time: 0.25, acceleration_time: 0.1 }
    }
}

impl Dynamics {
    /// What the table says of a joint, and the defaults for what it does not.
    pub fn of_joint(joint: &Joint<'_>, defaults: &Defaults) -> Self {
        let velocity = joint.max_velocity.unwrap_or(match joint.kind {
            JointKind::Revolute => defaults.revolute_velocity,
            JointKind::Prismatic => defaults.prismatic_velocity,
        });
        let acceleration = joint.max_acceleration.unwrap_or(velocity / defaults.velocity_time);
        let jerk = joint.max_jerk.unwrap_or(acceleration / defaults.acceleration_time);
        Self { velocity, acceleration, jerk }
    }

    /// No more velocity and acceleration than these, where there are any.
    pub(super) fn capped(self, (velocity, acceleration): (Option<f64>, Option<f64>)) -> Self {
        let cap = |value: f64, cap: Option<f64>| cap.map_or(value, |cap| value.min(cap));
        Self {
            velocity: cap(self.velocity, velocity),
            acceleration: cap(self.acceleration, acceleration),
            ..self
        }
    }

    /// The limits of the same motion, slower: at this part of its velocity.
    pub(super) fn slowed(self, part: f64) -> Self {
        Self {
            velocity: self.velocity * part,
            acceleration: self.acceleration * part.powi(2),
            jerk: self.jerk * part.powi(3),
        }
    }

    /// Whether a joint can move under them at all.
    pub(super) fn is_usable(self) -> bool {
        [self.velocity, self.acceleration, self.jerk].iter().all(|limit| limit.is_finite() && *limit > 0.0)
    }
}
