//! From a table's `[device]` to its driver.

use crate::driver::{DeviceKind, DeviceSettings, Driver, DriverError, JointMap, MapError};
use crate::dynamixel;
use crate::mycobot;
use crate::port::Port;
use std::fmt;

/// Why there is no driver.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ConnectError {
    /// A joint can't be moved by this device.
    Map(MapError),
    /// The device doesn't answer as it should.
    Driver(DriverError),
}

/// The driver of a device, which is at the other end of this port.
///
/// # Errors
/// Where the joints are none that it moves, or the device is not there or is another one.
pub fn connect(
    settings: DeviceSettings,
    joints: JointMap,
    port: Box<dyn Port>,
) -> Result<Box<dyn Driver>, ConnectError> {
    let DeviceSettings { kind, baud } = settings;
    Ok(match kind {
        DeviceKind::Dynamixel => {
            let bus = dynamixel::Bus::new(port, dynamixel::Timing::default());
            let arm = dynamixel::Arm::connect(bus, joints, dynamixel::Settings::default());
            Box::new(arm.map_err(ConnectError::Driver)?)
        }
        DeviceKind::Mycobot => {
            let model = mycobot::Model::of_baud(baud);
            Box::new(mycobot::MyCobot::new(port, joints, model).map_err(ConnectError::Map)?)
        }
    })
}

impl fmt::Display for ConnectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Map(error) => error.fmt(f),
            Self::Driver(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ConnectError {}
