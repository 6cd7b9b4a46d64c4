//! Several numbers at once: the same operations on each, which compilers make vector instructions of.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// How many.
pub(super) const LANES: usize = 4;

/// One number of each of several problems that are solved together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wide(pub(super) [f64; LANES]);

impl Wide {
    pub(super) const ZERO: Self = Self([0.0; LANES]);
    pub(super) const ONE: Self = Self([1.0; LANES]);

    /// The same number in all.
    #[inline]
    pub(super) const fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    /// One of them; none is not a number.
    #[inline]
    pub(super) fn lane(self, lane: usize) -> f64 {
        self.0.get(lane).copied().unwrap_or(f64::NAN)
    }

    #[inline]
    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let [a, b, c, d] = self.0;
        Self([f(a), f(b), f(c), f(d)])
    }

    #[inline]
    pub(super) fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// The least absolute value; one that is no number does not count.
    #[inline]
    fn least_size(self) -> f64 {
        let [a, b, c, d] = self.abs().0;
        a.min(b).min(c.min(d))
    }

    #[inline]
    pub(super) fn sqrt(self) -> Self {
        self.map(libm::sqrt)
    }

    /// Where the first is greater than the second, one, elsewhere the other.
    #[inline]
    pub(super) fn if_greater(self, than: Self, then: Self, or: Self) -> Self {
        let pick = |k: usize| if self.0[k] > than.0[k] { then.0[k] } else { or.0[k] };
        Self([pick(0), pick(1), pick(2), pick(3)])
    }

    /// With the numbers of another in some lanes.
    #[inline]
    pub(super) fn with_lanes(self, of: Self, lanes: [bool; LANES]) -> Self {
        let pick = |k: usize| if lanes[k] { of.0[k] } else { self.0[k] };
        Self([pick(0), pick(1), pick(2), pick(3)])
    }

    /// As large as this, with the sign of the other.
    #[inline]
    pub(super) fn copysign(self, sign: Self) -> Self {
        let ([a, b, c, d], [e, g, h, i]) = (self.0, sign.0);
        Self([a.copysign(e), b.copysign(g), c.copysign(h), d.copysign(i)])
    }
}

/// An operator on each of the numbers; written out, since unoptimised builds, in which macros run, call every closure.
macro_rules! on_each {
    ($operator:ident, $method:ident, $of:tt) => {
        impl $operator for Wide {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                let ([a, b, c, d], [e, g, h, i]) = (self.0, other.0);
                Self([a $of e, b $of g, c $of h, d $of i])
            }
        }
    };
}

on_each!(Add, add, +);
on_each!(Sub, sub, -);
on_each!(Mul, mul, *);
on_each!(Div, div, /);

impl Mul<f64> for Wide {
    type Output = Self;
    #[inline]
    fn mul(self, other: f64) -> Self {
        self * Self::all(other)
    }
}

impl Neg for Wide {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl AddAssign for Wide {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Wide {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// Several operators in one, written out for the same reason.
macro_rules! in_each {
    (|$k:ident| $value:expr) => {
        Wide([
            in_each!($k = 0, $value),
            in_each!($k = 1, $value),
            in_each!($k = 2, $value),
            in_each!($k = 3, $value),
        ])
    };
    ($k:ident = $lane:literal, $value:expr) => {{
        const $k: usize = $lane;
        $value
    }};
}

impl Wide {
    /// Adds a product.
    #[inline]
    pub(super) fn add_product(&mut self, a: Self, b: Self) {
        *self = in_each!(|K| self.0[K] + a.0[K] * b.0[K]);
    }

    /// Subtracts a product.
    #[inline]
    fn sub_product(&mut self, a: Self, b: Self) {
        *self = in_each!(|K| self.0[K] - a.0[K] * b.0[K]);
    }
}

/// A complex number times another, plus a third.
#[inline]
pub(super) fn product_plus([a, b]: [Wide; 2], [cos, sin]: [Wide; 2], [c, d]: [Wide; 2]) -> [Wide; 2] {
    [
        in_each!(|K| a.0[K] * cos.0[K] - b.0[K] * sin.0[K] + c.0[K]),
        in_each!(|K| a.0[K] * sin.0[K] + b.0[K] * cos.0[K] + d.0[K]),
    ]
}

/// The scalar product of a vector and one that all have in common.
#[inline]
pub(super) fn dot_all([p, q, r]: [Wide; 3], [a, b, c]: [f64; 3]) -> Wide {
    in_each!(|K| p.0[K] * a + q.0[K] * b + r.0[K] * c)
}

/// The scalar product of two vectors.
#[inline]
pub(super) fn dot([a1, a2, a3]: [Wide; 3], [b1, b2, b3]: [Wide; 3]) -> Wide {
    in_each!(|K| a1.0[K] * b1.0[K] + a2.0[K] * b2.0[K] + a3.0[K] * b3.0[K])
}

/// The vector product of two vectors.
#[inline]
pub(super) fn cross([a1, a2, a3]: [Wide; 3], [b1, b2, b3]: [Wide; 3]) -> [Wide; 3] {
    [a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1]
}

/// A vector times a matrix.
#[inline]
pub(super) fn matrix_vector(rows: &[[Wide; 3]; 3], vector: [Wide; 3]) -> [Wide; 3] {
    let [a, b, c] = *rows;
    [dot(a, vector), dot(b, vector), dot(c, vector)]
}

/// One of two vectors, where the first number is greater than the second.
#[inline]
pub(super) fn vector_if_greater(
    a: Wide,
    than: Wide,
    [x, y, z]: [Wide; 3],
    [u, v, w]: [Wide; 3],
) -> [Wide; 3] {
    [a.if_greater(than, x, u), a.if_greater(than, y, v), a.if_greater(than, z, w)]
}

/// Smaller than any column that matters, and large enough for its square to have an inverse.
const NOTHING: f64 = 1e-140;

/// Solves `ROWS` equations in `N` unknowns, given column by column, the last `COLUMNS` - `N` of which are right-hand sides,
/// in place: the first `N` numbers of these columns are the solutions then, those with the least squares where there are
/// more equations than unknowns. Returns the determinant.
///
/// By Householder's reflections, which have no pivots to be chosen \[Golub and Van Loan, Matrix Computations, §5.2\].
#[inline]
pub(super) fn solve<const ROWS: usize, const N: usize, const COLUMNS: usize>(
    a: &mut [[Wide; ROWS]; COLUMNS],
) -> Wide {
    let mut determinant = Wide::ONE;
    let mut inverses = [Wide::ZERO; N];
    for k in 0..N {
        let top = a[k];
        if k + 1 == ROWS {
            determinant = determinant * top[k];
            inverses[k] = Wide::ONE / top[k];
            break;
        }
        let square = top.iter().skip(k).fold(Wide::ZERO, |sum, x| sum + *x * *x);
        let length = square.sqrt() + Wide::all(NOTHING);
        let diagonal = -length.copysign(top[k]);
        let mut normal = top;
        normal[k] = top[k] - diagonal;
        let factor = Wide::ONE / (diagonal * normal[k]);
        determinant = -(determinant * diagonal);
        inverses[k] = Wide::ONE / diagonal;
        for column in a.iter_mut().skip(k + 1) {
            let mut product = Wide::ZERO;
            for r in k..ROWS {
                product.add_product(normal[r], column[r]);
            }
            let product = product * factor;
            for r in k..ROWS {
                column[r].add_product(product, normal[r]);
            }
        }
    }
    for k in (0..N).rev() {
        let upper = a[k];
        for column in a.iter_mut().skip(N) {
            let value = column[k] * inverses[k];
            column[k] = value;
            for r in 0..k {
                column[r].sub_product(upper[r], value);
            }
        }
    }
    determinant
}

/// Solves `N` equations, the last `COLUMNS` - `N` columns of which are right-hand sides, in place, and returns the
/// determinant: by elimination with pivots that suit all lanes, which is half the work of [`solve`]. A lane in which they
/// vanish is not a number then.
#[inline]
#[allow(clippy::needless_range_loop, reason = "iterators that skip cost a tenth of it")]
pub(super) fn eliminate<const N: usize, const COLUMNS: usize>(a: &mut [[Wide; COLUMNS]; N]) -> Wide {
    let mut determinant = Wide::ONE;
    let mut inverses = [Wide::ZERO; N];
    for k in 0..N {
        let (mut at, mut greatest) = (k, -1.0);
        for r in k..N {
            let size = a[r][k].least_size();
            if size > greatest {
                (at, greatest) = (r, size);
            }
        }
        let Some((head, tail)) = a.split_at_mut_checked(k + 1) else { break };
        let Some(top) = head.last_mut() else { break };
        if let Some(row) = at.checked_sub(k + 1).and_then(|below| tail.get_mut(below)) {
            // Not as a whole: rows are so long that they would be copied by a call.
            for c in k..COLUMNS {
                (top[c], row[c]) = (row[c], top[c]);
            }
            determinant = -determinant;
        }
        determinant = determinant * top[k];
        let inverse = Wide::ONE / top[k];
        inverses[k] = inverse;
        for row in tail {
            let factor = row[k] * inverse;
            for c in k + 1..COLUMNS {
                row[c].sub_product(factor, top[c]);
            }
        }
    }
    for k in (0..N).rev() {
        let Some((above, [solved, ..])) = a.split_at_mut_checked(k) else { break };
        for c in N..COLUMNS {
            solved[c] = solved[c] * inverses[k];
        }
        for row in above {
            let factor = row[k];
            for c in N..COLUMNS {
                row[c].sub_product(factor, solved[c]);
            }
        }
    }
    determinant
}

#[cfg(test)]
mod tests {
    use super::{LANES, Wide, eliminate, solve};

    #[test]
    fn each_lane_is_solved_by_itself() {
        let mut state = 3_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut columns = [[Wide::ZERO; 6]; 8];
        for column in &mut columns {
            for place in column.iter_mut() {
                *place = Wide([0; LANES].map(|_| random()));
            }
        }
        let mut solved = columns;
        let determinant = solve::<6, 6, 8>(&mut solved);
        let mut eliminated = [[Wide::ZERO; 8]; 6];
        for (r, row) in eliminated.iter_mut().enumerate() {
            for (c, value) in row.iter_mut().enumerate() {
                *value = columns[c][r];
            }
        }
        let same = eliminate::<6, 8>(&mut eliminated);
        for lane in 0..LANES {
            let mut rows = [[0.0; 8]; 6];
            for (c, column) in columns.iter().enumerate() {
                for (r, value) in column.iter().enumerate() {
                    rows[r][c] = value.0[lane];
                }
            }
            let wanted = crate::general::linear::solve::<6, 8>(&mut rows);
            assert!((determinant.0[lane] / wanted - 1.0).abs() < 1e-12);
            assert!((same.0[lane] / wanted - 1.0).abs() < 1e-12);
            for (r, row) in rows.iter().enumerate() {
                for (c, column) in solved.iter().enumerate().skip(6) {
                    assert!((column[r].0[lane] - row[c]).abs() < 1e-11);
                    assert!((eliminated[r][c].0[lane] - row[c]).abs() < 1e-11);
                }
            }
        }
    }
}
