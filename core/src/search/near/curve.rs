//! The curve on which five joints make up for what the sixth does as well as they can: along it the tool hardly moves, and two
//! solutions that nearly meet lie on it.

use super::newton::{self, Place};
use super::seek::Seek;
use super::{Labels, UNKNOWNS};
use crate::polish::{Polished, polish};
use crate::{Float, Frame, Solution};

/// A candidate whose error (reaches, rad) Newton's method doesn't bring below this is none.
const FOUND: f64 = 1e-12;

/// Damped steps at most.
const STEPS: usize = 24;

/// Places along a curve are so far apart (rad, reaches), and so many; the other joints follow by so many steps; farther than
/// this (reaches, rad) from the target the curve is left.
pub(super) const STRIDE: f64 = 0.25;
const FINER: f64 = 0.1;
const WALK: u32 = 28;
const CORRECTIONS: usize = 2;
const AWAY: f64 = 0.05;

/// Where a pivot is this small, solutions may be so near to each other that curves are followed past them.
const CROWDED: f64 = 5e-4;

/// Two solutions may have met where no more than this (reaches, rad) is missing.
const TOUCHES: f64 = 1e-6;

/// The greatest difference of two sets of joint values, whole turns aside.
pub(super) fn apart<const N: usize, S: Float>(a: &[S; N], b: &[S; N], unknowns: &[usize; UNKNOWNS]) -> S {
    let mut away = S::ZERO;
    for joint in unknowns {
        if let (Some(a), Some(b)) = (a.get(*joint), b.get(*joint)) {
            away = away.max((*a - *b).wrap_angle().abs());
        }
    }
    away
}

/// The arm as it is, to be brought to the target.
pub(super) struct Arm<'a, const N: usize, S, F> {
    pub(super) unknowns: &'a [usize; UNKNOWNS],
    pub(super) target: &'a Frame<S>,
    pub(super) reach: S,
    pub(super) labels: &'a Labels<'a, S>,
    pub(super) pose_and_jacobian: F,
}

impl<const N: usize, S: Float, F: FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N])> Arm<'_, N, S, F> {
    /// Brings joint values to the target.
    pub(super) fn bring(&mut self, q: [S; N]) -> Option<Solution<N, S>> {
        let exact = &mut self.pose_and_jacobian;
        if let Some((found, negative)) = newton::solve(q, self.unknowns, self.target, self.reach, exact) {
            return Some(self.labels.solution(&found, negative));
        }
        let met = S::from_f64(FOUND).max(S::from_f64(64.0) * S::EPSILON);
        let found = self.polish(q, STEPS, None);
        if !(found.position_error <= met * self.reach && found.rotation_error <= met) {
            return None;
        }
        let (tool, columns) = (self.pose_and_jacobian)(&found.q);
        let negative = newton::is_negative(self.unknowns, &tool, &columns, self.reach);
        Some(self.labels.solution(&found, negative))
    }

    /// Adds a solution; returns how little the tool moves there with the joints.
    pub(super) fn take(&mut self, found: Solution<N, S>, seek: &mut Seek<N, S>) -> S {
        seek.add(found, self.labels.windings);
        let pivot = self.place(&found.q).map_or(S::ZERO, |at| at.pivot);
        seek.crowded |= pivot < S::from_f64(CROWDED);
        pivot
    }

    fn place(&mut self, q: &[S; N]) -> Option<Place<S>> {
        let (tool, columns) = (self.pose_and_jacobian)(q);
        newton::place(self.unknowns, &tool, &columns, self.target, self.reach)
    }

    /// By damped steps of the unknowns but one.
    fn polish(&mut self, q: [S; N], steps: usize, held: Option<usize>) -> Polished<N, S> {
        let unknowns = self.unknowns;
        let exact = &mut self.pose_and_jacobian;
        polish(q, self.target, self.reach, steps, |q| {
            let (tool, mut columns) = exact(q);
            for (joint, column) in columns.iter_mut().enumerate() {
                if !unknowns.contains(&joint) || Some(joint) == held {
                    *column = [S::ZERO; 6];
                }
            }
            (tool, columns)
        })
    }

    /// Goes along the curve on which five joints make up for what the sixth does as well as they can. What is missing there
    /// has one direction, and is 0 at a solution. Says whether the curve was closed.
    pub(super) fn walk(&mut self, from: [S; N], stride: S, finer: u32, seek: &mut Seek<N, S>) -> bool {
        let Some(mut at) = self.place(&from) else { return false };
        let (mut q, mut before) = (from, None);
        seek.note(from);
        for step in 0..WALK {
            let mut on = q;
            for (joint, part) in self.unknowns.iter().zip(at.idle) {
                if let Some(value) = on.get_mut(*joint) {
                    *value += stride * part;
                }
            }
            let Some(held) = self.unknowns.get(at.leads) else { return false };
            on = self.polish(on, CORRECTIONS, Some(*held)).q;
            let Some(mut next) = self.place(&on) else { return false };
            if dot(&next.idle, &at.idle) < S::ZERO {
                next.idle = next.idle.map(|part| -part);
            }
            let [last, size] = [&at.missing, &next.missing].map(|missing| dot(missing, missing).sqrt());
            if size.is_nan() || size > S::from_f64(AWAY) {
                return false;
            }
            if dot(&at.missing, &next.missing) < S::ZERO {
                let mut between = q;
                let share = last / (last + size);
                between.iter_mut().zip(on).for_each(|(value, on)| *value += share * (on - *value));
                if let Some(hit) = self.bring(between) {
                    self.take(hit, seek);
                    if apart(&hit.q, &between, self.unknowns) < S::from_f64(0.5) * stride.abs() {
                        seek.note(hit.q);
                    }
                }
                before = None;
            } else if let Some((start, longer)) = before
                && last <= longer
                && last < size
                && may_vanish([longer, last, size])
            {
                // Two may be so near to each other that the sign has changed twice.
                if finer > 0 {
                    self.walk(start, stride * S::from_f64(FINER), finer - 1, seek);
                } else if let Some(hit) = self.bring(q) {
                    self.take(hit, seek);
                }
                before = Some((q, last));
            } else {
                before = Some((q, last));
            }
            (q, at) = (on, next);
            if finer > 0 && step > 2 && apart(&q, &from, self.unknowns) < S::from_f64(0.6) * stride.abs() {
                return true;
            }
        }
        false
    }
}

/// Whether the parabola through three values, of which that in the middle is the least, comes near to 0.
fn may_vanish<S: Float>([before, least, after]: [S; 3]) -> bool {
    let (rise, bend) = (after - before, before - least + after - least);
    let vertex = least - rise * rise / (S::from_f64(8.0) * bend);
    vertex <= S::from_f64(0.5) * least || least <= S::from_f64(TOUCHES)
}

fn dot<S: Float>(a: &[S; UNKNOWNS], b: &[S; UNKNOWNS]) -> S {
    a.iter().zip(b).fold(S::ZERO, |sum, (a, b)| sum + *a * *b)
}

#[cfg(test)]
mod tests {
    use super::{apart, may_vanish};

    #[test]
    fn a_parabola_that_comes_near_to_0_may_have_two_roots() {
        assert!(may_vanish([0.3, 0.01, 1.0]), "its vertex is below 0");
        assert!(!may_vanish([1.1, 1.0, 1.1]));
        assert!(may_vanish([1.0, 1e-7, 1.0]), "it touches 0");
    }

    #[test]
    fn whole_turns_are_no_distance() {
        let unknowns = [0, 1, 2, 3, 4, 5];
        let q = [0.1, -0.2, 3.1, 0.0, 1.0, -3.0];
        let turned = q.map(|x| x + core::f64::consts::TAU);
        assert!(apart(&q, &turned, &unknowns) < 1e-12);
        let mut other = turned;
        other[5] -= 0.25;
        assert!((apart(&q, &other, &unknowns) - 0.25_f64).abs() < 1e-12);
    }
}
