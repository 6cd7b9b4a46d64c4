//! A line over TCP, for one program at a time.

use super::Line;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

/// A line that programs open as `tcp:HOST:PORT`. The next one is let in when the one before has gone.
#[derive(Debug)]
pub struct TcpLine {
    listener: TcpListener,
    address: SocketAddr,
    stream: Option<TcpStream>,
}

/// Somebody who takes nothing for so long is gone.
const UNREAD: Duration = Duration::from_secs(1);

/// How often it is looked whether somebody comes.
const LISTENING: Duration = Duration::from_millis(10);

impl TcpLine {
    /// Listens, for instance on `127.0.0.1:0`: on any port that is free.
    ///
    /// # Errors
    /// Where it cannot.
    pub fn bind(address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        Ok(Self { listener, address, stream: None })
    }

    fn let_in(&mut self, timeout: Duration) -> io::Result<()> {
        match self.listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false)?;
                stream.set_nodelay(true)?;
                stream.set_write_timeout(Some(UNREAD))?;
                self.stream = Some(stream);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(timeout.min(LISTENING)),
            Err(error) => return Err(error),
        }
        Ok(())
    }
}

impl Line for TcpLine {
    fn name(&self) -> String {
        format!("tcp:{}", self.address)
    }

    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let Some(stream) = &mut self.stream else {
            self.let_in(timeout)?;
            return Ok(0);
        };
        // A line has one end: whoever comes while it is taken is sent away, and sees that at once.
        drop(self.listener.accept());
        stream.set_read_timeout(Some(timeout.max(Duration::from_micros(1))))?;
        match stream.read(buffer) {
            Ok(count) if count > 0 => return Ok(count),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                return Ok(0);
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => return Ok(0),
            // Gone: the next may come.
            Ok(_) | Err(_) => self.stream = None,
        }
        Ok(0)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let lost = self.stream.as_mut().is_some_and(|stream| stream.write_all(bytes).is_err());
        if lost {
            self.stream = None;
        }
        Ok(())
    }
}
