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

/// Joint values brought to a pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found<const N: usize, S> {
    pub(super) at: Polished<N, S>,
    /// The determinant of the Jacobian there (reaches, rad).
    pub(super) determinant: S,
    /// Whether it had the other sign at the start.
    pub(super) turned: bool,
    /// The first step (rad, reaches), of the joint that went farthest.
    pub(super) first: S,
}

/// Joint values brought to a pose; `None` where that is not a matter of a few steps.
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
) -> Option<Found<N, S>> {
    let (mut q, mut last) = (start, S::INFINITY);
    let (mut began, mut last_determinant) = (None, None);
    let mut first = S::ZERO;
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
            let determinant = last_determinant.unwrap_or_else(|| at.solution().1);
            let negative = determinant < S::ZERO;
            return Some(Found {
                at: found,
                determinant,
                turned: began.is_some_and(|began| began != negative),
                first,
            });
        }
        if slow || error.is_nan() {
            return None;
        }
        last = error;
        let mut length = S::ZERO;
        let (step, determinant) = at.solution();
        last_determinant = Some(determinant);
        let sign = determinant < S::ZERO;
        if began.is_none() {
            first = step.iter().fold(S::ZERO, |most, change| most.max(change.abs()));
        }
        let began = *began.get_or_insert(sign);
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
            return Some(Found { at: found, determinant, turned: began != sign, first });
        }
    }
    None
}

/// Whether the determinant of the Jacobian is negative.
pub(super) fn is_negative<S: Float>(
    unknowns: &[usize; UNKNOWNS],
    tool: &Frame<S>,
    jacobian: &[[S; 6]],
    reach: S,
) -> bool {
    Equations::new(unknowns, tool, jacobian, tool, reach).is_some_and(|mut at| at.pivoted().1 < S::ZERO)
}

/// What is missing of a pose, and the change of joint values that makes up for it.
pub(super) struct Equations<S> {
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
    pub(super) fn new(
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

    /// Columns of the Jacobian, and what is missing: reaches, then rad.
    pub(super) fn columns(&self) -> ([[S; UNKNOWNS]; UNKNOWNS], [S; UNKNOWNS]) {
        (core::array::from_fn(|place| self.rows.map(|row| row[place])), self.rows.map(|row| row[UNKNOWNS]))
    }

    /// By Gaussian elimination, with the determinant; not finite where the equations are singular.
    #[inline]
    fn solution(&mut self) -> ([S; UNKNOWNS], S) {
        // A digit that is lost here is made up for by the next step: rows are exchanged only where many are.
        unpivoted(&self.rows).unwrap_or_else(|| self.pivoted())
    }

    /// With partial pivoting.
    #[cold]
    #[inline(never)]
    fn pivoted(&mut self) -> ([S; UNKNOWNS], S) {
        let exchanged = self.triangular();
        let pivots = self.rows.iter().enumerate().map(|(k, row)| row[k]);
        let determinant =
            pivots.fold(if exchanged { -S::ONE } else { S::ONE }, |product, pivot| product * pivot);
        (substitute(&self.rows), determinant)
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
fn unpivoted<S: Float>(rows: &[[S; UNKNOWNS + 1]; UNKNOWNS]) -> Option<([S; UNKNOWNS], S)> {
    let [a, mut b, mut c, mut d, mut e, mut f] = *rows;
    let mut least = S::INFINITY;
    let mut determinant = S::ONE;
    macro_rules! eliminated {
        ($k:literal, $top:ident: $($row:ident),*) => {{
            let size = $top[$k].abs();
            least = if size < least { size } else { least };
            determinant *= $top[$k];
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
    determinant *= f[5];
    let z = f[6] / f[5];
    let y = (e[6] - e[5] * z) * ie;
    let x = (d[6] - d[5] * z - d[4] * y) * id;
    let w = (c[6] - c[5] * z - c[4] * y - c[3] * x) * ic;
    let v = (b[6] - b[5] * z - b[4] * y - b[3] * x - b[2] * w) * ib;
    let u = (a[6] - a[5] * z - a[4] * y - a[3] * x - a[2] * w - a[1] * v) * ia;
    Some(([u, v, w, x, y, z], determinant))
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
        let (x, determinant) = unpivoted(&plain).expect("no small pivot");
        assert!(left(&plain, &x) < 1e-12);
        let mut equations = Equations { rows: plain, position_error: 0.0, rotation_error: 0.0 };
        assert!((equations.pivoted().1 - determinant).abs() < 1e-12);
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
