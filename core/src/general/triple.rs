//! The three joints of the circuit that are not eliminated at once. What they make of the line does not depend on the target
//! where it stands behind the other three: then it can be computed when an arm is compiled, by `const` functions.

use super::chart::Chart;
use super::line::{Line, Motion, PRODUCTS, Products};
use super::{GeneralArm, JOINTS};
use crate::Frame;

/// Where half-angle tangents of these joints are counted from, by cosine and sine: 0, 0.7345 and -0.4123 rad, no places that a
/// target is likely to ask for.
pub(super) const OFFSETS: [[f64; 2]; 3] = [
    [1.0, 0.0],
    [0.742_165_954_237_334_3, 0.670_216_156_453_264_7],
    [0.916_201_596_387_047, -0.400_717_649_695_925_66],
];

/// How many samples there are: three values of each joint.
const SAMPLES: usize = 27;

/// The products of the first joint's axis as joints 3, 4 and 5 of the circuit carry it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triple {
    /// Constant part, and those with cosine and sine of the hidden joint: for the products of half-angle tangents, those of
    /// the last joint (1, s, s²) times 1, times t² and times t of the joint that the resultant eliminates.
    pub(super) parts: [[Products; 9]; 3],
    /// The same of the constant part of what is 1.
    pub(super) ones: [f64; 9],
    /// What the resultant is to be divided by.
    pub(super) factors: [Quadratic; 2],
}

impl GeneralArm<'_> {
    /// What the three joints that the first choice hides, eliminates last and leaves do whatever the target is; `None` where it
    /// has a say in that, and where some joints are given.
    pub const fn triple(&self) -> Option<Triple> {
        if self.links.len() != JOINTS + 1 || self.prismatic.len() != JOINTS || self.charts.is_empty() {
            return None;
        }
        let chart = self.charts[0];
        let mut links = [Frame::IDENTITY; 4];
        let mut slides = [false; 4];
        let mut k = 0;
        while k < links.len() {
            let joint = chart.place(k + 2);
            let after = if chart.backward { (joint + JOINTS - 1) % JOINTS } else { joint };
            if after + 1 == JOINTS {
                return None;
            }
            let mut link = self.links[after + 1];
            let [x, y, z] = link.translation;
            link.translation = [x / self.reach, y / self.reach, z / self.reach];
            links[k] = if chart.backward { inverse(&link) } else { link };
            slides[k] = self.prismatic[joint];
            k += 1;
        }
        let [_, slides @ ..] = slides;
        Some(Triple::new(&links, slides, chart))
    }
}

impl Triple {
    /// From the links behind joints 2 to 5 of the circuit, and which of joints 3, 4 and 5 slide.
    pub(super) const fn new(links: &[Frame; 4], slides: [bool; 3], chart: Chart) -> Self {
        let [hidden, first, last] = chart.places();
        let samples = samples(links, slides, [hidden, first, last]);
        let factors = if chart.divided { factors(&samples) } else { [UNITY; 2] };
        let (slides_first, slides_last) = (slides[first % 3], slides[last % 3]);
        let mut faces = [[[0.0; PRODUCTS]; 9]; 3];
        let mut face = 0;
        while face < 3 {
            let at = 9 * face;
            let [[a, b, c], [d, e, f], [g, h, i]] = [
                powers(&[samples[at], samples[at + 1], samples[at + 2]], slides_last),
                powers(&[samples[at + 3], samples[at + 4], samples[at + 5]], slides_last),
                powers(&[samples[at + 6], samples[at + 7], samples[at + 8]], slides_last),
            ];
            let [a, d, g] = powers(&[a, d, g], slides_first);
            let [b, e, h] = powers(&[b, e, h], slides_first);
            let [c, f, i] = powers(&[c, f, i], slides_first);
            // t behind its square.
            faces[face] = [a, b, c, g, h, i, d, e, f];
            face += 1;
        }
        // Faces at an angle, a quarter and half a turn from there.
        let mut parts = faces;
        let mut k = 0;
        while k < 9 {
            let mut p = 0;
            while p < PRODUCTS {
                let mean = 0.5 * (faces[0][k][p] + faces[2][k][p]);
                parts[0][k][p] = mean;
                parts[1][k][p] = faces[0][k][p] - mean;
                parts[2][k][p] = faces[1][k][p] - mean;
                p += 1;
            }
            k += 1;
        }
        let s = if slides_last { 0.0 } else { 1.0 };
        let t = if slides_first { 0.0 } else { 1.0 };
        Self { parts, ones: [1.0, 0.0, s, t, 0.0, s * t, 0.0, 0.0, 0.0], factors }
    }
}

/// The products at three values of each joint, counted from the offsets; the order is by the places of these joints (0, 1,
/// 2): nine faces of the first, three rows of the second, three values of the third.
const fn samples(links: &[Frame; 4], slides: [bool; 3], order: [usize; 3]) -> [Products; SAMPLES] {
    let [near, third, fourth, fifth] = links;
    let mut strides = [0; 3];
    strides[order[0] % 3] = 9;
    strides[order[1] % 3] = 3;
    strides[order[2] % 3] = 1;
    let axis = Line::AXIS.moved(fifth);
    let mut samples = [[0.0; PRODUCTS]; SAMPLES];
    let threes = quarters(slides[0], OFFSETS[0]);
    let fours = quarters(slides[1], OFFSETS[1]);
    let fives = quarters(slides[2], OFFSETS[2]);
    let mut k = 0;
    while k < 3 {
        let carried = axis.by(&fives[k]).moved(fourth);
        let mut j = 0;
        while j < 3 {
            let carried = carried.by(&fours[j]).moved(third);
            let mut i = 0;
            while i < 3 {
                let at = i * strides[0] + j * strides[1] + k * strides[2];
                if at < SAMPLES {
                    samples[at] = carried.by(&threes[i]).moved(near).products();
                }
                i += 1;
            }
            j += 1;
        }
        k += 1;
    }
    samples
}

/// An offset, a quarter turn from there, and half a turn from there; 0, 1 and -1 for a slide.
const fn quarters(prismatic: bool, [cos, sin]: [f64; 2]) -> [Motion; 3] {
    if prismatic {
        return [Motion::slid(0.0), Motion::slid(1.0), Motion::slid(-1.0)];
    }
    [Motion::turned(cos, sin), Motion::turned(-sin, cos), Motion::turned(-cos, -sin)]
}

/// From samples at an angle, a quarter turn and half a turn further (at 0, 1 and -1 of a slide) to the coefficients of 1,
/// t, t²: of the half-angle tangent, after multiplication by 1 + t² (of the slide itself).
const fn powers([f0, f1, f2]: &[Products; 3], prismatic: bool) -> [Products; 3] {
    let mut powers = [*f0, *f1, *f2];
    let mut p = 0;
    while p < PRODUCTS {
        if prismatic {
            powers[1][p] = 0.5 * (f1[p] - f2[p]);
            powers[2][p] = 0.5 * (f1[p] + f2[p]) - f0[p];
        } else {
            powers[1][p] = 2.0 * f1[p] - f0[p] - f2[p];
        }
        p += 1;
    }
    powers
}

/// A quadratic in exp(i x), complex coefficients from the constant on.
pub(super) type Quadratic = [[f64; 2]; 3];

const UNITY: Quadratic = [[1.0, 0.0], [0.0; 2], [0.0; 2]];

/// The factors that the resultant has for every target.
///
/// Far out in the complex plane, at y and z infinite with one sense or the other, all products of the line are those of
/// exp(i y) exp(±i z). The coefficients of those that count most there are one and the same polynomial in exp(i x), times
/// constants. Where it is 0, so is the resultant.
const fn factors(samples: &[Products; SAMPLES]) -> [Quadratic; 2] {
    [factor(samples, 1.0), factor(samples, -1.0)]
}

const fn factor(samples: &[Products; SAMPLES], sense: f64) -> Quadratic {
    let mut best = UNITY;
    let mut greatest = 0.0;
    let mut p = 0;
    while p < PRODUCTS {
        // Of every face the coefficients of cos y cos z, cos y sin z, sin y cos z and sin y sin z, as real and imaginary part.
        let mut at = [[0.0; 2]; 3];
        let mut face = 0;
        while face < 3 {
            let k = 9 * face;
            let [c0, s0] = harmonic(samples[k][p], samples[k + 1][p], samples[k + 2][p]);
            let [c1, s1] = harmonic(samples[k + 3][p], samples[k + 4][p], samples[k + 5][p]);
            let [c2, s2] = harmonic(samples[k + 6][p], samples[k + 7][p], samples[k + 8][p]);
            let [cos_cos, sin_cos] = harmonic(c0, c1, c2);
            let [cos_sin, sin_sin] = harmonic(s0, s1, s2);
            at[face] = [cos_cos - sense * sin_sin, -sin_cos - sense * cos_sin];
            face += 1;
        }
        let [at0, at1, at2] = at;
        let mean = [half(at0[0], at2[0]), half(at0[1], at2[1])];
        let cosine = [half(at0[0], -at2[0]), half(at0[1], -at2[1])];
        let sine = [at1[0] - mean[0], at1[1] - mean[1]];
        // cos and sin of x as halves of exp(i x) and exp(-i x).
        let last = [half(cosine[0], sine[1]), half(cosine[1], -sine[0])];
        let first = [half(cosine[0], -sine[1]), half(cosine[1], sine[0])];
        let size = square(first) + square(mean) + square(last);
        if size > greatest {
            greatest = size;
            best = [first, mean, last];
        }
        p += 1;
    }
    best
}

const fn half(a: f64, b: f64) -> f64 {
    0.5 * (a + b)
}

const fn square([a, b]: [f64; 2]) -> f64 {
    a * a + b * b
}

/// The coefficients of cosine and sine of what has these values at 0, a quarter and half a turn.
const fn harmonic(at0: f64, at1: f64, at2: f64) -> [f64; 2] {
    [0.5 * (at0 - at2), at1 - 0.5 * (at0 + at2)]
}

/// The inverse motion of an orthogonal frame.
const fn inverse(frame: &Frame) -> Frame {
    let [[a, b, c], [d, e, f], [g, h, i]] = frame.rotation;
    let [x, y, z] = frame.translation;
    Frame {
        rotation: [[a, d, g], [b, e, h], [c, f, i]],
        translation: [-(a * x + d * y + g * z), -(b * x + e * y + h * z), -(c * x + f * y + i * z)],
    }
}
