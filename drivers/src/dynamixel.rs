//! Dynamixel servos of the X series: Protocol 2.0.
//!
//! [`packet`] turns packets to bytes and back, [`instruction`] makes the packets that a host sends and [`status`] reads
//! what servos answer, [`control_table`] says what is stored where, [`Bus`] exchanges packets and answers for the
//! answers, [`Arm`] is the [`Driver`](crate::Driver) of an arm of such servos, and [`SimulatedBus`] is a bus of servos
//! that are not there.
//!
//! Source: the makers' e-manual, "DYNAMIXEL Protocol 2.0" and the pages of XL430-W250, XM430-W350 and XM540-W270.

mod arm;
mod bus;
pub mod control_table;
pub mod instruction;
pub mod packet;
mod simulated;
pub mod status;

pub use arm::{Arm, Settings};
pub use bus::{Answer, Bus, Confirmed, Identity, Timing};
pub use simulated::{ServoSpec, SimulatedBus, SimulatedServo};
