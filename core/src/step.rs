//! What one step of an inverse solution finds; errors name it.

use core::fmt;

use crate::Float;

/// One solving step of an inverse problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Step {
    /// Its place among the steps, from 0; deeper steps have greater ones.
    pub index: u8,
    /// Bit i is set where theta (or d) of row i is part of the unknown.
    pub rows: u32,
    /// Whether the unknown is a length (d) rather than an angle (theta).
    pub prismatic: bool,
    /// The dimension of the equation, that is, of each of its terms.
    pub measure: Measure,
    /// Whether the sign of its root is a part of a solution's [`Branch`](crate::Branch).
    pub signed: bool,
    /// Whether its rows are unknowns of their own, found at once, and not one that is their sum.
    pub at_once: bool,
}

/// Dimension of an equation: of its right-hand side and of each of its terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Measure {
    /// Dimensionless (or radians).
    Ratio,
    /// m
    Length,
    /// m²
    Area,
    /// A higher power of the metre.
    Power(u8),
}

impl Measure {
    /// The size of the numbers that such an equation of an arm of this reach (m) is made of.
    pub(crate) fn scale<S: Float>(self, reach: S) -> S {
        match self {
            Self::Ratio => S::ONE,
            Self::Length => reach,
            Self::Area => reach * reach,
            Self::Power(power) => (0..power).fold(S::ONE, |scale, _| scale * reach),
        }
    }
}

impl Step {
    /// A step whose root, of two, has a sign.
    pub const fn new(index: u8, rows: u32, prismatic: bool, measure: Measure) -> Self {
        Self { index, rows, prismatic, measure, signed: true, at_once: false }
    }

    /// The same; its rows are unknowns of their own.
    #[must_use]
    pub const fn at_once(self) -> Self {
        Self { at_once: true, ..self }
    }

    /// The same; which of two roots it takes says nothing of the solution.
    #[must_use]
    pub const fn unsigned(self) -> Self {
        Self { signed: false, ..self }
    }

    /// The first row (0-based) whose theta or d is part of the unknown.
    pub const fn first_row(&self) -> usize {
        if self.rows == 0 { 0 } else { self.rows.trailing_zeros() as usize }
    }

    /// How far from 0 its unknown goes, at most: half a turn, or the reach (m).
    pub(crate) fn half_range<S: Float>(self, reach: S) -> S {
        if self.prismatic { reach } else { S::PI }
    }

    /// What its unknown is measured in beside others: 1 (rad), or the reach (m).
    pub(crate) fn unit<S: Float>(self, reach: S) -> S {
        if self.prismatic { reach } else { S::ONE }
    }

    /// Whether the excess of [`IkError::Unreachable`](crate::IkError::Unreachable) is in metres rather than a ratio.
    pub const fn excess_is_length(&self) -> bool {
        self.prismatic || matches!(self.measure, Measure::Length)
    }
}

/// `step 2 (theta2 + theta3)`, counted from 1.
impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step {} (", u32::from(self.index) + 1)?;
        let at_once = self.at_once && self.rows.count_ones() > 1;
        let (symbol, between) = match (at_once, self.prismatic) {
            (true, _) => ("", ", "),
            (false, true) => ("d", " + "),
            (false, false) => ("theta", " + "),
        };
        f.write_str(if at_once { "joints " } else { "" })?;
        let mut separator = "";
        for row in (0..u32::BITS).filter(|row| self.rows & (1 << row) != 0) {
            write!(f, "{separator}{symbol}{}", row + 1)?;
            separator = between;
        }
        f.write_str(")")
    }
}
