//! Equations of the second degree in the cosine and sine of one angle: quartics in the tangent of its half.

use super::{Roots, Search, VANISHING};
use crate::general::Waves;
use crate::{Float, IkError, Step};

/// Four roots, and what two that nearly meet add.
const MAX_ROOTS: usize = 8;

/// Roots that are nearer to each other than this (rad) may lead to one solution.
const APART: f64 = 1e-5;

/// Roots of an equation of the fourth degree, or any value where its coefficients vanish. The loop over them is
/// [`Search::next_of_quartic`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuarticRoots<S = f64> {
    list: [S; MAX_ROOTS],
    len: usize,
    next: usize,
    /// Bit i is set where root i is a `-` root.
    minus: u32,
    /// The bit that tells them apart in a [`Branch`](crate::Branch).
    bit: u32,
    /// Where the coefficients vanish.
    any: Roots<S>,
}

impl<S: Float> QuarticRoots<S> {
    const fn of(any: Roots<S>) -> Self {
        Self { list: [S::ZERO; MAX_ROOTS], len: 0, next: 0, minus: 0, bit: 0, any }
    }

    fn push(&mut self, root: f64, minus: bool) {
        if let Some(place) = self.list.get_mut(self.len) {
            *place = S::from_f64(root);
            self.minus |= u32::from(minus) << self.len;
            self.len += 1;
        }
    }

    /// How many roots there are; any value counts as one.
    pub fn len(&self) -> usize {
        if self.len == 0 { self.any.len() } else { self.len }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The angles x (rad) with (k1 + l1 cos x + m1 sin x)² + (k2 + l2 cos x + m2 sin x)² = n²: four, two or none, and where two
    /// nearly meet that place too. Where the left side rises with x is the `+` root.
    ///
    /// Computed in f64, by bounds on Taylor's expansion and Newton's method.
    pub fn quartic(&mut self, step: Step, forms: [[S; 3]; 2], right: S) -> QuarticRoots<S> {
        let scale = self.begin(step);
        let all = || forms.as_flattened().iter().chain([&right]);
        if !all().all(|x| x.is_finite()) {
            return QuarticRoots::of(self.not_finite(step));
        }
        let size = all().fold(S::ZERO, |size, x| size.max(x.abs()));
        if size <= scale.vanishing {
            return QuarticRoots::of(self.degenerate(step, size, &scale));
        }
        // c + a1 cos x + b1 sin x + a2 cos 2x + b2 sin 2x
        let n = (right / size).to_f64();
        let [mut c, mut a1, mut b1, mut a2, mut b2] = [-n * n, 0.0, 0.0, 0.0, 0.0];
        for form in forms {
            let [k, l, m] = form.map(|x| (x / size).to_f64());
            c += k * k + f64::midpoint(l * l, m * m);
            a1 += 2.0 * k * l;
            b1 += 2.0 * k * m;
            a2 += (l - m) * (l + m) / 2.0;
            b2 += l * m;
        }
        let varying = [a1, b1, a2, b2].into_iter().fold(0.0, |varying, x| varying.max(libm::fabs(x)));
        if varying <= VANISHING * f64::EPSILON {
            return QuarticRoots::of(self.degenerate(step, S::from_f64(libm::fabs(c)) * size, &scale));
        }
        let largest = varying.max(libm::fabs(c));
        let [c, a1, b1, a2, b2] = [c, a1, b1, a2, b2].map(|x| x / largest);
        let waves = Waves::quadratic([[c, 0.0], [a1, -b1], [a2, -b2]]);
        let found = waves.roots();
        let mut roots = QuarticRoots { bit: step.sign_bit(), ..QuarticRoots::of(Roots::NONE) };
        for root in found.candidates().chain(found.unlikely().iter().copied()) {
            let (root, slope) = waves.refined(root);
            roots.push(root, slope < 0.0);
        }
        let near = |(place, root): (usize, f64)| {
            let mut others = found.candidates().skip(place + 1);
            others.any(|other| libm::fabs(libm::sin((root - other) / 2.0)) < APART)
        };
        self.doubtful |= found.is_doubtful() || !found.unlikely().is_empty();
        self.doubtful |= found.candidates().enumerate().any(near);
        if roots.is_empty() {
            let excess = S::from_f64(waves.miss(&found));
            let _ = self.fail_step(step, excess, IkError::Unreachable { step, excess });
        }
        roots
    }

    /// The next root (rad) to go on with, with its sine and cosine.
    pub fn next_of_quartic(&mut self, roots: &mut QuarticRoots<S>) -> Option<(S, S, S)> {
        if roots.len == 0 {
            return self.next_angle(&mut roots.any);
        }
        let angle = *roots.list.get(..roots.len)?.get(roots.next)?;
        let minus = roots.minus >> roots.next & 1 == 1;
        self.branch = if minus { self.branch | roots.bit } else { self.branch & !roots.bit };
        roots.next += 1;
        let (sin, cos) = angle.sin_cos();
        Some((sin.atan2(cos), sin, cos))
    }
}
