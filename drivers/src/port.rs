//! Bytes to and from a device.
//!
//! A [`Port`] is the host's end of a line. What is on the other one is a real device ([`Serial`], [`Tcp`]), a simulated
//! one in the same process ([`SimulatedPort`](crate::simulate::SimulatedPort), which can be made to lose, delay, split,
//! corrupt and double what passes), or a recording ([`Recorded`]).

mod recorded;
mod serial;
mod tcp;

use crate::clock::{Clock, Time};
use std::fmt;
use std::sync::Arc;

pub use recorded::{Exchange, Recorded};
pub use serial::Serial;
pub use tcp::Tcp;

/// The host's end of a line to a device.
pub trait Port: fmt::Debug + Send {
    /// What errors call it: a path like `/dev/ttyUSB0`, `tcp:HOST:PORT`, or what a test named it.
    fn name(&self) -> &str;

    /// The clock that deadlines are read on.
    fn clock(&self) -> Arc<dyn Clock>;

    /// Sends all bytes.
    ///
    /// # Errors
    /// [`PortError`]; of what was sent then nothing is known.
    fn write_all(&mut self, bytes: &[u8], deadline: Time) -> Result<(), PortError>;

    /// Waits for bytes and takes those that are there: at least one, at most the buffer's length.
    ///
    /// # Errors
    /// [`PortErrorKind::TimedOut`] where none came before the deadline, at once if that is past and none are there.
    fn read(&mut self, buffer: &mut [u8], deadline: Time) -> Result<usize, PortError>;

    /// Throws away what has arrived and was not read.
    ///
    /// # Errors
    /// [`PortError`]
    fn discard_input(&mut self) -> Result<(), PortError>;

    /// Changes the rate (bits per second). Lines without one take any.
    ///
    /// # Errors
    /// [`PortError`]; the rate is the old one then.
    fn set_baud(&mut self, baud: u32) -> Result<(), PortError>;

    /// The rate (bits per second); `None` for lines without one.
    fn baud(&self) -> Option<u32>;

    /// Closes the line and opens it anew under its name and rate: the way back after [`PortErrorKind::Gone`].
    ///
    /// # Errors
    /// [`PortErrorKind::Gone`] as long as the device is away.
    fn reopen(&mut self) -> Result<(), PortError>;
}

/// What went wrong with a port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortError {
    /// The port's name.
    pub port: String,
    /// What happened.
    pub kind: PortErrorKind,
}

/// The kinds of [`PortError`].
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum PortErrorKind {
    /// Another program has it open.
    Busy,
    /// This user may not open it.
    Denied,
    /// There is no such device, or no longer.
    Gone,
    /// Nothing came, or nothing could be sent, before the deadline.
    TimedOut,
    /// The rate (bits per second) is none that the port can do.
    Baud(u32),
    /// What the operating system says.
    Io(String),
    /// A recording was sent something else than what it has next.
    NotRecorded(String),
}

impl PortError {
    /// Of the port of this name.
    pub fn new(port: impl Into<String>, kind: PortErrorKind) -> Self {
        Self { port: port.into(), kind }
    }

    /// What the operating system reports; devices that were unplugged become [`PortErrorKind::Gone`].
    pub fn from_io(port: &str, error: &std::io::Error) -> Self {
        use std::io::ErrorKind;
        // EIO, ENXIO and ENODEV: what a terminal answers whose device is away; they have no kind of their own.
        let away = cfg!(unix) && matches!(error.raw_os_error(), Some(5 | 6 | 19));
        let kind = match error.kind() {
            _ if away => PortErrorKind::Gone,
            ErrorKind::TimedOut | ErrorKind::WouldBlock => PortErrorKind::TimedOut,
            ErrorKind::NotFound
            | ErrorKind::BrokenPipe
            | ErrorKind::UnexpectedEof
            | ErrorKind::NotConnected
            | ErrorKind::ConnectionReset
            | ErrorKind::ConnectionAborted
            | ErrorKind::ConnectionRefused => PortErrorKind::Gone,
            ErrorKind::ResourceBusy => PortErrorKind::Busy,
            ErrorKind::PermissionDenied => PortErrorKind::Denied,
            _ => PortErrorKind::Io(error.to_string()),
        };
        Self::new(port, kind)
    }
}

impl fmt::Display for PortError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = &self.port;
        match &self.kind {
            PortErrorKind::Busy => write!(f, "{name} is in use by another program"),
            PortErrorKind::Gone if name.starts_with("tcp:") => {
                write!(f, "{name}: nobody answers, or somebody else has the line")
            }
            PortErrorKind::Gone => write!(f, "{name} is not there: is the device plugged in and powered?"),
            PortErrorKind::Denied => write!(
                f,
                "{name} may not be opened by this user: on Linux, be in the group that it belongs to (ls -l {name}), \
                 often dialout"
            ),
            PortErrorKind::TimedOut => write!(f, "{name}: time is up"),
            PortErrorKind::Baud(baud) => write!(f, "{name} has no rate of {baud} bits per second"),
            PortErrorKind::Io(message) => write!(f, "{name}: {message}"),
            PortErrorKind::NotRecorded(difference) => write!(f, "{name}: {difference}"),
        }
    }
}

impl std::error::Error for PortError {}

/// Opens a port by its name: `tcp:HOST:PORT`, or the path of a serial port.
///
/// # Errors
/// [`PortError`]
pub fn open(name: &str, baud: u32, clock: Arc<dyn Clock>) -> Result<Box<dyn Port>, PortError> {
    if name.is_empty() {
        return Err(PortError::new("\"\"", PortErrorKind::Io("a port has a name".to_owned())));
    }
    Ok(match name.strip_prefix("tcp:") {
        Some(address) => Box::new(Tcp::connect(address, clock)?),
        None => Box::new(Serial::open(name, baud, clock)?),
    })
}
