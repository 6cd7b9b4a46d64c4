//! What goes wrong with devices.

use crate::port::PortError;
use std::fmt;
use std::time::Duration;

/// Something that was asked of a device and not done, or not known to be done.
#[derive(Debug, Clone, PartialEq)]
pub struct DriverError {
    /// The port's name.
    pub port: String,
    /// The joint, or another part of the device, where it is one's.
    pub joint: Option<String>,
    /// What was asked for: `read state`, `goal position`, ...
    pub command: &'static str,
    /// Why it was not done.
    pub cause: Cause,
}

/// Why something was not done.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// The port failed.
    Port(PortError),
    /// No answer in time, all tries together.
    Silent {
        /// How long was waited.
        waited: Duration,
    },
    /// Something came, but no sound answer, all tries together.
    Garbled,
    /// The device answered that it won't.
    Refused {
        /// The device's number for it.
        code: u8,
        /// What the number means.
        meaning: &'static str,
    },
    /// A latched fault is in the way.
    Fault(Fault),
    /// Two readings of the same thing, of which something depends, differ by too much (SI units).
    Unconfirmed {
        /// The first reading.
        first: f64,
        /// The second reading.
        second: f64,
    },
    /// There is a wrong number of joint values.
    Length {
        /// How many joints there are.
        expected: usize,
        /// How many values were given.
        got: usize,
    },
    /// The command was checked against another table.
    OtherRobot {
        /// The fingerprint of the driver's table.
        expected: u64,
        /// The command's.
        got: u64,
    },
    /// The value does not fit the device (device units).
    OutsideRange {
        /// What would be sent.
        value: f64,
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// Another servo of the table has the id already.
    IdTaken {
        /// The id.
        id: u32,
        /// Whose it is: a joint's name, or that of an attachment.
        of: String,
    },
    /// The device is set up for less than the table asks for (device units).
    LimitsDiffer {
        /// What it is that differs.
        what: &'static str,
        /// What the table needs.
        needed: f64,
        /// What the device allows.
        allowed: f64,
    },
    /// The device is another one than the table says.
    WrongModel {
        /// What the table says.
        expected: String,
        /// What answers.
        got: String,
    },
    /// It was written several times, and is something else when it is read.
    Unheeded,
    /// Torque is off.
    TorqueOff,
    /// The servos have no power, so that the device does not know where they are: switching torque on gives it to them.
    PowerOff,
    /// The device's watchdog has stopped it, or it came back from being away: torque must be switched on anew.
    Interrupted,
    /// The device can't do that.
    Unsupported,
}

/// A fault that the device has latched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fault {
    /// The device's number for it.
    pub code: u8,
    /// What the number means.
    pub meaning: &'static str,
}

impl DriverError {
    /// Of the device as a whole.
    pub fn new(port: impl Into<String>, command: &'static str, cause: Cause) -> Self {
        Self { port: port.into(), joint: None, command, cause }
    }

    /// Of this joint.
    pub fn of_joint(mut self, joint: impl Into<String>) -> Self {
        self.joint = Some(joint.into());
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.meaning, self.code)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(error) => error.fmt(f),
            Self::Silent { waited } => write!(f, "no answer in {:.0} ms", waited.as_secs_f64() * 1e3),
            Self::Garbled => f.write_str("only broken answers"),
            Self::Refused { code, meaning } => write!(f, "refused: {meaning} ({code})"),
            Self::Fault(fault) => write!(f, "fault: {fault}"),
            Self::Unconfirmed { first, second } => {
                write!(f, "two readings differ: {first:.6} and {second:.6}")
            }
            Self::Length { expected, got } => write!(f, "{got} joint values where there are {expected}"),
            Self::OtherRobot { expected, got } => {
                write!(f, "checked for the table {got:016x}, but this arm's is {expected:016x}")
            }
            Self::OutsideRange { value, min, max } => {
                write!(f, "{value} is not in {min} to {max}, which the servo takes")
            }
            Self::IdTaken { id, of } => {
                write!(f, "the id {id} is that of {of}: each servo on a bus has its own")
            }
            Self::LimitsDiffer { what, needed, allowed } => {
                write!(f, "{what} is set to {allowed} in the device, the table needs {needed}")
            }
            Self::WrongModel { expected, got } => write!(f, "the table says {expected}, but it is {got}"),
            Self::Unheeded => f.write_str("written, but it does not stay so"),
            Self::TorqueOff => f.write_str("torque is off"),
            Self::PowerOff => f.write_str("the servos have no power"),
            Self::Interrupted => f.write_str("the device was stopped or away: switch torque on anew"),
            Self::Unsupported => f.write_str("the device can't do that"),
        }
    }
}

impl fmt::Display for DriverError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A port's error names the port itself.
        if !matches!(self.cause, Cause::Port(_)) {
            write!(f, "{}, ", self.port)?;
        }
        if let Some(joint) = &self.joint {
            write!(f, "{joint}, ")?;
        }
        write!(f, "{}: {}", self.command, self.cause)
    }
}

impl std::error::Error for DriverError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.cause {
            Cause::Port(error) => Some(error),
            _ => None,
        }
    }
}
