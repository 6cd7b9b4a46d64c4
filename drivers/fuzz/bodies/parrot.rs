//! A device that answers everything with the same bytes.

use dh_drivers::clock::Time;
use dh_drivers::simulate::SimulatedDevice;
use std::collections::VecDeque;
use std::time::Duration;

#[derive(Debug)]
pub(crate) struct Parrot {
    bytes: Vec<u8>,
    due: VecDeque<Time>,
}

impl Parrot {
    pub(crate) fn saying(bytes: &[u8]) -> Self {
        Self { bytes: bytes.to_vec(), due: VecDeque::new() }
    }
}

impl SimulatedDevice for Parrot {
    fn receive(&mut self, _: &[u8], now: Time) {
        self.due.push_back(now + Duration::from_millis(1));
    }
    fn advance(&mut self, _: Time) {}
    fn next_send(&self) -> Option<Time> {
        self.due.front().copied()
    }
    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        self.due.front().filter(|time| **time <= now)?;
        self.due.pop_front().map(|_| self.bytes.clone())
    }
}
