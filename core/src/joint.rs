//! Joints as the table describes them.

use crate::Float;

/// Whether a joint turns or slides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JointKind {
    /// Turns; values in radians.
    Revolute,
    /// Slides; values in metres.
    Prismatic,
}

impl JointKind {
    /// `rad` or `m`.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad",
            Self::Prismatic => "m",
        }
    }
}

/// A closed interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<S = f64> {
    /// Least value.
    pub min: S,
    /// Greatest value.
    pub max: S,
}

impl<S: Float> Limits<S> {
    /// Whether the value is in the interval, to the last digit.
    pub fn contains(&self, value: S) -> bool {
        self.min <= value && value <= self.max
    }

    /// The nearest value of the interval.
    pub fn clamp(&self, value: S) -> S {
        if value < self.min {
            self.min
        } else if value > self.max {
            self.max
        } else {
            value
        }
    }

    /// The middle of the interval.
    pub fn middle(&self) -> S {
        (self.min + self.max) / S::TWO
    }

    /// What is in both intervals, if anything is.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let both = Self { min: self.min.max(other.min), max: self.max.min(other.max) };
        (both.min <= both.max).then_some(both)
    }

    /// How far the value is outside; 0 inside.
    pub(crate) fn excess(&self, value: S) -> S {
        (self.min - value).max(value - self.max).max(S::ZERO)
    }
}

/// A joint: one entry of `q`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint<'a, S = f64> {
    /// Its name in the table.
    pub name: &'a str,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// Limits of its value (rad or m).
    pub limits: Option<Limits<S>>,
    /// rad/s or m/s.
    pub max_velocity: Option<S>,
    /// rad/s² or m/s².
    pub max_acceleration: Option<S>,
    /// rad/s³ or m/s³.
    pub max_jerk: Option<S>,
    /// What the device is sent for it.
    pub servo: Option<Servo<'a, S>>,
}

impl<S: Float> Joint<'_, S> {
    /// The limits that motion may use (rad or m): those of the joint and what its servo's range leaves of them. Where
    /// nothing is left, those of the joint.
    pub fn motion_limits(&self) -> Option<Limits<S>> {
        let servo = self.servo.as_ref().and_then(Servo::limits);
        match (self.limits, servo) {
            (Some(joint), Some(servo)) => Some(joint.intersection(&servo).unwrap_or(joint)),
            (joint, servo) => joint.or(servo),
        }
    }
}

/// How a joint's value becomes what the device is sent: device = scale * q + zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo<'a, S = f64> {
    /// Bus id.
    pub id: Option<u32>,
    /// Device units per radian (or metre), signed.
    pub scale: S,
    /// Device value at q = 0.
    pub zero: S,
    /// What the register takes, in device units.
    pub range: Option<Limits<S>>,
    /// The servo's model.
    pub model: Option<&'a str>,
}

impl<S: Float> Servo<'_, S> {
    /// The device value of a joint value (rad or m); neither rounded nor held in the range.
    ///
    /// ```
    /// use dh_core::Servo;
    /// let servo = Servo { id: Some(1), scale: -100.0, zero: 2048.0, range: None, model: None };
    /// assert_eq!(servo.to_device(0.5), 1998.0);
    /// assert_eq!(servo.from_device(1998.0), 0.5);
    /// ```
    pub fn to_device(&self, q: S) -> S {
        self.scale * q + self.zero
    }

    /// The joint value (rad or m) of a device value.
    #[allow(
        clippy::wrong_self_convention,
        reason = "the counterpart of to_device: it converts by this servo's numbers"
    )]
    pub fn from_device(&self, device: S) -> S {
        (device - self.zero) / self.scale
    }

    /// The register's range as joint values (rad or m).
    pub fn limits(&self) -> Option<Limits<S>> {
        self.range.map(|range| {
            let (a, b) = (self.from_device(range.min), self.from_device(range.max));
            Limits { min: a.min(b), max: a.max(b) }
        })
    }
}

/// A named joint pose of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedPose<'a, S = f64> {
    /// Its name.
    pub name: &'a str,
    /// Joint values (rad or m), one a joint.
    pub q: &'a [S],
    /// Whether torque may be cut there.
    pub safe: bool,
}
