//! Drawing of diagnostics over the table's text.

use super::{Diagnostic, Diagnostics, Label, Severity};
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use std::ops::Range;

/// How diagnostics are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Text alone.
    Plain,
    /// With terminal colours.
    Coloured,
    /// Text alone, without the word "error" in front, for the message of an error that brings its own (`compile_error!`).
    WithinError,
}

/// Beyond so many, the rest is only counted.
const MOST_DRAWN: usize = 200;

/// Lines longer than this are cut around the place shown (bytes).
const LONGEST_LINE: usize = 2000;

impl Diagnostics {
    /// Draws all diagnostics in the order of the text. `path` is shown as given.
    pub fn render(&self, source: &str, path: &str, style: Style) -> String {
        let sorted = self.sorted();
        let mut drawn: Vec<String> =
            sorted.iter().take(MOST_DRAWN).map(|item| item.render(source, path, style)).collect();
        if let Some(more) = sorted.len().checked_sub(MOST_DRAWN).filter(|more| *more > 0) {
            drawn.push(format!("... and {more} more"));
        }
        drawn.join("\n\n")
    }
}

impl Diagnostic {
    /// Draws one diagnostic. `path` is shown as given.
    pub fn render(&self, source: &str, path: &str, style: Style) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let level = if style == Style::WithinError && self.severity == Severity::Error {
            level.no_name()
        } else {
            level
        };
        let mut title = level.primary_title(self.message.as_str());
        if style != Style::WithinError {
            title = title.id(self.code);
        }
        let help = self
            .help
            .iter()
            .map(|text| Level::HELP.message(annotate_snippets::normalize_untrusted_str(text)));
        let group = match excerpt(source, &self.labels) {
            Some(excerpt) => {
                let snippet = Snippet::source(excerpt.text).line_start(excerpt.line).path(path).annotations(
                    excerpt.labels.into_iter().map(|(span, label)| {
                        let kind =
                            if label.primary { AnnotationKind::Primary } else { AnnotationKind::Context };
                        let text = Some(label.text.as_str()).filter(|text| !text.is_empty());
                        kind.span(span).label(text)
                    }),
                );
                title.element(snippet).elements(help)
            }
            None => Group::with_title(title).element(annotate_snippets::Origin::path(path)).elements(help),
        };
        let renderer = if style == Style::Coloured { Renderer::styled() } else { Renderer::plain() };
        renderer.render(&[group])
    }
}

/// The lines that the labels stand in.
struct Excerpt<'a> {
    text: &'a str,
    /// 1-based number of its first line.
    line: usize,
    /// Labels with their places in `text`.
    labels: Vec<(Range<usize>, &'a Label)>,
}

/// Cut before it is drawn, so that the time that takes does not grow with the table.
fn excerpt<'a>(source: &'a str, labels: &'a [Label]) -> Option<Excerpt<'a>> {
    let inside: Vec<(Range<usize>, &Label)> =
        labels.iter().map(|label| (on_letters(source, &label.span), label)).collect();
    let first = inside.iter().map(|(span, _)| span.start).min()?;
    let last = inside.iter().map(|(span, _)| span.end).max()?;
    let mut start = source.get(..first)?.rfind('\n').map_or(0, |at| at + 1);
    let mut end = source.get(last..)?.find('\n').map_or(source.len(), |at| last + at);
    if first - start > LONGEST_LINE {
        start = letter_at_or_before(source, first - LONGEST_LINE);
    }
    if end - last > LONGEST_LINE {
        end = letter_at_or_before(source, last + LONGEST_LINE);
    }
    let line = 1 + source.get(..start)?.bytes().filter(|byte| *byte == b'\n').count();
    let labels =
        inside.into_iter().map(|(span, label)| (span.start - start..span.end - start, label)).collect();
    Some(Excerpt { text: source.get(start..end)?, line, labels })
}

/// The span, moved inside the text and onto whole letters.
fn on_letters(source: &str, span: &Range<usize>) -> Range<usize> {
    let start = letter_at_or_before(source, span.start);
    let mut end = span.end.clamp(start, source.len());
    while end < source.len() && !source.is_char_boundary(end) {
        end += 1;
    }
    start..end
}

fn letter_at_or_before(source: &str, at: usize) -> usize {
    let mut at = at.min(source.len());
    while at > 0 && !source.is_char_boundary(at) {
        at -= 1;
    }
    at
}
