//! A two-wheeled base driven with a joystick.

use std::f64::consts::FRAC_1_SQRT_2;

/// Speeds of the left and the right wheel for a stick at `x` (to the right) and `y` (forwards).
///
/// The stick's direction is turned by -45 degrees, so that pushing it diagonally forwards to the right drives the left
/// wheel alone: with `r` and `phi` the stick's polar coordinates, left = k r cos(phi - pi/4) and right =
/// k r sin(phi - pi/4). Written out, that is k (y + x) / sqrt 2 and k (y - x) / sqrt 2, which has no angle in it and is
/// exactly zero where a wheel stands still.
///
/// `gain` k is the speed of both wheels at full stick forwards, times sqrt 2; the speeds have its unit. To the right
/// alone, the right wheel turns backwards and the base on the spot.
///
/// ```
/// let [left, right] = dh_drivers::wheel_speeds([0.5, 0.5], 2.0_f64.sqrt());
/// assert!((left - 1.0).abs() < 1e-15);
/// assert_eq!(right, 0.0);
/// ```
pub fn wheel_speeds([x, y]: [f64; 2], gain: f64) -> [f64; 2] {
    let scale = gain * FRAC_1_SQRT_2;
    [scale * (y + x), scale * (y - x)]
}
