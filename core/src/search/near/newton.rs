//! Newton's method on all that a target prescribes, where it converges at once.

use super::UNKNOWNS;
use super::asked::Asked;
use super::blocks::Blocks;
use crate::frame::{dot, norm, sub};
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

/// A step that leaves more of the error than this is one of a method that isn't near a solution.
const CONVERGES: f64 = 0.25;

/// Determinants (reaches, rad) of so many times what the arm is off by may belong to several solutions near to each other.
const SINGULAR: f64 = 0.25;

/// The same of the least pivot, of targets of fewer rows than a pose: their determinants have fewer factors.
const SMALL_PIVOT: f64 = 8.0;

/// Joint values brought to a target.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found<const N: usize, S> {
    pub(super) at: Polished<N, S>,
    /// The determinant of the Jacobian there (reaches, rad).
    pub(super) determinant: S,
    /// The least pivot, where it isn't that of a pose.
    pivot: Option<S>,
    /// Whether it had the other sign at the start.
    pub(super) turned: bool,
    /// The first step (rad, reaches), of the joint that went farthest.
    pub(super) first: S,
}

impl<const N: usize, S: Float> Found<N, S> {
    /// Whether no other solution is near because the arm is off by so much (reaches, rad).
    pub(super) fn is_clear_of(&self, deviation: S) -> bool {
        match self.pivot {
            Some(pivot) => pivot > S::from_f64(SMALL_PIVOT) * deviation,
            None => self.determinant.abs() > S::from_f64(SINGULAR) * deviation,
        }
    }
}

/// Joint values brought to a target; `None` where that is not a matter of a few steps.
///
/// Where the first step is short beside what the Jacobian needs to become singular, there is one solution near the
/// start, and the error is squared with every step \[Kantorovich; Ortega and Rheinboldt, Iterative Solution of Nonlinear
/// Equations, §12.6\].
pub(super) fn solve<const N: usize, S: Float>(
    start: [S; N],
    asked: &Asked<'_, S>,
    mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
) -> Option<Found<N, S>> {
    let (mut q, mut last) = (start, S::INFINITY);
    let (mut began, mut last_determinant, mut pivot) = (None, None, None);
    let mut first = S::ZERO;
    let pose = asked.pose();
    // Of a pose, lengths are metres until they are compared.
    let per_reach = if pose.is_some() { S::ONE / asked.reach } else { S::ONE };
    let long = S::ONE.max(S::ONE / asked.reach);
    let smooth = asked.is_smooth();
    let rounding = S::from_f64(ROUNDING) * S::EPSILON;
    let small = S::from_f64(SMALL) * S::EPSILON;
    for _ in 0..STEPS {
        // Not taken apart: that would be a copy.
        let here = pose_and_jacobian(&q);
        let (tool, jacobian) = (&here.0, &here.1);
        let missing = match pose {
            Some((pose, _)) => (sub(pose.translation, tool.translation), turn(tool, pose)),
            None => halves(asked.missing(tool)),
        };
        let far = dot(missing.0, missing.0) * per_reach * per_reach;
        let angle = dot(missing.1, missing.1);
        // The square, as are what it is compared with.
        let error = if far > angle || far.is_nan() { far } else { angle };
        let slow = error > S::from_f64(CONVERGES * CONVERGES) * last;
        let met = error <= rounding * rounding || (error <= small * small && slow);
        if !met && (slow || error.is_nan()) {
            return None;
        }
        last = error;
        let (step, determinant) = match (met, last_determinant, pose) {
            (true, Some(determinant), _) => ([S::ZERO; UNKNOWNS], determinant),
            (.., Some((_, joints))) => step(joints, jacobian, missing, per_reach)?,
            (.., None) => {
                let mut equations = Equations::new(asked, tool, jacobian);
                let solved = equations.pivoted();
                pivot = Some(equations.least_pivot());
                solved
            }
        };
        last_determinant = Some(determinant);
        let negative = determinant < S::ZERO;
        let turned = *began.get_or_insert(negative) != negative;
        if met {
            let (position_error, rotation_error) =
                if pose.is_some() { (norm(missing.0), norm(missing.1)) } else { asked.target.errors(tool) };
            let at = Polished { q, position_error, rotation_error };
            return Some(Found { at, determinant, pivot, turned, first });
        }
        let (mut length, mut most) = (S::ZERO, S::ZERO);
        for change in step {
            let size = change.abs();
            length += size;
            most = if size > most { size } else { most };
        }
        asked.go(&mut q, &step);
        if first == S::ZERO {
            first = most;
        }
        // No second derivative of a pose by joint values is more than a reach (by a slide and a turn, 1).
        let length = length * long;
        let left = length * length;
        if smooth && left <= S::from_f64(LEFT) * S::EPSILON {
            let bound = if left > rounding { left } else { rounding };
            let at = Polished { q, position_error: bound * asked.reach, rotation_error: bound };
            return Some(Found { at, determinant, pivot, turned, first });
        }
    }
    None
}

fn halves<S>([a, b, c, d, e, f]: [S; UNKNOWNS]) -> ([S; 3], [S; 3]) {
    ([a, b, c], [d, e, f])
}

/// The columns of the joints that are found.
#[inline]
fn columns_of<'j, S>(unknowns: &[usize; UNKNOWNS], jacobian: &'j [[S; 6]]) -> Option<[&'j [S; 6]; UNKNOWNS]> {
    let [a, b, c, d, e, f] = *unknowns;
    let column = |joint: usize| jacobian.get(joint);
    Some([column(a)?, column(b)?, column(c)?, column(d)?, column(e)?, column(f)?])
}

/// The change of joint values that makes up for what is missing of a pose (m, rad), with the determinant of the Jacobian
/// (reaches, rad).
#[inline(always)]
#[allow(clippy::inline_always, reason = "a call would put the blocks into memory")]
fn step<S: Float>(
    unknowns: &[usize; UNKNOWNS],
    jacobian: &[[S; 6]],
    missing: ([S; 3], [S; 3]),
    per_reach: S,
) -> Option<([S; UNKNOWNS], S)> {
    let columns = columns_of(unknowns, jacobian)?;
    if let Some(blocks) = Blocks::new(columns, per_reach) {
        return Some((blocks.solution(missing.0, missing.1), blocks.determinant));
    }
    Some(Equations::of(columns, missing, per_reach).pivoted())
}

/// Whether the determinant of the Jacobian is negative.
pub(super) fn is_negative<S: Float>(asked: &Asked<'_, S>, tool: &Frame<S>, jacobian: &[[S; 6]]) -> bool {
    Equations::new(asked, tool, jacobian).pivoted().1 < S::ZERO
}

/// What is missing of a target, and the change of the unknowns that makes up for it.
struct Equations<S> {
    /// Columns of the Jacobian, as many as there are unknowns, and what is missing (reaches, rad).
    rows: [[S; UNKNOWNS + 1]; UNKNOWNS],
    count: usize,
}

impl<S: Float> Equations<S> {
    /// At a tool frame with its Jacobian.
    fn new(asked: &Asked<'_, S>, tool: &Frame<S>, jacobian: &[[S; 6]]) -> Self {
        let mut rows = [[S::ZERO; UNKNOWNS + 1]; UNKNOWNS];
        let count = asked.unknowns.len().min(UNKNOWNS);
        let (columns, missing) = (asked.columns(tool, jacobian), asked.missing(tool));
        for (place, column) in columns.iter().take(count).chain([&missing]).enumerate() {
            for (row, entry) in rows.iter_mut().zip(column) {
                row[place] = *entry;
            }
        }
        Self { rows, count }
    }

    /// Of columns and what is missing (m, rad) of a pose.
    fn of(columns: [&[S; 6]; UNKNOWNS], (away, turned): ([S; 3], [S; 3]), per_reach: S) -> Self {
        let mut rows = [[S::ZERO; UNKNOWNS + 1]; UNKNOWNS];
        let [px, py, pz] = away;
        let [wx, wy, wz] = turned;
        let missing = [px, py, pz, wx, wy, wz];
        let scale = [per_reach, per_reach, per_reach, S::ONE, S::ONE, S::ONE];
        for (place, column) in columns.into_iter().chain([&missing]).enumerate() {
            for ((row, entry), scale) in rows.iter_mut().zip(column).zip(scale) {
                row[place] = *entry * scale;
            }
        }
        Self { rows, count: UNKNOWNS }
    }

    /// By Gaussian elimination with partial pivoting, and the determinant; not finite where the equations are singular.
    #[cold]
    #[inline(never)]
    fn pivoted(&mut self) -> ([S; UNKNOWNS], S) {
        let exchanged = self.triangular();
        let start = if exchanged { -S::ONE } else { S::ONE };
        let determinant = self.pivots().fold(start, |product, pivot| product * pivot);
        (self.substituted(), determinant)
    }

    /// Of equations that were brought to triangular form.
    fn pivots(&self) -> impl Iterator<Item = S> {
        self.rows.iter().take(self.count).enumerate().map(|(k, row)| row[k])
    }

    /// The same: the least of them.
    fn least_pivot(&self) -> S {
        self.pivots()
            .map(Float::abs)
            .fold(S::INFINITY, |least, pivot| if pivot < least { pivot } else { least })
    }

    /// Says whether rows were exchanged an odd number of times.
    fn triangular(&mut self) -> bool {
        let (a, count) = (&mut self.rows, self.count);
        let mut odd = false;
        for k in 0..count {
            for r in k + 1..count {
                if a[r][k].abs() > a[k][k].abs() {
                    let (upper, lower) = (a[k], a[r]);
                    a[k] = lower;
                    a[r] = upper;
                    odd = !odd;
                }
            }
            // Takes the unknown of this column out of the rows below.
            let top = a[k];
            let inverse = S::ONE / top[k];
            for row in a.iter_mut().take(count).skip(k + 1) {
                let factor = row[k] * inverse;
                for (value, from) in row.iter_mut().zip(top).take(count + 1).skip(k + 1) {
                    *value -= factor * from;
                }
            }
        }
        odd
    }

    /// The unknowns of equations that were brought to triangular form.
    fn substituted(&self) -> [S; UNKNOWNS] {
        let (a, count) = (&self.rows, self.count);
        let mut x = [S::ZERO; UNKNOWNS];
        for k in (0..count).rev() {
            let mut value = a[k][count];
            for j in k + 1..count {
                value -= a[k][j] * x[j];
            }
            x[k] = value / a[k][k];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::{Equations, UNKNOWNS, solve};
    use crate::search::near::asked::{Asked, across};
    use crate::{Frame, Target};

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
    fn equations_are_solved_with_rows_exchanged() {
        for hidden in [false, true] {
            let rows = rows(hidden);
            let (x, _) = Equations { rows, count: UNKNOWNS }.pivoted();
            assert!(left(&rows, &x) < 1e-12);
        }
    }

    #[test]
    fn equations_that_are_singular_have_no_finite_solution() {
        let mut rows = rows(false);
        rows[5] = rows[4];
        assert!(!Equations { rows, count: UNKNOWNS }.pivoted().0.iter().all(|x| x.abs() < 1e9));
    }

    /// Whatever rows the target has that they miss nothing of.
    #[test]
    fn joint_values_that_are_no_numbers_meet_nothing() {
        let place = |q: &[f64; 2]| {
            let (s, c) = libm::sincos(q[0]);
            let tool = Frame::from_translation([c, s, q[1]]);
            (tool, [[-s, c, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]])
        };
        for target in [Target::Xy([1.0, 0.0]), Target::XyYaw { position: [1.0, 0.0], yaw: 0.0 }] {
            let across = across(&target);
            let asked = Asked { target: &target, unknowns: &[0, 1], follow: &[], across, reach: 1.0 };
            assert!(solve([f64::NAN, 0.0], &asked, place).is_none(), "{target:?}");
        }
    }
}
