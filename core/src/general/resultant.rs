//! The polynomial in the hidden joint.

use super::Chart;
use super::circuit::Circuit;
use super::line::PRODUCTS;
use super::linear::eliminate;
use super::posture::Values;
use super::waves::{MAX_DEGREE, Waves};
use super::wide::{LANES, Wide, cross, dot, matrix_vector, vector_if_greater};

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

/// The resultant at values of the hidden joint.
struct Sample {
    value: Wide,
    /// The products (1, s, s²) of the last joint, times 1 and t² of the eliminated one, from those times t.
    to_first: [[Wide; 3]; 3],
    to_last: [[Wide; 3]; 3],
    kernel: [[Wide; 3]; 3],
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

    /// At cosines and sines of the hidden joint.
    #[inline]
    fn sample(&self, cos: Wide, sin: Wide) -> Sample {
        let [constant, cosine, sine] = &self.parts;
        let mut columns = [[Wide::ZERO; LEFT]; 9];
        for r in 0..LEFT {
            for k in 0..9 {
                columns[k][r] = Wide::all(constant[r][k]) + cos * cosine[r][k] + sin * sine[r][k];
            }
        }
        let size = super::wide::solve::<LEFT, 9>(&mut columns);
        let [.., x, y, z] = columns;
        let row = |r: usize| [x[r], y[r], z[r]];
        let (to_first, to_last) = ([row(0), row(1), row(2)], [row(3), row(4), row(5)]);
        let mut kernel = [[Wide::ZERO; 3]; 3];
        for i in 0..3 {
            for k in 0..3 {
                let unit = if i == k { Wide::ONE } else { Wide::ZERO };
                kernel[i][k] = unit
                    - to_first[i][0] * to_last[0][k]
                    - to_first[i][1] * to_last[1][k]
                    - to_first[i][2] * to_last[2][k];
            }
        }
        let [[a, b, c], [d, e, f], [g, h, i]] = kernel;
        let determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
        Sample { value: size * size * determinant, to_first, to_last, kernel }
    }

    /// What stays 0 for every target where joints 3, 4 and 5 alone make it so.
    fn divisor(&self, cos: Wide, sin: Wide) -> Wide {
        let mut product = Wide::ONE;
        for [[a, b], [c, d], [e, f]] in self.factors {
            let [a, b, c, d] = [a, b, c, d].map(Wide::all);
            let (real, imaginary) = (c + cos * e - sin * f, d + sin * e + cos * f);
            let (real, imaginary) = (a + real * cos - imaginary * sin, b + real * sin + imaginary * cos);
            product = product * (real * real + imaginary * imaginary);
        }
        product
    }

    /// The polynomial, and the noise of its coefficients relative to the greatest.
    pub(super) fn waves(&self) -> (Waves, f64) {
        const MOST: usize = (2 * MAX_DEGREE + 6).next_multiple_of(LANES);
        let degree = usize::from(self.chart.degree).min(MAX_DEGREE);
        let period = 1.0 / f64::from(self.chart.periods.max(1));
        // Enough to see the two harmonics above the degree, which must be 0: one odd, one even.
        let count = (2 * degree + 4).next_multiple_of(LANES);
        let mut circle = [[0.0; 2]; MOST];
        let mut values = [0.0; MOST];
        let turn = core::f64::consts::TAU / count as f64;
        let (step_sin, step_cos) = libm::sincos(turn);
        let (mut cos, mut sin) = (1.0, 0.0);
        for place in circle.iter_mut().take(count) {
            *place = [cos, sin];
            (cos, sin) = (cos * step_cos - sin * step_sin, sin * step_cos + cos * step_sin);
        }
        for (k, values) in values.as_chunks_mut::<LANES>().0.iter_mut().enumerate().take(count / LANES) {
            // Half a step off, where factors that are divided out have no roots for reasons of symmetry.
            let (mut cos, mut sin) = (Wide::ZERO, Wide::ZERO);
            for (lane, (cos, sin)) in cos.0.iter_mut().zip(&mut sin.0).enumerate() {
                let angle = ((LANES * k + lane) as f64 + 0.5) * turn * period;
                (*sin, *cos) = crate::Float::sin_cos(angle);
            }
            *values = (self.sample(cos, sin).value / self.divisor(cos, sin)).0;
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

    /// Joints 3, 4 and 5 of the circuit where the hidden one is at roots.
    pub(super) fn others(&self, roots: Wide) -> [Values; 3] {
        let hidden = Values::new(false, roots);
        let (cos, sin) = hidden.direction();
        let sample = self.sample(cos, sin);
        let middle = null_vector(&sample.kernel);
        let first = matrix_vector(&sample.to_first, middle).map(|x| -x);
        let last = matrix_vector(&sample.to_last, middle).map(|x| -x);
        let [in_first, in_middle, in_last] = [first, middle, last].map(|v| dot(v, v));
        // t is the ratio of two of these three vectors: of those that are not next to 0.
        let below = vector_if_greater(in_first, in_last, first, middle);
        let above = vector_if_greater(in_first, in_last, middle, last);
        let mut ratio = (Wide::ZERO, Wide::ZERO);
        let mut most = -Wide::ONE;
        for (a, b) in below.into_iter().zip(above) {
            let size = a.abs() + b.abs();
            ratio = (size.if_greater(most, b, ratio.0), size.if_greater(most, a, ratio.1));
            most = size.if_greater(most, size, most);
        }
        let greatest = vector_if_greater(in_first, in_middle, first, middle);
        let size = in_first.if_greater(in_middle, in_first, in_middle);
        let [zero, one, two] = vector_if_greater(in_last, size, last, greatest);
        let (in_zero, in_two) = (zero.abs(), two.abs());
        let other = (in_two.if_greater(in_zero, two, one), in_two.if_greater(in_zero, one, zero));
        let [hidden_place, first, last] = places(self.chart);
        let offset = OFFSETS.get(hidden_place).map_or(Values::ZERO, |at| Values::new(false, Wide::all(*at)));
        let mut values = [Values::ZERO; 3];
        for (place, value) in [
            (hidden_place, hidden.turned_by(&offset)),
            (first, self.joint(first, ratio)),
            (last, self.joint(last, other)),
        ] {
            if let Some(to) = values.get_mut(place) {
                *to = value;
            }
        }
        values
    }

    /// The values of a joint whose half-angle tangents are ratios.
    fn joint(&self, place: usize, (numerator, denominator): (Wide, Wide)) -> Values {
        if self.slides.get(place).copied().unwrap_or(false) {
            return Values::slid(numerator / denominator);
        }
        let (above, below) = (numerator * numerator, denominator * denominator);
        let scale = Wide::ONE / (above + below);
        let product = numerator * denominator;
        let turned = Values::turned((below - above) * scale, (product + product) * scale);
        let offset = OFFSETS.get(place).copied().unwrap_or(0.0);
        turned.turned_by(&Values::new(false, Wide::all(offset)))
    }
}

/// The vectors that are nearest to being sent to 0 by matrices of rank 2: the greatest cross products of two rows.
fn null_vector(rows: &[[Wide; 3]; 3]) -> [Wide; 3] {
    let [a, b, c] = *rows;
    let mut best = cross(a, b);
    let mut greatest = dot(best, best);
    for vector in [cross(b, c), cross(c, a)] {
        let size = dot(vector, vector);
        best = vector_if_greater(size, greatest, vector, best);
        greatest = size.if_greater(greatest, size, greatest);
    }
    best
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
