//! Frames: `FE FE | LEN | command | payload | FA`, where LEN counts what follows it. Nothing else protects them: there
//! is no checksum, no sequence number and no address.

/// The byte that a frame starts with, twice.
pub const HEADER: u8 = 0xFE;
/// The byte that a frame ends with.
pub const FOOTER: u8 = 0xFA;
/// The longest payload, in bytes: LEN is at most 30 and counts command and footer.
pub const MAX_PAYLOAD: usize = 28;

/// Header, LEN, command and footer.
const OVERHEAD: usize = 5;

/// A request or a reply: a reply repeats the command of its request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// The command's byte.
    pub command: u8,
    /// At most [`MAX_PAYLOAD`] bytes; more cannot be sent.
    pub payload: Vec<u8>,
}

impl Frame {
    /// The frame on the wire. A payload that is too long is cut, which no command of this crate has.
    pub fn encode(&self) -> Vec<u8> {
        let payload = self.payload.get(..MAX_PAYLOAD).unwrap_or(&self.payload);
        let mut bytes = Vec::with_capacity(payload.len() + OVERHEAD);
        bytes.extend([HEADER, HEADER, payload.len() as u8 + 2, self.command]);
        bytes.extend(payload);
        bytes.push(FOOTER);
        bytes
    }
}

/// Finds frames in what comes in, whole or in pieces, with anything in between.
///
/// Where a frame that has begun turns out not to be one (its length is impossible, or there is no footer where the
/// length says), one byte is dropped and the search goes on behind it: garbage that looks like a header costs nothing
/// of what follows.
#[derive(Debug, Clone, Default)]
pub struct FrameReader {
    pending: Vec<u8>,
    skipped: u64,
}

impl FrameReader {
    /// Takes in bytes of the line.
    pub fn push(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
    }

    /// The next whole frame, if there is one.
    pub fn next_frame(&mut self) -> Option<Frame> {
        let mut start = 0;
        let mut found = None;
        while let Some(rest) = self.pending.get(start..).filter(|rest| !rest.is_empty()) {
            match Candidate::at(rest) {
                Candidate::Frame(frame, length) => {
                    found = Some((frame, start + length));
                    break;
                }
                Candidate::Incomplete => break,
                Candidate::Garbage => start += 1,
            }
        }
        self.skipped += start as u64;
        let end = found.as_ref().map_or(start, |(_, end)| *end);
        self.pending.drain(..end.min(self.pending.len()));
        found.map(|(frame, _)| frame)
    }

    /// The next whole frame once nothing more comes: what has begun and not ended was no frame, and hides none behind
    /// it. Afterwards, when there is none left, nothing is pending.
    pub fn next_after_gap(&mut self) -> Option<Frame> {
        loop {
            if let Some(frame) = self.next_frame() {
                return Some(frame);
            }
            if self.pending.is_empty() {
                return None;
            }
            self.pending.remove(0);
            self.skipped += 1;
        }
    }

    /// How many bytes wait for the rest of their frame.
    pub fn pending(&self) -> usize {
        self.pending.len()
    }

    /// How many bytes were dropped so far because they were part of no frame.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }
}

/// What the bytes at one place can be.
enum Candidate {
    Frame(Frame, usize),
    Incomplete,
    Garbage,
}

impl Candidate {
    fn at(bytes: &[u8]) -> Self {
        match *bytes {
            [HEADER] | [HEADER, HEADER] => Self::Incomplete,
            [HEADER, HEADER, length, ref rest @ ..] => {
                let length = usize::from(length);
                if !(2..=MAX_PAYLOAD + 2).contains(&length) {
                    return Self::Garbage;
                }
                match rest.get(..length) {
                    None => Self::Incomplete,
                    Some([command, payload @ .., FOOTER]) => {
                        Self::Frame(Frame { command: *command, payload: payload.to_vec() }, length + 3)
                    }
                    Some(_) => Self::Garbage,
                }
            }
            _ => Self::Garbage,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Frame, FrameReader};

    const ANGLES: &[u8] = b"\xfe\xfe\x0e\x20\x00\x64\x00\xc8\x01\x2c\x01\x90\x01\xf4\x02\x58\xfa";

    fn read(pieces: &[&[u8]]) -> (Vec<Frame>, FrameReader) {
        let mut reader = FrameReader::default();
        let mut frames = Vec::new();
        for piece in pieces {
            reader.push(piece);
            while let Some(frame) = reader.next_frame() {
                frames.push(frame);
            }
        }
        (frames, reader)
    }

    #[test]
    fn a_frame_is_the_same_in_any_pieces() {
        for cut in 0..=ANGLES.len() {
            let (frames, reader) = read(&[&ANGLES[..cut], &ANGLES[cut..]]);
            assert_eq!(frames.len(), 1, "cut at {cut}");
            assert_eq!(frames[0].encode(), ANGLES);
            assert_eq!((reader.pending(), reader.skipped()), (0, 0));
        }
    }

    #[test]
    fn garbage_and_a_header_too_many_cost_no_frame() {
        for garbage in
            [&b"\x00\x11\xaa\x55"[..], b"\xfe", b"\xfe\xfe", b"\xfe\xfe\xff", b"\xfe\xfe\x03\x22\x01\x00"]
        {
            let (frames, reader) = read(&[garbage, ANGLES]);
            assert_eq!(frames.len(), 1, "{garbage:02x?}");
            assert_eq!(frames[0].encode(), ANGLES);
            assert_eq!(reader.skipped(), garbage.len() as u64);
        }
    }

    #[test]
    fn a_payload_may_look_like_a_header_and_a_footer() {
        let bytes = b"\xfe\xfe\x0e\x20\xfe\xfe\xfe\xfe\xfa\xfa\xff\xfa\x00\xfa\xff\xfe\xfa";
        let (frames, _) = read(&[bytes]);
        assert_eq!(frames.len(), 1);
        assert_eq!(frames[0].payload.len(), 12);
    }

    #[test]
    fn what_has_begun_ends_with_the_gap_and_hides_nothing() {
        let (frames, mut reader) = read(&[&ANGLES[..16]]);
        assert!(frames.is_empty());
        assert_eq!(reader.next_after_gap(), None);
        assert_eq!((reader.pending(), reader.skipped()), (0, 16));

        // The garbage claims 30 bytes: more than follow.
        let (frames, mut reader) = read(&[b"\xfe\xfe\x1e", ANGLES]);
        assert!(frames.is_empty());
        assert_eq!(reader.next_after_gap().map(|frame| frame.encode()), Some(ANGLES.to_vec()));
        assert_eq!((reader.pending(), reader.skipped()), (0, 3));
    }
}
