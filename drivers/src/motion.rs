//! From goals to commands: checks, profiles and moves.

mod command;

pub use command::Command;
