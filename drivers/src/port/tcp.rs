//! Lines over TCP: simulated devices where there is no pseudo-terminal, and serial servers.

use super::{Port, PortError, PortErrorKind};
use crate::clock::{Clock, Time};
use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::time::Duration;

/// A line over TCP. It has no rate, and takes any.
#[derive(Debug)]
pub struct Tcp {
    address: String,
    name: String,
    clock: Arc<dyn Clock>,
    stream: Option<TcpStream>,
}

/// How many buffers of 4 KiB are thrown away at once, at most.
const DISCARDED: usize = 64;

/// How long connecting may take.
const CONNECTING: Duration = Duration::from_secs(3);

impl Tcp {
    /// Connects to `HOST:PORT`.
    ///
    /// # Errors
    /// [`PortErrorKind::Gone`] where nobody answers, or what the operating system says.
    pub fn connect(address: &str, clock: Arc<dyn Clock>) -> Result<Self, PortError> {
        let name = format!("tcp:{address}");
        let stream = connect(address).map_err(|error| match error.kind() {
            io::ErrorKind::InvalidInput => {
                PortError::new(name.as_str(), PortErrorKind::Io("write tcp:HOST:PORT".to_owned()))
            }
            _ => PortError::from_io(&name, &error),
        })?;
        Ok(Self { address: address.to_owned(), name, clock, stream: Some(stream) })
    }

    /// Makes a step of reading or writing until one is done or time is up.
    fn until(
        &mut self,
        deadline: Time,
        mut step: impl FnMut(&mut TcpStream, Duration) -> io::Result<usize>,
    ) -> Result<usize, PortError> {
        let Self { name, clock, stream, .. } = self;
        let stream = stream.as_mut().ok_or_else(|| PortError::new(name.as_str(), PortErrorKind::Gone))?;
        loop {
            // The operating system takes no zero; a microsecond still takes what is there.
            let left =
                deadline.since(clock.now()).clamp(Duration::from_micros(1), Duration::from_secs(1 << 30));
            match step(stream, left) {
                Ok(0) => return Err(PortError::new(name.as_str(), PortErrorKind::Gone)),
                Ok(count) => return Ok(count),
                Err(error) if error.kind() == io::ErrorKind::Interrupted && clock.now() < deadline => {}
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {
                    return Err(PortError::new(name.as_str(), PortErrorKind::TimedOut));
                }
                Err(error) => return Err(PortError::from_io(name, &error)),
            }
        }
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut failure = io::Error::new(io::ErrorKind::NotFound, "the name has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECTING) {
            Ok(stream) => {
                // Requests are small and wait for their answers: nothing is gained by gathering them.
                stream.set_nodelay(true)?;
                return Ok(stream);
            }
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

/// Takes what has arrived. A time-out, however short, would be waited for a tick of the operating system's clock.
fn drain(stream: &mut TcpStream) -> io::Result<()> {
    stream.set_nonblocking(true)?;
    let mut buffer = [0; 4096];
    let mut outcome = Ok(());
    // Somebody who sends without end is not waited for.
    for _ in 0..DISCARDED {
        match stream.read(&mut buffer) {
            Ok(0) => outcome = Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(_) => continue,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => outcome = Err(error),
        }
        break;
    }
    stream.set_nonblocking(false)?;
    outcome
}

impl Port for Tcp {
    fn name(&self) -> &str {
        &self.name
    }

    fn clock(&self) -> Arc<dyn Clock> {
        Arc::clone(&self.clock)
    }

    fn write_all(&mut self, bytes: &[u8], deadline: Time) -> Result<(), PortError> {
        let mut rest = bytes;
        while !rest.is_empty() {
            let count = self.until(deadline, |stream, left| {
                stream.set_write_timeout(Some(left))?;
                stream.write(rest)
            })?;
            rest = rest.get(count..).unwrap_or_default();
        }
        Ok(())
    }

    fn read(&mut self, buffer: &mut [u8], deadline: Time) -> Result<usize, PortError> {
        self.until(deadline, |stream, left| {
            stream.set_read_timeout(Some(left))?;
            stream.read(buffer)
        })
    }

    fn discard_input(&mut self) -> Result<(), PortError> {
        let Self { name, stream, .. } = self;
        let stream = stream.as_mut().ok_or_else(|| PortError::new(name.as_str(), PortErrorKind::Gone))?;
        drain(stream).map_err(|error| PortError::from_io(name, &error))
    }

    fn set_baud(&mut self, _baud: u32) -> Result<(), PortError> {
        Ok(())
    }

    fn baud(&self) -> Option<u32> {
        None
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        self.stream = None;
        self.stream = Some(connect(&self.address).map_err(|error| PortError::from_io(&self.name, &error))?);
        Ok(())
    }
}
