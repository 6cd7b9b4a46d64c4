//! The curve of joint values that keep a pose, point by point: back onto it, along it, towards a seed, to a limit.

use crate::frame::{cross, sub};
use crate::{Float, Frame};

/// How often joint values are moved before they are given up: each move squares what is left of the error.
const MOVES: u32 = 80;
/// The greatest move along the curve (rad or m), and back onto it.
const LONGEST: f64 = 0.3;
/// Back onto the curve by more than this part of a move along it is far.
const STRAYS: f64 = 0.25;
/// Below this the distance bends the wrong way, or hardly: no parabola is laid.
const FLAT: f64 = 0.2;
/// A row of the Jacobian (in reaches and rad) that others leave less than this of says nothing.
const VANISHING: f64 = 1e-9;

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

/// The curve near some joint values.
pub(super) struct Local<const N: usize, S> {
    /// The least change that leads onto it, to first order.
    correction: [S; N],
    /// Its direction, of length 1.
    pub(super) tangent: [S; N],
}

impl<const N: usize, S, F> Curve<'_, N, S, F>
where
    S: Float,
    F: Fn(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
{
    /// The linear equations J dq = e by modified Gram-Schmidt on the rows of J.
    pub(super) fn local(&self, q: &[S; N]) -> Local<N, S> {
        let (tool, columns) = (self.state)(q);
        let [px, py, pz] = sub(self.pose.translation, tool.translation).map(|x| x * self.per_reach);
        let [wx, wy, wz] = turn(&tool, self.pose);
        let error = [px, py, pz, wx, wy, wz];
        let p = self.per_reach;
        let mut rows = [[S::ZERO; N]; 6];
        for (place, [vx, vy, vz, ax, ay, az]) in columns.into_iter().enumerate() {
            for (row, entry) in rows.iter_mut().zip([vx * p, vy * p, vz * p, ax, ay, az]) {
                if let Some(slot) = row.get_mut(place) {
                    *slot = entry;
                }
            }
        }
        let mut parts = [S::ZERO; 6];
        let mut correction = [S::ZERO; N];
        for (place, error) in error.into_iter().enumerate() {
            let (done, rest) = rows.split_at_mut(place);
            let (Some(row), Some(part)) = (rest.first_mut(), parts.get(..place)) else { break };
            let mut left = error;
            for (basis, part) in done.iter().zip(part) {
                let share = dot(row, basis);
                add(row, basis, -share);
                left = left - share * *part;
            }
            let length = dot(row, row).sqrt();
            let inverse = if length > S::from_f64(VANISHING) { S::ONE / length } else { S::ZERO };
            row.iter_mut().for_each(|x| *x = *x * inverse);
            add(&mut correction, row, left * inverse);
            if let Some(slot) = parts.get_mut(place) {
                *slot = left * inverse;
            }
        }
        Local { correction, tangent: self.across(&rows) }
    }

    /// The direction across orthonormal rows: what they leave of the joint that takes the least part in them.
    fn across(&self, rows: &[[S; N]; 6]) -> [S; N] {
        let mut least: Option<(usize, S)> = None;
        for joint in 0..self.dof.min(N) {
            let part = rows.iter().filter_map(|row| row.get(joint)).fold(S::ZERO, |sum, x| sum + *x * *x);
            if least.is_none_or(|(_, least)| part < least) {
                least = Some((joint, part));
            }
        }
        let mut tangent = [S::ZERO; N];
        if let Some(slot) = least.and_then(|(joint, _)| tangent.get_mut(joint)) {
            *slot = S::ONE;
        }
        // Twice, since the first time rounding leaves something of the rows.
        for _ in 0..2 {
            for row in rows {
                let share = dot(&tangent, row);
                add(&mut tangent, row, -share);
            }
            let length = dot(&tangent, &tangent).sqrt();
            tangent.iter_mut().for_each(|x| *x = *x / length);
        }
        tangent
    }

    /// The point of the curve from which the seed is nearest, downhill from some joint values.
    pub(super) fn nearest_point(&self, from: &[S; N]) -> Option<[S; N]> {
        let mut before: Option<([S; N], S)> = None;
        let mut bend = S::ONE;
        self.walk(from, |q, local, longest| {
            let mut offset = *q;
            add(&mut offset, self.seed, -S::ONE);
            if let Some((tangent, moved)) = before {
                if dot(&tangent, &local.tangent) < S::ZERO {
                    local.tangent.iter_mut().for_each(|x| *x = -*x);
                }
                // The second derivative of half the square of the distance, along the curve; what corrections did to
                // the tangent says nothing of it.
                let aside = dot(&local.correction, &local.correction).sqrt();
                if moved.abs() > S::SQRT_EPSILON && aside < moved.abs() * S::from_f64(FLAT) {
                    bend = S::ONE + (dot(&offset, &local.tangent) - dot(&offset, &tangent)) / moved;
                }
            }
            let slope = dot(&offset, &local.tangent);
            let along = if bend > S::from_f64(FLAT) {
                (-slope / bend).max(-longest).min(longest)
            } else if slope > S::ZERO {
                -longest
            } else {
                longest
            };
            before = Some((local.tangent, along));
            (along, slope.abs())
        })
    }

    /// The point of the curve where a sum of joints has a value (rad or m), the nearest along the tangent.
    pub(super) fn crossing(&self, from: &[S; N], sum: impl Fn(&[S; N]) -> S, value: S) -> Option<[S; N]> {
        self.walk(from, |q, local, longest| {
            let missing = value - sum(q) - sum(&local.correction);
            let along = (missing / sum(&local.tangent)).max(-longest).min(longest);
            (along, along.abs())
        })
    }

    /// Moves joint values onto the curve and along it, as far as `along` says, until they are on it and what `along` says
    /// is left to be done there is nothing.
    fn walk(
        &self,
        from: &[S; N],
        mut along: impl FnMut(&[S; N], &mut Local<N, S>, S) -> (S, S),
    ) -> Option<[S; N]> {
        let mut q = *from;
        let most = S::from_f64(LONGEST);
        let (mut longest, mut moved) = (most, S::ZERO);
        for _ in 0..MOVES {
            let mut local = self.local(&q);
            let aside = dot(&local.correction, &local.correction).sqrt();
            // Where the curve bends away from its tangent, shorter moves stay with it.
            let strays = moved > S::ZERO && aside > moved * S::from_f64(STRAYS);
            longest = if strays { longest / S::TWO } else { most.min(longest * S::from_f64(1.5)) };
            let (along, left) = along(&q, &mut local, longest);
            moved = along.abs();
            let shorter = S::ONE.min(S::from_f64(LONGEST) / aside);
            add(&mut q, &local.correction, if aside > S::ZERO { shorter } else { S::ONE });
            add(&mut q, &local.tangent, along);
            let missing = aside + left;
            if !missing.is_finite() {
                return None;
            }
            if missing <= S::SQRT_EPSILON {
                return Some(q);
            }
        }
        None
    }
}

fn dot<const N: usize, S: Float>(a: &[S; N], b: &[S; N]) -> S {
    a.iter().zip(b).fold(S::ZERO, |sum, (a, b)| sum + *a * *b)
}

/// a += factor * b
fn add<const N: usize, S: Float>(a: &mut [S; N], b: &[S; N], factor: S) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * *b);
}

/// The axis of the turn from one orientation to another, as long as the sine of its angle (rad where it is small).
fn turn<S: Float>(from: &Frame<S>, to: &Frame<S>) -> [S; 3] {
    let columns = |frame: &Frame<S>| {
        let [[ax, bx, cx], [ay, by, cy], [az, bz, cz]] = frame.rotation;
        [[ax, ay, az], [bx, by, bz], [cx, cy, cz]]
    };
    let mut sum = [S::ZERO; 3];
    for (own, wanted) in columns(from).into_iter().zip(columns(to)) {
        sum.iter_mut().zip(cross(own, wanted)).for_each(|(sum, part)| *sum += part / S::TWO);
    }
    sum
}
