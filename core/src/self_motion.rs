//! Whether unknowns can move by themselves, with what is prescribed kept: only then is one of them free.

use crate::Float;
use crate::polish::damped_step;
use crate::search::indifferent;

/// Singular values (reaches, rad) that are smaller than this move nothing: in f64, where the square root of the machine
/// epsilon is less.
const STILL: f64 = 1e-6;

/// Of an unknown, this part (of 1) has to be among what moves nothing.
const LEAST: f64 = 0.03;

/// How far (rad, reaches) unknowns are moved to see whether solutions go on.
const TRIAL: f64 = 0.05;

/// The part of that which an unknown keeps where it is free, at least. Of as many directions as there are unknowns, each of
/// which changes nothing at first, one may be a curve; the unknown that takes the greatest part in it keeps a sixth.
const KEPT: f64 = 0.125;

/// The most steps back to a solution: two or three are usual. Where solutions stand alone, each halves the distance.
const STEPS: usize = 16;

/// The unknown that can move with what is prescribed kept, the others with it as they must: of those that are `asked`
/// for the `preferred` one if it can, else the one that takes the greatest part. `at` gives what is missing at a displacement (rad,
/// reaches) of the unknowns from a solution, and how much less of it with each.
///
/// Directions in which nothing changes at first are necessary for that, but two solutions that have met have one as well. So
/// a step is made, and what is then missing made up for across those directions: from two solutions that have met that leads
/// back to them.
pub(crate) fn free_unknown<const K: usize, S: Float>(
    asked: [bool; K],
    preferred: Option<usize>,
    mut at: impl FnMut(&[S; K]) -> ([S; 6], [[S; 6]; K]),
) -> Option<usize> {
    let (missing, columns) = at(&[S::ZERO; K]);
    let exact = indifferent::<S>().max(S::TWO * norm(&missing));
    let mut open = asked;
    let mut first = preferred;
    loop {
        let is_open = |place: &usize| open.get(*place) == Some(&true);
        let parts = (0..K).filter(is_open).map(|place| (place, still(&columns, place)));
        let greater = |a: (usize, [S; K]), b: (usize, [S; K])| if norm(&b.1) > norm(&a.1) { b } else { a };
        let chosen = first.take().filter(is_open).map(|place| (place, still(&columns, place)));
        let (place, direction) = chosen.or_else(|| parts.reduce(greater))?;
        *open.get_mut(place)? = false;
        let size = norm(&direction);
        let goes_on = |length: S| {
            let step = direction.map(|part| part * (length / size));
            let own = |x: &[S; K]| x.get(place).copied().unwrap_or(S::ZERO);
            back(step, exact, &mut at).is_some_and(|end| own(&end) / own(&step) > S::from_f64(KEPT))
        };
        let trial = S::from_f64(TRIAL);
        if size > S::from_f64(LEAST) && [trial, -trial].into_iter().any(goes_on) {
            return Some(place);
        }
    }
}

/// Of an unknown, the part that changes nothing at first.
fn still<const K: usize, S: Float>(columns: &[[S; 6]; K], place: usize) -> [S; K] {
    let mut direction = [S::ZERO; K];
    direction.iter_mut().skip(place).take(1).for_each(|part| *part = S::ONE);
    let change = columns.get(place).copied().unwrap_or([S::ZERO; 6]);
    let made_up_for = damped_step(columns, change, least());
    direction.iter_mut().zip(made_up_for).for_each(|(part, own)| *part -= own);
    direction
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
