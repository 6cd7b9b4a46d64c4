//! All rules that a set of joint values breaks, with their numbers.

use core::error::Error;
use core::fmt;

use super::{Rule, Rules, bound_rule, keep_out_rule, sum_rule, within};
use crate::{Float, JointKind, LengthError, Limits, MAX_JOINTS};

/// Everything that a set of joint values breaks. An error that lists them all; [`Violations::iter`] gives them one by
/// one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Violations<'a, S = f64> {
    rules: Rules<'a, S>,
    q: [S; MAX_JOINTS],
    got: usize,
    position: [S; 3],
}

/// One broken rule.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Violation<'a, S = f64> {
    /// There are too few or too many joint values; nothing else is checked then.
    Length(LengthError),
    /// A joint value is infinite or NaN.
    NotFinite {
        /// Index in q.
        joint: usize,
        /// The joint's name.
        name: &'a str,
        /// The value.
        value: S,
    },
    /// A joint is outside its limits.
    OutsideLimits {
        /// Index in q.
        joint: usize,
        /// The joint's name.
        name: &'a str,
        /// Whether the numbers are radians or metres.
        kind: JointKind,
        /// Its value (rad or m).
        value: S,
        /// rad or m
        min: S,
        /// rad or m
        max: S,
    },
    /// Another rule.
    Forbidden(Rule<S>),
}

impl<'a, S: Float> Violations<'a, S> {
    pub(super) fn new(rules: Rules<'a, S>, q: &[S], position: [S; 3]) -> Self {
        let mut copy = [S::ZERO; MAX_JOINTS];
        for (to, from) in copy.iter_mut().zip(q) {
            *to = *from;
        }
        Self { rules, q: copy, got: q.len(), position }
    }

    /// The violation of having the wrong number of joint values.
    pub fn of_length(rules: Rules<'a, S>, q: &[S]) -> Self {
        Self::new(rules, q, [S::ZERO; 3])
    }

    /// The joint values (rad or m) that were checked.
    pub fn q(&self) -> &[S] {
        self.q.get(..self.got).unwrap_or(&self.q)
    }

    /// Whether nothing is broken.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    /// Every broken rule: joint limits, sums, bounds, keep-out boxes, each in the table's order.
    pub fn iter(&self) -> impl Iterator<Item = Violation<'a, S>> {
        let Self { rules, q, got, position } = *self;
        let length = LengthError::check(rules.joints.len(), got).err();
        let rules = if length.is_some() { Rules::of_joints(&[], &[]) } else { rules };
        let joints = rules.joints.iter().zip(q).enumerate().filter_map(|(joint, (row, value))| {
            if !value.is_finite() {
                return Some(Violation::NotFinite { joint, name: row.name, value });
            }
            let Limits { min, max } = row.limits.filter(|limits| !within(limits, value))?;
            Some(Violation::OutsideLimits { joint, name: row.name, kind: row.kind, value, min, max })
        });
        let finite = q.iter().take(rules.joints.len()).all(|value| value.is_finite());
        // With a joint nowhere, sums and the tool point are nowhere too: nothing more to be said of them.
        let rules = if finite { rules } else { Rules::of_joints(&[], &[]) };
        let sums = rules.sums.iter().enumerate().filter_map(move |(index, sum)| sum_rule(index, sum, &q));
        let bounds = rules.bounds.iter().filter_map(move |bound| bound_rule(bound, position));
        let boxes = rules.keep_out.iter().enumerate();
        let boxes = boxes.filter_map(move |(index, keep)| keep_out_rule(index, keep, position));
        let forbidden = sums.chain(bounds).chain(boxes).map(Violation::Forbidden);
        length.map(Violation::Length).into_iter().chain(joints).chain(forbidden)
    }
}

impl<S: Float> fmt::Display for Violation<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(error) => error.fmt(f),
            Self::NotFinite { joint, name, value } => {
                write!(f, "joint {} ({name}) is {value}", joint + 1)
            }
            Self::OutsideLimits { joint, name, kind, value, min, max } => {
                let unit = kind.unit();
                write!(
                    f,
                    "joint {} ({name}) is at {value:.6} {unit}, not in {min:.6} to {max:.6} {unit}",
                    joint + 1
                )
            }
            Self::Forbidden(rule) => rule.fmt(f),
        }
    }
}

impl<S: Float> fmt::Display for Violations<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for violation in self.iter() {
            write!(f, "{separator}{violation}")?;
            separator = "; ";
        }
        Ok(())
    }
}

impl<S: Float> Error for Violations<'_, S> {}
