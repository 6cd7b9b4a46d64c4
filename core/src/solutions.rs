//! What an inverse problem has for an answer: at most sixteen sets of joint values, on the stack.

use core::ops::Deref;

use crate::rules::wrap_all;
use crate::search::indifferent;
use crate::windings::{Unlimited, Windings};
use crate::{Branch, Float, MAX_SOLUTIONS, Rules, Winding};

/// One solution of an inverse problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution<const N: usize, S = f64> {
    /// Joint values (rad or m).
    pub q: [S; N],
    /// How far `fk(q)` is from the target in position (m), in what the target prescribes of it; of a nearly special arm, how far
    /// at most.
    pub position_error: S,
    /// The same in orientation (rad).
    pub rotation_error: S,
    /// Where the target leaves a joint free, that joint's row in the table (0-based); `q` holds one of its values then.
    pub free: Option<usize>,
    /// Which of the target's solutions it is.
    pub branch: Branch,
}

impl<const N: usize, S: Float> Solution<N, S> {
    /// The greater of the two errors, metres and radians side by side.
    pub fn residual(&self) -> S {
        self.position_error.max(self.rotation_error)
    }

    /// The same solution with whole turns added, lazily: every set of joint values inside the joint limits and the
    /// limits on sums. A joint without limits is left where it is.
    pub fn windings<'a>(&self, rules: &Rules<'a, S>) -> Windings<'a, N, S> {
        Windings::new(self.q, *rules, Unlimited::Stay)
    }
}

/// Solutions of an inverse problem: at least one, at most [`MAX_SOLUTIONS`]. A slice of [`Solution`] in all other
/// respects.
#[derive(Debug, Clone)]
pub struct Solutions<const N: usize, S = f64> {
    items: [Solution<N, S>; MAX_SOLUTIONS],
    len: usize,
    dropped: usize,
}

/// Two solutions are one if no joint differs by more than this many times the square root of the machine epsilon
/// (rad or m; modulo whole turns): 2e-7 in f64, 6e-3 in f32. A rounding error of one epsilon drives a double root that
/// far apart, within a small factor.
const DUPLICATE: f64 = 16.0;

/// What is left of the error (reaches, rad) of a polished solution, at most, in machine epsilons: 4e-12 in f64. A branch that
/// ends short of its target, at an edge of the workspace, is off by more than that, or there is nothing to tell them apart.
const EXACT: f64 = 16_384.0;

impl<const N: usize, S: Float> Solutions<N, S> {
    /// None. As a constant it is one copy of memory; an array that is filled costs more than a step of a solution.
    pub(crate) const EMPTY: Self = {
        let nothing = Solution {
            q: [S::ZERO; N],
            position_error: S::ZERO,
            rotation_error: S::ZERO,
            free: None,
            branch: Branch::PLUS,
        };
        Self { items: [nothing; MAX_SOLUTIONS], len: 0, dropped: 0 }
    };

    /// The same set in one copy of memory, which a clone is not.
    pub(crate) fn copied(&self) -> Self {
        Self { items: self.items, len: self.len, dropped: self.dropped }
    }

    /// All of them, to be put back in changed; how many were dropped stays known.
    pub(crate) fn take(&mut self) -> Self {
        let dropped = self.dropped;
        core::mem::replace(self, Self { dropped, ..Self::EMPTY })
    }

    /// A set of one solution.
    pub fn one(solution: Solution<N, S>) -> Self {
        let mut solutions = Self::EMPTY;
        solutions.append(solution);
        solutions
    }

    /// Adds a solution, unless it is there already, whole turns aside; of the two the one with the smaller residual
    /// stays. Where the set is full the solution is counted in [`Solutions::dropped`] instead.
    pub fn push(&mut self, solution: Solution<N, S>, windings: &[Winding<'_, S>]) {
        let twin = |known: &Solution<N, S>| {
            !differ(&known.q, &solution.q, windings) && same(&known.q, &solution.q, windings)
        };
        let Some(first) = self.iter().position(&twin) else { return self.append(solution) };
        let twins = || self.iter().skip(first).filter(|known| twin(known));
        if twins().any(|known| known.residual() <= solution.residual()) {
            return;
        }
        // Between two that are not the same there may be one that is the same as either.
        let more = twins().nth(1).is_some();
        if let Some(known) = self.items.get_mut(first) {
            *known = solution;
        }
        if more {
            let mut place = 0;
            self.retain(|known| {
                place += 1;
                place <= first + 1 || !twin(known)
            });
        }
    }

    /// Adds a solution if it is another than those that are there, whole turns aside; says whether it is.
    pub(crate) fn append_new(&mut self, solution: Solution<N, S>, windings: &[Winding<'_, S>]) -> bool {
        let new = !self
            .iter()
            .any(|known| !differ(&known.q, &solution.q, windings) && same(&known.q, &solution.q, windings));
        if new {
            self.append(solution);
        }
        new
    }

    /// Whether these joint values are there, whole turns aside.
    pub(crate) fn contains(&self, q: &[S; N], windings: &[Winding<'_, S>]) -> bool {
        self.iter().any(|known| same(&known.q, q, windings))
    }

    pub(crate) fn append(&mut self, solution: Solution<N, S>) {
        if let Some(slot) = self.items.get_mut(self.len) {
            *slot = solution;
            self.len += 1;
        } else {
            self.dropped += 1;
        }
    }

    /// Adds a solution to those that are sorted by their joint travel from `q`. Where the set is full, the farthest is
    /// counted in [`Solutions::dropped`] instead.
    pub(crate) fn insert_by_distance(&mut self, solution: Solution<N, S>, q: &[S; N]) {
        let own = travel(&solution.q, q);
        let place = self.iter().position(|other| own < travel(&other.q, q)).unwrap_or(self.len);
        if self.len == MAX_SOLUTIONS {
            self.dropped += 1;
        } else {
            self.len += 1;
        }
        let mut moved = solution;
        for slot in self.as_mut_slice().iter_mut().skip(place) {
            core::mem::swap(slot, &mut moved);
        }
    }

    /// Leaves only solutions that meet their target to this, where there are any.
    pub(crate) fn drop_misses(&mut self, reach: S) {
        let exact = S::from_f64(EXACT) * S::EPSILON;
        let meets = |solution: &Solution<N, S>| {
            let most = if solution.free.is_none() { exact } else { exact.max(indifferent()) };
            solution.position_error <= most * reach && solution.rotation_error <= most
        };
        if !self.as_slice().iter().any(meets) {
            return;
        }
        self.retain(meets);
    }

    /// Leaves only solutions that are not at these places, from one to before another.
    pub(crate) fn drop_places(&mut self, from: usize, to: usize) {
        let mut place = 0;
        self.retain(|_| {
            place += 1;
            !(from < place && place <= to)
        });
    }

    fn retain(&mut self, mut keeps: impl FnMut(&Solution<N, S>) -> bool) {
        let all = self.items;
        let len = core::mem::take(&mut self.len);
        for solution in all.iter().take(len).filter(|solution| keeps(solution)) {
            self.append(*solution);
        }
    }

    /// How many solutions found no room.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// The solutions.
    pub fn as_slice(&self) -> &[Solution<N, S>] {
        self.items.get(..self.len).unwrap_or(&[])
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [Solution<N, S>] {
        self.items.get_mut(..self.len).unwrap_or(&mut [])
    }

    /// The solution with the least joint travel from `q`: the least root of the sum of squares (rad and m side by
    /// side), of the values as they are. Of equal ones the first.
    pub fn nearest(&self, q: &[S; N]) -> &Solution<N, S> {
        let [first, others @ ..] = &self.items;
        let mut best = (first, travel(&first.q, q));
        for solution in others.iter().take(self.len.saturating_sub(1)) {
            let distance = travel(&solution.q, q);
            if distance < best.1 {
                best = (solution, distance);
            }
        }
        best.0
    }

    /// The solutions on a branch: one at most where the arm is solved in closed form, unless a joint is free or a step has four
    /// roots, of which two have the same sign; without a closed form all that have the determinant's sign.
    pub fn on_branch(&self, branch: Branch) -> impl Iterator<Item = &Solution<N, S>> {
        self.iter().filter(move |solution| solution.branch == branch)
    }

    /// Puts the solution with the least joint travel from `q` first, and so on.
    pub fn sort_by_distance(&mut self, q: &[S; N]) {
        let mut rest = self.as_mut_slice();
        while let [first, others @ ..] = rest {
            for other in others.iter_mut() {
                if travel(&other.q, q) < travel(&first.q, q) {
                    core::mem::swap(first, other);
                }
            }
            rest = others;
        }
    }
}

/// The square of the joint travel from `a` to `b`.
pub(crate) fn travel<S: Float>(a: &[S], b: &[S]) -> S {
    a.iter().zip(b).fold(S::ZERO, |sum, (a, b)| sum + (*a - *b) * (*a - *b))
}

/// Whether a joint differs that no other joint's whole turns move, by more than rounding and less than a turn of its own.
#[inline]
fn differ<const N: usize, S: Float>(a: &[S; N], b: &[S; N], windings: &[Winding<'_, S>]) -> bool {
    windings.iter().any(|winding| {
        let (a, b) = (a.get(winding.joint), b.get(winding.joint));
        let apart = a.zip(b).map_or(S::ZERO, |(a, b)| (*a - *b).abs());
        let most = S::from_f64(DUPLICATE) * S::SQRT_EPSILON;
        apart > most && apart < winding.turn - most
    }) && windings.iter().all(|winding| winding.carries.is_empty())
}

/// Whether two sets of joint values are the same but for whole turns.
pub(crate) fn same<const N: usize, S: Float>(a: &[S; N], b: &[S; N], windings: &[Winding<'_, S>]) -> bool {
    let mut difference = *a;
    for (x, y) in difference.iter_mut().zip(b) {
        *x -= *y;
    }
    wrap_all(windings, &mut difference);
    difference.iter().all(|x| x.abs() <= S::from_f64(DUPLICATE) * S::SQRT_EPSILON)
}

impl<const N: usize, S: Float> Deref for Solutions<N, S> {
    type Target = [Solution<N, S>];
    fn deref(&self) -> &Self::Target {
        self.as_slice()
    }
}

impl<const N: usize, S: Float> PartialEq for Solutions<N, S> {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl<const N: usize, S: Float> IntoIterator for Solutions<N, S> {
    type Item = Solution<N, S>;
    type IntoIter = core::iter::Take<core::array::IntoIter<Solution<N, S>, MAX_SOLUTIONS>>;
    fn into_iter(self) -> Self::IntoIter {
        self.items.into_iter().take(self.len)
    }
}

impl<'a, const N: usize, S: Float> IntoIterator for &'a Solutions<N, S> {
    type Item = &'a Solution<N, S>;
    type IntoIter = core::slice::Iter<'a, Solution<N, S>>;
    fn into_iter(self) -> Self::IntoIter {
        self.as_slice().iter()
    }
}
