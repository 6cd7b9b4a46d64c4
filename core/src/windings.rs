//! Whole turns that bring a solution inside the limits.

use crate::rules::slack;
use crate::{Float, Rules, Winding};

/// How many choices of turns are looked at before the rest is given up: joints that turn hundreds of times under a
/// limit on their sum have more than anybody waits for.
const MOST_VISITS: u32 = 1 << 20;

/// Sets of joint values that differ by whole turns, inside the joint limits and the limits on sums. Made by
/// [`Solution::windings`](crate::Solution::windings); finds them one by one.
#[derive(Debug, Clone)]
pub struct Windings<'a, const N: usize, S = f64> {
    base: [S; N],
    rules: Rules<'a, S>,
    unlimited: Unlimited,
    /// For each winding that has been chosen: the number of turns, and the last one that is to be tried.
    turns: [(i32, i32); N],
    /// How many windings have been chosen.
    chosen: usize,
    /// How many choices have been looked at.
    visits: u32,
    done: bool,
}

/// What becomes of a joint without limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unlimited {
    /// It stays where it is.
    Stay,
    /// One turn to either side is tried too, since a limit on a sum may ask for it.
    OneTurn,
}

impl<'a, const N: usize, S: Float> Windings<'a, N, S> {
    pub(crate) fn new(base: [S; N], rules: Rules<'a, S>, unlimited: Unlimited) -> Self {
        let done = !base.iter().all(|value| value.is_finite());
        Self { base, rules, unlimited, turns: [(0, 0); N], chosen: 0, visits: 0, done }
    }

    /// The joint values with the turns that have been chosen.
    fn q(&self) -> [S; N] {
        let mut q = self.base;
        for (winding, (turns, _)) in self.rules.windings.iter().zip(&self.turns).take(self.chosen) {
            winding.apply(&mut q, S::from_f64(f64::from(*turns)));
        }
        q
    }

    /// The next number of turns of the last winding that has one left.
    fn advance(&mut self) {
        while self.chosen > 0 {
            self.chosen -= 1;
            if let Some((turns, last)) = self.turns.get_mut(self.chosen)
                && *turns < *last
            {
                *turns += 1;
                self.chosen += 1;
                return;
            }
        }
        self.done = true;
    }
}

impl<const N: usize, S: Float> Iterator for Windings<'_, N, S> {
    type Item = [S; N];

    fn next(&mut self) -> Option<[S; N]> {
        while !self.done && self.visits < MOST_VISITS {
            self.visits += 1;
            let q = self.q();
            let Some(winding) = self.rules.windings.get(self.chosen) else {
                self.advance();
                if self.rules.allow_joints(&q) {
                    return Some(q);
                }
                continue;
            };
            let range = turns_inside(winding, &self.rules, &q).unwrap_or(match self.unlimited {
                Unlimited::Stay => (0, 0),
                Unlimited::OneTurn => (-1, 1),
            });
            match self.turns.get_mut(self.chosen) {
                Some(slot) if range.0 <= range.1 => {
                    *slot = range;
                    self.chosen += 1;
                }
                _ => self.advance(),
            }
        }
        None
    }
}

/// The least and the greatest number of turns that bring the winding's joint inside its limits (none if the first is
/// greater); `None` where it has none.
pub(crate) fn turns_inside<S: Float>(
    winding: &Winding<'_, S>,
    rules: &Rules<'_, S>,
    q: &[S],
) -> Option<(i32, i32)> {
    let limits = rules.joints.get(winding.joint)?.limits?;
    let value = *q.get(winding.joint)?;
    let first = ((limits.min - slack(limits.min) - value) / winding.turn).ceil();
    let last = ((limits.max + slack(limits.max) - value) / winding.turn).floor();
    // Casts of floats saturate.
    Some((first.to_f64() as i32, last.to_f64() as i32))
}
