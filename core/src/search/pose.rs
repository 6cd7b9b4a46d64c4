//! Candidates of the full pose.

use super::{Search, accurate};
use crate::frame::{norm, sub};
use crate::{Float, Frame, Solution, polish, residual_tolerance, rotation_error};

/// A candidate that misses by more than this (reaches, rad) is a false root.
const HOPELESS: f64 = 1e-3;

/// See [`HOPELESS`].
pub(super) fn hopeless<S: Float>() -> S {
    S::from_f64(HOPELESS).max(residual_tolerance())
}

/// The most steps that are taken: at a double root, where one takes three quarters of the error away, from 1e-7 to 1e-16.
const STEPS: usize = 24;

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// [`Search::accept`] for the full pose: a candidate with its tool frame. One that is off because its steps were
    /// ill-conditioned is brought nearer to the target first ([`polish`]); `pose_and_jacobian` is the tool frame with the
    /// columns of the Jacobian.
    #[inline]
    pub fn accept_pose(
        &mut self,
        q: [S; N],
        tool: &Frame<S>,
        target: &Frame<S>,
        pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        let position_error = norm(sub(tool.translation, target.translation));
        let rotation_error = rotation_error(&target.rotation, &tool.rotation);
        let accurate = accurate(self.free_steps != 0);
        if position_error <= accurate * self.reach && rotation_error <= accurate {
            if self.doubtful {
                self.accept(q, position_error, rotation_error);
                return;
            }
            // Branches that parted clearly at every step end in solutions that differ.
            let mut q = q;
            crate::rules::wrap_all(self.windings, &mut q);
            self.accepted += 1;
            let branch = self.branch();
            self.solutions.append(Solution { q, position_error, rotation_error, free: None, branch });
        } else {
            self.accept_polished(q, target, position_error, rotation_error, pose_and_jacobian);
        }
    }

    #[cold]
    #[inline(never)]
    fn accept_polished(
        &mut self,
        q: [S; N],
        target: &Frame<S>,
        position_error: S,
        rotation_error: S,
        mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        let hopeless = hopeless::<S>();
        if !(position_error <= hopeless * self.reach && rotation_error <= hopeless) {
            self.accept(q, position_error, rotation_error);
            return;
        }
        self.doubtful = true;
        self.polished = true;
        let better = polish(q, target, self.reach, STEPS, |q| self.of_unknowns(pose_and_jacobian(q)));
        self.accept(better.q, better.position_error, better.rotation_error);
    }

    /// A tool frame and the columns of its Jacobian, those of joints that the caller gives set to 0.
    fn of_unknowns(&self, (tool, mut columns): (Frame<S>, [[S; 6]; N])) -> (Frame<S>, [[S; 6]; N]) {
        let given = columns.iter_mut().enumerate().filter(|(joint, _)| self.given & (1 << joint) != 0);
        given.for_each(|(_, column)| *column = [S::ZERO; 6]);
        (tool, columns)
    }
}
