//! Requests and replies on a line that protects neither.
//!
//! There is one request in flight. Before each the line must have been quiet, so that no late or doubled reply is
//! taken for the next one's; after trouble it must have been quiet for longer than a reply takes. What is no answer to
//! the request is passed over.

use std::sync::Arc;
use std::time::Duration;

use super::command::Command;
use super::frame::FrameReader;
use super::reply::{BadReply, Reply};
use super::request::Request;
use crate::clock::{Clock, Time};
use crate::driver::{Cause, DriverError};
use crate::port::{Port, PortError, PortErrorKind};

/// How long a reply may take. The arm's comes within 100 ms; a client that waits longer than 500 has lost it.
const REPLY: Duration = Duration::from_millis(250);
/// How long the line is quiet before a request.
const QUIET: Duration = Duration::from_millis(2);
/// The same after trouble: whatever is still on its way has come by then.
const RESYNC: Duration = Duration::from_millis(100);
/// A line that is not quiet for so long never is.
const BABBLE: Duration = Duration::from_millis(400);
/// After a gap of this length within a frame, the rest does not come any more.
const GAP: Duration = Duration::from_millis(100);
/// How often a request is sent, if it may be sent again.
const TRIES: usize = 3;
/// How often something is asked at most until two answers are alike.
const READINGS: usize = 5;

/// What happened on the line so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LineCounts {
    /// Requests sent, repeated ones included.
    pub requests: u64,
    /// Requests that were sent again.
    pub repeated: u64,
    /// Frames that answered nothing that was asked.
    pub strays: u64,
    /// Bytes that were part of no frame.
    pub garbage: u64,
    /// Values that could not be: outside the limits, faster than the joint moves, unlike the next reading.
    pub rejected: u64,
}

/// One end of the line.
#[derive(Debug)]
pub(super) struct Link {
    port: Box<dyn Port>,
    clock: Arc<dyn Clock>,
    reader: FrameReader,
    /// The device is away: the port must be opened anew.
    gone: bool,
    /// Something came that should not have, or did not come that should: see [`RESYNC`].
    trouble: bool,
    /// When the present call must be over.
    deadline: Time,
    pub(super) counts: LineCounts,
}

impl Link {
    pub(super) fn new(port: Box<dyn Port>) -> Self {
        let clock = port.clock();
        Self {
            port,
            clock,
            reader: FrameReader::default(),
            gone: false,
            trouble: true,
            deadline: Time::NEVER,
            counts: LineCounts::default(),
        }
    }

    pub(super) fn name(&self) -> &str {
        self.port.name()
    }

    pub(super) fn clock(&self) -> Arc<dyn Clock> {
        Arc::clone(&self.clock)
    }

    pub(super) fn is_gone(&self) -> bool {
        self.gone
    }

    /// Opens the port anew.
    pub(super) fn reopen(&mut self, command: &'static str) -> Result<(), DriverError> {
        self.port
            .reopen()
            .map_err(|error| DriverError::new(self.port.name(), command, Cause::Port(error)))?;
        self.gone = false;
        self.trouble = true;
        Ok(())
    }

    /// From now on, all requests together have so much time.
    pub(super) fn begin(&mut self, time: Duration) {
        self.deadline = self.clock.now() + time;
    }

    /// What went wrong with this request.
    pub(super) fn error(&self, request: &Request, cause: Cause) -> DriverError {
        let error = DriverError::new(self.name(), request.command().name(), cause);
        match request.joint() {
            Some(joint) => error.of_joint(format!("J{joint}")),
            None => error,
        }
    }

    /// Sends a request, again if need be and allowed, until a reply comes that can be read.
    pub(super) fn ask<T>(
        &mut self,
        request: &Request,
        read: impl Fn(&Reply) -> Result<T, BadReply>,
    ) -> Result<T, DriverError> {
        let tries = if request.command().is_repeatable() { TRIES } else { 1 };
        let start = self.clock.now();
        let mut garbled = false;
        for attempt in 0..tries {
            if self.clock.now() >= self.deadline {
                break;
            }
            self.counts.repeated += u64::from(attempt > 0);
            self.await_quiet()
                .and_then(|()| self.write(request))
                .map_err(|error| self.failed(request, error))?;
            let left = self.deadline.since(self.clock.now()).min(REPLY);
            match self.await_reply(request.command(), left).map_err(|error| self.failed(request, error))? {
                Ok(reply) => match read(&reply) {
                    Ok(value) => {
                        // The replies to the earlier ones may still come.
                        self.trouble |= attempt > 0;
                        return Ok(value);
                    }
                    Err(_) => garbled = true,
                },
                Err(something_came) => garbled |= something_came,
            }
            self.trouble = true;
        }
        let cause =
            if garbled { Cause::Garbled } else { Cause::Silent { waited: self.clock.now().since(start) } };
        Err(self.error(request, cause))
    }

    /// Has a request acknowledged. A refusal counts when it comes twice: one may be a broken acknowledgement.
    pub(super) fn acknowledge(&mut self, request: &Request) -> Result<(), DriverError> {
        let mut refusal = None;
        let readings = if request.command().is_repeatable() { READINGS } else { 1 };
        for _ in 0..readings {
            match self.ask(request, Reply::byte)? {
                1 => return Ok(()),
                code if refusal == Some(code) => break,
                code => refusal = Some(code),
            }
            self.counts.rejected += 1;
        }
        let meaning = "it does not acknowledge with 1";
        Err(self.error(request, Cause::Refused { code: refusal.unwrap_or_default(), meaning }))
    }

    /// Asks until two answers in a row are alike: for what something depends on. Else the last two.
    pub(super) fn agreeing<T: Copy>(
        &mut self,
        request: &Request,
        read: impl Fn(&Reply) -> Result<T, BadReply>,
        alike: impl Fn(&T, &T) -> bool,
    ) -> Result<Result<T, (T, T)>, DriverError> {
        let mut last = self.ask(request, &read)?;
        let mut pair = (last, last);
        for _ in 1..READINGS {
            let next = self.ask(request, &read)?;
            if alike(&last, &next) {
                return Ok(Ok(next));
            }
            self.counts.rejected += 1;
            pair = (last, next);
            last = next;
        }
        Ok(Err(pair))
    }

    /// The same for a byte.
    pub(super) fn confirm(
        &mut self,
        request: &Request,
        read: impl Fn(&Reply) -> Result<u8, BadReply>,
    ) -> Result<u8, DriverError> {
        self.agreeing(request, read, |a, b| a == b)?.map_err(|(first, second)| {
            let (first, second) = (f64::from(first), f64::from(second));
            self.error(request, Cause::Unconfirmed { first, second })
        })
    }

    /// Sends a request at once, whatever is on the line, and as often as time allows until it is acknowledged: for
    /// emergencies.
    pub(super) fn insist(&mut self, request: &Request) -> Result<(), DriverError> {
        let start = self.clock.now();
        let mut last = Cause::Silent { waited: Duration::ZERO };
        while self.clock.now() < self.deadline {
            let sent = self.port.discard_input().and_then(|()| self.write(request));
            let reply = sent.and_then(|()| self.await_reply(request.command(), GAP));
            self.trouble = true;
            match reply.map_err(|error| self.failed(request, error))? {
                Ok(reply) if reply.byte() == Ok(1) => return Ok(()),
                Ok(_) | Err(true) => last = Cause::Garbled,
                Err(false) => last = Cause::Silent { waited: self.clock.now().since(start) },
            }
        }
        Err(self.error(request, last))
    }

    fn failed(&mut self, request: &Request, error: PortError) -> DriverError {
        self.gone |= error.kind != PortErrorKind::TimedOut;
        self.error(request, Cause::Port(error))
    }

    fn write(&mut self, request: &Request) -> Result<(), PortError> {
        self.counts.requests += 1;
        self.forget();
        self.port.write_all(&request.encode(), self.clock.now() + REPLY)
    }

    /// Drops what has begun to come in.
    fn forget(&mut self) {
        self.counts.garbage += self.reader.pending() as u64;
        self.reader = FrameReader::default();
    }

    /// Waits until nothing has come for a while.
    fn await_quiet(&mut self) -> Result<(), PortError> {
        let silence = if self.trouble { RESYNC } else { QUIET };
        let end = (self.clock.now() + BABBLE).min(self.deadline.max(self.clock.now() + QUIET));
        let mut buffer = [0; 256];
        loop {
            let until = (self.clock.now() + silence).min(end);
            match self.port.read(&mut buffer, until) {
                Ok(count) => self.counts.garbage += count as u64,
                Err(error) if error.kind == PortErrorKind::TimedOut => break,
                Err(error) => return Err(error),
            }
            if self.clock.now() >= end {
                break;
            }
        }
        self.trouble = false;
        Ok(())
    }

    /// The first frame that answers the command; else whether anything came.
    fn await_reply(&mut self, command: Command, time: Duration) -> Result<Result<Reply, bool>, PortError> {
        let deadline = self.clock.now() + time;
        let mut buffer = [0; 64];
        let mut something_came = false;
        loop {
            let begun = self.reader.pending() > 0;
            let until = if begun { deadline.min(self.clock.now() + GAP) } else { deadline };
            let over = match self.port.read(&mut buffer, until) {
                Ok(count) => {
                    something_came = true;
                    self.reader.push(buffer.get(..count).unwrap_or_default());
                    // A line that never falls silent does not make it wait any longer.
                    self.clock.now() > deadline
                }
                Err(error) if error.kind == PortErrorKind::TimedOut => true,
                Err(error) => return Err(error),
            };
            while let Some(frame) = if over { self.reader.next_after_gap() } else { self.reader.next_frame() }
            {
                if let Ok(reply) = Reply::to(command, frame) {
                    self.settle();
                    return Ok(Ok(reply));
                }
                self.counts.strays += 1;
                self.trouble = true;
            }
            if over && self.clock.now() >= deadline {
                self.settle();
                return Ok(Err(something_came));
            }
        }
    }

    /// Counts what was dropped on the way to a reply.
    fn settle(&mut self) {
        self.counts.garbage += self.reader.skipped();
        self.trouble |= self.reader.skipped() > 0 || self.reader.pending() > 0;
        self.forget();
    }
}
