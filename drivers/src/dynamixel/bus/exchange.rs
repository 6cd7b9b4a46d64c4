//! Asking, and telling answers from what only looks like one.

use super::echo::{Echo, PINGED};
use super::{Answer, Bus};
use crate::clock::Time;
use crate::driver::{Cause, DriverError};
use crate::dynamixel::instruction;
use crate::dynamixel::packet::{BROADCAST, Packet};
use crate::dynamixel::status::{CRC_ERROR, Status};
use crate::port::{PortError, PortErrorKind};
use std::time::Duration;

/// After the deadline so many more reads take what had arrived by then: 4 KiB, which is what terminals keep.
const LATE_READS: u32 = 8;

/// A request, and who is to answer it with how many bytes of data.
#[derive(Debug)]
pub(super) struct Request {
    pub(super) command: &'static str,
    pub(super) packet: Packet,
    pub(super) expected: Vec<(u8, usize)>,
    /// All answers come in one packet.
    pub(super) fast: bool,
    /// Whether it may be sent again where no answer came: doing it twice is as good as once.
    pub(super) again: bool,
}

/// Why an attempt brought no answer.
#[derive(Debug)]
enum Miss {
    Port(PortError),
    /// No sound answer of these: who is first among them, and whether something broken came.
    Silent(Option<u8>, bool),
}

impl Bus {
    /// Asks until there is an answer that is one to this question.
    pub(super) fn exchange(&mut self, request: &Request) -> Result<Vec<Answer>, DriverError> {
        let Request { command, ref expected, .. } = *request;
        let pinged = request.packet.instruction == instruction::PING;
        let shape = |(id, length): &(u8, usize)| (*id, if pinged { PINGED } else { *length });
        let shapes: Vec<(u8, usize)> = expected.iter().map(shape).collect();
        self.restore(command)?;
        let start = self.port.clock().now();
        let silent = Cause::Silent { waited: Duration::ZERO };
        let mut miss = (None, silent.clone());
        for _ in 0..self.timing.attempts.max(1) {
            if self.echo.may_answer(&shapes) && !self.clear(command, &shapes)? {
                miss = (expected.first().map(|(id, _)| *id), silent.clone());
                continue;
            }
            let sent = self.port.clock().now();
            match self.attempt(request) {
                Err(Miss::Port(error)) => return Err(self.failed(command, error)),
                Err(Miss::Silent(id, broken)) => {
                    self.echo.missed(&shapes);
                    miss = (id, if broken { Cause::Garbled } else { silent.clone() });
                    if !request.again {
                        break;
                    }
                }
                Ok(statuses) => {
                    let refused = statuses.iter().find(|status| status.error.code() != 0);
                    let Some(refused) = refused else {
                        self.echo = Echo::of(shapes);
                        self.heard = Some(sent);
                        return Ok(statuses.into_iter().map(answer).collect());
                    };
                    let (id, error) = (Some(refused.id), refused.error);
                    let refusal = Cause::Refused { code: error.code(), meaning: error.meaning() };
                    // The request was damaged on its way, or an earlier one was refused twice.
                    let (damaged, doubtful) = (error.code() == CRC_ERROR, self.echo.may_refuse());
                    self.echo.missed(&shapes);
                    if !(damaged || doubtful) || !request.again {
                        return Err(self.error(command, id, refusal));
                    }
                    miss = (id, if damaged { refusal } else { Cause::Garbled });
                }
            }
        }
        let waited = self.port.clock().now() - start;
        let (id, cause) = miss;
        let cause = if let Cause::Silent { .. } = cause { Cause::Silent { waited } } else { cause };
        Err(self.error(command, id, cause))
    }

    /// Asks once.
    fn attempt(&mut self, request: &Request) -> Result<Vec<Status>, Miss> {
        let expected = &request.expected;
        let lengths: Vec<usize> = expected.iter().map(|(_, length)| *length).collect();
        let sent = request.packet.encode().len();
        let deadline = self.port.clock().now() + self.timeout(sent, &lengths);
        let broken = self.decoder.broken();
        self.send(&request.packet, deadline).map_err(Miss::Port)?;
        let mut found: Vec<Option<Status>> = vec![None; expected.len()];
        let outcome = self.listen(deadline, |packet| {
            if request.fast {
                let statuses = Status::of_fast_packet(&packet, &lengths).filter(|statuses| {
                    packet.id == BROADCAST
                        && statuses.iter().map(|status| status.id).eq(expected.iter().map(|(id, _)| *id))
                });
                let Some(statuses) = statuses else { return false };
                found = statuses.into_iter().map(Some).collect();
                return true;
            }
            let Some(status) = Status::of_packet(&packet) else { return false };
            let place = expected.iter().position(|(id, length)| {
                // What is refused comes without data.
                let refused = status.error.code() != 0 && status.data.is_empty();
                *id == status.id && (*length == status.data.len() || refused)
            });
            let Some(place) = place else { return false };
            if let Some(slot) = found.get_mut(place) {
                *slot = Some(status);
            }
            // Servos answer in order: after the last one no other comes.
            place + 1 == expected.len()
        });
        outcome.map_err(Miss::Port)?;
        let missing = found.iter().position(Option::is_none);
        if let Some(place) = missing {
            let id = expected.get(place).map(|(id, _)| *id);
            return Err(Miss::Silent(id, self.decoder.broken() > broken));
        }
        Ok(found.into_iter().flatten().collect())
    }

    /// Pushes out what earlier requests may still bring, with a read that they can't have asked for. Whether its answer
    /// came.
    fn clear(&mut self, command: &'static str, expected: &[(u8, usize)]) -> Result<bool, DriverError> {
        let Some((id, _)) = expected.first() else { return Ok(true) };
        let length = self.echo.other_length(*id, expected);
        let sent = self.port.clock().now();
        let deadline = sent + self.timeout(14, &[length]);
        let outcome = self.send(&instruction::read(*id, 0, length as u16), deadline).and_then(|()| {
            let mut came = false;
            self.listen(deadline, |packet| {
                came = Status::of_packet(&packet).is_some_and(|status| {
                    status.id == *id && status.data.len() == length && status.error.code() == 0
                });
                came
            })?;
            Ok(came)
        });
        match outcome {
            Ok(true) => {
                self.echo = Echo::of(vec![(*id, length)]);
                self.heard = Some(sent);
                Ok(true)
            }
            Ok(false) => {
                self.echo.missed_clearing(*id, length);
                Ok(false)
            }
            Err(error) => Err(self.failed(command, error)),
        }
    }

    pub(super) fn send(&mut self, packet: &Packet, deadline: Time) -> Result<(), PortError> {
        self.port.discard_input()?;
        self.decoder.clear();
        self.port.write_all(&packet.encode(), deadline)
    }

    /// Takes packets until one is enough or time is up.
    pub(super) fn listen(
        &mut self,
        deadline: Time,
        mut enough: impl FnMut(Packet) -> bool,
    ) -> Result<(), PortError> {
        let (mut buffer, mut late) = ([0; 512], 0);
        loop {
            while let Some(packet) = self.decoder.next_packet() {
                if enough(packet) {
                    return Ok(());
                }
            }
            // A line that never falls silent holds nobody up: by then no more has arrived than fits into these.
            late += u32::from(self.port.clock().now() > deadline);
            if late > LATE_READS {
                return Ok(());
            }
            match self.port.read(&mut buffer, deadline) {
                Ok(count) => self.decoder.push(buffer.get(..count).unwrap_or_default()),
                Err(error) if error.kind == PortErrorKind::TimedOut => return Ok(()),
                Err(error) => return Err(error),
            }
        }
    }
}

fn answer(status: Status) -> Answer {
    Answer { id: status.id, data: status.data, alert: status.error.alert() }
}
