//! The curve of joint values that keep a pose, point by point: back onto it, along it, towards a seed, to a limit.

use super::forces::Forces;
use super::pseudo_inverse::{PseudoInverse, add, dot};
use crate::frame::{add as plus, cross, sub, turn};
use crate::solutions::travel;
use crate::{Float, Frame};

/// How often joint values are moved before they are given up: each move squares what is left of the error.
const MOVES: u32 = 80;
/// A move of this (rad or m) may be the last one before which the Jacobian is inverted: what it leaves is taken away by the
/// same inverse.
const LAST: f64 = 1e-3;
/// Where that is not enough, moves are to be so much shorter.
const SHORTER: f64 = 1.0 / 64.0;
/// How often an inverse is used again, and an error (reaches, rad) in machine epsilons that is what rounding leaves.
const AGAIN: u32 = 3;
const ROUNDING: f64 = 32.0;
/// How much of the square of an offset may lie along the curve where it is said to be across: the distance is off by half
/// of that part at most.
const INEXACT: f64 = 1e-9;
/// The greatest move along the curve (rad or m), and back onto it.
const LONGEST: f64 = 0.3;
/// Back onto the curve by more than this part of a move along it is far.
const STRAYS: f64 = 0.25;
/// So far from the curve (rad or m) it is known which part of it the way leads to.
const BESIDE: f64 = 0.1;
/// Below this the square of the distance bends the wrong way along the curve, or hardly: its parabola isn't followed.
const FLAT: f64 = 0.2;

/// The curve, and what it is looked at from.
pub(super) struct Curve<'c, const N: usize, S, F> {
    /// The pose that is kept.
    pub(super) pose: &'c Frame<S>,
    /// 1/m
    pub(super) per_reach: S,
    /// How many of the joint values are there; the rest is padding.
    pub(super) dof: usize,
    /// Tool frame and columns of the Jacobian.
    pub(super) state: F,
    /// rad or m
    pub(super) seed: &'c [S; N],
}

/// Tool frame (m), and columns of the Jacobian (rad, m).
pub(super) type State<const N: usize, S> = (Frame<S>, [[S; 6]; N]);

/// The curve near some joint values.
pub(super) struct Local<const N: usize, S> {
    inverse: PseudoInverse<N, S>,
    /// The least change that leads onto it, to first order.
    correction: [S; N],
    /// Its direction, of length 1.
    pub(super) tangent: [S; N],
}

/// A point of the curve.
pub(super) struct Point<const N: usize, S> {
    /// rad or m
    pub(super) q: [S; N],
    /// The tool frame (m) there.
    pub(super) tool: Frame<S>,
}

impl<const N: usize, S, F> Curve<'_, N, S, F>
where
    S: Float,
    F: Fn(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
{
    /// What a tool frame is off by, in reaches and rad.
    fn error(&self, tool: &Frame<S>) -> [S; 6] {
        let p = self.per_reach;
        let [px, py, pz] = sub(self.pose.translation, tool.translation);
        let ([wx, wy, wz], _) = turn(&tool.rotation, &self.pose.rotation);
        [px * p, py * p, pz * p, wx, wy, wz]
    }

    /// The Jacobian's rows (reaches and rad).
    fn rows(&self, columns: &[[S; 6]; N]) -> [[S; N]; 6] {
        let p = self.per_reach;
        let mut rows = [[S::ZERO; N]; 6];
        let [r1, r2, r3, r4, r5, r6] = &mut rows;
        let entries = r1.iter_mut().zip(r2).zip(r3).zip(r4).zip(r5).zip(r6);
        for ((((((e1, e2), e3), e4), e5), e6), [vx, vy, vz, ax, ay, az]) in entries.zip(columns) {
            (*e1, *e2, *e3) = (*vx * p, *vy * p, *vz * p);
            (*e4, *e5, *e6) = (*ax, *ay, *az);
        }
        rows
    }

    /// The linear equations J dq = e at joint values, of which tool frame and Jacobian are known.
    pub(super) fn local(&self, (tool, columns): &State<N, S>) -> Local<N, S> {
        let (inverse, tangent) = PseudoInverse::of(self.rows(columns), self.dof);
        Local { correction: inverse.least(&self.error(tool)), tangent, inverse }
    }

    /// The point of the curve from which the seed is nearest, downhill from joint values of which this is known, and whether
    /// no point of any curve is nearer. None where the way comes by joint values, with that direction of the curve, from
    /// which it is known where it leads.
    ///
    /// Newton's method on what Lagrange asks of it: that it is on the curve, and that its offset from the seed is across.
    pub(super) fn nearest_point(
        &self,
        from: &[S; N],
        state: &State<N, S>,
        first: Local<N, S>,
        is_known: impl Fn(&[S; N], &[S; N]) -> bool,
    ) -> Option<(Point<N, S>, bool)> {
        let near = S::from_f64(LAST).max(S::SQRT_EPSILON);
        let beside = S::from_f64(BESIDE * BESIDE);
        let along = |q: &[S; N], columns: &[[S; 6]; N], local: &Local<N, S>, longest: S| {
            if dot(&local.correction, &local.correction) <= beside && is_known(q, &local.tangent) {
                return S::NAN;
            }
            let mut offset = *q;
            add(&mut offset, self.seed, -S::ONE);
            let slope = dot(&offset, &local.tangent);
            // How much of the offset that there will be is across changes with a move along the curve and with one onto it.
            add(&mut offset, &local.correction, S::ONE);
            let forces = Forces::new(columns, local.inverse.multipliers(&offset), self.per_reach);
            let turned = forces.bend(columns, &local.tangent);
            let bend = S::ONE - dot(&turned, &local.tangent);
            // Where the square of the distance bends the wrong way, or hardly, the slope says the way.
            let along = if bend > S::from_f64(FLAT) {
                (dot(&turned, &local.correction) - slope) / bend
            } else {
                -slope
            };
            along.max(-longest).min(longest)
        };
        self.walk((from, state, first), true, near, along, |q, inverse, last| {
            let (point, columns, exact) = self.settled(q, inverse);
            let (at_bottom, certain) = self.is_nearest(&point.q, &columns, inverse);
            (last || (exact && at_bottom)).then_some((point, certain))
        })
    }

    /// Whether the seed is across the curve from a point of it, and no point of any curve is nearer to the seed.
    fn is_nearest(&self, q: &[S; N], columns: &[[S; 6]; N], inverse: &PseudoInverse<N, S>) -> (bool, bool) {
        let mut left = *q;
        add(&mut left, self.seed, -S::ONE);
        let square = dot(&left, &left);
        let mut multipliers = [S::ZERO; 6];
        for _ in 0..2 {
            let more = inverse.multipliers(&left);
            let [fx, fy, fz, mx, my, mz] = more;
            for (left, [vx, vy, vz, ax, ay, az]) in left.iter_mut().zip(columns) {
                let force = *vx * fx + *vy * fy + *vz * fz;
                *left -= force * self.per_reach + (*ax * mx + *ay * my + *az * mz);
            }
            multipliers.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        // What is left of the offset costs its square over the room at most.
        let inexact = dot(&left, &left);
        let rounding = S::from_f64(ROUNDING) * S::EPSILON;
        let most = S::from_f64(INEXACT) * square + rounding * rounding;
        let room =
            || Forces::new(columns, multipliers, self.per_reach).room(columns, self.dof, square.sqrt());
        (inexact <= most, inverse.independent && inexact <= most && inexact <= most * room())
    }

    /// The point of the curve where a sum of joints has a value (rad or m), the nearest along the tangent, if it comes
    /// before the curve is farther from the seed than both `most` and where it starts.
    pub(super) fn crossing(
        &self,
        from: &[S; N],
        sum: impl Fn(&[S; N]) -> S,
        value: S,
        most: S,
    ) -> Option<Point<N, S>> {
        let most = most.max(travel(from, self.seed).sqrt());
        let state = (self.state)(from);
        let first = self.local(&state);
        let along = |q: &[S; N], _: &[[S; 6]; N], local: &Local<N, S>, longest: S| {
            if travel(q, self.seed).sqrt() > most + longest {
                return S::NAN;
            }
            let missing = value - sum(q) - sum(&local.correction);
            (missing / sum(&local.tangent)).max(-longest).min(longest)
        };
        // A move across the curve that `along` does not know of leads away from the value where that hardly changes along it.
        let done = |q, _: &PseudoInverse<N, S>, _| Some(Point { q, tool: (self.state)(&q).0 });
        self.walk((from, &state, first), false, S::SQRT_EPSILON, along, done)
    }

    /// Moves joint values onto the curve and along it, as far as `along` says of them, of the Jacobian, of the curve there,
    /// and of the longest move, until they are on it and all moves together are as short as `near`. Then `done` is asked, with
    /// what undoes the Jacobian before the last move, and whether there is nothing left to be moved. If `bent`, second
    /// derivatives of the tool take part, as far as moves across the curve make up for them.
    fn walk<T>(
        &self,
        (from, state, first): (&[S; N], &State<N, S>, Local<N, S>),
        bent: bool,
        mut near: S,
        along: impl Fn(&[S; N], &[[S; 6]; N], &Local<N, S>, S) -> S,
        done: impl Fn([S; N], &PseudoInverse<N, S>, bool) -> Option<T>,
    ) -> Option<T> {
        let mut q = *from;
        let most = S::from_f64(LONGEST);
        let (mut longest, mut moved) = (most, S::ZERO);
        let mut local = first;
        let mut state = *state;
        for _ in 0..MOVES {
            let aside = dot(&local.correction, &local.correction).sqrt();
            // Where the curve bends away from its tangent, shorter moves stay with it.
            let strays = moved > S::ZERO && aside > moved * S::from_f64(STRAYS);
            longest = if strays { longest / S::TWO } else { most.min(longest * S::from_f64(1.5)) };
            let along = along(&q, &state.1, &local, longest);
            moved = along.abs();
            let shorter = S::ONE.min(S::from_f64(LONGEST) / aside);
            let mut step = local.correction;
            if shorter < S::ONE {
                for x in &mut step {
                    *x *= shorter;
                }
            }
            add(&mut step, &local.tangent, along);
            add(&mut q, &step, S::ONE);
            let missing = aside + moved;
            if !missing.is_finite() {
                return None;
            }
            // Second derivatives take part where they are small beside first ones.
            if bent && shorter >= S::ONE {
                let second = local.inverse.least(&self.second(&state.1, &step));
                let size = missing * S::from_f64(STRAYS);
                if dot(&second, &second) <= size * size {
                    add(&mut q, &second, -S::ONE / S::TWO);
                }
            }
            if missing <= near {
                let found = done(q, &local.inverse, missing <= S::SQRT_EPSILON);
                if found.is_some() {
                    return found;
                }
                near *= S::from_f64(SHORTER);
            }
            state = (self.state)(&q);
            local = self.local(&state);
        }
        None
    }

    /// The tool frame's second derivative (reaches, rad) along a step.
    fn second(&self, columns: &[[S; 6]; N], step: &[S; N]) -> [S; 6] {
        let (mut turned, mut at, mut turns) = ([S::ZERO; 3], [S::ZERO; 3], [S::ZERO; 3]);
        for ([vx, vy, vz, ax, ay, az], x) in columns.iter().zip(step) {
            let moved = [*vx * *x, *vy * *x, *vz * *x];
            let own = [*ax * *x, *ay * *x, *az * *x];
            turns = plus(turns, cross(turned, own));
            // Those before count twice, with this one and this one with them.
            let before = turned;
            turned = plus(turned, own);
            at = plus(at, cross(plus(before, turned), moved));
        }
        let [px, py, pz] = at.map(|x| x * self.per_reach);
        let [wx, wy, wz] = turns;
        [px, py, pz, wx, wy, wz]
    }

    /// Joint values next to the curve, on it, by what undoes the Jacobian next to there; and the Jacobian, and whether only
    /// rounding is left.
    fn settled(&self, mut q: [S; N], inverse: &PseudoInverse<N, S>) -> (Point<N, S>, [[S; 6]; N], bool) {
        let (mut tool, mut columns) = (self.state)(&q);
        let mut error = self.error(&tool);
        let mut square = dot(&error, &error);
        let rounding = S::from_f64(ROUNDING) * S::EPSILON;
        for _ in 0..AGAIN {
            if square <= rounding * rounding {
                break;
            }
            let back = inverse.least(&error);
            // Where the Jacobian is next to singular, it is no longer that of here.
            if dot(&back, &back) > S::from_f64(LAST * LAST) {
                break;
            }
            let mut moved = q;
            add(&mut moved, &back, S::ONE);
            let next = (self.state)(&moved);
            error = self.error(&next.0);
            let before = core::mem::replace(&mut square, dot(&error, &error));
            if square >= before {
                break;
            }
            (q, (tool, columns)) = (moved, next);
        }
        (Point { q, tool }, columns, square <= rounding * rounding)
    }
}
