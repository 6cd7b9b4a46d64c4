//! `dhc read`

use crate::arm::{self, DeviceFlags, Use};
use crate::failure::{Failure, Status};
use dh_drivers::clock::{Clock, RealClock};
use std::io::Write;
use std::time::Duration;

/// What a device says: where the joints are and the hand is, velocities, loads, temperatures and faults.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, after_long_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    device: DeviceFlags,
    /// Answer in JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Go on, so many times a second, until Ctrl-C.
    #[arg(long, value_name = "HZ")]
    watch: Option<f64>,
}

const EXAMPLES: &str = "\
Examples:
  dhc read planar2r --port /dev/ttyUSB0
  dhc read mycobot --port /dev/ttyAMA0 --json --watch 5";

/// Runs the command.
pub(crate) fn run(arguments: &Arguments, out: &mut dyn Write) -> Result<Status, Failure> {
    let every = match arguments.watch {
        Some(rate) => Some(period(rate)?),
        None => None,
    };
    arm::with(&arguments.device, Use::Look, |arm| {
        let clock = RealClock::new();
        loop {
            let begun = clock.now();
            arm.read()?;
            arm.tell(arguments.json, out)?;
            match every {
                Some(every) => clock.sleep_until(begun + every),
                None => return Ok(Status::Done),
            }
        }
    })
}

fn period(rate: f64) -> Result<Duration, Failure> {
    let period = Duration::try_from_secs_f64(1.0 / rate).ok().filter(|_| rate > 0.0);
    period.ok_or_else(|| Failure::Usage(format!("--watch {rate} is no number of times a second")))
}
