//! A joint that a target leaves free, or next to free: one of its values, with which the rest can be solved.

use super::{DEPTH_OF_MISSED, Failure, Roots, Search};
use crate::{Float, Step};

/// Values of a free joint that are tried at even distances: multiples of an eighth of half a turn, or of the reach.
const EVEN: u32 = 16;

/// Golden section of an interval: what is left of it is 0.618^60 = 3e-13.
const REFINED: u32 = 60;

/// The ratio by which a golden section divides: (sqrt(5) - 1) / 2.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Values of an interval that tell whether what is missing changes in it: the middle, both inner points of the golden section,
/// and the next one, farther out, since a miss that vanishes on both sides of the middle may be as large at the inner points.
const TELLING: u32 = 4;

/// Where what is missing is the same up to this part of it at those values, it vanishes nowhere in the interval.
const FLAT: f64 = 1.0 / 64.0;

/// The state of a step whose coefficients vanish, or nearly do: values are tried until one of them leads to a solution.
///
/// What may be wrong with a value is that a later step leaves its domain, and by how much is a smooth function of the
/// value between the edges of domains. So where no value at even distances will do, the least failure is looked for by
/// golden section about the best of them. A root that is known to a few digits only is the first value, and the interval
/// that it may be in is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Free<S> {
    pub(super) step: Step,
    /// Whether any value meets the equation; else only those in the interval.
    any: bool,
    /// How many values at even distances are tried: none of a root that is known to some digits.
    even: u32,
    /// Whether all of those are, though one leads to a solution.
    every: bool,
    tried: u32,
    /// The first one.
    pub(super) value: S,
    start: S,
    /// How many solutions there were before.
    accepted: u32,
    /// The failure before, and the best one since with the value that led to it.
    outer: Option<Failure<S>>,
    best: Option<(S, Failure<S>)>,
    /// The interval of the golden section, and what is known of its inner points.
    interval: [S; 2],
    inner: [Option<Failure<S>>; 2],
    /// The failure in the middle of the interval, as long as the others in it are the same.
    flat: Option<Failure<S>>,
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// Any value of a step, starting with `free`'s.
    pub(super) fn free(&mut self, free: Free<S>) -> Roots<S> {
        let Free { step, value, .. } = free;
        match self.free.get_mut(usize::from(step.index)) {
            Some(slot) => *slot = Some(free),
            // More steps than joints: there are none.
            None => return Roots::NONE,
        }
        Roots::any(step, value)
    }

    /// The next value of a step that is free, if none led to a solution yet.
    #[cold]
    #[inline(never)]
    pub(super) fn next_value(&mut self, step: u8) -> Option<S> {
        let mut free = self.free.get(usize::from(step)).copied().flatten()?;
        let value = self.next_of(&mut free);
        if let Some(slot) = self.free.get_mut(usize::from(step)) {
            *slot = Some(free);
        }
        value
    }

    fn next_of(&mut self, free: &mut Free<S>) -> Option<S> {
        if free.tried == 0 {
            free.outer = self.failure.take();
        } else {
            let failure = self.failure.take();
            if self.accepted > free.accepted && !(free.every && free.tried < free.even) {
                self.failure = free.outer;
                return None;
            }
            free.note(failure);
        }
        let value = free.next(self.reach);
        free.tried += 1;
        if value.is_some() && free.any {
            self.mark_free(free.step);
        } else if value.is_none() {
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
    /// Of a step that any value meets: what is wanted, and values about that, before others.
    pub(super) fn any(step: Step, wanted: Option<S>, accepted: u32) -> Self {
        let start = wanted.unwrap_or(S::ZERO);
        Self {
            step,
            any: true,
            even: if wanted.is_some() { 2 * EVEN } else { EVEN },
            every: false,
            tried: 0,
            value: start,
            start,
            accepted,
            outer: None,
            best: None,
            interval: [S::ZERO; 2],
            inner: [None; 2],
            flat: None,
        }
    }

    /// The same with every value at even distances, for what each of them leads to.
    pub(super) fn every(step: Step, accepted: u32) -> Self {
        Self { every: true, ..Self::any(step, None, accepted) }
    }

    /// Of a root that is somewhere in an interval.
    pub(super) fn about(step: Step, root: S, uncertainty: S, accepted: u32) -> Self {
        let interval = [root - uncertainty, root + uncertainty];
        Self { any: false, even: 0, interval, ..Self::any(step, Some(root), accepted) }
    }

    /// One of the values at even distances.
    fn at_even_distance(&self, number: u32, half_range: S) -> S {
        // Quarter turns first, then eighths, then sixteenths.
        const ORDER: [i8; EVEN as usize] = [0, 4, -4, 8, 2, -2, 6, -6, 1, -1, 3, -3, 5, -5, 7, -7];
        let (from, eighths) = if self.even > EVEN && number < EVEN {
            // About what is wanted, the nearest first.
            let away = (number / 2 + 1) as i8;
            (self.start, if number.is_multiple_of(2) { away } else { -away })
        } else {
            (S::ZERO, ORDER.get((number % EVEN) as usize).copied().unwrap_or(0))
        };
        from + S::from_f64(f64::from(eighths) / 8.0) * half_range
    }

    fn next(&mut self, reach: S) -> Option<S> {
        if self.tried == 0 {
            return Some(self.value);
        }
        let half_range = self.step.half_range(reach);
        let even = self.even;
        if self.tried <= even {
            return Some(self.at_even_distance(self.tried - 1, half_range));
        }
        if self.tried > even + REFINED || (self.tried == even + TELLING && self.flat.is_some()) {
            return None;
        }
        if self.any && self.tried == even + 1 {
            let (value, _) = self.best?;
            let step = half_range / S::from_f64(8.0);
            self.interval = [value - step, value + step];
        }
        Some(self.refined())
    }

    fn note(&mut self, failure: Option<Failure<S>>) {
        let Some(failure) = failure else { return };
        if self.tried > self.even + 1 {
            let [left, right] = &mut self.inner;
            *(if left.is_none() { left } else { right }) = Some(failure);
            self.flat = self.flat.filter(|middle| failure.is_alike(middle));
        }
        if self.best.is_none_or(|(_, best)| failure.is_nearer(&best)) {
            self.best = Some((self.value, failure));
        }
        if self.tried == self.even + 1 {
            self.flat = self.best.map(|(_, middle)| middle);
        }
    }

    /// The inner points of the golden section.
    fn points(&self) -> [S; 2] {
        let [from, to] = self.interval;
        let part = S::from_f64(GOLDEN) * (to - from);
        [to - part, from + part]
    }

    /// The next value of the golden section.
    fn refined(&mut self) -> S {
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
        if let [None, _] = self.inner { left } else { right }
    }
}

impl<S: Float> Failure<S> {
    /// Whether it came further towards a solution than another one: at a later step, or by less. A candidate that
    /// misses its target has all steps behind it.
    fn is_nearer(&self, other: &Self) -> bool {
        let rank = |failure: &Self| failure.depth.wrapping_sub(DEPTH_OF_MISSED + 1);
        rank(self) > rank(other) || (rank(self) == rank(other) && self.miss < other.miss)
    }
    /// Whether it is of the same step, and next to as large.
    fn is_alike(&self, other: &Self) -> bool {
        self.depth == other.depth && (self.miss - other.miss).abs() <= S::from_f64(FLAT) * other.miss
    }
}
