//! Roots of an equation in one unknown, and their order.

use super::Search;
use crate::{Float, Step};

/// Roots of an equation in one unknown: one or two, none, or any value where the coefficients vanish. The loop over them
/// is [`Search::next`] or [`Search::next_angle`].
///
/// Plain numbers, so that they stay in registers; what a free step has tried is kept by the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roots<S = f64> {
    form: Form,
    /// Which are left: [`BOTH`], [`PLUS`], [`MINUS`] or none.
    left: u8,
    first: Root<S>,
    second: Root<S>,
    /// Whether the second one is the first one's negative: then so is its angle.
    opposite: bool,
    /// The bit that tells the two roots apart in a [`Branch`](crate::Branch); 0 of a step with one.
    bit: u32,
    /// The angle of the root before.
    angle: S,
}

/// Two roots, of which that with the positive square root comes first.
const BOTH: u8 = 0b010;

/// That with the negative one.
const MINUS: u8 = 0b001;

/// That with the positive one, or a single one.
const PLUS: u8 = 0b100;

/// One root: a value (m, rad) with 0 beside it, or an angle by its sine and cosine, the form in which equations need it.
type Root<S> = [S; 2];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Values,
    Angles,
    /// One angle, of two that are one up to rounding; the index of the step.
    Edge(u8),
    /// Any value; the index of the step.
    Free(u8),
}

impl<S: Float> Roots<S> {
    /// No root.
    pub const NONE: Self = Self {
        form: Form::Angles,
        left: 0,
        first: [S::ZERO; 2],
        second: [S::ZERO; 2],
        opposite: false,
        bit: 0,
        angle: S::ZERO,
    };

    /// One angle by sine and cosine.
    #[inline]
    pub(super) const fn angle(first: [S; 2]) -> Self {
        Self { left: PLUS, first, ..Self::NONE }
    }

    /// One angle by sine and cosine, of two that are one up to rounding: the `+` root is `apart` (rad) from it at most, the other
    /// as far on the other side.
    pub(super) const fn edge(step: Step, first: [S; 2], apart: S) -> Self {
        Self { form: Form::Edge(step.index), second: [apart, S::ZERO], ..Self::angle(first) }
    }

    /// Two angles by sine and cosine, the `+` root first; `opposite` where they differ in the sign of the sine alone.
    #[inline]
    pub(super) const fn angles(first: [S; 2], second: [S; 2], opposite: bool) -> Self {
        Self { left: BOTH, first, second, opposite, ..Self::NONE }
    }

    /// One value (m, rad).
    pub(super) const fn value(value: S) -> Self {
        Self { form: Form::Values, left: PLUS, first: [value, S::ZERO], ..Self::NONE }
    }

    /// Two values (m, rad), the `+` root first.
    pub(super) const fn values(first: S, second: S) -> Self {
        Self {
            form: Form::Values,
            left: BOTH,
            first: [first, S::ZERO],
            second: [second, S::ZERO],
            ..Self::NONE
        }
    }

    /// Any value, or one that is not known well; the first is `value`. The search knows the others.
    pub(super) const fn any(step: Step, value: S) -> Self {
        Self { form: Form::Free(step.index), left: PLUS, first: [value, S::ZERO], ..Self::NONE }
    }

    /// The same of a step whose roots have signs, which this bit stands for; `+` comes first.
    #[inline]
    pub(super) const fn signed(self, bit: u32) -> Self {
        Self { bit, ..self }
    }

    /// The same of a single one that is the `-` root.
    pub(super) const fn negative(self) -> Self {
        Self { left: MINUS, ..self }
    }

    /// Of a root at the edge that has been taken, the two beside it, at this distance (rad) at most.
    pub(super) fn beside_edge(&self, most: S) -> Self {
        let [apart, _] = self.first;
        let apart = apart.max(-most).min(most);
        let [first, second] = [apart, -apart].map(|side| (self.angle + side).sin_cos().into());
        Self::angles(first, second, false).signed(self.bit)
    }

    /// How many roots there are; any value counts as one.
    pub fn len(&self) -> usize {
        match self.left {
            0 => 0,
            BOTH => 2,
            _ => 1,
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.left == 0
    }

    /// The same roots, out of the memory that a function returned them in: what is written to there cannot be kept in
    /// registers.
    #[inline]
    pub(super) const fn unpacked(self) -> Self {
        let Self { form, left, first: [a, b], second: [c, d], opposite, bit, angle } = self;
        Self { form, left, first: [a, b], second: [c, d], opposite, bit, angle }
    }

    #[inline]
    fn take(&mut self) -> Option<Root<S>> {
        if self.left == 0 {
            return None;
        }
        // Of both, the other is left.
        self.left = (self.left >> 1) & MINUS;
        let root = self.first;
        self.first = self.second;
        Some(root)
    }

    /// A branch that was taken, as it is with the next root.
    #[inline]
    const fn branch(&self, taken: u32) -> u32 {
        if self.left == MINUS { taken | self.bit } else { taken & !self.bit }
    }

    /// A root as a value.
    fn value_of(&self, [first, second]: Root<S>) -> S {
        if matches!(self.form, Form::Angles | Form::Edge(_)) { first.atan2(second) } else { first }
    }
}

/// The roots (rad or m); of any value, the first to be tried.
impl<S: Float> IntoIterator for Roots<S> {
    type Item = S;
    type IntoIter = core::iter::Take<core::array::IntoIter<S, 2>>;
    fn into_iter(self) -> Self::IntoIter {
        [self.first, self.second].map(|root| self.value_of(root)).into_iter().take(self.len())
    }
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The next root (rad or m) to go on with. A step that is free gives another value as long as none led to a
    /// solution.
    #[inline]
    pub fn next(&mut self, roots: &mut Roots<S>) -> Option<S> {
        if let Form::Free(step) = roots.form {
            self.branch = roots.branch(self.branch);
            return self.next_value(step);
        }
        self.branch = roots.branch(self.branch);
        let root = roots.take()?;
        Some(roots.value_of(root))
    }

    /// The same for an angle (rad), with its sine and cosine.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call would put the roots into memory")]
    pub fn next_angle(&mut self, roots: &mut Roots<S>) -> Option<(S, S, S)> {
        if let Form::Edge(step) = roots.form {
            *roots = self.left_at_edge(step, *roots).unpacked();
        }
        match roots.form {
            Form::Angles | Form::Edge(_) => {
                let second = roots.left == MINUS;
                self.branch = roots.branch(self.branch);
                let [sin, cos] = roots.take()?;
                let angle = if roots.opposite && second { -roots.angle } else { sin.atan2(cos) };
                roots.angle = angle;
                Some((angle, sin, cos))
            }
            Form::Values => {
                self.branch = roots.branch(self.branch);
                let [angle, _] = roots.take()?;
                Some(with_sine(angle))
            }
            Form::Free(step) => {
                self.branch = roots.branch(self.branch);
                let angle = self.next_value(step)?;
                Some(with_sine(angle))
            }
        }
    }
}

/// An angle (rad) with its sine and cosine.
#[cold]
#[inline(never)]
fn with_sine<S: Float>(angle: S) -> (S, S, S) {
    let (sin, cos) = angle.sin_cos();
    (angle, sin, cos)
}
