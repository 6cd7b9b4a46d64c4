//! Joint variables in terms of the roots of the steps, and of the joints that the caller gives.

use super::Linear;
use super::atoms::AngleData;
use super::search::{State, Unknown};
use super::unknowns::{self, Form, Offset, Unknowns};
use std::collections::BTreeMap;

/// A free variable in terms of what is given and of the roots.
pub(super) struct ByRoots {
    /// (variable, coefficient)
    terms: Vec<(usize, f64)>,
    constant: Offset,
}

/// A form in the free variables, in terms of what is given and of the roots.
pub(super) fn linear(form: &Form, free: &[ByRoots]) -> Linear {
    let width = free.iter().flat_map(|free| &free.terms).map(|term| term.0 + 1).max().unwrap_or(0);
    let as_forms: Vec<Form> = free
        .iter()
        .map(|free| {
            let mut coefficients = vec![0.0; width];
            for &(variable, factor) in &free.terms {
                if let Some(entry) = coefficients.get_mut(variable) {
                    *entry += factor;
                }
            }
            Form { coefficients, offset: free.constant }
        })
        .collect();
    let combined = unknowns::combine(form, &as_forms);
    let terms = combined.coefficients.into_iter().enumerate().filter(|(_, x)| x.abs() > 1e-12);
    Linear { terms: terms.collect(), constant: combined.offset.value() }
}

/// Every free variable in terms of what is given and of the roots.
pub(super) fn by_roots(unknowns: &Unknowns, end: &State) -> Vec<ByRoots> {
    let given = unknowns.given().count();
    let mut free: Vec<ByRoots> = unknowns
        .free
        .iter()
        .map(|free| match free.given {
            Some(given) => ByRoots { terms: vec![(given.place, given.factor)], constant: given.at_zero },
            None => ByRoots { terms: Vec::new(), constant: Offset::default() },
        })
        .collect();
    for (stage, found) in end.found.iter().enumerate().rev() {
        let stage = given + stage;
        match &found.unknown {
            Unknown::Slide(atom) => {
                let place = end.atoms.slide(*atom).and_then(|index| free.get_mut(index));
                if let Some(place) = place {
                    place.terms.push((stage, 1.0));
                }
            }
            Unknown::Angle { frequency, at } => {
                let sign = f64::from(frequency.get(*at).copied().unwrap_or(1));
                let mut sum = BTreeMap::from([(stage, sign)]);
                for (angle, k) in
                    end.atoms.angles.iter().zip(frequency).enumerate().filter_map(|(index, (angle, k))| {
                        (index != *at && *k != 0).then_some((angle, f64::from(*k)))
                    })
                {
                    let AngleData::Free(other) = angle else { continue };
                    for &(root, x) in free.get(*other).map_or(&[][..], |other| &other.terms) {
                        *sum.entry(root).or_insert(0.0) -= sign * k * x;
                    }
                }
                if let Some(AngleData::Free(own)) = end.atoms.angles.get(*at)
                    && let Some(place) = free.get_mut(*own)
                {
                    place.terms = sum.into_iter().filter(|(_, x)| *x != 0.0).collect();
                }
            }
        }
    }
    free
}
