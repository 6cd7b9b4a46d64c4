//! Serial ports.

use super::{Port, PortError, PortErrorKind};
use crate::clock::{Clock, Time};
use serialport::{ClearBuffer, ErrorKind, SerialPort};
use std::io::{self, Read, Write};
use std::sync::Arc;
use std::time::Duration;

/// A serial port, 8N1 without flow control, that no other program can open meanwhile: the crate `serialport` sets
/// TIOCEXCL, which does not bind root, and takes an flock, which binds those who ask for one.
#[derive(Debug)]
pub struct Serial {
    path: String,
    baud: u32,
    clock: Arc<dyn Clock>,
    /// None after a failed [`Port::reopen`].
    line: Option<Box<dyn SerialPort>>,
}

impl Serial {
    /// Opens the port at this rate (bits per second).
    ///
    /// # Errors
    /// [`PortErrorKind::Busy`], [`PortErrorKind::Gone`], or what the operating system says.
    pub fn open(path: impl Into<String>, baud: u32, clock: Arc<dyn Clock>) -> Result<Self, PortError> {
        let path = path.into();
        let line = Some(open(&path, baud)?);
        Ok(Self { path, baud, clock, line })
    }

    /// Makes a step of reading or writing until one is done or time is up. Signals interrupt steps, and a step that
    /// moves nothing says that the device is away.
    fn until(
        &mut self,
        deadline: Time,
        mut step: impl FnMut(&mut Box<dyn SerialPort>) -> io::Result<usize>,
    ) -> Result<usize, PortError> {
        let Self { path, clock, line, .. } = self;
        let line = line.as_mut().ok_or_else(|| PortError::new(path.as_str(), PortErrorKind::Gone))?;
        loop {
            // A wait of zero still takes what is there. Later than years is as good as never.
            let left = deadline.since(clock.now()).min(Duration::from_secs(1 << 30));
            line.set_timeout(left).map_err(|error| from_serial(path, &error))?;
            match step(line) {
                Ok(0) => return Err(PortError::new(path.as_str(), PortErrorKind::Gone)),
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::Interrupted && !left.is_zero() => {}
                Err(error) => return Err(from_open(path, &error)),
            }
        }
    }
}

/// Errors of a line that is open: those without a kind are EIO, ENXIO and the like, what a terminal says whose device
/// was unplugged.
fn from_open(path: &str, error: &io::Error) -> PortError {
    match error.kind() {
        io::ErrorKind::Other => PortError::new(path, PortErrorKind::Gone),
        io::ErrorKind::Interrupted => PortError::new(path, PortErrorKind::TimedOut),
        _ => PortError::from_io(path, error),
    }
}

fn from_serial(path: &str, error: &serialport::Error) -> PortError {
    let kind = match error.kind() {
        // What is meant is a device that someone else holds; some systems say the same of one that is not there.
        ErrorKind::NoDevice if std::fs::exists(path).unwrap_or(false) => PortErrorKind::Busy,
        ErrorKind::NoDevice | ErrorKind::Io(io::ErrorKind::NotFound) => PortErrorKind::Gone,
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => PortErrorKind::Denied,
        _ => PortErrorKind::Io(format!("it can't be used as a serial port: {}", error.description)),
    };
    PortError::new(path, kind)
}

fn open(path: &str, baud: u32) -> Result<Box<dyn SerialPort>, PortError> {
    let line = serialport::new(path, baud).timeout(Duration::ZERO).open();
    let line = line.map_err(|error| from_serial(path, &error))?;
    line.clear(ClearBuffer::Input).map_err(|error| from_serial(path, &error))?;
    Ok(line)
}

impl Port for Serial {
    fn name(&self) -> &str {
        &self.path
    }

    fn clock(&self) -> Arc<dyn Clock> {
        Arc::clone(&self.clock)
    }

    fn write_all(&mut self, bytes: &[u8], deadline: Time) -> Result<(), PortError> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let count = self.until(deadline, |line| line.write(rest))?;
            rest = rest.get(count..).unwrap_or_default();
        }
        Ok(())
    }

    fn read(&mut self, buffer: &mut [u8], deadline: Time) -> Result<usize, PortError> {
        self.until(deadline, |line| line.read(buffer))
    }

    fn discard_input(&mut self) -> Result<(), PortError> {
        let gone = || PortError::new(self.path.as_str(), PortErrorKind::Gone);
        let line = self.line.as_mut().ok_or_else(gone)?;
        line.clear(ClearBuffer::Input).map_err(|_| gone())
    }

    fn set_baud(&mut self, baud: u32) -> Result<(), PortError> {
        let gone = || PortError::new(self.path.as_str(), PortErrorKind::Gone);
        let line = self.line.as_mut().ok_or_else(gone)?;
        line.set_baud_rate(baud)
            .map_err(|_| PortError::new(self.path.as_str(), PortErrorKind::Baud(baud)))?;
        self.baud = baud;
        Ok(())
    }

    fn baud(&self) -> Option<u32> {
        Some(self.baud)
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        // Closed first: it is opened exclusively.
        self.line = None;
        self.line = Some(open(&self.path, self.baud)?);
        Ok(())
    }
}
