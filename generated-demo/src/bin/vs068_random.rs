//! A VS-068: random reachable poses, solved, moved to and compared.

mod device;

use std::f64::consts::TAU;
use std::process::ExitCode;

use clap::Parser;
use device::{DeviceFlags, Failure};
use dh_drivers::connect::connect;
use dh_drivers::driver::{DeviceJoint, DeviceKind, DeviceSettings, Driver, JointMap};
use dh_drivers::motion::{Move, Robot};
use dh_runtime::{FULL_POSE, Frame, Kinematics, Limits, SolutionSet, Target, dh_robot, rotation_error};

/// The arm; `robots/vs068.toml`.
#[dh_robot("vs068")]
#[derive(Clone, Copy)]
struct Arm;

/// Bits per second.
const BAUD: u32 = 1_000_000;
/// Counts of a servo a turn of its joint: each is behind a gear of two to one, so that a joint makes two turns in the
/// 4096 counts of a turn of its servo.
const COUNTS_PER_TURN: f64 = 2048.0;
/// Of the greatest velocity.
const PART: f64 = 0.5;
/// A pose is solved where a solution meets it to this (m and rad).
const SOLVED: f64 = 1e-9;

/// Moves an arm of the VS-068's dimensions to random poses that it can reach: each is solved, moved to by the nearest
/// solution, and compared with where the hand then is.
///
/// The maker's controller has a protocol of its own; the arm moved here has a Dynamixel XM540 a joint, ids 1 to 6, each
/// behind a gear of two to one.
#[derive(Debug, Parser)]
struct Arguments {
    #[command(flatten)]
    device: DeviceFlags,
    /// How many poses.
    #[arg(long, default_value_t = 10)]
    poses: usize,
    /// Where the random numbers begin.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

fn main() -> ExitCode {
    device::end(random_poses(&Arguments::parse()))
}

fn random_poses(arguments: &Arguments) -> Result<(), Failure> {
    let settings = DeviceSettings { kind: DeviceKind::Dynamixel, baud: BAUD };
    let (port, joints) = arguments.device.open(Arm, settings, servos())?;
    let mut robot = Robot::new(&Arm, connect(settings, joints, port)?)?.with_poses(&Arm::POSES);
    device::stop_on_interrupt(robot.stop_handle())?;
    let mut random = Random(arguments.seed);
    for number in 1..=arguments.poses {
        let Reachable { drawn, goal, nearest } = reachable(&robot, &mut random)?;
        let count = solve(&drawn, &goal)?;
        device::go(&mut robot, &[Move::pose(goal).slowed(PART)])?;
        let q = robot.read()?.positions();
        let off =
            nearest.iter().zip(&q).map(|(target, present)| (target - present).abs()).fold(0.0, f64::max);
        let ticks = off * COUNTS_PER_TURN / TAU;
        compare(number, count, &goal, &Kinematics::fk(&Arm, &q)?);
        println!("  joints off by {ticks:.2} ticks at most");
    }
    arguments.device.leave(&mut robot)
}

/// A pose that the arm can move to.
struct Reachable {
    /// The joint values that it was made from, within the limits.
    drawn: Vec<f64>,
    goal: Frame,
    /// The nearest joint values that have it.
    nearest: Vec<f64>,
}

/// Draws joint values until the arm can move to their pose from where it stands.
fn reachable(robot: &Robot<'_, Box<dyn Driver>>, random: &mut Random) -> Result<Reachable, Failure> {
    for _ in 0..1000 {
        let limits = Arm::JOINTS.iter().filter_map(|joint| joint.limits);
        let drawn: Vec<f64> = limits.map(|Limits { min, max }| min + random.unit() * (max - min)).collect();
        let goal = Kinematics::fk(&Arm, &drawn)?;
        let checked = robot.plan(&[Move::pose(goal)]);
        if let Some(nearest) = checked.ok().and_then(|checked| checked.goal(0).map(<[f64]>::to_vec)) {
            return Ok(Reachable { drawn, goal, nearest });
        }
    }
    Err("no pose is reachable from here".into())
}

/// Solves the pose: how many solutions it has. Each must meet it, and the joint values that it was made from must be
/// among them.
fn solve(drawn: &[f64], goal: &Frame) -> Result<usize, Failure> {
    let mut solutions = SolutionSet::default();
    Arm.ik_into(FULL_POSE, &Target::Pose(*goal), &mut solutions)?;
    let worst = solutions.iter().map(|solution| solution.residual()).fold(0.0, f64::max);
    if worst > SOLVED {
        return Err(format!("a solution misses its pose by {worst:e}").into());
    }
    // Angles are the same modulo a turn.
    let off = |q: &[f64]| q.iter().zip(drawn).map(|(a, b)| ((a - b) / 2.0).sin().abs()).fold(0.0, f64::max);
    let nearest = solutions.iter().map(|solution| off(solution.q)).fold(f64::INFINITY, f64::min);
    if nearest > 1e-6 {
        return Err(format!("the joint values {drawn:?} are not among the solutions of their pose").into());
    }
    Ok(solutions.len())
}

fn compare(number: usize, count: usize, goal: &Frame, present: &Frame) {
    let millimetres =
        |frame: &Frame| frame.translation.map(|metres| format!("{:.1}", metres * 1000.0)).join(" ");
    let squares = goal.translation.iter().zip(&present.translation).map(|(a, b)| (a - b).powi(2));
    let position = squares.sum::<f64>().sqrt() * 1000.0;
    let rotation = rotation_error(&goal.rotation, &present.rotation).to_degrees();
    println!(
        "{number}: {count} solutions, target {} mm, present {} mm, off by {position:.2} mm and {rotation:.2} degrees",
        millimetres(goal),
        millimetres(present)
    );
}

/// The servos, which the table does not have.
fn servos() -> JointMap {
    let joints = (1..).zip(&Arm::JOINTS).map(|(id, joint)| DeviceJoint {
        name: joint.name.to_owned(),
        kind: joint.kind,
        table_limits: joint.limits,
        max_velocity: joint.max_velocity,
        max_acceleration: joint.max_acceleration,
        id,
        scale: COUNTS_PER_TURN / TAU,
        zero: 2048.0,
        range: Some(Limits { min: 0.0, max: 4095.0 }),
        model: Some("XM540-W270".to_owned()),
    });
    JointMap { fingerprint: Arm::FINGERPRINT, joints: joints.collect() }
}

/// `SplitMix64`, by Steele, Lea and Flood (2014).
struct Random(u64);

impl Random {
    /// From 0 to 1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
