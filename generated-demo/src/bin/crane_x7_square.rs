//! A CRANE-X7 as a planar arm: round a square, with the wrist straight or held down.

mod device;

use std::f64::consts::{FRAC_PI_2, PI};
use std::process::ExitCode;

use clap::Parser;
use device::{DeviceFlags, Failure};
use dh_drivers::driver::{DeviceKind, DeviceSettings, Effort, JointMap};
use dh_drivers::dynamixel::control_table::POSITION_MODE;
use dh_drivers::dynamixel::{self, Bus, Timing};
use dh_drivers::motion::{Move, Robot};
use dh_runtime::{Kinematics, Point2, dh_robot};

/// The whole arm, which moves; `robots/crane_x7.toml`.
#[dh_robot("crane_x7")]
#[derive(Clone, Copy)]
struct Arm;

/// Its joints 2 and 4 as a planar arm with the hand at the wrist centre, X forward and Y up from the shoulder;
/// `robots/crane_x7_2r.toml`.
#[dh_robot("crane_x7_2r")]
struct Plane;

/// Bits per second.
const BAUD: u32 = 3_000_000;
/// The square's corners (m), and how many targets there are: twice round, and back to the first.
const CORNERS: [[f64; 2]; 4] = [[0.25, 0.15], [0.35, 0.15], [0.35, 0.25], [0.25, 0.25]];
const TARGETS: usize = 9;
/// Of the greatest velocity.
const PART: f64 = 0.3;

/// Moves a CRANE-X7 round a square in its vertical plane, in position mode, and brakes at the end.
#[derive(Debug, Parser)]
struct Arguments {
    #[command(flatten)]
    device: DeviceFlags,
    /// Hold the wrist down, as far as joint 6 goes.
    #[arg(long)]
    wrist_down: bool,
}

fn main() -> ExitCode {
    device::end(square(&Arguments::parse()))
}

fn square(arguments: &Arguments) -> Result<(), Failure> {
    let settings = DeviceSettings { kind: DeviceKind::Dynamixel, baud: BAUD };
    let (port, joints) = arguments.device.open(Arm, settings, JointMap::of_table(&Arm)?)?;
    let mut bus = Bus::new(port, Timing::default());
    let ids: Vec<u8> = joints.joints.iter().filter_map(|joint| joint.id.try_into().ok()).collect();
    // Servos whose torque is on refuse to change: the arm would fall.
    bus.set_operating_mode(&ids, POSITION_MODE)?;
    println!("position mode");
    let driver = dynamixel::Arm::connect(bus, joints, dynamixel::Settings::default())?;
    let mut robot = Robot::new(&Arm, driver)?.with_poses(&Arm::POSES);
    device::stop_on_interrupt(robot.stop_handle())?;
    robot.hold()?;
    println!("torque on");
    for corner in CORNERS.iter().cycle().take(TARGETS) {
        let q = joints_at(*corner, arguments.wrist_down)?;
        device::go(&mut robot, &[Move::joints(&q).slowed(PART)])?;
        tell(&mut robot, *corner)?;
    }
    // Joints that move decelerate; the torque stays, and the stop is over when all are at rest.
    robot.emergency_stop()?;
    println!("at rest, holding");
    arguments.device.leave(&mut robot)
}

/// The arm's joints with the wrist centre at a place in the plane (m): joint 2 is the shoulder less a quarter of a turn,
/// joint 4 the elbow, and joint 6 turns the hand down, which wants -pi/2 - theta1 - theta2.
fn joints_at([x, y]: [f64; 2], wrist_down: bool) -> Result<[f64; 7], Failure> {
    let solutions = Plane.ik_xy_elbow_up(&Point2::new(x, y))?;
    let [theta1, theta2] = solutions.first().ok_or("there is no solution")?.q;
    let mut q = [0.0, theta1 - FRAC_PI_2, 0.0, theta2, 0.0, 0.0, 0.0];
    if wrist_down {
        let down = -FRAC_PI_2 - theta1 - theta2;
        let limits = Arm::JOINTS.get(5).and_then(|joint| joint.limits);
        let wrist = limits.map_or(down, |limits| limits.clamp(down));
        if (wrist - down).abs() > 1e-9 {
            println!("joint 6 ends {:.2} degrees short of straight down", (wrist - down).to_degrees());
        }
        if let Some(joint6) = q.get_mut(5) {
            *joint6 = wrist;
        }
    }
    Ok(q)
}

/// Target and present position of the hand, and what the servos say.
fn tell(robot: &mut Robot<'_, dynamixel::Arm>, [x, y]: [f64; 2]) -> Result<(), Failure> {
    let state = robot.read()?.clone();
    let q = state.positions();
    let (shoulder, elbow, wrist) = match *q.as_slice() {
        [_, q2, _, q4, _, q6, _] => (q2 + FRAC_PI_2, q4, q6),
        _ => return Err("the arm has seven joints".into()),
    };
    let [present_x, present_y, _] = Kinematics::fk(&Plane, &[shoulder, elbow])?.translation;
    let tilt = ((shoulder + elbow + wrist + 1.5 * PI).rem_euclid(2.0 * PI) - PI).to_degrees();
    println!(
        "target {x:.4} {y:.4} m, present {present_x:.4} {present_y:.4} m, joints 2, 4, 6 at {:.4} {elbow:.4} {wrist:.4} rad, \
         hand {tilt:.2} degrees from down",
        shoulder - FRAC_PI_2
    );
    for (joint, state) in Arm::JOINTS.iter().zip(&state.joints) {
        let velocity =
            state.velocity.map_or_else(|| "-".to_owned(), |velocity| format!("{velocity:.3} rad/s"));
        let effort = match state.effort {
            Some(Effort::Current(current)) => format!("{current:.3} A"),
            Some(Effort::Load(load)) => format!("{:.1} %", 100.0 * load),
            None => "-".to_owned(),
        };
        println!("  {}: {:.4} rad, {velocity}, {effort}", joint.name, state.position);
    }
    Ok(())
}
