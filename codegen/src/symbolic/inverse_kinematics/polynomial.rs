//! Trigonometric polynomials in normal form.
//!
//! Every product of sines and cosines is a sum of sines and cosines of sums of angles. Written so, equal expressions
//! are equal, s^2 + c^2 is 1 without a rule for it, and parallel axes merge by themselves. A term is
//! coefficient * monomial of atoms * {1, cos, sin}(frequency . angles).

use crate::symbolic::number::Number;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Something without structure that polynomials are made of: a number of the table, of the target, an unknown slide,
/// or a known quantity with a definition of its own. Index into [`super::atoms::Atoms`].
pub(super) type Atom = u16;

/// What a coefficient belongs to.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    /// Multiples of the angles; the first nonzero one is positive.
    pub frequency: Vec<i16>,
    /// Whether it is the sine; never for frequency 0.
    pub sine: bool,
    /// (atom, power), by atom.
    pub monomial: Vec<(Atom, u8)>,
}

/// A trigonometric polynomial in a fixed number of angles.
#[derive(Debug, Clone, PartialEq, Eq, Default, PartialOrd, Ord)]
pub(super) struct Polynomial {
    terms: BTreeMap<Key, Number>,
}

/// More terms than this are no equation that anybody reads, or that is solved in closed form.
const LONGEST: usize = 2000;

/// The polynomial became too long, or the integers of an exact coefficient too large.
#[derive(Debug, Clone, Copy)]
pub(super) struct Overflow;

type Outcome<T> = Result<T, Overflow>;

impl Polynomial {
    /// 0
    pub(super) fn zero() -> Self {
        Self::default()
    }

    /// A constant.
    pub(super) fn number(angles: usize, number: Number) -> Self {
        Self::term(vec![0; angles], false, Vec::new(), number)
    }

    /// An atom.
    pub(super) fn atom(angles: usize, atom: Atom) -> Self {
        Self::term(vec![0; angles], false, vec![(atom, 1)], Number::ONE)
    }

    /// cos(frequency . angles) or the sine.
    pub(super) fn trig(frequency: &[i16], sine: bool) -> Self {
        Self::term(frequency.to_vec(), sine, Vec::new(), Number::ONE)
    }

    /// One term, of any frequency.
    pub(super) fn term(
        frequency: Vec<i16>,
        sine: bool,
        monomial: Vec<(Atom, u8)>,
        coefficient: Number,
    ) -> Self {
        Self { terms: normal(frequency, sine, monomial, coefficient).into_iter().collect() }
    }

    /// Its terms.
    pub(super) fn terms(&self) -> impl Iterator<Item = (&Key, Number)> {
        self.terms.iter().map(|(key, number)| (key, *number))
    }

    /// How many terms there are.
    pub(super) fn len(&self) -> usize {
        self.terms.len()
    }

    /// Whether it is 0.
    pub(super) fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// self + factor * other
    pub(super) fn add_scaled(&self, other: &Self, factor: Number) -> Outcome<Self> {
        let mut sum = self.clone();
        for (key, number) in &other.terms {
            sum.put(key.clone(), number.checked_mul(factor).ok_or(Overflow)?)?;
        }
        Ok(sum)
    }

    /// self + other
    pub(super) fn add(&self, other: &Self) -> Outcome<Self> {
        self.add_scaled(other, Number::ONE)
    }

    /// self - other
    pub(super) fn sub(&self, other: &Self) -> Outcome<Self> {
        self.add_scaled(other, Number::integer(-1))
    }

    /// factor * self
    pub(super) fn scaled(&self, factor: Number) -> Outcome<Self> {
        Self::zero().add_scaled(self, factor)
    }

    /// self * other, by the product-to-sum identities.
    pub(super) fn mul(&self, other: &Self) -> Outcome<Self> {
        let mut product = Self::zero();
        product.add_product(self, other, Number::ONE)?;
        Ok(product)
    }

    /// Adds factor * left * right, in place.
    pub(super) fn add_product(&mut self, left: &Self, right: &Self, factor: Number) -> Outcome<()> {
        for (a, m) in &left.terms {
            let m = m.checked_mul(factor).ok_or(Overflow)?;
            for (b, n) in &right.terms {
                let coefficient = m.checked_mul(*n).ok_or(Overflow)?;
                let monomial = multiply(&a.monomial, &b.monomial);
                self.put_product(a, b, monomial, coefficient)?;
            }
        }
        Ok(())
    }

    /// Those of its terms that are as asked for.
    pub(super) fn filtered(&self, wanted: impl Fn(&Key) -> bool) -> Self {
        let terms = self.terms.iter().filter(|(key, _)| wanted(key));
        Self { terms: terms.map(|(key, number)| (key.clone(), *number)).collect() }
    }

    fn put_product(
        &mut self,
        a: &Key,
        b: &Key,
        monomial: Vec<(Atom, u8)>,
        coefficient: Number,
    ) -> Outcome<()> {
        let constant = |key: &Key| key.frequency.iter().all(|multiple| *multiple == 0);
        if constant(a) || constant(b) {
            let (frequency, sine) = if constant(a) { (&b.frequency, b.sine) } else { (&a.frequency, a.sine) };
            return self.put_term(frequency.clone(), sine, monomial, coefficient);
        }
        let combine = |sign: i16| a.frequency.iter().zip(&b.frequency).map(|(x, y)| x + sign * y).collect();
        let half = coefficient.checked_mul(Number::HALF).ok_or(Overflow)?;
        // cos a cos b = (cos(a-b) + cos(a+b)) / 2, sin a sin b = (cos(a-b) - cos(a+b)) / 2,
        // sin a cos b = (sin(a+b) + sin(a-b)) / 2, cos a sin b = (sin(a+b) - sin(a-b)) / 2.
        let sine = a.sine != b.sine;
        let (plus, minus) = match (a.sine, b.sine) {
            (true, true) => (-half, half),
            (false, true) => (half, -half),
            _ => (half, half),
        };
        self.put_term(combine(1), sine, monomial.clone(), plus)?;
        self.put_term(combine(-1), sine, monomial, minus)
    }

    /// Adds a term.
    pub(super) fn put_term(
        &mut self,
        frequency: Vec<i16>,
        sine: bool,
        monomial: Vec<(Atom, u8)>,
        coefficient: Number,
    ) -> Outcome<()> {
        match normal(frequency, sine, monomial, coefficient) {
            Some((key, number)) => self.put(key, number),
            None => Ok(()),
        }
    }

    fn put(&mut self, key: Key, number: Number) -> Outcome<()> {
        match self.terms.entry(key) {
            Entry::Vacant(place) => {
                place.insert(number);
                if self.terms.len() > LONGEST {
                    return Err(Overflow);
                }
            }
            Entry::Occupied(mut place) => {
                let sum = place.get().checked_add(number).ok_or(Overflow)?;
                if sum.is_zero() {
                    place.remove();
                } else {
                    place.insert(sum);
                }
            }
        }
        Ok(())
    }

    /// Divided by the coefficient of its first term, so that multiples of one polynomial are equal.
    pub(super) fn monic(&self) -> Outcome<Self> {
        match self.terms.values().next().and_then(|first| first.recip()) {
            Some(inverse) => self.scaled(inverse),
            None => Ok(self.clone()),
        }
    }

    /// With its angles in another order: of each, the place where it was.
    pub(super) fn in_order(&self, places: &[usize]) -> Self {
        let terms = self.terms.iter().filter_map(|(key, number)| {
            let frequency = places.iter().filter_map(|place| key.frequency.get(*place).copied()).collect();
            normal(frequency, key.sine, key.monomial.clone(), *number)
        });
        Self { terms: terms.collect() }
    }

    /// Replaces an angle by others: `angles[at]` = sum of coefficients * new angles, where the new angle at `at` is
    /// the one that takes its place.
    pub(super) fn substitute(&self, at: usize, coefficients: &[i16]) -> Outcome<Self> {
        let mut out = Self::zero();
        for (key, number) in &self.terms {
            let mut frequency = key.frequency.clone();
            let multiple = frequency.get(at).copied().unwrap_or(0);
            if let Some(entry) = frequency.get_mut(at) {
                *entry = 0;
            }
            for (entry, coefficient) in frequency.iter_mut().zip(coefficients) {
                *entry += multiple * coefficient;
            }
            out.put_term(frequency, key.sine, key.monomial.clone(), *number)?;
        }
        Ok(out)
    }
}

/// A term of any frequency in normal form, unless it is 0.
fn normal(
    mut frequency: Vec<i16>,
    sine: bool,
    monomial: Vec<(Atom, u8)>,
    mut coefficient: Number,
) -> Option<(Key, Number)> {
    match frequency.iter().find(|multiple| **multiple != 0) {
        None if sine => return None,
        Some(first) if *first < 0 => {
            for multiple in &mut frequency {
                *multiple = -*multiple;
            }
            if sine {
                coefficient = -coefficient;
            }
        }
        _ => {}
    }
    (!coefficient.is_zero()).then_some((Key { frequency, sine, monomial }, coefficient))
}

/// Product of two monomials.
pub(super) fn multiply(a: &[(Atom, u8)], b: &[(Atom, u8)]) -> Vec<(Atom, u8)> {
    let mut product = a.to_vec();
    for &(atom, power) in b {
        match product.binary_search_by_key(&atom, |factor| factor.0) {
            Ok(at) => {
                if let Some(factor) = product.get_mut(at) {
                    factor.1 += power;
                }
            }
            Err(at) => product.insert(at, (atom, power)),
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::{Number, Polynomial};

    #[test]
    fn products_of_sines_and_cosines_are_sums() {
        let (s1, c1) = (Polynomial::trig(&[1, 0], true), Polynomial::trig(&[1, 0], false));
        let (s2, c2) = (Polynomial::trig(&[0, 1], true), Polynomial::trig(&[0, 1], false));
        let mul = |a: &Polynomial, b: &Polynomial| a.mul(b).unwrap();
        let c12 = mul(&c1, &c2).sub(&mul(&s1, &s2)).unwrap();
        assert_eq!(c12, Polynomial::trig(&[1, 1], false));
        let s1m2 = mul(&s1, &c2).sub(&mul(&c1, &s2)).unwrap();
        assert_eq!(s1m2, Polynomial::trig(&[1, -1], true));
        let one = mul(&s1, &s1).add(&mul(&c1, &c1)).unwrap();
        assert_eq!(one, Polynomial::number(2, Number::ONE));
    }
}
