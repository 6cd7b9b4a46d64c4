//! Equations in the cosine and sine of one angle.

use super::{DOUBLE_ROOT, Roots, Scale, Search};
use crate::{Float, IkError, Step};

/// Two rows whose directions differ by less than this many square roots of the machine epsilon (rad) are one row.
const PARALLEL: f64 = 1.0;

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
        let h = a.hypot(b);
        if !(h.is_finite() && c.is_finite()) {
            return self.not_finite(step);
        }
        let size = c.abs();
        if h <= scale.vanishing {
            return self.degenerate(step, size, scale);
        }
        let excess = size - h;
        if excess > scale.tolerance {
            let relative = excess / h;
            let reported = if step.excess_is_length() {
                excess
            } else {
                relative
            };
            return self.fail_step(
                step,
                relative,
                IkError::Unreachable {
                    step,
                    excess: reported,
                },
            );
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
        let (h1, h2) = (a1.hypot(b1), a2.hypot(b2));
        let gap = c1.hypot(c2);
        if !(h1.is_finite() && h2.is_finite() && gap.is_finite()) {
            return self.not_finite(step);
        }
        let h = h1.max(h2);
        if h <= scale.vanishing {
            return self.degenerate(step, gap, &scale);
        }
        // Coefficients that are themselves the root of a rounding error (the sine of a wrist angle next to 0) are 0 if
        // the other side, which is known to the last digits, is.
        if h <= scale.tolerance && gap <= scale.vanishing {
            return self.degenerate(step, gap, &scale);
        }
        let (larger, smaller) = if h1 >= h2 {
            (first, second)
        } else {
            (second, first)
        };
        if h1.min(h2) <= scale.vanishing {
            let [_, _, c] = smaller;
            if c.abs() > scale.tolerance {
                let error = IkError::Singular {
                    joint: step.first_row(),
                    gap: c.abs(),
                };
                return self.fail_step(step, c.abs() / scale.size, error);
            }
            return self.solve_trig(step, larger, &scale);
        }
        let ([a1, b1, c1], [a2, b2, c2]) =
            ([a1 / h1, b1 / h1, c1 / h1], [a2 / h2, b2 / h2, c2 / h2]);
        let determinant = a1 * b2 - a2 * b1;
        if determinant.abs() <= S::from_f64(PARALLEL) * S::SQRT_EPSILON {
            return self.solve_trig(step, larger, &scale);
        }
        let cosine = (c1 * b2 - c2 * b1) / determinant;
        let sine = (a1 * c2 - a2 * c1) / determinant;
        let length = cosine.hypot(sine);
        // How far cosine and sine may be from the unit circle: what errors of the right-hand sides make of them.
        let off = (length - S::ONE).abs();
        if off > scale.tolerance / (h1.min(h2) * determinant.abs()) {
            let excess = if step.excess_is_length() {
                off * h
            } else {
                off
            };
            return self.fail_step(step, off, IkError::Unreachable { step, excess });
        }
        if length <= S::ZERO {
            return self.degenerate(step, gap, &scale);
        }
        let angle = sine.atan2(cosine);
        Roots::one(angle + gauss_newton(first, second, cosine / length, sine / length))
    }
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
