//! Text for people.

/// A text of the table's on one line.
pub(crate) fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Lines of columns, each as wide as its widest entry but for the last.
pub(crate) fn columns<const N: usize>(indent: &str, rows: &[[String; N]]) -> String {
    let mut widths = [0; N];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().max(*width);
        }
    }
    let mut text = String::new();
    for row in rows {
        let cells: Vec<String> =
            row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}")).collect();
        text += format!("{indent}{}", cells.join("  ")).trim_end();
        text.push('\n');
    }
    text
}

/// The size of an error.
pub(crate) fn small(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}

/// All digits of a number, and an exponent where it is far from 1.
pub(crate) fn exact(value: f64) -> String {
    // Adding 0 makes a positive zero of a negative one.
    let value = value + 0.0;
    let far = value != 0.0 && !(1e-5..1e16).contains(&value.abs());
    if far { format!("{value:e}") } else { format!("{value}") }
}
