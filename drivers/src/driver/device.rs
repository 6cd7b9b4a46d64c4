//! `[device]` of a table: which driver moves the arm, and its keys.

use std::fmt;

/// Which driver moves an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceKind {
    /// `driver = "dynamixel"`: X servos on a bus.
    Dynamixel,
    /// `driver = "mycobot"`: a myCobot 280.
    Mycobot,
}

impl DeviceKind {
    const ALL: [DeviceKind; 2] = [Self::Dynamixel, Self::Mycobot];

    /// What tables call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dynamixel => "dynamixel",
            Self::Mycobot => "mycobot",
        }
    }

    /// Bits per second where the table says nothing: what servos leave the factory with; what the arm on a Raspberry Pi
    /// has.
    fn usual_baud(self) -> u32 {
        match self {
            Self::Dynamixel => 57_600,
            Self::Mycobot => 1_000_000,
        }
    }
}

/// `[device]`, understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DeviceSettings {
    /// `driver`.
    pub kind: DeviceKind,
    /// `baud` (bits per second).
    pub baud: u32,
}

/// What is wrong with `[device]`.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeviceError {
    /// There is no such driver.
    Driver(String),
    /// The driver has no such key.
    Key {
        /// The driver.
        kind: DeviceKind,
        /// The key.
        key: String,
    },
    /// The key's value is none that it takes.
    Value {
        /// The key.
        key: &'static str,
        /// As written.
        value: String,
    },
}

impl DeviceSettings {
    /// Of a driver's name and the other keys, with their values as they are written in the table.
    ///
    /// # Errors
    /// A driver, key or value that there is not.
    pub fn of_table<'k>(
        driver: &str,
        keys: impl IntoIterator<Item = (&'k str, &'k str)>,
    ) -> Result<Self, DeviceError> {
        let kind = DeviceKind::ALL.into_iter().find(|kind| kind.name() == driver);
        let kind = kind.ok_or_else(|| DeviceError::Driver(driver.to_owned()))?;
        let mut settings = Self { kind, baud: kind.usual_baud() };
        for (key, value) in keys {
            if key != "baud" {
                return Err(DeviceError::Key { kind, key: key.to_owned() });
            }
            let number = value.replace('_', "").parse().ok().filter(|baud| *baud > 0);
            settings.baud =
                number.ok_or_else(|| DeviceError::Value { key: "baud", value: value.to_owned() })?;
        }
        Ok(settings)
    }
}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Driver(name) => {
                write!(f, "[device] has driver = \"{name}\"; there are \"dynamixel\" and \"mycobot\"")
            }
            Self::Key { kind, key } => {
                write!(f, "[device] has the key `{key}`; the driver \"{}\" knows `baud`", kind.name())
            }
            Self::Value { key, value } => {
                write!(f, "[device] has {key} = {value}; write bits per second, as in {key} = 1000000")
            }
        }
    }
}

impl std::error::Error for DeviceError {}

#[cfg(test)]
mod tests {
    use super::{DeviceKind, DeviceSettings};

    #[test]
    fn keys_are_read_or_refused() {
        let settings = DeviceSettings::of_table("dynamixel", [("baud", "3_000_000")]).unwrap();
        assert_eq!(settings, DeviceSettings { kind: DeviceKind::Dynamixel, baud: 3_000_000 });
        assert_eq!(DeviceSettings::of_table("mycobot", []).unwrap().baud, 1_000_000);
        let refused = |driver, keys: &[(&'static str, &'static str)]| {
            DeviceSettings::of_table(driver, keys.iter().copied()).unwrap_err().to_string()
        };
        assert!(refused("feetech", &[]).contains("there are \"dynamixel\" and \"mycobot\""));
        assert!(refused("dynamixel", &[("port", "\"/dev/ttyUSB0\"")]).contains("the key `port`"));
        for wrong in ["-1", "0", "\"1000000\"", "1e6", "99999999999"] {
            assert!(refused("mycobot", &[("baud", wrong)]).contains(wrong));
        }
    }
}
