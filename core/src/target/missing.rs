//! What a tool frame misses of a target as a vector, for methods that go downhill, and how it changes as the tool moves.

use crate::frame::{self, add, cross, dot, norm, sub, transpose};
use crate::{Float, Frame, Target};

impl<S: Float> Target<S> {
    /// What a tool frame misses: lengths (m) times `per_reach`, then angles (rad). As long as [`Target::errors`].
    pub(crate) fn missing(&self, tool: &Frame<S>, per_reach: S) -> [S; 6] {
        let point = tool.translation;
        let length = |v: [S; 3]| v.map(|x| x * per_reach);
        let plane = |[x, y]: [S; 2]| {
            let [px, py, _] = point;
            length([x - px, y - py, S::ZERO])
        };
        let ([px, py, pz], [ax, ay, az]) = match self {
            Self::Pose(frame) => {
                (length(sub(frame.translation, point)), turn(&frame.rotation, &tool.rotation))
            }
            Self::Position(position) => (length(sub(*position, point)), [S::ZERO; 3]),
            Self::PositionDirection { position, direction } => {
                (length(sub(*position, point)), between(tool.z_axis(), *direction))
            }
            Self::PositionYaw { position, yaw } => (length(sub(*position, point)), yaw_off(*yaw, tool)),
            Self::Rotation(rotation) => ([S::ZERO; 3], turn(rotation, &tool.rotation)),
            Self::Direction(direction) => ([S::ZERO; 3], between(tool.z_axis(), *direction)),
            Self::Ray { position, direction } => {
                (length(cross(*direction, sub(point, *position))), between(tool.z_axis(), *direction))
            }
            Self::Lookat(position) => (length(cross(tool.z_axis(), sub(*position, point))), [S::ZERO; 3]),
            Self::Xy(position) => (plane(*position), [S::ZERO; 3]),
            Self::XyYaw { position, yaw } => (plane(*position), yaw_off(*yaw, tool)),
        };
        [px, py, pz, ax, ay, az]
    }

    /// How much less of it is missing as the tool moves with a twist: vx vy vz (m) wx wy wz (rad) at the tool point, base
    /// axes. Of turns, the part that does not vanish with what is missing: exact where the target is met, and downhill
    /// elsewhere.
    pub(crate) fn gained(&self, tool: &Frame<S>, [vx, vy, vz, wx, wy, wz]: &[S; 6], per_reach: S) -> [S; 6] {
        let (linear, angular) = ([*vx, *vy, *vz], [*wx, *wy, *wz]);
        let length = |v: [S; 3]| v.map(|x| x * per_reach);
        let none = [S::ZERO; 3];
        let across = |direction: [S; 3]| {
            let along = dot(angular, direction);
            sub(angular, direction.map(|x| x * along))
        };
        let yaw = || {
            let axis = tool.x_axis();
            let ([x, y, _], [dx, dy, _]) = (axis, cross(angular, axis));
            let level = x * x + y * y;
            // An axis that stands upright has no yaw.
            [if level > S::ZERO { (x * dy - y * dx) / level } else { S::ZERO }, S::ZERO, S::ZERO]
        };
        let flat = || length([*vx, *vy, S::ZERO]);
        let ([px, py, pz], [ax, ay, az]) = match self {
            Self::Pose(_) => (length(linear), angular),
            Self::Position(_) => (length(linear), none),
            Self::PositionDirection { direction, .. } => (length(linear), across(*direction)),
            Self::PositionYaw { .. } => (length(linear), yaw()),
            Self::Rotation(_) => (none, angular),
            Self::Direction(direction) => (none, across(*direction)),
            Self::Ray { direction, .. } => (length(cross(linear, *direction)), across(*direction)),
            Self::Lookat(position) => {
                let axis = tool.z_axis();
                let turned = cross(cross(angular, axis), sub(*position, tool.translation));
                (length(sub(cross(axis, linear), turned)), none)
            }
            Self::Xy(_) => (flat(), none),
            Self::XyYaw { .. } => (flat(), yaw()),
        };
        [px, py, pz, ax, ay, az]
    }

    /// Of what is gained (or missing), as many coordinates as the target has rows, then zeros: of what lies across a
    /// direction its two coordinates there, in axes that are right-handed with it.
    pub(crate) fn coordinates(&self, tool: &Frame<S>, [px, py, pz, ax, ay, az]: &[S; 6]) -> [S; 6] {
        let (linear, angular) = ([*px, *py, *pz], [*ax, *ay, *az]);
        let flat = |direction: [S; 3], vector: [S; 3]| {
            let [first, second] = axes_across(direction);
            [dot(first, vector), dot(second, vector)]
        };
        let none = S::ZERO;
        match self {
            Self::Pose(_) => [*px, *py, *pz, *ax, *ay, *az],
            Self::Position(_) | Self::Xy(_) => [*px, *py, *pz, none, none, none],
            Self::PositionDirection { direction, .. } => {
                let [a, b] = flat(*direction, angular);
                [*px, *py, *pz, a, b, none]
            }
            Self::PositionYaw { .. } => [*px, *py, *pz, *ax, none, none],
            Self::Rotation(_) => [*ax, *ay, *az, none, none, none],
            Self::Direction(direction) => {
                let [a, b] = flat(*direction, angular);
                [a, b, none, none, none, none]
            }
            Self::Ray { direction, .. } => {
                let ([a, b], [c, d]) = (flat(*direction, linear), flat(*direction, angular));
                [a, b, c, d, none, none]
            }
            Self::Lookat(_) => {
                let [a, b] = flat(tool.z_axis(), linear);
                [a, b, none, none, none, none]
            }
            Self::XyYaw { .. } => [*px, *py, *ax, none, none, none],
        }
    }
}

/// The turn from one direction to another: its axis, as long as its angle (rad).
fn between<S: Float>(from: [S; 3], to: [S; 3]) -> [S; 3] {
    let across = cross(from, to);
    let sine = norm(across);
    if sine <= S::ZERO {
        // Half a turn is about any axis across.
        let half = if dot(from, to) < S::ZERO { S::PI } else { S::ZERO };
        return perpendicular(from).map(|x| x * half);
    }
    let angle = sine.atan2(dot(from, to));
    across.map(|x| x / sine * angle)
}

/// Two axes that are right-handed with a direction.
pub(crate) fn axes_across<S: Float>(direction: [S; 3]) -> [[S; 3]; 2] {
    let first = perpendicular(direction);
    [first, cross(direction, first)]
}

/// A direction across another.
fn perpendicular<S: Float>(direction: [S; 3]) -> [S; 3] {
    let [x, y, z] = direction;
    let least = if x.abs() <= y.abs() && x.abs() <= z.abs() {
        [S::ONE, S::ZERO, S::ZERO]
    } else if y.abs() <= z.abs() {
        [S::ZERO, S::ONE, S::ZERO]
    } else {
        [S::ZERO, S::ZERO, S::ONE]
    };
    let across = cross(direction, least);
    let length = norm(across);
    across.map(|x| x / length)
}

/// The turn from one orientation to another: its axis, as long as its angle (rad).
fn turn<S: Float>(to: &[[S; 3]; 3], from: &[[S; 3]; 3]) -> [S; 3] {
    let (axis, trace) = frame::turn(from, to);
    let sine = norm(axis);
    if sine <= S::ZERO {
        if trace >= S::ONE {
            return [S::ZERO; 3];
        }
        // Half a turn: what it leaves where it is, twice, is what any direction and its image add up to.
        let sums = transpose(from).into_iter().zip(transpose(to)).map(|(own, wanted)| add(own, wanted));
        let axis = sums.fold([S::ZERO; 3], |axis, sum| if norm(sum) > norm(axis) { sum } else { axis });
        let length = norm(axis);
        return axis.map(|x| x / length * S::PI);
    }
    let angle = sine.atan2((trace - S::ONE) / S::TWO);
    axis.map(|x| x / sine * angle)
}

fn yaw_off<S: Float>(yaw: S, tool: &Frame<S>) -> [S; 3] {
    let [x, y, _] = tool.x_axis();
    [(yaw - y.atan2(x)).wrap_angle(), S::ZERO, S::ZERO]
}
