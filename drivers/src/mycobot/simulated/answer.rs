//! What it answers to each command.

use dh_runtime::{FULL_POSE, Frame as Pose, SolutionSet, Target};

use super::super::refusal::{COORDINATES, within};
use super::super::{Command, Frame, Model};
use super::SimulatedMyCobot;

/// The error of coordinates that no joint angles have.
const NO_SOLUTION: u8 = 32;
/// Ticks of a servo a turn, and at zero degrees.
const TICKS_PER_TURN: f64 = 4096.0;
const TICK_AT_ZERO: f64 = 2048.0;
/// How near to coordinates counts as there (mm, deg).
const IN_POSITION: f64 = 0.5;

const DONE: [u8; 1] = [1];

impl SimulatedMyCobot<'_> {
    /// The reply to a request; `None` where the arm is silent.
    pub(super) fn answer(&mut self, request: &Frame) -> Option<Frame> {
        let command = Command::of_byte(request.command)?;
        if !command.request_sizes().contains(&request.payload.len()) {
            return None;
        }
        let payload = self.carry_out(command, &request.payload)?;
        Some(Frame { command: request.command, payload })
    }

    fn carry_out(&mut self, command: Command, request: &[u8]) -> Option<Vec<u8>> {
        use Command as C;
        match command {
            C::GetAngles
            | C::GetCoords
            | C::GetAnglesCoords
            | C::GetAnglesPlan
            | C::GetCoordsPlan
            | C::GetEncoder
            | C::GetEncoders
            | C::IsInPosition => {
                // Without power it does not know where it is.
                if self.arm.has_power() { self.reading(command, request) } else { None }
            }
            C::SendAngle
            | C::SendAngles
            | C::SendCoord
            | C::SendCoords
            | C::JogAngle
            | C::JogIncrementAngle
            | C::SetEncoder
            | C::SetEncoders => {
                let (goal, speed) = self.goal(command, request)?;
                match goal {
                    Some(angles) => self.arm.go(angles, speed),
                    None => self.arm.latch(NO_SOLUTION),
                }
                Some(DONE.to_vec())
            }
            C::GetJointMin | C::GetJointMax | C::SetJointMin | C::SetJointMax => self.limit(command, request),
            C::GetGripperValue
            | C::SetGripperState
            | C::SetGripperValue
            | C::SetGripperCalibration
            | C::InitGripper
            | C::IsGripperMoving => self.grip(command, request),
            C::GetBasicVersion | C::SetBasicOutput if self.model == Model::Pi => None,
            _ if command.is_acknowledged() => self.switch(command, request),
            _ => self.status(command, request),
        }
    }

    /// Commands that only say something.
    fn status(&mut self, command: Command, request: &[u8]) -> Option<Vec<u8>> {
        use Command as C;
        let flag = |yes: bool| Some(vec![u8::from(yes)]);
        match command {
            C::GetModifyVersion | C::IsControllerConnected => Some(DONE.to_vec()),
            C::GetSystemVersion => Some(vec![65]),
            C::GetBasicVersion => Some(vec![24]),
            C::GetErrorInformation => Some(vec![self.arm.error()]),
            C::IsPowerOn => flag(self.arm.has_power()),
            C::IsServoEnable => {
                let joint = *request.first()?;
                let torque = *self.arm.torque().get(usize::from(joint).checked_sub(1)?)?;
                Some(vec![joint, u8::from(torque)])
            }
            C::IsAllServoEnable => flag(self.arm.is_holding()),
            C::ReadNextError => Some(vec![0; 7]),
            C::GetFreshMode => flag(self.arm.fresh),
            C::IsFreeMode => flag(self.arm.free),
            C::IsPaused => flag(self.arm.is_paused()),
            C::IsMoving => flag(self.arm.is_moving()),
            C::GetRebootCount => Some(vec![0, 1]),
            C::GetServoSpeeds => Some(words(self.arm.velocities())),
            C::GetServoVoltages => Some(vec![80; 6]),
            C::GetServoTemps => Some(vec![31, 32, 32, 31, 30, 30]),
            _ => None,
        }
    }

    /// Commands that change a state and are acknowledged.
    fn switch(&mut self, command: Command, request: &[u8]) -> Option<Vec<u8>> {
        use Command as C;
        let first = request.first().copied().unwrap_or_default();
        match command {
            C::ClearErrorInformation => self.arm.clear_error(),
            C::PowerOn | C::PowerOff => self.arm.set_power(command == C::PowerOn),
            C::ReleaseAllServos => self.arm.set_torque(0, false),
            C::ReleaseServo | C::FocusServo if first > 6 => return None,
            C::ReleaseServo | C::FocusServo => {
                self.arm.set_torque(usize::from(first), command == C::FocusServo);
            }
            C::SetFreshMode => self.arm.fresh = first == 1,
            C::SetFreeMode => self.arm.free = first == 1,
            C::Pause => self.arm.pause(),
            C::Resume => self.arm.resume(),
            C::Stop => self.arm.stop(),
            C::SetColor => self.color = request.try_into().ok()?,
            C::SetBasicOutput => {}
            _ => return None,
        }
        Some(DONE.to_vec())
    }

    fn grip(&mut self, command: Command, request: &[u8]) -> Option<Vec<u8>> {
        use Command as C;
        match (command, request) {
            (C::GetGripperValue, _) => return Some(vec![self.arm.gripper_value()]),
            (C::IsGripperMoving, _) => return Some(vec![u8::from(self.arm.is_gripper_moving())]),
            (C::SetGripperState, [0, speed, ..]) => self.arm.set_gripper(100.0, *speed),
            (C::SetGripperState, [1, speed, ..]) => self.arm.set_gripper(0.0, *speed),
            (C::SetGripperState, [254, ..]) => self.arm.release_gripper(),
            (C::SetGripperValue, [value @ ..=100, speed, ..]) => {
                self.arm.set_gripper(f64::from(*value), *speed);
            }
            (C::SetGripperCalibration | C::InitGripper, _) => {}
            _ => return None,
        }
        Some(DONE.to_vec())
    }

    fn limit(&mut self, command: Command, request: &[u8]) -> Option<Vec<u8>> {
        use Command as C;
        let joint = *request.first()?;
        let limits = self.arm.limits(usize::from(joint))?;
        match (command, request) {
            (C::GetJointMin, _) => Some([vec![joint], words([limits.0 * 10.0])].concat()),
            (C::GetJointMax, _) => Some([vec![joint], words([limits.1 * 10.0])].concat()),
            (C::SetJointMin, [_, high, low]) => {
                limits.0 = f64::from(i16::from_be_bytes([*high, *low])) / 10.0;
                Some(DONE.to_vec())
            }
            (C::SetJointMax, [_, high, low]) => {
                limits.1 = f64::from(i16::from_be_bytes([*high, *low])) / 10.0;
                Some(DONE.to_vec())
            }
            _ => None,
        }
    }

    /// Where it is and where it is going.
    fn reading(&mut self, command: Command, request: &[u8]) -> Option<Vec<u8>> {
        use Command as C;
        let hundredths = |angles: [f64; 6]| words(angles.map(|angle| angle * 100.0));
        let (angles, goals) = (self.arm.angles(), self.arm.goal_angles());
        Some(match command {
            C::GetAngles => hundredths(angles),
            C::GetAnglesPlan => hundredths(goals),
            C::GetCoords => coordinate_words(self.coordinates(&angles)?),
            C::GetCoordsPlan => coordinate_words(self.coordinates(&goals)?),
            C::GetAnglesCoords => [hundredths(angles), coordinate_words(self.coordinates(&angles)?)].concat(),
            C::GetEncoders => words(angles.map(ticks)),
            C::GetEncoder => {
                let index = usize::from(*request.first()?).checked_sub(1)?;
                words([ticks(*angles.get(index)?)])
            }
            C::IsInPosition => {
                let [.., kind] = *request else { return None };
                let there = match (kind, numbers(request)?) {
                    (0, goal) => self.arm.is_at(&goal.map(|word| word / 100.0)),
                    (1, goal) => near(&self.coordinates(&angles)?, &coordinates_of(goal)),
                    _ => return None,
                };
                vec![u8::from(there)]
            }
            _ => return None,
        })
    }

    /// The angles (deg) and the speed (percent) that a move asks for; no angles where coordinates have none. `None`
    /// for a request that makes no sense.
    fn goal(&self, command: Command, request: &[u8]) -> Option<(Option<[f64; 6]>, u8)> {
        use Command as C;
        let mut angles = self.arm.goal_angles();
        if let C::SendAngles | C::SendCoords | C::SetEncoders = command {
            let (goal, speed) = (numbers(request)?, *request.get(12)?);
            let angles = match command {
                C::SendCoords => self.solve(&coordinates_of(goal)),
                C::SetEncoders => Some(goal.map(degrees)),
                _ => Some(goal.map(|word| word / 100.0)),
            };
            return Some((angles, speed));
        }
        let (number, index) = (*request.first()?, usize::from(*request.first()?).checked_sub(1)?);
        if let C::JogAngle = command {
            let [_, upwards, speed] = *request else { return None };
            let limits = self.arm.limits_of(usize::from(number))?;
            *angles.get_mut(index)? = if upwards == 1 { limits.1 } else { limits.0 };
            return Some((Some(angles), speed));
        }
        let [_, high, low, speed] = *request else { return None };
        let word = f64::from(i16::from_be_bytes([high, low]));
        if command == C::SendCoord {
            let mut coords = self.coordinates(&self.arm.angles())?;
            *coords.get_mut(index)? = if number <= 3 { word / 10.0 } else { word / 100.0 };
            return Some((self.solve(&coords), speed));
        }
        let angle = angles.get_mut(index)?;
        *angle = match command {
            C::JogIncrementAngle => *angle + word / 100.0,
            C::SetEncoder => degrees(word),
            _ => word / 100.0,
        };
        Some((Some(angles), speed))
    }

    /// x, y, z (mm), rx, ry, rz (deg) of the flange in the table's base, at these angles (deg).
    fn coordinates(&self, angles: &[f64; 6]) -> Option<[f64; 6]> {
        let flange = self.kinematics.fk_flange(&self.arm.joint_values(angles)).ok()?;
        let [x, y, z] = flange.translation.map(|metres| metres * 1000.0);
        let [rx, ry, rz] = flange.rpy().map(f64::to_degrees);
        Some([x, y, z, rx, ry, rz])
    }

    /// The angles (deg) of these coordinates that are nearest to where it is; `None` where there are none.
    fn solve(&self, coords: &[f64; 6]) -> Option<[f64; 6]> {
        if coords.iter().zip(COORDINATES).any(|(value, range)| !within(*value, range)) {
            return None;
        }
        let [x, y, z, rx, ry, rz] = *coords;
        let flange = Pose::from_rpy([x, y, z].map(|mm| mm / 1000.0), [rx, ry, rz].map(f64::to_radians));
        let q = self.arm.positions();
        let tool = self.kinematics.fk_flange(&q).ok()?.inverse().compose(&self.kinematics.fk(&q).ok()?);
        let mut solutions = SolutionSet::default();
        let target = Target::Pose(flange.compose(&tool));
        self.kinematics.ik_within(FULL_POSE, &target, Some(&q), &mut solutions).ok()?;
        solutions.nearest(&q).map(|solution| self.arm.device_angles(solution.q))
    }
}

/// 16 bits each, the nearest.
fn words<const N: usize>(values: [f64; N]) -> Vec<u8> {
    values.iter().flat_map(|value| (value.round() as i16).to_be_bytes()).collect()
}

fn coordinate_words([x, y, z, rx, ry, rz]: [f64; 6]) -> Vec<u8> {
    words([x * 10.0, y * 10.0, z * 10.0, rx * 100.0, ry * 100.0, rz * 100.0])
}

/// The first six numbers of a request, unscaled.
fn numbers(request: &[u8]) -> Option<[f64; 6]> {
    let mut numbers = [0.0; 6];
    for (number, pair) in numbers.iter_mut().zip(request.get(..12)?.chunks_exact(2)) {
        *number = f64::from(i16::from_be_bytes(pair.try_into().ok()?));
    }
    Some(numbers)
}

fn coordinates_of([x, y, z, rx, ry, rz]: [f64; 6]) -> [f64; 6] {
    [x / 10.0, y / 10.0, z / 10.0, rx / 100.0, ry / 100.0, rz / 100.0]
}

/// Whether coordinates are the same (mm, deg), angles modulo a turn.
fn near(a: &[f64; 6], b: &[f64; 6]) -> bool {
    let differences = a.iter().zip(b).map(|(a, b)| a - b);
    differences.enumerate().all(|(index, difference)| {
        let rest = if index < 3 { difference } else { (difference + 180.0).rem_euclid(360.0) - 180.0 };
        rest.abs() <= IN_POSITION
    })
}

fn ticks(angle: f64) -> f64 {
    TICK_AT_ZERO + angle * TICKS_PER_TURN / 360.0
}

fn degrees(ticks: f64) -> f64 {
    (ticks - TICK_AT_ZERO) * 360.0 / TICKS_PER_TURN
}
