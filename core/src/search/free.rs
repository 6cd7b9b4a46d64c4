//! A joint that a target leaves free: one of its values, with which the rest can be solved.

use super::{DEPTH_OF_MISSED, Failure, Roots, Search};
use crate::{Float, Step};

/// Values tried at even distances: multiples of an eighth of half a turn, or of the reach.
const EVEN: u32 = 16;

/// Golden section of the two intervals next to the best of those: the interval left is 0.618^60 = 3e-13 of them.
const REFINED: u32 = 60;

/// The ratio by which a golden section divides: (sqrt(5) - 1) / 2.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The state of a free step: values are tried until one of them leads to a solution.
///
/// First 0, then even steps away from it. What may be wrong with a value is that a later step leaves its domain, and by
/// how much is a smooth function of the value between the edges of domains; so at last the least failure is looked for,
/// by golden section about the best value so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Free<S> {
    step: Step,
    tried: u32,
    value: S,
    /// How many solutions there were before.
    accepted: u32,
    /// The failure before, and the best one since with the value that led to it.
    outer: Option<Failure<S>>,
    best: Option<(S, Failure<S>)>,
    /// The interval of the golden section, and what is known of its inner points.
    interval: [S; 2],
    inner: [Option<Failure<S>>; 2],
}

impl<S: Float> Roots<S> {
    /// The roots of a step whose coefficients vanish: any value.
    pub(super) fn free(step: Step, accepted: u32) -> Self {
        let free = Free {
            step,
            tried: 0,
            value: S::ZERO,
            accepted,
            outer: None,
            best: None,
            interval: [S::ZERO; 2],
            inner: [None; 2],
        };
        Self { roots: [Some(S::ZERO), None], free: Some(free) }
    }
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The next root to go on with. A step that is free gives another value as long as none led to a solution.
    #[inline]
    pub fn next(&mut self, roots: &mut Roots<S>) -> Option<S> {
        if let Some(free) = &mut roots.free {
            return self.next_value(free);
        }
        let [first, second] = &mut roots.roots;
        first.take().or_else(|| second.take())
    }

    #[cold]
    fn next_value(&mut self, free: &mut Free<S>) -> Option<S> {
        if free.tried == 0 {
            free.outer = self.failure.take();
        } else {
            let failure = self.failure.take();
            if self.accepted > free.accepted {
                self.failure = free.outer;
                return None;
            }
            free.note(failure);
        }
        let value = if free.tried < EVEN { Some(free.even(self.reach)) } else { free.refined(self.reach) };
        free.tried += 1;
        if value.is_some() {
            self.mark_free(free.step);
        } else {
            self.failure = free.outer;
            if let Some((_, best)) = free.best {
                self.fail(best.depth, best.miss, best.error);
            }
        }
        free.value = value.unwrap_or(free.value);
        value
    }
}

impl<S: Float> Free<S> {
    /// Half a turn, or the reach (m).
    fn half_range(&self, reach: S) -> S {
        if self.step.prismatic { reach } else { S::PI }
    }

    /// 0, then the even steps: quarters first.
    fn even(&self, reach: S) -> S {
        // 0 4 8 -4, 2 6 -6 -2, and the odd ones.
        const ORDER: [i8; EVEN as usize] = [0, 4, -4, 8, 2, -2, 6, -6, 1, -1, 3, -3, 5, -5, 7, -7];
        let eighths = ORDER.get(self.tried as usize).copied().unwrap_or(0);
        S::from_f64(f64::from(eighths) / 8.0) * self.half_range(reach)
    }

    fn note(&mut self, failure: Option<Failure<S>>) {
        let Some(failure) = failure else { return };
        if self.tried > EVEN {
            let [left, right] = &mut self.inner;
            *(if left.is_none() { left } else { right }) = Some(failure);
        }
        if self.best.is_none_or(|(_, best)| failure.is_nearer(&best)) {
            self.best = Some((self.value, failure));
        }
    }

    /// The inner points of the golden section.
    fn points(&self) -> [S; 2] {
        let [from, to] = self.interval;
        let part = S::from_f64(GOLDEN) * (to - from);
        [to - part, from + part]
    }

    /// The next value of the golden section.
    fn refined(&mut self, reach: S) -> Option<S> {
        if self.tried >= EVEN + REFINED {
            return None;
        }
        if self.tried == EVEN {
            let (value, _) = self.best?;
            let step = self.half_range(reach) / S::from_f64(8.0);
            self.interval = [value - step, value + step];
        }
        if let [Some(below), Some(above)] = self.inner {
            let [from, to] = self.interval;
            let [left, right] = self.points();
            (self.interval, self.inner) = if below.is_nearer(&above) {
                ([from, right], [None, Some(below)])
            } else {
                ([left, to], [Some(above), None])
            };
        }
        let [left, right] = self.points();
        Some(if let [None, _] = self.inner { left } else { right })
    }
}

impl<S: Float> Failure<S> {
    /// Whether it came further towards a solution than another one: at a later step, or by less. A candidate that
    /// misses its target has all steps behind it.
    fn is_nearer(&self, other: &Self) -> bool {
        let rank = |failure: &Self| failure.depth.wrapping_sub(DEPTH_OF_MISSED + 1);
        rank(self) > rank(other) || (rank(self) == rank(other) && self.miss < other.miss)
    }
}
