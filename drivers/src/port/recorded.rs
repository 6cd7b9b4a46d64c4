//! A port that plays a recording.

use super::{Port, PortError, PortErrorKind};
use crate::clock::{Clock, Time};
use std::collections::VecDeque;
use std::io::Read;
use std::sync::Arc;

/// A request and what was answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Exchange {
    /// What the host sends, with one write.
    pub request: Vec<u8>,
    /// What it gets; nothing for silence.
    pub reply: Vec<u8>,
}

/// A port whose device expects certain requests in a certain order and answers each in a certain way.
#[derive(Debug)]
pub struct Recorded {
    clock: Arc<dyn Clock>,
    exchanges: VecDeque<Exchange>,
    input: VecDeque<u8>,
}

const NAME: &str = "recording";

impl Recorded {
    /// Plays these exchanges.
    pub fn new(clock: Arc<dyn Clock>, exchanges: impl IntoIterator<Item = Exchange>) -> Self {
        Self { clock, exchanges: exchanges.into_iter().collect(), input: VecDeque::new() }
    }

    /// How many requests have not come yet.
    pub fn remaining(&self) -> usize {
        self.exchanges.len()
    }
}

impl Port for Recorded {
    fn name(&self) -> &str {
        NAME
    }

    fn clock(&self) -> Arc<dyn Clock> {
        Arc::clone(&self.clock)
    }

    fn write_all(&mut self, bytes: &[u8], _deadline: Time) -> Result<(), PortError> {
        let recorded = self.exchanges.front().map(|next| next.request.as_slice()).unwrap_or_default();
        if recorded != bytes {
            let difference = format!("{bytes:02x?} was sent, where {recorded:02x?} is recorded");
            return Err(PortError::new(NAME, PortErrorKind::NotRecorded(difference)));
        }
        self.input.extend(self.exchanges.pop_front().map(|next| next.reply).unwrap_or_default());
        Ok(())
    }

    fn read(&mut self, buffer: &mut [u8], deadline: Time) -> Result<usize, PortError> {
        if self.input.is_empty() {
            self.clock.sleep_until(deadline);
            return Err(PortError::new(NAME, PortErrorKind::TimedOut));
        }
        self.input.read(buffer).map_err(|error| PortError::from_io(NAME, &error))
    }

    fn discard_input(&mut self) -> Result<(), PortError> {
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
        Ok(())
    }
}
