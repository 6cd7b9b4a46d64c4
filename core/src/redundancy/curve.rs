//! The curve of joint values that keep a pose, point by point: back onto it, along it, towards a seed, to a limit.

use crate::frame::{norm, sub, turn};
use crate::solutions::travel;
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
    /// The Jacobian's rows (reaches and rad) and what joint values are off by in them.
    fn rows(&self, tool: &Frame<S>, columns: &[[S; 6]; N]) -> ([[S; N]; 6], [S; 6]) {
        let p = self.per_reach;
        let [px, py, pz] = sub(self.pose.translation, tool.translation).map(|x| x * p);
        let ([wx, wy, wz], _) = turn(&tool.rotation, &self.pose.rotation);
        let mut rows = [[S::ZERO; N]; 6];
        let [r1, r2, r3, r4, r5, r6] = &mut rows;
        let entries = r1.iter_mut().zip(r2).zip(r3).zip(r4).zip(r5).zip(r6);
        for ((((((e1, e2), e3), e4), e5), e6), [vx, vy, vz, ax, ay, az]) in entries.zip(columns) {
            (*e1, *e2, *e3) = (*vx * p, *vy * p, *vz * p);
            (*e4, *e5, *e6) = (*ax, *ay, *az);
        }
        (rows, [px, py, pz, wx, wy, wz])
    }

    /// The linear equations J dq = e at joint values.
    pub(super) fn local(&self, q: &[S; N]) -> Local<N, S> {
        self.local_of(&(self.state)(q))
    }

    /// The same where tool frame and Jacobian are known.
    pub(super) fn local_of(&self, (tool, columns): &(Frame<S>, [[S; 6]; N])) -> Local<N, S> {
        let (rows, error) = self.rows(tool, columns);
        let factors = Factors::of(rows);
        let mut left = error;
        let mut correction = [S::ZERO; N];
        for (place, (row, inverse)) in factors.rows.iter().zip(factors.inverses).enumerate() {
            let own = left.get(place).copied().unwrap_or(S::ZERO);
            for (left, shares) in left.iter_mut().zip(&factors.triangle).skip(place + 1) {
                *left -= shares.get(place).copied().unwrap_or(S::ZERO) * own;
            }
            add(&mut correction, row, own * inverse);
        }
        Local { correction, tangent: self.across(&factors) }
    }

    /// The direction across all rows: what they leave of the joint that takes the least part in them, which is so much that
    /// nothing is lost.
    fn across(&self, factors: &Factors<N, S>) -> [S; N] {
        let mut parts = [S::ZERO; N];
        for (row, inverse) in factors.rows.iter().zip(factors.inverses) {
            parts.iter_mut().zip(row).for_each(|(part, x)| *part += *x * *x * inverse);
        }
        let mut least = (0, S::INFINITY);
        for (joint, part) in parts.iter().enumerate().take(self.dof) {
            if *part < least.1 {
                least = (joint, *part);
            }
        }
        let mut tangent = [S::ZERO; N];
        if let Some(slot) = tangent.get_mut(least.0) {
            *slot = S::ONE;
        }
        for (row, inverse) in factors.rows.iter().zip(factors.inverses) {
            let share = row.get(least.0).copied().unwrap_or(S::ZERO) * inverse;
            add(&mut tangent, row, -share);
        }
        let inverse = S::ONE / dot(&tangent, &tangent).sqrt();
        tangent.map(|x| x * inverse)
    }

    /// Whether no point of any curve is nearer to the seed than a bottom of one, at this distance.
    ///
    /// With the bottom's offset from the seed Jᵀλ (across its curve), another solution, v away from it, is at a squared
    /// distance of D² + |v|² - 2 λ·r, where r is what the forward kinematics of it has beyond its linear part J v: the
    /// second-order condition of Lagrange multipliers, made one for every v up to 2 D by a bound on r. That is |v|²/2 times
    /// a bound on second derivatives: of the position in joints i <= j, the length of the Jacobian's column j; of the
    /// orientation 1 for each pair of joints. Third derivatives add at most the second ones times twice the sum of angles.
    pub(super) fn is_nearest(
        &self,
        q: &[S; N],
        (tool, columns): &(Frame<S>, [[S; 6]; N]),
        distance: S,
    ) -> bool {
        let (rows, _) = self.rows(tool, columns);
        let Factors { rows, inverses, triangle } = Factors::of(rows);
        let mut offset = *q;
        add(&mut offset, self.seed, -S::ONE);
        // The transposed triangle, from its last row up.
        let mut multipliers = [S::ZERO; 6];
        for place in (0..6).rev() {
            let inverse = inverses.get(place).copied().unwrap_or(S::ZERO);
            let mut own = rows.get(place).map_or(S::ZERO, |row| dot(row, &offset) * inverse);
            for (shares, found) in triangle.iter().zip(&multipliers).skip(place + 1) {
                own -= shares.get(place).map_or(S::ZERO, |share| *share * *found);
            }
            if let Some(slot) = multipliers.get_mut(place) {
                // A row that vanishes bounds nothing.
                *slot = if inverse > S::ZERO { own } else { S::INFINITY };
            }
        }
        let [l1, l2, l3, l4, l5, l6] = multipliers;
        let [at, turned] = [[l1, l2, l3], [l4, l5, l6]].map(norm);
        // From the last joint to the first: the greatest column from there on, and the greatest sum of a row of bounds.
        let (mut longest, mut behind, mut position) = (S::ZERO, S::ZERO, S::ZERO);
        let joints = S::from_f64(self.dof as f64);
        let mut place = joints;
        for [vx, vy, vz, ..] in columns.iter().take(self.dof).rev() {
            longest = longest.max(norm([*vx, *vy, *vz]) * self.per_reach);
            position = position.max(place * longest + behind);
            behind += longest;
            place -= S::ONE;
        }
        let rotation = (joints - S::ONE) / S::TWO;
        let angles = S::TWO * joints.sqrt() * distance;
        (at * position + turned * rotation) * (S::ONE + S::TWO * angles) <= S::ONE
    }

    /// The point of the curve from which the seed is nearest, downhill from joint values of which this is known.
    pub(super) fn nearest_point(&self, from: &[S; N], first: Local<N, S>) -> Option<[S; N]> {
        let mut before: Option<([S; N], S)> = None;
        let mut bend = S::ONE;
        self.walk(from, first, |q, local, longest| {
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

    /// The point of the curve where a sum of joints has a value (rad or m), the nearest along the tangent, if it comes
    /// before the curve is farther from the seed than both `most` and where it starts.
    pub(super) fn crossing(
        &self,
        from: &[S; N],
        sum: impl Fn(&[S; N]) -> S,
        value: S,
        most: S,
    ) -> Option<[S; N]> {
        let most = most.max(travel(from, self.seed).sqrt());
        self.walk(from, self.local(from), |q, local, longest| {
            if travel(q, self.seed).sqrt() > most + longest {
                return (S::NAN, S::NAN);
            }
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
        first: Local<N, S>,
        mut along: impl FnMut(&[S; N], &mut Local<N, S>, S) -> (S, S),
    ) -> Option<[S; N]> {
        let mut q = *from;
        let most = S::from_f64(LONGEST);
        let (mut longest, mut moved) = (most, S::ZERO);
        let mut next = Some(first);
        for _ in 0..MOVES {
            let mut local = next.take().unwrap_or_else(|| self.local(&q));
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

/// Rows as a triangular matrix, whose diagonal is 1, times orthogonal rows, by modified Gram-Schmidt.
struct Factors<const N: usize, S> {
    rows: [[S; N]; 6],
    /// One over the squares of their lengths; 0 where one vanishes.
    inverses: [S; 6],
    /// Below the diagonal.
    triangle: [[S; 6]; 6],
}

impl<const N: usize, S: Float> Factors<N, S> {
    /// Every row is taken out of all that follow at once: products that do not wait for each other.
    #[inline]
    fn of(mut rows: [[S; N]; 6]) -> Self {
        let vanishing = S::from_f64(VANISHING * VANISHING);
        let mut inverses = [S::ZERO; 6];
        let mut triangle = [[S::ZERO; 6]; 6];
        for (place, slot) in inverses.iter_mut().enumerate() {
            let Some((row, rest)) = rows.get_mut(place..).and_then(<[_]>::split_first_mut) else { break };
            let square = dot(row, row);
            let inverse = if square > vanishing { S::ONE / square } else { S::ZERO };
            *slot = inverse;
            for (other, shares) in rest.iter_mut().zip(triangle.iter_mut().skip(place + 1)) {
                let share = dot(other, row) * inverse;
                add(other, row, -share);
                if let Some(slot) = shares.get_mut(place) {
                    *slot = share;
                }
            }
        }
        Self { rows, inverses, triangle }
    }
}

/// In four sums, which do not wait for each other.
fn dot<const N: usize, S: Float>(a: &[S; N], b: &[S; N]) -> S {
    let (a, a_rest) = a.as_chunks::<4>();
    let (b, b_rest) = b.as_chunks::<4>();
    let mut sums = [S::ZERO; 4];
    for ([a1, a2, a3, a4], [b1, b2, b3, b4]) in a.iter().zip(b) {
        let [s1, s2, s3, s4] = sums;
        sums = [s1 + *a1 * *b1, s2 + *a2 * *b2, s3 + *a3 * *b3, s4 + *a4 * *b4];
    }
    for (sum, (a, b)) in sums.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *sum += *a * *b;
    }
    let [s1, s2, s3, s4] = sums;
    (s1 + s3) + (s2 + s4)
}

/// a += factor * b
fn add<const N: usize, S: Float>(a: &mut [S; N], b: &[S; N], factor: S) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * *b);
}
