//! A bad line.

use super::SimulatedDevice;
use crate::clock::Time;
use std::collections::VecDeque;
use std::time::Duration;

/// What goes wrong on a line, and how often: probabilities a frame, each from 0 to 1, of which at most one comes true.
/// A frame is what one write carries, in either direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Faults {
    /// The frame is lost.
    pub drop: f64,
    /// The frame comes late, by up to [`Faults::delay`].
    pub late: f64,
    /// The frame comes in two parts, the second late.
    pub split: f64,
    /// One to three bits of the frame are wrong.
    pub corrupt: f64,
    /// The frame comes twice.
    pub duplicate: f64,
    /// How late is late, at most.
    pub delay: Duration,
}

impl Faults {
    /// This part of all frames suffers, each kind as often as the others.
    pub fn evenly(part: f64, delay: Duration) -> Self {
        let each = part / 5.0;
        Self { drop: each, late: each, split: each, corrupt: each, duplicate: each, delay }
    }
}

/// How many frames went through, and what befell them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(missing_docs, reason = "the names are those of Faults")]
pub struct Injected {
    /// All frames.
    pub frames: u64,
    pub dropped: u64,
    pub late: u64,
    pub split: u64,
    pub corrupted: u64,
    pub duplicated: u64,
}

impl Injected {
    /// All frames that something befell.
    pub fn total(&self) -> u64 {
        self.dropped + self.late + self.split + self.corrupted + self.duplicated
    }
}

/// A device on a bad line. The same seed and the same traffic give the same faults.
#[derive(Debug)]
pub struct Faulty<D> {
    /// The device itself.
    pub device: D,
    /// What goes wrong from now on.
    pub faults: Faults,
    /// What went wrong so far.
    pub injected: Injected,
    random: Random,
    /// Frames on their way to the device and from it, with when they arrive.
    inward: VecDeque<(Time, Vec<u8>)>,
    outward: VecDeque<(Time, Vec<u8>)>,
    /// The line is pulled from the first time on, until the second.
    unplugged: Option<(Time, Time)>,
}

impl<D: SimulatedDevice> Faulty<D> {
    /// Puts the device on such a line.
    pub fn new(device: D, faults: Faults, seed: u64) -> Self {
        Self {
            device,
            faults,
            injected: Injected::default(),
            random: Random(seed),
            inward: VecDeque::new(),
            outward: VecDeque::new(),
            unplugged: None,
        }
    }

    /// Begins another sequence of chances.
    pub fn seed(&mut self, seed: u64) {
        self.random = Random(seed);
    }

    /// Pulls the plug for a while. The device itself goes on.
    pub fn unplug(&mut self, from: Time, until: Time) {
        self.unplugged = Some((from, until));
    }

    /// What becomes of a frame: its parts, and how much later than they should each arrives.
    fn pass(&mut self, bytes: Vec<u8>) -> Vec<(Duration, Vec<u8>)> {
        self.injected.frames += 1;
        let Faults { drop, late, split, corrupt, duplicate, delay } = self.faults;
        let mut dice = self.random.unit();
        let mut strikes = |probability: f64| {
            let struck = (0.0..probability).contains(&dice);
            dice -= probability;
            struck
        };
        let (drop, late, split, corrupt) = (strikes(drop), strikes(late), strikes(split), strikes(corrupt));
        let duplicate = strikes(duplicate);
        let wait = delay.mul_f64(self.random.unit());
        if drop {
            self.injected.dropped += 1;
            vec![]
        } else if late {
            self.injected.late += 1;
            vec![(wait, bytes)]
        } else if split {
            self.injected.split += 1;
            let at = self.random.below(bytes.len());
            let (first, second) = bytes.split_at_checked(at).unwrap_or((&bytes, &[]));
            vec![(Duration::ZERO, first.to_vec()), (wait, second.to_vec())]
        } else if corrupt {
            self.injected.corrupted += 1;
            let mut bytes = bytes;
            for _ in 0..=self.random.below(3) {
                let (at, bit) = (self.random.below(bytes.len()), self.random.below(8));
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << bit;
                }
            }
            vec![(Duration::ZERO, bytes)]
        } else if duplicate {
            self.injected.duplicated += 1;
            vec![(Duration::ZERO, bytes.clone()), (Duration::ZERO, bytes)]
        } else {
            vec![(Duration::ZERO, bytes)]
        }
    }

    /// Lets the device have what has arrived, and takes what it sends, in the order of time.
    fn run(&mut self, now: Time) {
        loop {
            let arrives = self.inward.front().map(|(time, _)| *time).filter(|time| *time <= now);
            let sends = self.device.next_send().filter(|time| *time <= now);
            match (arrives, sends) {
                (Some(time), sends) if sends.is_none_or(|sends| time <= sends) => {
                    if let Some((time, bytes)) = self.inward.pop_front() {
                        self.device.receive(&bytes, time);
                    }
                }
                (_, Some(time)) => {
                    let Some(bytes) = self.device.send(time) else { return };
                    for (wait, part) in self.pass(bytes) {
                        insert(&mut self.outward, time + wait, part);
                    }
                }
                _ => break,
            }
        }
        self.device.advance(now);
    }
}

/// Bytes do not overtake each other on a line: what follows something late is late too.
fn insert(line: &mut VecDeque<(Time, Vec<u8>)>, time: Time, bytes: Vec<u8>) {
    let last = line.back().map_or(Time::START, |(time, _)| *time);
    if !bytes.is_empty() {
        line.push_back((time.max(last), bytes));
    }
}

impl<D: SimulatedDevice> SimulatedDevice for Faulty<D> {
    fn receive(&mut self, bytes: &[u8], now: Time) {
        for (wait, part) in self.pass(bytes.to_vec()) {
            insert(&mut self.inward, now + wait, part);
        }
        self.run(now);
    }

    fn advance(&mut self, now: Time) {
        self.run(now);
    }

    fn next_send(&self) -> Option<Time> {
        let queued = [self.inward.front(), self.outward.front()].into_iter().flatten();
        queued.map(|(time, _)| *time).chain(self.device.next_send()).min()
    }

    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        self.run(now);
        self.outward.front().filter(|(time, _)| *time <= now)?;
        self.outward.pop_front().map(|(_, bytes)| bytes)
    }

    fn connected(&self, now: Time) -> bool {
        let pulled = self.unplugged.is_some_and(|(from, until)| from <= now && now < until);
        !pulled && self.device.connected(now)
    }
}

/// `SplitMix64`, by Steele, Lea and Flood (2014).
#[derive(Debug)]
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 to 1.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From 0 to less than `count`; 0 where that is 0.
    fn below(&mut self, count: usize) -> usize {
        self.next().checked_rem(count as u64).unwrap_or(0) as usize
    }
}
