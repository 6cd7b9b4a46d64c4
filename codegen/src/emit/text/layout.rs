//! Lines: long ones are broken before operators.

/// Columns of a line.
const WIDTH: usize = 100;
/// Columns of one level.
const TAB: usize = 4;
/// What follows a broken line stands at most this far right of where the line began.
const DEEPEST: usize = 12;

/// Text under construction.
#[derive(Debug, Default)]
pub(super) struct Text(String);

impl Text {
    /// A line at a level; long ones are broken, and what follows stands below the first character after ` = `.
    pub(super) fn line(&mut self, level: usize, line: &str) {
        let indent = level * TAB;
        let hanging = line.find(" = ").map_or(TAB, |at| at + 3).min(DEEPEST);
        let mut rest = line;
        let mut column = indent;
        while column + rest.len() > WIDTH
            && let Some(at) = break_before(rest, WIDTH.saturating_sub(column))
            && let Some((line, next)) = rest.split_at_checked(at)
        {
            self.put(column, line.trim_end());
            rest = next.trim_start();
            column = indent + hanging;
        }
        self.put(column, rest);
    }

    /// Lines at a level.
    pub(super) fn lines(&mut self, level: usize, lines: &[String]) {
        for line in lines {
            self.line(level, line);
        }
    }

    /// Lines that are laid out already.
    pub(super) fn append(&mut self, lines: &str) {
        self.0.push_str(lines);
    }

    /// An empty line, unless there is one or the text is empty.
    pub(super) fn gap(&mut self) {
        if !self.0.is_empty() && !self.0.ends_with("\n\n") {
            self.0.push('\n');
        }
    }

    /// Lines of columns: all but the last one as wide as their widest entry.
    pub(super) fn columns<const N: usize>(&mut self, level: usize, rows: &[[String; N]]) {
        let mut widths = [0; N];
        for row in rows {
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = cell.len().max(*width);
            }
        }
        for row in rows {
            let cells: Vec<String> =
                row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}")).collect();
            self.put(level * TAB, cells.join("  ").trim_end());
        }
    }

    /// All of it.
    pub(super) fn into_string(self) -> String {
        self.0
    }

    fn put(&mut self, column: usize, line: &str) {
        if !line.is_empty() {
            self.0.push_str(&" ".repeat(column));
            self.0.push_str(line);
        }
        self.0.push('\n');
    }
}

/// Where a line of at most `width` columns is best broken: at the least deeply nested operator behind its first third,
/// else between factors, else wherever there is a space.
fn break_before(line: &str, width: usize) -> Option<usize> {
    let mut depth = 0_usize;
    let mut best: Option<(usize, usize)> = None;
    let mut fallback = None;
    let bytes = line.as_bytes();
    for (at, byte) in bytes.iter().enumerate() {
        if at > width && fallback.is_some() {
            break;
        }
        match byte {
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            b' ' if at > 0 => {
                let next = bytes.get(at + 1..at + 3);
                let operator = matches!(next, Some(b"+ " | b"- " | b"= " | b"/ "));
                let after_operator = matches!(bytes.get(at.wrapping_sub(1)), Some(b'+' | b'-' | b'=' | b'/'));
                if after_operator {
                    continue;
                }
                let rank = 2 * depth + if operator { 0 } else { 3 };
                if at > width / 3 && at <= width && best.is_none_or(|(least, _)| rank <= least) {
                    best = Some((rank, at));
                }
                fallback = Some(at);
            }
            _ => {}
        }
    }
    best.map(|(_, at)| at).or(fallback)
}

#[cfg(test)]
mod tests {
    use super::Text;

    #[test]
    fn long_lines_are_broken_at_the_outermost_operator() {
        let mut text = Text::default();
        let inner = "c1 (a2 c2 + a3 c23 + a4 c234 + a5 c2345)";
        text.line(1, &format!("px = {inner} + {inner} - {inner}"));
        let expected = format!("    px = {inner} + {inner}\n         - {inner}\n");
        assert_eq!(text.into_string(), expected);
    }

    #[test]
    fn nothing_is_lost() {
        let mut text = Text::default();
        let long = "word ".repeat(100) + &"x".repeat(300) + " + y";
        text.line(0, &long);
        let text = text.into_string();
        assert_eq!(text.split_whitespace().collect::<Vec<_>>(), long.split_whitespace().collect::<Vec<_>>());
        assert!(text.lines().all(|line| line.len() <= 100 || !line.trim().contains(' ')), "{text}");
    }
}
