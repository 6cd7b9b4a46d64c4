//! Equations in one unknown and its square.

use super::{DOUBLE_ROOT, Roots, Scale, Search};
use crate::{Float, IkError, Step};

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The x (m, or rad) with a x = c.
    pub fn linear(&mut self, step: Step, a: S, c: S) -> Roots<S> {
        let scale = self.begin(step);
        self.solve_linear(step, a * self.unit(step), c, &scale)
    }

    /// The x (m, or rad) with a x² + b x + c = 0: two, or one at the edge of the domain or where a vanishes. Of two, that
    /// with the positive square root, 2 a x + b > 0, comes first.
    ///
    /// The root of greater size is computed without a difference, the other from the product of the two \[Press et al.,
    /// Numerical Recipes, §5.6\]; the discriminant as a product of sum and difference of b/2 and sqrt(a c).
    pub fn quadratic(&mut self, step: Step, a: S, b: S, c: S) -> Roots<S> {
        let scale = self.begin(step);
        self.doubtful = true;
        let signed = |roots: Roots<S>, plus: bool| {
            let roots = roots.signed(step.sign_bit());
            if plus { roots } else { roots.negative() }
        };
        // In units of the reach: every term has the dimension and the size of the equation then.
        let unit = self.unit(step);
        let (a, half, c) = (a * unit * unit, b * unit / S::TWO, c);
        if !(a.is_finite() && half.is_finite() && c.is_finite()) {
            return self.not_finite(step);
        }
        if a.abs() <= scale.vanishing {
            let root = self.solve_linear(step, S::TWO * half, -c, &scale);
            return signed(root, half > S::ZERO);
        }
        let mean = a.abs().sqrt() * c.abs().sqrt();
        let size = half.abs();
        let one_sign = (a > S::ZERO) == (c > S::ZERO);
        // How far the equation is from a double root, in its own dimension: (half² - a c) / |a|.
        let inside =
            if one_sign { (size - mean) * (size + mean) } else { size * size + mean * mean } / a.abs();
        if inside < -scale.tolerance {
            let excess = (mean - size) / a.abs() * unit;
            return self.fail_step(step, -inside / scale.size, IkError::Unreachable { step, excess });
        }
        if inside <= S::from_f64(DOUBLE_ROOT) * S::EPSILON * scale.size.max(size * size / a.abs()) {
            return signed(Roots::value(-half / a * unit), true);
        }
        let root = (inside * a.abs()).sqrt();
        let greater = if half < S::ZERO { size + root } else { -(size + root) };
        let (far, near) = (greater / a * unit, c / greater * unit);
        // The far root has the square root's sign of -b.
        let (first, second) = if half < S::ZERO { (far, near) } else { (near, far) };
        match (first.is_finite(), second.is_finite()) {
            (true, true) => signed(Roots::values(first, second), true),
            (true, false) => signed(Roots::value(first), true),
            (false, true) => signed(Roots::value(second), false),
            (false, false) => self.not_finite(step),
        }
    }

    /// `a` is in the dimension of the equation, for an unknown in units of the reach.
    fn solve_linear(&mut self, step: Step, a: S, c: S, scale: &Scale<S>) -> Roots<S> {
        if !(a.is_finite() && c.is_finite()) {
            return self.not_finite(step);
        }
        if a.abs() <= scale.vanishing {
            return self.degenerate(step, c.abs(), scale);
        }
        let root = c / a * self.unit(step);
        if root.is_finite() { Roots::value(root) } else { self.not_finite(step) }
    }

    /// The size of the unknown: the reach (m), or 1 rad.
    fn unit(&self, step: Step) -> S {
        if step.prismatic { self.reach } else { S::ONE }
    }
}
