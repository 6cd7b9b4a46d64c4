//! Lists of roots, and of places that may be roots.

use super::waves::MAX_ROOTS;
use crate::Float;

/// How many clusters of candidates are told apart.
const MAX_CLUSTERS: usize = 8;
/// Clusters that are nearer to each other (rad) are one.
const ADJACENT: f64 = 1e-9;

/// Roots of a polynomial, and candidates that may be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Roots {
    pub(super) certain: List,
    /// Of places where values are within what is uncertain of them.
    pub(super) possible: List,
    /// Places where there should be none, but nearly are.
    pub(super) unlikely: List,
    clusters: [[f64; 2]; MAX_CLUSTERS],
    clusters_len: usize,
    /// Whether more came than there is room for.
    pub(super) overflown: bool,
    /// How near the polynomial was seen to come to 0.
    pub(super) least: f64,
    /// How many cells were looked at.
    pub(super) cells: u32,
}

/// Angles (rad).
#[derive(Debug, Clone, Copy)]
pub(super) struct List {
    list: [f64; MAX_ROOTS],
    len: usize,
}

impl List {
    pub(super) const EMPTY: Self = Self { list: [0.0; MAX_ROOTS], len: 0 };

    pub(super) fn as_slice(&self) -> &[f64] {
        self.list.get(..self.len).unwrap_or(&self.list)
    }

    /// Whether there was room.
    pub(super) fn push(&mut self, root: f64) -> bool {
        let Some(place) = self.list.get_mut(self.len) else { return false };
        *place = root;
        self.len += 1;
        true
    }

    /// Only those that may stay.
    pub(super) fn retain(&mut self, stays: impl Fn(f64) -> bool) {
        let mut kept = Self::EMPTY;
        for root in self.as_slice() {
            if stays(*root) {
                kept.push(*root);
            }
        }
        *self = kept;
    }
}

impl Roots {
    pub(super) const NONE: Self = Self {
        certain: List::EMPTY,
        possible: List::EMPTY,
        unlikely: List::EMPTY,
        clusters: [[0.0; 2]; MAX_CLUSTERS],
        clusters_len: 0,
        overflown: false,
        least: f64::INFINITY,
        cells: 0,
    };

    /// All that may be roots.
    pub(crate) fn candidates(&self) -> impl Iterator<Item = f64> + Clone {
        self.certain.as_slice().iter().chain(self.possible.as_slice()).copied()
    }

    /// Places where there should be none, but nearly are.
    pub(crate) fn unlikely(&self) -> &[f64] {
        self.unlikely.as_slice()
    }

    /// Whether some may be double, or are missing.
    pub(crate) fn is_doubtful(&self) -> bool {
        self.overflown || !self.clusters().is_empty()
    }

    /// Where values are within what is uncertain of them.
    pub(super) fn clusters(&self) -> &[[f64; 2]] {
        self.clusters.get(..self.clusters_len).unwrap_or(&self.clusters)
    }

    pub(super) fn push(&mut self, root: f64) {
        self.overflown |= !self.certain.push(root);
    }

    /// A candidate between places; those that touch are one cluster.
    pub(super) fn perhaps(&mut self, root: f64, [low, high]: [f64; 2]) {
        self.possible.push(root);
        let last = self.clusters_len.checked_sub(1).and_then(|last| self.clusters.get_mut(last));
        if let Some([_, end]) = last
            && low - *end <= ADJACENT
        {
            *end = Float::max(*end, high);
        } else if let Some(place) = self.clusters.get_mut(self.clusters_len) {
            *place = [low, high];
            self.clusters_len += 1;
        } else {
            self.overflown = true;
        }
    }
}
