//! What is wrong with a table, where, and what to write instead.
//!
//! Stages collect [`Diagnostic`]s and go on, so that one run reports every mistake of a file. Macro and command line
//! draw them with the one renderer here.

use std::collections::HashSet;
use std::ops::Range;

// Codes and what they mean.
pub mod catalogue;
mod render;

pub use render::Style;

/// Whether a table can be used in spite of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Severity {
    /// The table is refused.
    Error,
    /// The table is taken as written.
    Warning,
}

/// A place in the table's text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Label {
    /// Byte range.
    pub span: Range<usize>,
    /// What is said about it; may be empty.
    pub text: String,
    /// The place that the message speaks of, rather than one that explains it.
    pub primary: bool,
}

/// One mistake, or one doubt.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Key into [`catalogue::CATALOGUE`].
    pub code: &'static str,
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// Where, the primary one first.
    pub labels: Vec<Label>,
    /// What to write instead.
    pub help: Vec<String>,
}

impl Diagnostic {
    /// An error with a code of the catalogue.
    pub fn error(code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            severity: Severity::Error,
            code,
            message: message.into(),
            labels: Vec::new(),
            help: Vec::new(),
        }
    }

    /// A warning with a code of the catalogue.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Diagnostic {
        Diagnostic { severity: Severity::Warning, ..Diagnostic::error(code, message) }
    }

    /// Underlines the place that the message speaks of.
    pub fn at(mut self, span: Range<usize>, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label { span, text: text.into(), primary: true });
        self
    }

    /// Underlines a place that explains it.
    pub fn beside(mut self, span: Range<usize>, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label { span, text: text.into(), primary: false });
        self
    }

    /// Says what to write instead.
    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help.push(text.into());
        self
    }

    /// Where it is sorted to.
    fn position(&self) -> usize {
        self.labels.first().map_or(0, |label| label.span.start)
    }
}

/// The diagnostics of one table, collected in any order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Diagnostics {
    items: Vec<Diagnostic>,
    seen: HashSet<Diagnostic>,
}

impl Diagnostics {
    /// None so far.
    pub fn new() -> Diagnostics {
        Diagnostics::default()
    }

    /// Adds one, unless it is there already.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if self.seen.insert(diagnostic.clone()) {
            self.items.push(diagnostic);
        }
    }

    /// Whether the table is refused.
    pub fn has_errors(&self) -> bool {
        self.errors() > 0
    }

    /// How many errors there are.
    pub fn errors(&self) -> usize {
        self.items.iter().filter(|item| item.severity == Severity::Error).count()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// In the order of the text; at one place errors first.
    pub fn sorted(&self) -> Vec<&Diagnostic> {
        let mut sorted: Vec<&Diagnostic> = self.items.iter().collect();
        sorted.sort_by_key(|item| (item.position(), item.severity));
        sorted
    }
}

/// A text of the user's, short enough to be part of a message.
pub fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    let clean = |c: char| if c.is_control() { ' ' } else { c };
    if text.chars().count() <= LONGEST {
        return text.chars().map(clean).collect();
    }
    let start: String = text.chars().take(LONGEST - 3).map(clean).collect();
    format!("{start}...")
}

/// The nearest of some names to what was written, if any is near: a few letters are wrong, or the end is missing.
pub fn nearest<'a>(written: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LONGEST: usize = 100;
    if written.len() > LONGEST {
        return None;
    }
    let lower = written.to_lowercase();
    let mut best: Option<(usize, &str)> = None;
    for name in names {
        let lower_name = name.to_lowercase();
        let letters = name.chars().count();
        let distance = strsim::damerau_levenshtein(&lower, &lower_name);
        // Of words of one or two letters each is near to any other.
        let near = distance == 0
            || (letters > 2 && distance <= (letters / 3).max(1) && distance < lower.chars().count());
        let begun = lower.len() > 2 && lower_name.starts_with(&lower);
        if (near || begun) && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, name));
        }
    }
    best.map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use expect_test::expect;

    const TEXT: &str = "[robot]\nname = \"x\"\nnmae = 3\n\n[[joint]]\nd = 1\nlimits = [\n  2,\n  1,\n]\n";

    fn sample() -> Diagnostics {
        let mut diagnostics = Diagnostics::new();
        diagnostics.push(
            Diagnostic::error(catalogue::LIMITS_ORDER, "the lower limit is above the upper one")
                .at(54..67, "2 > 1")
                .beside(29..38, "of this joint")
                .help("write `limits = [1, 2]`"),
        );
        diagnostics.push(
            Diagnostic::warning(catalogue::UNKNOWN_KEY, "unknown key `nmae`")
                .at(19..23, "")
                .help("`name` is near"),
        );
        diagnostics
    }

    #[test]
    fn drawn_in_the_order_of_the_text() {
        expect![[r"
            warning[unknown-key]: unknown key `nmae`
             --> robots/x.toml:3:1
              |
            3 | nmae = 3
              | ^^^^
              |
              = help: `name` is near

            error[limits-order]: the lower limit is above the upper one
              --> robots/x.toml:7:10
               |
             5 |   [[joint]]
               |   --------- of this joint
             6 |   d = 1
             7 |   limits = [
               |  __________^
             8 | |   2,
             9 | |   1,
            10 | | ]
               | |_^ 2 > 1
               |
               = help: write `limits = [1, 2]`"]]
        .assert_eq(&sample().render(TEXT, "robots/x.toml", Style::Plain));
    }

    #[test]
    fn a_macro_leaves_the_level_to_rustc() {
        expect![[r"
            warning: unknown key `nmae`
             --> x.toml:3:1
              |
            3 | nmae = 3
              | ^^^^
              |
              = help: `name` is near

            the lower limit is above the upper one
              --> x.toml:7:10
               |
             5 |   [[joint]]
               |   --------- of this joint
             6 |   d = 1
             7 |   limits = [
               |  __________^
             8 | |   2,
             9 | |   1,
            10 | | ]
               | |_^ 2 > 1
               |
               = help: write `limits = [1, 2]`"]]
        .assert_eq(&sample().render(TEXT, "x.toml", Style::WithinError));
    }

    #[test]
    fn colours_do_not_change_the_text() {
        let styled = sample().render(TEXT, "x.toml", Style::Coloured);
        assert!(styled.contains("\u{1b}["));
        assert!(styled.contains("nmae"));
    }

    #[test]
    fn the_same_is_said_once() {
        let mut diagnostics = sample();
        let before = diagnostics.len();
        for item in sample().sorted() {
            diagnostics.push(item.clone());
        }
        assert_eq!(diagnostics.len(), before);
        assert!(diagnostics.has_errors());
    }

    #[test]
    fn places_outside_the_text_are_drawn_at_its_end() {
        let mut diagnostics = Diagnostics::new();
        diagnostics.push(Diagnostic::error(catalogue::SYNTAX, "unexpected end").at(900..1000, "here"));
        diagnostics.push(Diagnostic::error(catalogue::SYNTAX, "inside a letter").at(1..2, ""));
        let drawn = diagnostics.render("é = é", "x.toml", Style::Plain);
        assert!(drawn.contains("x.toml:1:"), "{drawn}");
        assert!(!Diagnostics::render(&diagnostics, "", "x.toml", Style::Plain).is_empty());
    }
}
