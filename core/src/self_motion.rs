//! Whether unknowns can move by themselves, with what is prescribed kept: only then is one of them free.

use crate::Float;
use crate::polish::damped_step;

/// Singular values (reaches, rad) that are smaller than this move nothing: in f64, where the square root of the machine
/// epsilon is less.
const STILL: f64 = 1e-6;

/// Of an unknown, this part (of 1) has to be among what moves nothing.
const LEAST: f64 = 0.03;

/// How far (rad, reaches) unknowns are moved to see whether solutions go on.
const TRIAL: f64 = 0.05;

/// The part of that which an unknown keeps where it is free, at least. Where it keeps less, the step may have been along a direction
/// in which two solutions have met, more than along a curve.
const KEPT: f64 = 0.125;

/// So many such steps are made where it is asked how far.
const FAR: usize = 30;

/// The most steps back along a self-motion: each leaves of the way what is curved.
const RETURNS: usize = 6;

/// The most steps back to a solution: two or three are usual. Where solutions stand alone, each halves the distance.
const STEPS: usize = 16;

/// An unknown that can move with what is prescribed kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FreeUnknown<const K: usize, S> {
    /// Which one.
    pub(crate) place: usize,
    /// A displacement of all unknowns (rad, reaches) after which solutions go on.
    pub(crate) way: [S; K],
}

/// The unknown that can move with what is prescribed kept, the others with it as they must: of those that are `asked`
/// for the `preferred` one if it can, else the one that takes the greatest part. `at` gives what is missing at a displacement (rad,
/// reaches) of the unknowns from a solution, and how much less of it with each; what is missing by up to `exact`, or twice as much as
/// at the solution, counts as met.
///
/// Directions in which nothing changes at first are necessary for that, but two solutions that have met have one as well. So
/// a step is made, and what is then missing made up for across those directions: from two solutions that have met that leads
/// back to them. Where they have met on a curve, the direction is part of one and part of the other, and little of the step may be
/// left; from where it led to, the curve alone goes on, and a second step shows it.
pub(crate) fn free_unknown<const K: usize, S: Float>(
    asked: [bool; K],
    preferred: Option<usize>,
    exact: S,
    mut at: impl FnMut(&[S; K]) -> ([S; 6], [[S; 6]; K]),
) -> Option<FreeUnknown<K, S>> {
    let (missing, columns) = at(&[S::ZERO; K]);
    let exact = exact.max(S::TWO * norm(&missing));
    let mut open = asked;
    let mut first = preferred;
    loop {
        let is_open = |place: &usize| open.get(*place) == Some(&true);
        let parts = (0..K).filter(is_open).map(|place| (place, still(&columns, place)));
        let greater = |a: (usize, [S; K]), b: (usize, [S; K])| if norm(&b.1) > norm(&a.1) { b } else { a };
        let chosen = first.take().filter(is_open);
        let greatest = || parts.reduce(greater).filter(|(_, part)| norm(part) > S::from_f64(LEAST));
        let place = chosen.or_else(|| greatest().map(|(place, _)| place))?;
        *open.get_mut(place)? = false;
        let mut goes_on = |length: S| {
            let (mut end, kept) = step_of(place, &[S::ZERO; K], length, exact, &mut at)?;
            if !kept {
                let (second, kept) = step_of(place, &end, length, exact, &mut at)?;
                end = if kept { second } else { return None };
            }
            returns(end, exact, &mut at).then_some(end)
        };
        let trial = S::from_f64(TRIAL);
        if let Some(way) = [trial, -trial].into_iter().find_map(&mut goes_on) {
            return Some(FreeUnknown { place, way });
        }
    }
}

/// The solution to which a step of an unknown of such a length leads, from another one, and whether enough of the step is left.
fn step_of<const K: usize, S: Float>(
    place: usize,
    from: &[S; K],
    length: S,
    exact: S,
    at: &mut impl FnMut(&[S; K]) -> ([S; 6], [[S; 6]; K]),
) -> Option<([S; K], bool)> {
    let direction = still(&at(from).1, place);
    let size = norm(&direction);
    if size <= S::from_f64(LEAST) {
        return None;
    }
    let mut start = *from;
    start.iter_mut().zip(direction).for_each(|(value, part)| *value += part * (length / size));
    let end = back(start, exact, at)?;
    let own = |x: &[S; K]| x.get(place).copied().unwrap_or(S::ZERO);
    let (gone, step) = (own(&end) - own(from), own(&start) - own(from));
    Some((end, gone / step > S::from_f64(KEPT)))
}

/// Whether the way back along what changes nothing leads from a solution to the one that displacements are from. Else it has been
/// another one's curve, beside it.
fn returns<const K: usize, S: Float>(
    from: [S; K],
    exact: S,
    at: &mut impl FnMut(&[S; K]) -> ([S; 6], [[S; 6]; K]),
) -> bool {
    let mut here = from;
    for _ in 0..RETURNS {
        let home = unmoving(&at(&here).1, here.map(|value| -value));
        here.iter_mut().zip(home).for_each(|(value, part)| *value += part);
        match back(here, exact, at) {
            Some(solution) => here = solution,
            None => return false,
        }
        if norm(&here) <= least() {
            return true;
        }
    }
    false
}

/// Whether solutions go on for [`FAR`] in the direction of a displacement, step by step; `exact` as for [`free_unknown`]. Next to where
/// links lie on each other what is missing grows with the square of the way, and very slowly.
pub(crate) fn goes_far<const K: usize, S: Float>(
    displacement: [S; K],
    exact: S,
    mut at: impl FnMut(&[S; K]) -> ([S; 6], [[S; 6]; K]),
) -> bool {
    let (mut here, mut ahead) = ([S::ZERO; K], displacement);
    for _ in 0..FAR {
        let way = unmoving(&at(&here).1, ahead);
        let size = S::from_f64(TRIAL) / norm(&way);
        let mut next = here;
        next.iter_mut().zip(way).for_each(|(value, part)| *value += part * size);
        let Some(next) = back(next, exact, &mut at) else { return false };
        ahead = next;
        ahead.iter_mut().zip(here).for_each(|(next, here)| *next -= here);
        here = next;
    }
    true
}

/// The solution, met to `exact`, near a displacement (rad, reaches) along a self-motion.
pub(crate) fn beside<const K: usize, S: Float>(
    displacement: [S; K],
    exact: S,
    mut at: impl FnMut(&[S; K]) -> ([S; 6], [[S; 6]; K]),
) -> Option<[S; K]> {
    let end = back(displacement, exact, &mut at)?;
    let mut apart = end;
    apart.iter_mut().zip(displacement).for_each(|(end, from)| *end -= from);
    (norm(&apart) <= S::from_f64(TRIAL)).then_some(end)
}

/// Of an unknown, the part that changes nothing at first.
fn still<const K: usize, S: Float>(columns: &[[S; 6]; K], place: usize) -> [S; K] {
    let mut direction = [S::ZERO; K];
    direction.iter_mut().skip(place).take(1).for_each(|part| *part = S::ONE);
    unmoving(columns, direction)
}

/// The same of a displacement.
fn unmoving<const K: usize, S: Float>(columns: &[[S; 6]; K], mut displacement: [S; K]) -> [S; K] {
    let mut change = [S::ZERO; 6];
    for (column, part) in columns.iter().zip(displacement) {
        change.iter_mut().zip(column).for_each(|(sum, own)| *sum += *own * part);
    }
    let made_up_for = damped_step(columns, change, least());
    displacement.iter_mut().zip(made_up_for).for_each(|(part, own)| *part -= own);
    displacement
}

/// The solution to which steps lead that don't use what changes nothing.
fn back<const K: usize, S: Float>(
    start: [S; K],
    exact: S,
    at: &mut impl FnMut(&[S; K]) -> ([S; 6], [[S; 6]; K]),
) -> Option<[S; K]> {
    let mut x = start;
    for _ in 0..STEPS {
        let (missing, columns) = at(&x);
        let off = norm(&missing);
        if off <= exact {
            return Some(x);
        }
        let step = damped_step(&columns, missing, least::<S>().max(off));
        x.iter_mut().zip(step).for_each(|(value, change)| *value += change);
    }
    None
}

fn least<S: Float>() -> S {
    S::from_f64(STILL).max(S::SQRT_EPSILON)
}

fn norm<const K: usize, S: Float>(vector: &[S; K]) -> S {
    vector.iter().fold(S::ZERO, |sum, x| sum + *x * *x).sqrt()
}
