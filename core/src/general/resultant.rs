//! The polynomial in the hidden joint.

use super::Chart;
use super::circuit::Circuit;
use super::line::PRODUCTS;
use super::linear::{determinant, eliminate, null_vector, solve};
use super::waves::{MAX_DEGREE, Waves};

/// Where half-angle tangents are counted from (rad): no place that a target is likely to ask for.
const OFFSETS: [f64; 3] = [0.0, 0.734_5, -0.412_3];

/// Products that the first two joints of the circuit have beside 1.
const PAIR: usize = 8;
/// Samples of the other three.
const TRIPLE: usize = 27;
const COLUMNS: usize = PAIR + TRIPLE;
/// Equations that are left.
const LEFT: usize = PRODUCTS - PAIR;

/// Six equations, each a + b cos x + c sin x of the hidden joint, for the products of half-angle tangents: those of the
/// last joint (1, s, s²) times 1, times t² and times t of the joint that the resultant eliminates.
type Block = [[f64; 9]; LEFT];

/// The equations in three joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Resultant {
    /// Constant part, and those with cosine and sine of the hidden joint.
    parts: [Block; 3],
    /// What the resultant is to be divided by: two quadratics in exp(i x), complex coefficients from the constant on.
    factors: [[[f64; 2]; 3]; 2],
    /// The last pivot of the first elimination beside its greatest.
    pub(super) pivot: f64,
    chart: Chart,
    /// Whether joints 3, 4 and 5 slide.
    slides: [bool; 3],
}

/// The resultant at one value of the hidden joint.
struct Sample {
    value: f64,
    /// The products (1, s, s²) of the last joint, times 1 and t² of the eliminated one, from those times t.
    to_first: [[f64; 3]; 3],
    to_last: [[f64; 3]; 3],
    kernel: [[f64; 3]; 3],
}

impl Resultant {
    /// Eliminates joints 1 and 2 of the circuit. `None` where fewer than six equations are left.
    pub(super) fn new(circuit: &Circuit, chart: Chart) -> Option<Self> {
        let [_, _, _, slides @ ..] = circuit.prismatic;
        let mut rows = [[0.0; COLUMNS]; PRODUCTS];
        let pair = circuit.pair();
        let triple = order(&circuit.triple(&OFFSETS), chart);
        let [[constant, ..], ..] = pair;
        let columns = pair.iter().flatten().skip(1).chain(triple.iter().flatten().flatten());
        for (index, column) in columns.enumerate() {
            for ((row, value), constant) in rows.iter_mut().zip(column).zip(constant) {
                if let Some(place) = row.get_mut(index) {
                    *place = value - constant;
                }
            }
        }
        let (rank, pivot) = eliminate(&mut rows, PAIR);
        let mut equations = [[0.0; TRIPLE]; LEFT];
        // Where the two joints take fewer equations, the rest is added to the six: any six independent sums will do.
        for (index, row) in rows.iter().skip(rank).enumerate() {
            let [_, _, _, _, _, _, _, _, samples @ ..] = row;
            let greatest = samples
                .iter()
                .fold(0.0, |most: f64, x| if libm::fabs(*x) > most { libm::fabs(*x) } else { most });
            if greatest <= 0.0 {
                continue;
            }
            for (k, equation) in equations.iter_mut().enumerate() {
                let weight = weight(index, k);
                if weight != 0.0 {
                    for (place, value) in equation.iter_mut().zip(samples) {
                        *place += weight / greatest * value;
                    }
                }
            }
        }
        let [hidden, first, last] = places(chart).map(|place| slides.get(place).copied().unwrap_or(false));
        if hidden {
            return None;
        }
        let mut parts = [[[0.0; 9]; LEFT]; 3];
        let [constants, cosines, sines] = &mut parts;
        let blocks = constants.iter_mut().zip(cosines).zip(sines);
        for (equation, ((constant, cosine), sine)) in equations.iter().zip(blocks) {
            let mut faces = [[[0.0; 3]; 3]; 3];
            for (face, samples) in faces.iter_mut().zip(equation.as_chunks::<9>().0) {
                let [a, b, c, d, e, f, g, h, i] = *samples;
                let [x, y, z] = [powers([a, b, c], last), powers([d, e, f], last), powers([g, h, i], last)];
                for k in 0..3 {
                    [face[0][k], face[1][k], face[2][k]] = powers([x[k], y[k], z[k]], first);
                }
            }
            // Samples at an angle, a quarter and half a turn from there.
            let [at0, at1, at2] = faces;
            for (from, to) in [(0, 0), (2, 3), (1, 6)] {
                for k in 0..3 {
                    let mean = f64::midpoint(at0[from][k], at2[from][k]);
                    constant[to + k] = mean;
                    cosine[to + k] = at0[from][k] - mean;
                    sine[to + k] = at1[from][k] - mean;
                }
            }
        }
        let factors = if chart.divided { [factor(&triple, 1.0), factor(&triple, -1.0)] } else { [UNITY; 2] };
        Some(Self { parts, factors, pivot, chart, slides })
    }

    /// At cosine and sine of the hidden joint.
    #[inline]
    fn sample(&self, cos: f64, sin: f64) -> Sample {
        let [constant, cosine, sine] = &self.parts;
        let mut rows = [[0.0; 9]; LEFT];
        for (((row, a), b), c) in rows.iter_mut().zip(constant).zip(cosine).zip(sine) {
            for k in 0..9 {
                row[k] = a[k] + b[k] * cos + c[k] * sin;
            }
        }
        let size = solve::<LEFT, 9>(&mut rows);
        let [r0, r1, r2, r3, r4, r5] = rows.map(|[.., x, y, z]| [x, y, z]);
        let (to_first, to_last) = ([r0, r1, r2], [r3, r4, r5]);
        let product = crate::frame::matrix_product(&to_first, &to_last);
        let mut kernel = product.map(|row| row.map(|x| -x));
        for (k, row) in kernel.iter_mut().enumerate() {
            if let Some(diagonal) = row.get_mut(k) {
                *diagonal += 1.0;
            }
        }
        Sample { value: size * size * determinant(&kernel), to_first, to_last, kernel }
    }

    /// What stays 0 for every target where joints 3, 4 and 5 alone make it so.
    fn divisor(&self, cos: f64, sin: f64) -> f64 {
        let mut product = 1.0;
        for [[a, b], [c, d], [e, f]] in self.factors {
            let (real, imaginary) = (c + e * cos - f * sin, d + e * sin + f * cos);
            let (real, imaginary) = (a + real * cos - imaginary * sin, b + real * sin + imaginary * cos);
            product *= real * real + imaginary * imaginary;
        }
        product
    }

    /// The polynomial, and the noise of its coefficients relative to the greatest.
    pub(super) fn waves(&self) -> (Waves, f64) {
        const MOST: usize = 2 * MAX_DEGREE + 6;
        let degree = usize::from(self.chart.degree).min(MAX_DEGREE);
        let period = 1.0 / f64::from(self.chart.periods.max(1));
        // Enough to see the two harmonics above the degree, which must be 0: one odd, one even.
        let count = 2 * degree + 6;
        let mut circle = [[0.0; 2]; MOST];
        let mut values = [0.0; MOST];
        let turn = core::f64::consts::TAU / count as f64;
        let (step_sin, step_cos) = libm::sincos(turn);
        let (mut cos, mut sin) = (1.0, 0.0);
        for (k, (place, value)) in circle.iter_mut().zip(&mut values).enumerate().take(count) {
            *place = [cos, sin];
            (cos, sin) = (cos * step_cos - sin * step_sin, sin * step_cos + cos * step_sin);
            // Half a step off, where factors that are divided out have no roots for reasons of symmetry.
            let (sin, cos) = libm::sincos((k as f64 + 0.5) * turn * period);
            *value = self.sample(cos, sin).value / self.divisor(cos, sin);
        }
        let mut coefficients = [[0.0; 2]; MAX_DEGREE + 1];
        let mut greatest = 0.0;
        let mut noise = 0.0;
        for harmonic in 0..=degree + 2 {
            let mut at = 0;
            let (mut a, mut b) = (0.0, 0.0);
            for value in values.iter().take(count) {
                let [cos, sin] = circle.get(at).copied().unwrap_or_default();
                a += value * cos;
                b -= value * sin;
                at += harmonic;
                if at >= count {
                    at -= count;
                }
            }
            let (sin, cos) = libm::sincos(harmonic as f64 * turn / 2.0);
            let (a, b) = (a * cos + b * sin, b * cos - a * sin);
            let size = libm::fabs(a) + libm::fabs(b);
            if let Some(place) = coefficients.get_mut(harmonic).filter(|_| harmonic <= degree) {
                *place = if harmonic == 0 { [a, 0.0] } else { [2.0 * a, 2.0 * b] };
                greatest = if size > greatest { size } else { greatest };
            } else {
                noise = if size > noise { size } else { noise };
            }
        }
        let scale = if greatest > 0.0 { 1.0 / greatest } else { 1.0 };
        let coefficients = coefficients.map(|pair| pair.map(|x| x * scale));
        let noise = if greatest > 0.0 { noise / greatest } else { f64::INFINITY };
        (Waves::new(coefficients, degree, noise), noise)
    }

    /// Joints 3, 4 and 5 of the circuit where the hidden one is at a root.
    pub(super) fn others(&self, root: f64) -> [f64; 3] {
        let (sin, cos) = libm::sincos(root);
        let sample = self.sample(cos, sin);
        let middle = null_vector(&sample.kernel);
        let first = crate::frame::matrix_vector(&sample.to_first, middle).map(|x| -x);
        let last = crate::frame::matrix_vector(&sample.to_last, middle).map(|x| -x);
        let square = |v: [f64; 3]| crate::frame::dot(v, v);
        // t is the ratio of two of these three vectors: of those that are not next to 0.
        let (below, above) = if square(first) > square(last) { (first, middle) } else { (middle, last) };
        let greatest = [first, middle, last]
            .into_iter()
            .fold(middle, |most, v| if square(v) > square(most) { v } else { most });
        let mut index = 0;
        let mut most = -1.0;
        for (k, (a, b)) in below.iter().zip(above).enumerate() {
            let size = libm::fabs(*a) + libm::fabs(b);
            if size > most {
                (index, most) = (k, size);
            }
        }
        let pick = |v: [f64; 3]| v.get(index).copied().unwrap_or(0.0);
        let [zero, one, two] = greatest;
        let ratio = if libm::fabs(zero) >= libm::fabs(two) { (one, zero) } else { (two, one) };
        let [_, first, last] = places(self.chart);
        let hidden = usize::from(self.chart.hidden % 3);
        let mut values = [0.0; 3];
        for (place, value) in [
            (hidden, root),
            (first, self.joint(first, pick(above), pick(below))),
            (last, self.joint(last, ratio.0, ratio.1)),
        ] {
            if let Some(to) = values.get_mut(place) {
                *to = value + if place == hidden { hidden_offset(hidden) } else { 0.0 };
            }
        }
        values
    }

    /// The value of a joint whose half-angle tangent is a ratio.
    fn joint(&self, place: usize, numerator: f64, denominator: f64) -> f64 {
        if self.slides.get(place).copied().unwrap_or(false) {
            return numerator / denominator;
        }
        2.0 * libm::atan2(numerator, denominator) + OFFSETS.get(place).copied().unwrap_or(0.0)
    }
}

fn hidden_offset(place: usize) -> f64 {
    OFFSETS.get(place).copied().unwrap_or(0.0)
}

/// How much of a row is in an equation: the first six rows are equations, further ones are spread over them.
fn weight(row: usize, equation: usize) -> f64 {
    if row < LEFT {
        return if row == equation { 1.0 } else { 0.0 };
    }
    // Multiples of the golden section: no two rows are spread alike.
    let x = 0.618_033_988_749_894_9 * (row * LEFT + equation) as f64;
    x - libm::floor(x) - 0.5
}

/// Which of the three joints is hidden, eliminated, last.
fn places(chart: Chart) -> [usize; 3] {
    let [hidden, first, last] = match chart.hidden % 3 {
        0 => [0, 1, 2],
        1 => [1, 0, 2],
        _ => [2, 0, 1],
    };
    if chart.swapped { [hidden, last, first] } else { [hidden, first, last] }
}

/// The samples with the hidden joint first, then the one to be eliminated.
fn order(samples: &Samples, chart: Chart) -> Samples {
    let [hidden, first, last] = places(chart);
    let mut sorted = [[[[0.0; PRODUCTS]; 3]; 3]; 3];
    for (i, face) in sorted.iter_mut().enumerate() {
        for (j, row) in face.iter_mut().enumerate() {
            for (k, place) in row.iter_mut().enumerate() {
                let mut at = [0; 3];
                for (to, index) in [(hidden, i), (first, j), (last, k)] {
                    if let Some(to) = at.get_mut(to) {
                        *to = index;
                    }
                }
                let [x, y, z] = at;
                if let Some(sample) = samples.get(x).and_then(|face| face.get(y)).and_then(|row| row.get(z)) {
                    *place = *sample;
                }
            }
        }
    }
    sorted
}

/// From samples at an angle, a quarter turn and half a turn further (at 0, 1 and -1 of a slide) to the coefficients of 1,
/// t, t²: of the half-angle tangent, after multiplication by 1 + t² (of the slide itself).
fn powers([f0, f1, f2]: [f64; 3], prismatic: bool) -> [f64; 3] {
    if prismatic {
        [f0, f64::midpoint(f1, -f2), f64::midpoint(f1, f2) - f0]
    } else {
        [f0, 2.0 * f1 - f0 - f2, f2]
    }
}

/// Products of the line at three values of each of joints 3, 4 and 5.
type Samples = [[[super::line::Products; 3]; 3]; 3];

const UNITY: [[f64; 2]; 3] = [[1.0, 0.0], [0.0; 2], [0.0; 2]];

/// The factor that the resultant has for every target.
///
/// Far out in the complex plane, at y and z infinite with one sense or the other, all products of the line are those of
/// exp(i y) exp(±i z). The coefficients of those that count most there are one and the same polynomial in exp(i x), times
/// constants. Where it is 0, so is the resultant.
fn factor(triple: &Samples, sense: f64) -> [[f64; 2]; 3] {
    let mut best = UNITY;
    let mut greatest = 0.0;
    for product in 0..PRODUCTS {
        let mut faces = [[0.0; 2]; 3];
        for (at, face) in faces.iter_mut().zip(triple) {
            let [x, y, z] = face;
            let row = |[a, b, c]: &[super::line::Products; 3]| {
                wave([[a[product], 0.0], [b[product], 0.0], [c[product], 0.0]], sense)
            };
            *at = wave([row(x), row(y), row(z)], 1.0);
        }
        let [at0, at1, at2] = faces;
        let half = |a: f64, b: f64| f64::midpoint(a, b);
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
}

/// Twice the coefficient of exp(± i u) of what has these values at u = 0, a quarter and half a turn.
fn wave([[a0, b0], [a1, b1], [a2, b2]]: [[f64; 2]; 3], sense: f64) -> [f64; 2] {
    let (cosine, sine) = (
        [f64::midpoint(a0, -a2), f64::midpoint(b0, -b2)],
        [a1 - f64::midpoint(a0, a2), b1 - f64::midpoint(b0, b2)],
    );
    [cosine[0] + sense * sine[1], cosine[1] - sense * sine[0]]
}
