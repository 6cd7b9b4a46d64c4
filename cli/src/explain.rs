//! `dhc explain`

use crate::failure::{Failure, Refusal, Status};
use dh_codegen::diagnostic::{catalogue, nearest};
use std::io::{self, Write};

/// What the code of a diagnostic means; without a code, all of them.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The word in brackets: `rounded-angle` of `warning[rounded-angle]`.
    code: Option<String>,
}

const EXAMPLES: &str = "\
Example:
  dhc explain rounded-angle";

/// Columns of a line.
const WIDTH: usize = 88;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let Some(code) = &arguments.code else {
        for (place, (code, text)) in catalogue::CATALOGUE.iter().enumerate() {
            let gap = if place == 0 { "" } else { "\n" };
            writeln!(out, "{gap}{code}")?;
            fill(text, "    ", out)?;
        }
        return Ok(Status::Done);
    };
    // As it stands in a message, brackets and all.
    let bare = code.split_once('[').map_or(code.as_str(), |(_, rest)| rest.trim_end_matches(']'));
    match catalogue::explain(bare) {
        Some(text) => {
            fill(text, "", out)?;
            Ok(Status::Done)
        }
        None => Err(unknown(bare).into()),
    }
}

fn unknown(code: &str) -> Refusal {
    let shown = dh_codegen::diagnostic::shortened(code);
    let refusal = Refusal::new("unknown_code", format!("there is no diagnostic of the code `{shown}`"));
    refusal.help(match nearest(code, catalogue::CATALOGUE.iter().map(|(known, _)| *known)) {
        Some(near) => format!("there is `{near}`; `dhc explain` lists all"),
        None => "`dhc explain` lists all".to_owned(),
    })
}

/// Writes a text in lines.
fn fill(text: &str, indent: &str, out: &mut dyn Write) -> io::Result<()> {
    let mut line = String::new();
    for word in text.split(' ') {
        if !line.is_empty() && indent.len() + line.len() + 1 + word.len() > WIDTH {
            writeln!(out, "{indent}{line}")?;
            line.clear();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    writeln!(out, "{indent}{line}")
}
