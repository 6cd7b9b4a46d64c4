//! The polynomial in the hidden joint.

use super::Chart;
use super::circuit::Circuit;
use super::closer::View;
use super::line::{PRODUCTS, TURNED, UNTURNED};
use super::linear::eliminate;
use super::pair::{Pair, Sums};
use super::posture::Values;
use super::triple::{OFFSETS, Quadratic, Triple};
use super::waves::{MAX_DEGREE, Waves};
use super::wide::{LANES, Wide, cross, dot, matrix_vector, vector_if_greater};

/// Products that the first two joints of the circuit have beside 1.
const PAIR: usize = 8;
/// How many products of half-angle tangents and parts of the hidden joint there are.
const TRIPLE: usize = 27;
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
    /// The last pivot of the first elimination beside its greatest, or the least of the six equations beside the greatest.
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
    pub(super) fn new(circuit: &Circuit, pair: Option<&Pair>, triple: &Triple, chart: Chart) -> Option<Self> {
        let [_, _, _, slides @ ..] = circuit.prismatic;
        let [hidden, _, _] = chart.places();
        if slides.get(hidden).copied().unwrap_or(false) {
            return None;
        }
        let sums = pair.and_then(|pair| Some((pair, pair.sums()?)));
        let (mut parts, pivot) = match sums {
            Some((pair, sums)) => (pair_eliminated(triple, pair, &sums), 1.0),
            None => eliminated(triple, circuit),
        };
        let mut greatest = [0.0; LEFT];
        for sample in parts.as_flattened() {
            for (most, x) in greatest.iter_mut().zip(sample) {
                *most = if x.abs() > *most { x.abs() } else { *most };
            }
        }
        // An equation that has vanished beside the others is made of rounding.
        let (least, most) = greatest.into_iter().fold((f64::INFINITY, 0.0), |(least, most), x| {
            (if x < least { x } else { least }, if x > most { x } else { most })
        });
        let pivot = if least < pivot * most { least / most } else { pivot };
        let scale = greatest.map(|x| if x > 0.0 { 1.0 / x } else { 0.0 });
        for sample in parts.as_flattened_mut() {
            sample.iter_mut().zip(scale).for_each(|(x, scale)| *x *= scale);
        }
        Some(Self { parts, factors: triple.factors, pivot, chart, slides })
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
        let mut values = [0.0; MOST];
        let turn = core::f64::consts::TAU / count as f64;
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
        // Half steps, to the last digit: their errors would be noise.
        let mut circle = [[0.0; 2]; 2 * MOST];
        for k in 0..count / 2 {
            let (sin, cos) = crate::Float::sin_cos(k as f64 * turn / 2.0);
            for (quarter, direction) in
                [[cos, sin], [-sin, cos], [-cos, -sin], [sin, -cos]].into_iter().enumerate()
            {
                if let Some(place) = circle.get_mut(quarter * count / 2 + k) {
                    *place = direction;
                }
            }
        }
        let mut coefficients = [[0.0; 2]; MAX_DEGREE + 1];
        let mut greatest = 0.0;
        let mut noise = 0.0;
        for harmonic in 0..=degree + 2 {
            let mut at = harmonic;
            let (mut a, mut b) = (0.0, 0.0);
            for value in values.iter().take(count) {
                let [cos, sin] = circle.get(at).copied().unwrap_or_default();
                a += value * cos;
                b -= value * sin;
                at += 2 * harmonic;
                if at >= 2 * count {
                    at -= 2 * count;
                }
            }
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
        let [hidden_place, first, last] = self.chart.places();
        let offset = offset(hidden_place);
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
        turned.turned_by(&offset(place))
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

/// Where the half-angle tangent of one of joints 3, 4 and 5 (0, 1, 2) is counted from.
fn offset(place: usize) -> Values {
    OFFSETS.get(place).map_or(Values::ZERO, |at| {
        let [cos, sin] = at.map(Wide::all);
        Values::turned(cos, sin)
    })
}

/// The equations without joints 1 and 2.
fn pair_eliminated(triple: &Triple, pair: &Pair, sums: &Sums) -> [Block; 3] {
    let [constants, ..] = &pair.parts;
    let mut constant = [0.0; LEFT];
    for k in UNTURNED {
        constant.iter_mut().zip(sums[k]).for_each(|(sum, weight)| *sum -= weight * constants[k]);
    }
    let mut blocks = [[[0.0; LEFT]; 9]; 3];
    let [constants, ..] = &mut blocks;
    for (equations, one) in constants.iter_mut().zip(triple.ones) {
        *equations = constant.map(|x| one * x);
    }
    for (equations, sample) in blocks.as_flattened_mut().iter_mut().zip(triple.parts.as_flattened()) {
        let [a, b, c, d, real, imaginary] = equations;
        for [x, y] in TURNED {
            // The weights of the two differ by a quarter turn.
            let [.., wa, wb] = sums[x];
            *real += wa * sample[x] - wb * sample[y];
            *imaginary += wb * sample[x] + wa * sample[y];
        }
        for k in UNTURNED {
            let [wa, wb, wc, wd, ..] = sums[k];
            *a += wa * sample[k];
            *b += wb * sample[k];
            *c += wc * sample[k];
            *d += wd * sample[k];
        }
    }
    blocks
}

/// The same for joints of all kinds, wherever they are, by a search for pivots. Also says how small the last one was
/// beside the greatest.
#[cold]
#[inline(never)]
fn eliminated(triple: &Triple, circuit: &Circuit) -> ([Block; 3], f64) {
    let mut rows = [[0.0; COLUMNS]; PRODUCTS];
    let pair = circuit.pair();
    let [[constant, ..], ..] = pair;
    let ones = triple.ones.into_iter().chain([0.0; TRIPLE - 9]);
    let columns = pair.iter().flatten().skip(1).map(|column| (column, 1.0));
    let columns = columns.chain(triple.parts.as_flattened().iter().zip(ones));
    for (index, (column, one)) in columns.enumerate() {
        for ((row, value), constant) in rows.iter_mut().zip(column).zip(constant) {
            if let Some(place) = row.get_mut(index) {
                *place = value - one * constant;
            }
        }
    }
    let (rank, pivot) = eliminate(&mut rows, PAIR);
    let mut blocks = [[[0.0; LEFT]; 9]; 3];
    // Where the two joints take fewer equations, the rest is added to the six: any six independent sums will do.
    for (index, row) in rows.iter().skip(rank).enumerate() {
        let [_, _, _, _, _, _, _, _, samples @ ..] = row;
        let greatest = samples
            .iter()
            .fold(0.0, |most: f64, x| if libm::fabs(*x) > most { libm::fabs(*x) } else { most });
        if greatest <= 0.0 {
            continue;
        }
        for (equations, value) in blocks.as_flattened_mut().iter_mut().zip(samples) {
            for (k, place) in equations.iter_mut().enumerate() {
                *place += weight(index, k) / greatest * value;
            }
        }
    }
    (blocks, pivot)
}
