//! Poses that solvers are asked for, made of joint values.

use std::f64::consts::{FRAC_PI_2, PI};

/// Rows of `[R | p]`, p in metres.
pub type Matrix = [[f64; 4]; 3];

/// Joint values, and where they bring the tool.
pub struct Case {
    pub q: [f64; 6],
    pub pose: Matrix,
}

/// The same numbers on every run, in 0 ... 1.
pub fn draw(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Joint values anywhere in -pi ... pi.
pub fn random(count: usize, fk: impl Fn(&[f64; 6]) -> Matrix) -> Vec<Case> {
    let mut state = 20_260_101;
    let mut drawn = || [0; 6].map(|_| PI * (2.0 * draw(&mut state) - 1.0));
    (0..count).map(|_| drawn()).map(|q| Case { q, pose: fk(&q) }).collect()
}

/// Joint values that are multiples of a quarter turn: poses with every kind of singularity.
pub fn lattice(count: usize, fk: impl Fn(&[f64; 6]) -> Matrix) -> Vec<Case> {
    let mut state = 20_260_102;
    let mut drawn = || [0; 6].map(|_| FRAC_PI_2 * (4.0 * draw(&mut state)).floor() - PI);
    (0..count).map(|_| drawn()).map(|q| Case { q, pose: fk(&q) }).collect()
}
