//! From goals to commands: checks, profiles and moves.
//!
//! [`Move`]s are what an arm is asked to do. A [`Planner`] checks them as a whole, without a device, and makes
//! [`Checked`] moves of them; a [`Robot`] runs those, and nothing else.
//!
//! ```text
//! Move -> path of targets -> joints along it -> timing -> setpoints or goals, checked -> Driver
//!         path               follow, singular   timing,   planner, clearance             robot
//!                                               profile
//! ```
//!
//! ```no_run
//! use dh_drivers::clock::RealClock;
//! use dh_drivers::driver::{DeviceSettings, JointMap};
//! use dh_drivers::motion::{Move, Robot};
//! use dh_drivers::{connect, port};
//! use dh_runtime::{Target, dh_robot};
//! use std::sync::Arc;
//!
//! #[dh_robot("planar2r")]
//! struct Planar;
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let settings = DeviceSettings::of_table("dynamixel", [("baud", "57600")])?;
//!     let port = port::open("/dev/ttyUSB0", settings.baud, Arc::new(RealClock::new()))?;
//!     let driver = connect::connect(settings, JointMap::of_table(&Planar)?, port)?;
//!     let mut robot = Robot::new(&Planar, driver)?.with_poses(&Planar::POSES);
//!     let at = |x, y| Target::Xy([x, y]); // m
//!     robot.go(&[
//!         Move::joints(&[0.3, -0.6]), // rad
//!         Move::nearest("xy", at(0.2, 0.1)).slowed(0.5),
//!         Move::line("xy", at(0.1, 0.1)).speed(0.05), // m/s
//!     ])?;
//!     println!("{:?}", robot.read()?.positions());
//!     Ok(())
//! }
//! ```
//!
//! A device that makes its own profiles is sent goals so near together that the tool point keeps the rules, and lines
//! are lines to 5 mm, in whatever order its joints move between two of them.
//!
//! What is checked: limits of joints, of sums and of servos; workspace rules, for the tool point only, everywhere on
//! the way; speed; along paths that solutions neither end, nor jump to another branch, nor come near a singularity.

mod checked;
mod clearance;
mod command;
mod course;
mod dynamics;
mod error;
mod follow;
mod moves;
mod narrowed;
mod out_of_step;
mod path;
mod planner;
mod profile;
mod refusal;
mod robot;
mod settings;
mod singular;
mod slowing;
mod spline;
mod timing;

pub use checked::Checked;
pub use clearance::WAY_TOLERANCE;
pub use command::Command;
pub use dynamics::{Defaults, Dynamics};
pub use error::MotionError;
pub use moves::Move;
pub use planner::{OtherArm, Planner};
pub use profile::{Profile, ProfileError};
pub use refusal::{JointName, Reason, Refusal, Sample};
pub use robot::{ConnectError, Progress, Robot, StopHandle};
pub use settings::{Settings, Tolerance};
pub use timing::{LEAST_PATH_SPEED, PATH_SPEED};
