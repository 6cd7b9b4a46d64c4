//! Dynamixel Protocol 2.0.

use super::parrot::Parrot;
use dh_drivers::clock::{Clock, Time, VirtualClock};
use dh_drivers::dynamixel::control_table::{MODELS, REGISTERS};
use dh_drivers::dynamixel::packet::{BROADCAST, Decoder, MAX_LENGTH, Packet, STATUS};
use dh_drivers::dynamixel::status::Status;
use dh_drivers::dynamixel::{Bus, ServoSpec, SimulatedBus, Timing};
use dh_drivers::simulate::{SimulatedDevice, SimulatedPort};
use std::sync::{Arc, Mutex};
use std::time::Duration;

fn all(decoder: &mut Decoder) -> impl Iterator<Item = Packet> {
    std::iter::from_fn(|| decoder.next_packet())
}

/// Packets are the same however the stream is cut, and each comes back from its own bytes.
pub(crate) fn packets(bytes: &[u8]) {
    let mut decoder = Decoder::new();
    decoder.push(bytes);
    let found: Vec<Packet> = all(&mut decoder).collect();
    let mut in_pieces = Decoder::new();
    let mut found_in_pieces = Vec::new();
    for piece in bytes.chunks(3) {
        in_pieces.push(piece);
        found_in_pieces.extend(all(&mut in_pieces));
    }
    assert_eq!(found, found_in_pieces);
    for packet in found {
        let fast = packet.id == BROADCAST && packet.instruction == STATUS;
        let again = if fast { packet.encode_unstuffed() } else { packet.encode() };
        if again.len() <= MAX_LENGTH {
            let mut decoder = Decoder::new();
            decoder.push(&again);
            assert!(all(&mut decoder).eq([packet.clone()]));
        }
        let status = Status::of_packet(&packet);
        assert!(status.is_none_or(|status| status.packet() == packet));
        let _ = Status::of_fast_packet(&packet, &[4, 4]);
        for register in REGISTERS {
            let _ = register.value_in(&packet.parameters, 120);
        }
    }
}

/// Whatever is answered, requests end in time, and answers are of the servos and lengths that were asked for.
pub(crate) fn bus(bytes: &[u8]) {
    let clock = Arc::new(VirtualClock::new());
    let device = Arc::new(Mutex::new(Parrot::saying(bytes)));
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
pub(crate) fn servos(bytes: &[u8]) {
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
                assert!(all(&mut decoder).all(|packet| packet.instruction == STATUS));
                assert!(decoder.is_empty() && decoder.broken() == 0, "{sent:02x?}");
            }
        }
    }
    bus.advance(now + Duration::from_secs(5));
    assert!(bus.servos().iter().all(|servo| servo.position().is_finite()));
}
