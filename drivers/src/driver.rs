//! What motion knows of a device.

mod device;
mod error;
mod joint;

use crate::clock::{Clock, Time};
use crate::motion::Command;
use dh_runtime::Limits;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

pub use device::{DeviceError, DeviceKind, DeviceSettings};
pub use error::{Cause, DriverError, Fault};
pub use joint::{DeviceJoint, JointMap, MapError};

/// How a device wants to be told where to go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// It follows commands that come at a fixed rate: one a period, each the next point of the path.
    Stream {
        /// From one command to the next.
        period: Duration,
    },
    /// It is told a goal and a speed, and goes there by a profile of its own.
    PointToPoint,
}

/// What a motor does against the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effort {
    /// Current (A), signed like the joint's direction.
    Current(f64),
    /// An estimate of the load, as a part of the greatest one: -1 to 1, signed like the joint's direction.
    Load(f64),
}

/// What is known of one joint. What a device does not tell is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState {
    /// rad or m
    pub position: f64,
    /// rad/s or m/s
    pub velocity: Option<f64>,
    /// Current or load.
    pub effort: Option<Effort>,
    /// °C
    pub temperature: Option<f64>,
    /// Whether it is on its way.
    pub moving: Option<bool>,
    /// What has latched it.
    pub fault: Option<Fault>,
}

/// What is known of a device.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct State {
    /// When the answer was complete.
    pub stamp: Time,
    /// One a joint, in the table's order.
    pub joints: Vec<JointState>,
    /// What has stopped the device as a whole.
    pub fault: Option<Fault>,
}

impl State {
    /// Positions (rad or m), one a joint.
    pub fn positions(&self) -> Vec<f64> {
        self.joints.iter().map(|joint| joint.position).collect()
    }

    /// The first fault, with the index of its joint where it is a joint's.
    pub fn first_fault(&self) -> Option<(Option<usize>, &Fault)> {
        let joints = self.joints.iter().enumerate();
        let whole = self.fault.as_ref().map(|fault| (None, fault));
        let mut of_joints =
            joints.filter_map(|(index, joint)| joint.fault.as_ref().map(|fault| (Some(index), fault)));
        whole.or_else(|| of_joints.next())
    }
}

/// What happens to a moving device whose host is gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Watchdog {
    /// It stops by itself after so long without a word. This may be longer than what was asked for, never shorter.
    Device(Duration),
    /// Nothing: it goes on to its goal.
    None,
}

/// What a device moves besides the joints: a gripper, mostly. It is no part of the kinematics; what moves it is checked
/// against its own range and nothing else.
#[derive(Debug, Clone, PartialEq)]
pub struct Attachment {
    /// What it is called.
    pub name: String,
    /// What its values are.
    pub unit: AttachmentUnit,
    /// Its least and greatest value.
    pub range: Limits,
}

/// What the values of an [`Attachment`] are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttachmentUnit {
    /// rad
    Angle,
    /// How far it is open, of all it opens, in percent.
    Percent,
}

impl fmt::Display for Watchdog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Device(time) => {
                write!(f, "it stops by itself {:.0} ms after the last word", time.as_secs_f64() * 1e3)
            }
            Self::None => f.write_str("it goes on to its last goal, and nothing stops it but its switch"),
        }
    }
}

/// A device that moves the joints of one table.
///
/// Every call returns by a deadline of its own, and none spins. A call that fails because the device is gone tries
/// once to come back by [`Port::reopen`](crate::port::Port::reopen) the next time something is asked of it; a device
/// that has come back does not move until torque is switched on anew.
///
/// Nothing is sent where a call is refused for its arguments: lengths, the wrong arm, values outside a servo's range.
pub trait Driver: fmt::Debug + Send {
    /// What errors call the device: its port's name.
    fn name(&self) -> &str;

    /// The clock that stamps are read on.
    fn clock(&self) -> Arc<dyn Clock>;

    /// The joints, in the table's order, and what the device is sent for each.
    fn joints(&self) -> &JointMap;

    /// How it wants to be told where to go.
    fn pace(&self) -> Pace;

    /// Asks for everything that [`State`] has.
    ///
    /// # Errors
    /// [`DriverError`]; a latched fault of a joint is no error here but part of the state.
    fn read_state(&mut self) -> Result<State, DriverError>;

    /// Switches torque of all joints. On: the arm stays where it is. Off: it falls, unless its pose is a safe one;
    /// whether it is, is for the caller to know.
    ///
    /// # Errors
    /// [`DriverError`]; some joints may have been switched and others not.
    fn torque(&mut self, on: bool) -> Result<(), DriverError>;

    /// Sends the next point of a stream, or a goal: see [`Pace`]. Point to point, it returns when the device has taken
    /// the goal, long before it is there.
    ///
    /// # Errors
    /// [`DriverError`]. Where the driver gives up on a moving device, it has tried to stop it.
    fn send(&mut self, command: &Command) -> Result<(), DriverError>;

    /// Brings all joints to rest as fast as they decelerate, and holds them there: torque stays on. It is for
    /// emergencies as much as for the end of a move: it is tried several times and does not wait for the rest.
    ///
    /// # Errors
    /// [`DriverError`] where nothing says that the device has heard.
    fn stop(&mut self) -> Result<(), DriverError>;

    /// Makes the device forget the faults that it has latched, so that it can move again, and returns when it answers
    /// again. Joints that a fault was latched of may lose their torque by it: it counts as off until it is switched on.
    ///
    /// # Errors
    /// [`DriverError`]; a fault whose cause is still there comes back, which the next state tells.
    fn clear_faults(&mut self) -> Result<(), DriverError>;

    /// From now on the device stops by itself when it has not heard a word for so long; every other call is a word.
    /// `None` ends it.
    ///
    /// # Errors
    /// [`DriverError`]
    fn watchdog(&mut self, timeout: Option<Duration>) -> Result<Watchdog, DriverError>;

    /// What it moves besides the joints.
    fn attachments(&self) -> Vec<Attachment> {
        Vec::new()
    }

    /// Moves an attachment, switching it on where it is off, and returns long before it is there.
    ///
    /// # Errors
    /// [`DriverError`]; [`Cause::Unsupported`] where there is none of that name, [`Cause::OutsideRange`] before anything
    /// is sent.
    fn move_attachment(&mut self, name: &str, value: f64) -> Result<(), DriverError> {
        let _ = value;
        Err(DriverError::new(self.name(), "move attachment", Cause::Unsupported).of_joint(name))
    }

    /// Where an attachment is.
    ///
    /// # Errors
    /// [`DriverError`]; [`Cause::Unsupported`] where there is none of that name.
    fn read_attachment(&mut self, name: &str) -> Result<f64, DriverError> {
        Err(DriverError::new(self.name(), "read attachment", Cause::Unsupported).of_joint(name))
    }
}

/// What opens a device by its table's driver gives a `Box<dyn Driver>`, which is one itself.
impl<D: Driver + ?Sized> Driver for Box<D> {
    fn name(&self) -> &str {
        (**self).name()
    }
    fn clock(&self) -> Arc<dyn Clock> {
        (**self).clock()
    }
    fn joints(&self) -> &JointMap {
        (**self).joints()
    }
    fn pace(&self) -> Pace {
        (**self).pace()
    }
    fn read_state(&mut self) -> Result<State, DriverError> {
        (**self).read_state()
    }
    fn torque(&mut self, on: bool) -> Result<(), DriverError> {
        (**self).torque(on)
    }
    fn send(&mut self, command: &Command) -> Result<(), DriverError> {
        (**self).send(command)
    }
    fn stop(&mut self) -> Result<(), DriverError> {
        (**self).stop()
    }
    fn clear_faults(&mut self) -> Result<(), DriverError> {
        (**self).clear_faults()
    }
    fn attachments(&self) -> Vec<Attachment> {
        (**self).attachments()
    }
    fn move_attachment(&mut self, name: &str, value: f64) -> Result<(), DriverError> {
        (**self).move_attachment(name, value)
    }
    fn read_attachment(&mut self, name: &str) -> Result<f64, DriverError> {
        (**self).read_attachment(name)
    }
    fn watchdog(&mut self, timeout: Option<Duration>) -> Result<Watchdog, DriverError> {
        (**self).watchdog(timeout)
    }
}
