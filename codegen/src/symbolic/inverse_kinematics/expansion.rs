//! Terms of a polynomial as products of factors.

use super::polynomial::{Atom, Key, Polynomial};
use crate::symbolic::number::Number;
use std::collections::BTreeMap;

/// A factor of a term.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Factor {
    Atom(Atom),
    Trig(Vec<i16>, bool),
}

/// A coefficient and what it multiplies.
pub(super) type Term = (Number, Vec<Factor>);

/// Sines and cosines of sums as products of those of the single angles, by the addition theorems; `None` where the
/// integers overflow. Multiples of one angle stay as they are.
pub(super) fn expanded(polynomial: &Polynomial) -> Option<Vec<Term>> {
    let mut collected: BTreeMap<Vec<Factor>, Number> = BTreeMap::new();
    for (key, number) in polynomial.terms() {
        let plain =
            Key { frequency: vec![0; key.frequency.len()], sine: false, monomial: key.monomial.clone() };
        let atoms = factors(&plain);
        // (number, factors) of the cosine and of the sine of the angles so far.
        let mut cos: Vec<Term> = vec![(Number::ONE, Vec::new())];
        let mut sin: Vec<Term> = Vec::new();
        for (at, k) in key.frequency.iter().enumerate().filter(|(_, k)| **k != 0) {
            let mut own = vec![0; key.frequency.len()];
            if let Some(entry) = own.get_mut(at) {
                *entry = k.abs();
            }
            let sign = if *k < 0 { Number::integer(-1) } else { Number::ONE };
            let (s, c) = (Factor::Trig(own.clone(), true), Factor::Trig(own, false));
            let next_cos = [times(&cos, &c, Number::ONE)?, times(&sin, &s, -sign)?].concat();
            let next_sin = [times(&sin, &c, Number::ONE)?, times(&cos, &s, sign)?].concat();
            (cos, sin) = (next_cos, next_sin);
        }
        for (factor, mut list) in if key.sine { sin } else { cos } {
            list.extend(atoms.iter().cloned());
            list.sort();
            let entry = collected.entry(list).or_insert(Number::ZERO);
            *entry = entry.checked_add(factor.checked_mul(number)?)?;
        }
    }
    Some(collected.into_iter().filter(|(_, n)| !n.is_zero()).map(|(list, n)| (n, list)).collect())
}

fn times(terms: &[Term], factor: &Factor, by: Number) -> Option<Vec<Term>> {
    let one = |(number, list): &Term| {
        let mut list = list.clone();
        list.push(factor.clone());
        Some((number.checked_mul(by)?, list))
    };
    terms.iter().map(one).collect()
}

pub(super) fn factors(key: &Key) -> Vec<Factor> {
    let mut factors: Vec<Factor> = key
        .monomial
        .iter()
        .flat_map(|(atom, power)| std::iter::repeat_n(Factor::Atom(*atom), usize::from(*power)))
        .collect();
    if key.frequency.iter().any(|k| *k != 0) {
        factors.push(Factor::Trig(key.frequency.clone(), key.sine));
    }
    factors
}
