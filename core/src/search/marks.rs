//! Marks of free joints, held against the arm.

use super::Search;
use crate::self_motion::free_unknown;
use crate::{Float, Frame, IkError, Solutions, Step, Target};

/// The most steps that are looked at.
const UNKNOWNS: usize = 6;

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// [`Search::finish`]. A step that had nothing to say may leave its joint to others: a joint stays marked as free only where
    /// the arm can move with the target kept, and is the one that moves.
    ///
    /// `motions` are the steps with what one unit (rad, m) of the unknown of each adds to the joint values, `pose_and_jacobian`
    /// is the tool frame with the columns of the Jacobian. Only where a joint is marked is it asked for.
    ///
    /// # Errors
    /// Those of [`Search::finish`].
    #[inline]
    pub fn finish_marked(
        &mut self,
        motions: &[(Step, [S; N])],
        target: &Target<S>,
        pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) -> Result<Solutions<N, S>, IkError<S>> {
        // Of steps that find all joints at once marks are made where a curve was followed.
        if self.doubtful && !motions.is_empty() {
            self.check_marks(motions, target, pose_and_jacobian);
        }
        self.finish()
    }

    #[cold]
    #[inline(never)]
    fn check_marks(
        &mut self,
        motions: &[(Step, [S; N])],
        target: &Target<S>,
        mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        let per_reach = S::ONE / self.reach;
        let mut asked = [false; UNKNOWNS];
        // An unknown that only the derivation has moves no joint.
        let moves = motions.iter().map(|(_, motion)| motion.iter().any(|x| *x != S::ZERO));
        asked.iter_mut().zip(moves).for_each(|(asked, moves)| *asked = moves);
        for solution in self.solutions.as_mut_slice() {
            let Some(row) = solution.free else { continue };
            let marked = motions.iter().position(|(step, _)| step.first_row() == row);
            let place = free_unknown(asked, marked, |x: &[S; UNKNOWNS]| {
                let mut q = solution.q;
                for ((step, motion), value) in motions.iter().zip(x) {
                    let size = *value * step.unit(self.reach);
                    q.iter_mut().zip(motion).for_each(|(sum, own)| *sum += size * *own);
                }
                let (tool, jacobian) = pose_and_jacobian(&q);
                let mut columns = [[S::ZERO; 6]; UNKNOWNS];
                for (column, (step, motion)) in columns.iter_mut().zip(motions) {
                    let mut twist = [S::ZERO; 6];
                    for (own, factor) in jacobian.iter().zip(motion) {
                        let factor = *factor * step.unit(self.reach);
                        twist.iter_mut().zip(own).for_each(|(sum, own)| *sum += factor * *own);
                    }
                    *column = target.gained(&tool, &twist, per_reach);
                }
                (target.missing(&tool, per_reach), columns)
            });
            solution.free = place.and_then(|place| motions.get(place)).map(|(step, _)| step.first_row());
        }
    }
}
