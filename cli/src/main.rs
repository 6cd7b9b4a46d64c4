//! `dhc`: the compiler from Denavit-Hartenberg tables to kinematics code on the command line.
//!
//! One file a command. Values are in the table's units on the way in and out; what is computed in between is in
//! radians and metres. Exit status: 0 done, 1 the input is wrong or has no solution, 2 wrong usage.

mod arm;
mod calibrate;
mod check;
mod check_pose;
mod console;
mod device;
mod draw;
mod equations;
mod explain;
mod failure;
mod fk;
mod generate;
mod ik;
mod jacobian;
mod json;
mod list;
mod move_arm;
mod read;
mod robot;
mod rule;
mod sim;
mod stream;
mod text;
mod units;

use clap::{Parser, Subcommand};
use failure::{Failure, Status};
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

/// From a Denavit-Hartenberg table to equations, code, poses and joint values.
///
/// TABLE is a file, or the name of a table shipped with the project (mycobot, ur5, scara, ...). Values are in the
/// table's units, except Jacobians and errors of solutions, which are in metres and radians.
#[derive(Debug, Parser)]
#[command(name = "dhc", version, after_help = EXAMPLES, after_long_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  dhc check mycobot
  dhc equations mycobot --part fk
  dhc generate robots/arm.toml --lang rust -o src/arm.rs
  dhc fk mycobot --joints 0,-90,140,-50,0,0
  dhc ik mycobot --problem tool_down --position 150,-100,70

Exit status: 0 done, 1 the input is wrong or has no solution, 2 wrong usage.";

#[derive(Debug, Subcommand)]
enum Command {
    Check(check::Arguments),
    Equations(equations::Arguments),
    Generate(generate::Arguments),
    Fk(fk::Arguments),
    Jacobian(jacobian::Arguments),
    Ik(Box<ik::Arguments>),
    CheckPose(check_pose::Arguments),
    Sim(sim::Arguments),
    Read(read::Arguments),
    #[command(name = "move")]
    Move(Box<move_arm::Arguments>),
    Draw(draw::Arguments),
    Console(console::Arguments),
    Calibrate(calibrate::Arguments),
    Explain(explain::Arguments),
}

impl Command {
    fn run(&self, out: &mut dyn Write) -> Result<Status, Failure> {
        match self {
            Command::Check(arguments) => check::run(arguments, out),
            Command::Equations(arguments) => equations::run(arguments, out),
            Command::Generate(arguments) => generate::run(arguments, out),
            Command::Fk(arguments) => fk::run(arguments, out),
            Command::Jacobian(arguments) => jacobian::run(arguments, out),
            Command::Ik(arguments) => ik::run(arguments, out),
            Command::CheckPose(arguments) => check_pose::run(arguments, out),
            Command::Sim(arguments) => sim::run(arguments, out),
            Command::Read(arguments) => read::run(arguments, out),
            Command::Move(arguments) => move_arm::run(arguments, out),
            Command::Draw(arguments) => draw::run(arguments, out),
            Command::Console(arguments) => console::run(arguments, out),
            Command::Calibrate(arguments) => calibrate::run(arguments, out),
            Command::Explain(arguments) => explain::run(arguments, out),
        }
    }

    /// Whether failures are answered on stdout too.
    fn json(&self) -> bool {
        match self {
            Command::Fk(arguments) => arguments.json,
            Command::Jacobian(arguments) => arguments.json,
            Command::Ik(arguments) => arguments.json,
            Command::CheckPose(arguments) => arguments.json,
            Command::Read(arguments) => arguments.json,
            Command::Move(arguments) => arguments.json,
            Command::Draw(arguments) => arguments.json,
            Command::Check(_)
            | Command::Equations(_)
            | Command::Generate(_)
            | Command::Sim(_)
            | Command::Console(_)
            | Command::Calibrate(_)
            | Command::Explain(_) => false,
        }
    }
}

fn main() -> ExitCode {
    let command = Arguments::parse().command;
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    let outcome = command.run(&mut out).and_then(|status| {
        out.flush()?;
        Ok(status)
    });
    match outcome {
        Ok(status) => status.code(),
        Err(failure) => failure.report(command.json(), &mut out).code(),
    }
}
