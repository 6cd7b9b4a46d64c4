//! What must hold of the drivers' parsers whatever the bytes: bodies of the fuzz targets, and of `tests/fuzz.rs`.
#![allow(dead_code, reason = "every fuzz target uses one of them")]
#![allow(clippy::expect_used, reason = "a panic is what is looked for")]

use dh_drivers::clock::{Clock, Time, VirtualClock};
use dh_drivers::driver::{Driver, JointMap};
use dh_drivers::dynamixel::control_table::{MODELS, REGISTERS};
use dh_drivers::dynamixel::packet::{BROADCAST, Decoder, MAX_LENGTH, Packet, STATUS};
use dh_drivers::dynamixel::status::Status;
use dh_drivers::dynamixel::{Bus, ServoSpec, SimulatedBus, Timing};
use dh_drivers::mycobot::{self, FrameReader, MyCobot, Reply, SimulatedMyCobot};
use dh_drivers::simulate::{SimulatedDevice, SimulatedPort};
use dh_runtime::dh_robot;
use std::sync::{Arc, Mutex};
use std::time::Duration;

fn packets(decoder: &mut Decoder) -> impl Iterator<Item = Packet> {
    std::iter::from_fn(|| decoder.next_packet())
}

/// Packets are the same however the stream is cut, and each comes back from its own bytes.
pub(crate) fn dynamixel_packets(bytes: &[u8]) {
    let mut decoder = Decoder::new();
    decoder.push(bytes);
    let found: Vec<Packet> = packets(&mut decoder).collect();
    let mut in_pieces = Decoder::new();
    let mut found_in_pieces = Vec::new();
    for piece in bytes.chunks(3) {
        in_pieces.push(piece);
        found_in_pieces.extend(packets(&mut in_pieces));
    }
    assert_eq!(found, found_in_pieces);
    for packet in found {
        let fast = packet.id == BROADCAST && packet.instruction == STATUS;
        let again = if fast { packet.encode_unstuffed() } else { packet.encode() };
        if again.len() <= MAX_LENGTH {
            let mut decoder = Decoder::new();
            decoder.push(&again);
            assert!(packets(&mut decoder).eq([packet.clone()]));
        }
        let status = Status::of_packet(&packet);
        assert!(status.is_none_or(|status| status.packet() == packet));
        let _ = Status::of_fast_packet(&packet, &[4, 4]);
        for register in REGISTERS {
            let _ = register.value_in(&packet.parameters, 120);
        }
    }
}

/// A device that answers everything with the same bytes.
#[derive(Debug)]
struct Parrot<'b>(&'b [u8], Vec<Time>);

impl SimulatedDevice for Parrot<'_> {
    fn receive(&mut self, _: &[u8], now: Time) {
        self.1.push(now + Duration::from_millis(1));
    }
    fn advance(&mut self, _: Time) {}
    fn next_send(&self) -> Option<Time> {
        self.1.first().copied()
    }
    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        self.next_send().filter(|time| *time <= now)?;
        self.1.remove(0);
        Some(self.0.to_vec())
    }
}

/// Whatever is answered, requests end in time, and answers are of the servos and lengths that were asked for.
pub(crate) fn dynamixel_bus(bytes: &[u8]) {
    let clock = Arc::new(VirtualClock::new());
    // The port must be 'static; so must what it answers.
    let bytes: &'static [u8] = Box::leak(bytes.to_vec().into_boxed_slice());
    let device = Arc::new(Mutex::new(Parrot(bytes, Vec::new())));
    let mut bus = Bus::new(Box::new(SimulatedPort::new(device, clock.clone())), Timing::default());
    let mut within = |request: &dyn Fn(&mut Bus)| {
        let (start, longest) = (clock.now(), bus.longest(20, &[4, 4]));
        request(&mut bus);
        assert!(clock.now() - start <= longest);
    };
    within(&|bus| {
        let _ = bus.ping(1);
    });
    within(&|bus| {
        let _ = bus.write(1, 116, &[0, 8, 0, 0]);
    });
    within(&|bus| {
        if let Ok(answer) = bus.read(1, 132, 4) {
            assert!(answer.id == 1 && answer.data.len() == 4);
        }
    });
    for fast in [false, true] {
        within(&|bus| {
            let read =
                if fast { bus.fast_sync_read(&[1, 2], 132, 4) } else { bus.sync_read(&[1, 2], 132, 4) };
            if let Ok(answers) = read {
                assert!(answers.iter().map(|answer| (answer.id, answer.data.len())).eq([(1, 4), (2, 4)]));
            }
        });
    }
}

/// Whatever they are sent, servos answer sound packets or nothing.
pub(crate) fn dynamixel_servos(bytes: &[u8]) {
    let servo =
        |id: u8| ServoSpec { id, model: &MODELS[usize::from(id % 3)], baud: 1_000_000, position: 2048.0 };
    let mut bus = SimulatedBus::new([1, 2].map(servo));
    let mut now = Time::START;
    let mut decoder = Decoder::new();
    for piece in bytes.chunks(64) {
        now += Duration::from_millis(7);
        bus.receive(piece, now);
        while let Some(time) = bus.next_send() {
            now = now.max(time);
            while let Some(sent) = bus.send(now) {
                decoder.push(&sent);
                assert!(packets(&mut decoder).all(|packet| packet.instruction == STATUS));
                assert!(decoder.is_empty() && decoder.broken() == 0, "{sent:02x?}");
            }
        }
    }
    bus.advance(now + Duration::from_secs(5));
    assert!(bus.servos().iter().all(|servo| servo.position().is_finite()));
}

/// Any arm of six joints.
#[dh_robot("mycobot")]
struct SixJoints;

/// Frames are the same however the stream is cut, come back from their own bytes, and no byte is lost or counted twice.
pub(crate) fn mycobot_frames(bytes: &[u8]) {
    let mut reader = FrameReader::default();
    reader.push(bytes);
    let found: Vec<_> = std::iter::from_fn(|| reader.next_frame()).collect();
    let mut in_pieces = FrameReader::default();
    let mut found_in_pieces = Vec::new();
    for piece in bytes.chunks(3) {
        in_pieces.push(piece);
        found_in_pieces.extend(std::iter::from_fn(|| in_pieces.next_frame()));
    }
    assert_eq!(found, found_in_pieces);
    let rest: Vec<_> = std::iter::from_fn(|| reader.next_after_gap()).collect();
    assert_eq!(reader.pending(), 0);
    let framed: usize = found.iter().chain(&rest).map(|frame| frame.encode().len()).sum();
    assert_eq!(framed + reader.skipped() as usize, bytes.len());
    for frame in found.into_iter().chain(rest) {
        let mut again = FrameReader::default();
        again.push(&frame.encode());
        assert_eq!(again.next_frame().as_ref(), Some(&frame));
        for command in mycobot::Command::ALL {
            let Ok(reply) = Reply::to(*command, frame.clone()) else { continue };
            assert_eq!(frame.command, *command as u8);
            let angles = reply.angles().is_ok_and(|angles| angles.iter().any(|angle| angle.abs() > 327.68));
            assert!(!angles);
            let _ = (reply.flag(), reply.word(), reply.coordinates(), reply.angles_and_coordinates());
            let _ = (reply.joint_limit(), reply.version(), reply.bytes::<6>());
        }
    }
}

/// Whatever is answered, calls end in time, and what is believed is what a joint can have.
pub(crate) fn mycobot_driver(bytes: &[u8]) {
    let clock = Arc::new(VirtualClock::new());
    // The port must be 'static; so must what it answers.
    let bytes: &'static [u8] = Box::leak(bytes.to_vec().into_boxed_slice());
    let device = Arc::new(Mutex::new(Parrot(bytes, Vec::new())));
    let port = SimulatedPort::new(device, clock.clone());
    let joints = JointMap::of_table(&SixJoints).expect("six joints with servos");
    let mut driver = MyCobot::new(Box::new(port), joints, mycobot::Model::Pi).expect("a myCobot's joints");
    let mut within = |seconds: u64, call: &dyn Fn(&mut MyCobot)| {
        let start = clock.now();
        call(&mut driver);
        assert!(clock.now() - start <= Duration::from_secs(seconds));
    };
    within(7, &|driver| {
        if let Ok(state) = driver.read_state() {
            for (joint, (min, max)) in state.joints.iter().zip(mycobot::ANGLES) {
                let widest = (max - min).to_radians();
                assert!(joint.position.is_finite() && joint.position.abs() <= widest, "{joint:?}");
            }
        }
    });
    within(7, &|driver| {
        let _ = driver.coordinates();
    });
    within(7, &|driver| {
        let _ = driver.set_color([1, 2, 3]);
    });
    within(13, &|driver| {
        let _ = driver.torque(true);
    });
    within(3, &|driver| {
        let _ = driver.stop();
    });
}

/// Whatever it is sent, the arm answers sound frames or nothing, and is somewhere.
pub(crate) fn mycobot_arm(bytes: &[u8]) {
    let arm = SimulatedMyCobot::new(Box::new(SixJoints), mycobot::Model::M5);
    let mut arm = arm.expect("six joints with servos");
    let mut now = Time::START;
    let mut reader = FrameReader::default();
    for piece in bytes.chunks(16) {
        now += Duration::from_millis(33);
        arm.receive(piece, now);
        while let Some(time) = arm.next_send() {
            now = now.max(time);
            while let Some(sent) = arm.send(now) {
                reader.push(&sent);
                assert!(reader.next_frame().is_some() && reader.pending() == 0 && reader.skipped() == 0);
            }
        }
    }
    arm.advance(now + Duration::from_secs(60));
    assert!(arm.positions().iter().all(|q| q.is_finite()), "{arm:?}");
}
