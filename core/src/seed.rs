//! Joint values that a search is to be near to, where its target leaves it a choice.

use crate::rules::Rules;
use crate::{Float, IkError, LengthError, Solutions};

/// Joint values that say what a joint is set to which the target leaves free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seed<'a, S = f64> {
    /// rad or m
    pub q: &'a [S],
    /// How far from there a free joint is set, in half turns (reaches, where it slides); in half periods, where whole turns
    /// of it carry others by a fraction.
    pub aside: S,
}

impl<'a, S: Float> Seed<'a, S> {
    /// These joint values.
    pub const fn new(q: &'a [S]) -> Self {
        Self { q, aside: S::ZERO }
    }
}

/// What the unknowns of a search are at a [`Seed`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted<'s, const K: usize, S = f64> {
    unknowns: [S; K],
    seed: Option<Seed<'s, S>>,
}

impl<'s, const K: usize, S: Float> Wanted<'s, K, S> {
    /// The unknowns (rad or m) as functions of the joint values.
    ///
    /// # Errors
    /// Where the seed has not `N` joint values.
    #[inline]
    pub fn of<const N: usize>(
        seed: Option<Seed<'s, S>>,
        unknowns: impl Fn(&[S; N]) -> [S; K],
    ) -> Result<Self, LengthError> {
        let values = match seed {
            Some(seed) => unknowns(crate::joint_array(seed.q)?),
            None => [S::ZERO; K],
        };
        Ok(Self::new(values, seed))
    }

    /// The unknowns (rad or m; NaN where nothing is known of one) at the seed.
    #[inline]
    pub const fn new(unknowns: [S; K], seed: Option<Seed<'s, S>>) -> Self {
        Self { unknowns, seed }
    }

    /// As a search takes it: the unknowns, and the seed itself.
    pub(crate) fn view(&self) -> Option<(&[S], Seed<'s, S>)> {
        self.seed.map(|seed| (self.unknowns.as_slice(), seed))
    }
}

/// How many values of a free joint are tried where none of the solutions is allowed, besides the seed's own.
const ASIDE: i16 = 16;

impl<S: Float> Rules<'_, S> {
    /// The solutions that these rules allow, see [`Solutions::within`]; `solve` gives all that there are.
    ///
    /// A joint that the target leaves free is at the value of `seed`, without one at the middle of its limits; where
    /// no solution is allowed there, at the nearest of sixteen values spread over the whole turn (over the reach to
    /// either side, where it slides) at which one is.
    ///
    /// # Errors
    /// Those of `solve`, and those of [`Solutions::within`].
    pub fn allowed<const N: usize>(
        &self,
        mut solve: impl FnMut(Seed<'_, S>) -> Result<Solutions<N, S>, IkError<S>>,
        position_of: impl Fn(&[S; N]) -> [S; 3],
        seed: Option<&[S; N]>,
    ) -> Result<Solutions<N, S>, IkError<S>> {
        let reference = seed.copied().unwrap_or_else(|| self.middle());
        let q = reference.get(..self.joints.len()).unwrap_or(&reference);
        let solutions = solve(Seed::new(q))?;
        let is_free = solutions.iter().any(|solution| solution.free.is_some());
        let error = match solutions.within(self, &position_of, seed) {
            Err(error) if is_free => error,
            outcome => return outcome,
        };
        for step in 0..ASIDE {
            // An eighth of half a turn to one side, then to the other, then two eighths.
            let aside =
                S::from_f64(f64::from(if step % 2 == 0 { step / 2 + 1 } else { -(step / 2) - 1 }) / 8.0);
            let other = solve(Seed { q, aside }).and_then(|other| other.within(self, &position_of, seed));
            if other.is_ok() {
                return other;
            }
        }
        Err(error)
    }

    /// The middle of the limits (rad or m); 0 where there are none.
    pub(crate) fn middle<const N: usize>(&self) -> [S; N] {
        let mut middle = [S::ZERO; N];
        for (value, joint) in middle.iter_mut().zip(self.joints) {
            *value = joint.limits.map_or(S::ZERO, |limits| limits.middle());
        }
        middle
    }
}
