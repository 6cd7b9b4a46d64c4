//! A bus on a bad line: whatever happens to frames, no answer is taken for another, and nothing hangs.

#![expect(clippy::unwrap_used, reason = "a device that is not there is a broken test")]

use dh_drivers::clock::{Clock, VirtualClock};
use dh_drivers::driver::{Cause, DriverError};
use dh_drivers::dynamixel::control_table::{
    FEEDFORWARD_1, LED, MODELS, POSITION_P, PROFILE_ACCELERATION, PROFILE_VELOCITY, Register,
};
use dh_drivers::dynamixel::{Bus, ServoSpec, SimulatedBus, Timing};
use dh_drivers::port::PortErrorKind;
use dh_drivers::simulate::{Faults, Faulty, SimulatedDevice, SimulatedPort};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;

const SERVOS: [u8; 4] = [2, 3, 4, 9];
const REGISTERS: [Register; 5] = [LED, POSITION_P, FEEDFORWARD_1, PROFILE_ACCELERATION, PROFILE_VELOCITY];

/// What each register may hold: one value, or several after a write that nothing was heard of.
type Possible = HashMap<(u8, u16), Vec<i64>>;

/// `xorshift64*`, by Marsaglia and Vigna.
struct Random(u64);

impl Random {
    fn below(&mut self, count: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) % count
    }
}

struct Run {
    clock: Arc<VirtualClock>,
    device: Arc<Mutex<Faulty<SimulatedBus>>>,
    bus: Bus,
    possible: Possible,
    random: Random,
    failed: u32,
    away: u32,
}

impl Run {
    fn new(faults: Faults, seed: u64) -> Self {
        let clock = Arc::new(VirtualClock::new());
        let servo = |id| ServoSpec { id, model: &MODELS[1], baud: 1_000_000, position: 2048.0 };
        let device = Faulty::new(SimulatedBus::new(SERVOS.map(servo)), faults, seed);
        let device = Arc::new(Mutex::new(device));
        let port = SimulatedPort::new(device.clone(), clock.clone());
        let bus = Bus::new(Box::new(port), Timing::default());
        let initial =
            |id, register: &Register| ((id, register.address), vec![MODELS[1].initial(register).unwrap()]);
        let possible =
            SERVOS.iter().flat_map(|id| REGISTERS.iter().map(move |register| initial(*id, register)));
        let possible = possible.collect();
        let random = Random(seed);
        Self { clock, device, bus, possible, random, failed: 0, away: 0 }
    }

    fn pick<T: Copy, const N: usize>(&mut self, from: [T; N]) -> T {
        from[self.random.below(N as u64) as usize]
    }

    /// An answer must be possible; then it is what the register holds.
    fn read(&mut self, id: u8, register: &Register, data: &[u8]) {
        let value = register.value(data).unwrap();
        let possible = self.possible.get_mut(&(id, register.address)).unwrap();
        assert!(possible.contains(&value), "servo {id}, {}: {value}, not {possible:?}", register.name);
        *possible = vec![value];
    }

    /// A new value; where it is not sure that it arrived, the old ones stay possible.
    fn written(&mut self, id: u8, register: &Register, value: i64, sure: bool) {
        let possible = self.possible.get_mut(&(id, register.address)).unwrap();
        if sure {
            possible.clear();
        }
        possible.push(value);
    }

    fn value(&mut self, register: &Register) -> i64 {
        let limit = if *register == PROFILE_VELOCITY { 300 } else { register.range.1 };
        self.random.below(limit as u64 + 1) as i64
    }

    /// Only what a bad line does may go wrong.
    fn judge<T>(&mut self, outcome: Result<T, DriverError>) -> Option<T> {
        outcome
            .map_err(|error| match error.cause {
                Cause::Silent { .. } | Cause::Garbled => self.failed += 1,
                Cause::Port(ref port) if port.kind == PortErrorKind::Gone => self.away += 1,
                _ => unreachable!("{error}"),
            })
            .ok()
    }

    fn operation(&mut self) {
        let (id, register) = (self.pick(SERVOS), self.pick(REGISTERS));
        let (address, size) = (register.address, register.size);
        let start = self.clock.now();
        match self.random.below(9) {
            0 => {
                let outcome = self.bus.ping(id);
                if let Some(identity) = self.judge(outcome) {
                    assert_eq!((identity.id, identity.model, identity.firmware), (id, 1020, 46));
                }
            }
            1 | 2 => {
                let outcome = self.bus.read(id, address, size);
                if let Some(answer) = self.judge(outcome) {
                    self.read(id, &register, &answer.data);
                }
            }
            3 | 4 => {
                let value = self.value(&register);
                let outcome = self.bus.write(id, address, &register.bytes(value));
                let sure = self.judge(outcome).is_some();
                self.written(id, &register, value, sure);
            }
            5 => {
                let values: Vec<i64> = SERVOS.iter().map(|_| self.value(&register)).collect();
                let data: Vec<_> =
                    SERVOS.iter().zip(&values).map(|(id, value)| (*id, register.bytes(*value))).collect();
                let outcome = self.bus.sync_write(address, &data);
                self.judge(outcome);
                for (id, value) in SERVOS.iter().zip(values) {
                    self.written(*id, &register, value, false);
                }
            }
            6 => {
                // Refused, and nothing else may ever be: `judge` would not take it.
                let error = self.bus.write(id, LED.address, &[2]).unwrap_err();
                if !matches!(error.cause, Cause::Refused { code: 4, .. }) {
                    self.judge::<()>(Err(error));
                }
            }
            group => {
                let outcome = match group {
                    7 => self.bus.sync_read(&SERVOS, address, size),
                    _ => self.bus.fast_sync_read(&SERVOS, address, size),
                };
                if let Some(answers) = self.judge(outcome) {
                    assert!(answers.iter().map(|answer| answer.id).eq(SERVOS));
                    for answer in answers {
                        self.read(answer.id, &register, &answer.data);
                    }
                }
            }
        }
        let longest = self.bus.longest(30, &[size.into(); 4]);
        let took = self.clock.now() - start;
        assert!(took <= longest, "{took:?} instead of {longest:?}");
        // Programs do other things too.
        if self.random.below(4) == 0 {
            self.clock.advance(Duration::from_micros(self.random.below(20_000)));
        }
    }
}

/// 10,000 operations with 5 % of all frames lost, late, split, broken or double, for several lines; on some of them late
/// is later than what is waited for.
#[test]
fn nothing_is_answered_wrongly_on_a_bad_line() {
    for (seed, delay, most) in [(1, 20, 20), (2, 60, 20), (3, 200, 400)] {
        let mut run = Run::new(Faults::evenly(0.05, Duration::from_millis(delay)), seed);
        for _ in 0..10_000 {
            run.operation();
        }
        let mut device = run.device.lock().unwrap();
        device.advance(run.clock.now() + Duration::from_secs(10));
        for ((id, address), possible) in &run.possible {
            let register = REGISTERS.iter().find(|register| register.address == *address).unwrap();
            let held = device.device.servo(*id).unwrap().get(register);
            assert!(possible.contains(&held), "servo {id}, {}: {held}, not {possible:?}", register.name);
        }
        let injected = device.injected;
        println!("late up to {delay} ms: {injected:?}; {} of 10000 operations failed", run.failed);
        assert!(injected.total() > 500 && run.failed < most && run.away == 0, "{} {injected:?}", run.failed);
    }
}

/// The plug is pulled, again and again: the bus comes back by itself.
#[test]
fn comes_back_after_every_cut() {
    let mut run = Run::new(Faults::evenly(0.05, Duration::from_millis(60)), 4);
    for _ in 0..20 {
        let now = run.clock.now();
        let (from, until) = (now + Duration::from_millis(300), now + Duration::from_millis(700));
        run.device.lock().unwrap().unplug(from, until);
        while run.clock.now() < until {
            run.operation();
            run.clock.advance(Duration::from_millis(5));
        }
        let away = run.away;
        for _ in 0..50 {
            run.operation();
        }
        // One more at most: what finds out that the line is another one now.
        assert!(run.away <= away + 1, "{} after {away}", run.away);
    }
    assert!(run.away >= 20 * 10);
}
