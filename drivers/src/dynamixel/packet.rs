//! Packets to bytes and back.
//!
//! ```text
//! FF FF FD 00 | id | length, 2 bytes | instruction | parameters ... | CRC, 2 bytes
//! ```
//!
//! Numbers are little-endian. The length counts what follows it, as it is sent: stuffed. So does the CRC, which covers
//! everything before it.

/// The id that speaks to all servos, and that a fast sync read is answered with.
pub const BROADCAST: u8 = 0xfe;

/// The instruction byte of an answer.
pub const STATUS: u8 = 0x55;

/// The greatest id that a servo can have.
pub const MAX_ID: u8 = 252;

/// The greatest length (as it is written in a packet) that is believed. A fast read of 32 servos needs half of it.
pub const MAX_LENGTH: usize = 2048;

const HEADER: [u8; 4] = [0xff, 0xff, 0xfd, 0x00];
/// Header, id and length.
const PREFIX: usize = 7;
/// Instruction and CRC.
const MIN_LENGTH: usize = 3;

/// What is sent in one piece: what to do, or how it went.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packet {
    /// Whom it is to, or from.
    pub id: u8,
    /// What to do; [`STATUS`] for answers.
    pub instruction: u8,
    /// What follows the instruction, not stuffed. The first of an answer is its error byte.
    pub parameters: Vec<u8>,
}

impl Packet {
    /// The bytes on the line.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = self.prefix();
        let mut stuffing = Stuffing::default();
        for byte in std::iter::once(self.instruction).chain(self.parameters.iter().copied()) {
            bytes.push(byte);
            if stuffing.completes(byte) {
                bytes.push(0xfd);
            }
        }
        finish(bytes)
    }

    /// The bytes of an answer to a fast read, whose parameters are never stuffed.
    pub fn encode_unstuffed(&self) -> Vec<u8> {
        let mut bytes = self.prefix();
        bytes.push(self.instruction);
        bytes.extend(&self.parameters);
        finish(bytes)
    }

    fn prefix(&self) -> Vec<u8> {
        let mut bytes = HEADER.to_vec();
        bytes.extend([self.id, 0, 0]);
        bytes
    }
}

/// Writes the length and appends the CRC.
fn finish(mut bytes: Vec<u8>) -> Vec<u8> {
    let length = (bytes.len() - PREFIX + 2) as u16;
    for (to, from) in bytes.iter_mut().skip(PREFIX - 2).zip(length.to_le_bytes()) {
        *to = from;
    }
    bytes.extend(crc(&bytes).to_le_bytes());
    bytes
}

/// CRC-16 with the polynomial 0x8005, most significant bit first, from 0.
pub fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc, byte| {
        let mut crc = crc ^ (u16::from(*byte) << 8);
        for _ in 0..8 {
            crc = if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x8005 };
        }
        crc
    })
}

/// Watches for FF FF FD in a row of bytes, also where more FF stand before it.
#[derive(Debug, Default)]
struct Stuffing {
    /// How many FF end what has passed; at most 2 matter.
    ones: u8,
}

impl Stuffing {
    /// Whether this byte makes FF FF FD of the last three.
    fn completes(&mut self, byte: u8) -> bool {
        let complete = byte == 0xfd && self.ones >= 2;
        self.ones = if byte == 0xff { (self.ones + 1).min(2) } else { 0 };
        complete
    }
}

/// Takes the FD out that follows every FF FF FD. Where none follows, the sender did not stuff; nothing is taken out
/// then.
fn unstuff(bytes: &[u8]) -> Vec<u8> {
    let mut plain = Vec::with_capacity(bytes.len());
    let mut stuffing = Stuffing::default();
    let mut bytes = bytes.iter().copied().peekable();
    while let Some(byte) = bytes.next() {
        plain.push(byte);
        if stuffing.completes(byte) {
            bytes.next_if_eq(&0xfd);
        }
    }
    plain
}

/// Finds packets in a stream of bytes, whatever comes between them.
///
/// A packet counts if its CRC is right. Where it is wrong, the search goes on at the byte after the header's first, so
/// that a wrong length costs no more than the packet that it stands in.
#[derive(Debug, Default)]
pub struct Decoder {
    buffer: Vec<u8>,
    broken: usize,
}

impl Decoder {
    /// Nothing has come yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// These bytes have come.
    pub fn push(&mut self, bytes: &[u8]) {
        self.buffer.extend(bytes);
    }

    /// The next sound packet, if it is complete.
    pub fn next_packet(&mut self) -> Option<Packet> {
        loop {
            self.skip_to_header();
            let [low, high] = [*self.buffer.get(PREFIX - 2)?, *self.buffer.get(PREFIX - 1)?];
            let length = usize::from(u16::from_le_bytes([low, high]));
            if !(MIN_LENGTH..=MAX_LENGTH).contains(&length) {
                self.reject();
                continue;
            }
            let packet = self.buffer.get(..PREFIX + length)?;
            let (covered, sent) = packet.split_last_chunk::<2>()?;
            if crc(covered) != u16::from_le_bytes(*sent) {
                self.reject();
                continue;
            }
            let [_, _, _, _, id, _, _, stuffed @ ..] = covered else { return None };
            // Answers to fast reads are not stuffed.
            let fast = *id == BROADCAST && stuffed.first() == Some(&STATUS);
            let (id, plain) = (*id, if fast { stuffed.to_vec() } else { unstuff(stuffed) });
            let [instruction, ref parameters @ ..] = *plain else { return None };
            let parameters = parameters.to_vec();
            self.buffer.drain(..PREFIX + length);
            return Some(Packet { id, instruction, parameters });
        }
    }

    /// Forgets what has come and is no packet yet.
    pub fn clear(&mut self) {
        self.buffer.clear();
    }

    /// Whether a part of something has come.
    pub fn is_empty(&self) -> bool {
        self.buffer.is_empty()
    }

    /// How many packets were found whose length or CRC is wrong.
    pub fn broken(&self) -> usize {
        self.broken
    }

    fn reject(&mut self) {
        self.broken += 1;
        self.buffer.drain(..1);
    }

    /// Drops what comes before a header, or before what may be the start of one.
    fn skip_to_header(&mut self) {
        let starts = |rest: &[u8]| rest.iter().zip(&HEADER).all(|(byte, expected)| byte == expected);
        let at = (0..self.buffer.len()).find(|at| self.buffer.get(*at..).is_some_and(starts));
        self.buffer.drain(..at.unwrap_or(self.buffer.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::{Decoder, Packet, crc, unstuff};

    fn decoded(bytes: &[u8]) -> Vec<Packet> {
        let mut decoder = Decoder::new();
        decoder.push(bytes);
        std::iter::from_fn(|| decoder.next_packet()).collect()
    }

    /// The check value of CRC-16/UMTS (also called BUYPASS) in the CRC catalogue.
    #[test]
    fn crc_has_its_check_value() {
        assert_eq!(crc(b"123456789"), 0xfee8);
    }

    /// Every sequence of eight of the bytes that matter comes back, and no header stands inside of a packet.
    #[test]
    fn stuffing_is_undone_exactly() {
        const BYTES: [u8; 4] = [0xff, 0xfd, 0x00, 0x55];
        for code in 0..4_usize.pow(8) {
            let parameters: Vec<u8> = (0..8).map(|place| BYTES[(code >> (2 * place)) & 3]).collect();
            // A pattern may begin in what stands in an instruction's place.
            for instruction in [0x03, 0xff] {
                let packet = Packet { id: 1, instruction, parameters: parameters.clone() };
                let bytes = packet.encode();
                let inside = &bytes[4..bytes.len() - 2];
                assert!(!inside.windows(4).any(|four| four == [0xff, 0xff, 0xfd, 0x00]), "{bytes:02x?}");
                assert_eq!(decoded(&bytes), [packet]);
            }
        }
    }

    #[test]
    fn what_was_not_stuffed_is_left_alone() {
        assert_eq!(unstuff(&[0xff, 0xff, 0xfd, 0xff]), [0xff, 0xff, 0xfd, 0xff]);
        assert_eq!(unstuff(&[0xff, 0xff, 0xff, 0xfd, 0xfd]), [0xff, 0xff, 0xff, 0xfd]);
        assert_eq!(unstuff(&[0xff, 0xff, 0xfd, 0xfd, 0xfd]), [0xff, 0xff, 0xfd, 0xfd]);
    }

    /// Garbage, a header cut short, a length that is wrong, a CRC that is wrong: what follows is still found.
    #[test]
    fn finds_packets_after_anything() {
        let good = Packet { id: 7, instruction: 0x55, parameters: vec![0, 1, 2, 3, 4] };
        let bytes = good.encode();
        let mut wrong_length = bytes.clone();
        wrong_length[5] += 6;
        let mut wrong_crc = bytes.clone();
        *wrong_crc.last_mut().unwrap() ^= 1;
        let garbage: [&[u8]; 6] = [
            b"garbage",
            &[0xff, 0xff],
            &[0xff, 0xff, 0xfd, 0x00, 1, 0xff, 0xff],
            &wrong_length,
            &wrong_crc,
            &bytes[..5],
        ];
        for before in garbage {
            let stream = [before, &bytes, &bytes].concat();
            let found = decoded(&stream);
            assert!(found.ends_with(&[good.clone(), good.clone()]), "{before:02x?}: {found:?}");
            // One byte at a time gives the same.
            let mut decoder = Decoder::new();
            let mut one_by_one = Vec::new();
            for byte in stream {
                decoder.push(&[byte]);
                one_by_one.extend(std::iter::from_fn(|| decoder.next_packet()));
            }
            assert_eq!(one_by_one, found);
        }
    }
}
