//! Broken TOML: every broken statement is reported once and left out, so that the rest can be checked.

use super::places::{is_header, is_statement, line_around, open_bracket};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, shortened};
use std::ops::Range;
use toml::de::{DeTable, DeValue, Error};

/// After so many broken statements the rest is not looked at.
const MOST_MENDED: usize = 20;

/// Of so many duplicates the rest is not looked at.
const MOST_DUPLICATES: usize = 100;

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

/// Reports keys that stand twice. The parser reports some of them twice, too. Returns where the headers start that do.
pub(super) fn report_duplicates(
    text: &str,
    root: &DeTable,
    errors: &[Error],
    diagnostics: &mut Diagnostics,
) -> Vec<usize> {
    let mut headers = Vec::new();
    let mut sorted: Vec<&Error> = errors.iter().filter(|error| is_about_keys(error)).collect();
    sorted.sort_by_key(|error| error.span().map_or(0, |span| span.start));
    let mut skipped_to = 0;
    for error in sorted.into_iter().take(MOST_DUPLICATES) {
        let span = error.span().unwrap_or(0..0);
        if span.start < skipped_to {
            continue;
        }
        let line = line_around(text, span.start);
        let header = text.get(line.clone()).filter(|line| is_header(line));
        if header.is_some() {
            // What stands twice below a header that stands twice is no second mistake.
            skipped_to = next_header(text, line.end);
            headers.push(line.start);
        }
        diagnostics.push(duplicate(text, root, error, span, header));
    }
    headers
}

fn duplicate(
    text: &str,
    root: &DeTable,
    error: &Error,
    span: Range<usize>,
    header: Option<&str>,
) -> Diagnostic {
    let key = text.get(span.clone()).unwrap_or("").to_owned();
    let lists = ["joint", "ik", "limit", "servo"];
    let is_list = root.get(key.as_str()).is_some_and(|value| matches!(value.get_ref(), DeValue::Array(_)));
    if let Some(header) = header.filter(|_| is_list && lists.contains(&key.as_str())) {
        let header = shortened(header.trim());
        let first = root.get_key_value(key.as_str()).map(|(first, _)| first.span());
        let diagnostic = Diagnostic::error(
            catalogue::BOUND_ELSEWHERE,
            format!("`{header}` has no `[[{key}]]` to belong to: it binds to the last one before it, and the list is written as `{key} = [...]`"),
        )
        .at(span, "");
        let diagnostic = match first {
            Some(first) => diagnostic.beside(first, "the list, which cannot be added to"),
            None => diagnostic,
        };
        return if header.starts_with("[[") {
            diagnostic.help(format!(
                "write this entry inside the list, as `{{ ... }}`, or every entry as a `[[{key}]]`"
            ))
        } else {
            let inner = header.trim_matches(['[', ']']).rsplit('.').next().unwrap_or("").to_owned();
            diagnostic.help(format!("write `{inner} = {{ ... }}` inside the row that it belongs to"))
        };
    }
    let name = shortened(&key);
    let message = match error.message().strip_prefix("cannot extend value of type ") {
        Some(rest) => {
            let kind = rest.split(" with").next().unwrap_or("value");
            format!("`{name}` is already a value of type {kind}, which cannot have keys of its own")
        }
        None => format!("`{name}` stands twice"),
    };
    // The parser keeps the second of two headers, so the first one is looked for in the text.
    let first = match header {
        Some(header) => first_line_like(text, header, span.start),
        None => first_place(root, &key, span.start),
    };
    let diagnostic = Diagnostic::error(catalogue::DUPLICATE_KEY, message).at(span, "the second time");
    let diagnostic = match first {
        Some(first) => diagnostic.beside(first, "the first time"),
        None => diagnostic,
    };
    diagnostic.help("leave one of them out")
}

/// The first line before that is the same header.
fn first_line_like(text: &str, header: &str, before: usize) -> Option<Range<usize>> {
    let mut start = 0;
    for line in text.split('\n') {
        if start + line.len() >= before {
            return None;
        }
        if line.trim() == header.trim() {
            return Some(start..start + line.trim_end().len());
        }
        start += line.len() + 1;
    }
    None
}

/// The nearest place before, where the same key stands.
fn first_place(table: &DeTable, key: &str, before: usize) -> Option<Range<usize>> {
    let mut found: Option<Range<usize>> = None;
    let mut consider = |span: Range<usize>| {
        if span.start < before && found.as_ref().is_none_or(|found| found.start < span.start) {
            found = Some(span);
        }
    };
    for (name, value) in table {
        if name.get_ref() == key {
            consider(name.span());
        }
        match value.get_ref() {
            DeValue::Table(inner) => first_place(inner, key, before).into_iter().for_each(&mut consider),
            DeValue::Array(list) => {
                for inner in list.iter().filter_map(|value| value.get_ref().as_table()) {
                    first_place(inner, key, before).into_iter().for_each(&mut consider);
                }
            }
            _ => {}
        }
    }
    found
}

/// Mistakes that leave the text readable.
fn is_about_keys(error: &Error) -> bool {
    error.message().starts_with("duplicate key") || error.message().starts_with("cannot extend value")
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

/// Where the next header line after a place starts, or the text ends.
fn next_header(text: &str, after: usize) -> usize {
    let mut at = after;
    while at < text.len() {
        let line = line_around(text, at + 1);
        if line.start > at && text.get(line.clone()).is_some_and(is_header) {
            return line.start;
        }
        at = line.end.max(at + 1);
    }
    text.len()
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
