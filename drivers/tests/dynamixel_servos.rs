//! What simulated servos do, asked by the bus: the e-manual's rules, one a test.

#![expect(clippy::unwrap_used, reason = "a servo that does not answer is a failure")]

use dh_drivers::clock::{Clock, Time, VirtualClock};
use dh_drivers::driver::Cause;
use dh_drivers::dynamixel::control_table::{
    BUS_WATCHDOG, DRIVE_MODE, FIRMWARE, GOAL_CURRENT, GOAL_POSITION, HARDWARE_ERROR, HOMING_OFFSET, ID, LED,
    MAX_POSITION, MODELS, MOVING, OPERATING_MODE, POSITION_P, PRESENT_POSITION, PRESENT_VELOCITY,
    PROFILE_ACCELERATION, PROFILE_VELOCITY, REALTIME_TICK, REGISTERED, RETURN_DELAY, Register, STATUS_RETURN,
    TORQUE,
};
use dh_drivers::dynamixel::instruction::Spared;
use dh_drivers::dynamixel::{Bus, Confirmed, ServoSpec, SimulatedBus, Timing};
use dh_drivers::simulate::{SimulatedDevice, SimulatedPort};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// An XL430 of id 1 and an XM430 of id 2, at 2048 and 1000 ticks.
struct Bench {
    clock: Arc<VirtualClock>,
    device: Arc<Mutex<SimulatedBus>>,
    bus: Bus,
}

impl Bench {
    fn new() -> Self {
        let clock = Arc::new(VirtualClock::new());
        let servo =
            |id: u8, position| ServoSpec { id, model: &MODELS[usize::from(id) - 1], baud: 57_600, position };
        let device = Arc::new(Mutex::new(SimulatedBus::new([servo(1, 2048.0), servo(2, 1000.0)])));
        let port = SimulatedPort::new(device.clone(), clock.clone());
        let bus = Bus::new(Box::new(port), Timing::default());
        Self { clock, device, bus }
    }

    fn wait(&self, milliseconds: u64) {
        self.clock.advance(Duration::from_millis(milliseconds));
    }

    fn read(&mut self, id: u8, register: &Register) -> i64 {
        register.value(&self.bus.read(id, register.address, register.size).unwrap().data).unwrap()
    }

    /// 0, or the number of the refusal.
    fn write(&mut self, id: u8, register: &Register, value: i64) -> u8 {
        match self.bus.write(id, register.address, &register.bytes(value)).map_err(|error| error.cause) {
            Ok(_) => 0,
            Err(Cause::Refused { code, .. }) => code,
            Err(other) => unreachable!("{other}"),
        }
    }
}

#[test]
fn nothing_moves_without_torque_but_all_is_read() {
    let mut bench = Bench::new();
    assert_eq!(bench.write(1, &GOAL_POSITION, 3000), 0);
    bench.wait(1000);
    assert_eq!(bench.read(1, &PRESENT_POSITION), 2048);
    assert_eq!(bench.write(1, &TORQUE, 1), 0);
    bench.wait(1000);
    assert_eq!((bench.read(1, &PRESENT_POSITION), bench.read(1, &GOAL_POSITION)), (2048, 2048), "it holds");
    assert_eq!(bench.write(1, &GOAL_POSITION, 3000), 0);
    bench.wait(50);
    assert!(bench.read(1, &MOVING) == 1 && bench.read(1, &PRESENT_VELOCITY) > 0);
    assert_eq!(bench.write(1, &TORQUE, 0), 0);
    let fallen = bench.read(1, &PRESENT_POSITION);
    bench.wait(1000);
    assert_eq!((bench.read(1, &PRESENT_POSITION), bench.read(1, &PRESENT_VELOCITY)), (fallen, 0));
}

/// 952 ticks at 100 units of velocity (1563.3 ticks/s) and 20 of acceleration (4882.8 ticks/s²): v/a + d/v = 929 ms.
#[test]
fn profiles_take_their_time() {
    let mut bench = Bench::new();
    for (register, value) in [(&PROFILE_VELOCITY, 100), (&PROFILE_ACCELERATION, 20), (&TORQUE, 1)] {
        assert_eq!(bench.write(1, register, value), 0);
    }
    assert_eq!(bench.write(1, &GOAL_POSITION, 3000), 0);
    // It was told one return delay and the time of eleven bytes ago.
    let told = bench.clock.now().since_start().as_secs_f64() - (500e-6 + 1910e-6);
    bench.wait(500);
    assert_eq!(bench.read(1, &PRESENT_VELOCITY), 100);
    let speed = 0.229 / 60.0 * 4096.0 * 100.0;
    let acceleration = 214.577 / 3600.0 * 4096.0 * 20.0;
    let arrival = told + speed / acceleration + 952.0 / speed;
    for (time, arrives) in [(arrival - 1e-3, false), (arrival + 1e-3, true)] {
        let time = Time::after_start(Duration::from_secs_f64(time));
        let mut device = bench.device.lock().unwrap();
        device.advance(time);
        assert_eq!(device.servo(1).unwrap().velocity() == 0.0, arrives, "{:?}", device.servo(1));
    }
    bench.wait(30);
    assert_eq!((bench.read(1, &PRESENT_POSITION), bench.read(1, &MOVING)), (3000, 0));
}

#[test]
fn refusals_have_the_right_numbers() {
    let mut bench = Bench::new();
    let mut refused = |id, register: &Register, value| bench.write(id, register, value);
    assert_eq!(refused(1, &LED, 2), 4, "range");
    assert_eq!(refused(1, &FIRMWARE, 1), 7, "read-only");
    assert_eq!(refused(1, &GOAL_CURRENT, 1), 7, "an XL430 has no current");
    assert_eq!(refused(2, &GOAL_CURRENT, 1194), 4, "more than the current limit");
    assert_eq!(refused(1, &PROFILE_VELOCITY, 266), 4, "more than the velocity limit");
    assert_eq!(refused(1, &MAX_POSITION, 3000), 0);
    assert_eq!(refused(1, &GOAL_POSITION, 3001), 6, "outside the servo's limits");
    assert_eq!(refused(1, &TORQUE, 1), 0);
    assert_eq!(refused(1, &MAX_POSITION, 4095), 7, "EEPROM is locked while torque is on");
    assert_eq!(refused(1, &DRIVE_MODE, 0), 7);
    assert_eq!(refused(1, &TORQUE, 0), 0);
    let cause = |outcome: Result<_, dh_drivers::DriverError>| match outcome.unwrap_err().cause {
        Cause::Refused { code, .. } => code,
        other => unreachable!("{other}"),
    };
    assert_eq!(cause(bench.bus.write(1, 116, &[1, 2]).map(|_| ())), 5, "too short");
    assert_eq!(cause(bench.bus.write(1, 118, &[1, 2]).map(|_| ())), 7, "the middle of a register");
    assert_eq!(cause(bench.bus.write(1, 64, &[1, 2]).map(|_| ())), 4, "all or nothing: the LED takes no 2");
    assert_eq!(bench.read(1, &TORQUE), 0);
    assert_eq!(cause(bench.bus.read(1, 148, 4).map(|_| ())), 7, "nothing is there");
    assert_eq!(cause(bench.bus.action(1).map(|_| ())), 2, "nothing is registered");
}

#[test]
fn registered_writes_wait_for_the_action() {
    let mut bench = Bench::new();
    for id in [1, 2] {
        bench.bus.reg_write(id, LED.address, &[1]).unwrap();
        assert_eq!((bench.read(id, &REGISTERED), bench.read(id, &LED)), (1, 0));
    }
    bench.bus.action_of_all().unwrap();
    assert_eq!((bench.read(1, &LED), bench.read(2, &LED), bench.read(1, &REGISTERED)), (1, 1, 0));
    assert!(bench.bus.reg_write(1, GOAL_POSITION.address, &GOAL_POSITION.bytes(5000)).is_err());
}

#[test]
fn groups_read_and_write_at_once() {
    let mut bench = Bench::new();
    bench.bus.sync_write(POSITION_P.address, &[(1, vec![1, 0]), (2, vec![2, 0])]).unwrap();
    bench
        .bus
        .bulk_write(&[(1, LED.address, vec![1]), (2, PROFILE_VELOCITY.address, vec![9, 0, 0, 0])])
        .unwrap();
    let data = |answers: Vec<dh_drivers::dynamixel::Answer>| -> Vec<Vec<u8>> {
        answers.into_iter().map(|answer| answer.data).collect()
    };
    let gains = [vec![1, 0], vec![2, 0]];
    assert_eq!(data(bench.bus.sync_read(&[1, 2], POSITION_P.address, 2).unwrap()), gains);
    assert_eq!(data(bench.bus.fast_sync_read(&[1, 2], POSITION_P.address, 2).unwrap()), gains);
    let stretches = [(2, PROFILE_VELOCITY.address, 4), (1, LED.address, 1)];
    assert_eq!(data(bench.bus.bulk_read(&stretches).unwrap()), [vec![9, 0, 0, 0], vec![1]]);
    let error = bench.bus.sync_read(&[1, 7], POSITION_P.address, 2).unwrap_err();
    assert_eq!(error.joint.as_deref(), Some("servo 7"), "the one that is not there is named");
    let uneven = bench.bus.sync_write(LED.address, &[(1, vec![1]), (2, vec![1, 1])]).unwrap_err();
    assert_eq!(uneven.cause, Cause::Length { expected: 1, got: 2 });
}

/// Every four bytes of those that the protocol stuffs, through both codecs and the servo's memory.
#[test]
fn what_must_be_stuffed_comes_back() {
    let mut bench = Bench::new();
    assert_eq!(bench.write(1, &OPERATING_MODE, 4), 0);
    for value in [-131_073, -2, -1, 0, 1] {
        assert_eq!(bench.write(1, &HOMING_OFFSET, value), 0);
        assert_eq!(bench.read(1, &HOMING_OFFSET), value);
        assert_eq!(bench.read(1, &PRESENT_POSITION), 2048 + value);
    }
    for code in 0..3_u32.pow(6) {
        let bytes: Vec<u8> =
            (0..6).map(|place| [0xff, 0xfd, 0x00][(code / 3_u32.pow(place) % 3) as usize]).collect();
        // The indirect data: six bytes that mean nothing to the servo.
        bench.bus.write(2, 224, &bytes).unwrap();
        assert_eq!(bench.bus.read(2, 224, 6).unwrap().data, bytes);
        assert_eq!(bench.bus.fast_sync_read(&[2], 224, 6).unwrap()[0].data, bytes);
    }
}

#[test]
fn indirect_data_is_elsewhere() {
    let mut bench = Bench::new();
    // 224 and 225 become the two bytes of the position gain.
    let addresses = [POSITION_P.address.to_le_bytes(), (POSITION_P.address + 1).to_le_bytes()].concat();
    bench.bus.write(1, 168, &addresses).unwrap();
    bench.bus.write(1, 224, &[0x34, 0x12]).unwrap();
    assert_eq!(bench.read(1, &POSITION_P), 0x1234);
    assert_eq!(bench.bus.read(1, 224, 2).unwrap().data, [0x34, 0x12]);
}

#[test]
fn the_return_level_says_what_is_answered() {
    let mut bench = Bench::new();
    assert_eq!(bench.write(1, &STATUS_RETURN, 1), 0);
    assert!(matches!(bench.bus.write(1, LED.address, &[1]).unwrap_err().cause, Cause::Silent { .. }));
    assert_eq!(bench.read(1, &LED), 1, "done, though not answered");
    bench.bus.sync_write(STATUS_RETURN.address, &[(1, vec![0])]).unwrap();
    assert!(matches!(bench.bus.read(1, LED.address, 1).unwrap_err().cause, Cause::Silent { .. }));
    assert_eq!(bench.bus.ping(1).unwrap().model, 1060);
}

#[test]
fn the_return_delay_is_kept() {
    let mut bench = Bench::new();
    let mut took = |delay: i64| {
        assert_eq!(bench.write(1, &RETURN_DELAY, delay), 0);
        let start = bench.clock.now();
        bench.bus.read(1, LED.address, 1).unwrap();
        bench.clock.now() - start
    };
    let (longest, none) = (took(254), took(0));
    assert_eq!(longest, none + Duration::from_micros(508));
    // Twelve bytes at 57600 bits per second.
    assert!((none.as_secs_f64() - 120.0 / 57_600.0).abs() < 1e-6, "{none:?}");
}

#[test]
fn errors_are_latched_until_a_reboot() {
    let mut bench = Bench::new();
    assert_eq!(bench.write(1, &TORQUE, 1), 0);
    bench.device.lock().unwrap().servo_mut(1).unwrap().latch(0b100);
    let answer = bench.bus.read(1, TORQUE.address, 1).unwrap();
    assert!(answer.alert && answer.data == [0], "the alert is told, torque is off");
    assert_eq!(bench.write(1, &TORQUE, 1), 1);
    assert_eq!(bench.read(1, &HARDWARE_ERROR), 0b100);
    assert!(!bench.bus.read(2, TORQUE.address, 1).unwrap().alert);
    bench.bus.reboot(1).unwrap();
    assert!(bench.bus.ping(1).is_err(), "it starts");
    bench.wait(300);
    let answer = bench.bus.read(1, HARDWARE_ERROR.address, 1).unwrap();
    assert!(!answer.alert && answer.data == [0]);
    assert_eq!(bench.write(1, &TORQUE, 1), 0);
    // A bit that the shutdown register leaves out is told, and nothing else.
    bench.device.lock().unwrap().servo_mut(1).unwrap().latch(0b1);
    let answer = bench.bus.read(1, TORQUE.address, 1).unwrap();
    assert!(answer.alert && answer.data == [1]);
}

#[test]
fn the_watchdog_bites_and_must_be_called_off() {
    let mut bench = Bench::new();
    for (register, value) in
        [(&PROFILE_VELOCITY, 20), (&TORQUE, 1), (&BUS_WATCHDOG, 5), (&GOAL_POSITION, 4000)]
    {
        assert_eq!(bench.write(1, register, value), 0);
    }
    for _ in 0..10 {
        bench.wait(80);
        assert_eq!(bench.read(1, &MOVING), 1, "fed");
    }
    // Words to another servo are none to this one.
    for _ in 0..3 {
        bench.wait(80);
        bench.read(2, &MOVING);
    }
    assert_eq!((bench.read(1, &BUS_WATCHDOG), bench.read(1, &MOVING), bench.read(1, &TORQUE)), (-1, 0, 1));
    assert_eq!(bench.write(1, &GOAL_POSITION, 2048), 4);
    assert_eq!(bench.write(1, &BUS_WATCHDOG, 0), 0);
    assert_eq!(bench.write(1, &GOAL_POSITION, 2048), 0);
}

#[test]
fn resets_spare_what_they_are_told_to() {
    let mut bench = Bench::new();
    let lost = Confirmed::SettingsAreLost;
    for (spared, id, baud) in [(Spared::IdAndBaud, 9, 3), (Spared::Id, 9, 1), (Spared::Nothing, 1, 1)] {
        let mut bench = Bench::new();
        assert_eq!(bench.write(1, &ID, 9), 0);
        assert_eq!(bench.write(9, &MAX_POSITION, 100), 0);
        assert_eq!(bench.bus.write(9, 8, &[3]).map(|_| ()), Ok(()));
        bench.bus.factory_reset(9, spared, lost).unwrap();
        bench.wait(500);
        assert_eq!(bench.read(id, &MAX_POSITION), 4095, "{spared:?}");
        assert_eq!(bench.bus.read(id, 8, 1).unwrap().data, [baud], "{spared:?}");
    }
    // All at once would be too much.
    let error = bench.bus.factory_reset(254, Spared::Id, lost).unwrap_err();
    assert_eq!(error.cause, Cause::Unsupported);
    assert_eq!(bench.bus.ping(2).unwrap().id, 2);
}

#[test]
fn turns_are_many_and_forgotten_when_asked() {
    let mut bench = Bench::new();
    for (register, value) in [(&OPERATING_MODE, 4), (&TORQUE, 1), (&GOAL_POSITION, -9000)] {
        assert_eq!(bench.write(1, register, value), 0);
    }
    let moving = bench.bus.clear_turns(1).unwrap_err();
    assert!(matches!(moving.cause, Cause::Refused { code: 1, .. }), "{moving}");
    bench.wait(10_000);
    assert_eq!(bench.read(1, &PRESENT_POSITION), -9000);
    bench.bus.clear_turns(1).unwrap();
    assert_eq!(bench.read(1, &PRESENT_POSITION), -9000 + 3 * 4096);
}

#[test]
fn without_power_there_is_silence() {
    let mut bench = Bench::new();
    assert_eq!(bench.write(1, &TORQUE, 1), 0);
    assert_eq!(bench.write(1, &LED, 1), 0);
    bench.wait(40_000);
    // From 0 to 32767 and over again; the answer was some milliseconds under way.
    let passed =
        bench.read(1, &REALTIME_TICK) - (bench.clock.now().since_start().as_millis() as i64 - 32_768);
    assert!((-5..=0).contains(&passed), "{passed}");
    let now = bench.clock.now();
    bench.device.lock().unwrap().power(false, now);
    assert!(bench.bus.ping(1).is_err());
    let now = bench.clock.now();
    bench.device.lock().unwrap().power(true, now);
    bench.wait(300);
    assert_eq!((bench.read(1, &TORQUE), bench.read(1, &LED), bench.read(1, &ID)), (0, 0, 1), "RAM is lost");
    assert!(bench.read(1, &REALTIME_TICK) < 400);
}
