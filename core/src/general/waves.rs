//! Real roots of a trigonometric polynomial.

use super::roots::Roots;
use crate::Float;

/// The greatest degree.
pub(super) const MAX_DEGREE: usize = 12;
/// The most roots: as many real ones as a polynomial of the greatest degree can have.
pub(super) const MAX_ROOTS: usize = 2 * MAX_DEGREE;

/// Cells of a turn to begin with.
const CELLS: usize = 64;
/// Half of them.
const HALF: usize = CELLS / 2;
/// Their width (rad).
const WIDTH: f64 = core::f64::consts::TAU / CELLS as f64;
/// Where the first one begins (rad): where no root is by reason of symmetry.
const START: f64 = 0.123_4;
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
/// An extremum this near to an edge (rad) may be on either side of it.
const ON_THE_EDGE: f64 = 1e-9;
/// Cells (rad, half their width) that are no longer divided: a cluster of roots is in there.
const SMALLEST: f64 = 1e-7;
/// Two roots that have come this near to each other (rad) and left the real line may be real after all: of all errors,
/// the noise shows those only that are not the same at all angles. They are worth a try.
const NEARLY_MET: f64 = 1e-2;
/// Cells that are looked at, at most: there are some hundred, unless the polynomial is nothing but noise.
const MOST_CELLS: u32 = 2000;
/// A step this short (rad) is the last one: the next would be its square.
const LAST_STEP: f64 = 1e-9;
/// A step that leaves this (rad) is the last one, too.
const LEFT: f64 = 1e-11;
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
    third: f64,
    /// Values that are smaller may be 0.
    uncertain: f64,
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

    /// A root to its last digits, and the derivative there. (Between [`LAST_STEP`] and these, a bracket says nothing.)
    pub(crate) fn refined(&self, root: f64) -> (f64, f64) {
        let [f, d, _] = self.at(root);
        let step = f / d;
        (if libm::fabs(step) < 2.0 * LAST_STEP { root - step } else { root }, d)
    }

    /// Value and two derivatives.
    fn at(&self, x: f64) -> [f64; 3] {
        let (sin, cos) = Float::sin_cos(x);
        let [mut p, mut d, mut e] = [[0.0; 2]; 3];
        let step = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * cos - b * sin + c, a * sin + b * cos + d];
        for coefficient in self.coefficients.iter().take(self.degree + 1).rev() {
            e = step(e, d);
            d = step(d, p);
            p = step(p, *coefficient);
        }
        // With z = exp(ix): f' = Re(i z p'), f'' = -Re(z p' + 2 z^2 p''/2).
        let zd = [d[0] * cos - d[1] * sin, d[0] * sin + d[1] * cos];
        let ze = [e[0] * cos - e[1] * sin, e[0] * sin + e[1] * cos];
        let zze = ze[0] * cos - ze[1] * sin;
        [p[0], -zd[1], -(zd[0] + 2.0 * zze)]
    }

    /// The same in the middle of every cell.
    fn at_cells(&self) -> [[f64; 3]; CELLS] {
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
        let [even, odd] = &sums;
        let mut values = [[0.0; 3]; CELLS];
        let (near, far) = values.split_at_mut(HALF);
        for (cell, (near, far)) in near.iter_mut().zip(far).enumerate() {
            for n in 0..3 {
                near[n] = even[n][cell] + odd[n][cell];
                far[n] = even[n][cell] - odd[n][cell];
            }
        }
        values
    }

    /// How near the polynomial was seen to come to 0, relative to its size.
    pub(crate) fn miss(&self, roots: &Roots) -> f64 {
        let size = self.coefficients.iter().fold(0.0, |sum, [a, b]| sum + libm::sqrt(a * a + b * b));
        if size > 0.0 { roots.least / size } else { f64::INFINITY }
    }

    /// All roots in a turn.
    ///
    /// A cell in which Taylor's expansion at its middle leaves no room for a root is dropped, one in which the polynomial
    /// is monotonous or has one extremum is searched, others are halved. Where the values are within what is uncertain
    /// of them, a candidate is given.
    pub(crate) fn roots(&self) -> Roots {
        self.roots_within(core::f64::consts::PI)
    }

    /// The same for those that are at most this far (rad) from 0, and some others.
    pub(super) fn roots_within(&self, most: f64) -> Roots {
        let mut roots = Roots::NONE;
        let edge = |cell: usize| START + cell as f64 * WIDTH;
        for (cell, at_middle) in self.at_cells().into_iter().enumerate() {
            let [low, high] = [edge(cell), edge(cell + 1)];
            if libm::fabs(Float::wrap_angle(f64::midpoint(low, high))) <= most + WIDTH {
                self.search([low, high], at_middle, &mut roots);
            }
        }
        roots
    }

    /// The roots in a cell. Neighbours have an edge in common, to the last bit: no root falls between them.
    fn search(&self, [low, high]: [f64; 2], at_middle: [f64; 3], roots: &mut Roots) {
        roots.cells += 1;
        if roots.cells > MOST_CELLS {
            roots.overflown = true;
        } else if !self.cell([low, high], at_middle, roots) {
            let middle = f64::midpoint(low, high);
            self.search([low, middle], self.at(f64::midpoint(low, middle)), roots);
            self.search([middle, high], self.at(f64::midpoint(middle, high)), roots);
        }
    }

    /// Whether a cell is done with: else it is to be halved.
    fn cell(&self, [low, high]: [f64; 2], at_middle @ [f, d, e]: [f64; 3], roots: &mut Roots) -> bool {
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0);
        let rest = self.third * half;
        let change = (libm::fabs(d) + (libm::fabs(e) + rest / 3.0) * half / 2.0) * half;
        let size = libm::fabs(f);
        roots.least = Float::min(size, roots.least);
        if size > change + self.uncertain {
            // No root; but two may have met just off the real line.
            let nearly_met = (libm::fabs(e) + rest) * (NEARLY_MET * NEARLY_MET / 2.0);
            return half <= NEARLY_MET || size > change + nearly_met;
        }
        if libm::fabs(d) > (libm::fabs(e) + rest / 2.0) * half {
            self.monotonous([low, high], at_middle, roots);
            return true;
        }
        if size + change <= 2.0 * self.uncertain || half < SMALLEST {
            roots.perhaps(middle, [low, high]);
            return true;
        }
        if libm::fabs(e) > 2.0 * rest {
            self.parabola([low, high], e, roots);
            return true;
        }
        false
    }

    /// A cell in which the curve rises or falls all the way.
    fn monotonous(&self, [low, high]: [f64; 2], [f, d, e]: [f64; 3], roots: &mut Roots) {
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0);
        // Taylor's expansion says the signs at the edges, as a rule.
        let error = self.third * half * half * half / 6.0 + self.uncertain;
        let edge = |x: f64, step: f64| {
            let value = f + step * (d + step * e / 2.0);
            if libm::fabs(value) > error { value } else { self.at(x)[0] }
        };
        let guess = -f / d;
        let guess = middle + guess * (1.0 - guess * e / (2.0 * d));
        self.bracketed([low, high], [edge(low, -half), edge(high, half)], guess, roots);
    }

    /// A cell in which the curve bends one way only: none, two roots, or one at the edge.
    fn parabola(&self, [low, high]: [f64; 2], bend: f64, roots: &mut Roots) {
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0);
        let mut extremum = middle;
        let mut at_extremum = f64::NAN;
        for _ in 0..8 {
            let [f, d, e] = self.at(extremum);
            at_extremum = f;
            let step = d / e;
            extremum -= step;
            if libm::fabs(step) < LAST_STEP || !(extremum > low - half && extremum < high + half) {
                break;
            }
        }
        let [at_low, at_high] = [low, high].map(|edge| self.at(edge)[0]);
        // An extremum on an edge is in both cells rather than in none.
        if !(extremum > low - ON_THE_EDGE && extremum < high + ON_THE_EDGE) {
            self.bracketed([low, high], [at_low, at_high], middle, roots);
            return;
        }
        let extremum = Float::min(Float::max(extremum, low), high);
        if libm::fabs(at_extremum) <= self.uncertain {
            let around = libm::sqrt(2.0 * libm::fabs(self.uncertain / bend));
            roots.perhaps(extremum, [extremum - around, extremum + around]);
        }
        // The distance of the two roots from the extremum, real or imaginary.
        let distance = libm::sqrt(2.0 * libm::fabs(at_extremum / bend));
        if (at_extremum > 0.0) == (bend > 0.0) {
            if distance < NEARLY_MET {
                roots.unlikely.push(extremum);
            }
            return;
        }
        self.bracketed([low, extremum], [at_low, at_extremum], extremum - distance, roots);
        self.bracketed([extremum, high], [at_extremum, at_high], extremum + distance, roots);
    }

    /// The root between two places where the signs differ; the curve is monotonous there.
    fn bracketed(
        &self,
        [mut low, mut high]: [f64; 2],
        [at_low, at_high]: [f64; 2],
        guess: f64,
        roots: &mut Roots,
    ) {
        if (at_low > 0.0) == (at_high > 0.0) {
            return;
        }
        let rising = at_high > 0.0;
        let mut x = if guess > low && guess < high { guess } else { f64::midpoint(low, high) };
        for _ in 0..60 {
            let [f, d, e] = self.at(x);
            if (f > 0.0) == rising {
                high = x;
            } else {
                low = x;
            }
            // Halley's method; what it leaves of an error is its third power times a bound.
            let newton = f / d;
            let bend = e / (2.0 * d);
            let halley = x - newton / (1.0 - newton * bend);
            let inside = halley > low && halley < high;
            let next = if inside { halley } else { f64::midpoint(low, high) };
            let step = libm::fabs(next - x);
            x = next;
            let left = (bend * bend + libm::fabs(self.third / (6.0 * d))) * step * step * step;
            if step < LAST_STEP || (inside && left < LEFT) {
                break;
            }
        }
        roots.push(x);
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_DEGREE, Waves};

    /// The polynomial with these roots, 2 n of them, as a product of sin((x - r) / 2).
    fn with_roots(list: &[f64]) -> Waves {
        let degree = list.len() / 2;
        let count = 2 * MAX_DEGREE + 3;
        let mut coefficients = [[0.0; 2]; MAX_DEGREE + 1];
        for sample in 0..count {
            let x = core::f64::consts::TAU * f64::from(sample as u32) / count as f64;
            let f: f64 = list.iter().map(|root| 2.0 * libm::sin((x - root) / 2.0)).product();
            for (k, coefficient) in coefficients.iter_mut().enumerate().take(degree + 1) {
                let weight = if k == 0 { 1.0 } else { 2.0 } / count as f64;
                let (sin, cos) = libm::sincos(k as f64 * x);
                coefficient[0] += weight * f * cos;
                coefficient[1] -= weight * f * sin;
            }
        }
        Waves::new(coefficients, degree, 0.0)
    }

    #[test]
    fn simple_roots_are_found() {
        for list in [
            &[0.3, 1.0, 2.5, 2.6, 4.0, 6.2][..],
            &[0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 3.0, 3.1],
            &[1.0, 1.0001, 2.0, 5.0],
        ] {
            let roots = with_roots(list).roots();
            let mut found = roots.certain.as_slice().to_vec();
            for root in &mut found {
                *root = root.rem_euclid(core::f64::consts::TAU);
            }
            found.sort_by(f64::total_cmp);
            assert_eq!(found.len(), list.len(), "{list:?} {found:?}");
            for (root, wanted) in found.iter().zip(list) {
                assert!(libm::fabs(libm::sin((root - wanted) / 2.0)) < 1e-9, "{found:?} {list:?}");
            }
        }
    }

    #[test]
    fn roots_on_the_edges_of_cells_are_not_lost() {
        for cell in 0..super::CELLS {
            let edge = super::START + core::f64::consts::TAU * f64::from(cell as u32) / super::CELLS as f64;
            for list in [[edge, edge, edge + 1.0, edge + 2.0], [edge, edge + 0.5, edge + 1.0, edge + 2.0]] {
                let roots = with_roots(&list).roots();
                let near = |root: &f64| libm::fabs(libm::sin((root - edge) / 2.0)) < 1e-6;
                let mut all = roots.certain.as_slice().iter().chain(roots.possible.as_slice());
                assert!(all.any(near), "{edge}: {roots:?}");
            }
        }
    }

    #[test]
    fn a_cluster_has_candidates_all_over() {
        // Between such roots the values are below 1e-12.
        let list = [1.0, 1.004, 1.0041, 1.008, 2.0, 4.0];
        let roots = with_roots(&list).roots();
        assert_eq!(roots.clusters().len(), 1);
        for wanted in list {
            let mut all = roots.certain.as_slice().iter().chain(roots.possible.as_slice());
            assert!(all.any(|root| (root - wanted).abs() < 1e-3), "{wanted}");
        }
    }

    #[test]
    fn a_double_root_is_a_candidate() {
        let roots = with_roots(&[1.0, 1.0, 3.0, 4.0]).roots();
        assert_eq!(roots.clusters().len(), 1);
        assert!(roots.possible.as_slice().iter().any(|root| (root - 1.0).abs() < 1e-6));
    }
}
