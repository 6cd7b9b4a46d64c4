//! Simulated devices for other programs.

#[cfg(unix)]
mod pty;
mod tcp;

use super::SimulatedDevice;
use crate::clock::Clock;
use std::fmt;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

#[cfg(unix)]
pub use pty::Pty;
pub use tcp::TcpLine;

/// The device's end of a line that other programs can open.
pub trait Line: fmt::Debug {
    /// What they open: see [`port::open`](crate::port::open).
    fn name(&self) -> String;

    /// Waits for bytes, at most so long; 0 where none came.
    ///
    /// # Errors
    /// Where the line itself is broken. That nobody has opened it is no error.
    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize>;

    /// Sends with one write. What nobody takes is lost, as on a wire.
    ///
    /// # Errors
    /// Where the line itself is broken.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// How long it takes at most until a request to stop is heard.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs the device on the line until it is told to stop.
///
/// # Errors
/// Where the line is broken.
pub fn serve(
    device: &mut dyn SimulatedDevice,
    line: &mut dyn Line,
    clock: &dyn Clock,
    stop: &AtomicBool,
) -> io::Result<()> {
    let mut buffer = [0; 4096];
    while !stop.load(Ordering::Relaxed) {
        let now = clock.now();
        device.advance(now);
        while let Some(bytes) = device.send(now) {
            line.send(&bytes)?;
        }
        let wait = device.next_send().map_or(PATIENCE, |time| (time - now).min(PATIENCE));
        let count = line.receive(&mut buffer, wait)?;
        if count > 0 {
            device.receive(buffer.get(..count).unwrap_or_default(), clock.now());
        }
    }
    Ok(())
}
