//! The unknowns of an inverse function in terms of the joint values that it finds.

use super::Form;
use crate::symbolic::inverse_kinematics::Linear;

/// Coefficients below this are what rounding leaves of 0.
const NOTHING: f64 = 1e-9;

/// A sum of joint values that is a sum of variables: both sides of an equation.
struct Equation {
    /// One coefficient a variable.
    variables: Vec<f64>,
    joints: Form,
}

/// Solves `q = form of the variables` for the variables behind the first `given`. Constraints make some joint values
/// depend on others: then those count that the fewest variables take part in.
pub(super) fn of(joints: &[Linear], given: usize, variables: usize) -> Vec<Option<Form>> {
    let mut open: Vec<Equation> =
        joints.iter().enumerate().map(|(q, form)| equation(q, form, variables)).collect();
    let mut triangle = Vec::new();
    // The equation with the fewest variables gives one of them, which goes from all others.
    while let Some((place, pivot)) = shortest(&open) {
        let own = open.swap_remove(place);
        let size = own.variables.get(pivot).copied().unwrap_or(1.0);
        for other in &mut open {
            let share = other.variables.get(pivot).copied().unwrap_or(0.0) / size;
            if share.abs() > NOTHING {
                other.variables.iter_mut().zip(&own.variables).for_each(|(to, from)| *to -= share * from);
                add(&mut other.joints, &own.joints, -share);
            }
        }
        triangle.push((own, pivot, size));
    }
    let mut found: Vec<Option<Form>> = vec![None; variables];
    for (own, pivot, size) in triangle.into_iter().rev() {
        let rest = own.variables.iter().enumerate().filter(|(index, x)| *index != pivot && x.abs() > NOTHING);
        let mut form = scaled(&own.joints, 1.0 / size);
        let mut known = true;
        for (index, x) in rest {
            match found.get(index) {
                Some(Some(other)) => add(&mut form, other, -x / size),
                _ => known = false,
            }
        }
        if let (Some(slot), true) = (found.get_mut(pivot), known) {
            *slot = Some(form);
        }
    }
    found.split_off(given.min(found.len()))
}

fn equation(q: usize, form: &Linear, variables: usize) -> Equation {
    let mut coefficients = vec![0.0; variables];
    for (variable, factor) in &form.terms {
        if let Some(slot) = coefficients.get_mut(*variable) {
            *slot += factor;
        }
    }
    Equation { variables: coefficients, joints: Form { terms: vec![(q, 1.0)], constant: -form.constant } }
}

/// The equation with the fewest variables, and one of them.
fn shortest(open: &[Equation]) -> Option<(usize, usize)> {
    let count = |equation: &Equation| equation.variables.iter().filter(|x| x.abs() > NOTHING).count();
    let places = open.iter().enumerate().filter(|(_, equation)| count(equation) > 0);
    let (place, equation) = places.min_by_key(|(_, equation)| count(equation))?;
    Some((place, equation.variables.iter().position(|x| x.abs() > NOTHING)?))
}

fn scaled(form: &Form, factor: f64) -> Form {
    let mut sum = Form::default();
    add(&mut sum, form, factor);
    sum
}

/// sum += factor * form
fn add(sum: &mut Form, form: &Form, factor: f64) {
    for (joint, coefficient) in &form.terms {
        match sum.terms.iter_mut().find(|(known, _)| known == joint) {
            Some((_, own)) => *own += factor * coefficient,
            None => sum.terms.push((*joint, factor * coefficient)),
        }
    }
    sum.terms.retain(|(_, coefficient)| coefficient.abs() > NOTHING);
    sum.terms.sort_by_key(|(joint, _)| *joint);
    sum.constant += factor * form.constant;
}
