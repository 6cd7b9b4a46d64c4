//! Angles as linear forms in the joint variables, so that a sum of parallel axes (theta2 + theta3 + theta4) is one
//! angle with one sine and one cosine, however it came about.

use super::number::Number;
use crate::model::Angle;
use std::f64::consts::FRAC_PI_2;

/// A constant turn: quarter turns apart, which are exact, and the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// In units of 15 degrees.
    pub fifteenths: i32,
    /// What is left (rad); 0 where the turn is exact.
    pub rest: f64,
}

impl Turn {
    /// No turn.
    pub const ZERO: Self = Self { fifteenths: 0, rest: 0.0 };

    /// From an angle of the table.
    pub fn new(angle: Angle) -> Self {
        match angle.fifteenths {
            Some(fifteenths) => Self { fifteenths, rest: 0.0 },
            None => Self { fifteenths: 0, rest: angle.value },
        }
    }

    /// Sine and cosine, where they are exact.
    pub fn exact(self) -> Option<(Number, Number)> {
        (self.rest == 0.0).then(|| (Number::sin(self.fifteenths), Number::cos(self.fifteenths)))
    }

    /// Radians.
    pub fn value(self) -> f64 {
        f64::from(self.fifteenths) * (FRAC_PI_2 / 6.0) + self.rest
    }
}

/// The sum, its exact part in [0, 24) units of 15 degrees.
impl std::ops::Add for Turn {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { fifteenths: (self.fifteenths + other.fifteenths).rem_euclid(24), rest: self.rest + other.rest }
    }
}

/// The other way round.
impl std::ops::Neg for Turn {
    type Output = Self;

    fn neg(self) -> Self {
        Self { fifteenths: (-self.fifteenths).rem_euclid(24), rest: -self.rest }
    }
}

/// A sum of multiples of joint variables and a constant turn.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleForm {
    /// (index of the variable, coefficient), by index, none zero.
    pub terms: Vec<(usize, f64)>,
    /// Constant part.
    pub turn: Turn,
}

impl AngleForm {
    /// The angle 0.
    pub const ZERO: Self = Self { terms: Vec::new(), turn: Turn::ZERO };

    /// self + sign * other
    pub fn plus(&self, other: &Self, sign: f64) -> Self {
        let mut terms = self.terms.clone();
        for &(variable, coefficient) in &other.terms {
            match terms.binary_search_by_key(&variable, |term| term.0) {
                Ok(at) => {
                    if let Some(term) = terms.get_mut(at) {
                        term.1 += sign * coefficient;
                    }
                }
                Err(at) => terms.insert(at, (variable, sign * coefficient)),
            }
        }
        terms.retain(|term| term.1 != 0.0);
        let turn = if sign < 0.0 { -other.turn } else { other.turn };
        Self { terms, turn: self.turn + turn }
    }

    /// The other way round.
    pub fn negated(&self) -> Self {
        Self::ZERO.plus(self, -1.0)
    }
}
