//! Joint values brought nearer to a pose, step by step: the last digits of a solution whose steps were ill-conditioned.

use crate::frame::{norm, sub};
use crate::{Float, Frame, rotation_error};

/// Joint values, and how far the tool frame that they give is from its target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polished<const N: usize, S = f64> {
    /// Joint values (rad or m).
    pub q: [S; N],
    /// m
    pub position_error: S,
    /// rad
    pub rotation_error: S,
}

/// An error (reaches, rad) of this many machine epsilons is what rounding leaves.
const ROUNDING: f64 = 4.0;

/// An error of this many machine epsilons that a step didn't make smaller isn't tried again.
const SMALL: f64 = 64.0;

/// What the damping is multiplied by after a step that made the error greater, and divided by after one that didn't.
const DAMPING: f64 = 16.0;

/// Up to this many times what was missing (its square), a step that made it greater may be one along a valley that bends: one
/// more step, from where it led to, shows it.
const CLIMB: f64 = 4.0;

/// Brings joint values nearer to a pose by at most `steps` damped Gauss-Newton steps on all six coordinates of the tool
/// frame; never farther from it.
///
/// `pose_and_jacobian` is the tool frame with the columns of the geometric Jacobian (vx vy vz wx wy wz, base axes, at the
/// tool point), the reach (m) is what errors of positions are relative to. `N` may be any number of joints: of more than
/// six, the step with the least travel is taken, and with fewer the pose is met as well as it can be.
///
/// A step minimises |e - J dq|² + λ |dq|² with λ = |e|², e being the error in reaches and radians \[Levenberg 1944; Fan and
/// Yuan 2005 on this choice of λ\]. Near a solution this converges as Newton's method does (the error is squared with each
/// step), also where the Jacobian is singular but solutions form a curve, since λ vanishes with the error; at an isolated
/// double root by a factor of four a step. A Jacobian that is singular does no harm. The step comes from an orthogonal
/// factorisation, so that directions with singular values down to the square root of λ count.
pub fn polish<const N: usize, S: Float>(
    q: [S; N],
    target: &Frame<S>,
    reach: S,
    steps: usize,
    mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
) -> Polished<N, S> {
    let per_reach = if reach > S::ZERO && reach.is_finite() { S::ONE / reach } else { S::ONE };
    let (q, tool) = descend(q, steps, S::ZERO, |q| {
        let (tool, mut columns) = pose_and_jacobian(q);
        let [px, py, pz] = sub(target.translation, tool.translation).map(|x| x * per_reach);
        let [wx, wy, wz] = turn(&tool, target);
        for [x, y, z, ..] in &mut columns {
            (*x, *y, *z) = (*x * per_reach, *y * per_reach, *z * per_reach);
        }
        (tool, [px, py, pz, wx, wy, wz], columns)
    });
    Polished {
        q,
        position_error: norm(sub(tool.translation, target.translation)),
        rotation_error: rotation_error(&target.rotation, &tool.rotation),
    }
}

/// The steps of [`polish`] on any six quantities that are to become 0: `at` gives something to be handed back of the
/// place, what is missing there, and by how much less with each unknown.
///
/// Where a step would take away less than the part `least` of the square of what is missing, they lead to no solution, and
/// end. That is said of steps that are damped as usual, or less, and with λ of at most 1: from far away the damping alone makes
/// every step a small one. Steps without any damping would say it too late, since what is missing at a minimum that is no
/// solution can be had along its singular direction until the very last.
pub(crate) fn descend<const N: usize, T, S: Float>(
    q: [S; N],
    steps: usize,
    least: S,
    mut at: impl FnMut(&[S; N]) -> (T, [S; 6], [[S; 6]; N]),
) -> ([S; N], T) {
    let mut here = State::new(q, &mut at);
    let mut damping = S::ONE;
    for _ in 0..steps {
        let rounding = S::from_f64(ROUNDING) * S::EPSILON;
        if here.cost <= rounding * rounding {
            break;
        }
        let step = damped_step(&here.columns, here.error, (damping * here.cost).sqrt());
        if step.iter().all(|change| change.abs() <= S::EPSILON) {
            break;
        }
        let slightly = damping <= S::ONE && damping * here.cost <= S::ONE;
        if slightly && here.gains(&step) < least {
            break;
        }
        let next = here.after(&step, &mut at);
        if next.cost < here.cost {
            here = next;
            damping /= S::from_f64(DAMPING);
            continue;
        }
        let small = S::from_f64(SMALL) * S::EPSILON;
        if here.cost <= small * small {
            break;
        }
        if least > S::ZERO && next.cost < S::from_f64(CLIMB) * here.cost {
            let step = damped_step(&next.columns, next.error, (damping * next.cost).sqrt());
            let second = next.after(&step, &mut at);
            if second.cost < here.cost {
                here = second;
                continue;
            }
        }
        damping *= S::from_f64(DAMPING);
    }
    (here.q, here.place)
}

/// Joint values with what they give.
struct State<const N: usize, T, S> {
    q: [S; N],
    place: T,
    columns: [[S; 6]; N],
    /// Position in reaches, then rotation in rad.
    error: [S; 6],
    /// Its square.
    cost: S,
}

impl<const N: usize, T, S: Float> State<N, T, S> {
    fn new(q: [S; N], at: &mut impl FnMut(&[S; N]) -> (T, [S; 6], [[S; 6]; N])) -> Self {
        let (place, error, columns) = at(&q);
        Self { q, place, columns, error, cost: square(&error) }
    }

    /// The place a step from here.
    fn after(&self, step: &[S; N], at: &mut impl FnMut(&[S; N]) -> (T, [S; 6], [[S; 6]; N])) -> Self {
        let mut moved = self.q;
        moved.iter_mut().zip(step).for_each(|(value, change)| *value += *change);
        Self::new(moved, at)
    }

    /// The part of what is missing that a step takes away, if the equations were linear.
    fn gains(&self, step: &[S; N]) -> S {
        let mut rest = self.error;
        for (column, change) in self.columns.iter().zip(step) {
            rest.iter_mut().zip(column).for_each(|(rest, own)| *rest -= *own * *change);
        }
        S::ONE - square(&rest) / self.cost
    }
}

/// The axis of the turn from one orientation to another, as long as the sine of its angle; for more than a quarter turn
/// as long as 2 minus that, so that half a turn does not look like none.
#[inline]
pub(crate) fn turn<S: Float>(from: &Frame<S>, to: &Frame<S>) -> [S; 3] {
    let (sine_axis, trace) = crate::frame::turn(&from.rotation, &to.rotation);
    if trace >= S::ONE { sine_axis } else { far_turn(sine_axis) }
}

/// Of more than a quarter turn.
#[cold]
#[inline(never)]
fn far_turn<S: Float>(sine_axis: [S; 3]) -> [S; 3] {
    let sine = norm(sine_axis);
    // At exactly half a turn the axis is not in the antisymmetric part; any other error may then lead on.
    let longer = if sine > S::ZERO { (S::TWO - sine) / sine } else { S::ONE };
    sine_axis.map(|x| x * longer)
}

fn square<S: Float>(values: &[S]) -> S {
    values.iter().fold(S::ZERO, |sum, x| sum + *x * *x)
}

/// A column of the Jacobian over a column of the damping's diagonal.
#[derive(Clone, Copy)]
struct Column<const N: usize, S> {
    upper: [S; 6],
    lower: [S; N],
}

impl<const N: usize, S: Float> Column<N, S> {
    fn dot(&self, other: &Self) -> S {
        let products = self.upper.iter().zip(&other.upper).chain(self.lower.iter().zip(&other.lower));
        products.fold(S::ZERO, |sum, (a, b)| sum + *a * *b)
    }

    /// self += factor * other
    fn add_scaled(&mut self, other: &Self, factor: S) {
        let entries = self.upper.iter_mut().zip(&other.upper).chain(self.lower.iter_mut().zip(&other.lower));
        entries.for_each(|(a, b)| *a += factor * *b);
    }
}

/// The dq with the least |e - J dq|² + damping² |dq|², by modified Gram-Schmidt on the Jacobian over damping * 1
/// \[Björck, Numerical Methods for Least Squares Problems, §2.4\].
pub(crate) fn damped_step<const N: usize, S: Float>(
    jacobian: &[[S; 6]; N],
    error: [S; 6],
    damping: S,
) -> [S; N] {
    let mut columns = [Column { upper: [S::ZERO; 6], lower: [S::ZERO; N] }; N];
    for (index, (column, upper)) in columns.iter_mut().zip(jacobian).enumerate() {
        column.upper = *upper;
        if let Some(entry) = column.lower.get_mut(index) {
            *entry = damping;
        }
    }
    let mut rest = Column { upper: error, lower: [S::ZERO; N] };
    // Row j of the triangular factor, from its diagonal on, and the right-hand side.
    let mut factor = [([S::ZERO; N], S::ZERO); N];
    let mut open = columns.as_mut_slice();
    for (row, right) in &mut factor {
        let [first, others @ ..] = open else { break };
        let size = first.dot(first).sqrt();
        let unit = if size > S::ZERO { S::ONE / size } else { S::ZERO };
        first.upper = first.upper.map(|x| x * unit);
        first.lower = first.lower.map(|x| x * unit);
        let [diagonal, behind @ ..] = row.as_mut_slice() else { break };
        *diagonal = unit;
        for (column, entry) in others.iter_mut().zip(behind) {
            *entry = first.dot(column);
            column.add_scaled(first, -*entry);
        }
        *right = first.dot(&rest);
        rest.add_scaled(first, -*right);
        open = others;
    }
    // From the last unknown to the first: `found` has those behind row j at its end.
    let mut step = [S::ZERO; N];
    let mut behind = 0;
    for (row, right) in factor.iter().rev() {
        let [unit, entries @ ..] = row.as_slice() else { break };
        let mut value = *right;
        for (entry, found) in entries.iter().zip(step.iter().skip(N - behind)) {
            value += -(*entry * *found);
        }
        behind += 1;
        if let Some(slot) = step.get_mut(N - behind) {
            *slot = value * *unit;
        }
    }
    step
}

#[cfg(test)]
mod tests {
    use super::{damped_step, polish};
    use crate::Frame;

    /// Two parallel axes (links of 1 and 0.5 m) and a third that turns the hand.
    fn planar(q: &[f64; 3]) -> (Frame, [[f64; 6]; 3]) {
        let sums = [q[0], q[0] + q[1], q[0] + q[1] + q[2]];
        let [(s1, c1), (s12, c12), (_, _)] = sums.map(|x| (libm::sin(x), libm::cos(x)));
        let (x, y) = (c1 + 0.5 * c12, s1 + 0.5 * s12);
        let tool = Frame::from_rpy([x, y, 0.0], [0.0, 0.0, sums[2]]);
        let column = |vx: f64, vy: f64| [vx, vy, 0.0, 0.0, 0.0, 1.0];
        (tool, [column(-y, x), column(-0.5 * s12, 0.5 * c12), column(0.0, 0.0)])
    }

    #[test]
    fn a_regular_pose_is_met_to_the_last_digits() {
        let q = [0.3, 0.9, -0.4];
        let (target, _) = planar(&q);
        let found = polish([0.31, 0.88, -0.37], &target, 1.5, 6, planar);
        assert!(found.q.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
        assert!(found.position_error < 1e-15 && found.rotation_error < 1e-15);
    }

    #[test]
    fn a_double_root_is_approached_and_nothing_gets_worse() {
        let (target, _) = planar(&[0.3, 0.0, 0.2]);
        let start = [0.3, 1e-3, 0.2];
        let mut last = f64::INFINITY;
        for steps in 0..24 {
            let found = polish(start, &target, 1.5, steps, planar);
            let residual = found.position_error.max(found.rotation_error);
            assert!(residual <= last);
            last = residual;
        }
        assert!(last < 1e-13, "{last:e}");
    }

    #[test]
    fn what_cannot_be_reached_is_met_as_well_as_it_can_be() {
        let (mut target, _) = planar(&[0.3, 0.9, -0.4]);
        target.translation[2] = 0.1;
        let found = polish([0.31, 0.88, -0.37], &target, 1.5, 20, planar);
        assert!((found.position_error - 0.1).abs() < 1e-6, "{found:?}");
        let nowhere = polish([f64::NAN; 3], &target, 1.5, 3, planar);
        assert!(nowhere.position_error.is_nan());
    }

    #[test]
    fn a_damped_step_solves_the_normal_equations() {
        let (_, jacobian) = planar(&[0.3, 0.9, -0.4]);
        let (error, per_reach, damping) = ([0.1, -0.2, 0.3, 0.05, 0.02, -0.4], 0.5, 0.1);
        let scaled =
            jacobian.map(|[a, b, c, d, e, f]| [a * per_reach, b * per_reach, c * per_reach, d, e, f]);
        let step = damped_step(&scaled, error, damping);
        for (column, own) in scaled.iter().zip(step) {
            // J^T (e - J dq) = damping^2 dq
            let left: f64 = (0..6)
                .map(|row| {
                    let predicted: f64 = scaled.iter().zip(step).map(|(other, x)| other[row] * x).sum();
                    column[row] * (error[row] - predicted)
                })
                .sum();
            assert!((left - damping * damping * own).abs() < 1e-14);
        }
    }
}
