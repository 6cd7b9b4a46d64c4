//! `dhc sim`

use crate::device;
use crate::failure::{Failure, Refusal, Status};
use crate::json::Json;
use crate::robot::Robot;
use dh_codegen::model;
use dh_codegen::verify::Level;
use dh_drivers::clock::RealClock;
use dh_drivers::driver::{DeviceKind, DeviceSettings};
use dh_drivers::dynamixel::control_table::{MODELS, Model};
use dh_drivers::dynamixel::packet::MAX_ID;
use dh_drivers::dynamixel::{ServoSpec, SimulatedBus};
use dh_drivers::mycobot::{self, SimulatedMyCobot};
use dh_drivers::simulate::{Faults, Faulty, Line, SimulatedDevice, TcpLine, serve};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A simulated device of a table, on a pseudo-terminal that any program can open as its serial port.
///
/// Prints {"port":".."} and runs until SIGINT or SIGTERM. The arm starts with all joints at 0, or as near to it as their
/// limits let them be; servos with torque off, a myCobot holding. Where the system has no pseudo-terminals, the port is tcp:HOST:PORT.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// A table file, or the name of a shipped table.
    table: String,
    /// A symbolic link to the port, to have a name that stays the same. Not for tcp.
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,
    /// Listen here (HOST:PORT, port 0 for any) in place of a pseudo-terminal: for programs on other systems and machines.
    #[arg(long, value_name = "HOST:PORT", conflicts_with = "link")]
    listen: Option<String>,
    /// Bits per second, where they are to be others than the table's: what kind of myCobot it is depends on them.
    #[arg(long, value_name = "RATE", value_parser = clap::value_parser!(u32).range(1..))]
    baud: Option<u32>,
    /// A bad line: so many percent of all frames are lost, late, cut in two, broken or doubled.
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0)]
    faults: f64,
    /// Motors that are K times as fast. Time-outs and delays stay as they are.
    #[arg(long, value_name = "K", default_value_t = 1.0)]
    time_scale: f64,
}

const EXAMPLES: &str = "\
Examples:
  dhc sim mycobot
  dhc sim crane_x7 --link /tmp/crane_x7 --time-scale 10
  dhc sim planar2r --listen 127.0.0.1:4000 --faults 5";

/// How late a frame is that comes late, at most.
const LATE: Duration = Duration::from_millis(20);

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let scale = arguments.time_scale;
    if !(scale.is_finite() && scale > 0.0) {
        return Err(Failure::Usage(format!("--time-scale {scale} must be more than 0")));
    }
    let robot = Robot::load(&arguments.table, Level::Quick)?;
    if !(0.0..=100.0).contains(&arguments.faults) {
        return Err(Failure::Usage(format!("--faults {} is not from 0 to 100 percent", arguments.faults)));
    }
    let settings = device::settings(&robot, arguments.baud)?;
    let program = robot.program()?;
    let device: Box<dyn SimulatedDevice + '_> = match settings.kind {
        DeviceKind::Dynamixel => Box::new(servos(&robot, settings)?.with_time_scale(scale)),
        DeviceKind::Mycobot => {
            let arm = program.interpreter().map_err(|error| robot.unusable(&error))?;
            let model = mycobot::Model::of_baud(settings.baud).ok_or_else(|| {
                let message = format!("no myCobot has a line of {} bits per second", settings.baud);
                Refusal::new("device", message).help("baud = 1000000 is a Pi's, 115200 an M5's")
            })?;
            let simulated = SimulatedMyCobot::new(Box::new(arm), model)
                .map_err(|error| Refusal::new("device", error.to_string()))?;
            Box::new(simulated.with_time_scale(scale))
        }
    };
    let mut device = Faulty::new(device, Faults::evenly(arguments.faults / 100.0, LATE), 1);
    let stop = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&stop);
    ctrlc::set_handler(move || told.store(true, Ordering::Relaxed)).map_err(io::Error::other)?;
    let mut line = open(arguments)?;
    let name = line.name();
    writeln!(out, "{}", Json::Object(vec![("port", name.as_str().into())]))?;
    out.flush()?;
    serve(&mut device, line.as_mut(), &RealClock::new(), &stop)?;
    Ok(Status::Done)
}

/// The line that other programs open.
fn open(arguments: &Arguments) -> Result<Box<dyn Line>, Failure> {
    let Some(address) = &arguments.listen else { return terminal(arguments) };
    match TcpLine::bind(address) {
        Ok(line) => Ok(Box::new(line)),
        Err(error) => Err(Refusal::new("port", format!("nobody can listen on {address}: {error}"))
            .help("write HOST:PORT, as in 127.0.0.1:0")
            .into()),
    }
}

#[cfg(unix)]
fn terminal(arguments: &Arguments) -> Result<Box<dyn Line>, Failure> {
    let link = arguments.link.as_deref();
    match dh_drivers::simulate::Pty::open(link) {
        Ok(pty) => Ok(Box::new(pty)),
        Err(error) => {
            let link = link.map_or(String::new(), |link| format!(" with the link {}", link.display()));
            Err(Refusal::new("port", format!("no pseudo-terminal{link}: {error}")).into())
        }
    }
}

#[cfg(not(unix))]
fn terminal(arguments: &Arguments) -> Result<Box<dyn Line>, Failure> {
    if arguments.link.is_some() {
        return Err(Failure::Usage("--link needs a pseudo-terminal, which this system has not".to_owned()));
    }
    Ok(Box::new(TcpLine::bind("127.0.0.1:0")?))
}

/// The servos of all joints, and those outside the chain.
fn servos(robot: &Robot, settings: DeviceSettings) -> Result<SimulatedBus, Refusal> {
    let model = robot.model();
    let rows = model.joints.iter().filter_map(|row| model.rows.get(*row));
    let joints = rows.filter_map(|row| {
        let servo = row.servo.as_ref()?;
        let at = row.limits.map_or(0.0, |limits| 0.0_f64.clamp(limits.min, limits.max));
        Some((row.name.as_str(), servo, servo.scale * at + servo.zero))
    });
    let others = model.servos.iter().map(|named| (named.name.as_str(), &named.servo, named.servo.zero));
    let specs: Vec<ServoSpec> = joints
        .chain(others)
        .map(|(name, servo, at)| spec(name, servo, at, settings))
        .collect::<Result<_, _>>()?;
    if specs.is_empty() {
        return Err(Refusal::new("servo", "no joint has a servo: write servo = { id = ... } in its entry"));
    }
    Ok(SimulatedBus::new(specs))
}

fn spec(
    name: &str,
    servo: &model::Servo,
    position: f64,
    settings: DeviceSettings,
) -> Result<ServoSpec, Refusal> {
    let known = MODELS.map(|model| model.name).join(", ");
    let refuse = |what: String, help: String| {
        Err(Refusal::new("servo", format!("the servo of {name} {what}")).help(help))
    };
    let Some(id) = servo.id.and_then(|id| u8::try_from(id).ok()).filter(|id| *id <= MAX_ID) else {
        return refuse(format!("has no id from 0 to {MAX_ID}"), format!("write id = 0 to {MAX_ID}"));
    };
    let named = servo.model.as_deref().unwrap_or_default();
    let Some(model) = Model::by_name(named) else {
        return refuse(format!("is a {named:?}"), format!("write model = one of {known}"));
    };
    Ok(ServoSpec { id, model, baud: settings.baud, position })
}
