//! Constructors for the tables in generated code, which are constants: one line an entry.

use crate::{Axis, Bound, Joint, JointKind, KeepOut, Limits, NamedPose, Servo, Side, SumLimit, Winding};

impl<S: Copy> Limits<S> {
    /// From `min` to `max`.
    pub const fn new(min: S, max: S) -> Self {
        Self { min, max }
    }
}

impl<'a, S: Copy> Joint<'a, S> {
    /// A joint that turns, without limits.
    pub const fn revolute(name: &'a str) -> Self {
        Self::unlimited(name, JointKind::Revolute)
    }

    /// A joint that slides, without limits.
    pub const fn prismatic(name: &'a str) -> Self {
        Self::unlimited(name, JointKind::Prismatic)
    }

    const fn unlimited(name: &'a str, kind: JointKind) -> Self {
        Self {
            name,
            kind,
            limits: None,
            max_velocity: None,
            max_acceleration: None,
            max_jerk: None,
            servo: None,
        }
    }

    /// With limits of its value (rad or m).
    pub const fn with_limits(mut self, min: S, max: S) -> Self {
        self.limits = Some(Limits::new(min, max));
        self
    }

    /// With a limit of its speed (rad/s or m/s).
    pub const fn with_max_velocity(mut self, velocity: S) -> Self {
        self.max_velocity = Some(velocity);
        self
    }

    /// With a limit of its acceleration (rad/s² or m/s²).
    pub const fn with_max_acceleration(mut self, acceleration: S) -> Self {
        self.max_acceleration = Some(acceleration);
        self
    }

    /// With a limit of its jerk (rad/s³ or m/s³).
    pub const fn with_max_jerk(mut self, jerk: S) -> Self {
        self.max_jerk = Some(jerk);
        self
    }

    /// With a servo.
    pub const fn with_servo(mut self, servo: Servo<'a, S>) -> Self {
        self.servo = Some(servo);
        self
    }
}

impl<'a, S: Copy> Servo<'a, S> {
    /// device = scale * q + zero, q in rad or m.
    pub const fn new(scale: S, zero: S) -> Self {
        Self { id: None, scale, zero, range: None, model: None }
    }

    /// With a bus id.
    pub const fn with_id(mut self, id: u32) -> Self {
        self.id = Some(id);
        self
    }

    /// With the range of its register (device units).
    pub const fn with_range(mut self, min: S, max: S) -> Self {
        self.range = Some(Limits::new(min, max));
        self
    }

    /// With the name of its model.
    pub const fn with_model(mut self, model: &'a str) -> Self {
        self.model = Some(model);
        self
    }
}

impl<'a, S: Copy> NamedPose<'a, S> {
    /// A pose in which torque must not be cut.
    pub const fn new(name: &'a str, q: &'a [S]) -> Self {
        Self { name, q, safe: false }
    }

    /// The same, with torque that may be cut.
    pub const fn marked_safe(mut self) -> Self {
        self.safe = true;
        self
    }
}

impl<'a, S: Copy> SumLimit<'a, S> {
    /// A range of the sum of (index of q, coefficient), in rad or m.
    pub const fn new(terms: &'a [(usize, S)], min: S, max: S) -> Self {
        Self { terms, range: Limits::new(min, max) }
    }
}

impl<S: Copy> Bound<S> {
    /// No smaller coordinate than this (m).
    pub const fn min(axis: Axis, value: S) -> Self {
        Self { axis, side: Side::Min, value }
    }

    /// No greater coordinate than this (m).
    pub const fn max(axis: Axis, value: S) -> Self {
        Self { axis, side: Side::Max, value }
    }
}

impl<S: Copy> KeepOut<S> {
    /// The box between two corners (m).
    pub const fn new(min: [S; 3], max: [S; 3]) -> Self {
        Self { min, max }
    }
}

impl<'a, S: Copy> Winding<'a, S> {
    /// A turn (rad) of joint `q[joint]` that carries others along: (index of q, rad or m).
    pub const fn new(joint: usize, turn: S, carries: &'a [(usize, S)]) -> Self {
        Self { joint, turn, carries }
    }
}
