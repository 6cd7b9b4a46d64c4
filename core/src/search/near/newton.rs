//! Newton's method on all six coordinates of a pose, where it converges at once.

use super::UNKNOWNS;
use crate::frame::{norm, sub};
use crate::polish::{Polished, turn};
use crate::{Float, Frame};

/// Steps at most. The error is squared with each.
const STEPS: usize = 8;

/// An error of this many machine epsilons (reaches, rad) is what rounding leaves.
const ROUNDING: f64 = 16.0;

/// An error of this many machine epsilons that a step didn't make much smaller is rounding, too.
const SMALL: f64 = 1024.0;

/// A step after which at most this many machine epsilons (reaches, rad) can be left is the last.
const LEFT: f64 = 512.0;

/// Without an exchange of rows, smaller pivots cost more digits than a step of Newton's method can spare.
const SMALL_PIVOT: f64 = 1e-4;

/// A step that leaves more of the error than this is one of a method that isn't near a solution.
const CONVERGES: f64 = 0.25;

/// Joint values brought to a pose, with whether the determinant of the Jacobian is negative there; `None` where that is not a
/// matter of a few steps.
///
/// Where the first step is short beside what the Jacobian needs to become singular, there is one solution near the
/// start, and the error is squared with every step \[Kantorovich; Ortega and Rheinboldt, Iterative Solution of Nonlinear
/// Equations, §12.6\].
pub(super) fn solve<const N: usize, S: Float>(
    start: [S; N],
    unknowns: &[usize; UNKNOWNS],
    target: &Frame<S>,
    reach: S,
    mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
) -> Option<(Polished<N, S>, bool)> {
    let (mut q, mut last) = (start, S::INFINITY);
    let mut negative = None;
    let long = S::ONE.max(S::ONE / reach);
    for _ in 0..STEPS {
        let (tool, jacobian) = pose_and_jacobian(&q);
        let mut at = Equations::new(unknowns, &tool, &jacobian, target, reach)?;
        let error = (at.position_error / reach).max(at.rotation_error);
        let rounding = S::from_f64(ROUNDING) * S::EPSILON;
        let small = S::from_f64(SMALL) * S::EPSILON;
        let slow = error > S::from_f64(CONVERGES) * last;
        if error <= rounding || (error <= small && slow) {
            let found = Polished { q, position_error: at.position_error, rotation_error: at.rotation_error };
            return Some((found, negative.unwrap_or_else(|| at.solution().1)));
        }
        if slow || error.is_nan() {
            return None;
        }
        last = error;
        let mut length = S::ZERO;
        let (step, sign) = at.solution();
        negative = Some(sign);
        for (joint, change) in unknowns.iter().zip(step) {
            *q.get_mut(*joint)? += change;
            length += change.abs();
        }
        // No second derivative of a pose by joint values is more than a reach (by a slide and a turn, 1).
        let length = length * long;
        let left = length * length;
        if left <= S::from_f64(LEFT) * S::EPSILON {
            let bound = left.max(rounding);
            let found = Polished { q, position_error: bound * reach, rotation_error: bound };
            return Some((found, sign));
        }
    }
    None
}

/// Where joint values are, seen from a target.
pub(super) struct Place<S> {
    /// What is missing (reaches, then rad).
    pub(super) missing: [S; UNKNOWNS],
    /// Changes of the unknowns by which the tool moves least, the greatest of them 1; which that is; how little.
    pub(super) idle: [S; UNKNOWNS],
    pub(super) leads: usize,
    pub(super) pivot: S,
}

/// Whether the determinant of the Jacobian is negative.
pub(super) fn is_negative<S: Float>(
    unknowns: &[usize; UNKNOWNS],
    tool: &Frame<S>,
    jacobian: &[[S; 6]],
    reach: S,
) -> bool {
    Equations::new(unknowns, tool, jacobian, tool, reach).is_some_and(|mut at| at.pivoted().1)
}

/// See [`Place`].
pub(super) fn place<S: Float>(
    unknowns: &[usize; UNKNOWNS],
    tool: &Frame<S>,
    jacobian: &[[S; 6]],
    target: &Frame<S>,
    reach: S,
) -> Option<Place<S>> {
    let mut at = Equations::new(unknowns, tool, jacobian, target, reach)?;
    let missing = at.rows.map(|row| row[UNKNOWNS]);
    at.triangular();
    let a = &at.rows;
    let (mut pivot, mut column) = (S::INFINITY, 0);
    for (k, row) in a.iter().enumerate() {
        if row[k].abs() <= pivot {
            (pivot, column) = (row[k].abs(), k);
        }
    }
    let mut idle = [S::ZERO; UNKNOWNS];
    idle[column] = S::ONE;
    let mut leads = column;
    for k in (0..column).rev() {
        let mut value = S::ZERO;
        for j in k + 1..=column {
            value -= a[k][j] * idle[j];
        }
        idle[k] = value / a[k][k];
        if idle[k].abs() > idle[leads].abs() {
            leads = k;
        }
    }
    let most = idle[leads];
    Some(Place { missing, idle: idle.map(|part| part / most), leads, pivot })
}

/// What is missing of a pose, and the change of joint values that makes up for it.
struct Equations<S> {
    /// Columns of the Jacobian, and what is missing: reaches, then rad.
    rows: [[S; UNKNOWNS + 1]; UNKNOWNS],
    /// m
    position_error: S,
    /// rad
    rotation_error: S,
}

impl<S: Float> Equations<S> {
    /// At a tool frame with its Jacobian.
    #[inline]
    fn new(
        unknowns: &[usize; UNKNOWNS],
        tool: &Frame<S>,
        jacobian: &[[S; 6]],
        target: &Frame<S>,
        reach: S,
    ) -> Option<Self> {
        let per_reach = S::ONE / reach;
        let away = sub(target.translation, tool.translation);
        let turned = turn(tool, target);
        let [px, py, pz] = away.map(|x| x * per_reach);
        let [wx, wy, wz] = turned;
        let mut rows = [px, py, pz, wx, wy, wz].map(|missing| {
            let mut row = [S::ZERO; UNKNOWNS + 1];
            row[UNKNOWNS] = missing;
            row
        });
        for (place, joint) in unknowns.iter().enumerate() {
            let [vx, vy, vz, wx, wy, wz] = *jacobian.get(*joint)?;
            let column = [vx * per_reach, vy * per_reach, vz * per_reach, wx, wy, wz];
            for (row, entry) in rows.iter_mut().zip(column) {
                row[place] = entry;
            }
        }
        Some(Self { rows, position_error: norm(away), rotation_error: norm(turned) })
    }

    /// By Gaussian elimination, with whether the determinant is negative; not finite where the equations are singular.
    #[inline]
    fn solution(&mut self) -> ([S; UNKNOWNS], bool) {
        // A digit that is lost here is made up for by the next step: rows are exchanged only where many are.
        unpivoted(&self.rows).unwrap_or_else(|| self.pivoted())
    }

    /// With partial pivoting.
    #[cold]
    #[inline(never)]
    fn pivoted(&mut self) -> ([S; UNKNOWNS], bool) {
        let exchanged = self.triangular();
        let pivots = self.rows.iter().enumerate().map(|(k, row)| row[k]);
        let negative = pivots.fold(exchanged, |negative, pivot| negative ^ (pivot < S::ZERO));
        (substitute(&self.rows), negative)
    }

    /// Says whether rows were exchanged an odd number of times.
    fn triangular(&mut self) -> bool {
        let a = &mut self.rows;
        let mut odd = false;
        for k in 0..UNKNOWNS {
            for r in k + 1..UNKNOWNS {
                if a[r][k].abs() > a[k][k].abs() {
                    let (upper, lower) = (a[k], a[r]);
                    a[k] = lower;
                    a[r] = upper;
                    odd = !odd;
                }
            }
            eliminate(a, k);
        }
        odd
    }
}

/// Elimination with the rows as they come, or `None` where a pivot is small.
#[inline]
fn unpivoted<S: Float>(rows: &[[S; UNKNOWNS + 1]; UNKNOWNS]) -> Option<([S; UNKNOWNS], bool)> {
    let [a, mut b, mut c, mut d, mut e, mut f] = *rows;
    let mut least = S::INFINITY;
    let mut negative = false;
    macro_rules! eliminated {
        ($k:literal, $top:ident: $($row:ident),*) => {{
            let size = $top[$k].abs();
            least = if size < least { size } else { least };
            negative ^= $top[$k] < S::ZERO;
            let inverse = S::ONE / $top[$k];
            $(
                let factor = $row[$k] * inverse;
                // All columns, for the sake of vector instructions.
                for (value, from) in $row.iter_mut().zip($top) {
                    *value -= factor * from;
                }
            )*
            inverse
        }};
    }
    let ia = eliminated!(0, a: b, c, d, e, f);
    let ib = eliminated!(1, b: c, d, e, f);
    let ic = eliminated!(2, c: d, e, f);
    let id = eliminated!(3, d: e, f);
    let ie = eliminated!(4, e: f);
    let size = f[5].abs();
    least = if size < least { size } else { least };
    if !super::above(least, S::from_f64(SMALL_PIVOT)) {
        return None;
    }
    negative ^= f[5] < S::ZERO;
    let z = f[6] / f[5];
    let y = (e[6] - e[5] * z) * ie;
    let x = (d[6] - d[5] * z - d[4] * y) * id;
    let w = (c[6] - c[5] * z - c[4] * y - c[3] * x) * ic;
    let v = (b[6] - b[5] * z - b[4] * y - b[3] * x - b[2] * w) * ib;
    let u = (a[6] - a[5] * z - a[4] * y - a[3] * x - a[2] * w - a[1] * v) * ia;
    Some(([u, v, w, x, y, z], negative))
}

/// Takes the unknown of column `k` out of the rows below row `k`.
#[inline]
fn eliminate<S: Float>(a: &mut [[S; UNKNOWNS + 1]; UNKNOWNS], k: usize) {
    let top = a[k];
    let inverse = S::ONE / top[k];
    for row in a.iter_mut().skip(k + 1) {
        let factor = row[k] * inverse;
        for (value, from) in row.iter_mut().zip(top).skip(k + 1) {
            *value -= factor * from;
        }
    }
}

/// The unknowns of equations that were brought to triangular form.
fn substitute<S: Float>(a: &[[S; UNKNOWNS + 1]; UNKNOWNS]) -> [S; UNKNOWNS] {
    let mut x = [S::ZERO; UNKNOWNS];
    for k in (0..UNKNOWNS).rev() {
        let mut value = a[k][UNKNOWNS];
        for j in k + 1..UNKNOWNS {
            value -= a[k][j] * x[j];
        }
        x[k] = value / a[k][k];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::{Equations, UNKNOWNS, unpivoted};

    /// Rows whose first pivots vanish where they aren't exchanged, if `hidden`.
    fn rows(hidden: bool) -> [[f64; UNKNOWNS + 1]; UNKNOWNS] {
        let mut rows = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
        for (r, row) in rows.iter_mut().enumerate() {
            for (c, entry) in row.iter_mut().enumerate() {
                *entry = libm::sin((r * r * c + 3 * r + 5 * c * c + 1) as f64 * 1.3);
            }
        }
        if hidden {
            rows[0][0] = 0.0;
        }
        rows
    }

    fn left(rows: &[[f64; UNKNOWNS + 1]; UNKNOWNS], x: &[f64; UNKNOWNS]) -> f64 {
        let miss = |row: &[f64; UNKNOWNS + 1]| {
            let sum: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
            (sum - row[UNKNOWNS]).abs()
        };
        rows.iter().map(miss).fold(0.0, f64::max)
    }

    #[test]
    fn equations_are_solved_with_rows_as_they_come_and_exchanged() {
        let plain = rows(false);
        let (x, negative) = unpivoted(&plain).expect("no small pivot");
        assert!(left(&plain, &x) < 1e-12);
        let mut equations = Equations { rows: plain, position_error: 0.0, rotation_error: 0.0 };
        assert_eq!(equations.pivoted().1, negative);
        let hidden = rows(true);
        assert!(unpivoted(&hidden).is_none());
        let mut equations = Equations { rows: hidden, position_error: 0.0, rotation_error: 0.0 };
        assert!(left(&hidden, &equations.solution().0) < 1e-12);
    }

    #[test]
    fn equations_that_are_singular_have_no_finite_solution() {
        let mut rows = rows(false);
        rows[5] = rows[4];
        let mut equations = Equations { rows, position_error: 0.0, rotation_error: 0.0 };
        assert!(!equations.solution().0.iter().all(|x| x.abs() < 1e9));
    }
}
