//! The `where` of a problem, judged with a margin: at the bound itself rounding decides.

use crate::model::{Filter, JointKind, Model};
use dh_core::Float;
use std::f64::consts::PI;

/// Nearer to a bound than this (rad or m) nothing is asked.
const MARGIN: f64 = 1e-6;

/// The inequalities of one problem.
pub(super) struct Wheres<'m> {
    model: &'m Model,
    filters: &'m [Filter],
}

impl<'m> Wheres<'m> {
    pub(super) fn of(model: &'m Model, problem: Option<usize>) -> Self {
        let problem = problem.and_then(|index| model.problems.get(index));
        Wheres { model, filters: problem.map_or(&[], |problem| &problem.filters) }
    }

    /// Whether joint variables satisfy all inequalities, and not just so.
    pub(super) fn clearly_keep(&self, q: &[f64]) -> bool {
        self.filters.iter().all(|filter| self.excess(filter, q).is_some_and(|excess| excess < -MARGIN))
    }

    /// Whether joint variables break an inequality, and not just so.
    pub(super) fn clearly_refuse(&self, q: &[f64]) -> bool {
        self.filters.iter().any(|filter| self.excess(filter, q).is_some_and(|excess| excess > MARGIN))
    }

    /// The left-hand side, every angle taken in (-pi, pi]; `None` where one is too near the seam.
    fn excess(&self, filter: &Filter, q: &[f64]) -> Option<f64> {
        let mut sum = filter.form.constant.value;
        for (row, factor) in &filter.form.terms {
            let row = self.model.rows.get(*row)?;
            let varies: f64 =
                row.terms.iter().map(|(joint, rate)| rate * q.get(*joint).copied().unwrap_or(0.0)).sum();
            sum += factor
                * match row.kind {
                    JointKind::Prismatic => row.d + varies,
                    JointKind::Revolute => clear_of_the_seam(row.theta.value + varies)?,
                };
        }
        for (joint, factor) in &filter.q {
            let row = self.model.joints.get(*joint).and_then(|row| self.model.rows.get(*row))?;
            let value = q.get(*joint).copied()?;
            sum += factor
                * match row.kind {
                    JointKind::Prismatic => value,
                    JointKind::Revolute => clear_of_the_seam(value)?,
                };
        }
        Some(sum)
    }
}

/// The angle in (-pi, pi], unless it is too near the seam.
fn clear_of_the_seam(angle: f64) -> Option<f64> {
    let angle = angle.wrap_angle();
    (PI - angle.abs() >= MARGIN).then_some(angle)
}
