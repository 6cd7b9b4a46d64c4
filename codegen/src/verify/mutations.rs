//! Every single mistake in a plan by hand is caught: each scalar in turn is made wrong.

use super::{Level, verify};
use crate::diagnostic::Diagnostics;
use crate::model::Model;
use crate::plan::fixtures::{PLANAR_2R, PLANAR_2R_CONSTANTS, SCARA, SCARA_CONSTANTS, plan, planar_2r, scara};
use crate::plan::{Equation, FunctionKind, Plan, Scalar, Step};

/// The scalars of steps and outputs, outermost first.
fn scalars<'p>(steps: &'p mut [Step], found: &mut Vec<&'p mut Scalar>) {
    for step in steps {
        match step {
            Step::Let { value, .. } => found.push(value),
            Step::SinCos { angle, .. } => found.push(angle),
            Step::General { given, body, .. } | Step::Descents { given, body, .. } => {
                found.extend(given);
                scalars(body, found);
            }
            Step::Near { body, otherwise, .. } => {
                scalars(body, found);
                scalars(otherwise, found);
            }
            Step::Accept { q, tool, .. } => {
                found.extend(q);
                found.extend(tool);
            }
            Step::Solve { equation, body, .. } => {
                match equation {
                    Equation::Trig { a, b, c } | Equation::Quadratic { a, b, c } => found.extend([a, b, c]),
                    Equation::TrigUnit { row, others } => found.extend(row.iter_mut().chain(others)),
                    Equation::TrigPair { first, second } | Equation::TrigEither { first, second } => {
                        found.extend(first.iter_mut().chain(second));
                    }
                    Equation::Linear { a, c } => found.extend([a, c]),
                    Equation::Quartic { forms, right, vector } => {
                        found.extend(forms.as_flattened_mut());
                        found.push(right);
                        if let Some(vector) = vector {
                            found.extend(
                                vector.others.as_flattened_mut().iter_mut().chain(&mut vector.length),
                            );
                        }
                    }
                }
                scalars(body, found);
            }
        }
    }
}

/// Makes node number `left` of a scalar wrong, counting down to it.
fn mutate(scalar: &mut Scalar, left: &mut usize) -> bool {
    let here = *left == 0;
    *left = left.wrapping_sub(1);
    if here {
        *scalar = match std::mem::replace(scalar, Scalar::Number(0.0)) {
            Scalar::Value(value) => Scalar::Neg(Box::new(Scalar::Value(value))),
            Scalar::Constant(constant) => {
                Scalar::Mul(Box::new(Scalar::Number(1.001)), Box::new(Scalar::Constant(constant)))
            }
            Scalar::Number(number) => Scalar::Number(number + 0.001),
            Scalar::Neg(inner) => *inner,
            Scalar::Add(one, two) => Scalar::Sub(one, two),
            Scalar::Sub(one, two) | Scalar::Mul(one, two) => Scalar::Add(one, two),
            Scalar::Div(one, two) => Scalar::Mul(one, two),
        };
        return true;
    }
    match scalar {
        Scalar::Value(_) | Scalar::Constant(_) | Scalar::Number(_) => false,
        Scalar::Neg(inner) => mutate(inner, left),
        Scalar::Add(one, two) | Scalar::Sub(one, two) | Scalar::Mul(one, two) | Scalar::Div(one, two) => {
            mutate(one, left) || mutate(two, left)
        }
    }
}

/// The plan with node number `node` of a function made wrong; `None` where it has fewer.
fn mutant(plan: &Plan, function: usize, node: usize) -> Option<Plan> {
    let mut plan = plan.clone();
    let mutated = &mut plan.functions[function];
    let mut found = Vec::new();
    scalars(&mut mutated.steps, &mut found);
    found.extend(&mut mutated.outputs);
    let mut left = node;
    found.into_iter().any(|scalar| mutate(scalar, &mut left)).then_some(plan)
}

fn every_mutant_is_caught(model: &Model, plan: &Plan, at_least: usize) {
    let mut mutants = 0;
    for (index, function) in plan.functions.iter().enumerate() {
        for node in 0.. {
            let Some(mutant) = mutant(plan, index, node) else { break };
            mutants += 1;
            let shown = format!("{:?}, node {node}", function.kind);
            let (left, report) = verify(model, mutant, Level::Quick, &mut Diagnostics::default());
            assert!(report.functions[index].failure.is_some(), "{shown} is not caught");
            // Nothing else suffers, except what relies on `fk`.
            let expected = if function.kind == FunctionKind::Fk {
                plan.functions
                    .iter()
                    .filter(|function| matches!(function.kind, FunctionKind::Inverse(_)))
                    .count()
            } else {
                0
            };
            assert_eq!(left.functions.len() + 1 + expected, plan.functions.len(), "{shown}");
        }
    }
    assert!(mutants >= at_least, "{mutants}");
}

#[test]
fn of_the_planar_arm() {
    every_mutant_is_caught(&planar_2r(), &plan(PLANAR_2R_CONSTANTS, PLANAR_2R), 200);
}

#[test]
fn of_the_scara() {
    every_mutant_is_caught(&scara(), &plan(SCARA_CONSTANTS, SCARA), 300);
}
