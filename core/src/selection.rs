//! Which solutions the limits and rules allow, and which of their windings.

use crate::rules::within;
use crate::solutions::travel;
use crate::windings::{Unlimited, Windings, turns_inside};
use crate::{Float, IkError, Rule, Rules, Solution, Solutions, Winding};

/// How many windings of one solution are tried where limits on sums or carried turns forbid choosing joint by joint.
/// Limits of two turns on each of six joints make 64.
const MAX_WINDINGS_TRIED: usize = 4096;

impl<const N: usize, S: Float> Solutions<N, S> {
    /// The solutions that whole turns bring inside the limits and that no rule forbids, each in one representative:
    /// that nearest to the seed, else to the middle of the limits (joints without limits: to 0). The order stays;
    /// with a seed, the nearest comes first.
    ///
    /// `position_of` gives the tool point (m) in the frame of the rules; it is asked only where there are such rules.
    ///
    /// # Errors
    /// [`IkError::OutsideLimits`] of the solution nearest to being allowed, where none is inside its joint limits;
    /// else [`IkError::Forbidden`].
    pub fn within(
        self,
        rules: &Rules<'_, S>,
        position_of: impl Fn(&[S; N]) -> [S; 3],
        seed: Option<&[S; N]>,
    ) -> Result<Self, IkError<S>> {
        let mut allowed = Self::EMPTY;
        let mut refusal: Option<Refusal<S>> = None;
        for solution in &self {
            let verdict = representative(solution, rules, seed).and_then(|q| {
                let restricted = !(rules.bounds.is_empty() && rules.keep_out.is_empty());
                match restricted.then(|| rules.broken_workspace(position_of(&q))).flatten() {
                    Some(rule) => Err(Refusal::Rule(rule)),
                    None => Ok(q),
                }
            });
            match verdict {
                Ok(q) => allowed.append(Solution { q, ..*solution }),
                Err(new) => refusal = Some(refusal.map_or(new, |old| old.milder(new))),
            }
        }
        if allowed.is_empty() {
            return Err(refusal.map_or(IkError::NotFinite, Refusal::into_error));
        }
        if let Some(seed) = seed {
            allowed.sort_by_distance(seed);
        }
        Ok(allowed)
    }
}

/// Why a solution isn't allowed.
#[derive(Debug, Clone, Copy)]
enum Refusal<S> {
    /// No winding is inside the joint limits; the joint that is furthest outside.
    Outside { joint: usize, value: S, min: S, max: S, excess: S },
    /// Inside the joint limits, but a rule forbids it.
    Rule(Rule<S>),
}

impl<S: Float> Refusal<S> {
    /// The refusal of that solution which is nearer to being allowed.
    fn milder(self, new: Self) -> Self {
        match (self, new) {
            (Self::Outside { excess: old, .. }, Self::Outside { excess, .. }) if excess < old => new,
            (Self::Outside { .. }, Self::Rule(_)) => new,
            _ => self,
        }
    }

    fn into_error(self) -> IkError<S> {
        match self {
            Self::Outside { joint, value, min, max, .. } => IkError::OutsideLimits { joint, value, min, max },
            Self::Rule(rule) => IkError::Forbidden { rule },
        }
    }
}

/// The winding of a solution that is to be used.
fn representative<const N: usize, S: Float>(
    solution: &Solution<N, S>,
    rules: &Rules<'_, S>,
    seed: Option<&[S; N]>,
) -> Result<[S; N], Refusal<S>> {
    let mut reference = [S::ZERO; N];
    match seed {
        Some(seed) => reference = *seed,
        None => {
            for (value, joint) in reference.iter_mut().zip(rules.joints) {
                *value = joint.limits.map_or(S::ZERO, |limits| limits.middle());
            }
        }
    }
    let q = nearest_winding(rules, &solution.q, &reference);
    let carried = rules.windings.iter().any(|winding| !winding.carries.is_empty());
    let outside = furthest_outside(rules, &q);
    let sum = rules.broken_sum(&q);
    // Joint by joint is right unless joints depend on each other.
    if carried || sum.is_some() {
        let mut best: Option<([S; N], S)> = None;
        for other in Windings::new(q, *rules, Unlimited::OneTurn).take(MAX_WINDINGS_TRIED) {
            let distance = travel(&other, &reference);
            if best.is_none_or(|(_, least)| distance < least) {
                best = Some((other, distance));
            }
        }
        if let Some((other, _)) = best {
            return Ok(clamped(other, rules));
        }
    }
    match (outside, sum) {
        (Some(outside), _) => Err(outside),
        (None, Some(rule)) => Err(Refusal::Rule(rule)),
        (None, None) => Ok(clamped(q, rules)),
    }
}

/// The winding of joint values that is to be compared with a reference: inside the limits where whole turns, joint by
/// joint, bring it there; else nearest to the reference.
pub(crate) fn nearest_winding<const N: usize, S: Float>(
    rules: &Rules<'_, S>,
    q: &[S; N],
    reference: &[S; N],
) -> [S; N] {
    let mut nearest = *q;
    for winding in rules.windings {
        let turns = turns_towards(winding, rules, &nearest, reference);
        winding.apply(&mut nearest, turns);
    }
    nearest
}

/// How many turns bring the winding's joint inside its limits and nearest to the reference; where none does, nearest
/// to the limits.
fn turns_towards<S: Float>(winding: &Winding<'_, S>, rules: &Rules<'_, S>, q: &[S], reference: &[S]) -> S {
    let (Some(value), Some(reference)) = (q.get(winding.joint), reference.get(winding.joint)) else {
        return S::ZERO;
    };
    let apart = (*reference - *value).abs();
    let nearest = apart + apart < winding.turn;
    let limits = rules.joints.get(winding.joint).and_then(|joint| joint.limits);
    if nearest && limits.is_none_or(|limits| limits.contains(*value)) {
        return S::ZERO;
    }
    let wanted = ((*reference - *value) / winding.turn).round();
    let Some((first, last)) = turns_inside(winding, rules, q) else {
        return if wanted.is_finite() { wanted } else { S::ZERO };
    };
    let (first, last) = (S::from_f64(f64::from(first)), S::from_f64(f64::from(last)));
    if first <= last {
        return wanted.max(first).min(last);
    }
    // No turn is inside: `last` is below the limits, `first` above.
    let excess = |turns: S| limits.map_or(S::ZERO, |limits| limits.excess(*value + turns * winding.turn));
    if excess(last) < excess(first) { last } else { first }
}

/// The joint that is furthest outside its limits.
fn furthest_outside<S: Float>(rules: &Rules<'_, S>, q: &[S]) -> Option<Refusal<S>> {
    let mut worst: Option<(Refusal<S>, S)> = None;
    for (joint, (row, value)) in rules.joints.iter().zip(q).enumerate() {
        let Some(limits) = row.limits.filter(|limits| !within(limits, *value)) else {
            continue;
        };
        let excess = limits.excess(*value);
        if worst.is_none_or(|(_, most)| excess > most) {
            let refusal = Refusal::Outside { joint, value: *value, min: limits.min, max: limits.max, excess };
            worst = Some((refusal, excess));
        }
    }
    worst.map(|(refusal, _)| refusal)
}

/// Takes off the last digits by which a value may be beyond its limits.
fn clamped<const N: usize, S: Float>(mut q: [S; N], rules: &Rules<'_, S>) -> [S; N] {
    for (value, joint) in q.iter_mut().zip(rules.joints) {
        if let Some(limits) = joint.limits {
            *value = limits.clamp(*value);
        }
    }
    q
}
