//! Equations in the cosine and sine of one angle.

use super::{DOUBLE_ROOT, Roots, Scale, Search};
use crate::{Float, IkError, Step};

/// Two rows whose directions differ by less than this many square roots of the machine epsilon (rad) are one row.
const PARALLEL: f64 = 1.0;

/// Where a cosine and sine are off the unit circle by more than this, one of their rows may be nothing but rounding.
const UNRELIABLE: f64 = 1e-3;

/// It is, if it has less than this share of the larger one's size. (Two small rows of one size still tell the angle,
/// however wrong that size: its rounding is the same in both.)
const WEAK: f64 = 0.125;

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The angles x (rad) with a cos x + b sin x = c: two, or one at the edge of the domain.
    ///
    /// With (a, b) = h (cos phi, sin phi) this is cos(x - phi) = c / h. The angle comes from sqrt((h - c)(h + c)) and c,
    /// which keeps its digits next to the edge, where an arc cosine would lose half of them.
    pub fn trig(&mut self, step: Step, a: S, b: S, c: S) -> Roots<S> {
        let scale = self.begin(step);
        self.solve_trig(step, [a, b, c], &scale)
    }

    fn solve_trig(&mut self, step: Step, [a, b, c]: [S; 3], scale: &Scale<S>) -> Roots<S> {
        let h = size(a, b);
        if !(h.is_finite() && c.is_finite()) {
            return self.not_finite(step);
        }
        if h <= scale.vanishing {
            return self.degenerate(step, c.abs(), scale);
        }
        let excess = c.abs() - h;
        if excess > scale.tolerance {
            return self.unreachable(step, excess, h, scale);
        }
        let phi = b.atan2(a);
        if excess >= -(S::from_f64(DOUBLE_ROOT) * S::EPSILON * scale.size.max(h)) {
            return Roots::one(if c < S::ZERO { phi + S::PI } else { phi });
        }
        let half = ((h - c) * (h + c)).sqrt().atan2(c);
        Roots::two(phi + half, phi - half)
    }

    /// The angle x (rad) with a1 cos x + b1 sin x = c1 and a2 cos x + b2 sin x = c2.
    ///
    /// Cosine and sine come from the two rows as linear equations, each row divided by its size; then one step of
    /// Gauss-Newton on the rows as they are gives the larger row, which knows the angle better, its greater weight.
    /// Rows that are parallel, or of which one vanishes, are solved as one row, which may have two roots.
    pub fn trig_pair(&mut self, step: Step, first: [S; 3], second: [S; 3]) -> Roots<S> {
        let scale = self.begin(step);
        let ([a1, b1, c1], [a2, b2, c2]) = (first, second);
        let (h1, h2) = (size(a1, b1), size(a2, b2));
        let gap = size(c1, c2);
        if !(h1.is_finite() && h2.is_finite() && gap.is_finite()) {
            return self.not_finite(step);
        }
        let (larger, h, smaller, h_small) =
            if h1 >= h2 { (first, h1, second, h2) } else { (second, h2, first, h1) };
        // Coefficients that are themselves the root of a rounding error (the sine of a wrist angle next to 0) are 0 if
        // the right-hand sides, which are known to the last digits, are.
        if h <= scale.vanishing || (h <= scale.tolerance && gap <= scale.vanishing) {
            return self.degenerate(step, gap, &scale);
        }
        if h_small <= scale.vanishing {
            let [_, _, c] = smaller;
            if c.abs() > scale.tolerance {
                return self.singular(step, c.abs(), &scale);
            }
            return self.solve_trig(step, larger, &scale);
        }
        let ([a1, b1, c1], [a2, b2, c2]) = ([a1 / h1, b1 / h1, c1 / h1], [a2 / h2, b2 / h2, c2 / h2]);
        let determinant = a1 * b2 - a2 * b1;
        if determinant.abs() <= S::from_f64(PARALLEL) * S::SQRT_EPSILON {
            return self.solve_trig(step, larger, &scale);
        }
        let cosine = (c1 * b2 - c2 * b1) / determinant;
        let sine = (a1 * c2 - a2 * c1) / determinant;
        let length = size(cosine, sine);
        let off = (length - S::ONE).abs();
        // What the two rows say between them that the larger one alone doesn't.
        let rest = h_small * determinant.abs();
        // What small errors of the right-hand sides can make of cosine and sine.
        if off > scale.tolerance / rest {
            return self.unreachable(step, off * h, h, &scale);
        }
        if off > S::from_f64(UNRELIABLE) && rest <= scale.tolerance && rest < S::from_f64(WEAK) * h {
            return self.solve_trig(step, larger, &scale);
        }
        if length <= S::ZERO {
            return self.degenerate(step, gap, &scale);
        }
        let angle = sine.atan2(cosine);
        Roots::one(angle + gauss_newton(first, second, cosine / length, sine / length))
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
