//! Why an arm did not do what it was asked to.

use super::refusal::{JointName, Refusal};
use crate::driver::{DriverError, Fault, Watchdog};
use std::fmt;
use std::time::Duration;

/// A motion that was not made, or not to its end.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MotionError {
    /// It was refused; nothing was sent.
    Refused(Box<Refusal>),
    /// The arm is not where the checked moves begin; nothing was sent that moves it.
    NotAtStart {
        /// The joint that is furthest off.
        joint: JointName,
        /// Where it is (rad or m).
        actual: f64,
        /// Where it should be (rad or m).
        expected: f64,
    },
    /// The moves were checked for another arm, tool or base, or for a device that is told otherwise where to go; nothing was
    /// sent.
    OtherArm,
    /// The device did not do as it was told.
    Driver(DriverError),
    /// A fault has latched.
    Fault {
        /// The joint, where it is one's.
        joint: Option<JointName>,
        /// Which.
        fault: Fault,
    },
    /// There was no word of where the arm is for too long. It was told to stop.
    FeedbackLost {
        /// For how long.
        lost: Duration,
        /// What the last try said.
        last: Box<DriverError>,
    },
    /// The arm was not where it should have been. It was told to stop.
    Strayed {
        /// The joint that was furthest off.
        joint: JointName,
        /// Where it was (rad or m).
        actual: f64,
        /// It should have been between this (rad or m)
        min: f64,
        /// and this
        max: f64,
        /// within this.
        tolerance: f64,
    },
    /// The arm is not in its goal, and not on its way there any more or not fast enough. It holds.
    NotArrived {
        /// The joint that is furthest off, or still moves.
        joint: JointName,
        /// Where it is (rad or m).
        actual: f64,
        /// Where it should be (rad or m).
        goal: f64,
        /// How long was waited.
        waited: Duration,
    },
    /// It was asked to stop, did so, and holds.
    Stopped,
    /// Torque may not be cut here: the arm would fall.
    NotSafe {
        /// The safe pose that is nearest, with the joint that is furthest from it; none where the table has none.
        nearest: Option<(String, JointName)>,
        /// Where the joint is (rad or m).
        actual: f64,
        /// Where the pose has it (rad or m).
        expected: f64,
    },
    /// What went wrong first; and the arm could not be told to stop either.
    NotStopped {
        /// What went wrong.
        first: Box<MotionError>,
        /// Why it was not told to stop.
        stop: Box<DriverError>,
        /// What it does without a word.
        watchdog: Watchdog,
    },
}

impl From<DriverError> for MotionError {
    fn from(error: DriverError) -> Self {
        Self::Driver(error)
    }
}

impl From<Refusal> for MotionError {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(Box::new(refusal))
    }
}

impl fmt::Display for MotionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => refusal.fmt(f),
            Self::NotAtStart { joint, actual, expected } => {
                let unit = joint.kind.unit();
                write!(
                    f,
                    "{joint} is at {actual:.6} {unit}; the moves were checked from {expected:.6} {unit}"
                )
            }
            Self::OtherArm => {
                f.write_str("the moves were checked for another arm, tool, base or kind of device")
            }
            Self::Driver(error) => error.fmt(f),
            Self::Fault { joint: Some(joint), fault } => write!(f, "{joint}: {fault}"),
            Self::Fault { joint: None, fault } => fault.fmt(f),
            Self::FeedbackLost { lost, last } => {
                write!(f, "no word of where the arm is for {:.0} ms: {last}", lost.as_secs_f64() * 1e3)
            }
            Self::Strayed { joint, actual, min, max, tolerance } => {
                let unit = joint.kind.unit();
                write!(
                    f,
                    "{joint} strayed: it is at {actual:.6} {unit}, not within {tolerance:.6} {unit} of {min:.6} to {max:.6} \
                     {unit}"
                )
            }
            Self::NotArrived { joint, actual, goal, waited } => {
                let unit = joint.kind.unit();
                let waited = waited.as_secs_f64();
                write!(
                    f,
                    "{joint} is at {actual:.6} {unit}, not at rest in {goal:.6} {unit}, {waited:.1} s later"
                )
            }
            Self::Stopped => f.write_str("stopped on request"),
            Self::NotSafe { nearest: Some((pose, joint)), actual, expected } => {
                let unit = joint.kind.unit();
                write!(
                    f,
                    "torque stays on: the arm is in no safe pose; the nearest is {pose}, where {joint} is at \
                     {expected:.6} {unit}, now at {actual:.6} {unit}"
                )
            }
            Self::NotSafe { nearest: None, .. } => {
                f.write_str("torque stays on: the table marks no pose as safe")
            }
            Self::NotStopped { first, stop, watchdog } => {
                write!(f, "{first}; and it could not be told to stop ({stop}): {watchdog}")
            }
        }
    }
}

impl std::error::Error for MotionError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Refused(refusal) => Some(refusal),
            Self::Driver(error) => Some(error),
            Self::FeedbackLost { last, .. } => Some(last),
            Self::NotStopped { first, .. } => Some(first),
            _ => None,
        }
    }
}
