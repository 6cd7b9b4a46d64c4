//! `dhc move`

use crate::arm::{self, Arm, DeviceFlags, Use, Watcher};
use crate::failure::{Failure, Status};
use crate::ik::target::{Flags, Trouble};
use crate::list::List;
use dh_core::{FULL_POSE, Target};
use dh_drivers::motion::Move;
use std::io::Write;

/// Moves an arm: to joint values, to a named pose, or to a target of one of the table's inverse problems.
///
/// The whole way is checked before anything is sent: limits, workspace rules (of the tool point, and of nothing else),
/// speeds, and with --line that the solutions neither end nor jump nor come near a singularity. Ctrl-C stops the arm;
/// it holds. It holds, too, when the command is over.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
#[allow(clippy::struct_excessive_bools, reason = "flags of a command line, each independent of the others")]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceFlags,
    /// Joint values to move to, in the table's units.
    #[arg(long, value_name = "Q1,Q2,...", allow_hyphen_values = true)]
    joints: Option<List>,
    /// A pose of the table to move to.
    #[arg(long, value_name = "NAME", conflicts_with = "joints")]
    pose: Option<String>,
    /// Which inverse problem the target is one of; `pose` is the full pose.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["joints", "pose"])]
    problem: Option<String>,
    #[command(flatten)]
    target: Flags,
    /// With the hand in a straight line.
    #[arg(long)]
    line: bool,
    #[command(flatten)]
    pace: Pace,
    /// Check only: nothing is sent that moves the arm.
    #[arg(long)]
    dry_run: bool,
    /// Cut the torque at the end, wherever that is. Without it the arm holds.
    #[arg(long)]
    release: bool,
    /// Answer in JSON: what `dhc read` says at the end.
    #[arg(long)]
    pub(crate) json: bool,
}

/// How fast.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct Pace {
    /// The part of the greatest velocity to move at, in percent.
    #[arg(long, value_name = "PERCENT", default_value_t = 100.0, value_parser = percent, allow_negative_numbers = true)]
    pub(crate) percent: f64,
    /// Speed along lines, in the table's unit of length per second; refused where the joints can't follow.
    #[arg(long, value_name = "SPEED", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) speed: Option<f64>,
}

/// A part of the greatest velocity, in percent.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn percent(word: &str) -> Result<f64, String> {
    positive(word)
        .ok()
        .filter(|percent| *percent <= 100.0)
        .ok_or_else(|| format!("`{word}` is no percentage: write a number above 0, and at most 100"))
}

/// A speed.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn positive(word: &str) -> Result<f64, String> {
    let number = word.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| format!("`{word}` is no number above 0"))
}

impl Pace {
    /// The move at this pace.
    pub(crate) fn of(self, asked: Move, arm: &Arm<'_>) -> Move {
        let asked = asked.slowed(self.percent / 100.0);
        match self.speed {
            Some(speed) => asked.speed(arm.units().metres(speed)),
            None => asked,
        }
    }
}

const EXAMPLES: &str = "\
Examples:
  dhc move mycobot --port /dev/ttyAMA0 --joints 0,-90,140,-50,0,0 --percent 30
  dhc move mycobot --port /dev/ttyAMA0 --pose rest --release
  dhc move mycobot --port /dev/ttyAMA0 --problem tool_down --position 150,-100,70
  dhc move planar2r --port /dev/ttyUSB0 --problem xy --position 0.2,0.1 --line --speed 0.05";

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let by_target = arguments.joints.is_none() && arguments.pose.is_none();
    if !by_target && (arguments.line || !arguments.target.is_empty()) {
        return Err(Failure::Usage(
            "a target and --line go with --problem, not with --joints or --pose".to_owned(),
        ));
    }
    if by_target && arguments.target.is_empty() {
        return Err(Failure::Usage(
            "where to? Give --joints, --pose, or a target (--position ...)".to_owned(),
        ));
    }
    arm::with(&arguments.device, Use::Move, |arm| {
        let asked = arguments.pace.of(asked(arguments, arm)?, arm);
        if arguments.dry_run {
            let checked = arm.plan(&[asked])?;
            writeln!(out, "allowed: it would take about {:.1} s", checked.duration())?;
            return Ok(Status::Done);
        }
        arm.go(&[asked], &mut Watcher::new(&mut |_, _, _| {}))?;
        arm.read()?;
        arm.tell(arguments.json, out)?;
        if arguments.release {
            arm.release(true)?;
        }
        Ok(Status::Done)
    })
}

fn asked(arguments: &Arguments, arm: &Arm<'_>) -> Result<Move, Failure> {
    if let Some(List(joints)) = &arguments.joints {
        return Ok(Move::joints(&arm.units().joints_in_si(joints)?));
    }
    if let Some(pose) = &arguments.pose {
        return Ok(Move::joints(&arm.pose(pose)?));
    }
    let problem = arguments.problem.as_deref().unwrap_or(FULL_POSE);
    let target = target(arm, problem, &arguments.target)?;
    Ok(if arguments.line { Move::line(problem, target) } else { Move::nearest(problem, target) })
}

/// The target of a problem of this arm.
///
/// # Errors
/// Where there is no such problem, or the flags are none of its target.
fn target(arm: &Arm<'_>, problem: &str, flags: &Flags) -> Result<Target, Failure> {
    match flags.target(arm.kind(problem)?, arm.units()) {
        Ok(target) => Ok(target),
        Err(Trouble::Form(message)) => Err(Failure::Usage(message)),
        Err(Trouble::Value(error)) => Err(crate::failure::Refusal::new("target", error.to_string()).into()),
    }
}
