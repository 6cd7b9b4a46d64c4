//! `dhc equations`

use crate::failure::{Failure, Refusal, Status};
use crate::robot::Robot;
use clap::ValueEnum;
use dh_codegen::emit::text;
use dh_codegen::plan::FunctionKind;
use dh_codegen::verify::Level;
use std::io::Write;

/// The equations of a robot, expanded, in its parameters d1, a2, ... or with their numbers.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// A table file, or the name of a shipped table.
    table: String,
    /// Which equations.
    #[arg(long, value_enum, default_value_t = Part::All)]
    part: Part,
    /// How they are written.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// Put in the numbers of the table, in its units.
    #[arg(long)]
    numeric: bool,
}

const EXAMPLES: &str = "\
Examples:
  dhc equations mycobot --part fk
  dhc equations mycobot --part ik --numeric";

/// Which equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// The pose of the tool.
    Fk,
    /// The geometric Jacobian.
    Jacobian,
    /// The derivations of all inverse problems that are solved.
    Ik,
    /// All of these.
    All,
}

/// How equations are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Plain text.
    Text,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let robot = Robot::load(&arguments.table, Level::Quick)?;
    let functions = &robot.output.plan.functions;
    let solved = functions.iter().any(|function| matches!(function.kind, FunctionKind::Inverse(_)));
    if arguments.part == Part::Ik && !solved {
        let message = format!("no inverse problem of {} is solved", robot.source.name_shown);
        let help = format!("`dhc check {}` says why", robot.source.name_shown);
        return Err(Refusal::new("no_equations", message).help(help).into());
    }
    let part = match arguments.part {
        Part::Fk => text::Part::ForwardKinematics,
        Part::Jacobian => text::Part::Jacobian,
        Part::Ik => text::Part::InverseKinematics,
        Part::All => text::Part::All,
    };
    let options = text::Options { part, numeric: arguments.numeric };
    match arguments.format {
        Format::Text => write!(out, "{}", text::print(robot.model(), &robot.output.plan, &options))?,
    }
    Ok(Status::Done)
}
