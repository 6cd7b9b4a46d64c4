//! The myCobot 280 of Elephant Robotics.
mod command;
mod frame;
mod refusal;
mod reply;
mod request;

pub use command::Command;
pub use frame::{FOOTER, Frame, FrameReader, HEADER, MAX_PAYLOAD};
pub use refusal::{ANGLES, COORDINATES, Range, Refusal};
pub use reply::{ArmError, BadReply, Reply};
pub use request::{CoordinateMode, GripperKind, GripperState, Request};
