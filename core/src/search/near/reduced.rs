//! The equations of a pose by five joints of six.

use super::UNKNOWNS;
use crate::Float;

/// Another joint leads where it goes so many times as far.
const AHEAD: f64 = 2.0;

/// The equations of a place by all joints but one.
pub(super) struct Reduced<S> {
    lead: usize,
    /// Changes of the unknowns but the leading one that make up for what is missing in their directions.
    pub(super) change: [S; UNKNOWNS],
    /// How much is missing in their directions (reaches, rad).
    pub(super) left: S,
    /// What is missing in the direction in which the other joints move nothing (reaches, rad).
    pub(super) missing: S,
    /// How that changes with the leading joint.
    pub(super) slope: S,
    /// How the unknowns change with the leading joint as the other directions are kept.
    pub(super) rates: [S; UNKNOWNS],
    /// That direction.
    pub(super) normal: [S; UNKNOWNS],
    /// The least length of a column in a direction of its own.
    pub(super) weakest: S,
}

impl<S: Float> Reduced<S> {
    /// By modified Gram-Schmidt.
    pub(super) fn new(
        columns: &[[S; UNKNOWNS]; UNKNOWNS],
        missing: &[S; UNKNOWNS],
        lead: usize,
        normal: Option<&[S; UNKNOWNS]>,
    ) -> Self {
        let mut units = *columns;
        // With the leading one last.
        units.swap(lead, UNKNOWNS - 1);
        let mut factor = [[S::ZERO; UNKNOWNS]; UNKNOWNS];
        let mut right = [S::ZERO; UNKNOWNS];
        let mut rest = *missing;
        let mut weakest = S::INFINITY;
        let mut left = S::ZERO;
        for k in 0..UNKNOWNS - 1 {
            let size = dot(&units[k], &units[k]).sqrt();
            weakest = if size < weakest { size } else { weakest };
            let unit = units[k].map(|x| x / size);
            units[k] = unit;
            factor[k][k] = size;
            for j in k + 1..UNKNOWNS {
                factor[k][j] = dot(&unit, &units[j]);
                subtract(&mut units[j], &unit, factor[k][j]);
            }
            right[k] = dot(&unit, &rest);
            subtract(&mut rest, &unit, right[k]);
            left += right[k] * right[k];
        }
        let direction = normal.map_or_else(|| farthest(&units), |normal| across(&units, *normal));
        let (mut change, mut rates) = ([S::ZERO; UNKNOWNS], [S::ZERO; UNKNOWNS]);
        rates[UNKNOWNS - 1] = S::ONE;
        for k in (0..UNKNOWNS - 1).rev() {
            let (mut value, mut rate) = (right[k], -factor[k][UNKNOWNS - 1]);
            for j in k + 1..UNKNOWNS - 1 {
                value -= factor[k][j] * change[j];
                rate -= factor[k][j] * rates[j];
            }
            change[k] = value / factor[k][k];
            rates[k] = rate / factor[k][k];
        }
        change.swap(lead, UNKNOWNS - 1);
        rates.swap(lead, UNKNOWNS - 1);
        Self {
            lead,
            change,
            left: left.sqrt(),
            missing: dot(&direction, missing),
            slope: -dot(&direction, &columns[lead]),
            rates,
            normal: direction,
            weakest,
        }
    }

    /// Which joint goes much farther than the one that leads.
    pub(super) fn ahead(&self) -> Option<usize> {
        let mut farthest = self.lead;
        for (k, rate) in self.rates.iter().enumerate() {
            if rate.abs() > self.rates[farthest].abs() {
                farthest = k;
            }
        }
        (farthest != self.lead && self.rates[farthest].abs() > S::from_f64(AHEAD)).then_some(farthest)
    }
}

/// The part that is across all unit vectors but the last of the axis that is farthest from them, in unit length.
fn farthest<S: Float>(units: &[[S; UNKNOWNS]; UNKNOWNS]) -> [S; UNKNOWNS] {
    let within = |axis: usize| {
        units.iter().take(UNKNOWNS - 1).fold(S::ZERO, |sum, unit| sum + unit[axis] * unit[axis])
    };
    let best = (0..UNKNOWNS).fold(0, |best, axis| if within(axis) < within(best) { axis } else { best });
    let mut axis = [S::ZERO; UNKNOWNS];
    axis[best] = S::ONE;
    across(units, axis)
}

/// The part of a direction that is across all unit vectors but the last, in unit length.
fn across<S: Float>(units: &[[S; UNKNOWNS]; UNKNOWNS], mut direction: [S; UNKNOWNS]) -> [S; UNKNOWNS] {
    // Twice, for the sake of rounding.
    for _ in 0..2 {
        for unit in units.iter().take(UNKNOWNS - 1) {
            let part = dot(unit, &direction);
            subtract(&mut direction, unit, part);
        }
        let size = dot(&direction, &direction).sqrt();
        direction = direction.map(|x| x / size);
    }
    direction
}

fn subtract<S: Float>(from: &mut [S; UNKNOWNS], what: &[S; UNKNOWNS], factor: S) {
    for (value, part) in from.iter_mut().zip(what) {
        *value -= factor * *part;
    }
}

fn dot<S: Float>(a: &[S; UNKNOWNS], b: &[S; UNKNOWNS]) -> S {
    a.iter().zip(b).fold(S::ZERO, |sum, (a, b)| sum + *a * *b)
}

#[cfg(test)]
mod tests {
    use super::{Reduced, dot};

    #[test]
    fn what_is_missing_across_five_columns_is_no_matter_of_theirs() {
        let columns: [[f64; 6]; 6] = core::array::from_fn(|c| {
            core::array::from_fn(|r| libm::sin((r * r * c + 3 * r + 5 * c * c + 1) as f64 * 1.3))
        });
        let missing = [0.3, -0.1, 0.2, 0.5, -0.7, 0.4];
        for lead in 0..6 {
            let reduced = Reduced::new(&columns, &missing, lead, None);
            for (k, column) in columns.iter().enumerate() {
                assert!(k == lead || dot(column, &reduced.normal).abs() < 1e-12);
            }
            assert!(reduced.change[lead] == 0.0 && reduced.rates[lead] == 1.0);
            // What the change leaves, and what the rates move, is along the normal.
            for (combined, along) in [(reduced.change, reduced.missing), (reduced.rates, reduced.slope)] {
                let what = if combined == reduced.change { missing } else { [0.0; 6] };
                let left: [f64; 6] = core::array::from_fn(|row| {
                    what[row] - columns.iter().zip(combined).map(|(column, x)| column[row] * x).sum::<f64>()
                });
                let off = left.iter().zip(reduced.normal).map(|(left, normal)| (left - along * normal).abs());
                assert!(off.fold(0.0, f64::max) < 1e-10);
            }
        }
    }
}
