//! What Newton's method needs of a chain.

use super::linear::{determinant, solve};
use super::{JOINTS, SixJoints};
use crate::frame::{cross, sub};
use crate::{Float, Frame};

/// The tip, and the columns of the Jacobian.
pub(super) fn pose_and_jacobian(arm: &SixJoints<'_>, q: &[f64; JOINTS]) -> (Frame, [[f64; 6]; JOINTS]) {
    let [base, links @ ..] = &arm.links;
    let mut frame = *base;
    let mut axes = [([0.0; 3], [0.0; 3]); JOINTS];
    for (((value, link), slides), axis) in q.iter().zip(links).zip(arm.prismatic).zip(&mut axes) {
        *axis = (frame.z_axis(), frame.translation);
        frame = moved(&frame, slides, *value).compose(link);
    }
    let mut columns = [[0.0; 6]; JOINTS];
    for ((column, (axis, origin)), slides) in columns.iter_mut().zip(axes).zip(arm.prismatic) {
        let [wx, wy, wz] = if slides { [0.0; 3] } else { axis };
        let [vx, vy, vz] = if slides { axis } else { cross(axis, sub(frame.translation, origin)) };
        *column = [vx, vy, vz, wx, wy, wz];
    }
    (frame, columns)
}

impl SixJoints<'_> {
    /// The determinant of the Jacobian at joint values (rad, m), lengths in reaches.
    pub(crate) fn determinant(&self, q: &[f64; JOINTS]) -> f64 {
        let (_, columns) = pose_and_jacobian(self, q);
        let mut rows = columns
            .map(|[vx, vy, vz, wx, wy, wz]| [vx / self.reach, vy / self.reach, vz / self.reach, wx, wy, wz]);
        solve(&mut rows)
    }

    /// Joint values (rad, m) whose last three joints, which stand for an orientation that a target leaves open, don't turn the
    /// determinant of the Jacobian over, and whether these did. They are any rotation in two ways, by a turn about z, one about x
    /// and one about z, of which the middle one goes either way round.
    pub(crate) fn turned_back(&self, q: &[f64; JOINTS]) -> ([f64; JOINTS], bool) {
        let (_, columns) = pose_and_jacobian(self, q);
        let [.., a, b, c] = columns.map(|[_, _, _, wx, wy, wz]| [wx, wy, wz]);
        let [x, y, z, first, middle, last] = *q;
        if determinant(&[a, b, c]) >= 0.0 {
            return (*q, false);
        }
        let half = core::f64::consts::PI;
        ([x, y, z, (first + half).wrap_angle(), -middle, (last + half).wrap_angle()], true)
    }
}

/// A frame moved along or about its z axis.
pub(crate) fn moved(frame: &Frame, slides: bool, value: f64) -> Frame {
    let Frame { rotation: [[a, b, c], [d, e, f], [g, h, i]], translation: [x, y, z] } = *frame;
    if slides {
        return Frame { translation: [x + c * value, y + f * value, z + i * value], ..*frame };
    }
    let (s, t) = libm::sincos(value);
    Frame {
        rotation: [
            [t * a + s * b, t * b - s * a, c],
            [t * d + s * e, t * e - s * d, f],
            [t * g + s * h, t * h - s * g, i],
        ],
        translation: [x, y, z],
    }
}
