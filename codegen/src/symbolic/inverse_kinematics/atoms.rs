//! What polynomials are made of: the atoms of monomials, and the angles of frequencies.

use super::polynomial::{Atom, Polynomial};
use crate::symbolic::expression::Expr;

/// An atom.
#[derive(Debug, Clone)]
pub(super) struct AtomData {
    /// As it is written.
    pub name: String,
    /// Where its value comes from.
    pub source: Source,
    /// Power of the metre in it.
    pub dimension: u8,
}

/// Where the value of an atom comes from.
#[derive(Debug, Clone)]
pub(super) enum Source {
    /// The table: a constant expression.
    Table(Expr),
    /// The target: an expression in its numbers.
    Target(Expr),
    /// The free variable of this index, an unknown length.
    Slide(usize),
    /// A polynomial in known things, abbreviated.
    Abbreviation(Polynomial),
}

/// An angle of the frequencies.
#[derive(Debug, Clone)]
pub(super) enum AngleData {
    /// The free variable of this index.
    Free(usize),
    /// A constant of the table that is no multiple of 15 degrees.
    Constant {
        /// As it is written: `alpha3`.
        name: String,
        /// rad
        value: f64,
    },
}

/// The vocabulary of one derivation.
#[derive(Debug, Clone, Default)]
pub(super) struct Atoms {
    pub list: Vec<AtomData>,
    pub angles: Vec<AngleData>,
}

impl Atoms {
    /// The atom of this name, made if it isn't there.
    pub(super) fn atom(&mut self, name: &str, dimension: u8, source: Source) -> Atom {
        let known = self.list.iter().position(|atom| atom.name == name);
        known.unwrap_or_else(|| {
            self.list.push(AtomData { name: name.to_string(), source, dimension });
            self.list.len() - 1
        }) as Atom
    }

    /// The atom itself as a polynomial.
    pub(super) fn polynomial(&mut self, name: &str, dimension: u8, source: Source) -> Polynomial {
        let atom = self.atom(name, dimension, source);
        Polynomial::atom(self.angles.len(), atom)
    }

    /// Power of the metre in a monomial.
    pub(super) fn dimension(&self, monomial: &[(Atom, u8)]) -> u8 {
        let power = |(atom, power): &(Atom, u8)| {
            self.list.get(usize::from(*atom)).map_or(0, |data| data.dimension.saturating_mul(*power))
        };
        monomial.iter().map(power).fold(0, u8::saturating_add)
    }

    /// The unknown slide that an atom is.
    pub(super) fn slide(&self, atom: Atom) -> Option<usize> {
        match self.list.get(usize::from(atom)).map(|data| &data.source) {
            Some(Source::Slide(index)) => Some(*index),
            _ => None,
        }
    }
}
