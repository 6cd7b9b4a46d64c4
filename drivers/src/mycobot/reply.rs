//! What replies mean. A reply has no checksum: all that can be asked of it is that its command is the one asked for,
//! that its size is one that the command has, and that its values can be.

use std::fmt;

use super::command::Command;
use super::frame::Frame;

/// Why a frame is no answer to the request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BadReply {
    /// It answers something else.
    Command {
        /// The command's byte.
        found: u8,
    },
    /// Its payload has a size that the command does not have.
    Size {
        /// How many bytes there are.
        found: usize,
        /// How many there may be.
        expected: &'static [usize],
    },
    /// A value that cannot be.
    Value {
        /// What was expected in its place.
        expected: &'static str,
        /// The payload.
        payload: Vec<u8>,
    },
}

impl fmt::Display for BadReply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Command { found } => match Command::of_byte(*found) {
                Some(command) => write!(f, "the reply is one to {command}"),
                None => write!(f, "the reply is one to 0x{found:02X}, which is no command"),
            },
            Self::Size { found, expected } => {
                write!(f, "the reply holds {found} bytes, where it has {expected:?}")
            }
            Self::Value { expected, payload } => write!(f, "the reply is {payload:02x?}, not {expected}"),
        }
    }
}

impl std::error::Error for BadReply {}

/// A reply whose command and size are right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    command: Command,
    payload: Vec<u8>,
}

impl Reply {
    /// Judges a frame that came after a request of this command.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn to(command: Command, frame: Frame) -> Result<Self, BadReply> {
        let expected = command.reply_sizes();
        if frame.command != command as u8 {
            Err(BadReply::Command { found: frame.command })
        } else if expected.contains(&frame.payload.len()) {
            Ok(Self { command, payload: frame.payload })
        } else {
            Err(BadReply::Size { found: frame.payload.len(), expected })
        }
    }

    /// What it answers.
    pub fn command(&self) -> Command {
        self.command
    }

    /// What it holds.
    pub fn payload(&self) -> &[u8] {
        &self.payload
    }

    /// One byte. Where two came, the first names the joint.
    ///
    /// # Errors
    /// Where there are more.
    pub fn byte(&self) -> Result<u8, BadReply> {
        match *self.payload {
            [value] | [_, value] => Ok(value),
            _ => Err(self.not("one byte")),
        }
    }

    /// Yes or no.
    ///
    /// # Errors
    /// Where it is neither.
    pub fn flag(&self) -> Result<bool, BadReply> {
        match self.byte()? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(self.not("0 or 1")),
        }
    }

    /// A number of 16 bits. Where three bytes came, the first names the joint.
    ///
    /// # Errors
    /// Where there are others.
    pub fn word(&self) -> Result<i16, BadReply> {
        match *self.payload {
            [high, low] | [_, high, low] => Ok(i16::from_be_bytes([high, low])),
            _ => Err(self.not("a number of two bytes")),
        }
    }

    /// A fixed count of numbers of 16 bits.
    ///
    /// # Errors
    /// Where there are more or fewer.
    pub fn words<const N: usize>(&self) -> Result<[i16; N], BadReply> {
        if self.payload.len() != 2 * N {
            return Err(self.not("the expected count of numbers of two bytes"));
        }
        let mut words = [0; N];
        for (word, pair) in words.iter_mut().zip(self.payload.chunks_exact(2)) {
            if let [high, low] = *pair {
                *word = i16::from_be_bytes([high, low]);
            }
        }
        Ok(words)
    }

    /// A fixed count of bytes.
    ///
    /// # Errors
    /// Where there are more or fewer.
    pub fn bytes<const N: usize>(&self) -> Result<[u8; N], BadReply> {
        <[u8; N]>::try_from(self.payload.as_slice()).map_err(|_| self.not("the expected count of bytes"))
    }

    /// Six joint angles (deg).
    ///
    /// # Errors
    /// Where there are more or fewer.
    pub fn angles(&self) -> Result<[f64; 6], BadReply> {
        Ok(self.words::<6>()?.map(hundredths))
    }

    /// x, y, z (mm), rx, ry, rz (deg).
    ///
    /// # Errors
    /// Where there are more or fewer.
    pub fn coordinates(&self) -> Result<[f64; 6], BadReply> {
        Ok(coordinates(self.words()?))
    }

    /// Angles (deg) and coordinates (mm, deg).
    ///
    /// # Errors
    /// Where there are more or fewer.
    pub fn angles_and_coordinates(&self) -> Result<([f64; 6], [f64; 6]), BadReply> {
        let [a, b, c, d, e, f, coords @ ..] = self.words::<12>()?;
        Ok(([a, b, c, d, e, f].map(hundredths), coordinates(coords)))
    }

    /// A limit of a joint (deg).
    ///
    /// # Errors
    /// Where it is no number.
    pub fn joint_limit(&self) -> Result<f64, BadReply> {
        Ok(f64::from(self.word()?) / 10.0)
    }

    /// A version, sent in tenths.
    ///
    /// # Errors
    /// Where it is no byte.
    pub fn version(&self) -> Result<f64, BadReply> {
        Ok(f64::from(self.byte()?) / 10.0)
    }

    fn not(&self, expected: &'static str) -> BadReply {
        BadReply::Value { expected, payload: self.payload.clone() }
    }
}

fn hundredths(word: i16) -> f64 {
    f64::from(word) / 100.0
}

fn tenths(word: i16) -> f64 {
    f64::from(word) / 10.0
}

fn coordinates([x, y, z, rx, ry, rz]: [i16; 6]) -> [f64; 6] {
    [tenths(x), tenths(y), tenths(z), hundredths(rx), hundredths(ry), hundredths(rz)]
}

/// What the arm says of itself and has latched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmError {
    /// A joint (from 1) is beyond its limit.
    Limit(u8),
    /// It ran into something; the maker's code, 16 to 19.
    Collision(u8),
    /// There are no joint angles for the coordinates.
    NoSolution,
    /// No joint angles near enough for a straight line; the maker's code, 33 or 34.
    NoAdjacentSolution(u8),
    /// A code that the maker does not explain.
    Other(u8),
}

impl ArmError {
    /// What a code of `get_error_information` means; 0 is no error.
    pub fn of_code(code: u8) -> Option<Self> {
        match code {
            0 => None,
            1..=6 => Some(Self::Limit(code)),
            16..=19 => Some(Self::Collision(code)),
            32 => Some(Self::NoSolution),
            33 | 34 => Some(Self::NoAdjacentSolution(code)),
            _ => Some(Self::Other(code)),
        }
    }

    /// The code.
    pub fn code(self) -> u8 {
        match self {
            Self::Limit(code)
            | Self::Collision(code)
            | Self::NoAdjacentSolution(code)
            | Self::Other(code) => code,
            Self::NoSolution => 32,
        }
    }
}

impl ArmError {
    /// The index of the joint that it is of.
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Limit(joint) => usize::from(joint).checked_sub(1),
            _ => None,
        }
    }

    /// What it means, in words.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Limit(_) => "beyond its limit",
            Self::Collision(_) => "collision protection",
            Self::NoSolution => "no joint angles for these coordinates",
            Self::NoAdjacentSolution(_) => "no joint angles near enough for a straight line",
            Self::Other(_) => "a code that the maker does not explain",
        }
    }
}

impl fmt::Display for ArmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Limit(joint) => write!(f, "joint {joint} is {}", self.meaning()),
            _ => write!(f, "{} ({})", self.meaning(), self.code()),
        }
    }
}
