//! Tool frames that meet a target, with what it leaves open drawn evenly.

use crate::evenly::evenly;
use crate::{Float, Frame, Target};

/// The frame of this number. Lengths that are left open go as far as `reach` (m) about `middle`.
pub(super) fn frame<S: Float>(target: &Target<S>, number: u32, reach: S, middle: [S; 3]) -> Frame<S> {
    let ([one], [two, aside], [u, v, w, t]) =
        (evenly(number, 1), evenly(number, 2), evenly::<S, 4>(number, 4));
    let [roll, pitch, yaw] = [u * S::TAU, v * S::PI, w * S::TAU];
    let about = |turn: [S; 3]| Frame::from_rpy([S::ZERO; 3], turn);
    let spun = |part: S| about([S::ZERO, S::ZERO, part * S::TAU]);
    let along = |part: S| Frame::from_translation([S::ZERO, S::ZERO, S::TWO * part * reach]);
    let [_, _, height] = middle;
    let above = |[x, y]: [S; 2]| [x, y, height + S::TWO * t * reach];
    let at = |translation: [S; 3], frame: Frame<S>| Frame { translation, ..frame };
    let any = || about([roll, pitch, yaw]);
    // What has no place is drawn about the middle.
    let own = target.frame().unwrap_or(Frame::from_translation(middle));
    match *target {
        Target::Pose(_) => own,
        Target::Position(position) => at(position, any()),
        Target::PositionDirection { .. } => own * spun(one),
        Target::Ray { .. } => own * along(aside) * spun(two),
        Target::Rotation(rotation) => Frame { rotation, translation: middle },
        Target::Direction(direction) => {
            let ray = Target::Ray { position: middle, direction };
            ray.frame().unwrap_or(own) * spun(one)
        }
        Target::Lookat(position) => at(position, any()) * along(t),
        Target::PositionYaw { position, yaw } => at(position, about([roll, pitch, yaw])),
        Target::Xy(position) => at(above(position), any()),
        Target::XyYaw { position, yaw } => at(above(position), about([roll, pitch, yaw])),
    }
}

#[cfg(test)]
mod tests {
    use super::frame;
    use crate::{Frame, Target, TargetKind};

    #[test]
    fn drawn_frames_meet_their_target() {
        let tool = Frame::from_rpy([0.3, -0.2, 0.5], [0.7, -0.4, 2.0]);
        let kinds = [
            TargetKind::Pose,
            TargetKind::Position,
            TargetKind::PositionDirection,
            TargetKind::PositionYaw,
            TargetKind::Rotation,
            TargetKind::Direction,
            TargetKind::Ray,
            TargetKind::Lookat,
            TargetKind::Xy,
            TargetKind::XyYaw,
        ];
        for kind in kinds {
            let target = Target::of_frame(kind, &tool);
            for number in 0..50 {
                let drawn = frame(&target, number, 1.0, [0.1, 0.2, 0.3]);
                let (position, rotation) = target.errors(&drawn);
                assert!(position < 1e-12 && rotation < 1e-7, "{kind}: {position:e} {rotation:e}");
            }
        }
    }
}
