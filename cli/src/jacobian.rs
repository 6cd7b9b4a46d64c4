//! `dhc jacobian`

use crate::failure::{Failure, Refusal, Status};
use crate::json::Json;
use crate::list::List;
use crate::robot::Robot;
use crate::units::fixed;
use dh_codegen::verify::{Level, singular_values};
use dh_core::Kinematics;
use std::io::Write;

/// The geometric Jacobian at given joint values, in metres and radians whatever the table's units.
///
/// Rows are vx vy vz wx wy wz of the tool in base axes, a column a joint, per radian or metre of the joint. The
/// manipulability is the product of the singular values.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// A table file, or the name of a shipped table.
    table: String,
    /// Joint values in the table's units, base to tip.
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true)]
    joints: List,
    /// Answer in JSON: jacobian (by rows), `singular_values` and manipulability.
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  dhc jacobian mycobot --joints -12.08,-51.17,-123.8,84.96,0,-12.08
  dhc jacobian ur5 --joints 0,-1.57,1.57,0,1.57,0 --json";

const ROWS: [(&str, &str); 6] =
    [("vx", "m"), ("vy", "m"), ("vz", "m"), ("wx", "rad"), ("wy", "rad"), ("wz", "rad")];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let robot = Robot::load(&arguments.table, Level::Quick)?;
    let program = robot.program()?;
    let arm = program.interpreter().map_err(|error| robot.unusable(&error))?;
    let q = robot.units().joints_in_si(&arguments.joints.0)?;
    let mut columns = vec![[0.0; 6]; q.len()];
    arm.jacobian_into(&q, &mut columns).map_err(|error| Refusal::new("length", error.to_string()))?;
    let singular = singular_values(columns.iter().map(|column| column.to_vec()).collect());
    let singular: Vec<f64> = singular.into_iter().take(6).collect();
    let manipulability: f64 = singular.iter().product();
    let row = |row: usize| columns.iter().filter_map(move |column| column.get(row).copied());
    if arguments.json {
        let rows = (0..6).map(|place| Json::numbers(row(place))).collect();
        let answer = Json::Object(vec![
            ("jacobian", Json::List(rows)),
            ("singular_values", Json::numbers(singular)),
            ("manipulability", manipulability.into()),
        ]);
        writeln!(out, "{answer}")?;
        return Ok(Status::Done);
    }
    write!(out, "{:10}", "")?;
    for index in 0..q.len() {
        write!(out, "{:>14}", robot.units().joint(index).1)?;
    }
    writeln!(out, "   (m and rad, per rad or m of the joint)")?;
    for (place, (name, unit)) in ROWS.iter().enumerate() {
        write!(out, "{name:3}{unit:7}")?;
        row(place).try_for_each(|value| write!(out, "{:>14}", fixed(value, 9)))?;
        writeln!(out)?;
    }
    let values: Vec<String> = singular.iter().map(|value| fixed(*value, 9)).collect();
    writeln!(out, "\nsingular values  {}", values.join("  "))?;
    writeln!(out, "manipulability   {manipulability:.9e}")?;
    Ok(Status::Done)
}
