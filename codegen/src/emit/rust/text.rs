//! Lines of generated text.

/// Columns of a line.
const WIDTH: usize = 100;

/// Text under way.
#[derive(Debug, Default)]
pub(super) struct Text {
    text: String,
    indent: usize,
}

impl Text {
    pub(super) fn indented(levels: usize) -> Self {
        Self { text: String::new(), indent: 4 * levels }
    }

    /// Columns before the next line.
    pub(super) fn indent(&self) -> usize {
        self.indent
    }

    /// One line (or none, where `line` is empty).
    pub(super) fn line(&mut self, line: impl AsRef<str>) {
        let line = line.as_ref();
        if !line.is_empty() {
            self.text.push_str(&" ".repeat(self.indent));
            self.text.push_str(line);
        }
        self.text.push('\n');
    }

    /// A line that opens a block.
    pub(super) fn open(&mut self, line: impl AsRef<str>) {
        self.line(line);
        self.indent += 4;
    }

    /// A line that closes a block.
    pub(super) fn close(&mut self, line: impl AsRef<str>) {
        self.indent = self.indent.saturating_sub(4);
        self.line(line);
    }

    /// Whole lines that bring their own indent.
    pub(super) fn append(&mut self, lines: &str) {
        self.text.push_str(lines);
    }

    /// The same without the end of the last line.
    pub(super) fn laid_out(&mut self, lines: &str) {
        self.text.push_str(lines);
        self.text.push('\n');
    }

    /// An empty line, unless one is there, or a block has just opened.
    pub(super) fn gap(&mut self) {
        if !(self.text.is_empty() || self.text.ends_with("\n\n") || self.text.ends_with("{\n")) {
            self.text.push('\n');
        }
    }

    /// A paragraph behind `marker` (`//`, `///`) on every line.
    pub(super) fn paragraph(&mut self, marker: &str, paragraph: &str) {
        let room = WIDTH.saturating_sub(self.indent + marker.len() + 1).max(40);
        for line in wrapped(&clean(paragraph), room) {
            self.line(format!("{marker} {line}").trim_end());
        }
    }

    /// Documentation: Markdown, a paragraph each.
    pub(super) fn documentation<P: AsRef<str>>(&mut self, paragraphs: impl IntoIterator<Item = P>) {
        for (i, paragraph) in paragraphs.into_iter().enumerate() {
            if i > 0 {
                self.line("///");
            }
            let paragraph = paragraph.as_ref();
            if paragraph.starts_with('|') || paragraph.starts_with("```") {
                // Tables and equations are not wrapped.
                paragraph.lines().for_each(|row| self.line(format!("/// {}", clean(row))));
            } else {
                paragraph.lines().for_each(|line| self.paragraph("///", line));
            }
        }
    }

    /// An attribute that allows lints, with its reason.
    pub(super) fn allow(&mut self, lints: &[&str], reason: &str) {
        let reason = format!("reason = \"{reason}\"");
        let arguments = format!("{}, {reason}", lints.join(", "));
        // rustfmt keeps up to 70 columns of arguments on one line.
        if arguments.len() <= 70 {
            return self.line(format!("#[allow({arguments})]"));
        }
        self.open("#[allow(");
        for lint in lints {
            self.line(format!("{lint},"));
        }
        self.line(reason);
        self.close(")]");
    }

    /// Opens a function: its head, parameters and result on one line, or a parameter a line.
    pub(super) fn signature(&mut self, head: &str, parameters: &[String], result: &str) {
        let line = format!("{head}({}) -> {result} {{", parameters.join(", "));
        if self.indent + line.len() <= WIDTH {
            return self.open(line);
        }
        self.open(format!("{head}("));
        for parameter in parameters {
            self.line(format!("{parameter},"));
        }
        self.close(format!(") -> {result} {{"));
        self.indent += 4;
    }

    pub(super) fn into_string(self) -> String {
        self.text
    }
}

/// `text` on one line, without characters that end a comment or reorder what is shown.
pub(super) fn clean(text: &str) -> String {
    let hidden =
        |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{2028}' | '\u{2029}');
    text.chars().filter(|c| !hidden(*c)).map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// User's words inside Markdown, as they are.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for (i, word) in clean(text).split_whitespace().enumerate() {
        if i > 0 {
            escaped.push(' ');
        }
        if word.starts_with("https://") || word.starts_with("http://") {
            let end = word.trim_end_matches(|c: char| ".,;:)".contains(c)).len();
            let (address, rest) = word.split_at(end);
            escaped.extend(["<", &address.replace(['<', '>'], ""), ">", rest]);
            continue;
        }
        for c in word.chars() {
            if "\\`*_[]<>|#".contains(c) {
                escaped.push('\\');
            }
            escaped.push(c);
        }
    }
    escaped
}

/// Words in lines of at most `room` columns, where words allow it.
pub(super) fn wrapped(text: &str, room: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let Some(line) = lines.last_mut() else { break };
        if line.is_empty() {
            line.push_str(word);
        } else if line.chars().count() + 1 + word.chars().count() <= room {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::{Text, escaped};

    #[test]
    fn what_a_user_wrote_stays_text() {
        assert_eq!(escaped("a [b] *c*\nhttps://x.org/a_b."), "a \\[b\\] \\*c\\* <https://x.org/a_b>.");
        let mut text = Text::default();
        text.paragraph("//", "one\r\ntwo");
        assert_eq!(text.into_string(), "// one two\n");
    }

    #[test]
    fn paragraphs_wrap() {
        let mut text = Text::default();
        text.documentation(["word ".repeat(30), "```\nx\n```".to_owned()]);
        let text = text.into_string();
        assert!(text.lines().all(|line| line.len() <= 100 && line.starts_with("///")), "{text}");
        assert!(text.ends_with("///\n/// ```\n/// x\n/// ```\n"), "{text}");
    }
}
