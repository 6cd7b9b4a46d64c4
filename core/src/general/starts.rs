//! Places all over the joint space, for Newton's method to be started from.

use super::JOINTS;

/// Where the equations say little, Newton's method is started from so many places and, for each solution that is known,
/// [`PATIENCE`] more, until none of them has led to a new one; but not from more than [`MOST_STARTS`].
pub(super) const STARTS: u32 = 48;
pub(super) const PATIENCE: u32 = 8;
const MOST_STARTS: u32 = 1024;

/// Joint values (rad, reaches) that fill the joint space evenly: multiples of the powers of 1/g, with g^7 = g + 1, that
/// generalises the golden section \[Roberts 2018, The unreasonable effectiveness of quasirandom sequences\].
pub(super) fn starts() -> impl Iterator<Item = [f64; JOINTS]> {
    const INVERSE: f64 = 0.898_653_712_628_699_3;
    (1..=MOST_STARTS).map(|k| {
        let mut power = f64::from(k);
        [0; JOINTS].map(|_| {
            power *= INVERSE;
            core::f64::consts::TAU * (power - libm::floor(power) - 0.5)
        })
    })
}
