//! What the attribute `dh_robot` generates, compiled and run.

mod drawn;
mod near;
mod near_problems;
mod searched;
mod shipped;
