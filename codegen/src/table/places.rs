//! Lines and statements of a text.

use std::ops::Range;

/// The line that a byte is in, without its line feed.
pub(super) fn line_around(text: &str, at: usize) -> Range<usize> {
    let at = at.min(text.len());
    let bytes = text.as_bytes();
    let start = bytes.iter().take(at).rposition(|byte| *byte == b'\n').map_or(0, |feed| feed + 1);
    let end = bytes.iter().skip(at).position(|byte| *byte == b'\n').map_or(bytes.len(), |feed| at + feed);
    start..end
}

/// Whether a line looks like `[table]` or `[[table]]`.
pub(super) fn is_header(line: &str) -> bool {
    let line = line.trim_start();
    let name = line.strip_prefix("[[").or_else(|| line.strip_prefix('['));
    name.is_some_and(|name| name.trim_start().starts_with(|c: char| c.is_ascii_alphabetic() || c == '_'))
}

/// Whether a line looks like the start of `key = value`, or a header.
pub(super) fn is_statement(line: &str) -> bool {
    if is_header(line) {
        return true;
    }
    let Some((key, _)) = line.split_once('=') else {
        return false;
    };
    let key = key.trim();
    let allowed = |c: char| c.is_ascii_alphanumeric() || "_-.\"' ".contains(c);
    !key.is_empty() && key.chars().all(allowed)
}

/// Where the first bracket stands that a text leaves open, strings and comments aside.
pub(super) fn open_bracket(text: &str) -> Option<usize> {
    let mut open = Vec::new();
    let mut letters = text.char_indices().peekable();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '[' | '{' => open.push(at),
            ']' | '}' => {
                open.pop();
            }
            '#' => while letters.next_if(|(_, letter)| *letter != '\n').is_some() {},
            '"' | '\'' => {
                while let Some((_, inside)) = letters.next_if(|(_, inside)| *inside != '\n') {
                    if inside == letter {
                        break;
                    }
                    if inside == '\\' && letter == '"' {
                        letters.next();
                    }
                }
            }
            _ => {}
        }
    }
    open.first().copied()
}

/// Where the next header line after a place starts, or the text ends.
pub(super) fn next_header(text: &str, after: usize) -> usize {
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
