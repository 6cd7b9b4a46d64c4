//! Broken TOML: every broken statement is reported once and left out, so that the rest can be checked.

use super::duplicates::is_about_keys;
use super::places::{is_header, is_statement, line_around, next_header, open_bracket};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, shortened};
use std::ops::Range;
use toml::de::{DeTable, Error};

/// After so many broken statements the rest is not looked at.
const MOST_MENDED: usize = 20;

/// A text without its broken statements.
pub(super) struct Mended {
    /// As long as the original, so that places hold: what is left out is blank.
    pub(super) text: String,
    /// Whether nothing was left out.
    pub(super) complete: bool,
}

/// Leaves out what is not TOML, statement by statement.
pub(super) fn mend(text: &str, diagnostics: &mut Diagnostics) -> Mended {
    let mut mended = text.to_owned();
    for round in 0..MOST_MENDED {
        let (_, errors) = DeTable::parse_recoverable(&mended);
        let first = errors
            .iter()
            .filter(|error| !is_about_keys(error))
            .min_by_key(|error| error.span().map_or(0, |span| span.start));
        let Some(error) = first else {
            return Mended { text: mended, complete: round == 0 };
        };
        let span = error.span().unwrap_or(0..0);
        let (statement, unclosed) = broken_statement(&mended, span.start);
        diagnostics.push(match unclosed {
            Some(bracket) => not_closed(text, bracket),
            None => describe(text, error, span),
        });
        mended = blank(&mended, statement);
    }
    Mended { text: String::new(), complete: false }
}

/// The statement that an error is in, and the bracket that it leaves open, if that is the error.
fn broken_statement(text: &str, at: usize) -> (Range<usize>, Option<usize>) {
    let own = line_around(text, at);
    let before = statement_before(text, own.start);
    let unclosed = before.and_then(|start| Some(start + open_bracket(text.get(start..own.start)?)?));
    let own_line = text.get(own.clone()).unwrap_or("");
    let (start, bracket) = match (before, unclosed) {
        (Some(start), Some(bracket)) => (start, is_statement(own_line).then_some(bracket)),
        _ => (own.start, None),
    };
    let first_line = line_around(text, start);
    if text.get(first_line.clone()).is_some_and(is_header) {
        // Nobody knows what the keys below a broken header belong to.
        return (start..next_header(text, first_line.end), None);
    }
    let mut end = first_line.end;
    while end < text.len() {
        let next = line_around(text, end + 1);
        if text.get(next.clone()).is_none_or(is_statement)
            || (next.start > own.end && bracket.is_none() && unclosed.is_none())
        {
            break;
        }
        end = next.end.max(end + 1);
    }
    (start..end, bracket)
}

/// Where the last statement before a line starts.
fn statement_before(text: &str, line_start: usize) -> Option<usize> {
    let mut end = line_start;
    while end > 0 {
        let line = line_around(text, end - 1);
        if text.get(line.clone()).is_some_and(is_statement) {
            return Some(line.start);
        }
        end = line.start;
    }
    None
}

fn blank(text: &str, range: Range<usize>) -> String {
    let blanked = text
        .bytes()
        .enumerate()
        .map(|(at, byte)| if range.contains(&at) && byte != b'\n' && byte != b'\r' { b' ' } else { byte });
    // A range between line ends covers whole letters.
    String::from_utf8(blanked.collect()).unwrap_or_default()
}

fn not_closed(text: &str, bracket: usize) -> Diagnostic {
    let (open, close) =
        if text.get(bracket..).is_some_and(|text| text.starts_with('{')) { ("{", "}") } else { ("[", "]") };
    Diagnostic::error(catalogue::SYNTAX, format!("`{open}` is not closed"))
        .at(bracket..bracket + 1, "")
        .help(format!("write `{close}` where it ends"))
}

fn describe(text: &str, error: &Error, span: Range<usize>) -> Diagnostic {
    let written = text.get(span.clone()).unwrap_or("").trim();
    let message = error.message();
    if message.starts_with("string values must be quoted") {
        if written.is_empty() {
            return Diagnostic::error(CODE, "a value is missing")
                .at(span, "")
                .help("write a value, or leave the key out");
        }
        return Diagnostic::error(CODE, "a value that is not a number, true or false stands in quotes")
            .at(span, "")
            .help(format!("write `\"{}\"`", shortened(written)));
    }
    if message.starts_with("invalid float") || message.starts_with("invalid integer") {
        let line = line_around(text, span.start);
        let before = text.get(line.start..span.end).unwrap_or("");
        let literal = before.rsplit(['=', '[', ',', ' ']).next().unwrap_or("").trim();
        let number_ends = literal.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(literal.len());
        if let (Some(number), Some(unit)) = (literal.get(..number_ends), literal.get(number_ends..))
            && matches!(unit, "deg" | "rad" | "m" | "mm")
        {
            return Diagnostic::error(CODE, "a number with a unit stands in quotes")
                .at(span, "")
                .help(format!("write `\"{number} {unit}\"`"));
        }
    }
    let (what, expected) = message.split_once(", expected ").unwrap_or((message, "nothing"));
    let (what, help) = match KNOWN.iter().find(|(start, ..)| what.starts_with(start)) {
        Some((_, what, help)) => (*what, (*help).to_owned()),
        None if expected == "nothing" => (what, "leave it out".to_owned()),
        None => (what, format!("what may stand here: {}", shortened(expected))),
    };
    Diagnostic::error(CODE, format!("this is not TOML: {what}")).at(span, "").help(help)
}

/// What the parser says, what we say, and what to write.
const KNOWN: [(&str, &str, &str); 17] = [
    ("unclosed array table", "the header is not closed", "write `]]` where it ends"),
    ("unclosed table", "the header is not closed", "write `]` where it ends"),
    ("unclosed array", "the list is not closed", "write `]` where it ends"),
    ("unclosed inline table", "the table is not closed", "write `}` where it ends"),
    ("key with no value", "a key without `=`", "write `key = value`"),
    ("extra `=`", "a second `=`", "leave one of them out"),
    ("invalid basic string", "the text is not closed", "write `\"` where it ends"),
    ("invalid literal string", "the text is not closed", "write `'` where it ends"),
    ("invalid multi-line basic string", "the text is not closed", "write `\"\"\"` where it ends"),
    ("invalid multi-line literal string", "the text is not closed", "write `'''` where it ends"),
    ("unexpected leading zero", "a number begins with a 0 that says nothing", "leave the 0 out"),
    ("invalid fraction", "no digit follows the point", "write one, such as `1.0`"),
    ("invalid mantissa", "no digit stands before the point", "write one, such as `0.5`"),
    ("redundant numeric sign", "a number has two signs", "leave one of them out"),
    ("extra comma", "a comma with no value before it", "leave it out"),
    ("missing comma", "values without a comma between them", "write `,` before this one"),
    ("missing escaped value", "a backslash begins no escape", "write `\\\\` for a backslash"),
];

const CODE: &str = catalogue::SYNTAX;
