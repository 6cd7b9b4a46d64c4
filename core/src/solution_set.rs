//! Solutions of a robot whose number of joints is known only at run time.

use crate::solutions::{Solution, Solutions, travel};
use crate::{Branch, Float, IkError, LengthError, MAX_JOINTS, Rules};

/// What [`Kinematics::ik_into`](crate::Kinematics::ik_into) fills: solutions with [`SolutionSet::dof`] joint values
/// each. Starts empty, and can be used again and again.
#[derive(Debug, Clone)]
pub struct SolutionSet<S = f64> {
    dof: usize,
    solutions: Solutions<MAX_JOINTS, S>,
}

/// One solution of a [`SolutionSet`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolutionView<'a, S = f64> {
    /// Joint values (rad or m).
    pub q: &'a [S],
    /// m
    pub position_error: S,
    /// rad
    pub rotation_error: S,
    /// Where the target leaves a joint free, that joint's row in the table (0-based).
    pub free: Option<usize>,
    /// Which of the target's solutions it is.
    pub branch: Branch,
}

impl<S: Float> SolutionView<'_, S> {
    /// The greater of the two errors, metres and radians side by side.
    pub fn residual(&self) -> S {
        self.position_error.max(self.rotation_error)
    }
}

impl<S: Float> SolutionSet<S> {
    /// An empty set.
    pub const fn new() -> Self {
        Self { dof: 0, solutions: Solutions::EMPTY }
    }

    /// The solutions of a robot with `N` joints (at most [`MAX_JOINTS`]).
    pub fn from_solutions<const N: usize>(solutions: &Solutions<N, S>) -> Self {
        let mut set = Self::new();
        set.fill(N, solutions);
        set
    }

    /// Replaces what is in the set by solutions of which the first `dof` (at most [`MAX_JOINTS`]) joint values count.
    pub fn fill<const N: usize>(&mut self, dof: usize, solutions: &Solutions<N, S>) {
        self.dof = dof.min(N).min(MAX_JOINTS);
        self.solutions = Solutions::EMPTY;
        for solution in solutions {
            let mut q = [S::ZERO; MAX_JOINTS];
            for (to, from) in q.iter_mut().zip(&solution.q).take(self.dof) {
                *to = *from;
            }
            let Solution { position_error, rotation_error, free, branch, .. } = *solution;
            self.solutions.append(Solution { q, position_error, rotation_error, free, branch });
        }
    }

    /// Empties the set.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// How many joint values each solution has.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// How many solutions there are.
    pub fn len(&self) -> usize {
        self.solutions.len()
    }

    /// How many solutions found no room.
    pub fn dropped(&self) -> usize {
        self.solutions.dropped()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.solutions.is_empty()
    }

    /// The solutions with their joint values padded by 0.
    pub(crate) fn into_padded(self) -> Solutions<MAX_JOINTS, S> {
        self.solutions
    }

    /// Replaces what is in it by padded solutions.
    pub(crate) fn fill_padded(&mut self, dof: usize, solutions: Solutions<MAX_JOINTS, S>) {
        *self = Self { dof, solutions };
    }

    /// The solution at this place.
    pub fn get(&self, index: usize) -> Option<SolutionView<'_, S>> {
        self.iter().nth(index)
    }

    /// The solutions.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = SolutionView<'_, S>> {
        let dof = self.dof;
        self.solutions.iter().map(move |solution| SolutionView {
            q: solution.q.get(..dof).unwrap_or(&solution.q),
            position_error: solution.position_error,
            rotation_error: solution.rotation_error,
            free: solution.free,
            branch: solution.branch,
        })
    }

    /// The solutions on a branch, see [`Solutions::on_branch`].
    pub fn on_branch(&self, branch: Branch) -> impl Iterator<Item = SolutionView<'_, S>> {
        self.iter().filter(move |solution| solution.branch == branch)
    }

    /// The solution with the least joint travel from `q`, see [`Solutions::nearest`].
    pub fn nearest(&self, q: &[S]) -> Option<SolutionView<'_, S>> {
        let mut best: Option<(SolutionView<'_, S>, S)> = None;
        for solution in self.iter() {
            let distance = travel(solution.q, q);
            if best.is_none_or(|(_, least)| distance < least) {
                best = Some((solution, distance));
            }
        }
        best.map(|(solution, _)| solution)
    }

    /// Keeps what limits and rules allow, see [`Solutions::within`]. The set is empty after an error.
    ///
    /// # Errors
    /// As [`Solutions::within`]; [`IkError::Length`] where the seed has another length than the solutions.
    pub fn within(
        &mut self,
        rules: &Rules<'_, S>,
        position_of: impl Fn(&[S]) -> [S; 3],
        seed: Option<&[S]>,
    ) -> Result<(), IkError<S>> {
        let dof = self.dof;
        let solutions = core::mem::replace(&mut self.solutions, Solutions::EMPTY);
        let seed = match seed {
            Some(seed) => {
                LengthError::check(dof, seed.len())?;
                let mut padded = [S::ZERO; MAX_JOINTS];
                for (to, from) in padded.iter_mut().zip(seed) {
                    *to = *from;
                }
                Some(padded)
            }
            None => None,
        };
        let position_of = |q: &[S; MAX_JOINTS]| position_of(q.get(..dof).unwrap_or(q));
        self.solutions = solutions.within(rules, position_of, seed.as_ref())?;
        Ok(())
    }

    /// Measures the errors of every solution anew: `errors_of` gives position (m) and rotation error (rad).
    pub(crate) fn measure(&mut self, errors_of: impl Fn(&[S]) -> (S, S)) {
        let dof = self.dof;
        for solution in self.solutions.as_mut_slice() {
            let errors = errors_of(solution.q.get(..dof).unwrap_or(&solution.q));
            (solution.position_error, solution.rotation_error) = errors;
        }
    }
}

impl<S: Float> Default for SolutionSet<S> {
    fn default() -> Self {
        Self::new()
    }
}
