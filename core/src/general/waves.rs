//! A trigonometric polynomial.

use super::roots::Roots;
use super::wide::{Wide, product_plus};
use crate::Float;

/// The greatest degree.
pub(super) const MAX_DEGREE: usize = 12;
/// The most roots: as many real ones as a polynomial of the greatest degree can have.
pub(super) const MAX_ROOTS: usize = 2 * MAX_DEGREE;

/// Cells of a turn to begin with.
pub(super) const CELLS: usize = 64;
/// Half of them.
pub(super) const HALF: usize = CELLS / 2;
/// Their width (rad).
pub(super) const WIDTH: f64 = core::f64::consts::TAU / CELLS as f64;
/// Where the first one begins (rad): where no root is by reason of symmetry.
pub(super) const START: f64 = 0.123_4;
/// Cosine and sine of the width, and of the middle of the first cell.
const STEP: [f64; 2] = [0.995_184_726_672_196_9, 0.098_017_140_329_560_6];
const FIRST: [f64; 2] = [0.985_160_896_723_357_9, 0.171_633_352_141_212_25];
/// Cosines and sines of all multiples of the middles of half a turn of cells.
const MIDDLES: [[[f64; HALF]; 2]; MAX_DEGREE + 1] = {
    const fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
        [a * c - b * d, a * d + b * c]
    }
    let mut middles = [[[0.0; HALF]; 2]; MAX_DEGREE + 1];
    let mut middle = FIRST;
    let mut cell = 0;
    while cell < HALF {
        let mut power = [1.0, 0.0];
        let mut k = 0;
        while k <= MAX_DEGREE {
            middles[k][0][cell] = power[0];
            middles[k][1][cell] = power[1];
            power = product(power, middle);
            k += 1;
        }
        middle = product(middle, STEP);
        cell += 1;
    }
    middles
};
/// A step this short (rad) is the last one: the next would be its square.
pub(super) const LAST_STEP: f64 = 1e-9;
/// What is uncertain of a value, in multiples of the noise of the coefficients: they add up, and the noise is but that of
/// the two that should vanish. On 120,000 random poses of six arms, 30 and 1000 give the same 847,601 solutions, 3 gives
/// four fewer.
const CERTAIN: f64 = 30.0;
/// The least noise that is believed.
const ROUNDING: f64 = 1e-14;

/// f(x) = Re sum of (a + i b)_k exp(i k x).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Waves {
    coefficients: [[f64; 2]; MAX_DEGREE + 1],
    degree: usize,
    /// Bound on the third derivative.
    pub(super) third: f64,
    /// Values that are smaller may be 0.
    pub(super) uncertain: f64,
}

impl Waves {
    /// From coefficients of which the greatest is about 1, and their noise.
    pub(super) fn new(coefficients: [[f64; 2]; MAX_DEGREE + 1], degree: usize, noise: f64) -> Self {
        let mut third = 0.0;
        for (k, [a, b]) in coefficients.iter().enumerate() {
            let k = k as f64;
            third += k * k * k * libm::sqrt(a * a + b * b);
        }
        Self { coefficients, degree, third, uncertain: CERTAIN * Float::max(noise, ROUNDING) }
    }

    /// Of the second degree, from coefficients of which the greatest is about 1.
    pub(crate) fn quadratic(first: [[f64; 2]; 3]) -> Self {
        let mut coefficients = [[0.0; 2]; MAX_DEGREE + 1];
        coefficients.iter_mut().zip(first).for_each(|(coefficient, first)| *coefficient = first);
        Self::new(coefficients, 2, 0.0)
    }

    /// The same; values may be off by so much.
    pub(crate) fn quadratic_off_by(coefficients: [[f64; 2]; 3], off: f64) -> Self {
        let waves = Self::quadratic(coefficients);
        Self { uncertain: Float::max(off, waves.uncertain), ..waves }
    }

    /// Value and two derivatives.
    pub(super) fn at(&self, x: f64) -> [f64; 3] {
        let (sin, cos) = Float::sin_cos(x);
        let further = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * cos - b * sin + c, a * sin + b * cos + d];
        let [[f, _], [second, first], [third, _]] = self.sums([0.0; 2], |c| c, further);
        [f, -first, -(second + third + third)]
    }

    /// The same at several places at once.
    pub(super) fn at_all(&self, x: Wide) -> [Wide; 3] {
        let [mut cos, mut sin] = [x, x];
        for (sin, cos) in sin.0.iter_mut().zip(&mut cos.0) {
            (*sin, *cos) = Float::sin_cos(*sin);
        }
        let of = |[a, b]: [f64; 2]| [Wide::all(a), Wide::all(b)];
        let further = |by, plus| product_plus(by, [cos, sin], plus);
        let [[f, _], [second, first], [third, _]] = self.sums([Wide::ZERO; 2], of, further);
        [f, -first, -(second + third + third)]
    }

    /// p, z p' and z² p'' / 2 of the polynomial p, by Horner's scheme, which needs a number times z = exp(ix), plus another:
    /// f' = Re(i z p'), f'' = -Re(z p' + 2 z² p'' / 2).
    #[inline]
    fn sums<T: Copy>(&self, zero: T, of: impl Fn([f64; 2]) -> T, further: impl Fn(T, T) -> T) -> [T; 3] {
        let [mut p, mut d, mut e] = [zero; 3];
        for coefficient in self.coefficients.iter().take(self.degree + 1).rev() {
            e = further(e, d);
            d = further(d, p);
            p = further(p, of(*coefficient));
        }
        [p, further(d, zero), further(further(e, zero), zero)]
    }

    /// Values, first and second derivatives in the middle of every cell, of one half turn and of the other.
    pub(super) fn at_cells(&self) -> [[[f64; HALF]; 3]; 2] {
        // Half a turn further, odd multiples have the other sign.
        let mut sums = [[[0.0; HALF]; 3]; 2];
        let harmonics = self.coefficients.iter().zip(&MIDDLES).enumerate();
        for (k, ([a, b], [cosines, sines])) in harmonics.take(self.degree + 1) {
            let factor = k as f64;
            let [value, slope, bend] = &mut sums[k % 2];
            for cell in 0..HALF {
                let real = a * cosines[cell] - b * sines[cell];
                let imaginary = factor * (a * sines[cell] + b * cosines[cell]);
                value[cell] += real;
                slope[cell] -= imaginary;
                bend[cell] -= factor * factor * real;
            }
        }
        let [near, far] = &mut sums;
        for (even, odd) in near.as_flattened_mut().iter_mut().zip(far.as_flattened_mut()) {
            (*even, *odd) = (*even + *odd, *even - *odd);
        }
        sums
    }

    /// How near the polynomial was seen to come to 0, relative to its size.
    pub(crate) fn miss(&self, roots: &Roots) -> f64 {
        let size = self.coefficients.iter().fold(0.0, |sum, [a, b]| sum + libm::sqrt(a * a + b * b));
        if size > 0.0 { roots.least / size } else { f64::INFINITY }
    }
}
