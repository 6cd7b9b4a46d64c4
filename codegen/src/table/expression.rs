//! The expression language of tables: + - * / ( ), pi, functions, units, and (in constraints) variables.
//!
//! An expression is evaluated while it is read, into a [`Value`]: a sum of a bare number, an angle, a length and
//! multiples of variables. That sum is all that dimensions need, and all that a linear constraint can be.

use super::Text;
use super::lexer::{Lexer, Token, TokenKind};
use crate::diagnostic::{Diagnostic, catalogue};
use std::collections::BTreeMap;
use std::ops::Range;

mod functions;
mod refusals;
mod value;

pub(crate) use refusals::mixed_units;
pub use value::Value;

/// Parentheses and signs nested deeper than this are refused.
const DEEPEST: usize = 64;

/// Finds a variable by its name (and where that stands), or says what is wrong with it.
pub type Lookup<'a> = dyn Fn(&str, Range<usize>) -> Result<usize, Box<Diagnostic>> + 'a;

/// What an expression may mean.
pub struct Scope<'a> {
    /// rad: what a bare argument of a sine is in.
    pub radians_per_angle: f64,
    /// What names stand for.
    pub variable: &'a Lookup<'a>,
}

impl Scope<'_> {
    /// Numbers only.
    pub fn of_numbers(radians_per_angle: f64) -> Scope<'static> {
        Scope { radians_per_angle, variable: &refusals::no_variables }
    }
}

/// Evaluates an expression.
///
/// # Errors
/// A diagnostic, where the text is no expression or has no value.
pub fn evaluate(text: &Text, scope: &Scope) -> Result<Value, Box<Diagnostic>> {
    evaluate_part(text, 0..text.value.len(), scope)
}

/// Evaluates a part of a text (byte range), such as one side of an equation.
///
/// # Errors
/// A diagnostic, where the part is no expression or has no value.
pub fn evaluate_part(text: &Text, part: Range<usize>, scope: &Scope) -> Result<Value, Box<Diagnostic>> {
    let mut reader = Reader { lexer: Lexer::new(text, part.clone()), text, part, scope, depth: 0 };
    let mut value = reader.sum()?;
    let token = reader.lexer.next();
    let unit = if token.kind == TokenKind::Name { Unit::named(reader.lexer.of(&token)) } else { None };
    match unit {
        Some(unit) if reader.lexer.peek().kind == TokenKind::End => {
            reader.convert(&mut value, unit, &token)?;
        }
        _ if token.kind == TokenKind::End => {}
        _ => return Err(reader.no_operator_at(&token, "an operator or the end")),
    }
    let numbers = [value.bare, value.angle, value.length].into_iter().flatten();
    if numbers.chain(value.terms.values().copied()).all(f64::is_finite) {
        return Ok(value);
    }
    let refused = Diagnostic::error(catalogue::NOT_FINITE, "the expression is not a finite number");
    Err(Box::new(refused.at(text.span.clone(), "").help("write an expression for a finite number")))
}

/// Unit of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unit {
    Metre,
    Millimetre,
    Radian,
    Degree,
}

impl Unit {
    fn named(name: &str) -> Option<Unit> {
        Some(match name {
            "m" => Unit::Metre,
            "mm" => Unit::Millimetre,
            "rad" => Unit::Radian,
            "deg" => Unit::Degree,
            _ => return None,
        })
    }
}

struct Reader<'a> {
    lexer: Lexer<'a>,
    text: &'a Text,
    /// Which part of the text is read.
    part: Range<usize>,
    scope: &'a Scope<'a>,
    depth: usize,
}

type Outcome = Result<Value, Box<Diagnostic>>;

impl Reader<'_> {
    fn sum(&mut self) -> Outcome {
        let mut total = self.product()?;
        loop {
            let sign = match self.lexer.peek().kind {
                TokenKind::Plus => 1.0,
                TokenKind::Minus => -1.0,
                _ => return Ok(total),
            };
            self.lexer.next();
            let next = self.product()?;
            total.add(&next, sign);
        }
    }

    fn product(&mut self) -> Outcome {
        let mut total = self.signed()?;
        loop {
            let operator = self.lexer.peek();
            match operator.kind {
                TokenKind::Times => {
                    self.lexer.next();
                    let next = self.signed()?;
                    total = self.multiplied(&total, &next, &operator)?;
                }
                TokenKind::Over => {
                    self.lexer.next();
                    let next = self.signed()?;
                    total = self.divided(&total, &next, &operator)?;
                }
                _ => return Ok(total),
            }
        }
    }

    fn signed(&mut self) -> Outcome {
        let mut sign = 1.0;
        loop {
            match self.lexer.peek().kind {
                TokenKind::Minus => sign = -sign,
                TokenKind::Plus => {}
                _ => break,
            }
            self.lexer.next();
        }
        let mut value = self.primary()?;
        value.scale(sign);
        // A unit at the very end is that of the whole expression, one before that of what it follows.
        let token = self.lexer.peek();
        if token.kind == TokenKind::Name
            && let Some(unit) = Unit::named(self.lexer.of(&token))
        {
            let mut ahead = self.lexer.clone();
            ahead.next();
            if ahead.peek().kind != TokenKind::End {
                self.lexer.next();
                self.convert(&mut value, unit, &token)?;
            }
        }
        Ok(value)
    }

    fn primary(&mut self) -> Outcome {
        let token = self.lexer.next();
        match token.kind {
            TokenKind::Number => {
                let number = self.lexer.of(&token).parse::<f64>();
                match number {
                    Ok(number) if number.is_finite() => Ok(Value::of(number)),
                    Ok(_) => Err(self.refuse(
                        catalogue::NOT_FINITE,
                        "the number is too large",
                        &token.at,
                        "write a finite number",
                    )),
                    Err(_) => Err(self.no_value_at(&token)),
                }
            }
            TokenKind::Name => {
                let name = self.lexer.of(&token);
                if name == "pi" {
                    return Ok(Value::of_angle(core::f64::consts::PI));
                }
                if self.lexer.peek().kind == TokenKind::Open {
                    return self.call(name, &token);
                }
                if Unit::named(name).is_some() {
                    return Err(self.no_value_at(&token));
                }
                let variable = (self.scope.variable)(name, self.text.place(&token.at))?;
                Ok(Value { terms: BTreeMap::from([(variable, 1.0)]), ..Value::default() })
            }
            TokenKind::Open => {
                self.enter(&token)?;
                let value = self.sum()?;
                self.close()?;
                Ok(value)
            }
            _ => Err(self.no_value_at(&token)),
        }
    }

    fn enter(&mut self, token: &Token) -> Result<(), Box<Diagnostic>> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.refuse(
                catalogue::BAD_EXPRESSION,
                "parentheses are nested too deep",
                &token.at,
                "write fewer parentheses",
            ));
        }
        Ok(())
    }

    fn close(&mut self) -> Result<(), Box<Diagnostic>> {
        self.depth -= 1;
        let token = self.lexer.next();
        if token.kind == TokenKind::Close {
            Ok(())
        } else {
            Err(self.no_operator_at(&token, "an operator or `)`"))
        }
    }

    fn multiplied(&self, left: &Value, right: &Value, operator: &Token) -> Outcome {
        let (mut value, factor) = match (left.only_bare(), right.only_bare()) {
            (_, Some(factor)) => (left.clone(), factor),
            (Some(factor), None) => (right.clone(), factor),
            _ if left.terms.is_empty() && right.terms.is_empty() => {
                let message = "the product of two quantities with dimensions is no length and no angle";
                return Err(self.refuse(
                    catalogue::WRONG_UNIT,
                    message,
                    &operator.at,
                    "multiply by plain numbers",
                ));
            }
            _ => {
                return Err(self.not_linear(
                    "a joint is multiplied by something that is not a plain number",
                    &operator.at,
                ));
            }
        };
        value.scale(factor);
        Ok(value)
    }

    fn divided(&self, left: &Value, right: &Value, operator: &Token) -> Outcome {
        if !right.terms.is_empty() {
            return Err(self.not_linear("it divides by a joint", &operator.at));
        }
        if let Some(divisor) = right.only_bare() {
            if divisor == 0.0 {
                return Err(self.refuse(
                    catalogue::NO_VALUE,
                    "the expression divides by zero",
                    &operator.at,
                    "write a divisor that is not 0",
                ));
            }
            let mut value = left.clone();
            value.divide(divisor);
            return Ok(value);
        }
        if !left.terms.is_empty() {
            return Err(
                self.not_linear("a joint is divided by something that is not a plain number", &operator.at)
            );
        }
        let (above, below) = self.alike(left, right, operator)?;
        if below == 0.0 {
            return Err(self.refuse(
                catalogue::NO_VALUE,
                "the expression divides by zero",
                &operator.at,
                "write a divisor that is not 0",
            ));
        }
        Ok(Value::of(above / below))
    }

    /// Two quantities of one dimension.
    fn alike(&self, left: &Value, right: &Value, token: &Token) -> Result<(f64, f64), Box<Diagnostic>> {
        if !(left.terms.is_empty() && right.terms.is_empty()) {
            return Err(self.not_linear("a joint stands where only numbers may", &token.at));
        }
        match (left.only_part(), right.only_part()) {
            (Some((one, left)), Some((two, right))) if one == two => Ok((left, right)),
            _ => Err(self.refuse(
                catalogue::MIXED_UNITS,
                "the two quantities are not of one dimension",
                &token.at,
                "write both as plain numbers, or both with units",
            )),
        }
    }

    /// Gives the bare part a unit.
    fn convert(&self, value: &mut Value, unit: Unit, token: &Token) -> Result<(), Box<Diagnostic>> {
        let Some(bare) = value.bare.take() else {
            if unit == Unit::Radian && value.angle.is_some() {
                return Ok(());
            }
            let message = "there is no number that the unit could belong to";
            let help =
                "pi is half a turn whatever the units: leave the unit out, or write a number in place of pi";
            let refused = self.refuse(catalogue::WRONG_UNIT, message, &token.at, help);
            return Err(refused);
        };
        let converted = match unit {
            Unit::Metre => Value::of_length(bare),
            Unit::Millimetre => Value::of_length(bare / 1000.0),
            Unit::Radian => Value::of_angle(bare),
            Unit::Degree => Value::of_angle(crate::model::Angle::from_degrees(bare).value),
        };
        value.add(&converted, 1.0);
        Ok(())
    }
}
