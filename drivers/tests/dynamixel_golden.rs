//! Bytes recorded from the makers' Python client (dynamixel-sdk 4.1.0), held against our packets, our simulated servos
//! and our bus.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a recording that cannot be read is a broken test")]

use dh_drivers::clock::{Clock, Time, VirtualClock};
use dh_drivers::driver::Cause;
use dh_drivers::dynamixel::control_table::{MODELS, REGISTERS};
use dh_drivers::dynamixel::instruction::{self, Spared};
use dh_drivers::dynamixel::packet::Packet;
use dh_drivers::dynamixel::{Bus, ServoSpec, SimulatedBus, Timing};
use dh_drivers::simulate::{SimulatedDevice, SimulatedPort};
use serde_json::Value;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

fn vectors(group: &str) -> Vec<Value> {
    let text = include_str!("golden/dynamixel2-golden.json");
    let all: Value = serde_json::from_str(text).unwrap();
    let of_group = |vector: &&Value| vector["group"] == group;
    all["vectors"].as_array().unwrap().iter().filter(of_group).cloned().collect()
}

fn bytes(hex: &Value) -> Vec<u8> {
    let hex = hex.as_str().unwrap();
    (0..hex.len()).step_by(2).map(|at| u8::from_str_radix(&hex[at..at + 2], 16).unwrap()).collect()
}

fn integer(value: &Value) -> i64 {
    value.as_i64().unwrap()
}

/// What the client was called with, as a packet of ours.
fn request(vector: &Value) -> Packet {
    let call = vector["call"].as_str().unwrap();
    let args = vector["args"].as_array().unwrap();
    let number = |place: usize| integer(&args[place]);
    let id = || number(0) as u8;
    let ids: Vec<u8> = args.iter().filter_map(Value::as_i64).map(|id| id as u8).collect();
    // Of `GroupSyncRead(132,4).txRxPacket`: 132 and 4.
    let within: Vec<u16> = call
        .split(['(', ')'])
        .nth(1)
        .map(|numbers| numbers.split(',').map(|number| number.parse().unwrap()).collect())
        .unwrap_or_default();
    let little_endian = |value: i64, length: usize| value.to_le_bytes()[..length].to_vec();
    let width = call.chars().find(char::is_ascii_digit).map_or(0, |digit| digit as usize - '0' as usize);
    match call.split('(').next().unwrap() {
        "ping" => instruction::ping(id()),
        "broadcastPing" => instruction::ping(254),
        "readTxRx" => instruction::read(id(), number(1) as u16, number(2) as u16),
        "regWriteTxRx" => {
            instruction::reg_write(id(), number(1) as u16, &little_endian(number(3), number(2) as usize))
        }
        "action" => instruction::action(id()),
        "reboot" => instruction::reboot(id()),
        "factoryReset" if number(1) == 2 => instruction::factory_reset(id(), Spared::IdAndBaud),
        "clearMultiTurn" => instruction::clear_turns(id()),
        "GroupSyncRead" if call.ends_with("fastSyncRead") => {
            instruction::fast_sync_read(&ids, within[0], within[1])
        }
        "GroupSyncRead" => instruction::sync_read(&ids, within[0], within[1]),
        "GroupSyncWrite" => {
            let data = args.iter().map(|entry| {
                let value = &entry[1];
                let data = match value.as_i64() {
                    Some(value) => little_endian(value, within[1].into()),
                    None => bytes(value),
                };
                (integer(&entry[0]) as u8, data)
            });
            let data: Vec<(u8, Vec<u8>)> = data.collect();
            let data = data.iter().map(|(id, data)| (*id, data.as_slice()));
            instruction::sync_write(within[0], within[1], data)
        }
        "GroupBulkRead.txRxPacket" => {
            let stretch = |entry: &Value| {
                (integer(&entry[0]) as u8, integer(&entry[1]) as u16, integer(&entry[2]) as u16)
            };
            instruction::bulk_read(&args.iter().map(stretch).collect::<Vec<_>>())
        }
        "GroupBulkWrite.txPacket" => {
            let data = args.iter().map(|entry| {
                let address = integer(&entry[1]) as u16;
                let register = REGISTERS.iter().find(|register| register.address == address).unwrap();
                let numbers = entry.as_array().unwrap();
                let data = little_endian(integer(numbers.last().unwrap()), register.size.into());
                (integer(&entry[0]) as u8, address, data)
            });
            let data: Vec<(u8, u16, Vec<u8>)> = data.collect();
            instruction::bulk_write(data.iter().map(|(id, address, data)| (*id, *address, data.as_slice())))
        }
        name if name.starts_with("read") => instruction::read(id(), number(1) as u16, width as u16),
        name if name.starts_with("write") => {
            instruction::write(id(), number(1) as u16, &little_endian(number(2), width))
        }
        name => panic!("{name} is not known"),
    }
}

#[test]
fn requests_are_the_clients() {
    let mut not_stuffed = 0;
    for vector in vectors("normal").into_iter().chain(vectors("fault")) {
        // The client does not stuff what it sends, against the protocol; the recording says what it should have sent.
        let expected = match vector.get("spec_correct_bytes_hex") {
            Some(correct) => {
                not_stuffed += 1;
                bytes(correct)
            }
            None => bytes(&vector["bytes_sent_hex"]),
        };
        assert_eq!(request(&vector).encode(), expected, "{}", vector["label"]);
    }
    assert_eq!(not_stuffed, 2);
}

/// The servos that answered the recording: two XL430, moving as fast as they can.
fn two_servos() -> SimulatedBus {
    let servo = |id| ServoSpec { id, model: &MODELS[0], baud: 57_600, position: 2048.0 };
    SimulatedBus::new([1, 2].map(servo))
}

/// All that the client sent, byte for byte, to simulated servos: they answer the same bytes. Ten seconds pass between
/// requests, as the servos that answered the recording were at every goal at once.
#[test]
fn simulated_servos_answer_the_same() {
    let mut bus = two_servos();
    let mut now = Time::START;
    for vector in vectors("normal") {
        now += Duration::from_secs(10);
        bus.receive(&bytes(&vector["bytes_sent_hex"]), now);
        now += Duration::from_secs(1);
        let answer: Vec<u8> = std::iter::from_fn(|| bus.send(now)).flatten().collect();
        // What answered the recording did not know the instruction, and said so. The e-manual has it for these servos.
        if vector["call"] == "clearMultiTurn" {
            assert_eq!(bytes(&vector["reply_hex_used"]), [0xff, 0xff, 0xfd, 0, 1, 4, 0, 0x55, 2, 0xae, 0x8c]);
            assert_eq!(answer, [0xff, 0xff, 0xfd, 0, 1, 4, 0, 0x55, 0, 0xa1, 0x0c]);
            continue;
        }
        assert_eq!(answer, bytes(&vector["reply_hex_used"]), "{}", vector["label"]);
    }
}

/// A device that answers the first request with pieces at given times after it, and nothing else.
#[derive(Debug)]
struct Script {
    pieces: VecDeque<(Duration, Vec<u8>)>,
    asked: Option<Time>,
}

impl SimulatedDevice for Script {
    fn receive(&mut self, _: &[u8], now: Time) {
        self.asked.get_or_insert(now);
    }
    fn advance(&mut self, _: Time) {}
    fn next_send(&self) -> Option<Time> {
        Some(self.asked? + self.pieces.front()?.0)
    }
    fn send(&mut self, now: Time) -> Option<Vec<u8>> {
        self.next_send().filter(|time| *time <= now)?;
        self.pieces.pop_front().map(|(_, bytes)| bytes)
    }
}

/// The reply of a vector, cut and delayed as its label says.
fn script(vector: &Value) -> Script {
    let (label, reply) = (vector["label"].as_str().unwrap(), bytes(&vector["reply_hex_used"]));
    let milliseconds =
        label.split(' ').find_map(|word| word.parse().ok()).map_or(Duration::ZERO, Duration::from_millis);
    let at_once = Duration::from_millis(1);
    let half = if label.starts_with("sync") { 15.min(reply.len()) } else { reply.len() / 2 };
    let pieces = if label.starts_with("split") || label.contains("between") || label.contains("second after")
    {
        vec![(at_once, reply[..half].to_vec()), (at_once + milliseconds, reply[half..].to_vec())]
    } else if label.starts_with("reply after") {
        vec![(milliseconds, reply)]
    } else {
        vec![(at_once, reply)]
    };
    Script { pieces: pieces.into(), asked: None }
}

/// What the client made of an answer, and what the bus makes of it in one attempt.
#[test]
fn broken_answers_are_judged_as_the_client_does_or_better() {
    for vector in vectors("fault") {
        let label = vector["label"].as_str().unwrap();
        let clock = Arc::new(VirtualClock::new());
        let device = Arc::new(Mutex::new(script(&vector)));
        let port = SimulatedPort::new(device, clock.clone());
        let mut bus = Bus::new(Box::new(port), Timing { attempts: 1, ..Timing::default() });
        let packet = request(&vector);
        let before = clock.now();
        let outcome = match packet.instruction {
            instruction::READ => bus.read(1, 132, 4).map(|answer| vec![answer]),
            instruction::WRITE => bus.write(1, 116, &packet.parameters[2..]).map(|answer| vec![answer]),
            _ => bus.sync_read(&[1, 2], 132, 4),
        };
        assert!(clock.now() - before <= bus.longest(20, &[4, 4]), "{label}");
        let parsed = &vector["parsed_result"];
        let values: Vec<u32> = outcome.iter().flatten().map(|answer| value(&answer.data)).collect();
        let cause = outcome.as_ref().err().map(|error| &error.cause);
        match label {
            // The client takes the CRC for data, or the first of the bytes for what was asked for.
            "reply with fewer params (2 of 4)" | "reply with more params (6 of 4)" => {
                assert!(matches!(cause, Some(Cause::Silent { .. })), "{label}: {outcome:?}");
            }
            // The client raises an IndexError.
            "error reply without params (access error)" => {
                assert!(matches!(cause, Some(Cause::Refused { code: 7, .. })), "{label}: {outcome:?}");
            }
            // The client waits 42 ms for both; we grant the wire time of stuffed answers too, which makes 46.
            "sync read, second after 40 ms" => assert_eq!(values, [2048, 1500], "{label}"),
            // These the client has as numbers beside a success.
            "alert bit set, data fine" => {
                assert!(parsed["error"] == 128 && outcome.unwrap()[0].alert && values == [2048], "{label}");
            }
            "alert + data range error on write" => {
                assert!(matches!(cause, Some(Cause::Refused { code: 4, .. })), "{label}: {outcome:?}");
            }
            _ if label.starts_with("write status error") => {
                let Some(Cause::Refused { code, .. }) = cause else { panic!("{label}: {outcome:?}") };
                assert_eq!(integer(&parsed["error"]), i64::from(*code), "{label}");
            }
            _ if parsed["comm"] == "COMM_SUCCESS" => {
                let expected: Vec<u32> = ["value", "1", "2"]
                    .iter()
                    .filter_map(|key| parsed.get(key))
                    .map(|value| u32::try_from(value.as_u64().unwrap()).unwrap())
                    .collect();
                assert_eq!(values, expected, "{label}: {outcome:?}");
            }
            _ => {
                let error = outcome.expect_err(label);
                assert!(matches!(error.cause, Cause::Silent { .. } | Cause::Garbled), "{label}: {error}");
            }
        }
    }
}

fn value(data: &[u8]) -> u32 {
    u32::from_le_bytes(data.try_into().unwrap_or_default())
}
