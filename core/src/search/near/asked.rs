//! What is asked of the tool, and what may move to meet it.

use super::UNKNOWNS;
use crate::frame::{cross, dot, norm, sub};
use crate::polish::turn;
use crate::target::axes_across;
use crate::{Float, Frame, Target};

/// A target, and the unknowns that are to meet it: as many as it has rows.
///
/// Methods take six of both. Where there are fewer, rows and unknowns are added, one unknown a row, that have no part in the
/// others: such an unknown never moves, and the determinant is that of the others.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a, S> {
    pub(super) target: &'a Target<S>,
    /// See [`super::Nearly::unknowns`].
    pub(super) unknowns: &'a [usize],
    /// See [`super::Nearly::follow`].
    pub(super) follow: &'a [(usize, usize, f64)],
    /// See [`across`].
    pub(super) across: [[S; 3]; 2],
    /// m
    pub(super) reach: S,
}

/// Two axes across the direction of a target that prescribes a position and one.
pub(super) fn across<S: Float>(target: &Target<S>) -> [[S; 3]; 2] {
    match target {
        Target::PositionDirection { direction, .. } => axes_across(*direction),
        _ => [[S::ZERO; 3]; 2],
    }
}

impl<'a, S: Float> Asked<'a, S> {
    /// The pose that is asked for, and the six joints that are to meet it, each for itself.
    #[inline]
    pub(super) fn pose(&self) -> Option<(&'a Frame<S>, &'a [usize; UNKNOWNS])> {
        match (self.target, self.follow) {
            (Target::Pose(pose), []) => Some((pose, self.unknowns.try_into().ok()?)),
            _ => None,
        }
    }

    /// The last unknown.
    pub(super) fn last(&self) -> usize {
        self.unknowns.len().saturating_sub(1)
    }

    /// What a tool frame misses (reaches, rad), one coordinate a row.
    #[inline]
    pub(super) fn missing(&self, tool: &Frame<S>) -> [S; UNKNOWNS] {
        let per_reach = S::ONE / self.reach;
        let away = |to: [S; 3]| sub(to, tool.translation).map(|x| x * per_reach);
        match self.target {
            Target::Pose(pose) => {
                let ([px, py, pz], [wx, wy, wz]) = (away(pose.translation), turn(tool, pose));
                [px, py, pz, wx, wy, wz]
            }
            Target::Position(position) => {
                let [px, py, pz] = away(*position);
                [px, py, pz, S::ZERO, S::ZERO, S::ZERO]
            }
            Target::PositionDirection { position, direction } => {
                let ([px, py, pz], axis) = (away(*position), tool.z_axis());
                let mut turn = cross(axis, *direction);
                if dot(axis, *direction) < S::ZERO {
                    // Longer than a quarter turn's, so that half a turn does not look like none.
                    let sine = norm(turn);
                    turn = turn.map(|x| x * (S::TWO - sine) / sine);
                }
                let [a, b] = self.across.map(|axis| dot(axis, turn));
                [px, py, pz, a, b, S::ZERO]
            }
            target => target.coordinates(tool, &target.missing(tool, per_reach)),
        }
    }

    /// Whether what is missing has no greater second derivatives than a pose has.
    pub(super) fn is_smooth(&self) -> bool {
        let smooth = matches!(
            self.target,
            Target::Pose(_) | Target::Position(_) | Target::PositionDirection { .. } | Target::Xy(_)
        );
        smooth && self.follow.is_empty()
    }

    /// How much less of that is missing with each unknown.
    pub(super) fn columns(&self, tool: &Frame<S>, jacobian: &[[S; 6]]) -> [[S; UNKNOWNS]; UNKNOWNS] {
        let per_reach = S::ONE / self.reach;
        let mut columns = [[S::ZERO; UNKNOWNS]; UNKNOWNS];
        for (place, column) in columns.iter_mut().enumerate() {
            let Some(twist) = self.twist(place, jacobian) else {
                if let Some(own) = column.get_mut(place) {
                    *own = S::ONE;
                }
                continue;
            };
            let [vx, vy, vz, wx, wy, wz] = twist;
            let [px, py, pz] = [vx, vy, vz].map(|x| x * per_reach);
            *column = match self.target {
                Target::Pose(_) => [px, py, pz, wx, wy, wz],
                Target::Position(_) => [px, py, pz, S::ZERO, S::ZERO, S::ZERO],
                Target::PositionDirection { .. } => {
                    let [a, b] = self.across.map(|axis| dot(axis, [wx, wy, wz]));
                    [px, py, pz, a, b, S::ZERO]
                }
                target => target.coordinates(tool, &target.gained(tool, &twist, per_reach)),
            };
        }
        columns
    }

    /// What an unknown does to the tool (m, rad).
    fn twist(&self, place: usize, jacobian: &[[S; 6]]) -> Option<[S; 6]> {
        let mut twist = *jacobian.get(*self.unknowns.get(place)?)?;
        for (_, joint, factor) in self.follow.iter().filter(|(of, ..)| *of == place) {
            let factor = S::from_f64(*factor);
            let own = jacobian.get(*joint)?;
            twist.iter_mut().zip(own).for_each(|(sum, part)| *sum += factor * *part);
        }
        Some(twist)
    }

    /// Changes joint values by changes of the unknowns (rad, m).
    #[inline]
    pub(super) fn go<const N: usize>(&self, q: &mut [S; N], changes: &[S; UNKNOWNS]) {
        for (joint, change) in self.unknowns.iter().zip(changes) {
            if let Some(value) = q.get_mut(*joint) {
                *value += *change;
            }
        }
        for (place, joint, factor) in self.follow {
            if let (Some(value), Some(change)) = (q.get_mut(*joint), changes.get(*place)) {
                *value += S::from_f64(*factor) * *change;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Asked, across};
    use crate::{Frame, Target, TargetKind};

    /// Joints about z at the origin, about y a metre along x, and about x at the tip, two metres along x.
    fn arm(q: &[f64; 4]) -> (Frame, [[f64; 6]; 4]) {
        let along = Frame::from_translation([1.0, 0.0, 0.0]);
        let about = |axis: usize, angle: f64| {
            let mut rpy = [0.0; 3];
            rpy[axis] = angle;
            Frame::from_rpy([0.0; 3], rpy)
        };
        let first = about(2, q[0]).compose(&along);
        let second = first.compose(&about(1, q[1])).compose(&along);
        let third = second.compose(&about(0, q[2]));
        let tip = third.compose(&about(2, q[3]));
        let column = |frame: &Frame, axis: usize| {
            let w = frame.rotation.map(|row| row[axis]);
            let lever = crate::frame::sub(tip.translation, frame.translation);
            let [x, y, z] = crate::frame::cross(w, lever);
            [x, y, z, w[0], w[1], w[2]]
        };
        let columns = [column(&Frame::IDENTITY, 2), column(&first, 1), column(&second, 0), column(&third, 2)];
        (tip, columns)
    }

    /// Columns are what quotients of differences say where the target is met, for every kind of target, with an unknown that
    /// another joint follows; what has no part is 1.
    #[test]
    fn columns_are_the_changes_of_what_is_missing() {
        let q = [0.4, -0.7, 0.9, 0.3];
        let (tool, jacobian) = arm(&q);
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
            let follow = [(0, 3, -2.0)];
            let across = across(&target);
            let asked = Asked { target: &target, unknowns: &[0, 2], follow: &follow, across, reach: 2.0 };
            let columns = asked.columns(&tool, &jacobian);
            for place in 0..2 {
                let step = 1e-6;
                let mut changes = [0.0; 6];
                changes[place] = step;
                let mut moved = q;
                asked.go(&mut moved, &changes);
                let missing = asked.missing(&arm(&moved).0);
                for (gained, missing) in columns[place].iter().zip(missing) {
                    assert!((gained * step + missing).abs() < 1e-11, "{kind}: {columns:?}, {missing:e}");
                }
            }
            for (place, column) in columns.iter().enumerate().skip(2) {
                assert!(column.iter().enumerate().all(|(row, x)| *x == f64::from(u8::from(row == place))));
            }
        }
    }
}
