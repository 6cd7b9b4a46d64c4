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
mod path;
mod planner;
mod profile;
mod refusal;
mod robot;
mod settings;
mod singular;
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
