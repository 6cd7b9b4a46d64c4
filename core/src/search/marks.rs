//! Marks of free joints, held against the arm.

use super::motions::{Motions, UNKNOWNS};
use super::{Movable, Search, accurate};
use crate::rules::wrap_all;
use crate::self_motion::{FreeUnknown, beside, free_unknown, goes_far};
use crate::solutions::{same, travel};
use crate::{Float, Frame, IkError, Solution, Solutions, Step, Target, Winding};

/// In so many steps a point of a self-motion is reached that goes straight on but for rounding.
const APPROACHES: usize = 3;

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// [`Search::finish`], with what is known of the arm. Solutions that are off because steps were ill-conditioned are brought
    /// nearer to the target first. A step that had nothing to say may leave its joint to others, and one that is not
    /// well-conditioned says something where it should say nothing: a joint is marked as free where the arm can move with the
    /// target kept, and is the one that moves.
    ///
    /// `motions` are the steps with what one unit (rad, m) of the unknown of each adds to the joint values, `pose_and_jacobian`
    /// is the tool frame with the columns of the Jacobian. Only where a joint is marked, or nearly so, or a solution is off, is it
    /// asked for.
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
        let seed = self.wanted.map(|(_, seed)| seed);
        for mut solution in self.solutions.take() {
            if solution.free.is_none() && self.vague_steps == 0 {
                self.solutions.push(solution, self.windings);
                continue;
            }
            let marked = motions.list.iter().position(|(step, _)| Some(step.first_row()) == solution.free);
            let q = solution.q;
            let mut at = |x: &[S; UNKNOWNS]| {
                let (tool, jacobian) = pose_and_jacobian(&motions.moved(&q, x));
                motions.missing(&tool, &jacobian)
            };
            // As well as a solution with a mark meets its target; of others it is asked more strictly.
            let exact = if marked.is_some() { accurate(true) } else { rounding() };
            let free = free_unknown(asked, marked, exact, &mut at);
            let free = free.filter(|free| marked.is_some() || goes_far(free.way, exact, &mut at));
            let step = free.and_then(|free| motions.list.get(free.place));
            solution.free = step.map(|(step, _)| step.first_row());
            if let Some(free) = free {
                let mut motion = SelfMotion { motions, windings: self.windings, q, free, at };
                // Of a curve there is one point.
                let known = |known: &Solution<N, S>| known.free.is_some() && motion.comes_by(&known.q);
                if let Some(known) = self.solutions.iter().position(known) {
                    let off = |q: &[S; N]| {
                        seed.map_or(S::ZERO, |seed| travel(&left(self.windings, seed.q, q), &[S::ZERO; N]))
                    };
                    let farther = |known: &&mut Solution<N, S>| off(&q) < off(&known.q);
                    if let Some(known) = self.solutions.as_mut_slice().get_mut(known).filter(farther) {
                        *known = solution;
                    }
                    continue;
                }
                // Steps that were not well-conditioned have set a joint that is free.
                let wanted = seed.filter(|_| marked.is_none() && self.movable == Movable::Yes);
                if let Some(there) = wanted.and_then(|seed| motion.towards(seed.q, seed.aside, exact)) {
                    solution.q = there;
                    let (tool, _) = pose_and_jacobian(&there);
                    (solution.position_error, solution.rotation_error) = motions.target.errors(&tool);
                }
            }
            self.solutions.push(solution, self.windings);
        }
    }
}

/// A self-motion through a solution, with what is missing about that.
struct SelfMotion<'m, const N: usize, S, A> {
    motions: &'m Motions<'m, N, S>,
    windings: &'m [Winding<'m, S>],
    q: [S; N],
    free: FreeUnknown<UNKNOWNS, S>,
    at: A,
}

impl<const N: usize, S: Float, A: FnMut(&[S; UNKNOWNS]) -> ([S; 6], [[S; 6]; UNKNOWNS])>
    SelfMotion<'_, N, S, A>
{
    /// Its point that is nearest to joint values, or so much aside from there (half turns, reaches), if it goes straight on.
    fn towards(&mut self, wanted: &[S], aside: S, exact: S) -> Option<[S; N]> {
        let (mut x, mut there) = ([S::ZERO; UNKNOWNS], self.q);
        for _ in 0..if aside == S::ZERO { APPROACHES } else { 1 } {
            let along = self.motions.along(&self.free, &left(self.windings, wanted, &there), aside)?;
            x.iter_mut().zip(along).for_each(|(x, along)| *x += along);
            x = beside(x, exact, &mut self.at)?;
            there = self.motions.moved(&self.q, &x);
        }
        wrap_all(self.windings, &mut there);
        Some(there)
    }

    /// Whether another solution is a point of it.
    fn comes_by(&mut self, known: &[S; N]) -> bool {
        let exact = rounding();
        let way = self.motions.along(&self.free, &left(self.windings, known, &self.q), S::ZERO);
        let halfway = way.map(|way| way.map(|part| part / S::TWO));
        halfway.is_some_and(|halfway| beside(halfway, exact, &mut self.at).is_some())
            && self.towards(known, S::ZERO, exact).is_some_and(|there| same(&there, known, self.windings))
    }
}

/// What rounding leaves (reaches, rad) of a target that is met: 1.4e-14 in f64.
fn rounding<S: Float>() -> S {
    S::from_f64(64.0) * S::EPSILON
}

/// How far it is from joint values to others, whole turns aside.
fn left<const N: usize, S: Float>(windings: &[Winding<'_, S>], wanted: &[S], q: &[S; N]) -> [S; N] {
    let mut left = [S::ZERO; N];
    left.iter_mut().zip(wanted).zip(q).for_each(|((left, wanted), here)| *left = *wanted - *here);
    wrap_all(windings, &mut left);
    left
}
