//! From a table's `[device]` to its driver.

use crate::clock::Clock;
use crate::driver::{
    Cause, DeviceJoint, DeviceKind, DeviceSettings, Driver, DriverError, JointMap, MapError,
};
use crate::dynamixel::control_table::{MODELS, Model};
use crate::dynamixel::packet::MAX_ID;
use crate::dynamixel::{self, ServoSpec};
use crate::mycobot;
use crate::port::Port;
use crate::simulate::SimulatedPort;
use dh_runtime::Kinematics;
use std::fmt;
use std::sync::{Arc, Mutex};

/// Why there is no driver.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ConnectError {
    /// A joint can't be moved by this device.
    Map(MapError),
    /// The line's rate belongs to none of the arms that the driver is for.
    Baud {
        /// The driver.
        kind: DeviceKind,
        /// Bits per second.
        baud: u32,
    },
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
            let model = mycobot::Model::of_baud(baud).ok_or(ConnectError::Baud { kind, baud })?;
            Box::new(mycobot::MyCobot::new(port, joints, model).map_err(ConnectError::Map)?)
        }
    })
}

/// The same with servos besides those of the joints: a table's `[[servo]]`. Drivers whose devices have attachments of
/// their own take none.
///
/// # Errors
/// As [`connect`], and where such a servo is another one than the table says.
pub fn connect_with(
    settings: DeviceSettings,
    joints: JointMap,
    attachments: Vec<DeviceJoint>,
    port: Box<dyn Port>,
) -> Result<Box<dyn Driver>, ConnectError> {
    if settings.kind != DeviceKind::Dynamixel {
        return connect(settings, joints, port);
    }
    let bus = dynamixel::Bus::new(port, dynamixel::Timing::default());
    let arm = dynamixel::Arm::connect(bus, joints, dynamixel::Settings::default());
    let arm = arm.and_then(|arm| arm.with_attachments(attachments)).map_err(ConnectError::Driver)?;
    Ok(Box::new(arm))
}

/// Switches on a device that does not know where it is without power; it holds there. Whether that was needed.
///
/// # Errors
/// What the device says, to be asked or to be switched on.
pub fn wake(driver: &mut dyn Driver) -> Result<bool, DriverError> {
    match driver.read_state() {
        Ok(_) => Ok(false),
        Err(error) if error.cause == Cause::PowerOff => driver.torque(true).map(|()| true),
        Err(error) => Err(error),
    }
}

/// A simulated device of this arm, in this process, and the port to it. All joints are at 0, or as near to it as their
/// limits let them be. On a [`VirtualClock`](crate::clock::VirtualClock) waiting for it takes no time.
///
/// # Errors
/// Where the joints are none that there is such a device for.
pub fn simulated(
    settings: DeviceSettings,
    arm: Box<dyn Kinematics + Send>,
    joints: &JointMap,
    clock: Arc<dyn Clock>,
) -> Result<Box<dyn Port>, ConnectError> {
    let DeviceSettings { kind, baud } = settings;
    Ok(match kind {
        DeviceKind::Dynamixel => {
            let servos = joints.joints.iter().map(|joint| servo(joint, baud));
            let bus = dynamixel::SimulatedBus::new(servos.collect::<Result<Vec<_>, _>>()?);
            Box::new(SimulatedPort::new(Arc::new(Mutex::new(bus)), clock))
        }
        DeviceKind::Mycobot => {
            let model = mycobot::Model::of_baud(baud).ok_or(ConnectError::Baud { kind, baud })?;
            let arm = mycobot::SimulatedMyCobot::new(arm, model).map_err(ConnectError::Map)?;
            Box::new(SimulatedPort::new(Arc::new(Mutex::new(arm)), clock))
        }
    })
}

fn servo(joint: &DeviceJoint, baud: u32) -> Result<ServoSpec, ConnectError> {
    let missing = |what, instead| ConnectError::Map(MapError { joint: joint.name.clone(), what, instead });
    let id = u8::try_from(joint.id).ok().filter(|id| *id <= MAX_ID);
    let id =
        id.ok_or_else(|| missing("a servo whose id is over 252", format!("write id = 0 to {MAX_ID}")))?;
    let model = Model::by_name(joint.model.as_deref().unwrap_or_default()).ok_or_else(|| {
        let known = MODELS.map(|model| model.name).join(", ");
        missing("a servo of a model that is not known", format!("write model = one of {known}"))
    })?;
    let at = joint.limits().map_or(0.0, |limits| limits.clamp(0.0));
    Ok(ServoSpec { id, model, baud, position: joint.to_device(at) })
}

impl fmt::Display for ConnectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Map(error) => error.fmt(f),
            Self::Baud { kind, baud } => {
                write!(f, "no {} has a line of {baud} bits per second", kind.name())?;
                match kind {
                    DeviceKind::Mycobot => f.write_str(": a Pi's has 1000000, an M5's 115200"),
                    DeviceKind::Dynamixel => Ok(()),
                }
            }
            Self::Driver(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ConnectError {}
