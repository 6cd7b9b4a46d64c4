//! `dhc generate`

use crate::failure::{Failure, Refusal, Status};
use crate::robot::Robot;
use clap::ValueEnum;
use dh_codegen::emit::rust;
use dh_codegen::verify::Level;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Code that computes the kinematics of a robot, with comments.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// A table file, or the name of a shipped table.
    table: String,
    /// The language.
    #[arg(long, value_enum, default_value_t = Language::Rust)]
    lang: Language,
    /// Write to this file instead of stdout.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write nothing, and fail if the file is not what would be written.
    #[arg(long, requires = "output")]
    check: bool,
    /// Name of the struct; left out, it is made from the robot's.
    #[arg(long, value_name = "STRUCT", value_parser = identifier)]
    name: Option<String>,
}

const EXAMPLES: &str = "\
Examples:
  dhc generate mycobot --lang rust
  dhc generate robots/arm.toml --lang rust --name Arm -o src/arm.rs
  dhc generate robots/arm.toml --lang rust --name Arm -o src/arm.rs --check";

/// A language that code is generated in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Language {
    /// Rust that needs the crate `dh-runtime`.
    Rust,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let robot = Robot::load(&arguments.table, Level::Full)?;
    robot.warn();
    let options = rust::Options {
        name: arguments.name.clone(),
        table: portable(&robot.source.name_shown),
        ..rust::Options::default()
    };
    let text = match arguments.lang {
        Language::Rust => rust::print(robot.model(), &robot.output.plan, &options),
    };
    let Some(path) = &arguments.output else {
        out.write_all(text.as_bytes())?;
        return Ok(Status::Done);
    };
    if arguments.check {
        return fresh(path, &text, arguments);
    }
    std::fs::write(path, text)
        .map_err(|error| Refusal::new("output", format!("{} cannot be written: {error}", path.display())))?;
    Ok(Status::Done)
}

/// Whether a file is what would be written.
fn fresh(path: &Path, text: &str, arguments: &Arguments) -> Result<Status, Failure> {
    let shown = path.display();
    let message = match std::fs::read(path) {
        Ok(bytes) if bytes == text.as_bytes() => return Ok(Status::Done),
        Ok(_) => format!("{shown} is not what its table gives"),
        Err(error) => format!("{shown} cannot be read: {error}"),
    };
    let name = arguments.name.as_ref().map_or_else(String::new, |name| format!(" --name {name}"));
    let command = format!("dhc generate {} --lang rust{name} -o {shown}", arguments.table);
    Err(Refusal::new("stale", message).help(format!("run `{command}`")).into())
}

/// The table's name without the folders of this machine.
fn portable(name: &str) -> String {
    let path = Path::new(name);
    match path.file_name() {
        Some(file) if path.is_absolute() => file.to_string_lossy().into_owned(),
        _ => name.to_owned(),
    }
}

/// A name that Rust takes for a type.
fn identifier(text: &str) -> Result<String, String> {
    const KEYWORDS: [&str; 52] = [
        "Self", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate",
        "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in",
        "let", "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return",
        "self", "static", "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe", "unsized",
        "use", "virtual", "where", "while", "yield",
    ];
    let letters = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let first = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if letters && first && text != "_" && !KEYWORDS.contains(&text) {
        Ok(text.to_owned())
    } else {
        Err("write a name that Rust takes for a struct, such as `MyArm`".to_owned())
    }
}
