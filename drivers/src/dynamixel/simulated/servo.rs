//! One servo: its control table and its motor.

use super::{ServoSpec, baud_code};
use crate::clock::Time;
#[allow(clippy::wildcard_imports, reason = "it is the control table, nearly all of it")]
use crate::dynamixel::control_table::*;
use crate::dynamixel::status::{ErrorByte, Status};
use crate::simulate::Trapezoid;
use std::f64::consts::TAU;
use std::time::Duration;

/// Numbers of the error byte.
pub(super) const RESULT_FAIL: u8 = 1;
pub(super) const INSTRUCTION: u8 = 2;
pub(super) const DATA_RANGE: u8 = 4;
pub(super) const DATA_LENGTH: u8 = 5;
pub(super) const DATA_LIMIT: u8 = 6;
pub(super) const ACCESS: u8 = 7;

/// How long a servo is away that was started anew.
const STARTING: Duration = Duration::from_millis(200);
/// What a servo without a profile can do (ticks/s²).
const GREATEST_ACCELERATION: f64 = 40_000.0;
/// The size of the memory: up to the end of the indirect data.
const SIZE: usize = 252;
const TICKS_PER_RADIAN: f64 = TICKS_PER_TURN / TAU;

/// A servo that is not there: see [`SimulatedBus`](super::SimulatedBus).
#[derive(Debug, Clone)]
pub struct SimulatedServo {
    spec: ServoSpec,
    memory: Vec<u8>,
    /// Ticks and seconds, without the homing offset.
    motor: Trapezoid,
    pub(super) time_scale: f64,
    registered: Option<(u16, Vec<u8>)>,
    now: Time,
    started: Time,
    up: Time,
    heard: Time,
    powered: bool,
}

impl SimulatedServo {
    pub(super) fn new(spec: ServoSpec) -> Self {
        let mut servo = Self {
            spec,
            memory: vec![0; SIZE],
            motor: Trapezoid::at(spec.position, 0.0, GREATEST_ACCELERATION),
            time_scale: 1.0,
            registered: None,
            now: Time::START,
            started: Time::START,
            up: Time::START,
            heard: Time::START,
            powered: true,
        };
        servo.forget(true);
        servo.put(&ID, spec.id.into());
        servo.put(&BAUD_RATE, baud_code(spec.baud));
        servo.drive();
        servo
    }

    /// Its id.
    pub fn id(&self) -> u8 {
        self.get(&ID) as u8
    }

    /// Where it is (ticks), homing offset included; not rounded.
    pub fn position(&self) -> f64 {
        self.motor.position + self.get(&HOMING_OFFSET) as f64
    }

    /// How fast it goes (ticks/s).
    pub fn velocity(&self) -> f64 {
        self.motor.velocity
    }

    /// Whether its torque is on.
    pub fn is_driven(&self) -> bool {
        self.get(&TORQUE) == 1
    }

    /// What a register holds.
    pub fn get(&self, register: &Register) -> i64 {
        register.value_in(&self.memory, 0).unwrap_or(0)
    }

    /// Sets a register as if it had been set up so; nothing is refused.
    pub fn set(&mut self, register: &Register, value: i64) {
        self.put(register, value);
        self.drive();
    }

    /// Latches hardware errors, as overload or heat would; torque goes if the shutdown register says so.
    pub fn latch(&mut self, bits: u8) {
        self.put(&HARDWARE_ERROR, self.get(&HARDWARE_ERROR) | i64::from(bits));
        if self.is_shut_down() {
            self.put(&TORQUE, 0);
            self.motor.freeze();
        }
    }

    fn is_shut_down(&self) -> bool {
        self.get(&HARDWARE_ERROR) & self.get(&SHUTDOWN) != 0
    }

    fn put(&mut self, register: &Register, value: i64) {
        self.store(register.address, &register.bytes(value));
    }

    fn store(&mut self, address: u16, bytes: &[u8]) {
        let start = usize::from(address);
        if let Some(place) = self.memory.get_mut(start..start + bytes.len()) {
            place.copy_from_slice(bytes);
        }
    }

    /// Sets registers to what the factory left in them: of the EEPROM too, or of the rest.
    fn forget(&mut self, eeprom: bool) {
        let model = self.spec.model;
        for register in model.registers().filter(|register| eeprom || !register.in_eeprom()) {
            self.put(register, model.initial(register).unwrap_or(0));
        }
        let (data, count) = INDIRECT_DATA;
        for place in 0..count {
            self.store(INDIRECT_ADDRESSES + 2 * place, &(data + place).to_le_bytes());
            self.store(data + place, &[0]);
        }
        self.registered = None;
        self.motor.freeze();
        self.put(&GOAL_POSITION, self.position().round() as i64);
    }

    pub(super) fn power(&mut self, on: bool, now: Time) {
        self.advance(now);
        if on && !self.powered {
            self.reboot(now);
        }
        if !on {
            self.put(&TORQUE, 0);
            self.motor.freeze();
        }
        self.powered = on;
    }

    /// Whether it hears and answers.
    pub(super) fn is_up(&self, now: Time) -> bool {
        self.powered && now >= self.up
    }

    /// An instruction was for it.
    pub(super) fn hear(&mut self, now: Time) {
        self.heard = now;
    }

    pub(super) fn status_return(&self) -> i64 {
        self.get(&STATUS_RETURN)
    }

    pub(super) fn return_delay(&self) -> Duration {
        RETURN_DELAY_UNIT * self.get(&RETURN_DELAY) as u32
    }

    pub(super) fn baud(&self) -> u32 {
        BAUD_RATES.get(self.get(&BAUD_RATE) as usize).copied().unwrap_or(57_600)
    }

    pub(super) fn status(&self, id: u8, outcome: Result<Vec<u8>, u8>) -> Status {
        let alert = if self.get(&HARDWARE_ERROR) == 0 { 0 } else { 0x80 };
        match outcome {
            Ok(data) => Status { id, error: ErrorByte(alert), data },
            Err(code) => Status { id, error: ErrorByte(alert | code), data: vec![] },
        }
    }

    /// Moves on to this time; the watchdog may trip on the way.
    pub(super) fn advance(&mut self, now: Time) {
        let armed = self.get(&BUS_WATCHDOG);
        if armed > 0 {
            let trips = self.heard + WATCHDOG_UNIT * armed as u32;
            if now > trips {
                self.run(trips);
                self.put(&BUS_WATCHDOG, WATCHDOG_TRIPPED);
                self.motor.max_acceleration = GREATEST_ACCELERATION;
                self.motor.brake();
            }
        }
        self.run(now);
        self.show();
    }

    fn run(&mut self, now: Time) {
        self.motor.advance((now - self.now).as_secs_f64() * self.time_scale);
        self.now = self.now.max(now);
    }

    /// What the present is, in the registers that say it.
    fn show(&mut self) {
        let offset = self.get(&HOMING_OFFSET);
        let moving = self.is_driven() && self.motor.is_moving();
        let velocity = self.motor.velocity / TICKS_PER_RADIAN / VELOCITY_UNIT;
        let load = self.motor.velocity.signum() * if moving { 50.0 } else { 0.0 };
        let ticks = (self.now - self.started).as_millis() & 0x7fff;
        self.put(&REALTIME_TICK, ticks as i64);
        self.put(&MOVING, moving.into());
        self.put(&MOVING_STATUS, if moving { 0b10 } else { 0b01 });
        self.put(&PRESENT_LOAD, load as i64);
        for register in [&PRESENT_VELOCITY, &VELOCITY_TRAJECTORY] {
            self.put(register, velocity.round() as i64);
        }
        for register in [&PRESENT_POSITION, &POSITION_TRAJECTORY] {
            self.put(register, self.motor.position.round() as i64 + offset);
        }
    }

    /// Makes the motor do what the registers say.
    fn drive(&mut self) {
        let unit = VELOCITY_UNIT * TICKS_PER_RADIAN;
        let (limit, cruise) = (self.get(&VELOCITY_LIMIT), self.get(&PROFILE_VELOCITY));
        let cruise = if cruise == 0 { limit } else { cruise.min(limit) };
        self.motor.max_velocity = unit * cruise as f64;
        self.motor.max_acceleration = match self.get(&PROFILE_ACCELERATION) {
            0 => GREATEST_ACCELERATION,
            units => GREATEST_ACCELERATION.min(ACCELERATION_UNIT * TICKS_PER_RADIAN * units as f64),
        };
        let holds = [POSITION_MODE, EXTENDED_POSITION_MODE].contains(&self.get(&OPERATING_MODE));
        if self.is_driven() && holds && self.get(&BUS_WATCHDOG) != WATCHDOG_TRIPPED {
            self.motor.goal = (self.get(&GOAL_POSITION) - self.get(&HOMING_OFFSET)) as f64;
        }
    }

    pub(super) fn identity(&self) -> Vec<u8> {
        [MODEL_NUMBER.bytes(self.get(&MODEL_NUMBER)), FIRMWARE.bytes(self.get(&FIRMWARE))].concat()
    }

    /// Where a byte of the indirect data really is.
    fn target(&self, address: u16) -> u16 {
        let (data, count) = INDIRECT_DATA;
        let place = address.checked_sub(data).filter(|place| *place < count);
        let entry = place.map(|place| usize::from(INDIRECT_ADDRESSES + 2 * place));
        let bytes = entry.and_then(|entry| self.memory.get(entry..)?.first_chunk::<2>());
        bytes.map_or(address, |bytes| u16::from_le_bytes(*bytes))
    }

    /// The register that a byte belongs to.
    fn register_of(&self, address: u16) -> Option<&'static Register> {
        let holds =
            |register: &&Register| (register.address..register.address + register.size).contains(&address);
        self.spec.model.registers().find(holds)
    }

    fn is_indirect(address: u16) -> bool {
        (INDIRECT_ADDRESSES..INDIRECT_DATA.0 + INDIRECT_DATA.1).contains(&address)
    }

    pub(super) fn read(&mut self, address: u16, length: u16, now: Time) -> Result<Vec<u8>, u8> {
        self.advance(now);
        let end = address.checked_add(length).ok_or(ACCESS)?;
        let byte = |address: u16| {
            let target = self.target(address);
            let known = self.register_of(target).is_some() || Self::is_indirect(target);
            self.memory.get(usize::from(target)).copied().filter(|_| known).ok_or(ACCESS)
        };
        (address..end).map(byte).collect()
    }

    /// Writes all of it, or nothing where a part is refused.
    pub(super) fn write(&mut self, address: u16, data: &[u8], now: Time) -> Result<(), u8> {
        self.advance(now);
        let stretches = self.stretches(address, data)?;
        for (address, bytes) in &stretches {
            self.judge(*address, bytes)?;
        }
        for (address, bytes) in stretches {
            self.take(address, &bytes);
        }
        self.drive();
        self.show();
        Ok(())
    }

    /// Cuts what is written into registers.
    fn stretches(&self, address: u16, data: &[u8]) -> Result<Vec<(u16, Vec<u8>)>, u8> {
        if data.is_empty() {
            return Err(DATA_LENGTH);
        }
        let mut stretches: Vec<(u16, Vec<u8>)> = Vec::new();
        for (place, byte) in data.iter().enumerate() {
            let target = self.target(address.checked_add(place as u16).ok_or(ACCESS)?);
            let open = stretches.last_mut().filter(|(start, bytes)| {
                let size = self.register_of(*start).map_or(1, |register| register.size);
                bytes.len() < usize::from(size) && *start + bytes.len() as u16 == target
            });
            match open {
                Some((_, bytes)) => bytes.push(*byte),
                None => stretches.push((target, vec![*byte])),
            }
        }
        Ok(stretches)
    }

    /// Whether a register takes these bytes now.
    fn judge(&self, address: u16, bytes: &[u8]) -> Result<(), u8> {
        if Self::is_indirect(address) {
            return Ok(());
        }
        let register = self.register_of(address).ok_or(ACCESS)?;
        let locked = register.in_eeprom() && self.is_driven();
        if register.address != address || register.access == Access::Read || locked {
            return Err(ACCESS);
        }
        let value = register.value(bytes).ok_or(DATA_LENGTH)?;
        if !(register.range.0..=register.range.1).contains(&value) {
            return Err(DATA_RANGE);
        }
        let refused = match *register {
            DRIVE_MODE => value != 0,
            OPERATING_MODE => {
                let common = [1, POSITION_MODE, EXTENDED_POSITION_MODE, 16].contains(&value);
                !(common || self.spec.model.has_current && [0, 5].contains(&value))
            }
            BUS_WATCHDOG => value < 0,
            PROFILE_VELOCITY | GOAL_VELOCITY => value.abs() > self.get(&VELOCITY_LIMIT),
            GOAL_PWM => value.abs() > self.get(&PWM_LIMIT),
            GOAL_CURRENT => value.abs() > self.get(&CURRENT_LIMIT),
            _ => false,
        };
        let goal = [GOAL_POSITION, GOAL_VELOCITY, GOAL_CURRENT, GOAL_PWM].contains(register);
        if refused || (goal && self.get(&BUS_WATCHDOG) == WATCHDOG_TRIPPED) {
            return Err(DATA_RANGE);
        }
        if *register == GOAL_POSITION && self.get(&OPERATING_MODE) == POSITION_MODE {
            let allowed = self.get(&MIN_POSITION)..=self.get(&MAX_POSITION);
            return if allowed.contains(&value) { Ok(()) } else { Err(DATA_LIMIT) };
        }
        if *register == TORQUE && value == 1 && self.is_shut_down() {
            return Err(RESULT_FAIL);
        }
        Ok(())
    }

    fn take(&mut self, address: u16, bytes: &[u8]) {
        let driven = self.is_driven();
        self.store(address, bytes);
        let register = self.register_of(address).copied();
        match register {
            Some(TORQUE) if self.is_driven() != driven => {
                self.motor.freeze();
                self.put(&GOAL_POSITION, self.position().round() as i64);
            }
            Some(BUS_WATCHDOG) => self.heard = self.now,
            _ => {}
        }
    }

    pub(super) fn register(&mut self, address: u16, data: &[u8], now: Time) -> Result<(), u8> {
        self.advance(now);
        for (address, bytes) in self.stretches(address, data)? {
            self.judge(address, &bytes)?;
        }
        self.registered = Some((address, data.to_vec()));
        self.put(&REGISTERED, 1);
        Ok(())
    }

    pub(super) fn action(&mut self, now: Time) -> Result<(), u8> {
        let (address, data) = self.registered.take().ok_or(INSTRUCTION)?;
        self.put(&REGISTERED, 0);
        self.write(address, &data, now)
    }

    pub(super) fn reboot(&mut self, now: Time) {
        self.advance(now);
        self.forget(false);
        (self.started, self.up) = (now, now + STARTING);
        self.drive();
    }

    pub(super) fn factory_reset(&mut self, parameters: &[u8], to_all: bool, now: Time) -> Result<(), u8> {
        self.advance(now);
        let (id, baud) = (self.get(&ID), self.get(&BAUD_RATE));
        match *parameters {
            [0xff] if !to_all => self.forget(true),
            [code @ (1 | 2)] => {
                self.forget(true);
                self.put(&ID, id);
                if code == 2 {
                    self.put(&BAUD_RATE, baud);
                }
            }
            [_] => return Err(DATA_RANGE),
            _ => return Err(DATA_LENGTH),
        }
        (self.started, self.up) = (now, now + STARTING);
        self.drive();
        Ok(())
    }

    /// Whole turns are forgotten: the position comes within one turn.
    pub(super) fn clear(&mut self, parameters: &[u8], now: Time) -> Result<(), u8> {
        self.advance(now);
        if *parameters != [0x01, 0x44, 0x58, 0x4c, 0x22] {
            return Err(DATA_RANGE);
        }
        if self.motor.is_moving() {
            return Err(RESULT_FAIL);
        }
        self.motor.position = self.motor.position.rem_euclid(TICKS_PER_TURN);
        self.motor.freeze();
        self.put(&GOAL_POSITION, self.position().round() as i64);
        self.show();
        Ok(())
    }
}
