//! One angle from two equations in two angles: a quartic in the tangent of its half.
//!
//! Where a1 cos x + b1 sin x = c1 and a2 cos x + b2 sin x = c2, with coefficients that are linear in the cosine and sine of
//! another angle y, the sum of the squares of cos x and sin x is an equation in y alone. Of two kinds of such pairs it is of
//! the second degree in cos y and sin y, so that it has four roots: where the a and b are known (Elias, "Canonical
//! subproblems for robot inverse kinematics", calls it subproblem 6), and where the two rows are perpendicular, as Pieper's
//! are for the height of a point on three joints and its distance from the first axis.

use super::candidates::{angle, of_table, vanishes};
use super::closure::{Equation, Origin};
use super::polynomial::{Overflow, Polynomial};
use super::reading::{Open, Reading, short};
use super::search::{Class, Found, Solved, State};
use crate::symbolic::expression::Arena;
use crate::symbolic::number::Number;

/// Longer equations are not taken for a pair.
const LONGEST: usize = 96;

/// k + l cos y + m sin y
type Linear = [Polynomial; 3];

/// An equation as x sees it: a cos x + b sin x = c.
struct Row {
    at: usize,
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
        for (at, equation) in state.equations.iter().enumerate() {
            found.extend(row(at, equation, x, &state.open)?);
        }
        for (place, first) in found.iter().enumerate() {
            for second in found.iter().skip(place + 1) {
                list.extend(quartic(arena, state, x, first, second)?);
            }
        }
    }
    Ok(list)
}

fn row(at: usize, equation: &Equation, x: usize, open: &Open) -> Result<Option<Row>, Overflow> {
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
    Ok(own(unknown).then(|| Row { at, a: a.clone(), b: b.clone(), c, origin }))
}

fn quartic(
    arena: &Arena,
    state: &mut State,
    x: usize,
    first: &Row,
    second: &Row,
) -> Result<Option<Found>, Overflow> {
    debug_assert!(first.at < second.at);
    let mut others = state.open.clone();
    others.angles.retain(|angle| *angle != x);
    let mut y = None;
    let mut linear = |polynomial: &Polynomial| linear_in(polynomial, &others, &mut y);
    let rows = [[&first.a, &first.b, &first.c], [&second.a, &second.b, &second.c]];
    let mut read = Vec::new();
    for polynomial in rows.as_flattened() {
        match linear(polynomial)? {
            Some(linear) => read.push(linear),
            None => return Ok(None),
        }
    }
    let (Some(y), [a1, b1, c1, a2, b2, c2]) = (y, read.as_slice()) else { return Ok(None) };
    let known = |linear: &Linear| linear[1].is_zero() && linear[2].is_zero();
    let (mut forms, sound) = if [a1, b1, a2, b2].into_iter().all(known) {
        let determinant = product(&a1[0], &b2[0], &a2[0], &b1[0])?;
        if vanishes(arena, state, &determinant) {
            return Ok(None);
        }
        let sound = of_table(&state.atoms, &determinant);
        let (mut cos, mut sin) = (Linear::default(), Linear::default());
        for ((cos, sin), (c1, c2)) in cos.iter_mut().zip(&mut sin).zip(c1.iter().zip(c2)) {
            *cos = product(c1, &b2[0], c2, &b1[0])?;
            *sin = product(c2, &a1[0], c1, &a2[0])?;
        }
        let one = [determinant, Polynomial::zero(), Polynomial::zero()];
        ([cos, sin, one, Linear::default()], sound)
    } else {
        let Some((alpha, beta)) = perpendicular(rows, [a1, b1, a2, b2])? else { return Ok(None) };
        if vanishes(arena, state, &alpha) || vanishes(arena, state, &beta) {
            return Ok(None);
        }
        let sound = of_table(&state.atoms, &alpha) && of_table(&state.atoms, &beta);
        ([times(c1, &alpha)?, times(c2, &beta)?, times(a1, &alpha)?, times(b1, &alpha)?], sound)
    };
    for (part, name) in forms.iter_mut().flat_map(|form| form.iter_mut().zip(["k", "l", "m"])) {
        *part = short(part, &mut state.atoms, name)?;
    }
    if forms.iter().flat_map(|[_, l, m]| [l, m]).all(|polynomial| vanishes(arena, state, polynomial)) {
        return Ok(None);
    }
    let Some(unknown) = angle(&y) else { return Ok(None) };
    let eliminated = Origin::whole("of which the other angle is eliminated".to_owned());
    let origin = first.origin.with(&second.origin).with(&eliminated);
    let class = if sound { Class::Singular } else { Class::Unsound };
    Ok(Some(Found { unknown, equation: Solved::Quartic(forms), origin, class }))
}

/// a b - c d
fn product(a: &Polynomial, b: &Polynomial, c: &Polynomial, d: &Polynomial) -> Result<Polynomial, Overflow> {
    a.mul(b)?.sub(&c.mul(d)?)
}

fn times(linear: &Linear, factor: &Polynomial) -> Result<Linear, Overflow> {
    let [k, l, m] = linear;
    Ok([k.mul(factor)?, l.mul(factor)?, m.mul(factor)?])
}

/// A polynomial as one that is linear in the cosine and sine of one angle, the same for all.
fn linear_in(
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

/// Where (a2, b2) is alpha / beta (b1, -a1): alpha and beta, both known.
fn perpendicular(
    [[a1, b1, _], [a2, b2, _]]: [[&Polynomial; 3]; 2],
    linear: [&Linear; 4],
) -> Result<Option<(Polynomial, Polynomial)>, Overflow> {
    let minus = Number::integer(-1);
    let [own_a1, own_b1, own_a2, own_b2] = linear;
    let parts = own_a2.iter().zip(own_b1).find(|(_, beta)| !beta.is_zero());
    let (alpha, beta) = match parts {
        Some((alpha, beta)) => (alpha.clone(), beta.clone()),
        None => match own_b2.iter().zip(own_a1).find(|(_, beta)| !beta.is_zero()) {
            Some((alpha, beta)) => (alpha.clone(), beta.scaled(minus)?),
            None => return Ok(None),
        },
    };
    let first = product(a2, &beta, b1, &alpha)?;
    let second = b2.mul(&beta)?.add(&a1.mul(&alpha)?)?;
    Ok((first.is_zero() && second.is_zero() && !alpha.is_zero()).then_some((alpha, beta)))
}
