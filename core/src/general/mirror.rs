//! A change of joint values that no pose of the tip shows: of every solution it makes another one.

use super::{JOINTS, SixJoints};
use crate::Frame;

/// Lengths (reaches) and cosines up to this are taken for 0: an arm that is further from having the symmetry than rounding
/// doesn't have it.
const EXACT: f64 = 1e-14;

/// Two joints go half a turn on, those between them are turned over: q becomes a sum less q.
///
/// A half turn about the first axis is handed on from joint to joint: about a line that meets an axis at a right angle it
/// turns a joint's sense around, and it is absorbed by a joint about whose axis it is. In between it is about the common
/// perpendiculars of the axes, so they must meet each axis at one point. That is so wherever an axis meets the next one at a
/// right angle, the next ones are parallel, and the last of them meets a further one at a right angle, without an offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mirror {
    first: usize,
    last: usize,
    /// Of the old and the new value of the joints between these (rad).
    sums: [f64; JOINTS],
}

/// A line that meets the z axis at a right angle: at which height, and in which direction.
#[derive(Debug, Clone, Copy)]
struct Spoke {
    height: f64,
    direction: [f64; 2],
}

impl Mirror {
    /// The one in which a joint goes half a turn on. `None` where the arm, lengths in reaches, has none.
    pub(super) fn of(arm: &SixJoints<'_>, joint: usize) -> Option<Self> {
        (0..JOINTS).filter_map(|first| Self::from(arm, first)).find(|mirror| mirror.turns(joint))
    }

    /// Whether a joint goes half a turn on.
    fn turns(&self, joint: usize) -> bool {
        joint == self.first || joint == self.last
    }

    /// The one whose first joint this is.
    fn from(arm: &SixJoints<'_>, first: usize) -> Option<Self> {
        let [_, links @ ..] = &arm.links;
        let slides = |joint: usize| arm.prismatic.get(joint).copied().unwrap_or(true);
        if slides(first) {
            return None;
        }
        // The first axis is a spoke of the next.
        let mut before = Spoke::along_z(&links.get(first)?.inverse())?;
        let mut mirror = Self { first, last: first, sums: [0.0; JOINTS] };
        for joint in first + 1..JOINTS {
            let link = links.get(joint)?;
            if slides(joint) || slides(joint + 1) {
                return None;
            }
            let end = Spoke::along_z(link).filter(|spoke| is_zero(spoke.height - before.height));
            let (after, next) = end.map_or_else(|| before.handed_on(link), |spoke| Some((spoke, spoke)))?;
            let ([a, b], [c, d]) = (before.direction, after.direction);
            *mirror.sums.get_mut(joint)? = 2.0 * libm::atan2(b * c - a * d, a * c + b * d);
            if end.is_some() {
                return Some(Self { last: joint + 1, ..mirror });
            }
            before = next;
        }
        None
    }

    /// The other solution (rad, and any unit of length); whether the determinant of the Jacobian changes its sign.
    pub(super) fn apply(&self, q: &[f64; JOINTS]) -> ([f64; JOINTS], bool) {
        let mut other = *q;
        for (joint, (value, sum)) in other.iter_mut().zip(self.sums).enumerate() {
            if self.turns(joint) {
                *value = crate::Float::wrap_angle(*value + core::f64::consts::PI);
            } else if joint > self.first && joint < self.last {
                *value = crate::Float::wrap_angle(sum - *value);
            }
        }
        (other, (self.last - self.first).is_multiple_of(2))
    }
}

impl Spoke {
    /// The z axis of a frame, if it is one.
    fn along_z(frame: &Frame) -> Option<Self> {
        let [dx, dy, dz] = frame.z_axis();
        let [x, y, height] = frame.translation;
        (is_zero(dz) && is_zero(x * dy - y * dx)).then_some(Self { height, direction: [dx, dy] })
    }

    /// The spoke at this height that is one of the next axis as well, as both see it.
    fn handed_on(&self, link: &Frame) -> Option<(Self, Self)> {
        let [dx, dy, dz] = link.z_axis();
        let [x, y, z] = link.translation;
        let square = dx * dx + dy * dy;
        let (along, height) = if square > EXACT * EXACT {
            let height = -(x * dx + y * dy) / square;
            if !is_zero(z + height * dz - self.height) {
                return None;
            }
            ([-dy, dx], height)
        } else {
            ([x, y], (self.height - z) * dz)
        };
        let [a, b] = along;
        let length = libm::sqrt(a * a + b * b);
        if length <= EXACT {
            return None;
        }
        let [a, b] = [a / length, b / length];
        let [[r11, r12, _], [r21, r22, _], _] = link.rotation;
        let next = Self { height, direction: [r11 * a + r21 * b, r12 * a + r22 * b] };
        Some((Self { direction: [a, b], ..*self }, next))
    }
}

fn is_zero(x: f64) -> bool {
    libm::fabs(x) <= EXACT
}
