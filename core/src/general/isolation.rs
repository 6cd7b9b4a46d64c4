//! Real roots of a trigonometric polynomial.

use super::roots::Roots;
use super::waves::{CELLS, HALF, LAST_STEP, MAX_ROOTS, START, WIDTH, Waves};
use super::wide::{LANES, Wide};
use crate::Float;

/// An extremum this near to an edge (rad) may be on either side of it.
const ON_THE_EDGE: f64 = 1e-9;
/// Cells (rad, half their width) that are no longer divided: a cluster of roots is in there.
const SMALLEST: f64 = 1e-7;
/// Two roots that have come this near to each other (rad) and left the real line may be real after all: of all errors,
/// the noise shows those only that are not the same at all angles. They are worth a try.
const NEARLY_MET: f64 = 1e-2;
/// Cells that are looked at, at most: there are some hundred, unless the polynomial is nothing but noise.
const MOST_CELLS: u32 = 2000;
/// A step that leaves this (rad) is the last one, too.
const LEFT: f64 = 1e-11;

/// A place where the curve is monotonous and its signs at the ends differ.
#[derive(Debug, Clone, Copy)]
struct Bracket {
    ends: [f64; 2],
    rising: bool,
    guess: f64,
}

/// What a search has come to.
struct Isolation {
    roots: Roots,
    /// One root in each.
    brackets: [Bracket; MAX_ROOTS],
    len: usize,
}

impl Isolation {
    const EMPTY: Self = {
        let nothing = Bracket { ends: [0.0; 2], rising: false, guess: 0.0 };
        Self { roots: Roots::NONE, brackets: [nothing; MAX_ROOTS], len: 0 }
    };

    /// A place where the curve is monotonous: there is a root if the signs at its ends differ.
    fn monotonous(&mut self, ends @ [low, high]: [f64; 2], [at_low, at_high]: [f64; 2], guess: f64) {
        if (at_low > 0.0) == (at_high > 0.0) {
            return;
        }
        let guess = if guess > low && guess < high { guess } else { f64::midpoint(low, high) };
        match self.brackets.get_mut(self.len) {
            Some(place) => {
                *place = Bracket { ends, rising: at_high > 0.0, guess };
                self.len += 1;
            }
            None => self.roots.overflown = true,
        }
    }
}

impl Waves {
    /// All roots in a turn.
    ///
    /// A cell in which Taylor's expansion at its middle leaves no room for a root is dropped, one in which the polynomial
    /// is monotonous or has one extremum is searched, others are quartered. Where the values are within what is uncertain
    /// of them, a candidate is given.
    pub(crate) fn roots(&self) -> Roots {
        self.roots_within(core::f64::consts::PI)
    }

    /// The same for those that are at most this far (rad) from 0, and some others.
    pub(super) fn roots_within(&self, most: f64) -> Roots {
        let mut found = Isolation::EMPTY;
        found.roots.cells = CELLS as u32;
        let edge = |cell: usize| START + cell as f64 * WIDTH;
        for (first, at_middles) in [0, HALF].into_iter().zip(&self.at_cells()) {
            let (room, least) = self.room(at_middles);
            found.roots.least = Float::min(least, found.roots.least);
            let [values, slopes, bends] = at_middles;
            for cell in (0..HALF).filter(|cell| room[*cell] >= 0.0 || room[*cell].is_nan()) {
                let ends @ [low, high] = [edge(first + cell), edge(first + cell + 1)];
                if libm::fabs(Float::wrap_angle(f64::midpoint(low, high))) <= most + WIDTH {
                    self.search(ends, [values[cell], slopes[cell], bends[cell]], &mut found);
                }
            }
        }
        for brackets in found.brackets.get(..found.len).unwrap_or_default().chunks(LANES) {
            self.refine(brackets, &mut found.roots);
        }
        found.roots
    }

    /// Which cells are dropped, all at once: those that have less than no room. Also the value that is nearest to 0.
    fn room(&self, [values, slopes, bends]: &[[f64; HALF]; 3]) -> ([f64; HALF], f64) {
        let mut room = [0.0; HALF];
        let mut least = f64::INFINITY;
        for cell in 0..HALF {
            let size = values[cell].abs();
            least = if size < least { size } else { least };
            let (change, nearly_met) = self.change(slopes[cell], bends[cell], WIDTH / 2.0);
            room[cell] =
                change + if self.uncertain > nearly_met { self.uncertain } else { nearly_met } - size;
        }
        (room, least)
    }

    /// By how much values in a cell may differ from that in its middle, and by how much more they must stay away from 0 for
    /// no two roots to have met just off the real line.
    #[inline]
    fn change(&self, slope: f64, bend: f64, half: f64) -> (f64, f64) {
        let rest = self.third * half;
        let change = (slope.abs() + (bend.abs() + rest / 3.0) * half / 2.0) * half;
        (change, (bend.abs() + rest) * (NEARLY_MET * NEARLY_MET / 2.0))
    }

    /// The roots in a cell. Neighbours have an edge in common, to the last bit: no root falls between them.
    fn search(&self, ends @ [low, high]: [f64; 2], at_middle: [f64; 3], found: &mut Isolation) {
        if found.roots.cells > MOST_CELLS {
            found.roots.overflown = true;
        } else if !self.cell(ends, at_middle, found) {
            let middle = f64::midpoint(low, high);
            let (left, right) = (f64::midpoint(low, middle), f64::midpoint(middle, high));
            let cells = [[low, left], [left, middle], [middle, right], [right, high]];
            let [f, d, e] = self.at_all(Wide(cells.map(|[low, high]| f64::midpoint(low, high))));
            for (lane, cell) in cells.into_iter().enumerate() {
                found.roots.cells += 1;
                self.search(cell, [f, d, e].map(|x| x.lane(lane)), found);
            }
        }
    }

    /// Whether a cell is done with: else it is to be divided.
    fn cell(&self, [low, high]: [f64; 2], at_middle @ [f, d, e]: [f64; 3], found: &mut Isolation) -> bool {
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0);
        let rest = self.third * half;
        let (change, nearly_met) = self.change(d, e, half);
        let size = libm::fabs(f);
        found.roots.least = Float::min(size, found.roots.least);
        if size > change + self.uncertain {
            // No root; but two may have met just off the real line.
            return half <= NEARLY_MET || size > change + nearly_met;
        }
        if libm::fabs(d) > (libm::fabs(e) + rest / 2.0) * half {
            self.monotonous([low, high], at_middle, found);
            return true;
        }
        if size + change <= 2.0 * self.uncertain || half < SMALLEST {
            found.roots.perhaps(middle, [low, high]);
            return true;
        }
        if libm::fabs(e) > 2.0 * rest {
            self.parabola([low, high], e, found);
            return true;
        }
        false
    }

    /// A cell in which the curve rises or falls all the way.
    fn monotonous(&self, [low, high]: [f64; 2], [f, d, e]: [f64; 3], found: &mut Isolation) {
        let (middle, half) = (f64::midpoint(low, high), (high - low) / 2.0);
        // Taylor's expansion says the signs at the edges, as a rule.
        let error = self.third * half * half * half / 6.0 + self.uncertain;
        let edge = |x: f64, step: f64| {
            let value = f + step * (d + step * e / 2.0);
            if libm::fabs(value) > error { value } else { self.at(x)[0] }
        };
        let guess = -f / d;
        let guess = middle + guess * (1.0 - guess * e / (2.0 * d));
        found.monotonous([low, high], [edge(low, -half), edge(high, half)], guess);
    }

    /// A cell in which the curve bends one way only: none, two roots, or one at the edge.
    fn parabola(&self, [low, high]: [f64; 2], bend: f64, found: &mut Isolation) {
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
            found.monotonous([low, high], [at_low, at_high], middle);
            return;
        }
        let extremum = Float::min(Float::max(extremum, low), high);
        if libm::fabs(at_extremum) <= self.uncertain {
            let around = libm::sqrt(2.0 * libm::fabs(self.uncertain / bend));
            found.roots.perhaps(extremum, [extremum - around, extremum + around]);
        }
        // The distance of the two roots from the extremum, real or imaginary.
        let distance = libm::sqrt(2.0 * libm::fabs(at_extremum / bend));
        if (at_extremum > 0.0) == (bend > 0.0) {
            if distance < NEARLY_MET {
                found.roots.unlikely.push(extremum);
            }
            return;
        }
        found.monotonous([low, extremum], [at_low, at_extremum], extremum - distance);
        found.monotonous([extremum, high], [at_extremum, at_high], extremum + distance);
    }

    /// The roots in a few brackets, all at once.
    fn refine(&self, brackets: &[Bracket], roots: &mut Roots) {
        let Some(any) = brackets.first() else { return };
        let mut lanes: [Bracket; LANES] = core::array::from_fn(|lane| *brackets.get(lane).unwrap_or(any));
        let mut done = [false; LANES];
        for _ in 0..60 {
            let [f, d, e] = self.at_all(Wide(lanes.map(|bracket| bracket.guess)));
            for (lane, (bracket, done)) in lanes.iter_mut().zip(&mut done).enumerate() {
                if !*done {
                    *done = self.advance(bracket, [f, d, e].map(|x| x.lane(lane)));
                }
            }
            if done == [true; LANES] {
                break;
            }
        }
        for (bracket, _) in lanes.iter().zip(brackets) {
            roots.push(bracket.guess);
        }
    }

    /// A better guess, from the values at the last one. Whether it is good enough.
    fn advance(&self, bracket: &mut Bracket, [f, d, e]: [f64; 3]) -> bool {
        let x = bracket.guess;
        if f == 0.0 {
            return true;
        }
        let [low, high] = &mut bracket.ends;
        if (f > 0.0) == bracket.rising {
            *high = x;
        } else {
            *low = x;
        }
        // Halley's method; what it leaves of an error is its third power times a bound.
        let newton = f / d;
        let bend = e / (2.0 * d);
        let halley = x - newton / (1.0 - newton * bend);
        let inside = halley > *low && halley < *high;
        bracket.guess = if inside { halley } else { f64::midpoint(*low, *high) };
        let step = libm::fabs(bracket.guess - x);
        let left = (bend * bend + libm::fabs(self.third / (6.0 * d))) * step * step * step;
        step < LAST_STEP || (inside && left < LEFT)
    }
}

#[cfg(test)]
mod tests {
    use crate::general::waves::{CELLS, MAX_DEGREE, START, Waves};

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
        for cell in 0..CELLS {
            let edge = START + core::f64::consts::TAU * f64::from(cell as u32) / CELLS as f64;
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
