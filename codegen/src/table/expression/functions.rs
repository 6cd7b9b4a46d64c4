//! Functions of expressions.

use super::refusals::mixed_units;
use super::{Outcome, Reader, Value};
use crate::diagnostic::{catalogue, nearest, shortened};
use crate::table::lexer::{Token, TokenKind};

pub(super) const FUNCTIONS: [&str; 8] = ["sqrt", "sin", "cos", "tan", "acos", "asin", "atan", "atan2"];

impl Reader<'_> {
    pub(super) fn call(&mut self, name: &str, token: &Token) -> Outcome {
        if !FUNCTIONS.contains(&name) {
            let message = format!("`{}` is not a function", shortened(name));
            let help = match nearest(name, FUNCTIONS) {
                Some(near) => format!("write `{near}`"),
                None => format!("the functions are {}", FUNCTIONS.join(", ")),
            };
            return Err(self.refuse(catalogue::BAD_EXPRESSION, &message, &token.at, &help));
        }
        let open = self.lexer.next();
        self.enter(&open)?;
        let first = self.sum()?;
        if name == "atan2" {
            return self.atan2(&first, token);
        }
        self.close()?;
        if !argument_is_number(&first) {
            return Err(self.not_linear(&format!("a joint stands inside `{name}`"), &token.at));
        }
        match name {
            "sin" | "cos" | "tan" => self.of_angle(name, &first, token),
            _ => self.of_number(name, &first, token),
        }
    }

    fn atan2(&mut self, first: &Value, token: &Token) -> Outcome {
        let comma = self.lexer.next();
        if comma.kind != TokenKind::Comma {
            let message = "`atan2` takes two arguments";
            return Err(self.refuse(catalogue::BAD_EXPRESSION, message, &comma.at, "write `atan2(y, x)`"));
        }
        let second = self.sum()?;
        self.close()?;
        let (y, x) = self.alike(first, &second, token)?;
        if x == 0.0 && y == 0.0 {
            let message = "atan2(0, 0) has no value";
            let help = "write arguments of which one is not 0";
            return Err(self.refuse(catalogue::NO_VALUE, message, &token.at, help));
        }
        Ok(Value::of_angle(libm::atan2(y, x)))
    }

    /// sqrt, acos, asin, atan.
    fn of_number(&self, name: &str, argument: &Value, token: &Token) -> Outcome {
        let Some(x) = argument.only_bare() else {
            let message = format!("`{name}` takes a number without a unit");
            return Err(self.refuse(catalogue::WRONG_UNIT, &message, &token.at, "write a plain number"));
        };
        let range = match name {
            "sqrt" if x < 0.0 => "0 or more",
            "acos" | "asin" if x.abs() > 1.0 => "-1 to 1",
            _ => "",
        };
        if !range.is_empty() {
            let message = format!("`{name}` of {x} has no value");
            return Err(self.refuse(
                catalogue::NO_VALUE,
                &message,
                &token.at,
                &format!("write an argument of {range}"),
            ));
        }
        Ok(match name {
            "sqrt" => Value::of(libm::sqrt(x)),
            "acos" => Value::of_angle(libm::acos(x)),
            "asin" => Value::of_angle(libm::asin(x)),
            _ => Value::of_angle(libm::atan(x)),
        })
    }

    /// sin, cos, tan. A bare argument is in the table's unit of angle.
    fn of_angle(&self, name: &str, argument: &Value, token: &Token) -> Outcome {
        let angle = match (argument.bare, argument.angle, argument.length) {
            (Some(bare), None, None) => bare * self.scope.radians_per_angle,
            (None | Some(0.0), Some(angle), None) => angle,
            (_, _, None) => return Err(Box::new(mixed_units(self.text))),
            (_, _, Some(_)) => {
                let message = format!("`{name}` takes an angle, not a length");
                return Err(self.refuse(catalogue::WRONG_UNIT, &message, &token.at, "write an angle"));
            }
        };
        let (sine, cosine) = crate::model::Angle::from_radians(angle).sin_cos();
        match name {
            "sin" => Ok(Value::of(sine)),
            "cos" => Ok(Value::of(cosine)),
            _ if cosine != 0.0 => Ok(Value::of(sine / cosine)),
            _ => {
                let message = "the tangent of a quarter turn has no value";
                Err(self.refuse(catalogue::NO_VALUE, message, &token.at, "write another angle"))
            }
        }
    }
}

fn argument_is_number(argument: &Value) -> bool {
    argument.terms.is_empty()
}
