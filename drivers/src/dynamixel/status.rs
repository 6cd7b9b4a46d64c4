//! What servos answer.

use super::packet::{Packet, STATUS, crc};
use crate::driver::Fault;

/// The answer of one servo.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Status {
    /// Who answers.
    pub id: u8,
    /// How it went.
    pub error: ErrorByte,
    /// What was asked for.
    pub data: Vec<u8>,
}

/// How an instruction went: a number, and whether something is latched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ErrorByte(pub u8);

impl ErrorByte {
    /// Whether a hardware error is latched ([`HARDWARE_ERROR`](super::control_table::HARDWARE_ERROR)). The instruction
    /// may have been done all the same.
    pub fn alert(self) -> bool {
        self.0 & 0x80 != 0
    }

    /// Why the instruction was not done: 0 where it was.
    pub fn code(self) -> u8 {
        self.0 & 0x7f
    }

    /// What [`code`](Self::code) means.
    pub fn meaning(self) -> &'static str {
        match self.code() {
            0 => "done",
            1 => "the servo failed to do it",
            2 => "no such instruction, or an action with nothing registered",
            3 => "the instruction arrived with a wrong CRC",
            4 => "a value that the register does not take, or a tripped bus watchdog",
            5 => "too few bytes for the register",
            6 => "a value outside the servo's own limits",
            7 => "a register that is read-only, not there, or locked while torque is on",
            _ => "an error that the protocol does not define",
        }
    }
}

/// The error that a CRC which was wrong on the way to the servo gives.
pub const CRC_ERROR: u8 = 3;

impl Status {
    /// Of a packet that is one.
    pub fn of_packet(packet: &Packet) -> Option<Status> {
        let (error, data) = packet.parameters.split_first()?;
        let error = ErrorByte(*error);
        (packet.instruction == STATUS).then(|| Status { id: packet.id, error, data: data.to_vec() })
    }

    /// The packet that it is sent as.
    pub fn packet(&self) -> Packet {
        let parameters = [&[self.error.0], self.data.as_slice()].concat();
        Packet { id: self.id, instruction: STATUS, parameters }
    }

    /// The parts of the answer to a fast read of so many bytes each: error, id, data, CRC of all the packet so far; the
    /// last CRC is the packet's own. `None` where the packet is no such answer.
    pub fn of_fast_packet(packet: &Packet, lengths: &[usize]) -> Option<Vec<Status>> {
        let bytes = packet.encode_unstuffed();
        let mut rest = packet.parameters.as_slice();
        let mut found = Vec::with_capacity(lengths.len());
        for (place, length) in lengths.iter().enumerate() {
            let (head, after) = rest.split_at_checked(2 + length)?;
            let [error, id, data @ ..] = head else { return None };
            found.push(Status { id: *id, error: ErrorByte(*error), data: data.to_vec() });
            if place + 1 == lengths.len() {
                return (after.is_empty() && packet.instruction == STATUS).then_some(found);
            }
            // The decoder has judged the last CRC; those before it cover the bytes up to themselves.
            let (sent, after) = after.split_first_chunk::<2>()?;
            let covered = bytes.len().checked_sub(2 + after.len() + 2)?;
            if crc(bytes.get(..covered)?) != u16::from_le_bytes(*sent) {
                return None;
            }
            rest = after;
        }
        None
    }
}

/// What the bits of the hardware error register mean, as a fault; `None` for none.
pub fn hardware_fault(bits: u8) -> Option<Fault> {
    let meaning = match bits.trailing_zeros() {
        8.. => return None,
        0 => "the voltage is outside its limits",
        2 => "too hot",
        3 => "the encoder fails",
        4 => "electrical shock, or too little power",
        5 => "overload",
        _ => "a hardware error that the e-manual does not define",
    };
    Some(Fault { code: bits, meaning })
}
