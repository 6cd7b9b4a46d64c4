//! The fuzz targets' bodies on the committed corpus, and on what so many mutations make of it.

#![expect(clippy::unwrap_used, reason = "a corpus that cannot be read is a broken test")]

#[path = "../fuzz/bodies/mod.rs"]
mod bodies;

use std::fs;
use std::path::Path;

/// `SplitMix64`
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % count.max(1) as u64) as usize
    }
}

fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 5, "{target} has a corpus of {}", files.len());
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}

/// Bytes that mean something to one protocol or another.
const TELLING: [u8; 10] = [0xff, 0xfd, 0xfe, 0xfa, 0x00, 0x01, 0x02, 0x55, 0x7f, 0x80];

fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let at = random.below(bytes.len() + 1);
    match random.below(7) {
        0 => bytes.insert(at, TELLING[random.below(TELLING.len())]),
        1 => bytes.truncate(at),
        2 => bytes.extend(other),
        3 => {
            let from = random.below(other.len() + 1);
            bytes.truncate(at);
            bytes.extend(&other[from..]);
        }
        4 if at < bytes.len() => {
            bytes.remove(at);
        }
        5 if at < bytes.len() => bytes[at] = TELLING[random.below(TELLING.len())],
        _ if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
        _ => {}
    }
}

fn run(target: &str, body: fn(&[u8]), rounds: usize) {
    let corpus = corpus(target);
    let mut random = Random(1);
    for bytes in &corpus {
        body(bytes);
    }
    for round in 0..rounds {
        let mut bytes = corpus[round % corpus.len()].clone();
        for _ in 0..=random.below(4) {
            let other = random.below(corpus.len());
            mutate(&mut bytes, &corpus[other], &mut random);
        }
        let outcome = std::panic::catch_unwind(|| body(&bytes));
        assert!(outcome.is_ok(), "{target}: {bytes:02x?}");
    }
}

#[test]
fn dynamixel_packets() {
    run("dynamixel_packets", bodies::dynamixel::packets, 100_000);
}

#[test]
fn dynamixel_bus() {
    run("dynamixel_bus", bodies::dynamixel::bus, 10_000);
}

#[test]
fn dynamixel_servos() {
    run("dynamixel_servos", bodies::dynamixel::servos, 20_000);
}

#[test]
fn mycobot_frames() {
    run("mycobot_frames", bodies::mycobot::frames, 100_000);
}

#[test]
fn mycobot_driver() {
    run("mycobot_driver", bodies::mycobot::driver, 3_000);
}

#[test]
fn mycobot_arm() {
    run("mycobot_arm", bodies::mycobot::arm, 10_000);
}
