//! Requests. What they take is checked when they are made: a request that exists may be sent.

use super::command::Command;
use super::frame::Frame;
use super::refusal::{ANGLES, AXES, COORDINATES, Range, Refusal, within};

/// A request that the arm takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    command: Command,
    payload: Vec<u8>,
}

/// What the gripper is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GripperState {
    /// Open.
    Open,
    /// Closed.
    Closed,
    /// Without torque.
    Released,
}

/// How a move to coordinates gets there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CoordinateMode {
    /// All joints together.
    Joints,
    /// In a straight line.
    Linear,
}

/// Which gripper is meant and with how much torque it holds, where the plain commands do not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GripperKind {
    /// The maker's number of the kind.
    pub kind: u8,
    /// The maker's torque setting, for kinds that have one.
    pub torque: Option<u8>,
}

impl Request {
    /// A command that takes nothing.
    pub fn plain(command: Command) -> Self {
        Self { command, payload: Vec::new() }
    }

    /// A command that takes a switch: fresh mode (true: a new goal replaces the one before) or free mode.
    pub fn switch(command: Command, on: bool) -> Self {
        Self { command, payload: vec![u8::from(on)] }
    }

    /// All joints to these angles (deg), at a speed of 1 to 100 %.
    ///
    /// # Errors
    /// The first joint whose angle the arm does not take, or the speed.
    pub fn send_angles(angles: &[f64; 6], speed: u8) -> Result<Self, Refusal> {
        let mut payload = encode_angles(angles)?;
        payload.push(moving_speed(speed)?);
        Ok(Self { command: Command::SendAngles, payload })
    }

    /// Joint 1 to 6 to an angle (deg), at a speed of 1 to 100 %.
    ///
    /// # Errors
    /// Where the joint, the angle or the speed is none that the arm takes.
    pub fn send_angle(joint: usize, angle: f64, speed: u8) -> Result<Self, Refusal> {
        let [high, low] = encode_angle(joint, angle)?;
        Ok(Self {
            command: Command::SendAngle,
            payload: vec![joint_byte(joint)?, high, low, moving_speed(speed)?],
        })
    }

    /// The flange to x, y, z (mm), rx, ry, rz (deg), at a speed of 1 to 100 %. Without a mode the arm takes its own.
    ///
    /// # Errors
    /// The first coordinate that the arm does not take, or the speed.
    pub fn send_coords(coords: &[f64; 6], speed: u8, mode: Option<CoordinateMode>) -> Result<Self, Refusal> {
        let mut payload = encode_coordinates(coords)?;
        payload.push(moving_speed(speed)?);
        payload.extend(mode.map(|mode| u8::from(mode == CoordinateMode::Linear)));
        Ok(Self { command: Command::SendCoords, payload })
    }

    /// One coordinate (1 to 3: x, y, z in mm; 4 to 6: rx, ry, rz in deg) to a value.
    ///
    /// # Errors
    /// Where the number, the value or the speed is none that the arm takes.
    pub fn send_coord(number: usize, value: f64, speed: u8) -> Result<Self, Refusal> {
        let [high, low] = encode_coordinate(number, value)?;
        Ok(Self {
            command: Command::SendCoord,
            payload: vec![joint_byte(number)?, high, low, moving_speed(speed)?],
        })
    }

    /// A joint moves until it is stopped.
    ///
    /// # Errors
    /// Where the joint or the speed is none that the arm takes.
    pub fn jog_angle(joint: usize, upwards: bool, speed: u8) -> Result<Self, Refusal> {
        let payload = vec![joint_byte(joint)?, u8::from(upwards), moving_speed(speed)?];
        Ok(Self { command: Command::JogAngle, payload })
    }

    /// A joint moves by an angle (deg). This request is never sent twice.
    ///
    /// # Errors
    /// Where the joint, the angle or the speed is none that the arm takes.
    pub fn jog_increment_angle(joint: usize, increment: f64, speed: u8) -> Result<Self, Refusal> {
        let number = joint_byte(joint)?;
        let [high, low] = (within(increment, (-327.67, 327.67)))
            .then(|| hundredths(increment))
            .ok_or(Refusal::Increment { joint, value: increment })?;
        let payload = vec![number, high, low, moving_speed(speed)?];
        Ok(Self { command: Command::JogIncrementAngle, payload })
    }

    /// Whether the joints are at these angles (deg).
    ///
    /// # Errors
    /// The first joint whose angle the arm does not take.
    pub fn at_angles(angles: &[f64; 6]) -> Result<Self, Refusal> {
        let mut payload = encode_angles(angles)?;
        payload.push(0);
        Ok(Self { command: Command::IsInPosition, payload })
    }

    /// Whether the flange is at these coordinates (mm, deg).
    ///
    /// # Errors
    /// The first coordinate that the arm does not take.
    pub fn at_coords(coords: &[f64; 6]) -> Result<Self, Refusal> {
        let mut payload = encode_coordinates(coords)?;
        payload.push(1);
        Ok(Self { command: Command::IsInPosition, payload })
    }

    /// A command that asks or tells about one joint alone: [`Command::GetJointMin`], [`Command::GetJointMax`],
    /// [`Command::IsServoEnable`], [`Command::ReleaseServo`], [`Command::FocusServo`], [`Command::GetEncoder`].
    ///
    /// # Errors
    /// Where there is no such joint.
    pub fn of_joint(command: Command, joint: usize) -> Result<Self, Refusal> {
        Ok(Self { command, payload: vec![joint_byte(joint)?] })
    }

    /// Torque on all joints.
    pub fn focus_all() -> Self {
        Self { command: Command::FocusServo, payload: vec![0] }
    }

    /// Torque off all joints. Undamped, the arm falls at once.
    pub fn release_all(undamped: bool) -> Self {
        Self { command: Command::ReleaseAllServos, payload: if undamped { vec![1] } else { Vec::new() } }
    }

    /// A limit of a joint (deg, sent in tenths): [`Command::SetJointMin`] or [`Command::SetJointMax`].
    ///
    /// # Errors
    /// Where the joint or the angle is none that the arm takes.
    pub fn set_joint_limit(command: Command, joint: usize, angle: f64) -> Result<Self, Refusal> {
        encode_angle(joint, angle)?;
        let [high, low] = tenths(angle);
        Ok(Self { command, payload: vec![joint_byte(joint)?, high, low] })
    }

    /// A servo to a position in ticks, 0 to 4096.
    ///
    /// # Errors
    /// Where the joint or the speed is none that the arm takes.
    pub fn set_encoder(joint: usize, ticks: u16, speed: u8) -> Result<Self, Refusal> {
        let [high, low] = ticks.to_be_bytes();
        let payload = vec![joint_byte(joint)?, high, low, moving_speed(speed)?];
        Ok(Self { command: Command::SetEncoder, payload })
    }

    /// Opens, closes or releases the gripper, at a speed of 0 to 100 %.
    ///
    /// # Errors
    /// Where the speed is none that the arm takes.
    pub fn gripper_state(state: GripperState, speed: u8, kind: Option<GripperKind>) -> Result<Self, Refusal> {
        let flag = match state {
            GripperState::Open => 0,
            GripperState::Closed => 1,
            GripperState::Released => 254,
        };
        Self::gripper(Command::SetGripperState, flag, speed, kind)
    }

    /// The gripper to an opening of 0 to 100 %, at a speed of 0 to 100 %.
    ///
    /// # Errors
    /// Where the opening or the speed is none that the arm takes.
    pub fn gripper_value(value: u8, speed: u8, kind: Option<GripperKind>) -> Result<Self, Refusal> {
        if value > 100 {
            return Err(Refusal::Gripper { value });
        }
        Self::gripper(Command::SetGripperValue, value, speed, kind)
    }

    /// How far the gripper is open, of the kind that is named or of the arm's own.
    pub fn get_gripper_value(kind: Option<u8>) -> Self {
        Self { command: Command::GetGripperValue, payload: kind.into_iter().collect() }
    }

    /// The LED's colour.
    pub fn set_color(red: u8, green: u8, blue: u8) -> Self {
        Self { command: Command::SetColor, payload: vec![red, green, blue] }
    }

    /// An output pin of an M5's base.
    pub fn set_basic_output(pin: u8, high: bool) -> Self {
        Self { command: Command::SetBasicOutput, payload: vec![pin, u8::from(high)] }
    }

    /// The command.
    pub fn command(&self) -> Command {
        self.command
    }

    /// The joint that it speaks of, from 1, if it speaks of one.
    pub fn joint(&self) -> Option<usize> {
        use Command as C;
        let names_a_joint = matches!(
            self.command,
            C::SendAngle
                | C::JogAngle
                | C::JogIncrementAngle
                | C::SetEncoder
                | C::GetEncoder
                | C::GetJointMin
                | C::GetJointMax
                | C::SetJointMin
                | C::SetJointMax
                | C::IsServoEnable
                | C::ReleaseServo
                | C::FocusServo
        );
        let first = self.payload.first().copied().filter(|number| *number > 0)?;
        names_a_joint.then_some(usize::from(first))
    }

    /// The bytes on the wire.
    pub fn encode(&self) -> Vec<u8> {
        Frame { command: self.command as u8, payload: self.payload.clone() }.encode()
    }

    fn gripper(command: Command, first: u8, speed: u8, kind: Option<GripperKind>) -> Result<Self, Refusal> {
        let mut payload = vec![first, percent(speed, 0)?];
        if let Some(GripperKind { kind, torque }) = kind {
            payload.push(kind);
            payload.extend(torque);
        }
        Ok(Self { command, payload })
    }
}

/// Hundredths on the wire: the nearest one. The maker's client cuts, and sends 8.69 for 8.7.
fn hundredths(value: f64) -> [u8; 2] {
    ((value * 100.0).round() as i16).to_be_bytes()
}

/// Tenths on the wire.
fn tenths(value: f64) -> [u8; 2] {
    ((value * 10.0).round() as i16).to_be_bytes()
}

fn joint_byte(joint: usize) -> Result<u8, Refusal> {
    if (1..=6).contains(&joint) { Ok(joint as u8) } else { Err(Refusal::Joint { joint }) }
}

fn percent(value: u8, min: u8) -> Result<u8, Refusal> {
    if (min..=100).contains(&value) { Ok(value) } else { Err(Refusal::Speed { value, min }) }
}

fn moving_speed(speed: u8) -> Result<u8, Refusal> {
    percent(speed, 1)
}

/// The range of joint 1 to 6 or coordinate 1 to 6.
fn range_of(ranges: &[Range; 6], number: usize) -> Result<Range, Refusal> {
    let index = number.checked_sub(1);
    index.and_then(|index| ranges.get(index)).copied().ok_or(Refusal::Joint { joint: number })
}

fn encode_angle(joint: usize, value: f64) -> Result<[u8; 2], Refusal> {
    let range = range_of(&ANGLES, joint)?;
    if within(value, range) { Ok(hundredths(value)) } else { Err(Refusal::Angle { joint, value, range }) }
}

fn encode_coordinate(number: usize, value: f64) -> Result<[u8; 2], Refusal> {
    let range = range_of(&COORDINATES, number)?;
    if !within(value, range) {
        let axis = AXES.get(number - 1).copied().unwrap_or_default();
        return Err(Refusal::Coordinate { axis, value, range });
    }
    Ok(if number <= 3 { tenths(value) } else { hundredths(value) })
}

fn encode_angles(angles: &[f64; 6]) -> Result<Vec<u8>, Refusal> {
    encode_six(angles, encode_angle)
}

fn encode_coordinates(coords: &[f64; 6]) -> Result<Vec<u8>, Refusal> {
    encode_six(coords, encode_coordinate)
}

fn encode_six(
    values: &[f64; 6],
    encode: fn(usize, f64) -> Result<[u8; 2], Refusal>,
) -> Result<Vec<u8>, Refusal> {
    let mut payload = Vec::with_capacity(14);
    for (number, value) in (1..).zip(values) {
        payload.extend(encode(number, *value)?);
    }
    Ok(payload)
}
