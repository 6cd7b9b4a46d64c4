//! A joystick drives a two-wheeled base: stick positions from the keyboard to wheel speeds.

mod device;

use std::process::ExitCode;

use clap::Parser;
use device::Failure;
use dh_drivers::wheel_speeds;

/// Prints the speeds of the left and the right wheel for each position of the stick, x (right) and y (forwards), one a
/// line.
#[derive(Debug, Parser)]
struct Arguments {
    /// The speed of one wheel alone at a stick of length 1, diagonally forwards.
    #[arg(long, default_value_t = 1.0)]
    gain: f64,
}

fn main() -> ExitCode {
    device::end(wheels(&Arguments::parse()))
}

fn wheels(arguments: &Arguments) -> Result<(), Failure> {
    while let Some(line) = device::ask("x y> ")? {
        match device::numbers::<2>(&line) {
            Ok(stick) => {
                let [left, right] = wheel_speeds(stick, arguments.gain);
                println!("{left} {right}");
            }
            Err(problem) => println!("{problem}"),
        }
    }
    Ok(())
}
