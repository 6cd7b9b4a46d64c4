//! Numbers of a table: plain ones, and strings that hold an expression and may end in a unit.
//!
//! Every value is carried as (what is in table units) + (what is absolute: `pi`, a unit). Which of the two a bare
//! number is becomes clear at the end: `"2 * 45"` is in table units, `"pi/2"` in half turns. The oracle reads correct
//! tables only, so that mixing the two is simply an error.

use crate::double_double::DoubleDouble;

/// What a number measures; decides its units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Radians or degrees.
    Angle,
    /// Metres or millimetres.
    Length,
    /// No unit.
    Ratio,
}

/// SI values of one table unit.
#[derive(Debug, Clone, Copy)]
pub struct Units {
    /// Metres.
    pub length: DoubleDouble,
    /// Radians.
    pub angle: DoubleDouble,
}

impl Units {
    /// One table unit of `quantity` in SI.
    pub fn of(&self, quantity: Quantity) -> DoubleDouble {
        match quantity {
            Quantity::Angle => self.angle,
            Quantity::Length => self.length,
            Quantity::Ratio => DoubleDouble::ONE,
        }
    }
}

/// A literal. TOML's numbers are those of f64, in an expression too: the decimal 0.1 is the f64 nearest to it.
pub fn literal(text: &str) -> Option<DoubleDouble> {
    text.replace('_', "").parse::<f64>().ok().map(DoubleDouble::from)
}

/// One degree in radians.
pub fn degree() -> DoubleDouble {
    DoubleDouble::PI / DoubleDouble::from(180.0)
}

/// A value on the way: a bare number, or an angle in radians.
#[derive(Clone, Copy)]
enum Value {
    Bare(DoubleDouble),
    Radians(DoubleDouble),
}

/// The SI value of an expression.
///
/// # Errors
/// What is wrong with `text`.
pub fn evaluate(text: &str, quantity: Quantity, units: &Units) -> Result<DoubleDouble, String> {
    let degree = degree();
    let thousandth = DoubleDouble::ONE / DoubleDouble::from(1000.0);
    let suffixes = [
        ("mm", Quantity::Length, thousandth),
        ("m", Quantity::Length, DoubleDouble::ONE),
        ("deg", Quantity::Angle, degree),
        ("rad", Quantity::Angle, DoubleDouble::ONE),
    ];
    let trimmed = text.trim();
    for (suffix, kind, unit) in suffixes {
        let Some(body) = trimmed.strip_suffix(suffix) else { continue };
        if kind != quantity {
            return Err(format!("unit of the wrong kind in `{text}`"));
        }
        return match parse(body)? {
            Value::Bare(value) => Ok(value * unit),
            Value::Radians(_) => Err(format!("`{text}` has pi and a unit")),
        };
    }
    match parse(trimmed)? {
        Value::Bare(value) => Ok(value * units.of(quantity)),
        Value::Radians(value) if quantity == Quantity::Angle => Ok(value),
        Value::Radians(_) => Err(format!("`{text}` is an angle")),
    }
}

fn parse(text: &str) -> Result<Value, String> {
    let mut parser = Parser { rest: text };
    let value = parser.sum()?;
    if parser.rest.trim().is_empty() { Ok(value) } else { Err(format!("`{}` is left over", parser.rest)) }
}

struct Parser<'a> {
    rest: &'a str,
}

impl Parser<'_> {
    fn take(&mut self, token: char) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(token) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn sum(&mut self) -> Result<Value, String> {
        let mut left = self.product()?;
        loop {
            let sign = if self.take('+') {
                DoubleDouble::ONE
            } else if self.take('-') {
                -DoubleDouble::ONE
            } else {
                return Ok(left);
            };
            left = match (left, self.product()?) {
                (Value::Bare(a), Value::Bare(b)) => Value::Bare(a + sign * b),
                (Value::Radians(a), Value::Radians(b)) => Value::Radians(a + sign * b),
                _ => return Err("a sum of an angle and a bare number".to_owned()),
            };
        }
    }

    fn product(&mut self) -> Result<Value, String> {
        let mut left = self.factor()?;
        loop {
            let divide = if self.take('*') {
                false
            } else if self.take('/') {
                true
            } else {
                return Ok(left);
            };
            let right = self.factor()?;
            left = match (left, right, divide) {
                (Value::Bare(a), Value::Bare(b), false) => Value::Bare(a * b),
                (Value::Radians(a), Value::Bare(b), false) | (Value::Bare(a), Value::Radians(b), false) => {
                    Value::Radians(a * b)
                }
                (Value::Bare(a), Value::Bare(b), true) | (Value::Radians(a), Value::Radians(b), true) => {
                    Value::Bare(a / b)
                }
                (Value::Radians(a), Value::Bare(b), true) => Value::Radians(a / b),
                _ => return Err("a product that is neither an angle nor a bare number".to_owned()),
            };
        }
    }

    fn factor(&mut self) -> Result<Value, String> {
        if self.take('-') {
            return Ok(match self.factor()? {
                Value::Bare(value) => Value::Bare(-value),
                Value::Radians(value) => Value::Radians(-value),
            });
        }
        if self.take('+') {
            return self.factor();
        }
        if self.take('(') {
            let value = self.sum()?;
            return if self.take(')') { Ok(value) } else { Err("a parenthesis is not closed".to_owned()) };
        }
        let name: String = self.rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '.').collect();
        if name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            self.rest = &self.rest[name.len()..];
            return self.call(&name);
        }
        self.number()
    }

    fn number(&mut self) -> Result<Value, String> {
        let mut end = 0;
        let bytes = self.rest.as_bytes();
        while let Some(&byte) = bytes.get(end) {
            let exponent_sign =
                matches!(byte, b'+' | b'-') && end > 0 && matches!(bytes[end - 1], b'e' | b'E');
            if !(byte.is_ascii_digit() || matches!(byte, b'.' | b'e' | b'E' | b'_') || exponent_sign) {
                break;
            }
            end += 1;
        }
        let (number, rest) = self.rest.split_at(end);
        self.rest = rest;
        literal(number).map(Value::Bare).ok_or_else(|| format!("no number at `{number}{rest}`"))
    }

    fn call(&mut self, name: &str) -> Result<Value, String> {
        if name == "pi" {
            return Ok(Value::Radians(DoubleDouble::PI));
        }
        if !self.take('(') {
            return Err(format!("`{name}` is unknown"));
        }
        let first = self.sum()?;
        let second = if self.take(',') { Some(self.sum()?) } else { None };
        if !self.take(')') {
            return Err("a parenthesis is not closed".to_owned());
        }
        let one = DoubleDouble::ONE;
        Ok(match (name, first, second) {
            ("sqrt", Value::Bare(x), None) => Value::Bare(x.sqrt()),
            ("sin", Value::Radians(x), None) => Value::Bare(x.sin_cos().0),
            ("cos", Value::Radians(x), None) => Value::Bare(x.sin_cos().1),
            ("tan", Value::Radians(x), None) => Value::Bare(x.sin_cos().0 / x.sin_cos().1),
            ("asin", Value::Bare(x), None) => Value::Radians(DoubleDouble::atan2(x, (one - x * x).sqrt())),
            ("acos", Value::Bare(x), None) => Value::Radians(DoubleDouble::atan2((one - x * x).sqrt(), x)),
            ("atan", Value::Bare(x), None) => Value::Radians(DoubleDouble::atan2(x, one)),
            ("atan2", Value::Bare(y), Some(Value::Bare(x))) => Value::Radians(DoubleDouble::atan2(y, x)),
            _ => return Err(format!("`{name}` with arguments of the wrong kind")),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Quantity, Units, degree, evaluate};
    use crate::double_double::DoubleDouble;

    fn read(text: &str, quantity: Quantity) -> Result<f64, String> {
        let units = Units { length: DoubleDouble::ONE / DoubleDouble::from(1000.0), angle: degree() };
        evaluate(text, quantity, &units).map(DoubleDouble::to_f64)
    }

    #[test]
    fn expressions_have_dimensions() {
        let half = std::f64::consts::FRAC_PI_2;
        assert_eq!(read("pi/2", Quantity::Angle), Ok(half));
        assert_eq!(read("2 * 45", Quantity::Angle), Ok(half));
        assert_eq!(read("90 deg", Quantity::Angle), Ok(half));
        assert_eq!(read("1.5 rad", Quantity::Angle), Ok(1.5));
        assert_eq!(read("-(3 - 1) * pi / 4", Quantity::Angle), Ok(-half));
        assert_eq!(read("0.14 m", Quantity::Length), Ok(0.14));
        assert_eq!(read("140", Quantity::Length), Ok(0.14));
        assert_eq!(read("100 * sqrt(2) * sin(pi/4)", Quantity::Length), Ok(0.1));
        assert_eq!(read("acos(0) ", Quantity::Angle), Ok(half));
        assert_eq!(read("atan2(1e0, -1)", Quantity::Angle), Ok(1.5 * half));
        assert!(read("pi/2 + 90", Quantity::Angle).is_err());
        assert!(read("140 mm", Quantity::Angle).is_err());
        assert!(read("pi", Quantity::Length).is_err());
        assert!(read("2 2", Quantity::Length).is_err());
    }
}
