//! What an expression comes to.

use std::collections::BTreeMap;

/// What an expression comes to: the sum of its parts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Value {
    /// A number without a dimension, or in the table's units where one is wanted.
    pub bare: Option<f64>,
    /// rad
    pub angle: Option<f64>,
    /// m
    pub length: Option<f64>,
    /// Variables with their coefficients.
    pub terms: BTreeMap<usize, f64>,
}

/// The parts of a value, for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Bare,
    Angle,
    Length,
}

impl Value {
    pub(super) fn of(number: f64) -> Value {
        Value { bare: Some(number), ..Value::default() }
    }

    pub(super) fn of_angle(radians: f64) -> Value {
        Value { angle: Some(radians), ..Value::default() }
    }

    pub(super) fn of_length(metres: f64) -> Value {
        Value { length: Some(metres), ..Value::default() }
    }

    /// The number, where there is nothing else.
    pub fn only_bare(&self) -> Option<f64> {
        match self.only_part() {
            Some((Part::Bare, number)) if self.terms.is_empty() => Some(number),
            _ => None,
        }
    }

    pub(super) fn only_part(&self) -> Option<(Part, f64)> {
        match (self.bare, self.angle, self.length) {
            (Some(number), None, None) => Some((Part::Bare, number)),
            (None, Some(angle), None) => Some((Part::Angle, angle)),
            (None, None, Some(length)) => Some((Part::Length, length)),
            _ => None,
        }
    }

    /// Adds `other` times `factor`.
    pub fn add(&mut self, other: &Value, factor: f64) {
        let add = |one: Option<f64>, two: Option<f64>| match (one, two) {
            (None, None) => None,
            _ => Some(one.unwrap_or(0.0) + factor * two.unwrap_or(0.0)),
        };
        self.bare = add(self.bare, other.bare);
        self.angle = add(self.angle, other.angle);
        self.length = add(self.length, other.length);
        for (variable, coefficient) in &other.terms {
            *self.terms.entry(*variable).or_insert(0.0) += factor * coefficient;
        }
    }

    pub(super) fn scale(&mut self, factor: f64) {
        self.each(|part| *part *= factor);
    }

    pub(super) fn divide(&mut self, divisor: f64) {
        self.each(|part| *part /= divisor);
    }

    fn each(&mut self, change: impl Fn(&mut f64)) {
        for part in [&mut self.bare, &mut self.angle, &mut self.length].into_iter().flatten() {
            change(part);
        }
        self.terms.values_mut().for_each(change);
    }
}
