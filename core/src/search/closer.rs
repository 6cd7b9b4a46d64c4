//! Solutions of problems other than the full pose brought nearer to what their target prescribes.

use super::motions::{Motions, UNKNOWNS};
use super::{Search, accurate};
use crate::polish::descend;
use crate::rules::wrap_all;
use crate::{Float, Frame, Solution};

/// The most steps that are taken, as of the full pose.
const STEPS: usize = 24;

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// Takes away what ill-conditioned steps have left of the errors of solutions, see [`polish`](crate::polish). It is the
    /// unknowns that are moved, so that joints that are given, and what is prescribed between joints, stay.
    #[cold]
    #[inline(never)]
    pub(super) fn bring_closer(
        &mut self,
        motions: &Motions<'_, N, S>,
        pose_and_jacobian: &mut impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        let found = self.solutions.take();
        for solution in found {
            let most = accurate(solution.free.is_some());
            if solution.position_error <= most * self.reach && solution.rotation_error <= most {
                self.solutions.push(solution, self.windings);
                continue;
            }
            let (x, tool) = descend([S::ZERO; UNKNOWNS], STEPS, S::ZERO, |x| {
                let (tool, jacobian) = pose_and_jacobian(&motions.moved(&solution.q, x));
                let (missing, columns) = motions.missing(&tool, &jacobian);
                (tool, missing, columns)
            });
            let mut q = motions.moved(&solution.q, &x);
            wrap_all(self.windings, &mut q);
            let (position_error, rotation_error) = motions.target.errors(&tool);
            self.solutions.push(Solution { q, position_error, rotation_error, ..solution }, self.windings);
        }
        self.polished = true;
    }
}
