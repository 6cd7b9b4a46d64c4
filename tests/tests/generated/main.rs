//! What the attribute `dh_robot` generates, compiled and run.

mod drawn;
mod near;
mod searched;
mod shipped;
