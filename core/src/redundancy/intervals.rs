//! Which values of the free joint leave an allowed solution.

use super::{Range, Redundancy};
use crate::{Float, IkError, Limits, Solutions};

/// How many values are tried before the ends of intervals are looked for between them.
const VALUES: u32 = 64;

/// An end is found when it lies between values this many times the square root of the machine epsilon apart.
const END: f64 = 1.0;

impl<S: Float> Redundancy<'_, S> {
    /// The intervals of the free joint (rad or m) at which some solution keeps all limits and rules, in increasing
    /// order. As many as there is room for are put into `out`; how many there are is returned.
    ///
    /// Sixty-four values over the range of the joint are tried, and the ends between them found by bisection (to 2e-8
    /// in f64, inside the interval); what is narrower than the distance of two such values may be missed. Where a joint
    /// turns all the way, an interval may reach beyond half a turn instead of being cut there.
    pub fn intervals<const N: usize>(
        &self,
        mut at: impl FnMut(S) -> Result<Solutions<N, S>, IkError<S>>,
        position_of: impl Fn(&[S; N]) -> [S; 3],
        out: &mut [Limits<S>],
    ) -> usize {
        let mut allowed = |value: S| {
            at(value).and_then(|solutions| solutions.within(&self.rules, &position_of, None)).is_ok()
        };
        let Range { min, max, closed } = self.range(S::ZERO);
        let step = (max - min) / S::from_f64(f64::from(VALUES));
        let value = |index: u32| min + S::from_f64(f64::from(index)) * step;
        // A turn is walked from where nothing is allowed, so that no interval is cut.
        let start = if closed { (0..VALUES).find(|index| !allowed(value(*index))) } else { Some(0) };
        let Some(start) = start else {
            if let Some(slot) = out.first_mut() {
                *slot = Limits { min, max };
            }
            return 1;
        };
        let mut found = 0;
        let mut open: Option<S> = allowed(value(start)).then(|| value(start));
        let mut close = |min: S, max: S| {
            if let Some(slot) = out.get_mut(found) {
                *slot = Limits { min, max };
            }
            found += 1;
        };
        for index in start..start + VALUES {
            let (before, after) = (value(index), value(index + 1));
            match (open, allowed(after)) {
                (None, true) => open = Some(end(&mut allowed, after, before)),
                (Some(from), false) => {
                    close(from, end(&mut allowed, before, after));
                    open = None;
                }
                _ => {}
            }
        }
        if let Some(from) = open {
            close(from, value(start + VALUES));
        }
        found
    }
}

/// The end of an interval between an allowed value and another: the last allowed one that is found.
fn end<S: Float>(allowed: &mut impl FnMut(S) -> bool, inside: S, outside: S) -> S {
    let (mut inside, mut outside) = (inside, outside);
    let small = S::from_f64(END) * S::SQRT_EPSILON;
    while (outside - inside).abs() > small * S::ONE.max(inside.abs()) {
        let middle = (inside + outside) / S::TWO;
        if allowed(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}
