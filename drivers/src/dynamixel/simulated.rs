//! A bus of servos that are not there.

mod servo;

use super::control_table::{BAUD_RATES, Model};
use super::instruction::{
    ACTION, BULK_READ, BULK_WRITE, CLEAR, FACTORY_RESET, FAST_BULK_READ, FAST_SYNC_READ, PING, READ, REBOOT,
    REG_WRITE, SYNC_READ, SYNC_WRITE, WRITE,
};
use super::packet::{BROADCAST, Decoder, Packet, STATUS, crc};
use super::status::Status;
use crate::clock::Time;
use crate::simulate::SimulatedDevice;
use std::collections::VecDeque;
use std::time::Duration;

pub use servo::SimulatedServo;

/// What a simulated servo is, and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServoSpec {
    /// Its id.
    pub id: u8,
    /// Its type.
    pub model: &'static Model,
    /// Bits per second; where the servo has no such rate, the one that it leaves the factory with.
    pub baud: u32,
    /// Where it stands at first (ticks).
    pub position: f64,
}

/// Servos on one line, as the e-manual describes them.
///
/// Where it leaves things open: broken requests are not answered; a goal outside the limits is refused as "data
/// limit"; torque that is switched on holds the servo where it is; torque that a latched error keeps off is refused as
/// "result fail"; a servo whose watchdog trips brakes and holds. Only the two position modes move anything; profiles
/// by time and the reversed sense of rotation are refused as "data range". Loads are invented: a twentieth of the
/// greatest while a servo moves.
#[derive(Debug)]
pub struct SimulatedBus {
    servos: Vec<SimulatedServo>,
    decoder: Decoder,
    heard: Time,
    outbox: VecDeque<(Time, Vec<u8>)>,
}

/// Half a packet is dropped when so long nothing follows. Real servos give up after 1.5 ms, which a process that must
/// wait for its turn on a processor cannot keep.
const GAP: Duration = Duration::from_millis(25);

impl SimulatedBus {
    /// With these servos, powered from the start of the clock on.
    pub fn new(servos: impl IntoIterator<Item = ServoSpec>) -> Self {
        let servos = servos.into_iter().map(SimulatedServo::new).collect();
        Self { servos, decoder: Decoder::new(), heard: Time::START, outbox: VecDeque::new() }
    }

    /// Motors that are so many times as fast in everything, for programs that must not take long. The protocol's own
    /// times, watchdogs and ticks among them, stay as they are.
    pub fn with_time_scale(mut self, scale: f64) -> Self {
        for servo in &mut self.servos {
            servo.time_scale = scale;
        }
        self
    }

    /// The servo of this id.
    pub fn servo(&self, id: u8) -> Option<&SimulatedServo> {
        self.servos.iter().find(|servo| servo.id() == id)
    }

    /// The same, to do something to it.
    pub fn servo_mut(&mut self, id: u8) -> Option<&mut SimulatedServo> {
        self.servos.iter_mut().find(|servo| servo.id() == id)
    }

    /// All of them.
    pub fn servos(&self) -> &[SimulatedServo] {
        &self.servos
    }

    /// Switches power. Servos without it are silent and fall limp; with it again they start anew.
    pub fn power(&mut self, on: bool, now: Time) {
        for servo in &mut self.servos {
            servo.power(on, now);
        }
    }

    /// Sends an answer after the servo's return delay and the time that it takes on the wire, and after what is being
    /// sent already.
    fn answer(&mut self, bytes: Vec<u8>, delay: Duration, baud: u32, now: Time) {
        let wire = Duration::from_secs_f64(10.0 * bytes.len() as f64 / f64::from(baud.max(1)));
        let free = self.outbox.back().map_or(Time::START, |(time, _)| *time);
        self.outbox.push_back(((now + delay).max(free) + wire, bytes));
    }

    fn handle(&mut self, packet: &Packet, now: Time) {
        if packet.instruction == STATUS {
            return;
        }
        for servo in &mut self.servos {
            if packet.id == BROADCAST || servo.id() == packet.id {
                servo.hear(now);
            }
        }
        let parameters = packet.parameters.as_slice();
        match (packet.instruction, stretch(parameters)) {
            (SYNC_READ, Some((address, length, ids))) => {
                self.group_read(&same(ids, address, length), false, now);
            }
            (FAST_SYNC_READ, Some((address, length, ids))) => {
                self.group_read(&same(ids, address, length), true, now);
            }
            (BULK_READ, _) => self.group_read(&bulk(parameters), false, now),
            (FAST_BULK_READ, _) => self.group_read(&bulk(parameters), true, now),
            (SYNC_WRITE, Some((address, length, data))) => {
                for entry in data.chunks_exact(1 + usize::from(length)) {
                    let [id, bytes @ ..] = entry else { continue };
                    self.write_of(*id, address, bytes, now);
                }
            }
            (BULK_WRITE, _) => {
                let mut rest = parameters;
                while let Some((id, after)) = rest.split_first() {
                    let Some((address, length, after)) = stretch(after) else { break };
                    let Some((bytes, after)) = after.split_at_checked(length.into()) else { break };
                    self.write_of(*id, address, bytes, now);
                    rest = after;
                }
            }
            _ => self.single(packet, now),
        }
    }

    fn write_of(&mut self, id: u8, address: u16, bytes: &[u8], now: Time) {
        if let Some(servo) = self.servo_mut(id).filter(|servo| servo.is_up(now)) {
            // None answers: whoever refuses says nothing.
            let _ = servo.write(address, bytes, now);
        }
    }

    /// An instruction of one servo, or of all alike.
    fn single(&mut self, packet: &Packet, now: Time) {
        let Packet { id, instruction, parameters } = packet;
        let mut answers = Vec::new();
        for servo in &mut self.servos {
            if !((*id == BROADCAST || servo.id() == *id) && servo.is_up(now)) {
                continue;
            }
            let (level, delay, baud, from) =
                (servo.status_return(), servo.return_delay(), servo.baud(), servo.id());
            let address = parameters.first_chunk::<2>().map(|bytes| u16::from_le_bytes(*bytes));
            let data = parameters.get(2..).unwrap_or_default();
            let outcome = match (*instruction, address) {
                (PING, _) => Ok(servo.identity()),
                (READ, Some(address)) => match *data {
                    [low, high] => servo.read(address, u16::from_le_bytes([low, high]), now),
                    _ => Err(servo::DATA_LENGTH),
                },
                (WRITE, Some(address)) => servo.write(address, data, now).map(|()| vec![]),
                (REG_WRITE, Some(address)) => servo.register(address, data, now).map(|()| vec![]),
                (ACTION, _) => servo.action(now).map(|()| vec![]),
                (REBOOT, _) => {
                    servo.reboot(now);
                    Ok(vec![])
                }
                (FACTORY_RESET, _) => servo.factory_reset(parameters, *id == BROADCAST, now).map(|()| vec![]),
                (CLEAR, _) => servo.clear(parameters, now).map(|()| vec![]),
                _ => Err(servo::INSTRUCTION),
            };
            let least = match *instruction {
                PING => 0,
                READ => 1,
                _ => 2,
            };
            // To all at once, only a ping is answered.
            if (*id == BROADCAST && *instruction != PING) || level < least {
                continue;
            }
            answers.push((servo.status(from, outcome).packet().encode(), delay, baud));
        }
        for (bytes, delay, baud) in answers {
            self.answer(bytes, delay, baud, now);
        }
    }

    /// Every servo answers, in the order in which they are named; what they answer is sent with one write, as what comes
    /// from a real bus arrives in one piece. A servo behind one that is silent stays silent too.
    fn group_read(&mut self, stretches: &[(u8, u16, u16)], fast: bool, now: Time) {
        let mut statuses: Vec<Status> = Vec::new();
        let (mut delay, mut baud) = (Duration::ZERO, 0);
        for (id, address, length) in stretches {
            let servo = self.servo_mut(*id).filter(|servo| servo.is_up(now) && servo.status_return() >= 1);
            let Some(servo) = servo else { break };
            let outcome = servo.read(*address, *length, now);
            statuses.push(servo.status(*id, outcome));
            (delay, baud) = (delay + servo.return_delay(), servo.baud());
        }
        if statuses.is_empty() || (fast && statuses.len() < stretches.len()) {
            return;
        }
        let bytes = if fast {
            fast_answer(&statuses)
        } else {
            statuses.iter().flat_map(|status| status.packet().encode()).collect()
        };
        self.answer(bytes, delay, baud, now);
    }
}

/// The answer to a fast read: one packet from all, with the CRC so far after each servo's part.
fn fast_answer(statuses: &[Status]) -> Vec<u8> {
    let parts: usize = statuses.iter().map(|status| 2 + status.data.len()).sum();
    let between = 2 * (statuses.len() - 1);
    // The prefix is known beforehand: its length is that of the whole.
    let blank = vec![0; parts + between];
    let whole = Packet { id: BROADCAST, instruction: STATUS, parameters: blank }.encode_unstuffed();
    let mut bytes: Vec<u8> = whole.into_iter().take(8).collect();
    for status in statuses {
        bytes.extend([status.error.0, status.id]);
        bytes.extend(&status.data);
        bytes.extend(crc(&bytes).to_le_bytes());
    }
    bytes
}

/// Address, length, and what follows them.
fn stretch(parameters: &[u8]) -> Option<(u16, u16, &[u8])> {
    let [a, b, c, d, rest @ ..] = parameters else { return None };
    Some((u16::from_le_bytes([*a, *b]), u16::from_le_bytes([*c, *d]), rest))
}

fn same(ids: &[u8], address: u16, length: u16) -> Vec<(u8, u16, u16)> {
    ids.iter().map(|id| (*id, address, length)).collect()
}

fn bulk(parameters: &[u8]) -> Vec<(u8, u16, u16)> {
    let entries = parameters.chunks_exact(5);
    let entries = entries.filter_map(|entry| {
        let (id, rest) = entry.split_first()?;
        stretch(rest).map(|(address, length, _)| (*id, address, length))
    });
    entries.collect()
}

impl SimulatedDevice for SimulatedBus {
    fn receive(&mut self, bytes: &[u8], now: Time) {
        self.advance(now);
        if now - self.heard > GAP {
            self.decoder.clear();
        }
        self.heard = now;
        self.decoder.push(bytes);
        while let Some(packet) = self.decoder.next_packet() {
            self.handle(&packet, now);
        }
    }

    fn advance(&mut self, now: Time) {
        for servo in &mut self.servos {
            servo.advance(now);
        }
    }

    fn next_send(&self) -> Option<Time> {
        self.outbox.front().map(|(time, _)| *time)
    }

    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        self.outbox.front().filter(|(time, _)| *time <= now)?;
        self.outbox.pop_front().map(|(_, bytes)| bytes)
    }
}

/// The register's number for a rate; the factory's where there is none.
fn baud_code(baud: u32) -> i64 {
    BAUD_RATES.iter().position(|rate| *rate == baud).map_or(1, |place| place as i64)
}
