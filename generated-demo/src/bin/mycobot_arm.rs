//! A myCobot 280: joint angles from the keyboard, the hand at a position, a plate carried over.

mod device;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use device::{DeviceFlags, Failure};
use dh_drivers::connect::wake;
use dh_drivers::driver::{DeviceKind, DeviceSettings, JointMap};
use dh_drivers::motion::{MotionError, Move, Reason, Robot};
use dh_drivers::mycobot::{Model, MyCobot};
use dh_runtime::{IkError, Kinematics, Rule, Side, Target, Violations, dh_robot};

/// The arm; `robots/mycobot.toml`.
#[dh_robot("mycobot")]
#[derive(Clone, Copy)]
struct Arm;

/// The forearm is held so that the tool points down, with the elbow up.
const TOOL_DOWN: &str = "tool_down_elbow_up";

/// Where the plate is, where it goes (mm), by which lift, and the LED's colour at each waypoint.
const PLATE_FROM: [f64; 3] = [150.0, -100.0, 50.0];
const PLATE_TO: [f64; 3] = [100.0, -150.0, 50.0];
const LIFT: f64 = 100.0;
const COLORS: [[u8; 3]; 4] = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];

/// Moves a myCobot 280. Without a device it says what it would do.
#[derive(Debug, Parser)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
    /// Percent of the greatest speed.
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u8).range(1..=100), global = true)]
    speed: u8,
    /// The arm has an M5 in its base, not a Raspberry Pi.
    #[arg(long, global = true)]
    m5: bool,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Checks joint angles (deg) from the keyboard, six a line: limits, and where the hand would be. Nothing moves.
    Check,
    /// Moves to joint angles (deg) from the keyboard, six a line, all joints together.
    Joints(DeviceFlags),
    /// Moves the hand to a position (mm), tool down.
    Hand {
        /// mm
        #[arg(allow_hyphen_values = true)]
        x: f64,
        /// mm
        #[arg(allow_hyphen_values = true)]
        y: f64,
        /// mm
        #[arg(allow_hyphen_values = true)]
        z: f64,
        #[command(flatten)]
        device: DeviceFlags,
    },
    /// Carries a plate from (150, -100, 50) to (100, -150, 50) mm, lifting it by 100 mm, with the LED red, green, blue
    /// and white at the waypoints.
    Plate(DeviceFlags),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let model = if arguments.m5 { Model::M5 } else { Model::Pi };
    device::end(match &arguments.task {
        Task::Check => check(),
        Task::Joints(flags) => connected(flags, model, |robot| joints(robot, arguments.speed)),
        Task::Hand { x, y, z, device } => {
            connected(device, model, |robot| hand(robot, [*x, *y, *z], arguments.speed))
        }
        Task::Plate(flags) => connected(flags, model, |robot| plate(robot, arguments.speed)),
    })
}

fn connected(
    flags: &DeviceFlags,
    model: Model,
    act: impl FnOnce(&mut Robot<'_, MyCobot>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let settings = DeviceSettings { kind: DeviceKind::Mycobot, baud: model.baud() };
    let (port, joints) = flags.open(Arm, settings, JointMap::of_table(&Arm)?)?;
    let mut driver = MyCobot::new(port, joints, model)?;
    if wake(&mut driver)? {
        eprintln!("the arm had no power, which was switched on: it holds where it is");
    }
    let mut robot = Robot::new(&Arm, driver)?.with_poses(&Arm::POSES);
    device::stop_on_interrupt(robot.stop_handle())?;
    act(&mut robot)?;
    flags.leave(&mut robot)
}

/// Value check.
fn check() -> Result<(), Failure> {
    while let Some(line) = device::ask("J1 ... J6 (deg)> ")? {
        match device::numbers::<6>(&line) {
            Ok(angles) => {
                let q = angles.map(f64::to_radians);
                show("hand would be", &q)?;
                match Kinematics::check(&Arm, &q) {
                    Ok(()) => println!("allowed"),
                    Err(violations) => refused(&violations),
                }
            }
            Err(problem) => eprintln!("{problem}"),
        }
    }
    Ok(())
}

fn refused(violations: &Violations<'_>) {
    println!("refused: {violations}");
}

/// Joint angles from the keyboard.
fn joints(robot: &mut Robot<'_, MyCobot>, speed: u8) -> Result<(), Failure> {
    while let Some(line) = device::ask("J1 ... J6 (deg)> ")? {
        let outcome = device::numbers::<6>(&line).and_then(|angles| {
            let asked = Move::joints(&angles.map(f64::to_radians)).slowed(part(speed));
            device::go(robot, &[asked]).map_err(|error| in_degrees(&error).into())
        });
        match outcome {
            Ok(()) => arrived(robot)?,
            // A refusal has sent nothing; what stopped the arm has left it holding.
            Err(problem) => println!("{problem}"),
        }
    }
    Ok(())
}

/// The hand to a position (mm), tool down.
fn hand(robot: &mut Robot<'_, MyCobot>, position: [f64; 3], speed: u8) -> Result<(), Failure> {
    let asked = Move::nearest(TOOL_DOWN, target(position)).slowed(part(speed));
    device::go(robot, &[asked]).map_err(|error| in_degrees(&error))?;
    arrived(robot)
}

/// What is wrong with a move in the units of who asked for it, degrees and millimetres.
fn in_degrees(error: &MotionError) -> String {
    let MotionError::Refused(refusal) = error else { return error.to_string() };
    let told = [&refusal.reason].into_iter().chain(&refusal.also).map(|reason| match reason {
        Reason::OutsideLimits { joint, value, min, max } => {
            let [value, min, max] = [value, min, max].map(|angle| angle.to_degrees());
            format!("{} would be at {value:.2} degrees, not in {min:.0} to {max:.0}", joint.name)
        }
        Reason::Forbidden(rule) | Reason::NoSolution(IkError::Forbidden { rule }) => match rule {
            Rule::Bound { bound, value } => {
                let [value, limit] = [value, &bound.value].map(|metres| metres * 1000.0);
                let (axis, below) = (bound.axis, bound.side == Side::Min);
                let relation = if below { "below" } else { "above" };
                format!("the hand's {axis} would be {value:.2} mm, {relation} {limit:.0}")
            }
            other => other.to_string(),
        },
        other => other.to_string(),
    });
    format!("refused: {}", told.collect::<Vec<_>>().join("; "))
}

/// Down on the plate, up, over, and down again. Lifts are straight lines.
fn plate(robot: &mut Robot<'_, MyCobot>, speed: u8) -> Result<(), Failure> {
    let up = |[x, y, z]: [f64; 3]| [x, y, z + LIFT];
    let part = part(speed);
    let above = Move::nearest(TOOL_DOWN, target(up(PLATE_FROM))).slowed(part);
    let waypoints = [
        (PLATE_FROM, Move::line(TOOL_DOWN, target(PLATE_FROM)).slowed(part)),
        (up(PLATE_FROM), Move::line(TOOL_DOWN, target(up(PLATE_FROM))).slowed(part)),
        (up(PLATE_TO), Move::nearest(TOOL_DOWN, target(up(PLATE_TO))).slowed(part)),
        (PLATE_TO, Move::line(TOOL_DOWN, target(PLATE_TO)).slowed(part)),
    ];
    // The whole way is checked before the first step.
    let moves: Vec<Move> =
        [above.clone()].into_iter().chain(waypoints.iter().map(|(_, asked)| asked.clone())).collect();
    let whole = robot.plan(&moves).map_err(|refused| in_degrees(&refused.into()))?;
    println!("the whole way is allowed and takes about {:.0} s", whole.duration());
    device::go(robot, &[above])?;
    for (([x, y, z], asked), color) in waypoints.into_iter().zip(COLORS) {
        device::go(robot, &[asked])?;
        robot.driver().set_color(color)?;
        let [red, green, blue] = color;
        println!("waypoint {x} {y} {z} mm, LED {red} {green} {blue}");
        arrived(robot)?;
    }
    Ok(())
}

fn part(speed: u8) -> f64 {
    f64::from(speed) / 100.0
}

fn target(position: [f64; 3]) -> Target {
    Target::Position(position.map(|mm| mm / 1000.0))
}

/// Where the device says that it is.
fn arrived(robot: &mut Robot<'_, MyCobot>) -> Result<(), Failure> {
    let q = robot.read()?.positions();
    show("arrived, hand", &q)
}

fn show(what: &str, q: &[f64]) -> Result<(), Failure> {
    let angles: Vec<String> = q.iter().map(|angle| format!("{:.2}", angle.to_degrees())).collect();
    let [x, y, z] = Kinematics::fk(&Arm, q)?.translation.map(|metres| metres * 1000.0);
    println!("{what} at {x:.2} {y:.2} {z:.2} mm, joints {} deg", angles.join(" "));
    Ok(())
}
