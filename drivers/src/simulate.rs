//! Devices that are not there.
//!
//! A [`SimulatedDevice`] takes bytes and gives bytes, at times that it is told. What joins it to a program is a
//! [`SimulatedPort`] within one process, on any clock, or, for other programs, a [`Line`] that it is [`serve`]d on. [`Faulty`] wraps
//! a device and makes its line a bad one. [`Trapezoid`] moves what a device moves.

mod faulty;
mod port;
mod serve;
mod trapezoid;

use crate::clock::Time;
use std::fmt;

pub use faulty::{Faults, Faulty, Injected};
pub use port::SimulatedPort;
#[cfg(unix)]
pub use serve::Pty;
pub use serve::{Line, TcpLine, serve};
pub use trapezoid::Trapezoid;

/// A device made of code: what is on the other end of a line.
///
/// It owns no clock and no thread. It is told what time it is with every call, and times never go back.
pub trait SimulatedDevice: fmt::Debug + Send {
    /// Bytes have arrived, all with one write of the host's or several glued together.
    fn receive(&mut self, bytes: &[u8], now: Time);

    /// Brings everything that moves or times out to where it is now. The other calls do so by themselves.
    fn advance(&mut self, now: Time);

    /// When it next has something to send; `None` as long as nothing is due.
    fn next_send(&self) -> Option<Time>;

    /// What it sends with one write, if its time has come; to be called until it gives nothing.
    fn send(&mut self, now: Time) -> Option<Vec<u8>>;

    /// Whether the line is there; one that was pulled neither takes nor gives bytes.
    fn connected(&self, now: Time) -> bool {
        let _ = now;
        true
    }
}

impl<D: SimulatedDevice + ?Sized> SimulatedDevice for Box<D> {
    fn receive(&mut self, bytes: &[u8], now: Time) {
        (**self).receive(bytes, now);
    }
    fn advance(&mut self, now: Time) {
        (**self).advance(now);
    }
    fn next_send(&self) -> Option<Time> {
        (**self).next_send()
    }
    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        (**self).send(now)
    }
    fn connected(&self, now: Time) -> bool {
        (**self).connected(now)
    }
}
