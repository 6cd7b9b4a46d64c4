//! The constraints of a problem as equations between joint values.

use crate::model::{JointKind, Linear, Model, Problem};
use dh_core::ConstraintTerm;

/// The terms of every equation.
pub(super) fn of(model: &Model, problem: Option<usize>) -> Vec<ConstraintTerm> {
    let problem = problem.and_then(|index| model.problems.get(index));
    let constraints = problem.map_or(&[][..], |problem: &Problem| &problem.constraints[..]);
    constraints
        .iter()
        .enumerate()
        .flat_map(|(equation, constraint)| terms(model, equation, constraint))
        .collect()
}

/// Sum of coefficient * variable - constant, where the variables of rows are forms in the joint values.
fn terms(model: &Model, equation: usize, constraint: &Linear) -> Vec<ConstraintTerm> {
    let mut constant = -constraint.constant.value;
    let mut factors = vec![0.0; model.joints.len()];
    for (row, factor) in &constraint.terms {
        let Some(row) = model.rows.get(*row) else { continue };
        constant += factor * if row.kind == JointKind::Revolute { row.theta.value } else { row.d };
        for (joint, own) in &row.terms {
            if let Some(sum) = factors.get_mut(*joint) {
                *sum += factor * own;
            }
        }
    }
    let joints = factors.into_iter().enumerate().map(|(joint, coefficient)| (Some(joint), coefficient));
    let all = joints.chain([(None, constant)]).filter(|(_, coefficient)| *coefficient != 0.0);
    all.map(|(joint, coefficient)| ConstraintTerm { equation, joint, coefficient }).collect()
}
