//! What a robot takes for lost, for strayed, and for arrived.

use crate::driver::Pace;
use dh_runtime::JointKind;
use std::time::Duration;

/// A tolerance for joints that turn and one for those that slide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// rad (or rad/s)
    pub revolute: f64,
    /// m (or m/s)
    pub prismatic: f64,
}

impl Tolerance {
    /// The one of a joint of this kind.
    pub fn of(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute => self.revolute,
            JointKind::Prismatic => self.prismatic,
        }
    }
}

/// What a robot takes for lost, for strayed, and for arrived.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The arm has strayed where it is further than this from everything it was sent lately: 0.2 rad, 20 mm.
    pub following: Tolerance,
    /// What was sent in this time counts as lately: half a second.
    pub lag: Duration,
    /// The arm is in its goal where it is at most this far from it: 0.03 rad, 1 mm. It must be at rest, too; then it is as
    /// near as its servos bring it.
    pub arrival: Tolerance,
    /// It is at rest where nothing moves faster: 0.03 rad/s, 1 mm/s.
    pub rest: Tolerance,
    /// It has this long to come to rest in its goal after it should be there: 3 s.
    pub settling: Duration,
    /// Moves begin where the arm is at most this far from where they were checked: 0.05 rad, 2 mm.
    pub start: Tolerance,
    /// Torque may be cut at most this far from a safe pose: 0.1 rad, 5 mm.
    pub safe: Tolerance,
    /// Without a word from the device for so long the arm is stopped: half a second; a second where the device makes its
    /// own profiles, whose answers are slow.
    pub feedback: Duration,
    /// Without a word from this program for so long the device stops by itself, where it can: half a second.
    pub watchdog: Duration,
    /// How often a device that makes its own profiles is asked where it is, and any that is coming to rest: every 50 ms.
    pub poll: Duration,
}

impl Settings {
    /// The defaults for a device of this pace.
    pub fn of_pace(pace: Pace) -> Self {
        match pace {
            Pace::Stream { .. } => Self::default(),
            Pace::PointToPoint => Self { feedback: Duration::from_secs(1), ..Self::default() },
        }
    }
}

/// Those of a stream.
impl Default for Settings {
    fn default() -> Self {
        let tolerance = |revolute, prismatic| Tolerance { revolute, prismatic };
        Self {
            following: tolerance(0.2, 0.02),
            lag: Duration::from_millis(500),
            arrival: tolerance(0.03, 0.001),
            rest: tolerance(0.03, 0.001),
            settling: Duration::from_secs(3),
            start: tolerance(0.05, 0.002),
            safe: tolerance(0.1, 0.005),
            feedback: Duration::from_millis(500),
            watchdog: Duration::from_millis(500),
            poll: Duration::from_millis(50),
        }
    }
}
