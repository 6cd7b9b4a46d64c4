//! A planar arm of two links on two XL430: a console.

mod device;

use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use device::{DeviceFlags, Failure};
use dh_drivers::connect::connect;
use dh_drivers::driver::{DeviceKind, DeviceSettings, Driver, JointMap};
use dh_drivers::motion::{Defaults, Move, Robot};
use dh_drivers::workspace_edge;
use dh_runtime::{Kinematics, Target, dh_robot};
use std::f64::consts::FRAC_PI_3;

/// The arm; `robots/planar2r.toml`.
#[dh_robot("planar2r")]
#[derive(Clone, Copy)]
struct Arm;

/// Bits per second, as the servos leave the factory.
const BAUD: u32 = 57_600;
/// The course's first goals (ticks of motors 1 and 2), and the second (rad).
const TICKS: [f64; 2] = [3000.0, 1500.0];
const ANGLES: [f64; 2] = [FRAC_PI_3, -FRAC_PI_3];
/// How long the way to zero may take (s).
const TO_ZERO: f64 = 1.5;
/// A star (m).
const FIGURE: [[f64; 2]; 6] =
    [[0.20, 0.06], [0.10, 0.10], [0.18, 0.02], [0.18, 0.12], [0.10, 0.04], [0.20, 0.06]];
/// What servos of 6 rad/s do with two light links, where the table does not say.
const DYNAMICS: Defaults =
    Defaults { revolute_velocity: 4.0, velocity_time: 0.2, acceleration_time: 0.05, prismatic_velocity: 0.1 };
/// As much of the greatest velocity as is used where nothing is in a hurry.
const CALM: f64 = 0.3;

const COMMANDS: &str = "\
t  both goals of the test: ticks 3000 and 1500, then pi/3 and -pi/3
w  the edge of the workspace in one stroke from the joint limits, and to zero
d  draws a star in straight lines
z  to zero within 1500 ms
q  to zero, torque off, port closed";

/// A console for the planar arm: t, w, d, z, q, each on a line of its own.
#[derive(Debug, Parser)]
#[command(after_help = COMMANDS)]
struct Arguments {
    #[command(flatten)]
    device: DeviceFlags,
    /// Which way the elbow bends while the arm draws.
    #[arg(long, value_enum, default_value_t = Elbow::Up)]
    elbow: Elbow,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Elbow {
    Up,
    Down,
}

impl Elbow {
    fn problem(self) -> &'static str {
        match self {
            Self::Up => "xy_elbow_up",
            Self::Down => "xy_elbow_down",
        }
    }
}

type Planar<'k> = Robot<'k, Box<dyn Driver>>;

fn main() -> ExitCode {
    device::end(console(&Arguments::parse()))
}

fn console(arguments: &Arguments) -> Result<(), Failure> {
    let settings = DeviceSettings { kind: DeviceKind::Dynamixel, baud: BAUD };
    let (port, joints) = arguments.device.open(Arm, settings, JointMap::of_table(&Arm)?)?;
    let robot = Robot::new(&Arm, connect(settings, joints, port)?)?.with_poses(&Arm::POSES);
    let mut robot = robot.with_defaults(&DYNAMICS);
    device::stop_on_interrupt(robot.stop_handle())?;
    while let Some(command) = device::ask("t w d z q> ")? {
        let outcome = match command.as_str() {
            "" => Ok(()),
            "t" => test(&mut robot),
            "w" => edge(&mut robot),
            "d" => draw(&mut robot, arguments.elbow),
            "z" => zero(&mut robot),
            "q" => {
                device::go(&mut robot, &[Move::joints(&[0.0; 2]).slowed(CALM)])?;
                hand(&mut robot, "zero")?;
                // It is what q asks for: the arm lies on its table.
                robot.release_anywhere()?;
                println!("torque off");
                return Ok(());
            }
            other => Err(format!("`{other}` is no command\n{COMMANDS}").into()),
        };
        if let Err(failure) = outcome {
            println!("{failure}");
        }
    }
    arguments.device.leave(&mut robot)
}

/// Goals in ticks, then in radians; target and actual joints are compared.
fn test(robot: &mut Planar<'_>) -> Result<(), Failure> {
    let joints = robot.driver().joints().joints.clone();
    let in_ticks = joints.iter().zip(TICKS).map(|(joint, ticks)| joint.from_device(ticks)).collect();
    for goal in [in_ticks, ANGLES.to_vec()] {
        device::go(robot, &[Move::joints(&goal).slowed(CALM)])?;
        for ((joint, target), actual) in joints.iter().zip(&goal).zip(robot.read()?.positions()) {
            let (name, ticks) = (&joint.name, joint.to_device(*target));
            let present = joint.to_device(actual);
            println!(
                "{name}: target {target:.4} rad = {ticks:.0} ticks, actual {actual:.4} rad = {present:.0} ticks"
            );
        }
    }
    Ok(())
}

/// The edge of the workspace, and to zero.
fn edge(robot: &mut Planar<'_>) -> Result<(), Failure> {
    let limits: Vec<_> = robot.arm().joints().iter().filter_map(|joint| joint.limits).collect();
    let [joint1, joint2] = *limits.as_slice() else { return Err("a joint has no limits".into()) };
    let way = workspace_edge(joint1, joint2);
    let moves: Vec<Move> = way.iter().map(|q| Move::joints(q)).collect();
    device::go(robot, &moves)?;
    hand(robot, "edge done")
}

/// The figure in straight lines.
fn draw(robot: &mut Planar<'_>, elbow: Elbow) -> Result<(), Failure> {
    let problem = elbow.problem();
    let [start, ..] = FIGURE;
    let to_start = Move::nearest(problem, Target::Xy(start)).slowed(CALM);
    let lines = FIGURE.iter().skip(1).map(|point| Move::line(problem, Target::Xy(*point)));
    let moves: Vec<Move> = [to_start].into_iter().chain(lines).collect();
    // The whole figure is checked before the first line.
    robot.plan(&moves)?;
    for ([x, y], line) in FIGURE.iter().zip(moves) {
        device::go(robot, &[line])?;
        hand(robot, &format!("target {x:.4} {y:.4} m"))?;
    }
    Ok(())
}

fn zero(robot: &mut Planar<'_>) -> Result<(), Failure> {
    device::go(robot, &[Move::joints(&[0.0; 2]).within(TO_ZERO)])?;
    hand(robot, "zero")
}

/// Where the hand is, from what the servos say.
fn hand(robot: &mut Planar<'_>, what: &str) -> Result<(), Failure> {
    let q = robot.read()?.positions();
    let [x, y, _] = Kinematics::fk(&Arm, &q)?.translation;
    let joints: Vec<String> = q.iter().map(|angle| format!("{angle:.4}")).collect();
    println!("{what}, actual {x:.4} {y:.4} m, joints {} rad", joints.join(" "));
    Ok(())
}
