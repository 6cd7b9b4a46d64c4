//! `dhc check-pose`

use crate::failure::{Failure, Refusal, Status, complain};
use crate::json::Json;
use crate::list::List;
use crate::robot::Robot;
use crate::rule;
use dh_codegen::verify::Level;
use dh_core::Kinematics;
use std::io::Write;

/// Every limit and rule that joint values break; exit status 1 if there is one.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// A table file, or the name of a shipped table.
    table: String,
    /// Joint values in the table's units, base to tip.
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true)]
    joints: List,
    /// Answer in JSON: allowed, and a list of violations with their numbers.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  dhc check-pose mycobot --joints 0,-90,140,-50,0,0
  dhc check-pose mycobot --joints 100,-90,155,0,0,0 --json";

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let robot = Robot::load(&arguments.table, Level::Quick)?;
    let program = robot.program()?;
    let arm = program.interpreter().map_err(|error| robot.unusable(&error))?;
    let q = robot.units().joints_in_si(&arguments.joints.0)?;
    let violations: Vec<Refusal> = match arm.check(&q) {
        Ok(()) => Vec::new(),
        Err(violations) => {
            violations.iter().map(|violation| rule::violation(robot.model(), &violation)).collect()
        }
    };
    let status = if violations.is_empty() { Status::Done } else { Status::Wrong };
    if arguments.json {
        let list = violations.iter().map(Refusal::json).collect();
        let answer =
            Json::Object(vec![("allowed", violations.is_empty().into()), ("violations", Json::List(list))]);
        writeln!(out, "{answer}")?;
    } else if violations.is_empty() {
        writeln!(out, "allowed: no limit and no rule is broken")?;
    } else {
        let lines: Vec<String> = violations.iter().map(Refusal::to_string).collect();
        complain(&lines.join("\n"));
    }
    Ok(status)
}
