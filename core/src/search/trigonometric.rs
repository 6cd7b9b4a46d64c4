//! Equations in the cosine and sine of one angle.

use super::free::Free;
use super::pose::hopeless;
use super::{DOUBLE_ROOT, Roots, Scale, Search, indifferent};
use crate::{Float, IkError, Step};

/// Two rows whose directions differ by less than this many square roots of the machine epsilon (rad) are one row.
const PARALLEL: f64 = 1.0;

/// Where a cosine and sine are off the unit circle by more than this, one of their rows may be nothing but rounding.
const UNRELIABLE: f64 = 1e-3;

/// It is, if it has less than this share of the larger one's size. (Two small rows of one size still tell the angle,
/// however wrong that size: its rounding is the same in both.)
const WEAK: f64 = 0.125;

/// From here on r² = h² - c², in units of h², is as good as (h - c)(h + c).
const WELL_INSIDE: f64 = 1.0 / 64.0;

/// A root is one of two that part clearly where the square of the sine of half their distance is more than this many
/// machine epsilons: 5e-7 rad in f64, three times what counts as the same solution.
const CLEAR: f64 = 1024.0;

/// Two rows that are so many times the square root of the machine epsilon may be what ill-conditioned steps have left of nothing:
/// 1e-6 in f64.
pub(super) const VAGUE: f64 = 64.0;

/// Two rows are well-conditioned where the square of their determinant is more than this, in units of the fourth power of
/// the larger one: no digit but the last two is lost then.
const INDEPENDENT: f64 = 1e-4;

/// Cosine and sine from two well-conditioned rows are taken as they come if the sum of their squares is this many
/// machine epsilons from 1.
const CONSISTENT: f64 = 4096.0;

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The angles x (rad) with a cos x + b sin x = c: two, or one at the edge of the domain.
    ///
    /// With h² = a² + b² and r = sqrt(h² - c²) the roots are (a c ∓ b r, b c ± a r) / h² as cosine and sine. Next to the
    /// edge, where r loses half of its digits, it is (h - c)(h + c).
    #[inline]
    pub fn trig(&mut self, step: Step, a: S, b: S, c: S) -> Roots<S> {
        let scale = self.begin(step);
        let square = a * a + b * b;
        let rest = square - c * c;
        if rest > S::from_f64(WELL_INSIDE) * square && square > scale.tolerance * scale.tolerance {
            return both(a, b, c, rest.sqrt(), S::ONE / square).signed(step.sign_bit());
        }
        self.trig_at_edge(step, [a, b, c], &scale).unpacked().signed(step.sign_bit())
    }

    /// The angles x (rad) with a cos x + b sin x = c, where a² + b² is 1 and c is a coordinate of a unit vector whose
    /// other two are d and e: then a sin x - b cos x is ±sqrt(d² + e²), which keeps its digits where c is next to 1 or -1.
    #[inline]
    pub fn trig_unit(&mut self, step: Step, [a, b, c]: [S; 3], [d, e]: [S; 2]) -> Roots<S> {
        let scale = self.begin(step);
        let rest = d * d + e * e;
        let off = rest + c * c - S::ONE;
        if rest > S::from_f64(CLEAR) * S::EPSILON && off.abs() <= S::from_f64(CONSISTENT) * S::EPSILON {
            // A step of Newton's method for 1 / sqrt(1 + off).
            let unit = S::ONE - off / S::TWO;
            return both(a, b, c * unit, rest.sqrt() * unit, S::ONE).signed(step.sign_bit());
        }
        self.trig_at_pole(step, [a, b, c], rest.sqrt(), &scale).unpacked().signed(step.sign_bit())
    }

    /// The angle x (rad) with a1 cos x + b1 sin x = c1 and a2 cos x + b2 sin x = c2.
    ///
    /// Cosine and sine come from the two rows as linear equations. Where these are ill-conditioned, each row is divided by
    /// its size, and one step of Gauss-Newton on the rows as they are gives the larger row, which knows the angle better,
    /// its greater weight. Rows that are parallel, or of which one vanishes, are solved as one row, which may have two
    /// roots.
    #[inline]
    pub fn trig_pair(&mut self, step: Step, first: [S; 3], second: [S; 3]) -> Roots<S> {
        let scale = self.begin(step);
        let ([a1, b1, c1], [a2, b2, c2]) = (first, second);
        let determinant = a1 * b2 - a2 * b1;
        let (h1, h2) = (a1 * a1 + b1 * b1, a2 * a2 + b2 * b2);
        let h = if h1 > h2 { h1 } else { h2 };
        if determinant * determinant > S::from_f64(INDEPENDENT) * h * h
            && h > scale.tolerance * scale.tolerance
        {
            let inverse = S::ONE / determinant;
            let (cos, sin) = ((c1 * b2 - c2 * b1) * inverse, (a1 * c2 - a2 * c1) * inverse);
            let off = cos * cos + sin * sin - S::ONE;
            if off.abs() <= S::from_f64(CONSISTENT) * S::EPSILON {
                let unit = S::ONE - off / S::TWO;
                return Roots::angle([sin * unit, cos * unit]);
            }
        }
        self.trig_pair_with_care(step, first, second, &scale).unpacked().signed(0)
    }

    /// The angles x (rad) with a cos x + b sin x = c, of two rows each of which follows from the other wherever both say
    /// something, and the target can be met: two, from the row with the larger coefficients. Which is the `+` root is another
    /// in either row, and so no part of a branch.
    #[inline]
    pub fn trig_either(&mut self, step: Step, first: [S; 3], second: [S; 3]) -> Roots<S> {
        let square = |[a, b, _]: [S; 3]| a * a + b * b;
        let [a, b, c] = if square(first) > square(second) { first } else { second };
        self.trig(step, a, b, c).signed(0)
    }

    /// [`Search::trig`] where its fast way doesn't apply.
    #[cold]
    #[inline(never)]
    fn trig_at_edge(&mut self, step: Step, [a, b, c]: [S; 3], scale: &Scale<S>) -> Roots<S> {
        let h = size(a, b);
        if !(h.is_finite() && c.is_finite()) {
            return self.not_finite(step);
        }
        if h <= scale.vanishing {
            let told = self.tells_apart(step, c.abs(), scale);
            return told.unwrap_or_else(|| self.degenerate(step, c.abs(), scale));
        }
        let excess = c.abs() - h;
        if excess > self.spare(scale) {
            return self.unreachable(step, excess, h, scale);
        }
        let (a, b) = (a / h, b / h);
        let rest = (h - c) * (h + c);
        self.doubtful |= rest <= S::from_f64(CLEAR) * S::EPSILON * h * h || h <= scale.tolerance;
        if h <= scale.tolerance {
            self.vague_steps |= step.bit();
        }
        let rounding = S::from_f64(DOUBLE_ROOT) * S::EPSILON * scale.size.max(h);
        if excess >= -rounding {
            let apart = (S::TWO * excess.abs().max(rounding) / h).sqrt();
            // a sin - b cos rises there where c is positive.
            let (cos, sin, apart) = if c < S::ZERO { (-a, -b, -apart) } else { (a, b, apart) };
            return Roots::edge(step, [sin, cos], apart);
        }
        both(a, b, c / h, rest.sqrt() / h, S::ONE)
    }

    /// [`Search::trig_unit`] where its fast way doesn't apply; `rest` is the square root.
    #[cold]
    #[inline(never)]
    fn trig_at_pole(&mut self, step: Step, [a, b, c]: [S; 3], rest: S, scale: &Scale<S>) -> Roots<S> {
        self.doubtful = true;
        let length = size(c, rest);
        if !length.is_finite() {
            return self.not_finite(step);
        }
        // A unit vector that isn't one comes of earlier steps that left their domain by as much.
        let excess = c.abs() - S::ONE;
        if excess > scale.tolerance || length <= scale.tolerance {
            return self.unreachable(step, excess.max(S::ONE - length), S::ONE, scale);
        }
        if rest <= scale.vanishing {
            let (cos, sin) = if c < S::ZERO { (-a, -b) } else { (a, b) };
            return Roots::angle([sin, cos]);
        }
        both(a, b, c / length, rest / length, S::ONE)
    }

    /// [`Search::trig_pair`] where its fast way doesn't apply.
    #[cold]
    #[inline(never)]
    fn trig_pair_with_care(
        &mut self,
        step: Step,
        first: [S; 3],
        second: [S; 3],
        scale: &Scale<S>,
    ) -> Roots<S> {
        self.doubtful = true;
        let ([a1, b1, c1], [a2, b2, c2]) = (first, second);
        let (h1, h2) = (size(a1, b1), size(a2, b2));
        let gap = size(c1, c2);
        if !(h1.is_finite() && h2.is_finite() && gap.is_finite()) {
            return self.not_finite(step);
        }
        let (larger, h, smaller, h_small) =
            if h1 >= h2 { (first, h1, second, h2) } else { (second, h2, first, h1) };
        if h <= S::from_f64(VAGUE) * S::SQRT_EPSILON * scale.size {
            self.vague_steps |= step.bit();
        }
        // Coefficients that are themselves the root of a rounding error (the sine of a wrist angle next to 0) are 0 if
        // the right-hand sides, which are known to the last digits, are.
        if h <= scale.vanishing || (h <= scale.tolerance && gap <= scale.vanishing) {
            let told = self.tells_apart(step, h.max(gap), scale);
            return told.unwrap_or_else(|| self.degenerate(step, gap, scale));
        }
        if h_small <= scale.vanishing {
            let [_, _, c] = smaller;
            if c.abs() > scale.tolerance {
                return self.singular(step, c.abs(), scale);
            }
            return self.trig_at_edge(step, larger, scale);
        }
        let ([a1, b1, c1], [a2, b2, c2]) = ([a1 / h1, b1 / h1, c1 / h1], [a2 / h2, b2 / h2, c2 / h2]);
        let determinant = a1 * b2 - a2 * b1;
        if determinant.abs() <= S::from_f64(PARALLEL) * S::SQRT_EPSILON {
            return self.trig_at_edge(step, larger, scale);
        }
        let cosine = (c1 * b2 - c2 * b1) / determinant;
        let sine = (a1 * c2 - a2 * c1) / determinant;
        let length = size(cosine, sine);
        let off = (length - S::ONE).abs();
        // What the two rows say between them that the larger one alone doesn't.
        let rest = h_small * determinant.abs();
        // What small errors of the right-hand sides can make of cosine and sine.
        if off > self.spare(scale) / rest {
            return self.unreachable(step, off * h, h, scale);
        }
        if off > S::from_f64(UNRELIABLE) && rest <= scale.tolerance && rest < S::from_f64(WEAK) * h {
            return self.trig_at_edge(step, larger, scale);
        }
        if length <= S::ZERO {
            return self.degenerate(step, gap, scale);
        }
        let (cosine, sine) = (cosine / length, sine / length);
        let change = gauss_newton(first, second, cosine, sine);
        if h <= scale.tolerance {
            let root = sine.atan2(cosine) + change;
            let apart = self.edges.are_told_apart_by(step);
            if h.max(gap) <= indifferent::<S>() * scale.size && !apart {
                self.mark_free(step);
                let value = self.wanted_of(step).unwrap_or(root);
                return self.free(Free::any(step, Some(value), self.accepted));
            }
            // Rounding of the right-hand sides, over the size of the rows.
            let uncertainty = (scale.vanishing / h).min(S::PI);
            return self.free(Free::about(step, root, uncertainty, self.accepted));
        }
        let (sin, cos) = change.sin_cos();
        Roots::angle([sine * cos + cosine * sin, cosine * cos - sine * sin])
    }

    /// What a step may be out of its domain: where steps before it had next to nothing to go by, much more than a rounding error's
    /// root. What comes of it is brought to the target, or dropped.
    fn spare(&self, scale: &Scale<S>) -> S {
        if self.vague_steps == 0 { scale.tolerance } else { hopeless::<S>() * scale.size }
    }

    /// [`Search::unreachable`] for a step whose scale isn't at hand.
    pub(super) fn unreachable_by(&mut self, step: Step, excess: S, h: S) -> Roots<S> {
        let scale = self.begin(step);
        self.unreachable(step, excess, h, &scale)
    }

    /// `excess` is in the dimension of the equation, whose coefficients have size `h`.
    fn unreachable(&mut self, step: Step, excess: S, h: S, scale: &Scale<S>) -> Roots<S> {
        let (excess, miss) =
            if step.excess_is_length() { (excess, excess / scale.size) } else { (excess / h, excess / h) };
        self.fail_step(step, miss, IkError::Unreachable { step, excess })
    }
}

/// The length of (a, b). Plain squares: numbers of robots are nowhere near overflow, and what underflows vanishes
/// beside the scale of the equation anyway.
fn size<S: Float>(a: S, b: S) -> S {
    (a * a + b * b).sqrt()
}

/// The angles whose cosine and sine are (a c ∓ b r, b c ± a r) times `factor`, in this order: a sin - b cos is ± r.
#[inline]
pub(super) fn both<S: Float>(a: S, b: S, c: S, r: S, factor: S) -> Roots<S> {
    let (along, across) = (a * c * factor, b * c * factor);
    let (turned, back) = (b * r * factor, a * r * factor);
    Roots::angles([across + back, along - turned], [across - back, along + turned], b == S::ZERO)
}

/// The change of angle that brings both rows nearest to their right-hand sides, from an angle given by cosine and sine.
fn gauss_newton<S: Float>(first: [S; 3], second: [S; 3], cosine: S, sine: S) -> S {
    let (mut numerator, mut denominator) = (S::ZERO, S::ZERO);
    for [a, b, c] in [first, second] {
        let slope = b * cosine - a * sine;
        numerator += slope * (c - (a * cosine + b * sine));
        denominator += slope * slope;
    }
    let change = numerator / denominator;
    if change.is_finite() { change } else { S::ZERO }
}
