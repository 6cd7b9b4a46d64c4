//! `dhc ik`

mod refusal;
mod solve;
pub(crate) mod target;
mod trace;

use crate::failure::{Failure, Refusal, Status};
use crate::json::Json;
use crate::list::List;
use crate::robot::Robot;
use crate::stream;
use crate::text::{clean, small};
use crate::units::Units;
use dh_codegen::model::JointKind;
use dh_codegen::verify::Level;
use dh_core::{FULL_POSE, Norm};
use solve::{Answer, Question};
use std::io::{self, Write};

/// Joint values that bring the tool to a target.
///
/// Solutions are those within limits and workspace rules, each in the winding nearest to --near (else to the middle of
/// the limits), the nearest first. With --all they are all that the geometry has, joints within half a turn of 0.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
#[allow(clippy::struct_excessive_bools, reason = "each is a flag")]
pub(crate) struct Arguments {
    /// A table file, or the name of a shipped table.
    table: String,
    /// Which inverse problem of the table; `pose` is the full pose.
    #[arg(long, value_name = "NAME", default_value = FULL_POSE)]
    problem: String,
    /// Every geometric solution, whatever the limits.
    #[arg(long)]
    all: bool,
    /// Joint values to be near to, in the table's units.
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true)]
    near: Option<List>,
    /// How much a joint's way counts in what is nearest: a factor a joint, of ways in rad and m; 1 for each if left out.
    #[arg(long, value_name = "W1,W2,...", allow_hyphen_values = true)]
    weights: Option<List>,
    /// How the ways of the joints make one: by the sum of their squares, or the greatest.
    #[arg(long, value_enum, default_value_t)]
    norm: NormName,
    /// Values of the joints that the problem leaves to the caller, in the table's units. Left out, a problem that leaves
    /// one is solved at many values of it.
    #[arg(long, value_name = "V1,...", allow_hyphen_values = true)]
    free: Option<List>,
    /// Of a spherical-roll-spherical arm, the arm angle in place of the free joint's value, in the table's units: by how much
    /// the elbow is turned about the line from shoulder to wrist, from the side to which the first axis points.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true, conflicts_with_all = ["free", "trace"])]
    arm_angle: Option<f64>,
    #[command(flatten)]
    target: target::Flags,
    /// Answer in JSON: solutions (q, errors in m and rad, whether q keeps all limits and rules, its branch and, where there is
    /// one, its arm angle) and error.
    #[arg(long, conflicts_with = "stdin")]
    pub(crate) json: bool,
    /// Print every step with its roots, and what becomes of each candidate.
    #[arg(long, conflicts_with_all = ["json", "stdin"])]
    trace: bool,
    /// Read a JSON object a line, with the target's keys and, where wanted, near and free; answer with one a line.
    #[arg(long)]
    stdin: bool,
}

/// [`Norm`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
enum NormName {
    #[default]
    Squares,
    Greatest,
}

const EXAMPLES: &str = "\
Targets, by the problem's `target` (dhc check lists them):
  pose                     --position X,Y,Z --quaternion X,Y,Z,W  (or --rpy R,P,Y)
  position, lookat         --position X,Y,Z
  position_direction, ray  --position X,Y,Z --direction X,Y,Z
  position_yaw             --position X,Y,Z --yaw ANGLE
  rotation                 --quaternion X,Y,Z,W  (or --rpy R,P,Y)
  direction                --direction X,Y,Z
  xy, xy_yaw               --position X,Y  (--yaw ANGLE)

Examples:
  dhc ik mycobot --problem tool_down --position 150,-100,70
  dhc ik panda --position 0.4,0,0.5 --rpy 3.14159,0,0 --free 0.8
  dhc ik iiwa14 --position 0.5,0,0.5 --rpy 180,0,0 --arm-angle 20
  dhc ik scara --problem place --position 0.4,0.2,0.3 --yaw 30 --json
  echo '{\"position\": [150, -100, 70]}' | dhc ik mycobot --problem tool_down --stdin";

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    if arguments.stdin && !arguments.target.is_empty() {
        return Err(Failure::Usage("with --stdin the targets are read, not given by flags".to_owned()));
    }
    let robot = Robot::load(&arguments.table, Level::Full)?;
    let program = robot.program()?;
    let arm = program.interpreter().map_err(|error| robot.unusable(&error))?;
    let near = arguments.near.as_ref().map(|List(near)| robot.units().joints_in_si(near)).transpose()?;
    let mut question = Question::new(&robot, &arm, &arguments.problem, near, arguments.all)?;
    let norm = match arguments.norm {
        NormName::Squares => Norm::Squares,
        NormName::Greatest => Norm::Greatest,
    };
    question.weigh(arguments.weights.as_ref().map(|List(weights)| weights.as_slice()), norm)?;
    let free = arguments.free.as_ref().map(|List(free)| free.as_slice());
    question.turn(arguments.arm_angle)?;
    if arguments.stdin {
        if arguments.free.is_some() {
            question.give(free)?;
        }
        return Ok(stream::run(out, |line| answer_line(&mut question, line, free))?);
    }
    question.give(free)?;
    let units = robot.units();
    let target = match arguments.target.target(question.kind(), units) {
        Ok(target) => target,
        Err(target::Trouble::Form(message)) => return Err(Failure::Usage(message)),
        Err(target::Trouble::Value(error)) => return failed(arguments, out, question.refusal(&error)),
    };
    if arguments.trace {
        question.is_given("--trace")?;
        let (steps, outcome) = question.trace(&target);
        return match outcome {
            Ok(answers) => {
                writeln!(out, "{steps}")?;
                list(&question, &answers, out)?;
                Ok(Status::Done)
            }
            Err(error) => {
                // A failure has nothing to say on stdout, but its steps are what was asked for.
                crate::failure::complain(steps.trim_end());
                Err(question.refusal_near(&error, &target).into())
            }
        };
    }
    match question.solve(&target) {
        Ok(answers) if arguments.json => writeln!(out, "{}", json(units, &answers))?,
        Ok(answers) => list(&question, &answers, out)?,
        Err(error) => return failed(arguments, out, question.refusal_near(&error, &target)),
    }
    Ok(Status::Done)
}

/// A refusal in the shape of the command's answers.
fn failed(arguments: &Arguments, out: &mut dyn Write, refusal: Refusal) -> Result<Status, Failure> {
    if !arguments.json {
        return Err(refusal.into());
    }
    writeln!(out, "{}", nothing(&refusal))?;
    Ok(Status::Wrong)
}

/// One line of a stream; only one that is malformed is an error.
fn answer_line(question: &mut Question<'_>, line: &[u8], given: Option<&[f64]>) -> Result<Json, Refusal> {
    let units = question.units();
    let malformed = |trouble| match trouble {
        target::Trouble::Form(message) => stream::malformed(message),
        target::Trouble::Value(error) => stream::malformed(error.to_string()),
    };
    let mut fields = target::fields(line, question.kind()).map_err(malformed)?;
    let free = target::take_free(&mut fields).map_err(malformed)?;
    let near = target::take_near(&mut fields).map_err(malformed)?;
    question.seek(near.as_deref()).map_err(|refusal| stream::malformed(refusal.message))?;
    question.give(free.as_deref().or(given)).map_err(|refusal| stream::malformed(refusal.message))?;
    let target = match target::read(&fields, question.kind(), units) {
        Ok(target) => target,
        Err(target::Trouble::Form(message)) => return Err(stream::malformed(message)),
        Err(target::Trouble::Value(error)) => return Ok(question.refusal(&error).answer()),
    };
    Ok(match question.solve(&target) {
        Ok(answers) => json(units, &answers),
        Err(error) => question.refusal_near(&error, &target).answer(),
    })
}

/// `{"solutions": [..], "error": null}`
fn json(units: Units<'_>, answers: &[Answer]) -> Json {
    let solution = |answer: &Answer| {
        let mut fields = vec![
            ("q", Json::numbers(units.joints(&answer.q))),
            ("position_error", answer.position_error.into()),
            ("rotation_error", answer.rotation_error.into()),
            ("within_limits", answer.within_limits.into()),
            ("branch", answer.branch.as_str().into()),
        ];
        if let Some(row) = answer.free {
            fields.push(("free", (row + 1).into()));
        }
        if let Some(angle) = answer.arm_angle {
            fields.push(("arm_angle", units.angle(angle).into()));
        }
        Json::Object(fields)
    };
    let solutions = answers.iter().map(solution).collect();
    Json::Object(vec![("solutions", Json::List(solutions)), ("error", Json::Null)])
}

/// `{"solutions": [], "error": {..}}`
fn nothing(refusal: &Refusal) -> Json {
    Json::Object(vec![("solutions", Json::List(Vec::new())), ("error", refusal.json())])
}

/// Writes solutions for people.
fn list(question: &Question<'_>, answers: &[Answer], out: &mut dyn Write) -> io::Result<()> {
    let units = question.units();
    let count = answers.len();
    let plural = if count == 1 { "" } else { "s" };
    let what = if question.all() { "in all" } else { "within limits and rules, the nearest first" };
    let swept = question.swept().map_or_else(String::new, |joint| {
        let values = dh_core::SWEEP_SAMPLES;
        format!(", of those at {values} values of {} (--free gives one)", clean(joint))
    });
    writeln!(out, "{}: {count} solution{plural} {what}{swept}\n", question.name())?;
    let joints: Vec<(JointKind, &str)> = (0..question.dof()).map(|index| units.joint(index)).collect();
    write!(out, "  ")?;
    for (kind, name) in &joints {
        write!(out, "{:>15}", format!("{} ({})", clean(name), units.name(*kind)))?;
    }
    let longest = answers.iter().map(|answer| answer.branch.len()).max().unwrap_or(0);
    // Wide enough for its heading.
    let width = if longest == 0 { 0 } else { longest.max("branch".len()) + 3 };
    writeln!(out, "{:width$}   errors (m, rad)", if longest == 0 { "" } else { "   branch" })?;
    for (place, answer) in answers.iter().enumerate() {
        write!(out, "{:2}", place + 1)?;
        for ((kind, _), value) in joints.iter().zip(units.joints(&answer.q)) {
            write!(out, "{:>15}", units.show(*kind, value))?;
        }
        if longest > 0 {
            write!(out, "   {:<1$}", answer.branch, width - 3)?;
        }
        write!(out, "   {}, {}", small(answer.position_error), small(answer.rotation_error))?;
        if let Some(angle) = answer.arm_angle {
            let angle = units.show(JointKind::Revolute, units.angle(angle));
            write!(out, "  arm angle {angle}")?;
        }
        if !answer.within_limits {
            write!(out, "  breaks limits or rules")?;
        }
        if let Some(row) = answer.free {
            write!(out, "  {} is free: one of its values", clean(question.row(row)))?;
        }
        writeln!(out)?;
    }
    Ok(())
}
