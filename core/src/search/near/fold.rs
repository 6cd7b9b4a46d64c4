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

/// Of two solutions that may have met: both, neither, or `None` where it isn't sure. They are at most `far` (rad, reaches)
/// from the start.
pub(super) fn solve<const N: usize, S: Float>(
    start: [S; N],
    unknowns: &[usize; UNKNOWNS],
    target: &Frame<S>,
    reach: S,
    far: S,
    mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
) -> Option<Option<[Polished<N, S>; 2]>> {
    let (tool, jacobian) = pose_and_jacobian(&start);
    let at = Equations::new(unknowns, &tool, &jacobian, target, reach)?;
    let mut path = Path { order: Order::of(&at.rows)?, unknowns, target, reach, pose_and_jacobian };
    let first = path.meet(start)?;
    let second = path.meet(path.along(&first, far / S::TWO))?;
    let curvature = (second.slope - first.slope) / (far / S::TWO);
    if !(curvature.abs() > S::from_f64(CURVED)) {
        return None;
    }
    let to_vertex = -first.slope / curvature;
    if !(to_vertex.abs() <= S::from_f64(FARTHER) * far) {
        return None;
    }
    let near_vertex = path.meet(path.along(&first, to_vertex))?;
    // Where the parabola is not quite one, its curvature there.
    let curvature = if to_vertex.abs() > S::from_f64(APART) {
        (near_vertex.slope - first.slope) / to_vertex
    } else {
        curvature
    };
    if !(curvature.abs() > S::from_f64(CURVED)) {
        return None;
    }
    let vertex = path.meet(path.along(&near_vertex, -near_vertex.slope / curvature))?;
    let rest = -vertex.slope / curvature;
    let square = rest * rest - S::TWO * vertex.value / curvature;
    let apart = S::from_f64(APART);
    if !(square.abs() > apart * apart) {
        return None;
    }
    if square < S::ZERO {
        return Some(None);
    }
    let side = square.sqrt();
    let [one, other] = [rest - side, rest + side].map(|step| path.along(&vertex, step));
    let both = [path.polished(one)?, path.polished(other)?];
    let [below, above] = both.map(|solution| path.held(&solution.q) - path.held(&vertex.q));
    (below < S::ZERO && above > S::ZERO).then_some(Some(both))
}

/// In which order rows and columns are eliminated: the last column is the joint whose value is held.
struct Order {
    rows: [usize; UNKNOWNS],
    columns: [usize; UNKNOWNS],
}

impl Order {
    /// By the greatest pivots.
    fn of<S: Float>(rows: &[[S; UNKNOWNS + 1]; UNKNOWNS]) -> Option<Self> {
        let mut a = *rows;
        let mut order = Self { rows: [0, 1, 2, 3, 4, 5], columns: [0, 1, 2, 3, 4, 5] };
        for k in 0..UNKNOWNS - 1 {
            let (mut at, mut greatest) = ((k, k), S::ZERO);
            for (r, row) in a.iter().enumerate().skip(k) {
                for (c, value) in row.iter().enumerate().take(UNKNOWNS).skip(k) {
                    if value.abs() > greatest {
                        (at, greatest) = ((r, c), value.abs());
                    }
                }
            }
            if !(greatest > S::from_f64(PIVOT)) {
                return None;
            }
            let (r, c) = at;
            a.swap(k, r);
            order.rows.swap(k, r);
            order.columns.swap(k, c);
            for row in &mut a {
                row.swap(k, c);
            }
            newton::eliminate(&mut a, k);
        }
        Some(order)
    }

    fn apply<S: Float>(&self, rows: &[[S; UNKNOWNS + 1]; UNKNOWNS]) -> [[S; UNKNOWNS + 1]; UNKNOWNS] {
        self.rows.map(|r| {
            let row = rows[r];
            let [a, b, c, d, e, f] = self.columns.map(|c| row[c]);
            [a, b, c, d, e, f, row[UNKNOWNS]]
        })
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
    /// The held joint.
    fn held(&self, q: &[S; N]) -> S {
        let [.., last] = self.order.columns;
        q[self.unknowns[last]]
    }

    /// From a point along the path.
    fn along(&self, from: &Point<N, S>, by: S) -> [S; N] {
        let mut q = from.q;
        for (column, rate) in self.order.columns.iter().zip(from.tangent) {
            q[self.unknowns[*column]] += rate * by;
        }
        q
    }

    /// Brings the other five to their equations.
    fn meet(&mut self, start: [S; N]) -> Option<Point<N, S>> {
        let mut q = start;
        for _ in 0..STEPS {
            let (tool, jacobian) = (self.pose_and_jacobian)(&q);
            let at = Equations::new(self.unknowns, &tool, &jacobian, self.target, self.reach)?;
            let mut a = self.order.apply(&at.rows);
            let missing = a;
            for k in 0..UNKNOWNS - 1 {
                newton::eliminate(&mut a, k);
            }
            let last = UNKNOWNS - 1;
            let others = missing.iter().take(last).fold(S::ZERO, |most, row| most.max(row[UNKNOWNS].abs()));
            if others.is_nan() {
                return None;
            }
            if others <= S::from_f64(MET).max(S::from_f64(64.0) * S::EPSILON) {
                let mut tangent = newton::substitute(&a, last, last);
                for rate in &mut tangent {
                    *rate = -*rate;
                }
                tangent[last] = S::ONE;
                return Some(Point { q, value: -missing[last][UNKNOWNS], slope: a[last][last], tangent });
            }
            let step = newton::substitute(&a, last, UNKNOWNS);
            for (column, change) in self.order.columns.iter().zip(step).take(last) {
                q[self.unknowns[*column]] += change;
            }
        }
        None
    }

    fn polished(&mut self, q: [S; N]) -> Option<Polished<N, S>> {
        newton::solve(q, self.unknowns, self.target, self.reach, &mut self.pose_and_jacobian)
    }
}
