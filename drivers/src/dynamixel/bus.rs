//! Exchanges with servos on one line.

mod echo;
mod exchange;

use super::control_table::OPERATING_MODE;
use super::instruction::{self, Spared};
use super::packet::{BROADCAST, Decoder, MAX_ID, Packet};
use super::status::Status;
use crate::clock::Time;
use crate::driver::{Cause, DriverError};
use crate::port::{Port, PortError, PortErrorKind};
use echo::Echo;
use exchange::Request;
use std::time::Duration;

/// How long is waited for answers, and how often is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// What the way through operating system and USB takes at most, there and back, besides the time on the wire and
    /// the servos' return delays.
    pub latency: Duration,
    /// How often something is asked until it counts as not answered; at least once.
    pub attempts: u32,
}

impl Default for Timing {
    /// 34 ms, what the makers' client waits (USB adapters keep bytes for up to 16 ms), and three attempts.
    fn default() -> Self {
        Self { latency: Duration::from_millis(34), attempts: 3 }
    }
}

/// What a servo answers to a ping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Identity {
    /// Its id.
    pub id: u8,
    /// Its type: see [`Model::by_number`](super::control_table::Model::by_number).
    pub model: u16,
    /// The version of its firmware.
    pub firmware: u8,
}

/// What one servo answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// Who.
    pub id: u8,
    /// The bytes that were asked for; none where nothing was.
    pub data: Vec<u8>,
    /// Whether it has a hardware error latched.
    pub alert: bool,
}

/// Says that somebody wants what cannot be taken back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Confirmed {
    /// All settings of the servo are lost: limits, offsets, gains, and with them what the arm was set up with.
    SettingsAreLost,
}

/// The line to servos that speak Protocol 2.0.
///
/// Answers carry no number that says what they answer. What an earlier request brings late or twice could therefore be
/// taken for the answer to the next. A bus keeps its order, so this cannot happen as long as no two requests in a row
/// can be answered with the same number of bytes. Where they could, a read of another length goes between them, whose
/// answer pushes out whatever is still on its way.
///
/// Every request is answered, or has failed, before [`Bus::longest`] is over; opening a lost port anew comes on top.
///
/// A bus knows servos and no arm: what it writes nobody checks but the servo. It is for setting servos up and for looking
/// at them; arms are moved by [`motion`](crate::motion), through [`Arm`](super::Arm).
#[derive(Debug)]
pub struct Bus {
    port: Box<dyn Port>,
    timing: Timing,
    decoder: Decoder,
    echo: Echo,
    lost: bool,
    heard: Option<Time>,
}

/// Bytes of a packet besides its data: an answer's, a read's and a group read's.
const STATUS_OVERHEAD: usize = 11;
/// Assumed where a line has no rate: the rate that servos leave the factory with.
const FACTORY_BAUD: u32 = 57_600;
/// The servos' longest return delay.
const RETURN_DELAY: Duration = Duration::from_micros(508);
/// How long a servo may take to start.
const STARTING: Duration = Duration::from_secs(1);
/// What the makers' client grants each id to answer a broadcast ping with.
const PING_SLOT: Duration = Duration::from_millis(3);

impl Bus {
    /// Speaks on this port.
    pub fn new(port: Box<dyn Port>, timing: Timing) -> Self {
        let (decoder, echo) = (Decoder::new(), Echo::none());
        Self { port, timing, decoder, echo, lost: false, heard: None }
    }

    /// The port.
    pub fn port(&self) -> &dyn Port {
        self.port.as_ref()
    }

    /// When a request was sent that has been answered, the last time: since then the servos have had a word.
    pub fn heard(&self) -> Option<Time> {
        self.heard
    }

    /// How long so many bytes take on the wire.
    pub fn wire_time(&self, bytes: usize) -> Duration {
        let baud = self.port.baud().unwrap_or(FACTORY_BAUD).max(1);
        Duration::from_secs_f64(10.0 * bytes as f64 / f64::from(baud))
    }

    /// The longest that a request may take which is `sent` bytes long and gets answers of these lengths: all attempts,
    /// with a clearing read before each.
    pub fn longest(&self, sent: usize, answers: &[usize]) -> Duration {
        let attempt = self.timeout(sent, answers) + self.timeout(14, &[echo::LONGEST]);
        attempt * self.timing.attempts.max(1)
    }

    fn timeout(&self, sent: usize, answers: &[usize]) -> Duration {
        let bytes = sent + answers.iter().map(|length| length + STATUS_OVERHEAD).sum::<usize>();
        // A packet whose bytes need stuffing is a third longer at most.
        self.wire_time(bytes + bytes / 3) + RETURN_DELAY * answers.len() as u32 + self.timing.latency
    }

    /// Asks one servo for its type.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn ping(&mut self, id: u8) -> Result<Identity, DriverError> {
        let answer = self.one("ping", instruction::ping(id), echo::PING_LENGTH, true)?;
        identity(id, &answer.data).ok_or_else(|| self.error("ping", Some(id), Cause::Garbled))
    }

    /// Asks all servos for theirs, and waits until the last could have answered: 0.8 s and more.
    ///
    /// # Errors
    /// [`DriverError`] of the port; that nobody answers is none.
    pub fn scan(&mut self) -> Result<Vec<Identity>, DriverError> {
        let command = "scan";
        self.restore(command)?;
        let slots = u32::from(MAX_ID) + 1;
        let window = (self.wire_time(14) + PING_SLOT) * slots + self.timing.latency;
        let deadline = self.port.clock().now() + window;
        self.echo = Echo::of((0..=MAX_ID).map(|id| (id, echo::PINGED)).collect());
        let mut found: Vec<Identity> = Vec::new();
        let sent = self.send(&instruction::ping(BROADCAST), deadline);
        let outcome = sent.and_then(|()| {
            self.listen(deadline, |packet| {
                let status = Status::of_packet(&packet);
                found.extend(status.and_then(|status| identity(status.id, &status.data)));
                false
            })
        });
        if let Err(error) = outcome {
            return Err(self.failed(command, error));
        }
        found.sort_by_key(|identity| identity.id);
        found.dedup();
        Ok(found)
    }

    /// Reads a stretch of a servo's control table.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn read(&mut self, id: u8, address: u16, length: u16) -> Result<Answer, DriverError> {
        self.one("read", instruction::read(id, address, length), length.into(), true)
    }

    /// Writes one. Servos whose status return level is less than 2 do not answer; see [`Bus::sync_write`].
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn write(&mut self, id: u8, address: u16, data: &[u8]) -> Result<Answer, DriverError> {
        self.one("write", instruction::write(id, address, data), 0, true)
    }

    /// Has a servo write when [`Bus::action`] comes.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn reg_write(&mut self, id: u8, address: u16, data: &[u8]) -> Result<Answer, DriverError> {
        self.one("reg write", instruction::reg_write(id, address, data), 0, true)
    }

    /// Has a servo do what it registered. It is asked once: without an answer,
    /// [`REGISTERED`](super::control_table::REGISTERED) says whether it has been done.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn action(&mut self, id: u8) -> Result<Answer, DriverError> {
        self.one("action", instruction::action(id), 0, false)
    }

    /// Has all servos do at once what they registered; none answers.
    ///
    /// # Errors
    /// [`DriverError`] of the port.
    pub fn action_of_all(&mut self) -> Result<(), DriverError> {
        self.unanswered("action", &instruction::action(BROADCAST))
    }

    /// Starts a servo anew. It is away for some tenths of a second then, its torque is off and latched errors are gone.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn reboot(&mut self, id: u8) -> Result<Answer, DriverError> {
        self.one("reboot", instruction::reboot(id), 0, false)
    }

    /// Sets servos to an operating mode, those that are not in it already: it keeps them without power.
    ///
    /// # Errors
    /// [`DriverError`]; a servo whose torque is on refuses.
    pub fn set_operating_mode(&mut self, ids: &[u8], mode: i64) -> Result<(), DriverError> {
        for id in ids {
            let now = self.read(*id, OPERATING_MODE.address, OPERATING_MODE.size)?;
            if OPERATING_MODE.value(&now.data) != Some(mode) {
                self.write(*id, OPERATING_MODE.address, &OPERATING_MODE.bytes(mode))?;
            }
        }
        Ok(())
    }

    /// Waits until a servo that was started anew answers again: a second at most.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn await_servo(&mut self, id: u8) -> Result<Identity, DriverError> {
        let clock = self.port.clock();
        let deadline = clock.now() + STARTING;
        loop {
            match self.ping(id) {
                Err(error) if matches!(error.cause, Cause::Silent { .. }) && clock.now() < deadline => {}
                outcome => return outcome,
            }
        }
    }

    /// Sets a servo to what it was when it left the factory, but for what is spared. It is asked once.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn factory_reset(&mut self, id: u8, spared: Spared, _: Confirmed) -> Result<Answer, DriverError> {
        if id > MAX_ID {
            return Err(self.error("factory reset", Some(id), Cause::Unsupported));
        }
        self.one("factory reset", instruction::factory_reset(id, spared), 0, false)
    }

    /// Has a servo at rest forget whole turns: its position is within one turn then.
    ///
    /// # Errors
    /// [`DriverError`]
    pub fn clear_turns(&mut self, id: u8) -> Result<Answer, DriverError> {
        self.one("clear turns", instruction::clear_turns(id), 0, true)
    }

    /// Reads the same stretch of several servos; answers in the order of ids.
    ///
    /// # Errors
    /// [`DriverError`], also where only one of them does not answer.
    pub fn sync_read(&mut self, ids: &[u8], address: u16, length: u16) -> Result<Vec<Answer>, DriverError> {
        let packet = instruction::sync_read(ids, address, length);
        let expected = ids.iter().map(|id| (*id, length.into())).collect();
        self.exchange(&Request { command: "sync read", packet, expected, fast: false, again: true })
    }

    /// The same with all answers in one packet: firmware 45 and newer.
    ///
    /// # Errors
    /// [`DriverError`], also where only one of them does not answer.
    pub fn fast_sync_read(
        &mut self,
        ids: &[u8],
        address: u16,
        length: u16,
    ) -> Result<Vec<Answer>, DriverError> {
        let packet = instruction::fast_sync_read(ids, address, length);
        let expected = ids.iter().map(|id| (*id, length.into())).collect();
        self.exchange(&Request { command: "fast sync read", packet, expected, fast: true, again: true })
    }

    /// Reads a stretch (id, address, length) of each of several servos; answers in the order of stretches.
    ///
    /// # Errors
    /// [`DriverError`], also where only one of them does not answer.
    pub fn bulk_read(&mut self, stretches: &[(u8, u16, u16)]) -> Result<Vec<Answer>, DriverError> {
        let packet = instruction::bulk_read(stretches);
        let expected = stretches.iter().map(|(id, _, length)| (*id, (*length).into())).collect();
        self.exchange(&Request { command: "bulk read", packet, expected, fast: false, again: true })
    }

    /// Writes the same stretch of several servos: (id, bytes), of one length. None answers: whether they did it, a read
    /// can tell.
    ///
    /// # Errors
    /// [`DriverError`] of the port, and of data of different lengths.
    pub fn sync_write(&mut self, address: u16, data: &[(u8, Vec<u8>)]) -> Result<(), DriverError> {
        let command = "sync write";
        let length = data.first().map_or(0, |(_, bytes)| bytes.len());
        if let Some((id, bytes)) = data.iter().find(|(_, bytes)| bytes.len() != length) {
            let cause = Cause::Length { expected: length, got: bytes.len() };
            return Err(self.error(command, Some(*id), cause));
        }
        let data = data.iter().map(|(id, bytes)| (*id, bytes.as_slice()));
        self.unanswered(command, &instruction::sync_write(address, length as u16, data))
    }

    /// Writes a stretch of its own of each of several servos: (id, address, bytes). None answers.
    ///
    /// # Errors
    /// [`DriverError`] of the port.
    pub fn bulk_write(&mut self, data: &[(u8, u16, Vec<u8>)]) -> Result<(), DriverError> {
        let data = data.iter().map(|(id, address, bytes)| (*id, *address, bytes.as_slice()));
        self.unanswered("bulk write", &instruction::bulk_write(data))
    }

    fn error(&self, command: &'static str, id: Option<u8>, cause: Cause) -> DriverError {
        let error = DriverError::new(self.port.name(), command, cause);
        match id {
            Some(id) => error.of_joint(servo_name(id)),
            None => error,
        }
    }

    /// The port failed: it must be opened anew where the device is gone.
    fn failed(&mut self, command: &'static str, error: PortError) -> DriverError {
        if !matches!(error.kind, PortErrorKind::TimedOut | PortErrorKind::Baud(_)) {
            self.lost = true;
        }
        self.error(command, None, Cause::Port(error))
    }

    /// Opens a lost port anew.
    fn restore(&mut self, command: &'static str) -> Result<(), DriverError> {
        if self.lost {
            if let Err(error) = self.port.reopen() {
                return Err(self.failed(command, error));
            }
            self.lost = false;
            self.decoder.clear();
            self.echo = Echo::unknown();
        }
        Ok(())
    }

    /// Sends what nobody answers.
    fn unanswered(&mut self, command: &'static str, packet: &Packet) -> Result<(), DriverError> {
        self.restore(command)?;
        let bytes = packet.encode();
        let deadline = self.port.clock().now() + self.timeout(bytes.len(), &[]);
        self.port.write_all(&bytes, deadline).map_err(|error| self.failed(command, error))
    }

    fn one(
        &mut self,
        command: &'static str,
        packet: Packet,
        length: usize,
        again: bool,
    ) -> Result<Answer, DriverError> {
        let id = packet.id;
        let expected = vec![(id, length)];
        let answers = self.exchange(&Request { command, packet, expected, fast: false, again })?;
        answers.into_iter().next().ok_or_else(|| self.error(command, Some(id), Cause::Garbled))
    }
}

/// What errors call a servo whose joint is not known.
pub(super) fn servo_name(id: u8) -> String {
    format!("servo {id}")
}

fn identity(id: u8, data: &[u8]) -> Option<Identity> {
    let [low, high, firmware] = *data else { return None };
    Some(Identity { id, model: u16::from_le_bytes([low, high]), firmware })
}
