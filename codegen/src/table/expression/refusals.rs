//! What is said about expressions that are none.
#![allow(
    clippy::unnecessary_box_returns,
    reason = "they are the errors of results that are returned at every token, which stay small so"
)]

use super::functions::FUNCTIONS;
use super::{Reader, Unit};
use crate::diagnostic::{Diagnostic, catalogue, nearest, shortened};
use crate::table::Text;
use crate::table::lexer::{Token, TokenKind};
use std::ops::Range;

const LANGUAGE: &str = "an expression has + - * / ( ), pi, sqrt sin cos tan acos asin atan atan2, and at its end a unit: m, mm, rad or deg";

impl Reader<'_> {
    pub(super) fn refuse(
        &self,
        code: &'static str,
        message: &str,
        at: &Range<usize>,
        help: &str,
    ) -> Box<Diagnostic> {
        Box::new(Diagnostic::error(code, message).at(self.text.place(at), "").help(help))
    }

    pub(super) fn not_linear(&self, why: &str, at: &Range<usize>) -> Box<Diagnostic> {
        let message = format!("not linear in the joints: {why}");
        let help =
            "write a sum of joints times numbers, and a number, such as `theta4 = pi/2 - theta2 - theta3`";
        self.refuse(catalogue::NOT_LINEAR, &message, at, help)
    }

    /// A value was to begin here.
    pub(super) fn no_value_at(&self, token: &Token) -> Box<Diagnostic> {
        let written = shortened(self.lexer.of(token));
        let (message, help) = match token.kind {
            TokenKind::End if self.part.start == token.at.start || self.is_blank() => {
                ("the expression is empty".to_owned(), "write a number".to_owned())
            }
            TokenKind::End => (
                "the expression ends too early".to_owned(),
                "write what is missing, or leave the last operator out".to_owned(),
            ),
            TokenKind::Name => (
                format!("the unit `{written}` has no number"),
                format!("write a number before it, such as `1 {written}`"),
            ),
            _ => (
                format!("`{written}` stands where a number is wanted"),
                "write a number, `pi`, a function or `(`".to_owned(),
            ),
        };
        self.refuse(catalogue::BAD_EXPRESSION, &message, &token.at, &help)
    }

    /// A value was read, and neither an operator nor the end follows.
    pub(super) fn no_operator_at(&self, token: &Token, wanted: &str) -> Box<Diagnostic> {
        let written = shortened(self.lexer.of(token));
        let stands = format!("`{written}` stands where {wanted} is wanted");
        let units =
            ["degrees", "degree", "radians", "radian", "millimetres", "millimeters", "metres", "meters"];
        let (message, help) = match token.kind {
            TokenKind::End => {
                (format!("the expression ends where {wanted} is wanted"), "write `)`".to_owned())
            }
            TokenKind::Power => (stands, "there are no powers: write `x*x`".to_owned()),
            TokenKind::Name if Unit::named(&written).is_some() => {
                (stands, "a unit stands at the very end, or behind the number that it belongs to".to_owned())
            }
            TokenKind::Name if written == "pi" || FUNCTIONS.contains(&written.as_str()) => {
                (stands, format!("write `*` before `{written}` to multiply"))
            }
            TokenKind::Name => {
                let unit = match nearest(&written, units) {
                    Some("degrees" | "degree") => "write `deg`",
                    Some("radians" | "radian") => "write `rad`",
                    Some("millimetres" | "millimeters") => "write `mm`",
                    Some(_) => "write `m`",
                    None => "the units are m, mm, rad and deg",
                };
                (format!("`{written}` is no unit"), unit.to_owned())
            }
            TokenKind::Number | TokenKind::Open => {
                (stands, format!("write `*` before `{written}` to multiply"))
            }
            TokenKind::Unknown if matches!(written.as_str(), "<" | ">" | "=") => {
                (stands, "an inequality has one of <=, <, >= and >, an equation one `=`".to_owned())
            }
            _ => (stands, LANGUAGE.to_owned()),
        };
        self.refuse(catalogue::BAD_EXPRESSION, &message, &token.at, &help)
    }

    fn is_blank(&self) -> bool {
        self.text.value.get(self.part.clone()).is_none_or(|part| part.trim().is_empty())
    }
}

/// A name stands in a number, where there are no variables.
pub(super) fn no_variables(name: &str, span: Range<usize>) -> Result<usize, Box<Diagnostic>> {
    let near = nearest(name, FUNCTIONS.into_iter().chain(["pi"]));
    let diagnostic = if FUNCTIONS.contains(&name) {
        Diagnostic::error(catalogue::BAD_EXPRESSION, format!("`{name}` has no argument in parentheses"))
            .help(format!("write `{name}(...)`"))
    } else {
        let message = format!("`{}` means nothing in an expression", shortened(name));
        Diagnostic::error(catalogue::BAD_EXPRESSION, message)
            .help(near.map_or_else(|| LANGUAGE.to_owned(), |near| format!("write `{near}`")))
    };
    Err(Box::new(diagnostic.at(span, "")))
}

/// An angle, or a length, and a bare number are added.
pub(crate) fn mixed_units(text: &Text) -> Diagnostic {
    let shown = shortened(&text.value);
    let help = if text.value.contains("pi") && !text.value.contains(['=', '<', '>', '(']) {
        format!("write its unit at the end, `\"{shown} deg\"` or `\"{shown} rad\"`")
    } else {
        "write the unit of each number, as in `\"pi/2 + 90 deg\"`".to_owned()
    };
    Diagnostic::error(
        catalogue::MIXED_UNITS,
        "a number without a unit is added to one that has one: pi is half a turn whatever the table's units, a bare number is in them",
    )
    .at(text.span.clone(), "")
    .help(help)
}
