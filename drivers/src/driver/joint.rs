//! The joints of a table as a device has them.

use dh_runtime::{Joint, JointKind, Kinematics, Limits, Servo};
use std::fmt;

/// One joint and what the device is sent for it: device = scale * q + zero.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceJoint {
    /// Its name in the table.
    pub name: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// The table's limits (rad or m), without the servo's.
    pub table_limits: Option<Limits>,
    /// rad/s or m/s
    pub max_velocity: Option<f64>,
    /// rad/s² or m/s²
    pub max_acceleration: Option<f64>,
    /// Bus id.
    pub id: u32,
    /// Device units per radian (or metre), signed.
    pub scale: f64,
    /// Device value at q = 0.
    pub zero: f64,
    /// What the register takes (device units).
    pub range: Option<Limits>,
    /// The servo's model, as the table calls it.
    pub model: Option<String>,
}

impl DeviceJoint {
    fn of_table(joint: &Joint<'_>) -> Result<Self, MapError> {
        let missing = |what, instead: &str| MapError {
            joint: joint.name.to_owned(),
            what,
            instead: instead.to_owned(),
        };
        let with_id = "write servo = { id = ... } in its entry";
        let servo = joint.servo.ok_or_else(|| missing("no servo", with_id))?;
        let id = servo.id.ok_or_else(|| missing("a servo without an id", with_id))?;
        if !(servo.scale.is_finite() && servo.scale != 0.0 && servo.zero.is_finite()) {
            return Err(missing("a servo whose scale or zero is no number", "write finite ones"));
        }
        Ok(Self {
            name: joint.name.to_owned(),
            kind: joint.kind,
            table_limits: joint.limits,
            max_velocity: joint.max_velocity,
            max_acceleration: joint.max_acceleration,
            id,
            scale: servo.scale,
            zero: servo.zero,
            range: servo.range,
            model: servo.model.map(str::to_owned),
        })
    }

    /// A servo that is no joint, of this name.
    ///
    /// # Errors
    /// Where it has no id, or numbers that are none.
    pub fn of_servo(name: &str, servo: Servo<'_>) -> Result<Self, MapError> {
        Self::of_table(&Joint { servo: Some(servo), ..Joint::revolute(name) })
    }

    /// The device value of a joint value (rad or m); neither rounded nor held in the range.
    pub fn to_device(&self, q: f64) -> f64 {
        self.servo().to_device(q)
    }

    /// The joint value (rad or m) of a device value.
    pub fn from_device(&self, device: f64) -> f64 {
        self.servo().from_device(device)
    }

    /// Where the joint may go (rad or m): the table's limits, and what the servo's range leaves of them; where it
    /// leaves nothing, the table's.
    pub fn limits(&self) -> Option<Limits> {
        match (self.table_limits, self.servo().limits()) {
            (Some(joint), Some(servo)) => Some(joint.intersection(&servo).unwrap_or(joint)),
            (joint, servo) => joint.or(servo),
        }
    }

    fn servo(&self) -> Servo<'_> {
        Servo { range: self.range, ..Servo::new(self.scale, self.zero) }
    }
}

/// The joints of one table, each with its servo.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMap {
    /// The table: see [`Kinematics::fingerprint`].
    pub fingerprint: u64,
    /// The joints, in the table's order. What one arm out of many has of its own, zeros and signs, may be written over
    /// the table's before a driver is made.
    pub joints: Vec<DeviceJoint>,
}

impl JointMap {
    /// What the table says.
    ///
    /// # Errors
    /// The first joint that no servo moves.
    pub fn of_table(arm: &dyn Kinematics) -> Result<Self, MapError> {
        let joints = arm.joints().iter().map(DeviceJoint::of_table).collect::<Result<_, _>>()?;
        Ok(Self { fingerprint: arm.fingerprint(), joints })
    }

    /// How many joints there are.
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }
}

/// A joint that no driver can move, for what its table lacks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapError {
    /// The joint's name.
    pub joint: String,
    /// What it has in place of a servo that would do.
    pub what: &'static str,
    /// What to do about it.
    pub instead: String,
}

impl fmt::Display for MapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint {} has {}: {}", self.joint, self.what, self.instead)
    }
}

impl std::error::Error for MapError {}
