//! The equations of a state that one unknown solves.

use super::atoms::{AngleData, Atoms, Source};
use super::closure::{Equation, Origin};
use super::polynomial::{Atom, Overflow, Polynomial};
use super::reading::{Simple, simple};
use super::search::{Class, Found, Solved, State, Unknown};
use crate::symbolic::expression::Arena;
use crate::symbolic::number::Number;

/// Rows with more unknown terms than this are not squared.
const LONGEST_SQUARED: usize = 8;
/// A value that is smaller at all samples is zero (m, m^2 or a ratio; samples are of the order of 1).
pub(super) const ZERO: f64 = 1e-9;

/// An equation in one unknown, and where it comes from.
struct Lone {
    simple: Simple,
    group: usize,
    origin: Origin,
    /// a and b of an angle's equation at the samples: that something is zero or a number is tried with them, before
    /// polynomials are multiplied.
    values: Vec<[f64; 2]>,
}

/// All steps that can be taken next.
pub(super) fn candidates(arena: &Arena, state: &mut State) -> Result<Vec<Found>, Overflow> {
    let read = |equation: &Equation| simple(&equation.polynomial, &state.open);
    let mut readings = state.equations.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let known: Vec<Polynomial> =
        state.equations.iter().map(|equation| state.open.known(&equation.polynomial)).collect();
    let squares = squares(state, &known)?;
    for equation in &squares {
        readings.push(read(equation)?);
    }
    let mut lone: Vec<Lone> = Vec::new();
    let State { equations, samples, atoms, .. } = state;
    for (equation, reading) in equations.iter().chain(&squares).zip(readings) {
        let Some(simple) = reading else { continue };
        let values = match &simple {
            Simple::Trig { a, b, .. } => {
                samples.iter_mut().map(|sample| [a, b].map(|form| sample.value(arena, atoms, form))).collect()
            }
            Simple::Slide { .. } => Vec::new(),
        };
        lone.push(Lone { simple, group: equation.group, origin: equation.origin.clone(), values });
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
                if (0..2).all(|at| first.values.iter().any(|values| values[at].abs() < ZERO)) {
                    continue;
                }
                let list = [a.clone(), b.clone(), c.clone()];
                let equation = match unit(arena, state, &known, first, &list)? {
                    Some(others) => Solved::Unit(list, others),
                    None => Solved::Trig(list),
                };
                let table = of_table(&state.atoms, a) && of_table(&state.atoms, b);
                found.push(Found {
                    unknown: unknown.clone(),
                    equation,
                    origin: first.origin.clone(),
                    class: if table { Class::Constant } else { Class::Singular },
                });
                let later = lone.iter().skip(index + 1);
                for second in later.filter(|second| second.group == first.group) {
                    found.extend(pair(&state.atoms, &unknown, first, second)?);
                }
            }
        }
    }
    if state.overdetermined {
        either(arena, state, &lone, &mut found)?;
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
            found.extend(pair(&state.atoms, &unknown, first, second)?);
        }
    }
    Ok(found)
}

/// Where a target prescribes more than there are unknowns, rows of different vectors may have the same roots, each where
/// the other vanishes too. Two such rows take the place of those that may vanish.
fn either(arena: &Arena, state: &mut State, lone: &[Lone], found: &mut Vec<Found>) -> Result<(), Overflow> {
    for (index, first) in lone.iter().enumerate() {
        let Simple::Trig { frequency, .. } = &first.simple else { continue };
        let Some(unknown) = angle(frequency) else { continue };
        let settled = |found: &Found| {
            let single = matches!(found.equation, Solved::Trig(_) | Solved::Unit(..));
            found.unknown == unknown && (found.class != Class::Singular || !single)
        };
        if found.iter().any(settled) {
            continue;
        }
        for second in lone.iter().skip(index + 1).filter(|second| second.group != first.group) {
            let Some(equation) = same(arena, state, first, second)? else { continue };
            found.retain(|single| single.unknown != unknown);
            let origin = first.origin.with(&second.origin);
            found.push(Found { unknown, equation, origin, class: Class::Singular });
            break;
        }
    }
    Ok(())
}

/// Two equations in the sine and cosine of one angle that have the same roots at all samples, as lengths both or neither,
/// if one is not merely a multiple of the other.
fn same(arena: &Arena, state: &mut State, first: &Lone, second: &Lone) -> Result<Option<Solved>, Overflow> {
    let Some([[a, b, c], [a2, b2, c2]]) = of_one_angle(first, second) else { return Ok(None) };
    let State { samples, atoms, .. } = state;
    let mut ratios = Vec::new();
    for sample in samples {
        let [a, b, c, a2, b2, c2] = [a, b, c, a2, b2, c2].map(|row| sample.value(arena, atoms, row));
        let off = [a * b2 - a2 * b, a * c2 - a2 * c, b * c2 - b2 * c];
        let sizes = [a.hypot(b), a2.hypot(b2)];
        if off.iter().any(|off| off.abs() > ZERO) || sizes.iter().any(|size| *size < ZERO) {
            return Ok(None);
        }
        ratios.push(libm::atan2(a * a2 + b * b2, a * a + b * b));
    }
    if ratios.iter().all(|ratio| ratios.first().is_some_and(|first| (ratio - first).abs() < ZERO)) {
        return Ok(None);
    }
    let rows = [[a, b, c], [a2, b2, c2]];
    let power = |row: [&Polynomial; 3]| {
        let keys = row.into_iter().flat_map(Polynomial::terms);
        keys.map(|(key, _)| state.atoms.dimension(&key.monomial)).max().unwrap_or(0)
    };
    let [power, other] = rows.map(power);
    if power.abs_diff(other) > 1 {
        return Ok(None);
    }
    let Some(length) = longest(arena, state) else { return Ok(None) };
    let as_much = |row: [&Polynomial; 3], less: bool| {
        let row = row.map(|entry| if less { entry.mul(&length) } else { Ok(entry.clone()) });
        let [a, b, c] = row;
        Ok([a?, b?, c?])
    };
    let [first, second] = rows;
    Ok(Some(Solved::Either(as_much(first, power < other)?, as_much(second, other < power)?)))
}

/// The greatest length of the table.
fn longest(arena: &Arena, state: &mut State) -> Option<Polynomial> {
    let State { samples, atoms, .. } = state;
    let sample = samples.first_mut()?;
    let lengths = atoms.list.iter().enumerate().filter_map(|(index, atom)| {
        let length = matches!(atom.source, Source::Table(_)) && atom.dimension == 1;
        length.then(|| Polynomial::atom(atoms.angles.len(), index as Atom))
    });
    let sized = lengths.map(|length| (sample.value(arena, atoms, &length).abs(), length));
    sized.max_by(|(one, _), (other, _)| one.total_cmp(other)).map(|(_, length)| length)
}

pub(super) fn angle(frequency: &[i16]) -> Option<Unknown> {
    let at = frequency.iter().position(|k| k.abs() == 1)?;
    Some(Unknown::Angle { frequency: frequency.to_vec(), at })
}

/// The coefficients of two equations in the sine and cosine of one angle, if they are such.
fn of_one_angle<'l>(first: &'l Lone, second: &'l Lone) -> Option<[[&'l Polynomial; 3]; 2]> {
    match (&first.simple, &second.simple) {
        (Simple::Trig { frequency, a, b, c }, Simple::Trig { frequency: other, a: a2, b: b2, c: c2 })
            if frequency == other =>
        {
            Some([[a, b, c], [a2, b2, c2]])
        }
        _ => None,
    }
}

/// Two equations in the sine and cosine of one angle, if they are independent at all samples.
fn pair(atoms: &Atoms, unknown: &Unknown, first: &Lone, second: &Lone) -> Result<Option<Found>, Overflow> {
    let Some([[a, b, c], [a2, b2, c2]]) = of_one_angle(first, second) else { return Ok(None) };
    let values = first.values.iter().zip(&second.values);
    let determinants: Vec<f64> = values.map(|([a, b], [a2, b2])| a * b2 - b * a2).collect();
    if determinants.iter().any(|determinant| determinant.abs() < ZERO) {
        return Ok(None);
    }
    let is_number = |first: &f64| {
        determinants.iter().all(|determinant| (determinant - first).abs() < ZERO * first.abs().max(1.0))
    };
    let class =
        if determinants.first().is_some_and(is_number) && of_table(atoms, &a.mul(b2)?.sub(&b.mul(a2)?)?) {
            Class::Constant
        } else if perpendicular([a, b], [a2, b2])? {
            Class::Singular
        } else {
            Class::Unsound
        };
    let equation = Solved::Pair([a.clone(), b.clone(), c.clone()], [a2.clone(), b2.clone(), c2.clone()]);
    let origin = first.origin.with(&second.origin);
    Ok(Some(Found { unknown: unknown.clone(), equation, origin, class }))
}

/// The other two coordinates of the known vector that c, the right-hand side of this row, is a coordinate of, if that
/// vector has length 1 and (a, b) has too.
fn unit(
    arena: &Arena,
    state: &mut State,
    known: &[Polynomial],
    row: &Lone,
    [a, b, c]: &[Polynomial; 3],
) -> Result<Option<[Polynomial; 2]>, Overflow> {
    if row.values.iter().any(|[a, b]| (a * a + b * b - 1.0).abs() > ZERO) {
        return Ok(None);
    }
    let mut square = a.mul(a)?;
    square.add_product(b, b, Number::ONE)?;
    let Some((key, _)) = square.terms().next() else { return Ok(None) };
    let one = Polynomial::number(key.frequency.len(), Number::ONE);
    if !square.sub(&one)?.is_zero() {
        return Ok(None);
    }
    let State { samples, atoms, equations, .. } = state;
    let of_group = equations.iter().zip(known).filter(|(equation, _)| equation.group == row.group);
    let mut known: Vec<Polynomial> = of_group.map(|(_, known)| known.clone()).collect();
    let own = known.iter().position(|known| known == c || known.add(c).is_ok_and(|sum| sum.is_zero()));
    let Some(own) = own.filter(|_| known.len() == 3) else { return Ok(None) };
    let is_unit = samples.iter_mut().all(|sample| {
        let square = |polynomial: &Polynomial| sample.value(arena, atoms, polynomial).powi(2);
        (known.iter().map(square).sum::<f64>() - 1.0).abs() < ZERO
    });
    known.remove(own);
    Ok(<[Polynomial; 2]>::try_from(known).ok().filter(|_| is_unit))
}

/// Whether the rows are those of a turned and scaled pair, (a, b) and (-b, a): then the determinant a^2 + b^2 vanishes
/// only with both.
fn perpendicular([a, b]: [&Polynomial; 2], [a2, b2]: [&Polynomial; 2]) -> Result<bool, Overflow> {
    let (sum, difference) = (a.add(b2)?, a.sub(b2)?);
    Ok((difference.is_zero() && b.add(a2)?.is_zero()) || (sum.is_zero() && b.sub(a2)?.is_zero()))
}

/// Whether only numbers of the table are in it.
pub(super) fn of_table(atoms: &Atoms, polynomial: &Polynomial) -> bool {
    polynomial.terms().all(|(key, _)| {
        let table = |(atom, _): &(Atom, u8)| {
            matches!(atoms.list.get(usize::from(*atom)).map(|data| &data.source), Some(Source::Table(_)))
        };
        let constant = |at: usize| matches!(atoms.angles.get(at), Some(AngleData::Constant { .. }));
        key.frequency.iter().enumerate().all(|(at, k)| *k == 0 || constant(at))
            && key.monomial.iter().all(table)
    })
}

/// Whether a known polynomial is zero at some sample: then it may be zero wherever the arm can be.
pub(super) fn vanishes(arena: &Arena, state: &mut State, polynomial: &Polynomial) -> bool {
    let State { samples, atoms, .. } = state;
    samples.iter_mut().any(|sample| sample.value(arena, atoms, polynomial).abs() < ZERO)
}

/// Sums of squares of two or three rows of one vector: |unknown part|^2 = |known part|^2.
fn squares(state: &State, known: &[Polynomial]) -> Result<Vec<Equation>, Overflow> {
    let mut found = Vec::new();
    let mut groups: Vec<usize> = state.equations.iter().map(|equation| equation.group).collect();
    groups.dedup();
    for group in groups {
        let rows: Vec<_> =
            state.equations.iter().zip(known).filter(|(equation, _)| equation.group == group).collect();
        let chosen = subsets(rows.len());
        if chosen.is_empty() {
            continue;
        }
        let squared = |(row, known): &(&Equation, &Polynomial)| square(&row.polynomial, known);
        let squared = rows.iter().map(squared).collect::<Result<Vec<_>, _>>()?;
        for chosen in chosen {
            let rows =
                chosen.iter().filter_map(|index| Some((rows.get(*index)?.0, squared.get(*index)?.as_ref())));
            found.extend(square_sum(rows)?);
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

/// |unknown part|^2 - |known part|^2, unless it would be too long.
fn square(row: &Polynomial, known: &Polynomial) -> Result<Option<Polynomial>, Overflow> {
    let unknown = row.sub(known)?;
    if unknown.len() > LONGEST_SQUARED || known.len() > LONGEST_SQUARED {
        return Ok(None);
    }
    let mut square = unknown.mul(&unknown)?;
    square.add_product(known, known, Number::integer(-1))?;
    Ok(Some(square))
}

/// The sum of rows' squares.
fn square_sum<'r>(
    rows: impl Iterator<Item = (&'r Equation, Option<&'r Polynomial>)>,
) -> Result<Option<Equation>, Overflow> {
    let mut sum = Polynomial::zero();
    let mut whole: Option<(Origin, String)> = None;
    for (row, square) in rows {
        let Some(square) = square else { return Ok(None) };
        sum = sum.add(square)?;
        whole = Some(match whole {
            None => (row.origin.clone(), row.name.clone()),
            Some((origin, name)) => (origin.with(&row.origin), name),
        });
    }
    if sum.is_zero() {
        return Ok(None);
    }
    Ok(whole.map(|(origin, name)| Equation {
        polynomial: sum,
        group: usize::MAX,
        origin: Origin { squares: true, ..origin },
        name,
    }))
}
