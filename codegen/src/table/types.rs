//! Types of values, and what is said about wrong ones.

use super::fields::Reader;
use crate::diagnostic::{Diagnostic, catalogue, shortened};
use toml::Spanned;
use toml::de::DeValue;

impl Reader<'_> {
    /// Reports a value that is of another type than is wanted.
    pub(super) fn wrong_type(&mut self, what: &str, value: &Spanned<DeValue>, wanted: &str) {
        if self.repeated.contains(&value.span().start) {
            return;
        }
        let raw = self.text.get(value.span()).unwrap_or("");
        let short = if raw.contains('\n') { "..." } else { raw };
        let (found, help) = match (value.get_ref(), wanted) {
            (DeValue::Integer(_) | DeValue::Float(_), TEXT) if what == "`name`" => {
                ("a number", format!("write `\"{short}\"`"))
            }
            (DeValue::String(_), TEXTS) => ("a text", format!("write `[{}]`", shortened(short))),
            (DeValue::Array(list), NUMBER) if list.len() == 1 => {
                ("a list", format!("write `{}`", shortened(short.trim_matches(['[', ']']))))
            }
            (found, _) => (name_of(found), format!("write {}", example_of(wanted))),
        };
        let span = self.first_line(&value.span());
        self.diagnostics.push(
            Diagnostic::error(catalogue::WRONG_TYPE, format!("{what} wants {wanted}, and this is {found}"))
                .at(span, "")
                .help(help),
        );
    }
}

pub(super) const TEXT: &str = "a text in quotes";
pub(super) const TEXTS: &str = "a list of texts in quotes";
pub(super) const NUMBER: &str = "a number, or an expression in quotes";
pub(super) const NUMBERS: &str = "a list of numbers";
pub(super) const KEYS: &str = "a table of keys";
pub(super) const FLAG: &str = "true or false";

fn name_of(value: &DeValue) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// An example of what is wanted.
fn example_of(wanted: &str) -> &str {
    match wanted {
        TEXT => "`\"...\"`",
        TEXTS => "`[\"...\", \"...\"]`",
        NUMBER => "a number such as `0.14`, or an expression such as `\"pi/2\"`",
        NUMBERS => "numbers in brackets, such as `[0, \"pi/2\"]`",
        KEYS => "keys in braces, as in `{ key = value }`, or a `[header]` with keys below it",
        FLAG => "`true` or `false`",
        other => other,
    }
}
