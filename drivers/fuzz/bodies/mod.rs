//! What must hold of the drivers' parsers whatever the bytes: bodies of the fuzz targets, and of `tests/fuzz.rs`.
#![allow(dead_code, reason = "every fuzz target uses one of them")]

pub(crate) mod dynamixel;
pub(crate) mod mycobot;
mod parrot;
