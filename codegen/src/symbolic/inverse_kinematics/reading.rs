//! An equation as its unknowns see it: known coefficients of unknown sines, cosines and slides.

use super::atoms::{Atoms, Source};
use super::polynomial::{Atom, Key, Overflow, Polynomial};
use crate::symbolic::number::Number;
use std::collections::BTreeMap;

/// What of the vocabulary is still unknown.
#[derive(Debug, Clone, Default)]
pub(super) struct Open {
    /// Indices of frequencies.
    pub angles: Vec<usize>,
    /// Atoms.
    pub slides: Vec<Atom>,
}

impl Open {
    /// Whether everything is known.
    pub(super) fn is_empty(&self) -> bool {
        self.angles.is_empty() && self.slides.is_empty()
    }

    /// The known part of an equation.
    pub(super) fn known(&self, equation: &Polynomial) -> Polynomial {
        equation.filtered(|key| self.knows_term(key))
    }

    /// Whether nothing in a polynomial is unknown.
    pub(super) fn knows(&self, polynomial: &Polynomial) -> bool {
        polynomial.terms().all(|(key, _)| self.knows_term(key))
    }

    /// Whether the unknown terms of an equation are of one angle, or of none. Terms of different angles never cancel, so that
    /// all others have more than one unknown, and need not be read.
    fn may_be_simple(&self, equation: &Polynomial) -> bool {
        let mut unknown = equation.terms().map(|(key, _)| key).filter(|key| !self.knows_term(key));
        let Some(first) = unknown.next() else { return false };
        let multiple = |key: &Key, angle: usize| key.frequency.get(angle).copied().unwrap_or(0);
        let same = |key: &Key, sign: i16| {
            self.angles.iter().all(|angle| multiple(key, *angle) == sign * multiple(first, *angle))
        };
        unknown.all(|key| same(key, 1) || same(key, -1))
    }

    fn knows_term(&self, key: &Key) -> bool {
        self.angles.iter().all(|angle| key.frequency.get(*angle).is_none_or(|k| *k == 0))
            && key.monomial.iter().all(|(atom, _)| !self.slides.contains(atom))
    }
}

/// An unknown factor: frequency in the unknown angles, and powers of unknown slides.
type Unknown = (Vec<i16>, Vec<(Atom, u8)>);

/// Coefficients of the cosine and of the sine of each unknown factor; of frequency 0, the coefficient itself.
#[derive(Debug, Clone, Default)]
pub(super) struct Reading {
    pub parts: BTreeMap<Unknown, [Polynomial; 2]>,
}

/// An equation that one unknown solves.
#[derive(Debug, Clone)]
pub(super) enum Simple {
    /// a cos + b sin = c of the angle with this frequency.
    Trig { frequency: Vec<i16>, a: Polynomial, b: Polynomial, c: Polynomial },
    /// a x^2 + b x + c = 0 of this slide.
    Slide { slide: Atom, a: Polynomial, b: Polynomial, c: Polynomial },
}

/// The equation in one unknown that an equation is, if it is one.
pub(super) fn simple(equation: &Polynomial, open: &Open) -> Result<Option<Simple>, Overflow> {
    if open.may_be_simple(equation) { Reading::new(equation, open)?.simple() } else { Ok(None) }
}

impl Reading {
    /// Sorts the terms of an equation.
    pub(super) fn new(equation: &Polynomial, open: &Open) -> Result<Self, Overflow> {
        let mut reading = Self::default();
        for (key, number) in equation.terms() {
            let is_open = |index: usize| open.angles.contains(&index);
            let split = |unknown: bool| -> Vec<i16> {
                let pick = |(index, k): (usize, &i16)| if is_open(index) == unknown { *k } else { 0 };
                key.frequency.iter().enumerate().map(pick).collect()
            };
            let (mut unknown, mut known, mut sign) = (split(true), split(false), Number::ONE);
            if unknown.iter().find(|k| **k != 0).is_some_and(|k| *k < 0) {
                unknown.iter_mut().chain(&mut known).for_each(|k| *k = -*k);
                if key.sine {
                    sign = Number::integer(-1);
                }
            }
            let coefficient = number.checked_mul(sign).ok_or(Overflow)?;
            let (slides, rest): (Vec<_>, Vec<_>) =
                key.monomial.iter().copied().partition(|(atom, _)| open.slides.contains(atom));
            let constant = unknown.iter().all(|k| *k == 0);
            let [cos, sin] = reading.parts.entry((unknown, slides)).or_default();
            if constant {
                cos.put_term(known, key.sine, rest, coefficient)?;
            } else if key.sine {
                // sin(K + U) = cos K sin U + sin K cos U
                sin.put_term(known.clone(), false, rest.clone(), coefficient)?;
                cos.put_term(known, true, rest, coefficient)?;
            } else {
                // cos(K + U) = cos K cos U - sin K sin U
                cos.put_term(known.clone(), false, rest.clone(), coefficient)?;
                sin.put_term(known, true, rest, -coefficient)?;
            }
        }
        reading.parts.retain(|_, [cos, sin]| !(cos.is_zero() && sin.is_zero()));
        Ok(reading)
    }

    /// The known part.
    pub(super) fn constant(&self) -> Polynomial {
        let known = |(frequency, slides): &Unknown| slides.is_empty() && frequency.iter().all(|k| *k == 0);
        let part = self.parts.iter().find(|(unknown, _)| known(unknown));
        part.map_or_else(Polynomial::zero, |(_, [cos, _])| cos.clone())
    }

    fn simple(&self) -> Result<Option<Simple>, Overflow> {
        let minus = Number::integer(-1);
        let constant = self.constant();
        let unknown: Vec<_> = self
            .parts
            .iter()
            .filter(|((frequency, slides), _)| !slides.is_empty() || frequency.iter().any(|k| *k != 0))
            .collect();
        Ok(match unknown.as_slice() {
            [((frequency, slides), [a, b])] if slides.is_empty() => {
                let trig = Simple::Trig {
                    frequency: frequency.clone(),
                    a: a.clone(),
                    b: b.clone(),
                    c: constant.scaled(minus)?,
                };
                frequency.iter().any(|k| k.abs() == 1).then_some(trig)
            }
            parts => slide(parts, constant),
        })
    }
}

/// The equation in one slide that these unknown parts and the known one make.
fn slide(parts: &[(&Unknown, &[Polynomial; 2])], constant: Polynomial) -> Option<Simple> {
    let mut powers = [constant, Polynomial::zero(), Polynomial::zero()];
    let mut slide = None;
    for ((frequency, slides), [coefficient, _]) in parts {
        let [(atom, power)] = slides.as_slice() else { return None };
        if frequency.iter().any(|k| *k != 0) || slide.is_some_and(|known| known != *atom) {
            return None;
        }
        slide = Some(*atom);
        *powers.get_mut(usize::from(*power))? = coefficient.clone();
    }
    let [c, b, a] = powers;
    Some(Simple::Slide { slide: slide?, a, b, c })
}

/// A known part, where it is more than a number of the table, as an atom, so that squares stay short. Coefficients of unknown
/// sines and cosines stay as they are: sums of their squares must still collapse.
pub(super) fn short(polynomial: &Polynomial, atoms: &mut Atoms, name: &str) -> Result<Polynomial, Overflow> {
    let still = |key: &Key| key.frequency.iter().all(|k| *k == 0);
    let of_table = |key: &Key| {
        key.monomial.iter().all(|(atom, _)| {
            matches!(atoms.list.get(usize::from(*atom)).map(|data| &data.source), Some(Source::Table(_)))
        })
    };
    let plain = polynomial.terms().all(|(key, _)| still(key) && of_table(key));
    let lone = polynomial.len() == 1
        && polynomial.terms().all(|(key, _)| still(key) && matches!(key.monomial.as_slice(), [(_, 1)] | []));
    if plain || lone {
        return Ok(polynomial.clone());
    }
    let minus = Number::integer(-1);
    let negated = polynomial.scaled(minus)?;
    for (index, atom) in atoms.list.iter().enumerate() {
        if let Source::Abbreviation(definition) = &atom.source {
            let known = Polynomial::atom(atoms.angles.len(), index as Atom);
            if definition == polynomial {
                return Ok(known);
            }
            if *definition == negated {
                return known.scaled(minus);
            }
        }
    }
    let dimension = polynomial.terms().map(|(key, _)| atoms.dimension(&key.monomial)).max().unwrap_or(0);
    let taken = |name: &String| atoms.list.iter().any(|atom| atom.name == *name);
    let mut unique = name.to_string();
    let mut count = 1;
    while taken(&unique) {
        count += 1;
        unique = format!("{name}_{count}");
    }
    Ok(atoms.polynomial(&unique, dimension, Source::Abbreviation(polynomial.clone())))
}
