//! What is prescribed of a problem, by its unknowns.

use crate::self_motion::FreeUnknown;
use crate::{Float, Frame, Step, Target};

/// The most unknowns of a problem.
pub(super) const UNKNOWNS: usize = 6;

/// The unknowns of a problem that is solved in closed form. They are measured in rad and reaches.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motions<'m, const N: usize, S> {
    /// Their steps, with what one unit (rad, m) of each adds to the joint values.
    pub(super) list: &'m [(Step, [S; N])],
    pub(super) target: &'m Target<S>,
    /// m
    pub(super) reach: S,
}

impl<const N: usize, S: Float> Motions<'_, N, S> {
    /// Joint values (rad, m) at a displacement of the unknowns.
    pub(super) fn moved(&self, q: &[S; N], x: &[S; UNKNOWNS]) -> [S; N] {
        let mut q = *q;
        for ((step, motion), value) in self.list.iter().zip(x) {
            let size = *value * step.unit(self.reach);
            q.iter_mut().zip(motion).for_each(|(sum, own)| *sum += size * *own);
        }
        q
    }

    /// How far the unknowns go (rad, reaches) along a self-motion, if it goes straight on, until the joints are as near as they come to
    /// where there is so much left to go (rad, m), and `aside` of that in half turns (reaches).
    pub(super) fn along(
        &self,
        free: &FreeUnknown<UNKNOWNS, S>,
        left: &[S; N],
        aside: S,
    ) -> Option<[S; UNKNOWNS]> {
        let way = self.moved(&[S::ZERO; N], &free.way);
        let (mut dot, mut square) = (S::ZERO, S::ZERO);
        for (way, left) in way.iter().zip(left) {
            dot += *way * *left;
            square += *way * *way;
        }
        let (step, own) = (self.list.get(free.place)?.0, *free.way.get(free.place)?);
        let times = dot / square + aside * step.half_range(self.reach) / (step.unit(self.reach) * own);
        times.is_finite().then(|| free.way.map(|part| part * times))
    }

    /// What a tool frame misses of the target (reaches, rad), and how much less of it with each unknown, from the columns of
    /// the Jacobian.
    pub(super) fn missing(&self, tool: &Frame<S>, jacobian: &[[S; 6]; N]) -> ([S; 6], [[S; 6]; UNKNOWNS]) {
        let per_reach = S::ONE / self.reach;
        let mut columns = [[S::ZERO; 6]; UNKNOWNS];
        for (column, (step, motion)) in columns.iter_mut().zip(self.list) {
            let mut twist = [S::ZERO; 6];
            for (own, factor) in jacobian.iter().zip(motion) {
                let factor = *factor * step.unit(self.reach);
                twist.iter_mut().zip(own).for_each(|(sum, own)| *sum += factor * *own);
            }
            *column = self.target.gained(tool, &twist, per_reach);
        }
        (self.target.missing(tool, per_reach), columns)
    }
}
