//! The order in which the unknowns are found.
//!
//! At every state the equations are read with what is known; those with one unknown are candidates, among them sums
//! of squares of rows of one vector, which lose the angles that only turn that vector. A step with one root is taken
//! at once, since it costs nothing later; steps with two are tried in turn, and the order with the fewest branches
//! and the shortest coefficients is kept.

use super::OfVector;
use super::atoms::{Atoms, Source};
use super::candidates::candidates;
use super::closure::{Equation, Origin};
use super::elimination::quartics;
use super::polynomial::{Atom, Overflow, Polynomial};
use super::reading::{self, Open};
use super::samples::Sample;
use crate::symbolic::expression::Arena;
use std::collections::BTreeSet;

/// A step of the solution.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub unknown: Unknown,
    pub equation: Solved,
    pub origin: Origin,
    /// Where it fails.
    pub class: Class,
}

/// Where a step fails because its coefficients vanish, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Class {
    /// Nowhere: they are numbers of the table.
    Constant,
    /// Where the unknown itself is free: all of them vanish together.
    Singular,
    /// Elsewhere too.
    Unsound,
}

/// What a step finds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Unknown {
    /// The angle frequency . angles; from then on it stands in the place `at`.
    Angle { frequency: Vec<i16>, at: usize },
    /// A slide.
    Slide(Atom),
}

impl Unknown {
    /// How many joints beyond the first it is a sum of. Such a sum has to be taken apart later.
    fn merged(&self) -> usize {
        match self {
            Self::Slide(_) => 0,
            Self::Angle { frequency, .. } => frequency.iter().filter(|k| **k != 0).count().saturating_sub(1),
        }
    }
}

/// How it is found.
#[derive(Debug, Clone)]
pub(super) enum Solved {
    /// a cos + b sin = c
    Trig([Polynomial; 3]),
    /// The same where c is a coordinate of a unit vector, of which these are the other two, and (a, b) has length 1.
    Unit([Polynomial; 3], [Polynomial; 2]),
    /// Two of those, which are independent.
    Pair([Polynomial; 3], [Polynomial; 3]),
    /// Two of those, which say the same wherever both say something.
    Either([Polynomial; 3], [Polynomial; 3]),
    /// b x + c = 0
    Linear([Polynomial; 2]),
    /// a x^2 + b x + c = 0
    Quadratic([Polynomial; 3]),
    /// (k1 + l1 cos x + m1 sin x)^2 + (k2 + l2 cos x + m2 sin x)^2 = n^2
    Quartic([[Polynomial; 3]; 2], Polynomial, Option<Box<OfVector<Polynomial>>>),
}

impl Solved {
    fn roots(&self) -> usize {
        match self {
            Self::Pair(..) | Self::Linear(_) => 1,
            Self::Trig(_) | Self::Unit(..) | Self::Either(..) | Self::Quadratic(_) => 2,
            Self::Quartic(..) => 4,
        }
    }

    /// The coefficients.
    pub(super) fn coefficients(&self) -> Vec<&Polynomial> {
        match self {
            Self::Trig(list) | Self::Quadratic(list) => list.iter().collect(),
            Self::Unit(list, others) => list.iter().chain(others).collect(),
            Self::Pair(first, second) | Self::Either(first, second) => first.iter().chain(second).collect(),
            Self::Linear(list) => list.iter().collect(),
            Self::Quartic(forms, right, vector) => {
                let vector = vector.iter().flat_map(|vector| vector.coefficients());
                forms.as_flattened().iter().chain([right]).chain(vector).collect()
            }
        }
    }

    /// Terms in its coefficients. The other coordinates of a unit vector come with every way to take it apart.
    fn size(&self) -> usize {
        let list = match self {
            Self::Unit(list, _) => list.iter().collect(),
            _ => self.coefficients(),
        };
        list.iter().map(|polynomial| polynomial.len()).sum()
    }
}

/// Where a search stands.
#[derive(Debug, Clone)]
pub(super) struct State {
    /// Whether the target prescribes more than there are unknowns.
    pub overdetermined: bool,
    pub atoms: Atoms,
    pub equations: Vec<Equation>,
    pub open: Open,
    pub samples: Vec<Sample>,
    pub found: Vec<Found>,
}

impl State {
    /// Whether every step fails nowhere but where its unknown is free.
    pub(super) fn is_sound(&self) -> bool {
        self.found.iter().all(|found| found.class != Class::Unsound)
    }
}

impl Found {
    /// Whether taking it costs nothing: one root, of a joint of its own.
    fn is_free(&self) -> bool {
        self.class != Class::Unsound && self.unknown.merged() == 0 && self.equation.roots() == 1
    }
}

/// Which steps are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Steps {
    /// Those with up to two roots.
    Quadratic,
    /// Where there are none, those with four: an angle is eliminated from two equations.
    Quartic,
}

/// How many states a search looks at before it keeps the best so far.
const BUDGET: usize = 60;
/// How many steps with two roots are tried at one state.
const WIDTH: usize = 3;
/// The best order, as the state at its end.
pub(super) fn run(arena: &Arena, mut start: State, most: Steps) -> Result<Option<State>, Overflow> {
    settle(&mut start)?;
    let mut search = Search { arena, most, budget: BUDGET, best: None };
    search.visit(start)?;
    Ok(search.best.map(|(_, state)| state))
}

struct Search<'a> {
    arena: &'a Arena,
    most: Steps,
    budget: usize,
    best: Option<(Cost, State)>,
}

impl Search<'_> {
    fn visit(&mut self, mut state: State) -> Result<(), Overflow> {
        if state.open.is_empty() {
            let cost = cost(&state);
            if self.best.as_ref().is_none_or(|(least, _)| cost < *least) {
                self.best = Some((cost, state));
            }
            return Ok(());
        }
        if self.budget == 0 {
            return Ok(());
        }
        self.budget -= 1;
        let mut candidates = candidates(self.arena, &mut state)?;
        if candidates.is_empty() && self.most == Steps::Quartic {
            candidates = quartics(self.arena, &mut state)?;
        }
        candidates.sort_by_key(|found| {
            let unsound = found.class == Class::Unsound;
            let unit = matches!(found.equation, Solved::Unit(..));
            (unsound, found.equation.roots(), found.class, found.equation.size(), !unit)
        });
        let mut unknowns = Vec::new();
        candidates.retain(|found| {
            let new = !unknowns.contains(&found.unknown);
            unknowns.push(found.unknown.clone());
            new
        });
        let width = if candidates.first().is_some_and(Found::is_free) { 1 } else { WIDTH };
        for found in candidates.into_iter().take(width) {
            let mut next = state.clone();
            take(&mut next, found)?;
            self.visit(next)?;
        }
        Ok(())
    }
}

/// What orders are compared by, first things first: unsound steps, branches, work.
type Cost = (usize, usize, usize);

fn cost(state: &State) -> Cost {
    let found = &state.found;
    let unsound = found.iter().filter(|step| step.class == Class::Unsound).count();
    let branches = found.iter().map(|step| step.equation.roots()).product();
    let mut atoms = BTreeSet::new();
    let mut work = 0;
    for step in found {
        work += step.equation.size() + 3 * step.unknown.merged() + usize::from(step.class != Class::Constant);
        for polynomial in step.equation.coefficients() {
            collect(&state.atoms, polynomial, &mut atoms);
        }
    }
    let definition = |atom: &Atom| match state.atoms.list.get(usize::from(*atom)).map(|data| &data.source) {
        Some(Source::Abbreviation(polynomial)) => polynomial.len(),
        _ => 0,
    };
    (unsound, branches, work + atoms.iter().map(definition).sum::<usize>())
}

/// The atoms of a polynomial, and of the definitions of those that are abbreviations.
fn collect(atoms: &Atoms, polynomial: &Polynomial, found: &mut BTreeSet<Atom>) {
    for (key, _) in polynomial.terms() {
        for (atom, _) in &key.monomial {
            if found.insert(*atom)
                && let Some(Source::Abbreviation(definition)) =
                    atoms.list.get(usize::from(*atom)).map(|data| &data.source)
            {
                collect(atoms, definition, found);
            }
        }
    }
}

impl Unknown {
    /// The place of an angle.
    pub(super) fn place(&self) -> Option<usize> {
        match self {
            Self::Angle { at, .. } => Some(*at),
            Self::Slide(_) => None,
        }
    }

    /// The place of an angle and what stands there from then on: root = frequency . angles, so the angle at `at` is
    /// sign (root - the others).
    pub(super) fn replaced(&self) -> Option<(usize, Vec<i16>)> {
        let Self::Angle { frequency, at } = self else { return None };
        let sign = frequency.get(*at).copied().unwrap_or(1);
        let mut coefficients: Vec<i16> = frequency.iter().map(|k| -sign * k).collect();
        if let Some(entry) = coefficients.get_mut(*at) {
            *entry = sign;
        }
        Some((*at, coefficients))
    }
}

/// Makes a step: its unknown becomes known.
fn take(state: &mut State, found: Found) -> Result<(), Overflow> {
    match &found.unknown {
        Unknown::Slide(atom) => state.open.slides.retain(|slide| slide != atom),
        Unknown::Angle { frequency, at } => {
            if let Some((at, coefficients)) = found.unknown.replaced() {
                for equation in &mut state.equations {
                    equation.polynomial = equation.polynomial.substitute(at, &coefficients)?;
                }
            }
            for sample in &mut state.samples {
                let root = frequency.iter().zip(&sample.angles).map(|(k, x)| f64::from(*k) * x).sum();
                if let Some(entry) = sample.angles.get_mut(*at) {
                    *entry = root;
                }
            }
            state.open.angles.retain(|angle| angle != at);
        }
    }
    state.found.push(found);
    settle(state)
}

/// Reads all equations anew, abbreviates what is known, and drops what says nothing new: equations without unknowns,
/// and vectors whose rows all stand in an earlier frame too (there is one wherever a joint is held).
fn settle(state: &mut State) -> Result<(), Overflow> {
    let mut groups: Vec<(BTreeSet<Polynomial>, Vec<Equation>)> = Vec::new();
    let mut last = None;
    for equation in std::mem::take(&mut state.equations) {
        let known = state.open.known(&equation.polynomial);
        if known.len() == equation.polynomial.len() {
            continue;
        }
        let short = reading::short(&known, &mut state.atoms, &equation.name)?;
        let polynomial = if short == known {
            equation.polynomial
        } else {
            equation.polynomial.sub(&known)?.add(&short)?
        };
        if last.replace(equation.group) != Some(equation.group) {
            groups.push((BTreeSet::new(), Vec::new()));
        }
        if let Some((rows, equations)) = groups.last_mut()
            && rows.insert(polynomial.monic()?)
        {
            equations.push(Equation { polynomial, ..equation });
        }
    }
    let mut kept: Vec<(BTreeSet<Polynomial>, Vec<Equation>)> = Vec::new();
    for (rows, equations) in groups {
        if !kept.iter().any(|(known, _)| rows.is_subset(known)) {
            kept.push((rows, equations));
        }
    }
    state.equations = kept.into_iter().flat_map(|(_, equations)| equations).collect();
    Ok(())
}
