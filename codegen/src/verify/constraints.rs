//! The constraints of an inverse problem as linear equations in the joint variables.

use crate::model::{JointKind, Linear, Model, Problem};
use std::f64::consts::TAU;

/// Coefficients and constants below this are rounding of the table's numbers.
const VANISHING: f64 = 1e-9;

/// A linear form in the joint variables: sum of `coefficients[k] * q[k]` + `constant`.
#[derive(Debug, Clone)]
struct Form {
    coefficients: Vec<f64>,
    constant: f64,
}

/// The joint vectors that a problem's constraints allow: the independent joints are free to choose, the others
/// follow from them.
#[derive(Debug, Clone)]
pub(super) struct Constraints {
    /// As the table has them, each to be 0 (mod `turn`).
    forms: Vec<(Form, f64)>,
    /// (dependent joint, its value as a form in the others).
    dependent: Vec<(usize, Form)>,
    /// Joints that no constraint decides.
    pub(super) independent: Vec<usize>,
}

impl Constraints {
    /// Those of a problem; none for the full pose.
    pub(super) fn of(model: &Model, problem: Option<&Problem>) -> Self {
        let (linear, given) =
            problem.map_or((&[][..], &[][..]), |problem| (&problem.constraints[..], &problem.free[..]));
        let forms: Vec<Form> = linear.iter().map(|constraint| in_joints(model, constraint)).collect();
        let dependent = eliminate(forms.clone(), model.joints.len(), given);
        let independent = (0..model.joints.len())
            .filter(|joint| dependent.iter().all(|(other, _)| other != joint))
            .collect();
        let forms = forms
            .into_iter()
            .map(|form| (turn_of(model, &form), form))
            .map(|(turn, form)| (form, turn))
            .collect();
        Constraints { forms, dependent, independent }
    }

    /// Sets the dependent joints to what the others ask for.
    pub(super) fn complete(&self, q: &mut [f64]) {
        for (joint, form) in &self.dependent {
            let value = form.at(q);
            if let Some(slot) = q.get_mut(*joint) {
                *slot = value;
            }
        }
    }

    /// By how much joint variables break the constraints (rad or m), whole turns aside.
    pub(super) fn excess(&self, q: &[f64]) -> f64 {
        let excess = |(form, turn): &(Form, f64)| {
            let value = form.at(q);
            if *turn > 0.0 { (value - turn * (value / turn).round()).abs() } else { value.abs() }
        };
        self.forms.iter().map(excess).fold(0.0, f64::max)
    }

    /// The direction in which all joints move with one independent joint.
    pub(super) fn direction(&self, joint: usize, dof: usize) -> Vec<f64> {
        let mut direction = vec![0.0; dof];
        if let Some(slot) = direction.get_mut(joint) {
            *slot = 1.0;
        }
        for (dependent, form) in &self.dependent {
            if let (Some(slot), Some(rate)) = (direction.get_mut(*dependent), form.coefficients.get(joint)) {
                *slot = *rate;
            }
        }
        direction
    }
}

impl Form {
    fn at(&self, q: &[f64]) -> f64 {
        self.constant + self.coefficients.iter().zip(q).map(|(coefficient, q)| coefficient * q).sum::<f64>()
    }
}

/// A constraint on theta and d of rows, in the joint variables: `form` = 0.
fn in_joints(model: &Model, constraint: &Linear) -> Form {
    let mut form = Form { coefficients: vec![0.0; model.joints.len()], constant: -constraint.constant.value };
    for (row, coefficient) in &constraint.terms {
        let Some(row) = model.rows.get(*row) else {
            continue;
        };
        form.constant += coefficient
            * match row.kind {
                JointKind::Revolute => row.theta.value,
                JointKind::Prismatic => row.d,
            };
        for (joint, factor) in &row.terms {
            if let Some(slot) = form.coefficients.get_mut(*joint) {
                *slot += coefficient * factor;
            }
        }
    }
    form
}

/// By how much the form changes at least when revolute joints make whole turns; 0 where they don't enter, or in
/// proportions without a common measure.
fn turn_of(model: &Model, form: &Form) -> f64 {
    let mut turn = 0.0;
    for (coefficient, row) in form.coefficients.iter().zip(&model.joints) {
        if model.rows.get(*row).is_some_and(|row| row.kind == JointKind::Revolute) {
            turn = common_measure(turn, coefficient.abs());
        }
    }
    // A measure much finer than the gears of real arms would let any value pass.
    if turn > 1e-2 { TAU * turn } else { 0.0 }
}

/// Euclid's algorithm on lengths.
fn common_measure(mut left: f64, mut right: f64) -> f64 {
    while right > VANISHING {
        (left, right) = (right, left - right * (left / right).round());
        right = right.abs();
    }
    left
}

/// Gauss-Jordan elimination: solves for one joint an equation, the one with the greatest coefficient (of equal ones
/// the last, so that wrists follow shoulders), never for one that is given by the caller.
fn eliminate(mut equations: Vec<Form>, joints: usize, given: &[usize]) -> Vec<(usize, Form)> {
    let mut solved: Vec<(usize, Form)> = Vec::new();
    while let Some(equation) = equations.pop() {
        let size = |joint: &usize| equation.coefficients.get(*joint).map_or(0.0, |c| c.abs());
        let pivot =
            (0..joints).filter(|joint| !given.contains(joint)).max_by(|l, r| size(l).total_cmp(&size(r)));
        let Some(pivot) = pivot.filter(|pivot| size(pivot) > VANISHING) else {
            continue;
        };
        let Some(divisor) = equation.coefficients.get(pivot).copied() else {
            continue;
        };
        // q[pivot] = value(others)
        let mut value = Form {
            coefficients: equation.coefficients.iter().map(|c| -c / divisor).collect(),
            constant: -equation.constant / divisor,
        };
        if let Some(own) = value.coefficients.get_mut(pivot) {
            *own = 0.0;
        }
        for form in equations.iter_mut().chain(solved.iter_mut().map(|(_, form)| form)) {
            substitute(form, pivot, &value);
        }
        solved.push((pivot, value));
    }
    solved
}

/// Puts a joint's value in its place.
fn substitute(form: &mut Form, joint: usize, value: &Form) {
    let Some(factor) = form.coefficients.get_mut(joint).map(std::mem::take) else {
        return;
    };
    form.constant += factor * value.constant;
    for (slot, coefficient) in form.coefficients.iter_mut().zip(&value.coefficients) {
        *slot += factor * coefficient;
    }
}
