//! Roots of an equation in one unknown, and their order.

use super::Search;
use super::free::Free;
use crate::{Float, Step};

/// Roots of an equation in one unknown: one or two, none, or any value where the coefficients vanish. The loop over them
/// is [`Search::next`] or [`Search::next_angle`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roots<S = f64> {
    first: Option<Root<S>>,
    second: Option<Root<S>>,
    /// How any value is chosen.
    free: Option<Free<S>>,
}

/// One root.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Root<S> {
    /// m, or rad
    Value(S),
    /// An angle by its sine and cosine, the form in which equations need it.
    Angle { sin: S, cos: S },
}

impl<S: Float> Root<S> {
    fn value(self) -> S {
        match self {
            Self::Value(value) => value,
            Self::Angle { sin, cos } => sin.atan2(cos),
        }
    }

    #[inline]
    fn angle(self) -> (S, S, S) {
        match self {
            Self::Angle { sin, cos } => (sin.atan2(cos), sin, cos),
            Self::Value(angle) => {
                let (sin, cos) = angle.sin_cos();
                (angle, sin, cos)
            }
        }
    }
}

impl<S: Float> Roots<S> {
    /// No root.
    pub const NONE: Self = Self { first: None, second: None, free: None };

    #[inline]
    pub(super) const fn one(root: Root<S>) -> Self {
        Self { first: Some(root), second: None, free: None }
    }

    #[inline]
    pub(super) const fn two(first: Root<S>, second: Root<S>) -> Self {
        Self { first: Some(first), second: Some(second), free: None }
    }

    /// Any value, of a step whose coefficients vanish; `accepted` candidates were taken before.
    pub(super) fn any(step: Step, wanted: Option<S>, accepted: u32) -> Self {
        Self { first: None, second: None, free: Some(Free::any(step, wanted, accepted)) }
    }

    /// A root (rad or m) that may be off by as much as `uncertainty`.
    pub(super) fn about(step: Step, root: S, uncertainty: S, accepted: u32) -> Self {
        Self { first: None, second: None, free: Some(Free::about(step, root, uncertainty, accepted)) }
    }

    /// How many roots there are; any value counts as one.
    pub fn len(&self) -> usize {
        let roots = usize::from(self.first.is_some()) + usize::from(self.second.is_some());
        roots + usize::from(self.free.is_some())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    #[inline]
    fn take(&mut self) -> Option<Root<S>> {
        let root = self.first;
        self.first = self.second.take();
        root
    }
}

/// The roots (rad or m); of any value, the first to be tried.
impl<S: Float> IntoIterator for Roots<S> {
    type Item = S;
    type IntoIter = core::iter::Flatten<core::array::IntoIter<Option<S>, 3>>;
    fn into_iter(self) -> Self::IntoIter {
        let [first, second] = [self.first, self.second].map(|root| root.map(Root::value));
        [first, second, self.free.map(|free| free.value)].into_iter().flatten()
    }
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The next root (rad or m) to go on with. A step that is free gives another value as long as none led to a
    /// solution.
    #[inline]
    pub fn next(&mut self, roots: &mut Roots<S>) -> Option<S> {
        if let Some(free) = roots.free {
            let (value, free) = self.next_value(free);
            roots.free = Some(free);
            return value;
        }
        roots.take().map(Root::value)
    }

    /// The same for an angle (rad), with its sine and cosine.
    #[inline]
    pub fn next_angle(&mut self, roots: &mut Roots<S>) -> Option<(S, S, S)> {
        if let Some(free) = roots.free {
            let (value, free) = self.next_value(free);
            roots.free = Some(free);
            return value.map(|value| Root::Value(value).angle());
        }
        roots.take().map(Root::angle)
    }
}
