//! The myCobot 280 of Elephant Robotics, with a Raspberry Pi or an M5 in its base.
//!
//! [`Frame`]s and the [`Command`]s they carry, [`Request`]s (checked when they are made) and [`Reply`]s (judged when they
//! come), [`MyCobot`], the [`Driver`](crate::Driver), and [`SimulatedMyCobot`], an arm that is not there.
//!
//! **Nothing protects what is on the wire**: no checksum, no sequence number. [`MyCobot`] says what is done about it.
//!
//! **Nothing stops the arm when its program is gone.** It has no watchdog: killed in the middle of a move, a program
//! leaves it going on to its last goal. What moves it is therefore one goal at a time, checked as a whole, and never a
//! jog that goes on until it is stopped.
//!
//! **Coordinates are read, and not sent.** The firmware solves what it is sent by itself, by whichever joint values it
//! likes and along whatever way: nobody could check the limits and workspace rules of such a move before it is made, and
//! what moves an arm here is a checked [`Command`](crate::Command). The same moves are
//! [`Move::pose`](crate::motion::Move::pose) and, straight, [`Move::line`](crate::motion::Move::line), which solve them from
//! the table. [`Request`] can write all of the protocol, for the simulated arm and for tests.
//!
//! Units: degrees of the device and millimetres in requests and replies, which are the protocol's own; radians and
//! metres of the table in the driver.
//!
//! Sources: the bytes and times that the maker's client pymycobot 4.0.7 sends and takes (`tests/golden/mycobot.json`),
//! and the maker's document `MyCobot_280_en`. Nothing here was tried on a real arm.

mod command;
mod device;
mod frame;
mod link;
mod readings;
mod refusal;
mod reply;
mod request;
mod simulated;
#[cfg(test)]
mod tests;

use crate::driver::{DeviceJoint, JointMap, MapError};

pub use command::Command;
pub use device::{MyCobot, Versions};
pub use frame::{FOOTER, Frame, FrameReader, HEADER, MAX_PAYLOAD};
pub use link::LineCounts;
pub use refusal::{ANGLES, COORDINATES, Range, Refusal};
pub use reply::{ArmError, BadReply, Reply};
pub use request::{CoordinateMode, GripperKind, GripperState, Request};
pub use simulated::SimulatedMyCobot;

/// Which of the two arms it is. They differ in what their base answers, and in their line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// With a Raspberry Pi in its base, at `/dev/ttyAMA0`.
    Pi,
    /// With an M5 in its base, on USB. The M5 must show its screen *Transponder, USB UART*.
    M5,
}

impl Model {
    /// Bits per second of its line.
    pub const fn baud(self) -> u32 {
        match self {
            Self::Pi => 1_000_000,
            Self::M5 => 115_200,
        }
    }

    /// The model with a line of this rate.
    pub const fn of_baud(baud: u32) -> Option<Self> {
        match baud {
            1_000_000 => Some(Self::Pi),
            115_200 => Some(Self::M5),
            _ => None,
        }
    }
}

/// The joints, if there are six of them.
fn six(map: &JointMap) -> Result<&[DeviceJoint; 6], MapError> {
    map.joints.as_slice().try_into().map_err(|_| MapError {
        joint: format!("{} of {}", map.len().min(6) + 1, map.len()),
        what: "no place in a myCobot, which has six joints",
        instead: "take another driver, or the table of a myCobot".to_owned(),
    })
}
