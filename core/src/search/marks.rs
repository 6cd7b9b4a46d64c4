//! Marks of free joints, held against the arm.

use super::Search;
use super::motions::{Motions, UNKNOWNS};
use crate::self_motion::free_unknown;
use crate::{Float, Frame, IkError, Solutions, Step, Target};

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// [`Search::finish`], with what is known of the arm. Solutions that are off because steps were ill-conditioned are brought
    /// nearer to the target first. A step that had nothing to say may leave its joint to others: a joint stays marked as free only
    /// where the arm can move with the target kept, and is the one that moves.
    ///
    /// `motions` are the steps with what one unit (rad, m) of the unknown of each adds to the joint values, `pose_and_jacobian`
    /// is the tool frame with the columns of the Jacobian. Only where a joint is marked, or a solution is off, is it asked for.
    ///
    /// # Errors
    /// Those of [`Search::finish`].
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call would copy the solutions once more")]
    pub fn finish_marked(
        &mut self,
        motions: &[(Step, [S; N])],
        target: &Target<S>,
        pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) -> Result<Solutions<N, S>, IkError<S>> {
        if self.doubtful || self.inaccurate {
            self.put_right(motions, target, pose_and_jacobian);
        }
        self.finish()
    }

    #[cold]
    #[inline(never)]
    fn put_right(
        &mut self,
        motions: &[(Step, [S; N])],
        target: &Target<S>,
        mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        // Of steps that find all joints at once both have been done, marks where a curve was followed.
        if motions.is_empty() {
            return;
        }
        let motions = Motions { list: motions, target, reach: self.reach };
        if self.inaccurate && !self.polished {
            self.bring_closer(&motions, &mut pose_and_jacobian);
        }
        self.check_marks(&motions, &mut pose_and_jacobian);
    }

    fn check_marks(
        &mut self,
        motions: &Motions<'_, N, S>,
        pose_and_jacobian: &mut impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        let mut asked = [false; UNKNOWNS];
        // An unknown that only the derivation has moves no joint.
        let moves = motions.list.iter().map(|(_, motion)| motion.iter().any(|x| *x != S::ZERO));
        asked.iter_mut().zip(moves).for_each(|(asked, moves)| *asked = moves);
        for solution in self.solutions.as_mut_slice() {
            let Some(row) = solution.free else { continue };
            let marked = motions.list.iter().position(|(step, _)| step.first_row() == row);
            let place = free_unknown(asked, marked, |x: &[S; UNKNOWNS]| {
                let (tool, jacobian) = pose_and_jacobian(&motions.moved(&solution.q, x));
                motions.missing(&tool, &jacobian)
            });
            solution.free = place.and_then(|place| motions.list.get(place)).map(|(step, _)| step.first_row());
        }
    }
}
