//! The compiler as a library: what it makes of tables, against the oracle, and what the workspace promises of itself.
//!
//! One program, so that its tests share both processors and what they compile. What compiles generated code itself is not
//! among them: a test that rewrites that code must run when it does not compile.

mod agree;
mod arm_angle;
mod branch;
mod cases;
mod classes;
mod folded;
mod full_pose;
mod geometry;
mod inverse;
mod layering;
mod marks;
mod mounted;
mod nopanic;
mod oracle;
mod position_direction;
mod printed_text;
mod random;
mod reachable;
mod rebuild;
mod redundant;
mod second_method;
mod seeded;
mod snapshots;
mod tables;
mod ui;
