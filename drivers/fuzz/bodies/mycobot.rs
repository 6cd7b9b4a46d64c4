//! The myCobot's protocol.

use super::parrot::Parrot;
use dh_drivers::clock::{Clock, Time, VirtualClock};
use dh_drivers::driver::{Driver, JointMap};
use dh_drivers::mycobot::{Command, Frame, FrameReader, Model, MyCobot, Reply, SimulatedMyCobot};
use dh_drivers::simulate::{SimulatedDevice, SimulatedPort};
use dh_runtime::dh_robot;
use std::sync::{Arc, Mutex};
use std::time::Duration;

#[dh_robot("mycobot")]
struct Arm;

fn all(reader: &mut FrameReader) -> Vec<Frame> {
    std::iter::from_fn(|| reader.next_frame()).collect()
}

/// Frames are the same however the stream is cut, each comes back from its own bytes, and whatever it says is read or
/// refused.
pub(crate) fn frames(bytes: &[u8]) {
    let mut reader = FrameReader::default();
    reader.push(bytes);
    let found = all(&mut reader);
    let mut in_pieces = FrameReader::default();
    let mut found_in_pieces = Vec::new();
    for piece in bytes.chunks(3) {
        in_pieces.push(piece);
        found_in_pieces.extend(all(&mut in_pieces));
    }
    assert_eq!(found, found_in_pieces);
    while reader.next_after_gap().is_some() {}
    for frame in found {
        let mut reader = FrameReader::default();
        reader.push(&frame.encode());
        assert_eq!(all(&mut reader), std::slice::from_ref(&frame));
        let Some(command) = Command::of_byte(frame.command) else { continue };
        if let Ok(reply) = Reply::to(command, frame) {
            let _ = (reply.byte(), reply.flag(), reply.word(), reply.joint_limit(), reply.version());
            assert!(reply.angles().iter().flatten().all(|angle| angle.is_finite()));
            let _ = (reply.coordinates(), reply.angles_and_coordinates());
        }
    }
}

/// Whatever is answered, calls end, in half a minute at the most, and positions that are believed are such that the arm
/// can be there.
pub(crate) fn driver(bytes: &[u8]) {
    let clock = Arc::new(VirtualClock::new());
    let device = Arc::new(Mutex::new(Parrot::saying(bytes)));
    let port = SimulatedPort::new(device, clock.clone());
    let map = JointMap::of_table(&Arm).unwrap();
    let mut arm = MyCobot::new(Box::new(port), map, Model::Pi).unwrap();
    let mut within = |call: &mut dyn FnMut(&mut MyCobot)| {
        let start = clock.now();
        call(&mut arm);
        assert!(clock.now() - start <= Duration::from_secs(30));
    };
    within(&mut |arm| {
        if let Ok(state) = arm.read_state() {
            assert!(state.positions().iter().all(|q| q.abs() < 6.3));
        }
    });
    within(&mut |arm| {
        let _ = arm.torque(true);
    });
    within(&mut |arm| {
        let _ = arm.stop();
    });
}

/// Whatever it is sent, the arm answers whole frames or nothing, and stays somewhere.
pub(crate) fn arm(bytes: &[u8]) {
    let mut device = SimulatedMyCobot::new(Box::new(Arm), Model::Pi).unwrap();
    let mut now = Time::START;
    let mut reader = FrameReader::default();
    for piece in bytes.chunks(64) {
        now += Duration::from_millis(20);
        device.receive(piece, now);
        while let Some(time) = device.next_send() {
            now = now.max(time);
            while let Some(sent) = device.send(now) {
                reader.push(&sent);
                assert!(!all(&mut reader).is_empty() && reader.pending() == 0, "{sent:02x?}");
            }
        }
    }
    device.advance(now + Duration::from_secs(5));
    assert!(device.positions().iter().all(|q| q.is_finite()));
}
