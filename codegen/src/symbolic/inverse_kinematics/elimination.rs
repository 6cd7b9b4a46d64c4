//! One angle of two from two equations: a quartic in the tangent of its half.
//!
//! Where a1 cos x + b1 sin x = c1 and a2 cos x + b2 sin x = c2 with known a and b, and c that are linear in the cosine and
//! sine of another angle y, cos x and sin x are linear in these too, and the sum of their squares is an equation of the
//! second degree in y alone (subproblem 6 of Elias and Wen, "IK-Geo: Unified robot inverse kinematics using subproblem
//! decomposition"). A point on three joints gives such a pair: its height on the second axis and its distance from it know
//! the first and the third joint only (Pieper 1968).

use super::candidates::{angle, of_table, vanishes};
use super::closure::{Equation, Origin};
use super::polynomial::{Overflow, Polynomial};
use super::reading::{Open, Reading, short};
use super::search::{Class, Found, Solved, State};
use super::unit_vector;
use crate::symbolic::expression::Arena;
use crate::symbolic::number::Number;

/// Longer equations are not taken for a pair.
pub(super) const LONGEST: usize = 96;

/// k + l cos y + m sin y
pub(super) type Linear = [Polynomial; 3];

/// An equation as x sees it: a cos x + b sin x = c.
struct Row {
    a: Polynomial,
    b: Polynomial,
    c: Polynomial,
    origin: Origin,
}

/// All quartics that two equations give.
pub(super) fn quartics(arena: &Arena, state: &mut State) -> Result<Vec<Found>, Overflow> {
    let mut list = Vec::new();
    for x in state.open.angles.clone() {
        let mut found = Vec::new();
        for equation in &state.equations {
            found.extend(row(equation, x, &state.open)?);
        }
        for (place, first) in found.iter().enumerate() {
            for second in found.iter().skip(place + 1) {
                list.extend(quartic(arena, state, x, [first, second])?);
            }
        }
    }
    Ok(list)
}

fn row(equation: &Equation, x: usize, open: &Open) -> Result<Option<Row>, Overflow> {
    if equation.polynomial.len() > LONGEST {
        return Ok(None);
    }
    let only = Open { angles: vec![x], slides: open.slides.clone() };
    let reading = Reading::new(&equation.polynomial, &only)?;
    let own = |(frequency, slides): &(Vec<i16>, Vec<_>)| {
        slides.is_empty() && frequency.get(x).is_some_and(|k| k.abs() == 1)
    };
    let constant = reading.constant();
    let mut others = reading
        .parts
        .iter()
        .filter(|((frequency, slides), _)| !slides.is_empty() || frequency.iter().any(|k| *k != 0));
    let (Some((unknown, [a, b])), None) = (others.next(), others.next()) else { return Ok(None) };
    let c = constant.scaled(Number::integer(-1))?;
    let origin = equation.origin.clone();
    Ok(own(unknown).then(|| Row { a: a.clone(), b: b.clone(), c, origin }))
}

fn quartic(
    arena: &Arena,
    state: &mut State,
    x: usize,
    [first, second]: [&Row; 2],
) -> Result<Option<Found>, Overflow> {
    let mut others = state.open.clone();
    others.angles.retain(|angle| *angle != x);
    let mut y = None;
    let mut read = Vec::new();
    for row in [first, second] {
        for known in [&row.a, &row.b] {
            if !others.knows(known) {
                return Ok(None);
            }
        }
        read.extend(linear(&row.c, &others, &mut y)?);
    }
    let (Some(y), [c1, c2]) = (y, read.as_slice()) else { return Ok(None) };
    let determinant = product(&first.a, &second.b, &second.a, &first.b)?;
    if determinant.is_zero() {
        return difference(arena, state, &y, [(first, c1), (second, c2)]);
    }
    if vanishes(arena, state, &determinant) {
        return Ok(None);
    }
    let class = if of_table(&state.atoms, &determinant) { Class::Singular } else { Class::Unsound };
    let (mut cos, mut sin) = (Linear::default(), Linear::default());
    for ((cos, sin), (c1, c2)) in cos.iter_mut().zip(&mut sin).zip(c1.iter().zip(c2)) {
        *cos = product(c1, &second.b, c2, &first.b)?;
        *sin = product(c2, &first.a, c1, &second.a)?;
    }
    let [_, varying @ ..] = &cos;
    let [_, more @ ..] = &sin;
    if varying.iter().chain(more).all(|polynomial| vanishes(arena, state, polynomial)) {
        return Ok(None);
    }
    let Some(unknown) = angle(&y) else { return Ok(None) };
    let of_vector = |state: &mut State, row: &Row, c: &Linear, beside: &Row| {
        let (factor, scale, other) = match (row.a.is_zero(), row.b.is_zero()) {
            (false, true) => (&row.a, &beside.b, &sin),
            (true, false) => (&row.b, &beside.a, &cos),
            _ => return Ok(None),
        };
        unit_vector::quartic(arena, state, &y, [c, other], [factor, scale])
    };
    let mut equation = of_vector(state, first, c1, second)?;
    if equation.is_none() {
        equation = of_vector(state, second, c2, first)?;
    }
    let mut equation = equation.unwrap_or(Solved::Quartic([cos, sin], determinant, None));
    if let Solved::Quartic(forms, _, vector) = &mut equation {
        let others = vector.iter_mut().flat_map(|vector| &mut vector.others);
        let named = forms.iter_mut().chain(others).flat_map(|form| form.iter_mut().zip(["k", "l", "m"]));
        for (part, name) in named {
            *part = short(part, &mut state.atoms, name)?;
        }
    }
    let origin = eliminated(first, second);
    Ok(Some(Found { unknown, equation, origin, class }))
}

/// Two rows that have the same of x, but for a factor: their difference has nothing of it.
fn difference(
    arena: &Arena,
    state: &mut State,
    y: &[i16],
    [(first, c1), (second, c2)]: [(&Row, &Linear); 2],
) -> Result<Option<Found>, Overflow> {
    let Some(unknown) = angle(y) else { return Ok(None) };
    let (one, other) = if first.a.is_zero() { (&first.b, &second.b) } else { (&first.a, &second.a) };
    let mut difference = Linear::default();
    for (entry, (c1, c2)) in difference.iter_mut().zip(c1.iter().zip(c2)) {
        *entry = product(c1, other, c2, one)?;
    }
    let [k, a, b] = difference;
    let c = k.scaled(Number::integer(-1))?;
    let sound = of_table(&state.atoms, one) && of_table(&state.atoms, other);
    let gone = [one, other].into_iter().any(|factor| vanishes(arena, state, factor));
    if gone || (vanishes(arena, state, &a) && vanishes(arena, state, &b)) {
        return Ok(None);
    }
    let c = short(&c, &mut state.atoms, "k")?;
    let class = if sound { Class::Singular } else { Class::Unsound };
    let origin = eliminated(first, second);
    Ok(Some(Found { unknown, equation: Solved::Trig([a, b, c]), origin, class }))
}

/// "row 3 of the z axis in frame 1; row 3 of the position in frame 1; from both, the other angle is eliminated"
fn eliminated(first: &Row, second: &Row) -> Origin {
    let mut origin = first.origin.with(&second.origin);
    let eliminated = Origin::whole("from both, the other angle is eliminated".to_owned());
    origin.and = Some(Box::new(origin.and.map_or(eliminated.clone(), |and| and.with(&eliminated))));
    origin
}

/// a b - c d
fn product(a: &Polynomial, b: &Polynomial, c: &Polynomial, d: &Polynomial) -> Result<Polynomial, Overflow> {
    a.mul(b)?.sub(&c.mul(d)?)
}

/// A polynomial as one that is linear in the cosine and sine of one angle, the same for all.
pub(super) fn linear(
    polynomial: &Polynomial,
    open: &Open,
    angle: &mut Option<Vec<i16>>,
) -> Result<Option<Linear>, Overflow> {
    let reading = Reading::new(polynomial, open)?;
    let mut linear = [reading.constant(), Polynomial::zero(), Polynomial::zero()];
    for ((frequency, slides), [cos, sin]) in &reading.parts {
        if slides.is_empty() && frequency.iter().all(|k| *k == 0) {
            continue;
        }
        if !slides.is_empty() || angle.get_or_insert_with(|| frequency.clone()) != frequency {
            return Ok(None);
        }
        linear = [reading.constant(), cos.clone(), sin.clone()];
    }
    Ok(Some(linear))
}
