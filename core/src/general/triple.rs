//! The three joints of the circuit that are not eliminated at once.

use super::circuit::Circuit;
use super::line::{Line, Motion, PRODUCTS, Products};

/// How many samples there are.
pub(super) const TRIPLE: usize = 27;

/// Products of the first joint's axis as joints 3, 4 and 5 of the circuit carry it, at three values of each: nine faces of
/// the first of these in an order that the caller chooses, three rows of the second, three values of the third.
pub(super) type Samples = [Products; TRIPLE];

/// The samples, counted from the offsets of joints 3, 4 and 5; the order is by the places of these joints (0, 1, 2).
pub(super) fn samples(circuit: &Circuit, offsets: &[f64; 3], order: [usize; 3]) -> Samples {
    let [.., near, third, fourth, fifth] = &circuit.links;
    let [at3, at4, at5] = *offsets;
    let mut strides = [0; 3];
    for (place, stride) in order.into_iter().zip([9, 3, 1]) {
        if let Some(to) = strides.get_mut(place) {
            *to = stride;
        }
    }
    let [stride3, stride4, stride5] = strides;
    let axis = Line::AXIS.moved(fifth);
    let mut samples = [[0.0; PRODUCTS]; TRIPLE];
    let threes = quarters(circuit.slides(3), at3);
    let fours = quarters(circuit.slides(4), at4);
    for (k, five) in quarters(circuit.slides(5), at5).iter().enumerate() {
        let carried = axis.by(five).moved(fourth);
        for (j, four) in fours.iter().enumerate() {
            let carried = carried.by(four).moved(third);
            for (i, three) in threes.iter().enumerate() {
                if let Some(place) = samples.get_mut(i * stride3 + j * stride4 + k * stride5) {
                    *place = carried.by(three).moved(near).products();
                }
            }
        }
    }
    samples
}

/// An offset, a quarter turn from there, and half a turn from there; 0, 1 and -1 for a slide.
fn quarters(prismatic: bool, offset: f64) -> [Motion; 3] {
    if prismatic {
        return [0.0, 1.0, -1.0].map(|value| Motion::new(true, value));
    }
    let (sin, cos) = crate::Float::sin_cos(offset);
    [Motion::turned(cos, sin), Motion::turned(-sin, cos), Motion::turned(-cos, -sin)]
}

/// A quadratic in exp(i x), complex coefficients from the constant on.
pub(super) type Quadratic = [[f64; 2]; 3];

pub(super) const UNITY: Quadratic = [[1.0, 0.0], [0.0; 2], [0.0; 2]];

/// The factors that the resultant has for every target.
///
/// Far out in the complex plane, at y and z infinite with one sense or the other, all products of the line are those of
/// exp(i y) exp(±i z). The coefficients of those that count most there are one and the same polynomial in exp(i x), times
/// constants. Where it is 0, so is the resultant.
pub(super) fn factors(samples: &Samples) -> [Quadratic; 2] {
    // Of every face the coefficients of cos y cos z, cos y sin z, sin y cos z and sin y sin z.
    let mut faces = [[[0.0; PRODUCTS]; 4]; 3];
    for (face, samples) in faces.iter_mut().zip(samples.as_chunks::<9>().0) {
        let [a, b, c, d, e, f, g, h, i] = samples;
        let [cos_cos, cos_sin, sin_cos, sin_sin] = face;
        for p in 0..PRODUCTS {
            let [c0, s0] = harmonic(a[p], b[p], c[p]);
            let [c1, s1] = harmonic(d[p], e[p], f[p]);
            let [c2, s2] = harmonic(g[p], h[p], i[p]);
            [cos_cos[p], sin_cos[p]] = harmonic(c0, c1, c2);
            [cos_sin[p], sin_sin[p]] = harmonic(s0, s1, s2);
        }
    }
    [1.0, -1.0].map(|sense| {
        let mut best = UNITY;
        let mut greatest = 0.0;
        for p in 0..PRODUCTS {
            let [at0, at1, at2] = faces.each_ref().map(|[cos_cos, cos_sin, sin_cos, sin_sin]| {
                [cos_cos[p] - sense * sin_sin[p], -sin_cos[p] - sense * cos_sin[p]]
            });
            let half = |a: f64, b: f64| 0.5 * (a + b);
            let mean = [half(at0[0], at2[0]), half(at0[1], at2[1])];
            let cosine = [half(at0[0], -at2[0]), half(at0[1], -at2[1])];
            let sine = [at1[0] - mean[0], at1[1] - mean[1]];
            // cos and sin of x as halves of exp(i x) and exp(-i x).
            let last = [half(cosine[0], sine[1]), half(cosine[1], -sine[0])];
            let first = [half(cosine[0], -sine[1]), half(cosine[1], sine[0])];
            let size = [first, mean, last].iter().flatten().fold(0.0, |sum, x| sum + x * x);
            if size > greatest {
                (best, greatest) = ([first, mean, last], size);
            }
        }
        let scale = 1.0 / libm::sqrt(greatest);
        best.map(|pair| pair.map(|x| x * scale))
    })
}

/// The coefficients of cosine and sine of what has these values at 0, a quarter and half a turn.
#[inline]
fn harmonic(at0: f64, at1: f64, at2: f64) -> [f64; 2] {
    [0.5 * (at0 - at2), at1 - 0.5 * (at0 + at2)]
}
