//! Typed access to the keys of a TOML table, with a diagnostic for each that is wrong.

use super::types::{FLAG, KEYS, NUMBER, NUMBERS, TEXT, TEXTS};
use super::{Number, Numbers, Span, Text, Written};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, nearest, shortened};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// What reading needs besides the tables.
pub(super) struct Reader<'a> {
    pub(super) text: &'a str,
    pub(super) diagnostics: &'a mut Diagnostics,
    /// Where the lines end.
    pub(super) line_feeds: Vec<usize>,
    /// Headers that stand for a second time, in place of what stood there first.
    pub(super) repeated: Vec<usize>,
    /// Whether nothing of the text was left out.
    pub(super) complete: bool,
}

/// A table of the file, whose keys are all known.
pub(super) struct Fields<'a> {
    pub(super) table: &'a DeTable<'a>,
    /// From its header to its last value.
    pub(super) span: Span,
    /// How it is called in messages: "`[robot]`".
    pub(super) place: &'static str,
}

impl<'a> Fields<'a> {
    pub(super) fn value(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table.get(key)
    }

    pub(super) fn key_span(&self, key: &str) -> Span {
        self.table.get_key_value(key).map_or(0..0, |(key, _)| key.span())
    }

    /// Keys and values in the order of the text.
    pub(super) fn in_order(&self) -> Vec<(&'a Spanned<DeString<'a>>, &'a Spanned<DeValue<'a>>)> {
        let mut entries: Vec<_> = self.table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        entries
    }
}

impl Reader<'_> {
    /// A table with these keys; `None` where it is something else.
    pub(super) fn open<'a>(
        &mut self,
        value: &'a Spanned<DeValue<'a>>,
        place: &'static str,
        known: &[&str],
    ) -> Option<Fields<'a>> {
        let fields = self.open_any(value, place)?;
        self.refuse_unknown(&fields, known);
        Some(fields)
    }

    /// A table with any keys.
    pub(super) fn open_any<'a>(
        &mut self,
        value: &'a Spanned<DeValue<'a>>,
        place: &'static str,
    ) -> Option<Fields<'a>> {
        let DeValue::Table(table) = value.get_ref() else {
            self.wrong_type(place, value, KEYS);
            return None;
        };
        Some(Fields { table, span: value.span().start..end_of(value).max(value.span().end), place })
    }

    /// Reports keys that are not among the known ones.
    pub(super) fn refuse_unknown(&mut self, fields: &Fields, known: &[&str]) {
        for (key, _) in fields.in_order() {
            let name: &str = key.get_ref();
            if known.contains(&name) {
                continue;
            }
            let mut diagnostic = Diagnostic::error(
                catalogue::UNKNOWN_KEY,
                format!("{} has no key `{}`", fields.place, shortened(name)),
            )
            .at(key.span(), "");
            diagnostic = match nearest(name, known.iter().copied()) {
                Some(near) => diagnostic.help(format!("write `{near}`")),
                None => diagnostic.help(format!("its keys are {}", known.join(", "))),
            };
            self.diagnostics.push(diagnostic);
        }
    }

    /// A value that has to be there.
    pub(super) fn required<'a>(
        &mut self,
        fields: &Fields<'a>,
        key: &str,
        example: &str,
    ) -> Option<&'a Spanned<DeValue<'a>>> {
        let value = fields.value(key);
        if value.is_none() && self.complete {
            self.diagnostics.push(
                Diagnostic::error(catalogue::MISSING_KEY, format!("{} has no `{key}`", fields.place))
                    .at(self.first_line(&fields.span), "")
                    .help(format!("write `{key} = {example}`")),
            );
        }
        value
    }

    /// The first line of a place.
    pub(super) fn first_line(&self, span: &Span) -> Span {
        let end = self
            .text
            .get(span.clone())
            .and_then(|text| text.find(['\n', '\r']))
            .map_or(span.end, |length| span.start + length);
        span.start..end
    }

    /// 1-based line that a place begins in.
    pub(super) fn line(&self, span: &Span) -> usize {
        1 + self.line_feeds.partition_point(|feed| *feed < span.start)
    }

    pub(super) fn text(&mut self, fields: &Fields, key: &str) -> Option<Text> {
        let value = fields.value(key)?;
        self.text_of(key, value)
    }

    pub(super) fn text_of(&mut self, key: &str, value: &Spanned<DeValue>) -> Option<Text> {
        let DeValue::String(string) = value.get_ref() else {
            self.wrong_type(&format!("`{key}`"), value, TEXT);
            return None;
        };
        Some(self.located(string, value.span()))
    }

    /// The string with the place of its letters, if it has no escapes.
    fn located(&self, string: &str, span: Span) -> Text {
        let raw = self.text.get(span.clone()).unwrap_or("");
        let base = [1, 3].into_iter().find_map(|quotes: usize| {
            let inside = raw.get(quotes..raw.len().checked_sub(quotes)?)?;
            (inside == string).then_some(span.start + quotes)
        });
        Text { value: string.to_owned(), span, base }
    }

    /// The name that a key is.
    pub(super) fn key_text(key: &Spanned<DeString>) -> Text {
        Text { value: key.get_ref().to_string(), span: key.span(), base: None }
    }

    pub(super) fn flag(&mut self, fields: &Fields, key: &str) -> Option<bool> {
        let value = fields.value(key)?;
        if let DeValue::Boolean(flag) = value.get_ref() {
            return Some(*flag);
        }
        self.wrong_type(&format!("`{key}`"), value, FLAG);
        None
    }

    pub(super) fn number(&mut self, fields: &Fields, key: &str) -> Option<Number> {
        let value = fields.value(key)?;
        self.number_of(key, value)
    }

    pub(super) fn number_of(&mut self, key: &str, value: &Spanned<DeValue>) -> Option<Number> {
        let span = value.span();
        let (number, digits) = match value.get_ref() {
            DeValue::String(string) => return Some(Number::Expression(self.located(string, span))),
            DeValue::Integer(integer) if integer.radix() == 10 => {
                (integer.as_str().parse().ok(), integer.as_str())
            }
            DeValue::Integer(integer) => {
                let value = u128::from_str_radix(integer.as_str(), integer.radix()).ok();
                (value.map(|value| value as f64), integer.as_str())
            }
            DeValue::Float(float) => (float.as_str().parse::<f64>().ok(), float.as_str()),
            _ => {
                self.wrong_type(&format!("`{key}`"), value, NUMBER);
                return None;
            }
        };
        if let Some(number) = number.filter(|number: &f64| number.is_finite()) {
            return Some(Number::Literal { value: number, digits: digits.to_owned(), span });
        }
        self.diagnostics.push(
            Diagnostic::error(
                catalogue::NOT_FINITE,
                format!("`{}` is not a finite number", shortened(digits)),
            )
            .at(span, "")
            .help(format!("write a number, or leave `{key}` out if there is none")),
        );
        None
    }

    /// A list of so many numbers.
    pub(super) fn numbers(&mut self, fields: &Fields, key: &str, meanings: &[&str]) -> Option<Numbers> {
        let value = fields.value(key)?;
        let numbers = self.numbers_of(key, value)?;
        if numbers.value.len() == meanings.len() {
            return Some(numbers);
        }
        let count = numbers.value.len();
        self.diagnostics.push(
            Diagnostic::error(
                catalogue::WRONG_LENGTH,
                format!("`{key}` has {}, not {}", counted(count, "value"), meanings.len()),
            )
            .at(value.span(), "")
            .help(format!("write `{key} = [{}]`", meanings.join(", "))),
        );
        None
    }

    /// A list of any number of numbers; `None` if one of them is none.
    pub(super) fn numbers_of(&mut self, key: &str, value: &Spanned<DeValue>) -> Option<Numbers> {
        let DeValue::Array(array) = value.get_ref() else {
            self.wrong_type(&format!("`{key}`"), value, NUMBERS);
            return None;
        };
        let numbers: Vec<Option<Number>> = array.iter().map(|value| self.number_of(key, value)).collect();
        let numbers: Option<Vec<Number>> = numbers.into_iter().collect();
        Some(Written { value: numbers?, span: value.span() })
    }

    /// A list of texts, and whether all of them were.
    pub(super) fn texts(&mut self, fields: &Fields, key: &str) -> (Vec<Text>, bool) {
        let Some(value) = fields.value(key) else {
            return (Vec::new(), true);
        };
        let DeValue::Array(array) = value.get_ref() else {
            self.wrong_type(&format!("`{key}`"), value, TEXTS);
            return (Vec::new(), false);
        };
        let texts: Vec<Text> = array.iter().filter_map(|value| self.text_of(key, value)).collect();
        let all = texts.len() == array.len();
        (texts, all)
    }

    /// `{ name = number, ... }`.
    pub(super) fn weights(&mut self, fields: &Fields, key: &'static str) -> Option<Vec<(Text, Number)>> {
        let value = fields.value(key)?;
        let inner = self.open_any(value, key_place(key))?;
        let weights: Vec<Option<(Text, Number)>> = inner
            .in_order()
            .into_iter()
            .map(|(name, value)| Some((Reader::key_text(name), self.number_of(key, value)?)))
            .collect();
        weights.into_iter().collect()
    }

    /// The entries of a list of tables, `[[key]]` or `key = [...]`.
    pub(super) fn entries<'a>(
        &mut self,
        root: &'a DeTable<'a>,
        key: &'static str,
    ) -> Vec<&'a Spanned<DeValue<'a>>> {
        let Some(value) = root.get(key) else {
            return Vec::new();
        };
        match value.get_ref() {
            DeValue::Array(array) => array.iter().collect(),
            DeValue::Table(_) => {
                self.diagnostics.push(
                    Diagnostic::error(
                        catalogue::WRONG_TYPE,
                        format!("`{key}` is a list, of which `[{key}]` is not an entry"),
                    )
                    .at(self.first_line(&value.span()), "")
                    .help(format!("write `[[{key}]]`")),
                );
                self.complete = false;
                Vec::new()
            }
            _ => {
                self.wrong_type(
                    &format!("`{key}`"),
                    value,
                    &format!("a list of tables, each headed `[[{key}]]`"),
                );
                self.complete = false;
                Vec::new()
            }
        }
    }
}

/// How a table that is a value is called in messages.
fn key_place(key: &'static str) -> &'static str {
    match key {
        "couple" => "`couple`",
        _ => "`of`",
    }
}

/// "1 value", "2 values".
pub(super) fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

/// Where the last value inside a value ends. TOML nests at most 80 deep, so this does.
fn end_of(value: &Spanned<DeValue>) -> usize {
    let inside = match value.get_ref() {
        DeValue::Table(table) => table.iter().map(|(_, value)| end_of(value)).max(),
        DeValue::Array(array) => array.iter().map(end_of).max(),
        _ => None,
    };
    inside.unwrap_or(0).max(value.span().end)
}
