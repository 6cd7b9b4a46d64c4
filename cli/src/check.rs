//! `dhc check`

mod joints;
mod problems;
mod verified;

use crate::failure::{Failure, Status};
use crate::robot::Robot;
use crate::text::{clean, columns};
use crate::units::fixed;
use dh_codegen::plan::{Counts, FunctionKind};
use dh_codegen::verify::Level;
use std::io::Write;

/// Validates tables, and says what is known about each robot.
///
/// Prints its joints and axes, how every inverse problem is solved, what was verified with which figures, the reach,
/// and what a pose costs. Exit status 1 if a table has errors, or a problem of it has no function.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Table files, or names of shipped tables.
    #[arg(required = true, value_name = "TABLE")]
    tables: Vec<String>,
    /// How many random poses every function is verified at, with more of the special ones too.
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    poses: Option<u32>,
}

const EXAMPLES: &str = "\
Examples:
  dhc check mycobot
  dhc check robots/*.toml
  dhc check --poses 100000 ur5";

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let mut status = Status::Done;
    let mut separator = "";
    let level = arguments.poses.map_or(Level::Full, Level::Poses);
    for table in &arguments.tables {
        match Robot::load(table, level) {
            Ok(robot) => {
                robot.warn();
                if !robot.has_all() {
                    status = Status::Wrong;
                }
                write!(out, "{separator}{}", report(&robot))?;
                out.flush()?;
                separator = "\n";
            }
            Err(failure @ Failure::Table { .. }) => status = failure.report(false, out),
            Err(failure) => return Err(failure),
        }
    }
    Ok(status)
}

/// All that is said about one robot.
fn report(robot: &Robot) -> String {
    let (model, units) = (robot.model(), robot.units());
    let geometry = model.geometry();
    let reach = fixed(units.length(model.reach()), if units.length_name() == "m" { 4 } else { 1 });
    let fields = [
        ["class", &geometry.class()],
        ["joints", &joints::written(model)],
        ["reach", &format!("{reach} {}, or less", units.length_name())],
        ["pose", &operations(robot, &FunctionKind::Fk)],
        ["and Jacobian", &operations(robot, &FunctionKind::FkJacobian)],
    ];
    let mut text = format!("{} ({})\n", clean(&model.name), robot.source.name_shown);
    text += &columns("  ", &fields.map(|field| field.map(str::to_owned)));
    let notes = geometry.near_misses().into_iter().map(|near_miss| ["  note", &near_miss].join(": ") + "\n");
    text.extend(notes);
    text += &problems::written(robot);
    text += &verified::written(robot);
    text
}

/// What a function costs.
fn operations(robot: &Robot, kind: &FunctionKind) -> String {
    let function = robot.output.plan.functions.iter().find(|function| function.kind == *kind);
    let Some(function) = function else {
        return "left out".to_owned();
    };
    let Counts { mul, add, sincos, angle_add } = function.counts;
    let plural = |count: usize, noun: &str| format!("{count} {noun}{}", if count == 1 { "" } else { "s" });
    let arguments = match angle_add {
        0 => String::new(),
        adds => format!(" (and {} in their arguments)", plural(adds, "addition")),
    };
    format!(
        "{}, {}, {}{arguments}",
        plural(mul, "multiplication"),
        plural(add, "addition"),
        plural(sincos, "sine-cosine pair")
    )
}
