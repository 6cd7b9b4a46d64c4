//! Values in all kinds of variables -> linear forms in the thetas and ds of rows.

use super::constraint::Joints;
use super::{Angle, JointKind, Linear, Row, topology};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue};
use crate::table::Text;
use crate::table::expression::{Value, mixed_units};
use std::collections::BTreeMap;

/// A sum of terms and a constant, all on one side.
pub(super) struct Form {
    /// In thetas and ds of rows, as the model keeps it.
    pub(super) linear: Linear,
    /// The same in q: coefficients, and the constant.
    pub(super) in_q: (Vec<f64>, f64),
    /// As it is written: thetas and ds of rows in one form, coefficients of q beside it.
    pub(super) written: (Linear, Vec<(usize, f64)>),
    /// Whether it speaks of angles, rather than lengths.
    pub(super) of_angles: bool,
}

impl Form {
    /// The form of a value. Its variables are numbered: first theta (or d) of every row, then every q.
    pub(super) fn of(
        text: &Text,
        value: &Value,
        joints: &Joints,
        diagnostics: &mut Diagnostics,
    ) -> Option<Form> {
        let kind = kind(text, value, joints, diagnostics)?;
        let constant = constant(text, value, kind, joints, diagnostics)?;
        let mut sum = Sum {
            kind,
            in_q: (vec![0.0; joints.moving.len()], constant.value),
            terms: BTreeMap::new(),
            constant,
        };
        let mut rows_alone = Sum { in_q: sum.in_q.clone(), terms: BTreeMap::new(), ..sum };
        let mut q_terms = Vec::new();
        for (&variable, &coefficient) in &value.terms {
            if let Some(q) = variable.checked_sub(joints.rows.len()) {
                sum.add_q(q, coefficient, joints)?;
                q_terms.push((q, coefficient));
            } else {
                let row = joints.rows.get(variable)?;
                sum.add_row(variable, coefficient, row);
                rows_alone.add_row(variable, coefficient, row);
            }
        }
        let largest = value.terms.values().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        sum.terms.retain(|_, coefficient| coefficient.abs() > CANCELLED * largest);
        let linear = |terms: BTreeMap<usize, f64>, constant: Angle| Linear {
            terms: terms.into_iter().collect(),
            constant,
            text: text.value.clone(),
            span: text.span.clone(),
        };
        Some(Form {
            linear: linear(sum.terms, sum.constant),
            in_q: sum.in_q,
            written: (linear(rows_alone.terms, rows_alone.constant), q_terms),
            of_angles: kind == JointKind::Revolute,
        })
    }
}

/// Coefficients smaller than this part of the largest one have cancelled.
const CANCELLED: f64 = 1e-12;

/// Whether all variables are angles, or all of them lengths.
fn kind(text: &Text, value: &Value, joints: &Joints, diagnostics: &mut Diagnostics) -> Option<JointKind> {
    let rows = joints.rows;
    let row_of = |variable: usize| match variable.checked_sub(rows.len()) {
        None => rows.get(variable),
        Some(q) => rows.get(*joints.moving.get(q)?),
    };
    let mut kinds = value.terms.keys().filter_map(|variable| row_of(*variable)).map(|row| row.kind);
    let first = kinds.next();
    let alike = first.is_none_or(|first| kinds.all(|kind| kind == first));
    let kind = match first {
        Some(kind) => kind,
        None if value.length.is_some() => JointKind::Prismatic,
        None => JointKind::Revolute,
    };
    let other = if kind == JointKind::Prismatic { value.angle } else { value.length };
    if alike && other.is_none_or(|other| other == 0.0) {
        return Some(kind);
    }
    diagnostics.push(
        Diagnostic::error(catalogue::WRONG_UNIT, "an angle and a length are added")
            .at(text.span.clone(), "")
            .help("theta and q of revolute joints are angles, d and q of prismatic ones lengths"),
    );
    None
}

/// The number in it. Beside variables a bare one is in the table's units.
fn constant(
    text: &Text,
    value: &Value,
    kind: JointKind,
    joints: &Joints,
    diagnostics: &mut Diagnostics,
) -> Option<Angle> {
    let written = if kind == JointKind::Prismatic { value.length } else { value.angle };
    let Some(bare) = value.bare.filter(|bare| *bare != 0.0) else {
        return Some(number(kind, written.unwrap_or(0.0)));
    };
    if written.is_some_and(|written| written != 0.0) {
        diagnostics.push(mixed_units(text));
        return None;
    }
    Some(match kind {
        JointKind::Revolute => joints.units.angle_of(bare),
        JointKind::Prismatic => number(kind, joints.units.length_of(bare)),
    })
}

/// A number in SI; only angles are multiples of 15 degrees.
fn number(kind: JointKind, value: f64) -> Angle {
    match kind {
        JointKind::Revolute => Angle::from_radians(value),
        JointKind::Prismatic => Angle { value, fifteenths: (value == 0.0).then_some(0) },
    }
}

/// A sum that is being put together.
struct Sum {
    kind: JointKind,
    in_q: (Vec<f64>, f64),
    terms: BTreeMap<usize, f64>,
    constant: Angle,
}

impl Sum {
    /// q = inverse * (theta - theta at zero)
    fn add_q(&mut self, q: usize, coefficient: f64, joints: &Joints) -> Option<()> {
        if let Some(entry) = self.in_q.0.get_mut(q) {
            *entry += coefficient;
        }
        for (&inverse, &index) in joints.inverse.get(q)?.iter().zip(joints.moving) {
            if inverse != 0.0 {
                *self.terms.entry(index).or_insert(0.0) += coefficient * inverse;
                self.add_at_zero(joints.rows.get(index)?, -coefficient * inverse);
            }
        }
        Some(())
    }

    fn add_row(&mut self, index: usize, coefficient: f64, row: &Row) {
        let size = self.in_q.0.len();
        for (entry, moves) in self.in_q.0.iter_mut().zip(topology::coefficients(row, size)) {
            *entry += coefficient * moves;
        }
        self.in_q.1 += coefficient * at_zero(row).value;
        if row.terms.is_empty() {
            self.add_at_zero(row, coefficient);
        } else {
            *self.terms.entry(index).or_insert(0.0) += coefficient;
        }
    }

    /// What the theta (or d) of a row is where all joints are at zero.
    fn add_at_zero(&mut self, row: &Row, factor: f64) {
        let part = at_zero(row);
        self.constant = match self.kind {
            JointKind::Revolute => self.constant.plus(part.times(factor)),
            JointKind::Prismatic => number(self.kind, self.constant.value + part.value * factor),
        };
    }
}

fn at_zero(row: &Row) -> Angle {
    match row.kind {
        JointKind::Revolute => row.theta,
        JointKind::Prismatic => number(row.kind, row.d),
    }
}
