//! Scalars of a plan as expressions of Rust.
//!
//! Signs move outwards (`a + -b` is `a - b`, `x * -y` is `-x * y`): rounding is symmetric, so the bits stay those of
//! the plan's tree. Nothing else is rearranged.

use super::ScalarType;
use super::layout::{Expression, Operator};
use super::number::number;
use super::paths::Paths;
use crate::plan::Scalar;

/// What the leaves of a function's scalars are called.
pub(super) struct Leaves<'a> {
    /// One name a value.
    pub(super) values: &'a [String],
    /// One name a constant.
    pub(super) constants: &'a [String],
    /// Type of numbers.
    pub(super) scalar: ScalarType,
    /// Names of foreign items.
    pub(super) paths: &'a Paths,
}

impl Leaves<'_> {
    /// The scalar as an expression.
    pub(super) fn expression(&self, scalar: &Scalar) -> Expression {
        match scalar {
            Scalar::Value(id) => named(self.values, id.0),
            Scalar::Constant(id) => named(self.constants, id.0),
            Scalar::Number(value) if value.is_sign_negative() && !value.is_nan() => {
                negative(self.expression(&Scalar::Number(-value)))
            }
            Scalar::Number(value) => Expression::Atom(number(*value, self.scalar, self.paths)),
            Scalar::Neg(x) => negative(self.expression(x)),
            Scalar::Add(x, y) => self.sum(Operator::Add, x, y),
            Scalar::Sub(x, y) => self.sum(Operator::Sub, x, y),
            Scalar::Mul(x, y) => self.product(Operator::Mul, x, y),
            Scalar::Div(x, y) => self.product(Operator::Div, x, y),
        }
    }

    fn sum(&self, operator: Operator, x: &Scalar, y: &Scalar) -> Expression {
        let right = self.expression(y);
        let (operator, right) = match positive(&right) {
            Some(right) if operator == Operator::Add => (Operator::Sub, right),
            Some(right) => (Operator::Add, right),
            None => (operator, right),
        };
        Expression::Binary(operator, Box::new(self.expression(x)), Box::new(right))
    }

    fn product(&self, operator: Operator, x: &Scalar, y: &Scalar) -> Expression {
        if operator == Operator::Mul && *x == Scalar::Number(-1.0) {
            return negative(self.expression(y));
        }
        let (left, right) = (self.expression(x), self.expression(y));
        match positive(&right) {
            Some(right) => Expression::Binary(operator, Box::new(negative(left)), Box::new(right)),
            None => Expression::Binary(operator, Box::new(left), Box::new(right)),
        }
    }
}

/// -x, with the sign on the first factor.
fn negative(x: Expression) -> Expression {
    match x {
        Expression::Neg(x) => *x,
        Expression::Binary(operator @ (Operator::Mul | Operator::Div), left, right) => {
            Expression::Binary(operator, Box::new(negative(*left)), right)
        }
        x => Expression::Neg(Box::new(x)),
    }
}

/// y where x = -y is how x would be printed.
fn positive(x: &Expression) -> Option<Expression> {
    match x {
        Expression::Neg(x) => Some((**x).clone()),
        Expression::Binary(operator @ (Operator::Mul | Operator::Div), left, right) => {
            Some(Expression::Binary(*operator, Box::new(positive(left)?), right.clone()))
        }
        _ => None,
    }
}

/// A plan names all its leaves; one that does not prints as a name that no compiler takes.
fn named(names: &[String], index: usize) -> Expression {
    Expression::Atom(names.get(index).cloned().unwrap_or_else(|| format!("unnamed_{index}")))
}
