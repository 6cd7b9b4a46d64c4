//! The steps of the closed form, with account of what their unknowns may be off by.
//!
//! A step whose two roots have met, or that has none but may have one of the arm as it is, gives the root between; one whose
//! coefficients vanish gives any. What follows from there is near the curve on which the solutions are ([`super::curve`]).

use super::super::free::Free;
use super::super::trigonometric::both;
use super::{MARGIN, Near, UNSURE, above, row};
use crate::{Float, QuarticRoots, Roots, Step};

/// Sines that are smaller than this are taken for 0 where another step has a double root.
const CROSSED: f64 = 0.1;

/// Cosine and sine that are off the unit circle by more than this belong to no root.
const FALSE: f64 = 0.25;

/// Rows of which the larger is more than so many times what it may be off by don't vanish.
const LARGE: f64 = 10.0;

impl<const N: usize, S: Float> Near<'_, N, S> {
    /// What a step's equation may be off by, in its own dimension; and that as if all earlier unknowns were right.
    #[inline]
    fn begin(&mut self, step: Step) -> [S; 2] {
        let index = usize::from(step.index);
        // This step and those that follow it.
        self.singular = self.singular.without(!(step.bit() - 1));
        let Some([deviation, gains @ ..]) = self.gains.get(row(index)..row(index + 1)) else {
            return [S::INFINITY; 2];
        };
        let own = S::from_f64(*deviation);
        let mut off = own;
        for (gain, by) in gains.iter().zip(&self.off) {
            off += S::from_f64(*gain) * *by;
            // Of an unknown that may be anything, nothing follows.
            if *gain > 0.0 && *by >= S::from_f64(UNSURE) {
                off = S::INFINITY;
            }
        }
        let scale = step.measure.scale(self.search.reach);
        [off * scale, own * scale]
    }

    /// Doubts a step that may have no root, if it depends on an unknown that is any: the curve through one value of that may
    /// be one of several.
    #[inline]
    fn doubt_if_adrift(&mut self, step: Step) {
        if self.singular.idle != 0 {
            let index = usize::from(step.index);
            let gains = self.gains.get(row(index) + 1..row(index + 1)).unwrap_or_default();
            let idle = |(place, gain): (usize, &f64)| *gain > 0.0 && self.singular.idle & (1 << place) != 0;
            self.doubtful |= gains.iter().enumerate().any(idle);
        }
    }

    /// Notes by how much (rad, reaches) the unknown of a step may be off.
    #[inline]
    fn end(&mut self, step: Step, by: S) {
        let most = S::from_f64(UNSURE);
        if let Some(off) = self.off.get_mut(usize::from(step.index)) {
            *off = if by < most { by } else { most };
        }
    }

    #[cold]
    fn doubt(&mut self) -> Roots<S> {
        self.doubtful = true;
        Roots::NONE
    }

    /// Notes that the unknown of a step is any.
    fn any(&mut self, step: Step) {
        self.singular.idle |= step.bit();
        self.end(step, S::ZERO);
    }

    /// [`Search::trig`](crate::Search::trig): its two roots meet where a² + b² = c².
    #[inline]
    pub fn trig(&mut self, step: Step, a: S, b: S, c: S) -> Roots<S> {
        if self.seek.is_some() {
            return self.trig_of_neighbour(step, [a, b, c]);
        }
        self.doubt_if_adrift(step);
        let [off, own] = self.begin(step);
        let square = a * a + b * b;
        let rest = square - c * c;
        if rest > S::ZERO && rest * rest > own * own * square {
            let root = rest.sqrt();
            self.end(step, off / root);
            return both(a, b, c, root, S::ONE / square);
        }
        self.trig_at_fold(step, [a, b, c], [off, own])
    }

    #[cold]
    #[inline(never)]
    fn trig_of_neighbour(&mut self, step: Step, [a, b, c]: [S; 3]) -> Roots<S> {
        let nothing = self.nothing(step);
        if [a, b, c].iter().all(|x| !above(x.abs(), nothing)) {
            return self.search.free(Free::every(step, self.search.accepted));
        }
        self.search.trig(step, a, b, c)
    }

    /// Of a neighbour of a target that is no pose: coefficients that are no greater vanish, as far as is known.
    fn nothing(&self, step: Step) -> S {
        if self.asks_for_pose() {
            return -S::ONE;
        }
        let deviation = self.gains.get(row(usize::from(step.index))).copied().unwrap_or(f64::INFINITY);
        S::from_f64(MARGIN * deviation) * step.measure.scale(self.search.reach)
    }

    /// Two roots that are about to meet, or have met.
    #[cold]
    #[inline(never)]
    fn trig_at_fold(&mut self, step: Step, [a, b, c]: [S; 3], [off, own]: [S; 2]) -> Roots<S> {
        let h = (a * a + b * b).sqrt();
        let excess = c.abs() - h;
        if excess > S::ZERO {
            self.search.unreachable_by(step, excess, h);
        }
        if excess > S::from_f64(MARGIN) * off && off.is_finite() {
            self.doubtful |= self.singular.idle != 0;
            return Roots::NONE;
        }
        if above(S::from_f64(MARGIN) * own, h) {
            self.any(step);
        } else {
            self.singular.folds |= step.bit();
            self.singular.beyond |= if excess > S::ZERO { step.bit() } else { 0 };
            self.end(step, (S::TWO * off / h).sqrt());
        }
        let unit = S::ONE / h;
        Roots::angle(match h > S::ZERO {
            true if c < S::ZERO => [-b * unit, -a * unit],
            true => [b * unit, a * unit],
            false => [S::ZERO, S::ONE],
        })
    }

    /// [`Search::trig_unit`](crate::Search::trig_unit): its two roots meet where d and e vanish.
    #[inline]
    pub fn trig_unit(&mut self, step: Step, row: [S; 3], others: [S; 2]) -> Roots<S> {
        if self.seek.is_some() {
            return self.search.trig_unit(step, row, others);
        }
        self.doubt_if_adrift(step);
        let ([a, b, c], [d, e]) = (row, others);
        let [off, own] = self.begin(step);
        let rest = d * d + e * e;
        // Where roots of a step before may have met, this one is not known any better.
        let sure = if self.singular.folds == 0 { own } else { off.min(own.max(S::from_f64(CROSSED))) };
        let margin = S::from_f64(MARGIN) * sure;
        if !above(rest, margin * margin) {
            self.singular.poles |= step.bit();
            self.end(step, margin + off);
            return Roots::angle(if c < S::ZERO { [-b, -a] } else { [b, a] });
        }
        self.end(step, off);
        let unit = S::ONE / (rest + c * c);
        let root = unit.sqrt();
        both(a, b, c * root, rest.sqrt() * root, S::ONE)
    }

    /// [`Search::trig_pair`](crate::Search::trig_pair): it has no root where the rows are one, or vanish.
    #[inline]
    pub fn trig_pair(&mut self, step: Step, first: [S; 3], second: [S; 3]) -> Roots<S> {
        if self.seek.is_some() {
            return self.trig_pair_of_neighbour(step, first, second);
        }
        let [off, own] = self.begin(step);
        let ([a1, b1, c1], [a2, b2, c2]) = (first, second);
        let determinant = a1 * b2 - a2 * b1;
        let (h1, h2) = (a1 * a1 + b1 * b1, a2 * a2 + b2 * b2);
        let h = if h1 > h2 { h1 } else { h2 };
        let (cos, sin) = (c1 * b2 - c2 * b1, a1 * c2 - a2 * c1);
        let size = (cos * cos + sin * sin).sqrt();
        let unit = S::ONE / if determinant < S::ZERO { -size } else { size };
        let inverse = S::ONE / determinant.abs();
        let per_off = h.sqrt() * inverse;
        let miss = (size * inverse - S::ONE).abs();
        let root = [sin * unit, cos * unit];
        if !above(S::from_f64(UNSURE), own * per_off) {
            return self.trig_pair_at_pole(step, h, own, root);
        }
        let by = off * per_off;
        self.end(step, by);
        if miss > S::from_f64(MARGIN) * by + S::from_f64(FALSE) {
            self.doubtful |= self.singular.idle != 0;
            return self.search.unreachable_by(step, miss * h.sqrt(), h.sqrt());
        }
        Roots::angle(root)
    }

    /// Rows that are one, or vanish.
    #[cold]
    #[inline(never)]
    fn trig_pair_at_pole(&mut self, step: Step, h: S, own: S, root: [S; 2]) -> Roots<S> {
        if above(h, S::from_f64(LARGE * LARGE) * own * own) {
            return self.doubt();
        }
        self.any(step);
        let sure = root.iter().all(|part| part.is_finite());
        Roots::angle(if sure { root } else { [S::ZERO, S::ONE] })
    }

    #[cold]
    #[inline(never)]
    fn trig_pair_of_neighbour(&mut self, step: Step, first: [S; 3], second: [S; 3]) -> Roots<S> {
        let nothing = self.nothing(step);
        if first.iter().chain(&second).all(|x| !above(x.abs(), nothing)) {
            return self.search.free(Free::every(step, self.search.accepted));
        }
        self.search.trig_pair(step, first, second)
    }

    /// [`Search::quartic`](crate::Search::quartic): two of its roots meet where its slope is 0.
    pub fn quartic(&mut self, step: Step, forms: [[S; 3]; 2], right: S) -> QuarticRoots<S> {
        self.squares(step, forms, right, None)
    }

    /// [`Search::quartic_unit`](crate::Search::quartic_unit).
    pub fn quartic_unit(
        &mut self,
        step: Step,
        forms: [[S; 3]; 2],
        right: S,
        others: [[S; 3]; 2],
        length: [S; 3],
    ) -> QuarticRoots<S> {
        self.squares(step, forms, right, Some((others, length)))
    }

    fn squares(
        &mut self,
        step: Step,
        forms: [[S; 3]; 2],
        right: S,
        unit: Option<([[S; 3]; 2], [S; 3])>,
    ) -> QuarticRoots<S> {
        // Also where a step before it was in doubt, so that it is only reached for poses beside the target.
        self.quartic = true;
        if self.seek.is_some() {
            return self.search.squares(step, forms, right, unit);
        }
        self.doubt_if_adrift(step);
        let [off, _] = self.begin(step);
        // The sums have the step's dimension, their squares twice that.
        let off = off * step.measure.scale(self.search.reach);
        match self.search.quartic_off_by(step, forms, right, unit, S::from_f64(MARGIN) * off) {
            Some((roots, by)) => {
                self.end(step, by);
                roots
            }
            None => QuarticRoots::of(self.doubt()),
        }
    }

    /// The next root (rad) of a quartic to go on with, with its sine and cosine.
    pub fn next_of_quartic(&mut self, roots: &mut QuarticRoots<S>) -> Option<(S, S, S)> {
        if self.stopped() { None } else { self.search.next_of_quartic(roots) }
    }

    /// [`Search::linear`](crate::Search::linear): it has no root where a vanishes.
    pub fn linear(&mut self, step: Step, a: S, c: S) -> Roots<S> {
        if self.seek.is_some() {
            return self.search.linear(step, a, c);
        }
        let [off, _] = self.begin(step);
        let unit = if step.prismatic { self.search.reach } else { S::ONE };
        let slope = (a * unit).abs();
        if !above(slope, S::from_f64(MARGIN) * off) {
            return self.doubt();
        }
        let root = c / a;
        self.end(step, off * (S::ONE + (root / unit).abs()) / slope);
        Roots::value(root)
    }

    /// [`Search::quadratic`](crate::Search::quadratic): its two roots meet where b² = 4 a c.
    pub fn quadratic(&mut self, step: Step, a: S, b: S, c: S) -> Roots<S> {
        if self.seek.is_some() {
            return self.search.quadratic(step, a, b, c);
        }
        self.doubt_if_adrift(step);
        let [off, _] = self.begin(step);
        let unit = if step.prismatic { self.search.reach } else { S::ONE };
        let (a, half) = (a * unit * unit, b * unit / S::TWO);
        let (square, product) = (half * half, a * c);
        let rest = square - product;
        let size = half.abs() + a.abs() + c.abs();
        let margin = S::TWO * S::from_f64(MARGIN) * off;
        if !(above(rest.abs(), margin * size) && above(a.abs(), margin)) {
            return self.doubt();
        }
        if rest < S::ZERO {
            let excess = (product.sqrt() - half.abs()) / a.abs();
            return self.search.unreachable_by(step, excess * unit, S::ONE);
        }
        let root = rest.sqrt();
        let greater = if half < S::ZERO { root - half } else { -(half + root) };
        let (first, second) = (greater / a, c / greater);
        let far = first.abs().max(second.abs()).max(S::ONE);
        self.end(step, off * far * far / root);
        Roots::values(first * unit, second * unit)
    }
}
