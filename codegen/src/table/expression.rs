//! The expression language of tables: + - * / ( ), pi, functions, units, and (in constraints) variables.
//!
//! An expression is evaluated while it is read, into a [`Value`]: a sum of a bare number, an angle, a length and
//! multiples of variables. That sum is all that dimensions need, and all that a linear constraint can be.

use super::Text;
use super::lexer::{Lexer, Token, TokenKind};
use crate::diagnostic::{Diagnostic, catalogue, shortened};
use std::collections::BTreeMap;
use std::ops::Range;

/// Parentheses and signs nested deeper than this are refused.
const DEEPEST: usize = 64;

/// What an expression comes to: the sum of its parts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Value {
    /// A number without a dimension, or in the table's units where one is wanted.
    pub bare: Option<f64>,
    /// rad
    pub angle: Option<f64>,
    /// m
    pub length: Option<f64>,
    /// Variables with their coefficients.
    pub terms: BTreeMap<usize, f64>,
}

/// What an expression may mean.
pub struct Scope<'a> {
    /// rad: what a bare argument of a sine is in.
    pub radians_per_angle: f64,
    /// Finds a variable by its name, or says what is wrong with it.
    pub variable: &'a dyn Fn(&str, Range<usize>) -> Result<usize, Box<Diagnostic>>,
}

impl Scope<'_> {
    /// Numbers only.
    pub fn of_numbers(radians_per_angle: f64) -> Scope<'static> {
        Scope {
            radians_per_angle,
            variable: &no_variables,
        }
    }
}

fn no_variables(name: &str, span: Range<usize>) -> Result<usize, Box<Diagnostic>> {
    let known = [
        "pi", "sqrt", "sin", "cos", "tan", "acos", "asin", "atan", "atan2",
    ];
    let mut diagnostic = Diagnostic::error(
        catalogue::BAD_EXPRESSION,
        format!("`{}` means nothing in an expression", shortened(name)),
    )
    .at(span, "");
    diagnostic = match crate::diagnostic::nearest(name, known) {
        Some(near) => diagnostic.help(format!("write `{near}`")),
        None => diagnostic.help(
            "an expression has + - * / ( ), pi, sqrt sin cos tan acos asin atan atan2, and at its end a unit: m, mm, rad or deg",
        ),
    };
    Err(Box::new(diagnostic))
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
pub fn evaluate_part(
    text: &Text,
    part: Range<usize>,
    scope: &Scope,
) -> Result<Value, Box<Diagnostic>> {
    let mut reader = Reader {
        lexer: Lexer::new(text, part),
        text,
        scope,
        depth: 0,
    };
    let mut value = reader.sum()?;
    let token = reader.lexer.next();
    let unit = if token.kind == TokenKind::Name {
        Unit::named(reader.lexer.of(&token))
    } else {
        None
    };
    match unit {
        Some(unit) if reader.lexer.peek().kind == TokenKind::End => {
            reader.convert(&mut value, unit, &token)?;
        }
        _ if token.kind == TokenKind::End => {}
        _ => return Err(reader.unexpected(&token, "an operator (+ - * /) or the end")),
    }
    let numbers = [value.bare, value.angle, value.length]
        .into_iter()
        .flatten();
    if numbers
        .chain(value.terms.values().copied())
        .all(f64::is_finite)
    {
        return Ok(value);
    }
    Err(Box::new(
        Diagnostic::error(
            catalogue::NOT_FINITE,
            "the expression is not a finite number",
        )
        .at(text.span.clone(), ""),
    ))
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
                    )),
                    Err(_) => Err(self.unexpected(&token, "a number")),
                }
            }
            TokenKind::Name => {
                let name = self.lexer.of(&token);
                if name == "pi" {
                    return Ok(Value {
                        angle: Some(core::f64::consts::PI),
                        ..Value::default()
                    });
                }
                if self.lexer.peek().kind == TokenKind::Open {
                    return self.call(name, &token);
                }
                if Unit::named(name).is_some() {
                    return Err(self.unexpected(&token, "a number before its unit"));
                }
                let variable = (self.scope.variable)(name, self.text.place(&token.at))?;
                Ok(Value {
                    terms: BTreeMap::from([(variable, 1.0)]),
                    ..Value::default()
                })
            }
            TokenKind::Open => {
                self.enter(&token)?;
                let value = self.sum()?;
                self.close()?;
                Ok(value)
            }
            _ => Err(self.unexpected(&token, "a number, a name or `(`")),
        }
    }

    fn enter(&mut self, token: &Token) -> Result<(), Box<Diagnostic>> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.refuse(
                catalogue::BAD_EXPRESSION,
                "parentheses are nested too deep",
                &token.at,
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
            Err(self.unexpected(&token, "`)` or an operator"))
        }
    }

    fn call(&mut self, name: &str, token: &Token) -> Outcome {
        let known = ["sqrt", "sin", "cos", "tan", "acos", "asin", "atan", "atan2"];
        if !known.contains(&name) {
            let message = format!("`{}` is not a function", shortened(name));
            let mut diagnostic = self.refuse(catalogue::BAD_EXPRESSION, &message, &token.at);
            diagnostic
                .help
                .push(match crate::diagnostic::nearest(name, known) {
                    Some(near) => format!("write `{near}`"),
                    None => format!("the functions are {}", known.join(", ")),
                });
            return Err(diagnostic);
        }
        let open = self.lexer.next();
        self.enter(&open)?;
        let first = self.sum()?;
        if name == "atan2" {
            let comma = self.lexer.next();
            if comma.kind != TokenKind::Comma {
                return Err(
                    self.unexpected(&comma, "`,` and the second argument, as in `atan2(y, x)`")
                );
            }
            let second = self.sum()?;
            self.close()?;
            let (y, x) = self.alike(&first, &second, token)?;
            if x == 0.0 && y == 0.0 {
                return Err(self.refuse(
                    catalogue::NO_VALUE,
                    "atan2(0, 0) has no value",
                    &token.at,
                ));
            }
            return Ok(Value {
                angle: Some(libm::atan2(y, x)),
                ..Value::default()
            });
        }
        self.close()?;
        self.function(name, &first, token)
    }

    fn function(&self, name: &str, argument: &Value, token: &Token) -> Outcome {
        if !argument.terms.is_empty() {
            return Err(self.not_linear(&format!("a joint stands inside `{name}`"), &token.at));
        }
        if matches!(name, "sin" | "cos" | "tan") {
            return self.of_angle(name, argument, token);
        }
        let Some(x) = argument.only_bare() else {
            let message = format!("`{name}` takes a number without a unit");
            return Err(self.refuse(catalogue::WRONG_UNIT, &message, &token.at));
        };
        let outside = match name {
            "sqrt" => x < 0.0,
            "acos" | "asin" => x.abs() > 1.0,
            _ => false,
        };
        if outside {
            let range = if name == "sqrt" {
                "0 or more"
            } else {
                "-1 to 1"
            };
            let message = format!("`{name}` of {x} has no value: it takes {range}");
            return Err(self.refuse(catalogue::NO_VALUE, &message, &token.at));
        }
        Ok(match name {
            "sqrt" => Value::of(libm::sqrt(x)),
            "acos" => Value {
                angle: Some(libm::acos(x)),
                ..Value::default()
            },
            "asin" => Value {
                angle: Some(libm::asin(x)),
                ..Value::default()
            },
            _ => Value {
                angle: Some(libm::atan(x)),
                ..Value::default()
            },
        })
    }

    /// sin, cos, tan. A bare argument is in the table's unit of angle.
    fn of_angle(&self, name: &str, argument: &Value, token: &Token) -> Outcome {
        let angle = match (argument.bare, argument.angle, argument.length) {
            (Some(bare), None, None) => bare * self.scope.radians_per_angle,
            (None | Some(0.0), Some(angle), None) => angle,
            (_, _, None) => return Err(self.mixed(argument)),
            (_, _, Some(_)) => {
                let message = format!("`{name}` takes an angle, not a length");
                return Err(self.refuse(catalogue::WRONG_UNIT, &message, &token.at));
            }
        };
        let (sine, cosine) = crate::model::Angle::from_radians(angle).sin_cos();
        match name {
            "sin" => Ok(Value::of(sine)),
            "cos" => Ok(Value::of(cosine)),
            _ if cosine == 0.0 => Err(self.refuse(
                catalogue::NO_VALUE,
                "the tangent has no value there",
                &token.at,
            )),
            _ => Ok(Value::of(sine / cosine)),
        }
    }

    fn multiplied(&self, left: &Value, right: &Value, operator: &Token) -> Outcome {
        let (mut value, factor) = match (left.only_bare(), right.only_bare()) {
            (_, Some(factor)) => (left.clone(), factor),
            (Some(factor), None) => (right.clone(), factor),
            _ if left.terms.is_empty() && right.terms.is_empty() => {
                let message =
                    "the product of two quantities with dimensions is no length and no angle";
                return Err(self.refuse(catalogue::WRONG_UNIT, message, &operator.at));
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
                ));
            }
            let mut value = left.clone();
            value.divide(divisor);
            return Ok(value);
        }
        if !left.terms.is_empty() {
            return Err(self.not_linear(
                "a joint is divided by something that is not a plain number",
                &operator.at,
            ));
        }
        let (above, below) = self.alike(left, right, operator)?;
        if below == 0.0 {
            return Err(self.refuse(
                catalogue::NO_VALUE,
                "the expression divides by zero",
                &operator.at,
            ));
        }
        Ok(Value::of(above / below))
    }

    /// Two quantities of one dimension.
    fn alike(
        &self,
        left: &Value,
        right: &Value,
        token: &Token,
    ) -> Result<(f64, f64), Box<Diagnostic>> {
        if !(left.terms.is_empty() && right.terms.is_empty()) {
            return Err(self.not_linear("a joint stands where only numbers may", &token.at));
        }
        match (left.only_part(), right.only_part()) {
            (Some((one, left)), Some((two, right))) if one == two => Ok((left, right)),
            _ => Err(self.refuse(
                catalogue::MIXED_UNITS,
                "the two sides are not of one dimension",
                &token.at,
            )),
        }
    }

    /// Gives the bare part a unit.
    fn convert(&self, value: &mut Value, unit: Unit, token: &Token) -> Result<(), Box<Diagnostic>> {
        let Some(bare) = value.bare.take() else {
            if unit == Unit::Radian && value.angle.is_some() {
                return Ok(());
            }
            let mut refused = self.refuse(
                catalogue::WRONG_UNIT,
                "there is no number that the unit could belong to",
                &token.at,
            );
            if value.angle.is_some() {
                refused.help.push("pi is half a turn whatever the units: leave the unit out, or write the number for it".into());
            }
            return Err(refused);
        };
        let converted = match unit {
            Unit::Metre => Value {
                length: Some(bare),
                ..Value::default()
            },
            Unit::Millimetre => Value {
                length: Some(bare / 1000.0),
                ..Value::default()
            },
            Unit::Radian => Value {
                angle: Some(bare),
                ..Value::default()
            },
            Unit::Degree => Value {
                angle: Some(crate::model::Angle::from_degrees(bare).value),
                ..Value::default()
            },
        };
        value.add(&converted, 1.0);
        Ok(())
    }

    fn mixed(&self, _: &Value) -> Box<Diagnostic> {
        Box::new(mixed_units(self.text))
    }

    fn not_linear(&self, why: &str, at: &Range<usize>) -> Box<Diagnostic> {
        let mut diagnostic = self.refuse(
            catalogue::NOT_LINEAR,
            &format!("not linear in the joints: {why}"),
            at,
        );
        diagnostic.help.push("write a sum of joints times numbers, and a number, such as `theta4 = pi/2 - theta2 - theta3`".into());
        diagnostic
    }

    fn refuse(&self, code: &'static str, message: &str, at: &Range<usize>) -> Box<Diagnostic> {
        Box::new(Diagnostic::error(code, message).at(self.text.place(at), ""))
    }

    fn unexpected(&self, token: &Token, wanted: &str) -> Box<Diagnostic> {
        let found = match token.kind {
            TokenKind::End => "the expression ends".to_owned(),
            _ => format!("`{}` stands", shortened(self.lexer.of(token))),
        };
        let mut diagnostic = self.refuse(
            catalogue::BAD_EXPRESSION,
            &format!("{found} where {wanted} is wanted"),
            &token.at,
        );
        if token.kind == TokenKind::Power {
            diagnostic
                .help
                .push("there are no powers: write `x*x` or `sqrt(x)`".into());
        }
        Box::new(*diagnostic)
    }
}

/// An angle, or a length, and a bare number are added.
pub fn mixed_units(text: &Text) -> Diagnostic {
    Diagnostic::error(
        catalogue::MIXED_UNITS,
        "a number without a unit is added to one that has one: pi is half a turn whatever the table's units, a bare number is in them",
    )
    .at(text.span.clone(), "")
    .help("give the number its unit at the end, as in \"pi/2 + 90 deg\"")
}

/// The parts of a value, for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Bare,
    Angle,
    Length,
}

impl Value {
    fn of(number: f64) -> Value {
        Value {
            bare: Some(number),
            ..Value::default()
        }
    }

    /// The number, where there is nothing else.
    pub fn only_bare(&self) -> Option<f64> {
        match self.only_part() {
            Some((Part::Bare, number)) if self.terms.is_empty() => Some(number),
            _ => None,
        }
    }

    fn only_part(&self) -> Option<(Part, f64)> {
        match (self.bare, self.angle, self.length) {
            (Some(number), None, None) => Some((Part::Bare, number)),
            (None, Some(angle), None) => Some((Part::Angle, angle)),
            (None, None, Some(length)) => Some((Part::Length, length)),
            _ => None,
        }
    }

    /// Adds `other` times `factor`.
    pub fn add(&mut self, other: &Value, factor: f64) {
        let add = |one: Option<f64>, two: Option<f64>| match (one, two) {
            (None, None) => None,
            _ => Some(one.unwrap_or(0.0) + factor * two.unwrap_or(0.0)),
        };
        self.bare = add(self.bare, other.bare);
        self.angle = add(self.angle, other.angle);
        self.length = add(self.length, other.length);
        for (variable, coefficient) in &other.terms {
            *self.terms.entry(*variable).or_insert(0.0) += factor * coefficient;
        }
    }

    fn scale(&mut self, factor: f64) {
        self.each(|part| *part *= factor);
    }

    fn divide(&mut self, divisor: f64) {
        self.each(|part| *part /= divisor);
    }

    fn each(&mut self, change: impl Fn(&mut f64)) {
        for part in [&mut self.bare, &mut self.angle, &mut self.length]
            .into_iter()
            .flatten()
        {
            change(part);
        }
        self.terms.values_mut().for_each(change);
    }
}
