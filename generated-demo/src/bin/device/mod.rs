//! What the programs have in common: one flag for the device, progress, and Ctrl-C.

#![allow(dead_code, reason = "each program uses some of it")]

use std::error::Error;
use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use dh_drivers::clock::{RealClock, VirtualClock};
use dh_drivers::connect;
use dh_drivers::driver::{DeviceSettings, Driver, JointMap};
use dh_drivers::motion::{MotionError, Move, Progress, Robot, StopHandle};
use dh_drivers::port::{self, Port};
use dh_drivers::unit::Unit;
use dh_runtime::Kinematics;

/// Anything that ends a program.
pub(crate) type Failure = Box<dyn Error>;

/// The device.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct DeviceFlags {
    #[command(flatten)]
    place: Place,
    /// Servo zeros and signs of this very arm, as `dhc calibrate` writes them.
    #[arg(long, value_name = "FILE")]
    unit: Option<PathBuf>,
    /// Cut the torque at the end, if the arm then is in a pose that the table marks safe.
    #[arg(long)]
    release: bool,
    /// Cut it wherever the arm is then. Hold it: it falls.
    #[arg(long, conflicts_with = "release")]
    release_anywhere: bool,
}

#[derive(Debug, Clone, clap::Args)]
#[group(required = true, multiple = false)]
struct Place {
    /// The real device, or one of `dhc sim`: its port.
    #[arg(long, value_name = "PORT")]
    port: Option<String>,
    /// A simulated device within this program, which takes no time to move.
    #[arg(long)]
    simulated: bool,
}

impl DeviceFlags {
    /// The line to the device, and the joints as this one has them.
    pub(crate) fn open<K: Kinematics + Send + 'static>(
        &self,
        arm: K,
        settings: DeviceSettings,
        mut joints: JointMap,
    ) -> Result<(Box<dyn Port>, JointMap), Failure> {
        if let Some(path) = &self.unit {
            let name = path.display();
            let text = std::fs::read_to_string(path).map_err(|error| format!("{name}: {error}"))?;
            let unit = Unit::parse(&text).map_err(|error| format!("{name}:{error}"))?;
            unit.apply(&mut joints).map_err(|error| format!("{name}: {error}"))?;
        }
        let line = match &self.place.port {
            Some(name) => port::open(name, settings.baud, Arc::new(RealClock::new()))?,
            None => connect::simulated(settings, Box::new(arm), &joints, Arc::new(VirtualClock::new()))?,
        };
        Ok((line, joints))
    }

    /// The end of a program: the arm holds, unless its torque is to be cut.
    pub(crate) fn leave<D: Driver>(&self, robot: &mut Robot<'_, D>) -> Result<(), Failure> {
        match (self.release, self.release_anywhere) {
            (true, _) => robot.release()?,
            (_, true) => robot.release_anywhere()?,
            _ => {}
        }
        Ok(())
    }
}

/// Whether an arm moves now.
static MOVING: AtomicBool = AtomicBool::new(false);

/// Ctrl-C stops the arm on its path, where it holds. While it rests, or a second time, it ends the program; the arm
/// holds then, too.
pub(crate) fn stop_on_interrupt(stop: StopHandle) -> Result<(), Failure> {
    ctrlc::set_handler(move || {
        if MOVING.load(Ordering::SeqCst) && !stop.is_set() {
            stop.stop();
        } else {
            std::process::exit(130);
        }
    })?;
    Ok(())
}

/// Makes moves and tells of long ones how far they are.
pub(crate) fn go<D: Driver>(robot: &mut Robot<'_, D>, moves: &[Move]) -> Result<(), MotionError> {
    // A stop that was asked for while the last move was made is over with it.
    robot.stop_handle().clear();
    MOVING.store(true, Ordering::SeqCst);
    let mut told = (0, 0);
    let outcome = robot.go_watched(moves, &mut |progress: &Progress<'_>| {
        let quarter = (4.0 * progress.elapsed / progress.duration.max(f64::MIN_POSITIVE)) as usize;
        if progress.duration > 2.0 && (progress.step, quarter) > told && quarter < 4 {
            told = (progress.step, quarter);
            eprintln!("move {} of {}, {} %", progress.step + 1, progress.steps, 25 * quarter);
        }
    });
    MOVING.store(false, Ordering::SeqCst);
    outcome
}

/// Numbers of a line, between spaces or commas.
pub(crate) fn numbers<const N: usize>(line: &str) -> Result<[f64; N], Failure> {
    let words = line.split([' ', ',', '\t']).filter(|word| !word.is_empty());
    let numbers: Vec<f64> = words
        .map(|word| word.parse().map_err(|_| format!("`{word}` is no number")))
        .collect::<Result<_, _>>()?;
    let count = numbers.len();
    numbers.try_into().map_err(|_| format!("{count} numbers where {N} are needed").into())
}

/// Lines from the keyboard, each asked for; lines of a file come unasked.
pub(crate) fn ask(prompt: &str) -> Result<Option<String>, Failure> {
    if io::stdin().is_terminal() {
        eprint!("{prompt}");
        io::stderr().flush()?;
    }
    let mut line = String::new();
    Ok((io::stdin().read_line(&mut line)? > 0).then(|| line.trim().to_owned()))
}

/// Exit status and last words of a program.
pub(crate) fn end(outcome: Result<(), Failure>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::FAILURE
        }
    }
}
