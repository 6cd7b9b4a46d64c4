//! Where joints and tool point may be.

mod violations;

use core::fmt;

pub use violations::{Violation, Violations};

use crate::{Float, Joint, Limits};

/// Everything that restricts joint values and the tool point. Borrowed tables: constants in generated code, a model in
/// the interpreter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules<'a, S = f64> {
    /// The joints with their limits, in the order of q.
    pub joints: &'a [Joint<'a, S>],
    /// Limits on sums of joints.
    pub sums: &'a [SumLimit<'a, S>],
    /// Bounds on the tool point.
    pub bounds: &'a [Bound<S>],
    /// Boxes that the tool point stays out of.
    pub keep_out: &'a [KeepOut<S>],
    /// Whole turns that leave every frame where it is.
    pub windings: &'a [Winding<'a, S>],
}

/// A limit on a weighted sum of joint values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SumLimit<'a, S = f64> {
    /// (index of q, coefficient).
    pub terms: &'a [(usize, S)],
    /// rad or m.
    pub range: Limits<S>,
}

impl<S: Float> SumLimit<'_, S> {
    /// The sum at these joint values (rad or m).
    pub fn value(&self, q: &[S]) -> S {
        self.terms.iter().fold(S::ZERO, |sum, (joint, coefficient)| {
            sum + q.get(*joint).map_or(S::ZERO, |value| *coefficient * *value)
        })
    }
}

/// A coordinate axis of the base frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    pub(crate) fn of<S: Copy>(self, [x, y, z]: [S; 3]) -> S {
        match self {
            Self::X => x,
            Self::Y => y,
            Self::Z => z,
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

/// Which end of a range a bound is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Smaller values are refused.
    Min,
    /// Greater values are refused.
    Max,
}

/// One bound on a coordinate of the tool point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound<S = f64> {
    /// Which coordinate.
    pub axis: Axis,
    /// Which side is allowed.
    pub side: Side,
    /// m
    pub value: S,
}

/// A box, with edges along the base axes, that the tool point stays out of. Its surface is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeepOut<S = f64> {
    /// Least corner (m).
    pub min: [S; 3],
    /// Greatest corner (m).
    pub max: [S; 3],
}

/// One whole turn that leaves every frame where it is: `q[joint] += turn` and `q[k] += c` for every carried (k, c).
///
/// Only couplings that aren't whole numbers carry anything. In a list of them, a joint's own winding comes before those
/// of the joints that it carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Winding<'a, S = f64> {
    /// Index of q.
    pub joint: usize,
    /// rad
    pub turn: S,
    /// (index of q, rad or m).
    pub carries: &'a [(usize, S)],
}

impl<S: Float> Winding<'_, S> {
    /// Adds this many turns to the joint values.
    pub(crate) fn apply(&self, q: &mut [S], turns: S) {
        if let Some(value) = q.get_mut(self.joint) {
            *value += turns * self.turn;
        }
        for (joint, carried) in self.carries {
            if let Some(value) = q.get_mut(*joint) {
                *value += turns * *carried;
            }
        }
    }

    /// Takes whole turns away until the joint is in (-turn/2, turn/2].
    #[inline]
    pub(crate) fn wrap(&self, q: &mut [S]) {
        let Some(value) = q.get_mut(self.joint) else {
            return;
        };
        let (before, half) = (*value, self.turn / S::TWO);
        if before > -half && before <= half {
            return;
        }
        *value = crate::float::wrap(before, self.turn);
        if self.carries.is_empty() {
            return;
        }
        let turns = ((*value - before) / self.turn).round();
        for (joint, carried) in self.carries {
            if let Some(value) = q.get_mut(*joint) {
                *value += turns * *carried;
            }
        }
    }
}

/// Brings joint values to the representative with every revolute joint within half a turn of 0.
pub(crate) fn wrap_all<S: Float>(windings: &[Winding<'_, S>], q: &mut [S]) {
    for winding in windings {
        winding.wrap(q);
    }
}

/// A rule that joint values break, other than the limits of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Rule<S = f64> {
    /// A sum of joints leaves its range.
    Sum {
        /// Index in [`Rules::sums`].
        index: usize,
        /// Its value (rad or m).
        value: S,
        /// rad or m
        min: S,
        /// rad or m
        max: S,
    },
    /// The tool point is on the wrong side of a bound.
    Bound {
        /// Which bound.
        bound: Bound<S>,
        /// The coordinate of the tool point (m).
        value: S,
    },
    /// The tool point is in a box.
    KeepOut {
        /// Index in [`Rules::keep_out`].
        index: usize,
        /// The tool point (m).
        position: [S; 3],
    },
    /// A condition of the inverse problem (`where` in the table) doesn't hold.
    Where {
        /// Index among the problem's conditions.
        index: usize,
        /// By how much (rad or m).
        excess: S,
    },
}

impl<S: Float> fmt::Display for Rule<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sum { index, value, min, max } => {
                write!(f, "sum {} is {value:.6}, not in {min:.6} to {max:.6} (rad or m)", index + 1)
            }
            Self::Bound { bound: Bound { axis, side, value: limit }, value } => {
                let relation = match side {
                    Side::Min => "below",
                    Side::Max => "above",
                };
                write!(f, "the tool point's {axis} is {value:.6} m, {relation} {limit:.6} m")
            }
            Self::KeepOut { index, position: [x, y, z] } => {
                write!(f, "the tool point ({x:.6}, {y:.6}, {z:.6}) m is in keep-out box {}", index + 1)
            }
            Self::Where { index, excess } => {
                write!(f, "condition {} of the problem is exceeded by {excess:.6} (rad or m)", index + 1)
            }
        }
    }
}

/// A limit or bound counts as kept up to this many machine epsilons beyond it (times its own size where that is more
/// than 1): 2e-13 in f64, 1e-4 in f32. Joint values that an inverse solution or a conversion of units puts on a limit
/// differ from it in the last digits, and none of them is a reason to refuse.
const LIMIT_SLACK: f64 = 1024.0;

pub(crate) fn slack<S: Float>(limit: S) -> S {
    S::from_f64(LIMIT_SLACK) * S::EPSILON * limit.abs().max(S::ONE)
}

/// Whether the value keeps the limits, up to the slack.
pub(crate) fn within<S: Float>(limits: &Limits<S>, value: S) -> bool {
    value >= limits.min - slack(limits.min) && value <= limits.max + slack(limits.max)
}

impl<'a, S: Float> Rules<'a, S> {
    /// The limits of these joints and no other rules.
    pub const fn of_joints(joints: &'a [Joint<'a, S>], windings: &'a [Winding<'a, S>]) -> Self {
        Self { joints, sums: &[], bounds: &[], keep_out: &[], windings }
    }

    /// Everything that these joint values (rad or m) with this tool point (m, base frame) break.
    pub fn violations(&self, q: &[S], position: [S; 3]) -> Violations<'a, S> {
        Violations::new(*self, q, position)
    }

    /// Whether these joint values (rad or m) with this tool point (m, base frame) are allowed.
    ///
    /// # Errors
    /// Every rule that they break.
    #[allow(clippy::result_large_err, reason = "no heap: the error holds the joint values that it speaks of")]
    pub fn check(&self, q: &[S], position: [S; 3]) -> Result<(), Violations<'a, S>> {
        let violations = self.violations(q, position);
        if violations.is_empty() { Ok(()) } else { Err(violations) }
    }

    /// The first sum that the joint values break.
    pub(crate) fn broken_sum(&self, q: &[S]) -> Option<Rule<S>> {
        self.sums.iter().enumerate().find_map(|(index, sum)| sum_rule(index, sum, q))
    }

    /// The first workspace rule that the tool point (m) breaks.
    pub(crate) fn broken_workspace(&self, position: [S; 3]) -> Option<Rule<S>> {
        let bound = self.bounds.iter().find_map(|bound| bound_rule(bound, position));
        bound.or_else(|| {
            self.keep_out.iter().enumerate().find_map(|(index, keep)| keep_out_rule(index, keep, position))
        })
    }

    /// Whether the joint limits and sums allow these joint values.
    pub(crate) fn allow_joints(&self, q: &[S]) -> bool {
        let limits =
            self.joints.iter().zip(q).all(|(joint, value)| joint.limits.is_none_or(|l| within(&l, *value)));
        limits && self.broken_sum(q).is_none()
    }
}

fn sum_rule<S: Float>(index: usize, sum: &SumLimit<'_, S>, q: &[S]) -> Option<Rule<S>> {
    let value = sum.value(q);
    let Limits { min, max } = sum.range;
    (!within(&sum.range, value)).then_some(Rule::Sum { index, value, min, max })
}

fn bound_rule<S: Float>(bound: &Bound<S>, position: [S; 3]) -> Option<Rule<S>> {
    let value = bound.axis.of(position);
    let kept = match bound.side {
        Side::Min => value >= bound.value - slack(bound.value),
        Side::Max => value <= bound.value + slack(bound.value),
    };
    (!kept).then_some(Rule::Bound { bound: *bound, value })
}

fn keep_out_rule<S: Float>(index: usize, keep: &KeepOut<S>, position: [S; 3]) -> Option<Rule<S>> {
    let inside = [Axis::X, Axis::Y, Axis::Z].into_iter().all(|axis| {
        let (value, min, max) = (axis.of(position), axis.of(keep.min), axis.of(keep.max));
        value > min + slack(min) && value < max - slack(max)
    });
    inside.then_some(Rule::KeepOut { index, position })
}
