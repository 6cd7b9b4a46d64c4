//! Ctrl-C: stops the arm on its path; a second time, or while it rests, ends the program. The arm holds either way.

use crate::failure::Failure;
use dh_drivers::motion::StopHandle;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a shell reports of a program that was ended by SIGINT.
const INTERRUPTED: i32 = 130;

static MOVING: AtomicBool = AtomicBool::new(false);

/// The arm moves as long as this lives.
pub(super) struct Moving(());

impl Moving {
    pub(super) fn begin() -> Self {
        MOVING.store(true, Ordering::SeqCst);
        Self(())
    }
}

impl Drop for Moving {
    fn drop(&mut self) {
        MOVING.store(false, Ordering::SeqCst);
    }
}

/// From now on SIGINT and SIGTERM stop the arm.
///
/// # Errors
/// Where the system refuses.
pub(super) fn install(stop: &StopHandle) -> Result<(), Failure> {
    let stop = stop.clone();
    let handler = move || {
        if MOVING.load(Ordering::SeqCst) && !stop.is_set() {
            stop.stop();
        } else {
            std::process::exit(INTERRUPTED);
        }
    };
    ctrlc::set_handler(handler).map_err(|error| Failure::Output(io::Error::other(error)))
}
