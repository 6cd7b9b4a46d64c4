//! `dhc console`

use crate::arm::{self, Arm, DeviceFlags, Use, Watcher};
use crate::failure::{Failure, Refusal, Status, complain};
use crate::move_arm::{self, Pace};
use dh_core::{FULL_POSE, Frame, Target, TargetKind};
use dh_drivers::motion::Move;
use std::io::{self, BufRead, IsTerminal, Write};

/// Moves an arm by commands from the keyboard, or from a file.
#[derive(Debug, clap::Args)]
#[command(after_help = COMMANDS, after_long_help = COMMANDS)]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceFlags,
    #[command(flatten)]
    pace: Pace,
}

const COMMANDS: &str = "\
Commands, with values in the table's units:
  read                        what the device says
  joints Q1 Q2 ...            all joints to these values
  pose NAME                   all joints to a pose of the table
  to [PROBLEM] NUMBERS        to the nearest solution of an inverse problem
  line [PROBLEM] NUMBERS      there in a straight line
  check joints|to|line ...    whether such a move is allowed; nothing is sent that moves the arm
  percent P, speed V          how fast from now on
  hold                        torque on
  clear                       has the device forget its faults; joints that had one may lose their torque by it
  release [anywhere]          torque off, in a safe pose or wherever the arm is
  NAME [VALUE]                what the arm has besides joints: gripper (percent, of a myCobot) or a [[servo]] of the table
  help, quit                  when the console is left the arm holds

NUMBERS are those of the problem's target: x y z of a position, x y of xy, x y z yaw, x y z roll pitch yaw of a pose,
x y z and a direction, roll pitch yaw of a rotation. Without PROBLEM it is the full pose.
Ctrl-C stops a move; the arm holds.";

/// First words of the commands that move the arm.
const MOVES: &[&str] = &["joints", "pose", "to", "line"];

/// Those of the others.
const OTHERS: &[&str] =
    &["read", "check", "percent", "speed", "hold", "clear", "release", "help", "?", "quit", "exit", "q"];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let terminal = io::stdin().is_terminal();
    arm::with(&arguments.device, Use::Move, |arm| {
        no_command_is_hidden(arm)?;
        let mut pace = arguments.pace;
        let mut status = Status::Done;
        let mut input = io::stdin().lock();
        for number in 1_u64.. {
            out.flush()?;
            if terminal {
                write!(io::stderr(), "> ")?;
            }
            let mut line = String::new();
            if input.read_line(&mut line)? == 0 {
                return Ok(status);
            }
            let words: Vec<&str> =
                line.split([' ', '\t', ',', '\n', '\r']).filter(|word| !word.is_empty()).collect();
            match command(arm, &mut pace, &words, out) {
                Ok(Next::Go) => {}
                Ok(Next::Quit) => return Ok(status),
                // Whoever types sees it; of a script the line is told, and at its end that something was wrong.
                Err(Failure::Refused(refusal)) if terminal => complain(&refusal.to_string()),
                Err(Failure::Refused(refusal)) => {
                    status = Status::Wrong;
                    complain(&format!("line {number}: {refusal}"));
                }
                Err(other) => return Err(other),
            }
        }
        Ok(status)
    })
}

enum Next {
    Go,
    Quit,
}

fn command(arm: &mut Arm<'_>, pace: &mut Pace, words: &[&str], out: &mut dyn Write) -> Result<Next, Failure> {
    match words {
        [] => {}
        ["quit" | "exit" | "q"] => return Ok(Next::Quit),
        ["help" | "?"] => writeln!(out, "{COMMANDS}")?,
        ["read"] => {
            arm.read()?;
            arm.show(out)?;
        }
        ["hold"] => arm.hold()?,
        ["release"] => arm.release(false)?,
        ["release", "anywhere"] => arm.release(true)?,
        ["percent", number] => pace.percent = move_arm::percent(number).map_err(wrong)?,
        ["speed", number] => pace.speed = Some(move_arm::positive(number).map_err(wrong)?),
        ["clear"] => arm.clear_faults()?,
        ["check", words @ ..] => {
            let asked = pace.of(asked(arm, words)?, arm);
            let checked = arm.plan(&[asked])?;
            writeln!(out, "allowed: it would take about {:.1} s", checked.duration())?;
        }
        [name, value @ ..] if !MOVES.contains(name) => attachment(arm, name, value, out)?,
        words => {
            let asked = pace.of(asked(arm, words)?, arm);
            arm.go(&[asked], &mut Watcher::new(&mut |_, _, _| {}))?;
            let hand = arm.hand(&arm.robot.state().positions());
            arm.show_hand("hand", &hand, out)?;
        }
    }
    Ok(Next::Go)
}

/// What the arm has besides joints is told where it is, or sent elsewhere.
fn attachment(arm: &mut Arm<'_>, name: &str, value: &[&str], out: &mut dyn Write) -> Result<(), Failure> {
    let Some(attachment) = arm.attachment(name) else { return Err(no_command(name).into()) };
    match value {
        [] => writeln!(out, "{name} at {}", arm.read_attachment(&attachment)?)?,
        [value] => arm.move_attachment(&attachment, number(value)?)?,
        _ => return Err(wrong(format!("{name} takes one value")).into()),
    }
    Ok(())
}

/// An attachment that is called as a command is could not be told from it.
fn no_command_is_hidden(arm: &mut Arm<'_>) -> Result<(), Refusal> {
    for name in MOVES.iter().chain(OTHERS) {
        if arm.attachment(name).is_some() {
            let message = format!("the servo `{name}` has the name of a command");
            return Err(Refusal::new("command", message).help("give its [[servo]] another name in the table"));
        }
    }
    Ok(())
}

fn no_command(name: &str) -> Refusal {
    Refusal::new("command", format!("`{name}` is no command")).help("help lists them")
}

fn wrong(message: String) -> Refusal {
    Refusal::new("command", message)
}

/// The move that a command asks for.
fn asked(arm: &Arm<'_>, words: &[&str]) -> Result<Move, Refusal> {
    match words {
        ["joints", rest @ ..] => Ok(Move::joints(&arm.units().joints_in_si(&numbers(rest)?)?)),
        ["pose", name] => Ok(Move::joints(&arm.pose(name)?)),
        ["to", rest @ ..] => target(arm, rest).map(|(problem, target)| Move::nearest(problem, target)),
        ["line", rest @ ..] => target(arm, rest).map(|(problem, target)| Move::line(problem, target)),
        _ => Err(no_command(words.first().copied().unwrap_or_default())),
    }
}

fn numbers(words: &[&str]) -> Result<Vec<f64>, Refusal> {
    words.iter().map(|word| number(word)).collect()
}

fn number(word: &str) -> Result<f64, Refusal> {
    let number = word.parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| wrong(format!("`{word}` is no number")))
}

/// A problem's name, if it is given, and its target.
fn target<'w>(arm: &Arm<'_>, words: &[&'w str]) -> Result<(&'w str, Target), Refusal> {
    let (problem, rest) = match words {
        [name, rest @ ..] if name.parse::<f64>().is_err() => (*name, rest),
        rest => (FULL_POSE, rest),
    };
    let kind = arm.kind(problem)?;
    let numbers = numbers(rest)?;
    let units = arm.units();
    let length = |x: &f64| units.metres(*x);
    let angle = |x: &f64| units.radians(*x);
    let target = match (kind, numbers.as_slice()) {
        (TargetKind::Pose, [x, y, z, roll, pitch, yaw]) => {
            let rpy = [roll, pitch, yaw].map(angle);
            Target::Pose(Frame::from_rpy([x, y, z].map(length), rpy))
        }
        (TargetKind::Position, [x, y, z]) => Target::Position([x, y, z].map(length)),
        (TargetKind::Lookat, [x, y, z]) => Target::Lookat([x, y, z].map(length)),
        (TargetKind::PositionDirection, [x, y, z, direction @ ..]) if direction.len() == 3 => {
            Target::PositionDirection { position: [x, y, z].map(length), direction: three(direction) }
        }
        (TargetKind::Ray, [x, y, z, direction @ ..]) if direction.len() == 3 => {
            Target::Ray { position: [x, y, z].map(length), direction: three(direction) }
        }
        (TargetKind::PositionYaw, [x, y, z, yaw]) => {
            Target::PositionYaw { position: [x, y, z].map(length), yaw: angle(yaw) }
        }
        (TargetKind::Rotation, [roll, pitch, yaw]) => {
            Target::Rotation(Frame::from_rpy([0.0; 3], [roll, pitch, yaw].map(angle)).rotation)
        }
        (TargetKind::Direction, direction) if direction.len() == 3 => Target::Direction(three(direction)),
        (TargetKind::Xy, [x, y]) => Target::Xy([x, y].map(length)),
        (TargetKind::XyYaw, [x, y, yaw]) => Target::XyYaw { position: [x, y].map(length), yaw: angle(yaw) },
        (kind, numbers) => {
            let message = format!("{} numbers make no target of kind {kind}", numbers.len());
            return Err(Refusal::new("command", message).help("help says which numbers a target has"));
        }
    };
    Ok((problem, target))
}

fn three(numbers: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|index| numbers.get(index).copied().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::{COMMANDS, MOVES, OTHERS};

    #[test]
    fn every_command_of_the_help_is_known_by_name() {
        let (commands, _) = COMMANDS.split_once("\n\n").unwrap_or_default();
        let heads = commands.lines().skip(1).filter_map(|line| line.get(2..30));
        let alternatives = heads.flat_map(|head| head.split(", "));
        let firsts: Vec<&str> = alternatives.filter_map(|head| head.split_whitespace().next()).collect();
        assert!(firsts.len() > 12, "{firsts:?}");
        for first in firsts {
            assert!(first == "NAME" || MOVES.contains(&first) || OTHERS.contains(&first), "{first}");
        }
    }
}
