//! What an arm is asked to do.

use dh_runtime::{FULL_POSE, Frame, Target};

/// One move, from wherever the arm stands then, at rest, to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Move {
    pub(super) goal: Goal,
    /// Of the greatest velocity: 0 to 1.
    pub(super) part: f64,
    /// Along a path (m/s).
    pub(super) speed: Option<f64>,
    /// s
    pub(super) within: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Goal {
    /// Joint values (rad or m).
    Joints(Vec<f64>),
    /// The nearest solution.
    Nearest { problem: String, target: Box<Target> },
    /// Through these targets, one after the other; one alone is the end of a straight line.
    Path { problem: String, through: Vec<Target> },
}

impl Move {
    fn to(goal: Goal) -> Self {
        Self { goal, part: 1.0, speed: None, within: None }
    }

    /// All joints at once to these values (rad or m).
    pub fn joints(q: &[f64]) -> Self {
        Self::to(Goal::Joints(q.to_vec()))
    }

    /// All joints at once to the nearest solution of an inverse problem of the table.
    pub fn nearest(problem: &str, target: Target) -> Self {
        Self::to(Goal::Nearest { problem: problem.to_owned(), target: Box::new(target) })
    }

    /// All joints at once to the nearest joint values at which the tool has this pose.
    pub fn pose(pose: impl Into<Frame>) -> Self {
        Self::nearest(FULL_POSE, Target::Pose(pose.into()))
    }

    /// The tool in a straight line to a target of an inverse problem, which is solved all along the way. Where the target
    /// says how the tool is turned, it turns evenly on the way; what the problem holds fast stays so.
    pub fn line(problem: &str, target: Target) -> Self {
        Self::curve(problem, vec![target])
    }

    /// The tool smoothly through all these targets to the last, likewise: by a cubic spline, whose speed may differ from
    /// that asked for by as much as the points are unevenly placed on their curve.
    pub fn curve(problem: &str, through: Vec<Target>) -> Self {
        Self::to(Goal::Path { problem: problem.to_owned(), through })
    }

    /// The same motion at this part (more than 0, at most 1) of the greatest velocity; with the square of it for the
    /// acceleration, and the cube for the jerk.
    pub fn slowed(mut self, part: f64) -> Self {
        self.part = part;
        self
    }

    /// At this speed along the path (m/s), and refused where the joints can't follow. Where nothing is asked for, the
    /// speed is [`PATH_SPEED`](super::PATH_SPEED) or what the joints can follow. Where the hand turns more than it travels, a
    /// radian counts as a tenth of a metre. Has no effect on moves that are not along paths.
    pub fn speed(mut self, speed: f64) -> Self {
        self.speed = Some(speed);
        self
    }

    /// Refused if it takes longer than this (s).
    pub fn within(mut self, seconds: f64) -> Self {
        self.within = Some(seconds);
        self
    }
}
