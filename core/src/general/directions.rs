//! Directions in which what is prescribed stays, to first order.

use super::continuum::{dot, moved, square};

/// Directions of length 1, across each other.
#[derive(Clone, Copy)]
pub(super) struct Directions<const K: usize> {
    pub(super) list: [[f64; K]; K],
    pub(super) count: usize,
}

impl<const K: usize> Directions<K> {
    fn as_slice(&self) -> &[[f64; K]] {
        self.list.get(..self.count).unwrap_or(&self.list)
    }

    /// The part of a vector that is along them.
    pub(super) fn part(&self, vector: &[f64; K]) -> [f64; K] {
        self.as_slice().iter().fold([0.0; K], |sum, own| moved(&sum, own, dot(vector, own)))
    }

    fn push(&mut self, vector: &[f64; K]) {
        let across = moved(vector, &self.part(vector), -1.0);
        let length = libm::sqrt(dot(&across, &across));
        if let Some(slot) = self.list.get_mut(self.count) {
            *slot = across.map(|part| part / length);
            self.count += 1;
        }
    }
}

/// The combinations of columns that are no longer than this, by elimination with the greatest pivot each time.
pub(super) fn null_space<const K: usize>(columns: &[[f64; 6]; K], least: f64) -> Directions<K> {
    // Column, and the combination of the given ones that it is.
    let mut open: [([f64; 6], [f64; K]); K] = [([0.0; 6], [0.0; K]); K];
    for (index, (slot, column)) in open.iter_mut().zip(columns).enumerate() {
        slot.0 = *column;
        if let Some(entry) = slot.1.get_mut(index) {
            *entry = 1.0;
        }
    }
    let mut directions = Directions { list: [[0.0; K]; K], count: 0 };
    let mut open = open.as_mut_slice();
    loop {
        let [first, others @ ..] = open else { return directions };
        for other in others.iter_mut() {
            if square(&other.0) > square(&first.0) {
                core::mem::swap(first, other);
            }
        }
        let size = square(&first.0);
        if size <= least * least {
            directions.push(&first.1);
        } else {
            for (column, combination) in others.iter_mut() {
                let share = dot(column, &first.0) / size;
                *column = moved(column, &first.0, -share);
                *combination = moved(combination, &first.1, -share);
            }
        }
        open = others;
    }
}
