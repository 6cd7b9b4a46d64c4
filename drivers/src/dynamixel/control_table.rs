//! What X servos store where.
//!
//! Source: the e-manual's control tables of XL430-W250, XM430-W350 and XM540-W270. Below 64 is EEPROM, which is locked
//! while torque is on.

/// A register of the control table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Register {
    /// What the e-manual calls it.
    pub name: &'static str,
    /// Its first byte.
    pub address: u16,
    /// 1, 2 or 4 bytes.
    pub size: u16,
    /// Whether it is written at all.
    pub access: Access,
    /// Least and greatest value that it takes. Where the least one is negative, the register is signed.
    pub range: (i64, i64),
    /// What it holds when the servo leaves the factory, in the order of [`MODELS`]; `None` where a model has no such
    /// register.
    pub initial: [Option<i64>; 3],
}

/// Whether a register can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// It can't.
    Read,
    /// It can.
    Write,
}

impl Register {
    /// Whether it keeps its value without power, and is locked while torque is on.
    pub fn in_eeprom(&self) -> bool {
        self.address < 64
    }

    /// The value in these bytes, of which there must be as many as its size.
    pub fn value(&self, bytes: &[u8]) -> Option<i64> {
        let signed = self.range.0 < 0;
        match *bytes {
            [a] if self.size == 1 => Some(if signed { i64::from(a.cast_signed()) } else { i64::from(a) }),
            [a, b] if self.size == 2 => {
                let value = u16::from_le_bytes([a, b]);
                Some(if signed { i64::from(value.cast_signed()) } else { i64::from(value) })
            }
            [a, b, c, d] if self.size == 4 => {
                let value = u32::from_le_bytes([a, b, c, d]);
                Some(if signed { i64::from(value.cast_signed()) } else { i64::from(value) })
            }
            _ => None,
        }
    }

    /// The value in a stretch of the table that starts at this address.
    pub fn value_in(&self, stretch: &[u8], address: u16) -> Option<i64> {
        let start = usize::from(self.address.checked_sub(address)?);
        self.value(stretch.get(start..start + usize::from(self.size))?)
    }

    /// The bytes of a value; its low ones where it does not fit.
    pub fn bytes(&self, value: i64) -> Vec<u8> {
        value.to_le_bytes().into_iter().take(usize::from(self.size)).collect()
    }

    /// Whether two share a byte.
    pub fn overlaps(&self, other: &Register) -> bool {
        self.address < other.address + other.size && other.address < self.address + self.size
    }
}

/// A servo's type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Model {
    /// As it is called in tables.
    pub name: &'static str,
    /// What it answers to a ping.
    pub number: u16,
    /// Whether [`PRESENT_LOAD`] is a current (in units of [`CURRENT_UNIT`]), not an estimated load.
    pub has_current: bool,
    place: usize,
}

/// The types that are known.
pub const MODELS: [Model; 3] = [
    Model { name: "XL430-W250", number: 1060, has_current: false, place: 0 },
    Model { name: "XM430-W350", number: 1020, has_current: true, place: 1 },
    Model { name: "XM540-W270", number: 1120, has_current: true, place: 2 },
];

impl Model {
    /// The type that answers to a ping with this number.
    pub fn by_number(number: u16) -> Option<&'static Model> {
        MODELS.iter().find(|model| model.number == number)
    }

    /// The type that tables call so; the part after the second hyphen (-T, -R: the plug) does not matter.
    pub fn by_name(name: &str) -> Option<&'static Model> {
        MODELS.iter().find(|model| {
            name.strip_prefix(model.name).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
        })
    }

    /// Its registers, in the order of addresses.
    pub fn registers(&'static self) -> impl Iterator<Item = &'static Register> {
        REGISTERS.iter().filter(|register| self.initial(register).is_some())
    }

    /// What a register holds when it leaves the factory; `None` where it has no such register.
    pub fn initial(&self, register: &Register) -> Option<i64> {
        register.initial.get(self.place).copied().flatten()
    }
}

/// Positions in one turn.
pub const TICKS_PER_TURN: f64 = 4096.0;
/// One unit of velocity (rad/s): 0.229 rev/min.
pub const VELOCITY_UNIT: f64 = 0.229 * std::f64::consts::TAU / 60.0;
/// One unit of profile acceleration (rad/s²): 214.577 rev/min².
pub const ACCELERATION_UNIT: f64 = 214.577 * std::f64::consts::TAU / 3600.0;
/// One unit of current (A).
pub const CURRENT_UNIT: f64 = 2.69e-3;
/// One unit of load, as a part of the greatest one.
pub const LOAD_UNIT: f64 = 1e-3;
/// One unit of the bus watchdog.
pub const WATCHDOG_UNIT: std::time::Duration = std::time::Duration::from_millis(20);
/// One unit of the return delay.
pub const RETURN_DELAY_UNIT: std::time::Duration = std::time::Duration::from_micros(2);
/// What the bus watchdog holds when it has tripped.
pub const WATCHDOG_TRIPPED: i64 = -1;
/// Bits per second, by what [`BAUD_RATE`] holds.
pub const BAUD_RATES: [u32; 8] =
    [9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000];

/// [`OPERATING_MODE`]: a goal position within one turn.
pub const POSITION_MODE: i64 = 3;
/// [`OPERATING_MODE`]: a goal position over many turns.
pub const EXTENDED_POSITION_MODE: i64 = 4;

/// Where [`INDIRECT_DATA`] begins, a byte each, and how many bytes there are.
pub const INDIRECT_DATA: (u16, u16) = (224, 28);
/// Where the addresses of [`INDIRECT_DATA`] begin, two bytes each.
pub const INDIRECT_ADDRESSES: u16 = 168;

macro_rules! registers {
    ($($(#[$doc:meta])* $constant:ident = $address:literal $size:literal $name:literal $access:ident
        $range:expr, [$xl430:expr, $xm430:expr, $xm540:expr];)*) => {
        $($(#[$doc])*
        pub const $constant: Register = Register {
            name: $name,
            address: $address,
            size: $size,
            access: Access::$access,
            range: $range,
            initial: [$xl430, $xm430, $xm540],
        };)*

        /// All registers of all models, in the order of addresses; indirect ones are not among them.
        pub const REGISTERS: &[Register] = &[$($constant),*];
    };
}

registers! {
    /// The type: see [`MODELS`].
    MODEL_NUMBER = 0 2 "model number" Read (0, 65535), [Some(1060), Some(1020), Some(1120)];
    /// Not documented.
    MODEL_INFORMATION = 2 4 "model information" Read (0, 0xffff_ffff), [Some(0), Some(0), Some(0)];
    /// Version of the firmware.
    FIRMWARE = 6 1 "firmware version" Read (0, 255), [Some(46), Some(46), Some(46)];
    /// Who it is on the bus.
    ID = 7 1 "id" Write (0, 252), [Some(1), Some(1), Some(1)];
    /// Index of [`BAUD_RATES`].
    BAUD_RATE = 8 1 "baud rate" Write (0, 7), [Some(1), Some(1), Some(1)];
    /// How long it waits before it answers ([`RETURN_DELAY_UNIT`]).
    RETURN_DELAY = 9 1 "return delay time" Write (0, 254), [Some(250), Some(250), Some(250)];
    /// Bit 0 turns the sense of rotation, bit 2 makes profiles a matter of time.
    DRIVE_MODE = 10 1 "drive mode" Write (0, 13), [Some(0), Some(0), Some(0)];
    /// [`POSITION_MODE`] and others.
    OPERATING_MODE = 11 1 "operating mode" Write (0, 16), [Some(3), Some(3), Some(3)];
    /// Another id that it listens to; 255 for none.
    SHADOW_ID = 12 1 "secondary id" Write (0, 255), [Some(255), Some(255), Some(255)];
    /// The version of the protocol.
    PROTOCOL = 13 1 "protocol type" Write (1, 2), [Some(2), Some(2), Some(2)];
    /// What is added to the position (ticks).
    HOMING_OFFSET = 20 4 "homing offset" Write (-1_044_479, 1_044_479), [Some(0), Some(0), Some(0)];
    /// Faster than this counts as moving ([`VELOCITY_UNIT`]).
    MOVING_THRESHOLD = 24 4 "moving threshold" Write (0, 1023), [Some(10), Some(10), Some(10)];
    /// °C
    TEMPERATURE_LIMIT = 31 1 "temperature limit" Write (0, 100), [Some(72), Some(80), Some(80)];
    /// 0.1 V
    MAX_VOLTAGE = 32 2 "max voltage limit" Write (60, 160), [Some(140), Some(160), Some(160)];
    /// 0.1 V
    MIN_VOLTAGE = 34 2 "min voltage limit" Write (60, 160), [Some(60), Some(95), Some(95)];
    /// 0.113 %
    PWM_LIMIT = 36 2 "PWM limit" Write (0, 885), [Some(885), Some(885), Some(885)];
    /// [`CURRENT_UNIT`]
    CURRENT_LIMIT = 38 2 "current limit" Write (0, 2047), [None, Some(1193), Some(2047)];
    /// The greatest [`GOAL_VELOCITY`] and [`PROFILE_VELOCITY`] ([`VELOCITY_UNIT`]).
    VELOCITY_LIMIT = 44 4 "velocity limit" Write (0, 1023), [Some(265), Some(350), Some(128)];
    /// The greatest [`GOAL_POSITION`] of [`POSITION_MODE`] (ticks).
    MAX_POSITION = 48 4 "max position limit" Write (0, 4095), [Some(4095), Some(4095), Some(4095)];
    /// The least one.
    MIN_POSITION = 52 4 "min position limit" Write (0, 4095), [Some(0), Some(0), Some(0)];
    /// What it does when power comes.
    STARTUP = 60 1 "startup configuration" Write (0, 3), [Some(0), Some(0), Some(0)];
    /// Which bits of [`HARDWARE_ERROR`] switch torque off.
    SHUTDOWN = 63 1 "shutdown" Write (0, 63), [Some(52), Some(52), Some(52)];
    /// 1 while the motor is driven.
    TORQUE = 64 1 "torque enable" Write (0, 1), [Some(0), Some(0), Some(0)];
    /// 1 while the LED is on.
    LED = 65 1 "LED" Write (0, 1), [Some(0), Some(0), Some(0)];
    /// What is answered: 0 pings only, 1 reads too, 2 everything.
    STATUS_RETURN = 68 1 "status return level" Write (0, 2), [Some(2), Some(2), Some(2)];
    /// 1 while something waits for an action.
    REGISTERED = 69 1 "registered instruction" Read (0, 1), [Some(0), Some(0), Some(0)];
    /// What is latched: see [`hardware_fault`](super::status::hardware_fault).
    HARDWARE_ERROR = 70 1 "hardware error status" Read (0, 255), [Some(0), Some(0), Some(0)];
    /// Gain.
    VELOCITY_I = 76 2 "velocity I gain" Write (0, 16383), [Some(1000), Some(1920), Some(1920)];
    /// Gain.
    VELOCITY_P = 78 2 "velocity P gain" Write (0, 16383), [Some(100), Some(100), Some(100)];
    /// Gain.
    POSITION_D = 80 2 "position D gain" Write (0, 16383), [Some(4000), Some(0), Some(0)];
    /// Gain.
    POSITION_I = 82 2 "position I gain" Write (0, 16383), [Some(0), Some(0), Some(0)];
    /// Gain.
    POSITION_P = 84 2 "position P gain" Write (0, 16383), [Some(640), Some(800), Some(800)];
    /// Gain.
    FEEDFORWARD_2 = 88 2 "feedforward 2nd gain" Write (0, 16383), [Some(0), Some(0), Some(0)];
    /// Gain.
    FEEDFORWARD_1 = 90 2 "feedforward 1st gain" Write (0, 16383), [Some(0), Some(0), Some(0)];
    /// After how long without an instruction the servo stops ([`WATCHDOG_UNIT`]); 0 for never, [`WATCHDOG_TRIPPED`].
    BUS_WATCHDOG = 98 1 "bus watchdog" Write (-1, 127), [Some(0), Some(0), Some(0)];
    /// 0.113 %
    GOAL_PWM = 100 2 "goal PWM" Write (-885, 885), [Some(885), Some(885), Some(885)];
    /// [`CURRENT_UNIT`]
    GOAL_CURRENT = 102 2 "goal current" Write (-2047, 2047), [None, Some(1193), Some(2047)];
    /// [`VELOCITY_UNIT`]
    GOAL_VELOCITY = 104 4 "goal velocity" Write (-1023, 1023), [Some(0), Some(0), Some(0)];
    /// How fast profiles accelerate ([`ACCELERATION_UNIT`]); 0: as fast as the servo can.
    PROFILE_ACCELERATION = 108 4 "profile acceleration" Write (0, 32767), [Some(0), Some(0), Some(0)];
    /// How fast profiles cruise ([`VELOCITY_UNIT`]); 0: as fast as the servo can.
    PROFILE_VELOCITY = 112 4 "profile velocity" Write (0, 32767), [Some(0), Some(0), Some(0)];
    /// Where it is to go (ticks).
    GOAL_POSITION = 116 4 "goal position" Write (-1_048_575, 1_048_575), [Some(0), Some(0), Some(0)];
    /// ms, from 0 to 32767 and over again.
    REALTIME_TICK = 120 2 "realtime tick" Read (0, 32767), [Some(0), Some(0), Some(0)];
    /// 1 while it moves or a profile runs.
    MOVING = 122 1 "moving" Read (0, 1), [Some(0), Some(0), Some(0)];
    /// Bit 0: in position. Bit 1: a profile runs.
    MOVING_STATUS = 123 1 "moving status" Read (0, 255), [Some(0), Some(0), Some(0)];
    /// 0.113 %
    PRESENT_PWM = 124 2 "present PWM" Read (-885, 885), [Some(0), Some(0), Some(0)];
    /// [`LOAD_UNIT`] or [`CURRENT_UNIT`]: see [`Model::has_current`].
    PRESENT_LOAD = 126 2 "present load or current" Read (-2047, 2047), [Some(0), Some(0), Some(0)];
    /// [`VELOCITY_UNIT`]
    PRESENT_VELOCITY = 128 4 "present velocity" Read (-1023, 1023), [Some(0), Some(0), Some(0)];
    /// Ticks.
    PRESENT_POSITION = 132 4 "present position" Read (i32::MIN as i64, i32::MAX as i64), [Some(0), Some(0), Some(0)];
    /// Where the profile is ([`VELOCITY_UNIT`]).
    VELOCITY_TRAJECTORY = 136 4 "velocity trajectory" Read (-1023, 1023), [Some(0), Some(0), Some(0)];
    /// Where the profile is (ticks).
    POSITION_TRAJECTORY = 140 4 "position trajectory" Read (i32::MIN as i64, i32::MAX as i64), [Some(0), Some(0), Some(0)];
    /// 0.1 V
    VOLTAGE = 144 2 "present input voltage" Read (0, 65535), [Some(120), Some(120), Some(120)];
    /// °C
    TEMPERATURE = 146 1 "present temperature" Read (0, 255), [Some(30), Some(30), Some(30)];
    /// 1 where there is a backup.
    BACKUP_READY = 147 1 "backup ready" Read (0, 1), [Some(0), Some(0), Some(0)];
}

#[cfg(test)]
mod tests {
    use super::{Access, INDIRECT_ADDRESSES, MODELS, Model, REGISTERS};

    #[test]
    fn registers_are_in_order_and_share_no_byte() {
        for pair in REGISTERS.windows(2) {
            assert!(pair[0].address < pair[1].address && !pair[0].overlaps(&pair[1]), "{pair:?}");
        }
        let last = REGISTERS.last().unwrap();
        assert!(last.address + last.size <= INDIRECT_ADDRESSES);
    }

    #[test]
    fn initial_values_fit() {
        for model in &MODELS {
            for register in model.registers() {
                let initial = model.initial(register).unwrap();
                assert!((register.range.0..=register.range.1).contains(&initial), "{register:?}");
                assert_eq!(register.value(&register.bytes(initial)), Some(initial), "{register:?}");
                let limit = 1_i64 << (8 * register.size);
                assert!(register.range.1 < limit && register.range.0 >= -limit / 2, "{register:?}");
                if register.access == Access::Write && register.range.0 < 0 {
                    assert_eq!(register.value(&register.bytes(register.range.0)), Some(register.range.0));
                }
            }
            assert_eq!(model.initial(&super::MODEL_NUMBER), Some(i64::from(model.number)));
        }
    }

    #[test]
    fn models_are_found() {
        assert_eq!(Model::by_name("XL430-W250-T").unwrap().number, 1060);
        assert_eq!(Model::by_name("XM540-W270").unwrap(), Model::by_number(1120).unwrap());
        assert!(Model::by_name("XM430-W350x").is_none() && Model::by_name("XM430").is_none());
    }
}
