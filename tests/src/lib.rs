//! What crosses crates: agreement of every engine, compile tests, round trips, devices end to end.

pub mod plans;
