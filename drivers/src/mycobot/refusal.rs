//! What is refused before a byte is sent.

use std::fmt;

/// A closed range of what the arm takes.
pub type Range = (f64, f64);

/// The angles that the maker's client takes for each joint, in degrees of the device.
pub const ANGLES: [Range; 6] =
    [(-168.0, 168.0), (-140.0, 140.0), (-150.0, 150.0), (-150.0, 150.0), (-155.0, 160.0), (-180.0, 180.0)];

/// The coordinates that the maker's client takes: x, y, z in millimetres, rx, ry, rz in degrees.
pub const COORDINATES: [Range; 6] = [
    (-281.45, 281.45),
    (-281.45, 281.45),
    (-70.0, 412.67),
    (-180.0, 180.0),
    (-180.0, 180.0),
    (-180.0, 180.0),
];

/// Why a request is not sent. Joints count from 1, as in the maker's documents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// There is no such joint.
    Joint {
        /// The number given.
        joint: usize,
    },
    /// An angle outside what the arm takes (deg).
    Angle {
        /// The joint.
        joint: usize,
        /// The angle.
        value: f64,
        /// What it takes.
        range: Range,
    },
    /// A coordinate outside what the arm takes (mm, deg).
    Coordinate {
        /// Its name.
        axis: &'static str,
        /// Its value.
        value: f64,
        /// What it takes.
        range: Range,
    },
    /// An increment outside what the wire holds (deg).
    Increment {
        /// The joint.
        joint: usize,
        /// The increment.
        value: f64,
    },
    /// A speed outside the percentages that the command takes.
    Speed {
        /// The speed.
        value: u8,
        /// The least that it takes.
        min: u8,
    },
    /// An opening of the gripper over 100 %.
    Gripper {
        /// The opening.
        value: u8,
    },
}

/// The names of the coordinates.
pub(super) const AXES: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

/// How far a value may lie beyond its range and count as inside (mm, deg): what converting radians to degrees leaves.
const SLACK: f64 = 1e-9;

/// Whether the value is in the range. Not a number is not.
pub(super) fn within(value: f64, (min, max): Range) -> bool {
    min - SLACK <= value && value <= max + SLACK
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Joint { joint } => write!(f, "there is no joint {joint}: the arm has joints 1 to 6"),
            Self::Angle { joint, value, range: (min, max) } => {
                write!(f, "joint {joint} takes {min} to {max} degrees, not {value}")
            }
            Self::Coordinate { axis, value, range: (min, max) } => {
                let unit = if axis.starts_with('r') { "degrees" } else { "mm" };
                write!(f, "{axis} takes {min} to {max} {unit}, not {value}")
            }
            Self::Increment { joint, value } => {
                write!(f, "joint {joint} moves by at most 327.67 degrees at a time, not by {value}")
            }
            Self::Speed { value, min } => write!(f, "a speed is {min} to 100 percent, not {value}"),
            Self::Gripper { value } => write!(f, "the gripper takes 0 to 100 percent, not {value}"),
        }
    }
}

impl std::error::Error for Refusal {}
