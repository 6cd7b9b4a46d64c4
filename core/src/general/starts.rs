//! Places for Newton's method to be started from.

use super::JOINTS;
use super::wide::LANES;
use crate::evenly::evenly;

/// Where the equations say little, Newton's method is started from so many places and, for each solution that is known,
/// [`PATIENCE`] more, until none of them has led to a new one; but not from more than [`MOST_STARTS`].
pub(super) const STARTS: usize = 48;
pub(super) const PATIENCE: usize = 8;
const MOST_STARTS: u32 = 2048;
/// So many times as many, where there is nothing else, or some must be missing.
pub(crate) const MORE: usize = 8;

/// Joint values (rad, reaches) that fill the joint space evenly.
pub(super) fn everywhere() -> impl Iterator<Item = [f64; JOINTS]> {
    (1..=MOST_STARTS)
        .map(|number| evenly::<f64, JOINTS>(number, JOINTS).map(|part| core::f64::consts::TAU * part))
}

/// Some places.
pub(super) struct Starts {
    list: [[f64; JOINTS]; LANES],
    len: usize,
}

impl Starts {
    /// As many of them as are done at once.
    pub(super) fn next(places: &mut impl Iterator<Item = [f64; JOINTS]>) -> Option<Self> {
        let mut starts = Self { list: [[0.0; JOINTS]; LANES], len: 0 };
        for (to, place) in starts.list.iter_mut().zip(places) {
            *to = place;
            starts.len += 1;
        }
        (starts.len > 0).then_some(starts)
    }

    pub(super) fn as_slice(&self) -> &[[f64; JOINTS]] {
        self.list.get(..self.len).unwrap_or(&self.list)
    }
}
