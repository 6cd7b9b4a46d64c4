//! `dhc calibrate`

use crate::arm::{self, Arm, DeviceFlags, Use};
use crate::failure::{Failure, Refusal, Status, complain};
use dh_drivers::unit::Unit;
use std::fs;
use std::io::{self, BufRead, Write};
use std::path::PathBuf;

/// Servo zeros and signs of one arm, measured: writes the file that --unit takes.
///
/// Bring the arm to a pose of the table as exactly as you can (by hand, with --release; by jigs, by marks), and the
/// zeros are what its servos say there. A second pose, in which every joint is elsewhere, gives their signs too.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceFlags,
    /// A pose of the table that the arm is brought to; a second one may be given.
    #[arg(long, value_name = "NAME", required = true)]
    pose: Vec<String>,
    /// The file to write; stdout if left out.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Cut the torque first, so that the arm can be moved by hand. Hold it: it falls.
    #[arg(long)]
    release: bool,
    /// The arm is in the pose already: read at once, without asking. For one pose.
    #[arg(long)]
    now: bool,
}

const EXAMPLES: &str = "\
Examples:
  dhc calibrate planar2r --port /dev/ttyUSB0 --pose zero --now -o left-arm.toml
  dhc calibrate planar2r --port /dev/ttyUSB0 --pose zero --pose test --release -o left-arm.toml
  dhc read planar2r --port /dev/ttyUSB0 --unit left-arm.toml";

/// How often the joints are read in a pose, and how far readings may be apart: a part of a turn, and mm.
const READINGS: usize = 5;
const AT_REST: f64 = 0.005;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    if arguments.pose.len() > 2 || (arguments.now && arguments.pose.len() > 1) {
        return Err(Failure::Usage("give one --pose, or two without --now".to_owned()));
    }
    if arguments.device.unit.is_some() {
        return Err(Failure::Usage("--unit is what this command makes: leave it out".to_owned()));
    }
    arm::with(&arguments.device, Use::Look, |arm| {
        // Names are looked up before anybody is asked to move an arm.
        let poses = arguments.pose.iter().map(|name| arm.pose(name)).collect::<Result<Vec<_>, _>>()?;
        if arguments.release {
            arm.release(true)?;
        }
        let mut measured: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        for (name, q) in arguments.pose.iter().zip(poses) {
            if !arguments.now {
                wait_for_enter(name, arm, &q)?;
            }
            measured.push((q, device_values(arm)?));
        }
        let slices = |(q, device): &(Vec<f64>, Vec<f64>)| (q.clone(), device.clone());
        let (Some(first), second) = (measured.first().map(slices), measured.get(1).map(slices)) else {
            return Ok(Status::Usage);
        };
        let second = second.as_ref().map(|(q, device)| (q.as_slice(), device.as_slice()));
        let map = arm.robot.driver().joints().clone();
        let unit = Unit::measured(&arm.model.name, &map, (&first.0, &first.1), second)
            .map_err(|error| Refusal::new("calibration", error.to_string()))?;
        for (joint, own) in map.joints.iter().zip(&unit.joints) {
            let sign = if own.reversed { ", counting against it" } else { "" };
            complain(&format!(
                "{}: zero at {:.1}, by the table {:.1}{sign}",
                joint.name, own.zero, joint.zero
            ));
        }
        match &arguments.output {
            Some(path) => fs::write(path, unit.to_toml())
                .map_err(|error| Refusal::new("output", format!("{}: {error}", path.display())))?,
            None => write!(out, "{}", unit.to_toml())?,
        }
        Ok(Status::Done)
    })
}

fn wait_for_enter(name: &str, arm: &Arm<'_>, q: &[f64]) -> Result<(), Refusal> {
    let units = arm.units();
    let values: Vec<String> = units
        .joints(q)
        .iter()
        .enumerate()
        .map(|(index, value)| {
            let (kind, name) = units.joint(index);
            format!("{name} {} {}", units.show(kind, *value), units.name(kind))
        })
        .collect();
    complain(&format!("bring the arm to {name} ({}), and press Enter", values.join(", ")));
    let mut line = String::new();
    match io::stdin().lock().read_line(&mut line) {
        Ok(0) => Err(Refusal::new("stdin", "nobody said that the arm is there").help("use --now in scripts")),
        Ok(_) => Ok(()),
        Err(error) => Err(Refusal::new("stdin", error.to_string())),
    }
}

/// What the servos say (device units), the mean of some readings of an arm at rest.
fn device_values(arm: &mut Arm<'_>) -> Result<Vec<f64>, Refusal> {
    let mut readings: Vec<Vec<f64>> = Vec::new();
    for _ in 0..READINGS {
        arm.read()?;
        readings.push(arm.robot.state().positions());
    }
    let map = arm.robot.driver().joints().clone();
    let mut values = Vec::new();
    for (index, joint) in map.joints.iter().enumerate() {
        let seen: Vec<f64> = readings.iter().filter_map(|reading| reading.get(index).copied()).collect();
        let (least, greatest) =
            seen.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), x| (min.min(*x), max.max(*x)));
        // Written so that what is no number moves.
        if greatest - least > AT_REST || !(greatest - least).is_finite() {
            let message = format!("joint {} ({}) moves", index + 1, joint.name);
            return Err(Refusal::new("moving", message).help("hold the arm still while it is read"));
        }
        values.push(joint.to_device(seen.iter().sum::<f64>() / seen.len() as f64));
    }
    Ok(values)
}
