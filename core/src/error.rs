//! Why there is no solution.

use core::error::Error;
use core::fmt;

use crate::{Float, Rule, Step, TargetKind};

/// Why an inverse problem has no solution. The first step that fails on the branch that came furthest decides.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum IkError<S = f64> {
    /// The coefficients of a step vanish: no value of the joint brings the tool there.
    Singular {
        /// The row of the joint, 0-based (messages count from 1).
        joint: usize,
        /// What the joint would have to make up for and cannot, in the unit of its equation (m, m², or a ratio).
        gap: S,
    },
    /// The argument of a step leaves its domain: the target is too far away, or too near.
    Unreachable {
        /// Which step.
        step: Step,
        /// By how much: metres where [`Step::excess_is_length`], else a ratio.
        excess: S,
    },
    /// There are solutions, but none inside the joint limits; this is the nearest to being allowed.
    OutsideLimits {
        /// Index of the joint in q, 0-based (messages count from 1).
        joint: usize,
        /// The value that the joint would need (rad or m).
        value: S,
        /// Its least value (rad or m).
        min: S,
        /// Its greatest value (rad or m).
        max: S,
    },
    /// There are solutions inside the joint limits, but all break a rule.
    Forbidden {
        /// The rule that the one nearest to being allowed breaks.
        rule: Rule<S>,
    },
    /// A number of the target is infinite or NaN, or so great that what is computed of it is.
    NotFinite,
    /// The target's rotation is not one, or its direction has no length.
    NotRigid {
        /// The greatest entry of |`RᵀR` - 1| and |det R - 1|; 1 for a direction of length 0.
        error: S,
    },
    /// Every candidate missed the target: what the solved rows ask for contradicts the rest.
    Failed {
        /// Position error of the best candidate (m).
        position_error: S,
        /// Its rotation error (rad).
        rotation_error: S,
    },
    /// The robot has no inverse problem of this name.
    UnknownProblem,
    /// The problem takes another kind of target.
    WrongTarget {
        /// The kind that it takes.
        expected: TargetKind,
    },
    /// A slice of joint values has the wrong length.
    Length(LengthError),
}

/// Below this, two decimals say nothing.
const SMALL_PERCENT: f64 = 0.05;

/// Below this, it is rounding.
const NO_PERCENT: f64 = 1e-11;

impl<S: Float> fmt::Display for IkError<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Singular { joint, gap } => {
                write!(f, "singular: joint {} cannot make up for the {gap:.3e} that is missing", joint + 1)
            }
            Self::Unreachable { step, excess } if step.excess_is_length() => {
                write!(f, "out of reach: {step} lacks {excess:.6} m")
            }
            Self::Unreachable { step, excess } => {
                let percent = excess.to_f64() * 100.0;
                if percent <= NO_PERCENT {
                    write!(f, "out of reach: {step} is at the edge of its domain, and leads to no solution")
                } else if percent < SMALL_PERCENT {
                    write!(f, "out of reach: {step} exceeds its domain by {percent:.1e} %")
                } else {
                    write!(f, "out of reach: {step} exceeds its domain by {percent:.2} %")
                }
            }
            Self::OutsideLimits { joint, value, min, max } => {
                write!(
                    f,
                    "outside the limits: joint {} would be at {value:.6}, not in {min:.6} to {max:.6} (rad or m)",
                    joint + 1
                )
            }
            Self::Forbidden { rule } => write!(f, "forbidden: {rule}"),
            Self::NotFinite => {
                f.write_str("the target has a number that is infinite or NaN, or so great that its square is")
            }
            Self::NotRigid { error } => {
                write!(f, "the target's rotation or direction is not one: off by {error:.3e}")
            }
            Self::Failed { position_error, rotation_error } => write!(
                f,
                "no candidate reaches the target: the best misses it by {position_error:.3e} m and {rotation_error:.3e} rad"
            ),
            Self::UnknownProblem => f.write_str("the robot has no inverse problem of this name"),
            Self::WrongTarget { expected } => {
                write!(f, "the problem takes a target of kind {expected}")
            }
            Self::Length(error) => error.fmt(f),
        }
    }
}

impl<S: Float> Error for IkError<S> {}

impl<S> From<LengthError> for IkError<S> {
    fn from(error: LengthError) -> Self {
        Self::Length(error)
    }
}

/// A slice has the wrong length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LengthError {
    /// How many there must be (at least, for outputs).
    pub expected: usize,
    /// How many there are.
    pub got: usize,
}

impl LengthError {
    /// An error unless `got` is `expected`.
    ///
    /// # Errors
    /// The two numbers.
    pub const fn check(expected: usize, got: usize) -> Result<(), Self> {
        if expected == got { Ok(()) } else { Err(Self { expected, got }) }
    }
}

impl fmt::Display for LengthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} values where {} are needed", self.got, self.expected)
    }
}

impl Error for LengthError {}
