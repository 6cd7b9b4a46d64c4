//! What targets prescribe, as numbers of a tool frame.

use crate::model;
use dh_core::{Frame, Target};
use std::f64::consts::FRAC_1_SQRT_2;

/// Below this (of 1) the tool's x axis points along base z and has no yaw.
const UPRIGHT: f64 = 1e-3;

/// The target of a kind that a tool frame meets; `None` where the frame has none (no yaw). `number` varies what the
/// frame leaves open: which point of the tool's axis is asked for, up to `reach` (m) away.
pub(super) fn target_of(
    kind: model::Target,
    tool: &Frame<f64>,
    number: usize,
    reach: f64,
) -> Option<Target<f64>> {
    let position = tool.translation;
    let [[r11, ..], [r21, ..], _] = tool.rotation;
    let direction = tool.z_axis();
    let yaw = (f64::hypot(r11, r21) > UPRIGHT).then(|| libm::atan2(r21, r11));
    let along = reach * [0.5, 0.0, 0.25, 1.0][number % 4];
    let ahead = sum(position, direction, along);
    let [x, y, _] = position;
    Some(match kind {
        model::Target::Pose => Target::Pose(*tool),
        model::Target::Position => Target::Position(position),
        model::Target::PositionDirection => Target::PositionDirection { position, direction },
        model::Target::PositionYaw => Target::PositionYaw { position, yaw: yaw? },
        model::Target::Rotation => Target::Rotation(tool.rotation),
        model::Target::Direction => Target::Direction(direction),
        model::Target::Ray => Target::Ray { position: ahead, direction },
        // The point on the axis must not be the tool's own, which any direction would meet.
        model::Target::Lookat => Target::Lookat(sum(position, direction, along + reach / 8.0)),
        model::Target::Xy => Target::Xy([x, y]),
        model::Target::XyYaw => Target::XyYaw { position: [x, y], yaw: yaw? },
    })
}

/// The numbers of a tool frame that a target prescribes: they change smoothly with the joints, and to first order
/// the target is met where they don't change. Angles are unit vectors' coordinates, so that each is about 1 per rad.
pub(super) fn prescribed(target: &Target<f64>, tool: &Frame<f64>) -> Vec<f64> {
    let position = tool.translation;
    let direction = tool.z_axis();
    let rotation = || tool.rotation.into_iter().flatten().map(|entry| entry * FRAC_1_SQRT_2);
    let yaw = || {
        let [[r11, ..], [r21, ..], _] = tool.rotation;
        let length = f64::hypot(r11, r21);
        [r11 / length, r21 / length]
    };
    match target {
        Target::Pose(_) => position.into_iter().chain(rotation()).collect(),
        Target::Position(_) => position.to_vec(),
        Target::PositionDirection { .. } => [position, direction].concat(),
        Target::PositionYaw { .. } => position.into_iter().chain(yaw()).collect(),
        Target::Rotation(_) => rotation().collect(),
        Target::Direction(_) => direction.to_vec(),
        Target::Ray { position: point, .. } => [off_axis(tool, *point), direction].concat(),
        Target::Lookat(point) => off_axis(tool, *point).to_vec(),
        Target::Xy(_) => position[..2].to_vec(),
        Target::XyYaw { .. } => position[..2].iter().copied().chain(yaw()).collect(),
    }
}

/// From the nearest point of the tool's z axis to a point (m).
fn off_axis(tool: &Frame<f64>, point: [f64; 3]) -> [f64; 3] {
    let direction = tool.z_axis();
    let to = sum(point, tool.translation, -1.0);
    let along: f64 = to.iter().zip(&direction).map(|(to, direction)| to * direction).sum();
    sum(to, direction, -along)
}

/// `point + factor * direction`
fn sum(point: [f64; 3], direction: [f64; 3], factor: f64) -> [f64; 3] {
    let [x, y, z] = point;
    let [dx, dy, dz] = direction;
    [x + factor * dx, y + factor * dy, z + factor * dz]
}
