//! The line between a program and a simulated device in the same process.

use super::SimulatedDevice;
use crate::clock::{Clock, Time};
use crate::port::{Port, PortError, PortErrorKind};
use std::collections::VecDeque;
use std::io::Read;
use std::sync::{Arc, Mutex, PoisonError};

/// A port with a simulated device behind it.
///
/// Nothing happens behind the back of who reads: a read asks the device what it sends next, waits until then on the
/// clock, and takes it. On a [`VirtualClock`](crate::clock::VirtualClock) that makes a run the same every time.
///
/// The device is shared, so that a test can look at it while a driver has the port.
#[derive(Debug)]
pub struct SimulatedPort<D> {
    device: Arc<Mutex<D>>,
    clock: Arc<dyn Clock>,
    input: VecDeque<u8>,
    /// Set when the line was found pulled: it must be opened anew, even if the device is back by then.
    closed: bool,
}

const NAME: &str = "simulated";

impl<D: SimulatedDevice> SimulatedPort<D> {
    /// Joins them.
    pub fn new(device: Arc<Mutex<D>>, clock: Arc<dyn Clock>) -> Self {
        Self { device, clock, input: VecDeque::new(), closed: false }
    }

    /// Does something with the device at the present time, if it is connected.
    fn with<T>(&mut self, act: impl FnOnce(&mut D, Time) -> T) -> Result<T, PortError> {
        let now = self.clock.now();
        let mut device = self.device.lock().unwrap_or_else(PoisonError::into_inner);
        if self.closed || !device.connected(now) {
            self.closed = true;
            self.input.clear();
            return Err(PortError::new(NAME, PortErrorKind::Gone));
        }
        Ok(act(&mut device, now))
    }

    /// Takes what has been sent by now, and says when more will come.
    fn collect(&mut self) -> Result<Option<Time>, PortError> {
        let (sent, next) = self.with(|device, now| {
            device.advance(now);
            let sent: Vec<u8> = std::iter::from_fn(|| device.send(now)).flatten().collect();
            (sent, device.next_send())
        })?;
        self.input.extend(sent);
        Ok(next)
    }
}

impl<D: SimulatedDevice> Port for SimulatedPort<D> {
    fn name(&self) -> &str {
        NAME
    }

    fn clock(&self) -> Arc<dyn Clock> {
        Arc::clone(&self.clock)
    }

    fn write_all(&mut self, bytes: &[u8], _deadline: Time) -> Result<(), PortError> {
        self.with(|device, now| device.receive(bytes, now))
    }

    fn read(&mut self, buffer: &mut [u8], deadline: Time) -> Result<usize, PortError> {
        let mut next = self.collect()?;
        while self.input.is_empty() {
            let now = self.clock.now();
            if now >= deadline {
                return Err(PortError::new(NAME, PortErrorKind::TimedOut));
            }
            self.clock.sleep_until(next.unwrap_or(deadline).min(deadline));
            next = self.collect()?;
        }
        self.input.read(buffer).map_err(|error| PortError::from_io(NAME, &error))
    }

    fn discard_input(&mut self) -> Result<(), PortError> {
        self.collect()?;
        self.input.clear();
        Ok(())
    }

    fn set_baud(&mut self, _baud: u32) -> Result<(), PortError> {
        Ok(())
    }

    fn baud(&self) -> Option<u32> {
        None
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        self.closed = false;
        self.discard_input()
    }
}
