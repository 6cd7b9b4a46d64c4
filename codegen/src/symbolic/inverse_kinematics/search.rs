//! The order in which the unknowns are found.
//!
//! At every state the equations are read with what is known; those with one unknown are candidates, among them sums
//! of squares of rows of one vector, which lose the angles that only turn that vector. A step with one root is taken
//! at once, since it costs nothing later; steps with two are tried in turn, and the order with the fewest branches
//! and the shortest coefficients is kept.

use super::atoms::{Atoms, Source};
use super::closure::{Equation, Origin};
use super::polynomial::{Atom, Overflow, Polynomial};
use super::reading::{self, Open, Reading, Simple};
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
    class: Class,
}

/// Where a step fails because its coefficients vanish, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Class {
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
    /// Two of those.
    Pair([Polynomial; 3], [Polynomial; 3]),
    /// b x + c = 0
    Linear([Polynomial; 2]),
    /// a x^2 + b x + c = 0
    Quadratic([Polynomial; 3]),
}

impl Solved {
    fn roots(&self) -> usize {
        match self {
            Self::Pair(..) | Self::Linear(_) => 1,
            Self::Trig(_) | Self::Quadratic(_) => 2,
        }
    }

    /// The coefficients.
    pub(super) fn coefficients(&self) -> Vec<&Polynomial> {
        match self {
            Self::Trig(list) | Self::Quadratic(list) => list.iter().collect(),
            Self::Pair(first, second) => first.iter().chain(second).collect(),
            Self::Linear(list) => list.iter().collect(),
        }
    }

    fn size(&self) -> usize {
        self.coefficients().iter().map(|polynomial| polynomial.len()).sum()
    }
}

/// Where a search stands.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub atoms: Atoms,
    pub equations: Vec<Equation>,
    pub open: Open,
    pub samples: Vec<Sample>,
    pub found: Vec<Found>,
}

impl Found {
    /// Whether taking it costs nothing: one root, of a joint of its own.
    fn is_free(&self) -> bool {
        self.class != Class::Unsound && self.unknown.merged() == 0 && self.equation.roots() == 1
    }
}

/// How many states a search looks at before it keeps the best so far.
const BUDGET: usize = 60;
/// How many steps with two roots are tried at one state.
const WIDTH: usize = 3;
/// Rows with more unknown terms than this are not squared.
const LONGEST_SQUARED: usize = 8;
/// A value that is smaller at all samples is zero (m, m^2 or a ratio; samples are of the order of 1).
const ZERO: f64 = 1e-9;

/// The best order, as the state at its end.
pub(super) fn run(arena: &Arena, mut start: State) -> Result<Option<State>, Overflow> {
    settle(&mut start)?;
    let mut search = Search { arena, budget: BUDGET, best: None };
    search.visit(start)?;
    Ok(search.best.map(|(_, state)| state))
}

struct Search<'a> {
    arena: &'a Arena,
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
        candidates.sort_by_key(|found| {
            let unsound = found.class == Class::Unsound;
            (unsound, found.equation.roots(), found.class, found.equation.size())
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

/// Makes a step: its unknown becomes known.
fn take(state: &mut State, found: Found) -> Result<(), Overflow> {
    match &found.unknown {
        Unknown::Slide(atom) => state.open.slides.retain(|slide| slide != atom),
        Unknown::Angle { frequency, at } => {
            // root = frequency . angles, so the angle at `at` = sign (root - the others).
            let sign = frequency.get(*at).copied().unwrap_or(1);
            let mut coefficients: Vec<i16> = frequency.iter().map(|k| -sign * k).collect();
            if let Some(entry) = coefficients.get_mut(*at) {
                *entry = sign;
            }
            for equation in &mut state.equations {
                equation.polynomial = equation.polynomial.substitute(*at, &coefficients)?;
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
        let mut reading = Reading::new(&equation.polynomial, &state.open)?;
        if reading.is_known() {
            continue;
        }
        reading::abbreviate(&mut reading, &mut state.atoms, &equation.name)?;
        let polynomial = reading.polynomial()?;
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

/// An equation in one unknown, and where it comes from.
struct Lone {
    simple: Simple,
    group: usize,
    origin: Origin,
}

fn candidates(arena: &Arena, state: &mut State) -> Result<Vec<Found>, Overflow> {
    let mut lone: Vec<Lone> = Vec::new();
    let squares = squares(state)?;
    for equation in state.equations.iter().chain(&squares) {
        if let Some(simple) = Reading::new(&equation.polynomial, &state.open)?.simple()? {
            lone.push(Lone { simple, group: equation.group, origin: equation.origin.clone() });
        }
    }
    let mut found = Vec::new();
    for (index, first) in lone.iter().enumerate() {
        match &first.simple {
            Simple::Slide { slide, a, b, c } => {
                let equation = if a.is_zero() {
                    Solved::Linear([b.clone(), c.clone()])
                } else {
                    Solved::Quadratic([a.clone(), b.clone(), c.clone()])
                };
                let leading = if a.is_zero() { b } else { a };
                if !vanishes(arena, state, leading) {
                    let (unknown, origin) = (Unknown::Slide(*slide), first.origin.clone());
                    let class =
                        if of_table(&state.atoms, leading) { Class::Constant } else { Class::Unsound };
                    found.push(Found { unknown, equation, origin, class });
                }
            }
            Simple::Trig { frequency, a, b, c } => {
                let Some(unknown) = angle(frequency) else { continue };
                if vanishes(arena, state, a) && vanishes(arena, state, b) {
                    continue;
                }
                let equation = Solved::Trig([a.clone(), b.clone(), c.clone()]);
                let table = of_table(&state.atoms, a) && of_table(&state.atoms, b);
                found.push(Found {
                    unknown: unknown.clone(),
                    equation,
                    origin: first.origin.clone(),
                    class: if table { Class::Constant } else { Class::Singular },
                });
                let later = lone.iter().skip(index + 1);
                for second in later.filter(|second| second.group == first.group) {
                    found.extend(pair(arena, state, &unknown, first, second)?);
                }
            }
        }
    }
    // Rows of different vectors make pairs only of what no vector has a sound pair of.
    for (index, first) in lone.iter().enumerate() {
        let Simple::Trig { frequency, .. } = &first.simple else { continue };
        let Some(unknown) = angle(frequency) else { continue };
        let sound = |found: &Found| {
            found.unknown == unknown
                && found.class != Class::Unsound
                && matches!(found.equation, Solved::Pair(..))
        };
        if found.iter().any(sound) {
            continue;
        }
        for second in lone.iter().skip(index + 1).filter(|second| second.group != first.group) {
            found.extend(pair(arena, state, &unknown, first, second)?);
        }
    }
    Ok(found)
}

fn angle(frequency: &[i16]) -> Option<Unknown> {
    let at = frequency.iter().position(|k| k.abs() == 1)?;
    Some(Unknown::Angle { frequency: frequency.to_vec(), at })
}

/// Two equations in the sine and cosine of one angle, if they are independent at all samples.
fn pair(
    arena: &Arena,
    state: &mut State,
    unknown: &Unknown,
    first: &Lone,
    second: &Lone,
) -> Result<Option<Found>, Overflow> {
    let (Simple::Trig { frequency, a, b, c }, Simple::Trig { frequency: other, a: a2, b: b2, c: c2 }) =
        (&first.simple, &second.simple)
    else {
        return Ok(None);
    };
    if frequency != other {
        return Ok(None);
    }
    let determinant = a.mul(b2)?.sub(&b.mul(a2)?)?;
    if vanishes(arena, state, &determinant) {
        return Ok(None);
    }
    let equation = Solved::Pair([a.clone(), b.clone(), c.clone()], [a2.clone(), b2.clone(), c2.clone()]);
    let origin = first.origin.with(&second.origin);
    let class = if of_table(&state.atoms, &determinant) {
        Class::Constant
    } else if perpendicular([a, b], [a2, b2])? {
        Class::Singular
    } else {
        Class::Unsound
    };
    Ok(Some(Found { unknown: unknown.clone(), equation, origin, class }))
}

/// Whether the rows are those of a turned and scaled pair, (a, b) and (-b, a): then the determinant a^2 + b^2 vanishes
/// only with both.
fn perpendicular([a, b]: [&Polynomial; 2], [a2, b2]: [&Polynomial; 2]) -> Result<bool, Overflow> {
    let (sum, difference) = (a.add(b2)?, a.sub(b2)?);
    Ok((difference.is_zero() && b.add(a2)?.is_zero()) || (sum.is_zero() && b.sub(a2)?.is_zero()))
}

/// Whether only numbers of the table are in it.
fn of_table(atoms: &Atoms, polynomial: &Polynomial) -> bool {
    polynomial.terms().all(|(key, _)| {
        let table = |(atom, _): &(Atom, u8)| {
            matches!(atoms.list.get(usize::from(*atom)).map(|data| &data.source), Some(Source::Table(_)))
        };
        key.frequency.iter().all(|k| *k == 0) && key.monomial.iter().all(table)
    })
}

/// Whether a known polynomial is zero at some sample: then it may be zero wherever the arm can be.
fn vanishes(arena: &Arena, state: &mut State, polynomial: &Polynomial) -> bool {
    let State { samples, atoms, .. } = state;
    samples.iter_mut().any(|sample| sample.value(arena, atoms, polynomial).abs() < ZERO)
}

/// Sums of squares of two or three rows of one vector: |unknown part|^2 = |known part|^2.
fn squares(state: &State) -> Result<Vec<Equation>, Overflow> {
    let mut found = Vec::new();
    let mut groups: Vec<usize> = state.equations.iter().map(|equation| equation.group).collect();
    groups.dedup();
    for group in groups {
        let rows: Vec<&Equation> =
            state.equations.iter().filter(|equation| equation.group == group).collect();
        for chosen in subsets(rows.len()) {
            let rows: Vec<&Equation> = chosen.iter().filter_map(|index| rows.get(*index).copied()).collect();
            if let Some(equation) = square_sum(&rows, &state.open)? {
                found.push(equation);
            }
        }
    }
    Ok(found)
}

/// Subsets of two or more of up to three rows.
fn subsets(rows: usize) -> Vec<Vec<usize>> {
    match rows {
        2 => vec![vec![0, 1]],
        3 => vec![vec![0, 1], vec![0, 2], vec![1, 2], vec![0, 1, 2]],
        _ => Vec::new(),
    }
}

fn square_sum(rows: &[&Equation], open: &Open) -> Result<Option<Equation>, Overflow> {
    let mut sum = Polynomial::zero();
    let mut origin: Option<Origin> = None;
    for row in rows {
        let known = Reading::new(&row.polynomial, open)?.constant();
        let unknown = row.polynomial.sub(&known)?;
        if unknown.len() > LONGEST_SQUARED || known.len() > LONGEST_SQUARED {
            return Ok(None);
        }
        sum = sum.add(&unknown.mul(&unknown)?)?.sub(&known.mul(&known)?)?;
        origin = Some(origin.map_or_else(|| row.origin.clone(), |origin| origin.with(&row.origin)));
    }
    if sum.is_zero() {
        return Ok(None);
    }
    let (Some(first), Some(origin)) = (rows.first(), origin) else { return Ok(None) };
    Ok(Some(Equation {
        polynomial: sum,
        group: usize::MAX,
        origin: Origin { squares: true, ..origin },
        name: first.name.clone(),
    }))
}
