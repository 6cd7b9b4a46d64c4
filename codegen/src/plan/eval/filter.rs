//! The `where` of an inverse problem on a candidate.

use crate::model::{JointKind, Model, Problem};
use dh_core::{Condition, Float};

/// sum of coefficient * theta (or d, or q) + constant <= 0.
#[derive(Debug, Clone)]
pub(super) struct Filter<S> {
    terms: Vec<(Variable<S>, S)>,
    constant: S,
    strict: bool,
}

/// theta or d of a row, or a joint variable itself, as a form in the joint variables.
#[derive(Debug, Clone)]
struct Variable<S> {
    /// Whether it turns, and so is taken in (-pi, pi].
    angle: bool,
    zero: S,
    terms: Vec<(usize, S)>,
}

impl<S: Float> Filter<S> {
    /// Those of a problem.
    pub(super) fn all_of(model: &Model, problem: &Problem) -> Vec<Self> {
        let filter = |filter: &crate::model::Filter| Filter {
            terms: {
                let rows = filter.form.terms.iter();
                let rows = rows.filter_map(|(row, factor)| Some((Variable::of(model, *row)?, *factor)));
                let joints = filter.q.iter();
                let joints =
                    joints.filter_map(|(joint, factor)| Some((Variable::of_q(model, *joint)?, *factor)));
                rows.chain(joints).map(|(variable, factor)| (variable, S::from_f64(factor))).collect()
            },
            constant: S::from_f64(filter.form.constant.value),
            strict: filter.strict,
        };
        problem.filters.iter().map(filter).collect()
    }

    /// The inequality at joint variables (rad or m), every angle taken in (-pi, pi].
    pub(super) fn at(&self, q: &[S]) -> Condition<S> {
        let add = |sum, (variable, factor): &(Variable<S>, S)| sum + *factor * variable.at(q);
        let form = self.terms.iter().fold(self.constant, add);
        if self.strict { Condition::below_zero(form) } else { Condition::at_most_zero(form) }
    }
}

impl<S: Float> Variable<S> {
    fn of(model: &Model, row: usize) -> Option<Self> {
        let row = model.rows.get(row)?;
        let angle = row.kind == JointKind::Revolute;
        let zero = if angle { row.theta.value } else { row.d };
        let terms = row.terms.iter().map(|(joint, factor)| (*joint, S::from_f64(*factor))).collect();
        Some(Variable { angle, zero: S::from_f64(zero), terms })
    }

    fn of_q(model: &Model, joint: usize) -> Option<Self> {
        let row = model.rows.get(*model.joints.get(joint)?)?;
        let angle = row.kind == JointKind::Revolute;
        Some(Variable { angle, zero: S::ZERO, terms: vec![(joint, S::ONE)] })
    }

    fn at(&self, q: &[S]) -> S {
        let add =
            |sum, (joint, factor): &(usize, S)| sum + *factor * q.get(*joint).copied().unwrap_or(S::ZERO);
        let value = self.terms.iter().fold(self.zero, add);
        if self.angle { value.wrap_angle() } else { value }
    }
}
