//! Steps at the edge of their domain, where two roots are one up to rounding, and later steps that tell them apart.
//!
//! A root at the edge is known to the square root of a rounding error only. As a rule the two then lead to the same joint
//! values, and the edge itself is taken for both. Where two links of one length lie on each other they don't: how far the point
//! behind them is from the axis before them is known to the last digits, and its direction is what turns the links; it is
//! another for either root, by half a turn. In the step for that turn one side of the equations vanishes and the other does not.

use super::{Roots, Scale, Search};
use crate::branch::bit_of;
use crate::{Float, IkError, Step};

/// Two roots are taken at this many times the distance (reaches) that a later step has found between them, to either side: the
/// lengths that they turn are less than the reach. Their places need not be known, only on which side of the edge they are.
const APART: f64 = 8.0;

/// The steps at the edge of their domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edges<S> {
    /// Bit i is set where step i is there, as long as the root at the edge is followed.
    at: u32,
    /// Bit i is set where a later step tells the roots of step i apart.
    parted: u32,
    /// Bit i is set where step i has told roots of steps before it apart, since the first of them was at its edge.
    by: u32,
    /// By how much (reaches), at most.
    distance: S,
}

impl<S: Float> Edges<S> {
    pub(super) const NONE: Self = Self { at: 0, parted: 0, by: 0, distance: S::ZERO };

    /// Whether a step has told roots of steps before it apart: its equations are small, but no rounding.
    pub(super) fn are_told_apart_by(&self, step: Step) -> bool {
        self.by & step.bit() != 0
    }
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// What is left of the roots of a step at the edge of its domain: that at the edge, then both where a later step has told
    /// them apart. By value: roots whose address is given away are kept in memory.
    #[cold]
    #[inline(never)]
    pub(super) fn left_at_edge(&mut self, step: u8, roots: Roots<S>) -> Roots<S> {
        let bit = bit_of(step);
        if !roots.is_empty() {
            if self.edges.at == 0 {
                self.edges = Edges::NONE;
            }
            self.edges.at |= bit;
            self.edges.parted &= !bit;
            return roots;
        }
        self.edges.at &= !bit;
        if self.edges.parted & bit == 0 {
            return roots;
        }
        roots.beside_edge(self.edges.distance * S::from_f64(APART))
    }

    /// Where one side of a step's equations vanishes and the other, of this size, does not, though no more is missing than an
    /// edge leaves: no root, and those of the steps at the edge are told apart.
    pub(super) fn tells_apart(&mut self, step: Step, size: S, scale: &Scale<S>) -> Option<Roots<S>> {
        if self.edges.at == 0 || size <= scale.vanishing || size > scale.tolerance {
            return None;
        }
        self.edges.parted |= self.edges.at;
        self.edges.by |= step.bit();
        self.edges.distance = self.edges.distance.max(size / scale.size);
        Some(self.fail_step(
            step,
            size / scale.size,
            IkError::Singular { joint: step.first_row(), gap: size },
        ))
    }
}

#[cfg(test)]
mod tests {
    use crate::{Measure, Search, Solutions, Step};
    use core::f64::consts::PI;

    const THETA2: Step = Step::new(0, 0b10, false, Measure::Area);
    const THETA1: Step = Step::new(1, 0b1, false, Measure::Length);

    /// Two links of 0.4 m.
    fn solutions(x: f64, y: f64) -> Solutions<2> {
        let mut search = Search::<2>::new(0.8, &[]);
        let mut roots = search.trig(THETA2, 0.32, 0.0, x * x + y * y - 0.32);
        while let Some((theta2, s2, c2)) = search.next_angle(&mut roots) {
            let (k1, k2) = (0.4 + 0.4 * c2, 0.4 * s2);
            let mut roots = search.trig_pair(THETA1, [k1, -k2, x], [k2, k1, y]);
            while let Some((theta1, _, _)) = search.next_angle(&mut roots) {
                search.accept([theta1, theta2], 0.0, 0.0);
            }
        }
        search.finish().unwrap()
    }

    #[test]
    fn links_that_nearly_lie_on_each_other_go_either_way() {
        for distance in [1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 2e-13] {
            let found = solutions(0.6 * distance, 0.8 * distance);
            assert_eq!(found.len(), 2, "{distance:e}");
            let along = libm::atan2(0.8, 0.6);
            for (solution, side) in found.iter().zip([1.0, -1.0]) {
                let [theta1, theta2] = solution.q;
                assert!((theta1 + theta2 / 2.0 - along).sin().abs() < 1e-3, "{distance:e}: {solution:?}");
                assert!(side * theta2.sin() > 0.0 && theta2.abs() > PI - 1e-6, "{distance:e}: {solution:?}");
                assert_eq!(solution.free, None);
            }
        }
    }

    #[test]
    fn within_rounding_of_the_axis_the_first_joint_is_free() {
        for distance in [0.0, 1e-16] {
            let found = solutions(distance, 0.0);
            assert_eq!(found.len(), 1);
            assert_eq!((found[0].free, found[0].q[1].abs()), (Some(0), PI));
        }
    }
}
