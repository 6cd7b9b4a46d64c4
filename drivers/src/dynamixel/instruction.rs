//! What a host asks of servos.

use super::packet::{BROADCAST, Packet};

/// Asks whether a servo is there: answered with model number and firmware version.
pub const PING: u8 = 0x01;
/// Reads a stretch of the control table.
pub const READ: u8 = 0x02;
/// Writes one.
pub const WRITE: u8 = 0x03;
/// Writes one when an [`ACTION`] comes.
pub const REG_WRITE: u8 = 0x04;
/// Does what [`REG_WRITE`] left to do.
pub const ACTION: u8 = 0x05;
/// Sets everything to what it was when the servo left the factory.
pub const FACTORY_RESET: u8 = 0x06;
/// Starts the servo anew: torque is off then, and latched errors are gone.
pub const REBOOT: u8 = 0x08;
/// Forgets whole turns.
pub const CLEAR: u8 = 0x10;
/// Reads the same stretch of several servos, each of which answers.
pub const SYNC_READ: u8 = 0x82;
/// Writes the same stretch of several servos, none of which answers.
pub const SYNC_WRITE: u8 = 0x83;
/// Reads like [`SYNC_READ`], with all answers in one packet.
pub const FAST_SYNC_READ: u8 = 0x8a;
/// Reads a stretch of its own of each of several servos.
pub const BULK_READ: u8 = 0x92;
/// Writes a stretch of its own of each of several servos, none of which answers.
pub const BULK_WRITE: u8 = 0x93;
/// Reads like [`BULK_READ`], with all answers in one packet.
pub const FAST_BULK_READ: u8 = 0x9a;

/// What a factory reset spares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spared {
    /// Nothing.
    Nothing,
    /// The id.
    Id,
    /// The id and the baud rate.
    IdAndBaud,
}

impl Spared {
    /// The parameter of the instruction.
    pub fn code(self) -> u8 {
        match self {
            Self::Nothing => 0xff,
            Self::Id => 0x01,
            Self::IdAndBaud => 0x02,
        }
    }
}

fn packet(id: u8, instruction: u8, parameters: Vec<u8>) -> Packet {
    Packet { id, instruction, parameters }
}

fn stretch(address: u16, length: u16) -> Vec<u8> {
    [address.to_le_bytes(), length.to_le_bytes()].concat()
}

/// [`PING`]; all servos answer one to [`BROADCAST`].
pub fn ping(id: u8) -> Packet {
    packet(id, PING, vec![])
}

/// [`READ`]
pub fn read(id: u8, address: u16, length: u16) -> Packet {
    packet(id, READ, stretch(address, length))
}

/// [`WRITE`]
pub fn write(id: u8, address: u16, data: &[u8]) -> Packet {
    packet(id, WRITE, [&address.to_le_bytes(), data].concat())
}

/// [`REG_WRITE`]
pub fn reg_write(id: u8, address: u16, data: &[u8]) -> Packet {
    packet(id, REG_WRITE, [&address.to_le_bytes(), data].concat())
}

/// [`ACTION`]; [`BROADCAST`] for all servos at once, which is not answered.
pub fn action(id: u8) -> Packet {
    packet(id, ACTION, vec![])
}

/// [`FACTORY_RESET`]
pub fn factory_reset(id: u8, spared: Spared) -> Packet {
    packet(id, FACTORY_RESET, vec![spared.code()])
}

/// [`REBOOT`]
pub fn reboot(id: u8) -> Packet {
    packet(id, REBOOT, vec![])
}

/// [`CLEAR`], with the key that the e-manual gives.
pub fn clear_turns(id: u8) -> Packet {
    packet(id, CLEAR, vec![0x01, 0x44, 0x58, 0x4c, 0x22])
}

/// [`SYNC_READ`]
pub fn sync_read(ids: &[u8], address: u16, length: u16) -> Packet {
    packet(BROADCAST, SYNC_READ, [stretch(address, length), ids.to_vec()].concat())
}

/// [`FAST_SYNC_READ`]
pub fn fast_sync_read(ids: &[u8], address: u16, length: u16) -> Packet {
    packet(BROADCAST, FAST_SYNC_READ, [stretch(address, length), ids.to_vec()].concat())
}

/// [`SYNC_WRITE`] of `length` bytes each.
pub fn sync_write<'a>(address: u16, length: u16, data: impl IntoIterator<Item = (u8, &'a [u8])>) -> Packet {
    let mut parameters = stretch(address, length);
    for (id, bytes) in data {
        parameters.push(id);
        parameters.extend(bytes);
    }
    packet(BROADCAST, SYNC_WRITE, parameters)
}

/// [`BULK_READ`] of (id, address, length).
pub fn bulk_read(stretches: &[(u8, u16, u16)]) -> Packet {
    let mut parameters = Vec::new();
    for (id, address, length) in stretches {
        parameters.push(*id);
        parameters.extend(stretch(*address, *length));
    }
    packet(BROADCAST, BULK_READ, parameters)
}

/// [`BULK_WRITE`] of (id, address, bytes).
pub fn bulk_write<'a>(data: impl IntoIterator<Item = (u8, u16, &'a [u8])>) -> Packet {
    let mut parameters = Vec::new();
    for (id, address, bytes) in data {
        parameters.push(id);
        parameters.extend(stretch(address, bytes.len() as u16));
        parameters.extend(bytes);
    }
    packet(BROADCAST, BULK_WRITE, parameters)
}
