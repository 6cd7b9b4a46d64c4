//! The polynomial in the hidden joint.

use super::Chart;
use super::circuit::Circuit;
use super::closer::View;
use super::line::{PRODUCTS, UNTURNED};
use super::linear::eliminate;
use super::pair::{Pair, Sums};
use super::posture::Values;
use super::triple::{self, Quadratic, Samples, TRIPLE, UNITY};
use super::waves::{MAX_DEGREE, Waves};
use super::wide::{LANES, Wide, cross, dot, matrix_vector, vector_if_greater};

/// Where half-angle tangents are counted from (rad): no place that a target is likely to ask for.
const OFFSETS: [f64; 3] = [0.0, 0.734_5, -0.412_3];

/// Products that the first two joints of the circuit have beside 1.
const PAIR: usize = 8;
const COLUMNS: usize = PAIR + TRIPLE;
/// Equations that are left.
pub(super) const LEFT: usize = PRODUCTS - PAIR;

/// Six equations, each a + b cos x + c sin x of the hidden joint, for the products of half-angle tangents: those of the
/// last joint (1, s, s²) times 1, times t² and times t of the joint that the resultant eliminates.
type Block = [[f64; LEFT]; 9];

/// The equations in three joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Resultant {
    /// Constant part, and those with cosine and sine of the hidden joint.
    parts: [Block; 3],
    /// What the resultant is to be divided by: two quadratics in exp(i x), complex coefficients from the constant on.
    factors: [Quadratic; 2],
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
    /// Eliminates joints 1 and 2 of the circuit. `None` where the joint that is to be hidden slides.
    pub(super) fn new(circuit: &Circuit, pair: Option<&Pair>, chart: Chart) -> Option<Self> {
        let [_, _, _, slides @ ..] = circuit.prismatic;
        let order = places(chart);
        let [hidden, first, last] = order.map(|place| slides.get(place).copied().unwrap_or(false));
        if hidden {
            return None;
        }
        let samples = triple::samples(circuit, &OFFSETS, order);
        let sums = pair.and_then(|pair| Some((pair, pair.sums()?)));
        let (mut equations, pivot) = match sums {
            Some((pair, sums)) => (pair_eliminated(&samples, pair, &sums), 1.0),
            None => eliminated(&samples, circuit),
        };
        let mut greatest = [0.0; LEFT];
        for sample in &equations {
            for (most, x) in greatest.iter_mut().zip(sample) {
                *most = if x.abs() > *most { x.abs() } else { *most };
            }
        }
        let scale = greatest.map(|x| if x > 0.0 { 1.0 / x } else { 0.0 });
        for sample in &mut equations {
            sample.iter_mut().zip(scale).for_each(|(x, scale)| *x *= scale);
        }
        for row in equations.as_chunks_mut::<3>().0 {
            *row = powers(row, last);
        }
        for face in equations.as_chunks_mut::<9>().0 {
            for k in 0..3 {
                [face[k], face[k + 3], face[k + 6]] = powers(&[face[k], face[k + 3], face[k + 6]], first);
            }
        }
        // Samples at an angle, a quarter and half a turn from there.
        let mut parts = [[[0.0; LEFT]; 9]; 3];
        let [constants, cosines, sines] = &mut parts;
        let [at0, at1, at2] = equations.as_chunks::<9>().0 else { return None };
        for k in 0..9 {
            for r in 0..LEFT {
                let mean = 0.5 * (at0[k][r] + at2[k][r]);
                constants[k][r] = mean;
                cosines[k][r] = at0[k][r] - mean;
                sines[k][r] = at1[k][r] - mean;
            }
        }
        // t behind its square.
        for [_, _, _, t0, t1, t2, s0, s1, s2] in &mut parts {
            core::mem::swap(t0, s0);
            core::mem::swap(t1, s1);
            core::mem::swap(t2, s2);
        }
        let factors = if chart.divided { triple::factors(&samples) } else { [UNITY; 2] };
        Some(Self { parts, factors, pivot, chart, slides })
    }

    /// At cosines and sines of the hidden joint.
    #[inline]
    fn sample(&self, cos: Wide, sin: Wide) -> Sample {
        let [constant, cosine, sine] = &self.parts;
        let mut rows = [[Wide::ZERO; 9]; LEFT];
        for (r, row) in rows.iter_mut().enumerate() {
            for (k, place) in row.iter_mut().enumerate() {
                *place = Wide::all(constant[k][r]) + cos * cosine[k][r] + sin * sine[k][r];
            }
        }
        let size = super::wide::eliminate::<LEFT, 9>(&mut rows);
        let row = |r: usize| [rows[r][6], rows[r][7], rows[r][8]];
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

    /// The resultant without the elimination of two thirds of the unknowns, which may itself be next to singular.
    #[cold]
    #[inline(never)]
    fn determinant(&self, cos: Wide, sin: Wide) -> Wide {
        let [constant, cosine, sine] = &self.parts;
        let mut products = [[Wide::ZERO; LEFT]; 9];
        for (k, column) in products.iter_mut().enumerate() {
            for (r, place) in column.iter_mut().enumerate() {
                *place = Wide::all(constant[k][r]) + cos * cosine[k][r] + sin * sine[k][r];
            }
        }
        let [a, b, c, d, e, f, g, h, i] = products;
        // By powers of t, and the same times t.
        let mut columns = [[Wide::ZERO; 2 * LEFT]; 12];
        for (k, column) in [a, b, c, g, h, i, d, e, f].into_iter().enumerate() {
            for (r, value) in column.into_iter().enumerate() {
                columns[k][r] = value;
                columns[k + 3][LEFT + r] = value;
            }
        }
        super::wide::solve::<12, 12, 12>(&mut columns)
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
    pub(super) fn waves(&self, view: View) -> (Waves, f64) {
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
            let (mut angles, mut sizes) = (Wide::ZERO, Wide::ZERO);
            for (lane, (angle, size)) in angles.0.iter_mut().zip(&mut sizes.0).enumerate() {
                (*angle, *size) = view.at(((LANES * k + lane) as f64 + 0.5) * turn);
            }
            let (cos, sin) = Values::new(false, angles * period).direction();
            let power = (0..degree).fold(Wide::ONE, |power, _| power * sizes);
            let value =
                if view.is_whole() { self.sample(cos, sin).value } else { self.determinant(cos, sin) };
            *values = (power * value / self.divisor(cos, sin)).0;
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

/// The equations without joints 1 and 2, at every sample.
fn pair_eliminated(samples: &Samples, pair: &Pair, sums: &Sums) -> [[f64; LEFT]; TRIPLE] {
    let [constants, ..] = &pair.parts;
    let mut constant = [0.0; LEFT];
    for k in UNTURNED {
        constant.iter_mut().zip(sums[k]).for_each(|(sum, weight)| *sum -= weight * constants[k]);
    }
    let mut equations = [constant; TRIPLE];
    for (equations, sample) in equations.iter_mut().zip(samples) {
        for (weights, x) in sums.iter().zip(sample) {
            equations.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * x);
        }
    }
    equations
}

/// The same for joints of all kinds, wherever they are, by a search for pivots. Also says how small the last one was
/// beside the greatest.
#[cold]
#[inline(never)]
fn eliminated(samples: &Samples, circuit: &Circuit) -> ([[f64; LEFT]; TRIPLE], f64) {
    let mut rows = [[0.0; COLUMNS]; PRODUCTS];
    let pair = circuit.pair();
    let [[constant, ..], ..] = pair;
    let columns = pair.iter().flatten().skip(1).chain(samples);
    for (index, column) in columns.enumerate() {
        for ((row, value), constant) in rows.iter_mut().zip(column).zip(constant) {
            if let Some(place) = row.get_mut(index) {
                *place = value - constant;
            }
        }
    }
    let (rank, pivot) = eliminate(&mut rows, PAIR);
    let mut equations = [[0.0; LEFT]; TRIPLE];
    // Where the two joints take fewer equations, the rest is added to the six: any six independent sums will do.
    for (index, row) in rows.iter().skip(rank).enumerate() {
        let [_, _, _, _, _, _, _, _, samples @ ..] = row;
        let greatest = samples
            .iter()
            .fold(0.0, |most: f64, x| if libm::fabs(*x) > most { libm::fabs(*x) } else { most });
        if greatest <= 0.0 {
            continue;
        }
        for (equations, value) in equations.iter_mut().zip(samples) {
            for (k, place) in equations.iter_mut().enumerate() {
                *place += weight(index, k) / greatest * value;
            }
        }
    }
    (equations, pivot)
}

/// From samples at an angle, a quarter turn and half a turn further (at 0, 1 and -1 of a slide) to the coefficients of 1,
/// t, t²: of the half-angle tangent, after multiplication by 1 + t² (of the slide itself).
#[inline]
fn powers([f0, f1, f2]: &[[f64; LEFT]; 3], prismatic: bool) -> [[f64; LEFT]; 3] {
    let mut powers = [*f0, [0.0; LEFT], *f2];
    let [_, one, two] = &mut powers;
    for r in 0..LEFT {
        if prismatic {
            one[r] = 0.5 * (f1[r] - f2[r]);
            two[r] = 0.5 * (f1[r] + f2[r]) - f0[r];
        } else {
            one[r] = 2.0 * f1[r] - f0[r] - f2[r];
        }
    }
    powers
}
