//! How far joint values are from each other, and paths that keep that small.

use core::error::Error;
use core::fmt;

use crate::{Float, IkError, LengthError, Solution, SolutionSet, SolutionView, Solutions};

/// How the travels of the joints make one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Norm {
    /// The root of the sum of their squares.
    #[default]
    Squares,
    /// The greatest of them.
    Greatest,
}

/// A measure of joint travel: each joint's way (rad or m) times its weight, put together by a norm.
///
/// ```
/// use dh_core::{Norm, Travel};
/// let travel = Travel { weights: &[1.0, 2.0], norm: Norm::Greatest };
/// assert_eq!(travel.between(&[0.0, 0.0], &[1.5, -1.0]), 2.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Travel<'a, S = f64> {
    /// One a joint (1/rad or 1/m, or any other unit of cost); joints beyond its end have the weight 1.
    pub weights: &'a [S],
    /// How they are put together.
    pub norm: Norm,
}

impl<S: Float> Travel<'_, S> {
    /// The travel from one set of joint values to another, as they are: no whole turns are taken away.
    pub fn between(&self, from: &[S], to: &[S]) -> S {
        let weights = self.weights.iter().copied().chain(core::iter::repeat(S::ONE));
        let ways = from.iter().zip(to).zip(weights).map(|((from, to), weight)| weight * (*to - *from));
        match self.norm {
            Norm::Squares => ways.fold(S::ZERO, |sum, way| sum + way * way).sqrt(),
            Norm::Greatest => ways.fold(S::ZERO, |most, way| most.max(way.abs())),
        }
    }
}

impl<const N: usize, S: Float> Solutions<N, S> {
    /// The solution with the least travel from `q` (rad or m), of equal ones the first.
    pub fn nearest_by(&self, q: &[S; N], travel: &Travel<'_, S>) -> &Solution<N, S> {
        let mut best = (self.nearest(q), S::INFINITY);
        for solution in self {
            let way = travel.between(q, &solution.q);
            if way < best.1 {
                best = (solution, way);
            }
        }
        best.0
    }
}

impl<S: Float> SolutionSet<S> {
    /// The solution with the least travel from `q` (rad or m), of equal ones the first.
    pub fn nearest_by(&self, q: &[S], travel: &Travel<'_, S>) -> Option<SolutionView<'_, S>> {
        let mut best: Option<(SolutionView<'_, S>, S)> = None;
        for solution in self.iter() {
            let way = travel.between(q, solution.q);
            if best.is_none_or(|(_, least)| way < least) {
                best = Some((solution, way));
            }
        }
        best.map(|(solution, _)| solution)
    }
}

/// Where a path of targets cannot be followed any further; what was followed before stands.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TrackError<S = f64> {
    /// A target has no solution that is allowed.
    NoSolution {
        /// Which target, from 0.
        at: usize,
        /// Why.
        error: IkError<S>,
    },
    /// The allowed solution nearest to the last one is farther than a path that goes on is: the arm would have to jump to
    /// another branch, or turn a joint back by whole turns.
    Jump {
        /// Which target, from 0.
        at: usize,
        /// The joint that goes farthest (index of q).
        joint: usize,
        /// How far it would go (rad or m, signed).
        by: S,
    },
    /// There is not as much room as there are targets.
    Length(LengthError),
}

impl<S: Float> fmt::Display for TrackError<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSolution { at, error } => write!(f, "target {}: {error}", at + 1),
            Self::Jump { at, joint, by } => {
                write!(f, "target {}: joint {} would jump by {by:.6} (rad or m)", at + 1, joint + 1)
            }
            Self::Length(error) => error.fmt(f),
        }
    }
}

impl<S: Float> Error for TrackError<S> {}

/// Follows a path of targets from joint values: for each the allowed solution nearest to that before, which `nearest`
/// gives. As long as the path is sampled finely, that is the branch that it is on.
///
/// No joint may go farther than `longest` (rad or m) from one target to the next; where one must, the path ends.
///
/// # Errors
/// [`TrackError`] says at which target and why; `out` holds the joint values of those before it.
pub fn track<T, const N: usize, S: Float>(
    targets: &[T],
    start: &[S; N],
    longest: S,
    out: &mut [[S; N]],
    mut nearest: impl FnMut(&T, &[S; N]) -> Result<Solution<N, S>, IkError<S>>,
) -> Result<(), TrackError<S>> {
    if out.len() < targets.len() {
        return Err(TrackError::Length(LengthError { expected: targets.len(), got: out.len() }));
    }
    let mut last = *start;
    for (at, (target, slot)) in targets.iter().zip(out).enumerate() {
        let next = nearest(target, &last).map_err(|error| TrackError::NoSolution { at, error })?.q;
        let mut farthest = (0, S::ZERO);
        for (joint, (from, to)) in last.iter().zip(&next).enumerate() {
            let way = *to - *from;
            if way.abs() > farthest.1.abs() {
                farthest = (joint, way);
            }
        }
        let (joint, by) = farthest;
        if by.abs() > longest {
            return Err(TrackError::Jump { at, joint, by });
        }
        *slot = next;
        last = next;
    }
    Ok(())
}
