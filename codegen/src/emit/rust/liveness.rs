//! Which steps and constants of a function its results need: the others are not printed.

use crate::plan::{ConstantId, Equation, Function, Scalar, Step, ValueId};

/// What a function's results are made from.
#[derive(Debug)]
pub(super) struct Live {
    values: Vec<bool>,
    constants: Vec<bool>,
}

impl Live {
    /// Of `function`, in a plan with `constants` named numbers.
    pub(super) fn of(function: &Function, constants: usize) -> Self {
        let mut live = Self { values: vec![false; function.values.len()], constants: vec![false; constants] };
        for output in &function.outputs {
            live.mark(output);
        }
        live.mark_steps(&function.steps);
        live
    }

    /// Whether anything that is printed reads the value.
    pub(super) fn value(&self, id: ValueId) -> bool {
        self.values.get(id.0).copied().unwrap_or(false)
    }

    /// Whether anything that is printed reads the constant.
    pub(super) fn constant(&self, id: ConstantId) -> bool {
        self.constants.get(id.0).copied().unwrap_or(false)
    }

    /// Backwards, so that every reader of a value has been seen before its definition.
    fn mark_steps(&mut self, steps: &[Step]) {
        for step in steps.iter().rev() {
            match step {
                Step::Let { name, value } => {
                    if self.value(*name) {
                        self.mark(value);
                    }
                }
                Step::SinCos { sin, cos, angle } => {
                    if self.value(*sin) || self.value(*cos) {
                        self.mark(angle);
                    }
                }
                Step::Solve { equation, body, .. } => {
                    self.mark_steps(body);
                    for scalar in coefficients(equation) {
                        self.mark(scalar);
                    }
                }
                Step::General { given, body, .. } | Step::Descents { given, body, .. } => {
                    self.mark_steps(body);
                    for scalar in given {
                        self.mark(scalar);
                    }
                }
                Step::Near { body, otherwise, .. } => {
                    self.mark_steps(otherwise);
                    self.mark_steps(body);
                }
                Step::Accept { q, tool, .. } => q.iter().chain(tool).for_each(|scalar| self.mark(scalar)),
            }
        }
    }

    fn mark(&mut self, scalar: &Scalar) {
        match scalar {
            Scalar::Value(id) => {
                if let Some(live) = self.values.get_mut(id.0) {
                    *live = true;
                }
            }
            Scalar::Constant(id) => {
                if let Some(live) = self.constants.get_mut(id.0) {
                    *live = true;
                }
            }
            Scalar::Number(_) => {}
            Scalar::Neg(x) => self.mark(x),
            Scalar::Add(x, y) | Scalar::Sub(x, y) | Scalar::Mul(x, y) | Scalar::Div(x, y) => {
                self.mark(x);
                self.mark(y);
            }
        }
    }
}

/// The coefficients of an equation, in the order of the solver's arguments.
pub(super) fn coefficients(equation: &Equation) -> Vec<&Scalar> {
    match equation {
        Equation::Trig { a, b, c } | Equation::Quadratic { a, b, c } => vec![a, b, c],
        Equation::TrigUnit { row, others } => row.iter().chain(others).collect(),
        Equation::TrigPair { first, second } | Equation::TrigEither { first, second } => {
            first.iter().chain(second).collect()
        }
        Equation::Linear { a, c } => vec![a, c],
        Equation::Quartic { forms, right, vector } => {
            let vector = vector.iter().flat_map(|vector| vector.coefficients());
            forms.as_flattened().iter().chain([right]).chain(vector).collect()
        }
    }
}
