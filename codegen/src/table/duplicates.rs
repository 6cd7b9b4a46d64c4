//! Keys and headers that stand twice.

use super::places::{is_header, line_around, next_header};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, shortened};
use std::ops::Range;
use toml::de::{DeTable, DeValue, Error};

/// Of so many duplicates the rest is not looked at.
const MOST_DUPLICATES: usize = 100;

/// Reports keys that stand twice. The parser reports some of them twice, too. Returns where the headers start that do.
pub(super) fn report(
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
pub(super) fn is_about_keys(error: &Error) -> bool {
    error.message().starts_with("duplicate key") || error.message().starts_with("cannot extend value")
}
