//! `dhc fk`

use crate::failure::{Failure, Refusal, Status};
use crate::json::Json;
use crate::list::List;
use crate::robot::Robot;
use crate::stream::{self, malformed};
use crate::text::exact;
use crate::units::{Units, fixed};
use dh_codegen::plan::FunctionKind;
use dh_codegen::plan::eval::{Event, Interpreter};
use dh_codegen::verify::Level;
use dh_core::{Frame, Kinematics};
use std::io::{self, Write};

/// The pose of the tool at given joint values.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// A table file, or the name of a shipped table.
    table: String,
    /// Joint values in the table's units, base to tip.
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true, required_unless_present = "stdin")]
    joints: Option<List>,
    /// Answer in JSON: position, quaternion (x, y, z, w, with w >= 0) and matrix.
    #[arg(long, conflicts_with = "stdin")]
    pub(crate) json: bool,
    /// Print every named step (s1, c234, ...) with its value.
    #[arg(long, conflicts_with_all = ["json", "stdin"])]
    trace: bool,
    /// Read a JSON array of joint values a line, and answer with one JSON object a line.
    #[arg(long, conflicts_with = "joints")]
    stdin: bool,
}

const EXAMPLES: &str = "\
Examples:
  dhc fk mycobot --joints -12.08,-51.17,-123.8,84.96,0,-12.08
  dhc fk mycobot --joints 0,-90,140,-50,0,0 --trace
  echo '[0, -90, 140, -50, 0, 0]' | dhc fk mycobot --stdin";

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let robot = Robot::load(&arguments.table, Level::Quick)?;
    let program = robot.program()?;
    let arm = program.interpreter().map_err(|error| robot.unusable(&error))?;
    let units = robot.units();
    let Some(List(joints)) = &arguments.joints else {
        return Ok(stream::run(out, |line| answer(&arm, units, line))?);
    };
    let q = units.joints_in_si(joints)?;
    let mut steps = Vec::new();
    let pose = if arguments.trace {
        arm.trace_fk(&q, |event| {
            if let Event::Value { name, value } = event {
                steps.push((name.to_owned(), value));
            }
        })
    } else {
        arm.fk(&q)
    };
    let pose = pose.map_err(|error| Refusal::new("length", error.to_string()))?;
    if arguments.json {
        writeln!(out, "{}", units.pose(&pose))?;
        return Ok(Status::Done);
    }
    if arguments.trace {
        write!(out, "{}", trace(&robot, joints, &steps))?;
    }
    write_pose(units, &pose, out)?;
    Ok(Status::Done)
}

/// One line of a stream.
fn answer(arm: &Interpreter<'_>, units: Units<'_>, line: &[u8]) -> Result<Json, Refusal> {
    let values: Vec<f64> = serde_json::from_slice(line)
        .map_err(|error| malformed(format!("the line is not an array of joint values: {error}")))?;
    let q = units.joints_in_si(&values)?;
    let pose = arm.fk(&q).map_err(|error| Refusal::new("length", error.to_string()))?;
    Ok(units.pose(&pose))
}

/// The named steps in order, with the joint values as they were given before them; lengths in the table's unit.
fn trace(robot: &Robot, joints: &[f64], steps: &[(String, f64)]) -> String {
    let (units, plan) = (robot.units(), &robot.output.plan);
    let function = plan.functions.iter().find(|function| function.kind == FunctionKind::Fk);
    let dimensions = function.map(|function| function.dimensions(robot.model(), &plan.constants));
    let dimension = |name: &str| {
        let place = function.and_then(|function| function.values.iter().position(|known| known == name))?;
        dimensions.as_ref()?.get(place).copied()
    };
    let inputs = function.into_iter().flat_map(|function| function.values.iter().take(function.inputs));
    let mut lines: Vec<(String, f64, &str)> = Vec::new();
    for ((index, name), value) in inputs.enumerate().zip(joints) {
        lines.push((name.clone(), *value, units.name(units.joint(index).0)));
    }
    for (name, value) in steps {
        let power = dimension(name).unwrap_or(0);
        let unit = if power == 0 { "" } else { units.length_name() };
        lines.push((name.clone(), units.power(*value, power), unit));
    }
    let width = lines.iter().map(|(name, ..)| name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (name, value, unit) in lines {
        text += format!("{name:width$} = {} {unit}", exact(value)).trim_end();
        text.push('\n');
    }
    text.push('\n');
    text
}

/// Writes the pose for people.
fn write_pose(units: Units<'_>, pose: &Frame, out: &mut dyn Write) -> io::Result<()> {
    let position = units.point(pose.translation).map(|x| units.show_length(x));
    let quaternion = pose.quaternion().map(|x| fixed(x, 9));
    writeln!(out, "position    {} {}", position.join("  "), units.length_name())?;
    writeln!(out, "quaternion  {} (x y z w)", quaternion.join("  "))?;
    let width = position.iter().map(String::len).max().unwrap_or(0);
    for (place, (row, p)) in pose.rotation.iter().zip(&position).enumerate() {
        let [x, y, z] = row.map(|x| fixed(x, 9));
        let title = if place == 0 { "matrix" } else { "" };
        writeln!(out, "{title:10}{x:>14}{y:>14}{z:>14}  {p:>width$}")?;
    }
    Ok(())
}
