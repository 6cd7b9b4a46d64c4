//! Two solutions that are about to meet, or have just met: both, or neither.
//!
//! There the Jacobian has one direction that hardly moves the tool. Five equations of the pose tell five joints for every
//! value of the sixth, and what is left of the last equation is nearly a parabola in that value \[Lyapunov-Schmidt reduction;
//! Golubitsky and Schaeffer, Singularities and Groups in Bifurcation Theory, §I.3\]. Its vertex is looked for on the arm
//! itself, so that its sign there decides.

use super::UNKNOWNS;
use super::newton::{self, Equations};
use crate::polish::Polished;
use crate::{Float, Frame};

/// Equations, the right-hand sides in the last column.
type Rows<S> = [[S; UNKNOWNS + 1]; UNKNOWNS];

/// Steps that bring five joints to their equations, at most.
const STEPS: usize = 8;

/// They are met where this much (reaches, rad) is left.
const MET: f64 = 1e-11;

/// Where the fifth pivot is smaller, more than one direction hardly moves the tool.
const PIVOT: f64 = 0.02;

/// A curvature that is smaller is none.
const CURVED: f64 = 0.01;

/// The joint that is held need not be that of the step: it may move more than that one.
const FARTHER: f64 = 8.0;

/// Two solutions that are nearer to each other (rad, reaches) may be one, or none.
const APART: f64 = 1e-5;

/// What has become of two solutions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fold<const N: usize, S> {
    /// They are there.
    Both([Polished<N, S>; 2]),
    /// They have met.
    Neither,
}

/// Of two solutions that may have met: both, neither, or `None` where it isn't sure. They are at most `far` (rad, reaches)
/// from the start.
pub(super) fn solve<const N: usize, S: Float>(
    start: [S; N],
    unknowns: &[usize; UNKNOWNS],
    target: &Frame<S>,
    reach: S,
    far: S,
    mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
) -> Option<Fold<N, S>> {
    let (tool, jacobian) = pose_and_jacobian(&start);
    let at = Equations::new(unknowns, &tool, &jacobian, target, reach)?;
    let mut path = Path { order: Order::of(&at.rows)?, unknowns, target, reach, pose_and_jacobian };
    let first = path.meet(start)?;
    let second = path.meet(path.along(&first, far / S::TWO))?;
    let curvature = (second.slope - first.slope) / (far / S::TWO);
    if !super::above(curvature.abs(), S::from_f64(CURVED)) {
        return None;
    }
    let to_vertex = -first.slope / curvature;
    if !super::above(S::from_f64(FARTHER) * far, to_vertex.abs()) {
        return None;
    }
    let near_vertex = path.meet(path.along(&first, to_vertex))?;
    // Where the parabola is not quite one, its curvature there.
    let curvature = if to_vertex.abs() > S::from_f64(APART) {
        (near_vertex.slope - first.slope) / to_vertex
    } else {
        curvature
    };
    if !super::above(curvature.abs(), S::from_f64(CURVED)) {
        return None;
    }
    let vertex = path.meet(path.along(&near_vertex, -near_vertex.slope / curvature))?;
    let rest = -vertex.slope / curvature;
    let square = rest * rest - S::TWO * vertex.value / curvature;
    let apart = S::from_f64(APART);
    if !super::above(square.abs(), apart * apart) {
        return None;
    }
    if square < S::ZERO {
        return Some(Fold::Neither);
    }
    let side = square.sqrt();
    let [one, other] = [rest - side, rest + side].map(|step| path.along(&vertex, step));
    let both = [path.polished(one)?, path.polished(other)?];
    let [below, above] = both.map(|solution| path.held(&solution.q) - path.held(&vertex.q));
    (below < S::ZERO && above > S::ZERO).then_some(Fold::Both(both))
}

/// Row `r`, column `c`.
fn entry<S: Float>(rows: &Rows<S>, r: usize, c: usize) -> S {
    rows.get(r).and_then(|row| row.get(c)).copied().unwrap_or(S::NAN)
}

/// In which order rows and columns are eliminated: the last column is the joint whose value is held.
struct Order {
    rows: [usize; UNKNOWNS],
    columns: [usize; UNKNOWNS],
}

impl Order {
    /// By the greatest pivots.
    fn of<S: Float>(rows: &Rows<S>) -> Option<Self> {
        let mut order = Self { rows: [0, 1, 2, 3, 4, 5], columns: [0, 1, 2, 3, 4, 5] };
        for k in 0..UNKNOWNS - 1 {
            let mut a = order.apply(rows);
            for done in 0..k {
                newton::eliminate(&mut a, done);
            }
            let (mut at, mut greatest) = ((k, k), S::ZERO);
            for (r, row) in a.iter().enumerate().skip(k) {
                for (c, value) in row.iter().enumerate().take(UNKNOWNS).skip(k) {
                    if value.abs() > greatest {
                        (at, greatest) = ((r, c), value.abs());
                    }
                }
            }
            if !super::above(greatest, S::from_f64(PIVOT)) {
                return None;
            }
            exchange(&mut order.rows, k, at.0);
            exchange(&mut order.columns, k, at.1);
        }
        Some(order)
    }

    fn apply<S: Float>(&self, rows: &Rows<S>) -> Rows<S> {
        self.rows.map(|r| {
            let [a, b, c, d, e, f] = self.columns.map(|c| entry(rows, r, c));
            [a, b, c, d, e, f, entry(rows, r, UNKNOWNS)]
        })
    }
}

fn exchange(list: &mut [usize; UNKNOWNS], i: usize, j: usize) {
    let (a, b) = (list.get(i).copied(), list.get(j).copied());
    for (place, value) in [(i, b), (j, a)] {
        if let (Some(entry), Some(value)) = (list.get_mut(place), value) {
            *entry = value;
        }
    }
}

/// A point at which five equations are met.
struct Point<const N: usize, S> {
    q: [S; N],
    /// The last equation: what is missing, and how that changes with the held joint.
    value: S,
    slope: S,
    /// How the other joints follow the held one.
    tangent: [S; UNKNOWNS],
}

/// The joint values that meet five of the equations.
struct Path<'a, const N: usize, S, F> {
    order: Order,
    unknowns: &'a [usize; UNKNOWNS],
    target: &'a Frame<S>,
    reach: S,
    pose_and_jacobian: F,
}

impl<const N: usize, S: Float, F: FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N])> Path<'_, N, S, F> {
    /// The value of the held joint.
    fn held(&self, q: &[S; N]) -> S {
        let [.., last] = self.order.columns;
        let joint = self.unknowns.get(last).and_then(|joint| q.get(*joint));
        joint.copied().unwrap_or(S::NAN)
    }

    /// Joint values changed, in the order of elimination.
    fn moved(&self, q: &[S; N], by: [S; UNKNOWNS]) -> [S; N] {
        let mut q = *q;
        for (column, change) in self.order.columns.iter().zip(by) {
            if let Some(value) = self.unknowns.get(*column).and_then(|joint| q.get_mut(*joint)) {
                *value += change;
            }
        }
        q
    }

    /// From a point along the path.
    fn along(&self, from: &Point<N, S>, by: S) -> [S; N] {
        self.moved(&from.q, from.tangent.map(|rate| rate * by))
    }

    /// Brings the other five to their equations.
    fn meet(&mut self, start: [S; N]) -> Option<Point<N, S>> {
        const LAST: usize = UNKNOWNS - 1;
        let mut q = start;
        for _ in 0..STEPS {
            let (tool, jacobian) = (self.pose_and_jacobian)(&q);
            let at = Equations::new(self.unknowns, &tool, &jacobian, self.target, self.reach)?;
            let mut a = self.order.apply(&at.rows);
            let missing = a.map(|row| row[UNKNOWNS]);
            for k in 0..LAST {
                newton::eliminate(&mut a, k);
            }
            let others = missing.iter().take(LAST).fold(S::ZERO, |most, x| most.max(x.abs()));
            if others <= S::from_f64(MET).max(S::from_f64(64.0) * S::EPSILON) {
                let mut tangent = newton::substitute(&a, LAST, LAST).map(|rate| -rate);
                tangent[LAST] = S::ONE;
                return Some(Point { q, value: -missing[LAST], slope: a[LAST][LAST], tangent });
            }
            q = self.moved(&q, newton::substitute(&a, LAST, UNKNOWNS));
        }
        None
    }

    fn polished(&mut self, q: [S; N]) -> Option<Polished<N, S>> {
        newton::solve(q, self.unknowns, self.target, self.reach, &mut self.pose_and_jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::{Fold, solve};
    use crate::Frame;

    const UNKNOWNS: [usize; 6] = [0, 1, 2, 3, 4, 5];

    /// Three slides, the first of which has gone round a bend at 0.1, and three turns.
    fn bent(q: &[f64; 6]) -> (Frame, [[f64; 6]; 6]) {
        let [a, b, c, x, y, z] = *q;
        let off = a - 0.1;
        let tool = Frame::from_rpy([off * off + 0.3 * off * off * off + b, b, c + 0.2 * off], [x, y, z]);
        let (sy, cy) = (libm::sin(y), libm::cos(y));
        let (sz, cz) = (libm::sin(z), libm::cos(z));
        let columns = [
            [2.0 * off + 0.9 * off * off, 0.0, 0.2, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, cz * cy, sz * cy, -sy],
            [0.0, 0.0, 0.0, -sz, cz, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ];
        (tool, columns)
    }

    fn target(a: f64) -> Frame {
        bent(&[a, 0.2, -0.1, 0.3, -0.2, 0.5]).0
    }

    const START: [f64; 6] = [0.095, 0.21, -0.11, 0.29, -0.19, 0.52];

    #[test]
    fn both_solutions_next_to_a_fold_are_found() {
        for off in [1e-3, 0.01, 0.05] {
            let found = solve(START, &UNKNOWNS, &target(0.1 + off), 1.0, 0.05, bent);
            let Some(Fold::Both([one, other])) = found else { panic!("{off}: {found:?}") };
            let (low, high) = if one.q[0] < other.q[0] { (one, other) } else { (other, one) };
            assert!((high.q[0] - 0.1 - off).abs() < 1e-9, "{off}: {high:?}");
            assert!(low.q[0] < 0.1 && low.position_error < 1e-13 && high.rotation_error < 1e-13);
        }
    }

    #[test]
    fn neither_is_where_they_have_met() {
        let mut target = target(0.1);
        target.translation[0] -= 1e-6;
        assert_eq!(solve(START, &UNKNOWNS, &target, 1.0, 0.05, bent), Some(Fold::Neither));
    }

    #[test]
    fn nothing_is_said_at_the_fold_itself_or_where_more_is_singular() {
        assert_eq!(solve(START, &UNKNOWNS, &target(0.1), 1.0, 0.05, bent), None);
        let twice = |q: &[f64; 6]| {
            let (tool, mut columns) = bent(q);
            columns[1] = [1e-3; 6];
            (tool, columns)
        };
        assert_eq!(solve(START, &UNKNOWNS, &target(0.12), 1.0, 0.05, twice), None);
    }
}
