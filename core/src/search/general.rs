//! Chains without a closed form: all joints at once.

use super::Search;
use crate::general::{GeneralArm, JOINTS, same};
use crate::{Float, Frame, IkError, Step, Target};

/// How many candidates are kept: the sixteen solutions that six joints can have, and what double roots add.
const MAX_CANDIDATES: usize = 64;

/// Two candidates that are nearer than this (rad; m, in an arm of 1 m) are one.
const SAME: f64 = 1e-6;

/// Values of six joints each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidates<S = f64> {
    list: [[S; JOINTS]; MAX_CANDIDATES],
    len: usize,
}

impl<S: Float> Candidates<S> {
    /// As a slice.
    pub fn as_slice(&self) -> &[[S; JOINTS]] {
        self.list.get(..self.len).unwrap_or(&self.list)
    }
}

impl<S: Float> IntoIterator for Candidates<S> {
    type Item = [S; JOINTS];
    type IntoIter = core::iter::Take<core::array::IntoIter<[S; JOINTS], MAX_CANDIDATES>>;
    fn into_iter(self) -> Self::IntoIter {
        self.list.into_iter().take(self.len)
    }
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The values (rad, m) of the six joints of a chain that are not given, for a target that prescribes its tip wholly
    /// or with the help of joints at the tip that only the chain has. Computed in f64.
    pub fn general(
        &mut self,
        step: Step,
        arm: &GeneralArm<'_>,
        target: &Target<S>,
        given: &[S],
    ) -> Candidates<S> {
        let _ = self.begin(step);
        let mut candidates = Candidates { list: [[S::ZERO; JOINTS]; MAX_CANDIDATES], len: 0 };
        let mut values = [0.0; crate::MAX_JOINTS];
        for (value, given) in values.iter_mut().zip(given) {
            *value = given.to_f64();
        }
        let (Some(pose), Some(six)) = (target.frame(), arm.six(&values)) else {
            return candidates;
        };
        let pose = Frame {
            rotation: pose.rotation.map(|row| row.map(Float::to_f64)),
            translation: pose.translation.map(Float::to_f64),
        };
        // Angles are compared in rad, slides in m.
        let scale = if arm.reach < 1.0 { arm.reach } else { 1.0 };
        let mut list = [[0.0; JOINTS]; MAX_CANDIDATES];
        let mut len = 0;
        let outcome = six.solve(&pose, |solution| {
            let known = list.iter().take(len).any(|other| same(other, solution, six.prismatic, SAME * scale));
            if let Some(place) = list.get_mut(len).filter(|_| !known) {
                *place = *solution;
                len += 1;
            }
        });
        for (place, q) in candidates.list.iter_mut().zip(list).take(len) {
            *place = q.map(S::from_f64);
        }
        candidates.len = len;
        if len == 0 {
            let excess = S::from_f64(outcome.miss);
            self.fail_step(step, excess, IkError::Unreachable { step, excess });
        }
        candidates
    }
}
