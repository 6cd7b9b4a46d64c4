//! Functions for what nothing better is known of: one step that searches for all unknowns at once.

use super::general::{inputs, sum};
use super::{
    Counts, Form, Function, FunctionKind, Measure, Scalar, Stage, Step, ValueId, target_kind, unknowns,
};
use crate::model::{JointKind, Model, Problem, Target};
use crate::symbolic::inverse_kinematics::rows::{self, Rows};
use crate::symbolic::inverse_kinematics::{Idle, Linear, Refusal};
use dh_core::{BranchBit, BranchWord, Frame, RowChain, Target as Asked};

/// The chain of a [`Step::Descents`], as `dh_core::RowChain` takes it.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowingChain {
    /// Fixed transforms (m): before the first row, between the rows, after the last.
    pub links: Vec<Frame>,
    /// Which rows slide.
    pub prismatic: Vec<bool>,
    /// The value of each row (rad, m): a factor for each unknown, one for each joint that the caller gives, a constant.
    pub forms: Vec<Vec<f64>>,
    /// One an unknown: after how many whole turns of it all is as it was; 0 where it is a length.
    pub turns: Vec<u8>,
    /// Size of the arm (m).
    pub reach: f64,
    /// So many starts in a row without a new solution end the search.
    pub patience: u32,
}

impl FollowingChain {
    /// Hands the chain, as the numeric kernel takes it, to `then`.
    pub fn with<T>(&self, then: impl FnOnce(&RowChain<'_>) -> T) -> T {
        let forms: Vec<&[f64]> = self.forms.iter().map(Vec::as_slice).collect();
        then(&RowChain {
            links: &self.links,
            prismatic: &self.prismatic,
            forms: &forms,
            turns: &self.turns,
            reach: self.reach,
            patience: self.patience,
        })
    }
}

/// Poses of the arm itself at which starts are counted.
const POSES: usize = 12;

/// So many starts each: at first, and at most where some solution was met by fewer than [`ENOUGH`]. Macros are built without
/// optimisation: there a start takes half a millisecond.
const STARTS: u32 = 64;
const MOST_STARTS: u32 = 256;
const ENOUGH: u32 = 4;

/// A solution as rare as the rarest of those is missed once in so many times where determinants must balance: one that is
/// missed alone upsets the balance, and the search goes on.
const MISSED_BALANCED: f64 = 1e3;

/// The same where nothing would tell.
const MISSED: f64 = 1e4;

/// However often all solutions are met.
const LEAST_PATIENCE: u32 = 64;

/// Solutions that are nearer than this (rad, reaches) are one.
const SAME: f64 = 1e-6;

/// What a tool looks at is so far ahead of it (reaches): of the arm's own size, and not in the tool, where any direction
/// would do.
const AHEAD: f64 = 0.7;

/// The function of a problem (an index into `Model::problems`, or the full pose).
///
/// # Errors
/// Why there is none.
pub(super) fn function(model: &Model, index: Option<usize>, problem: &Problem) -> Result<Function, Refusal> {
    let rows = rows::chain(model, problem)?;
    let unknowns = rows.unknowns.len();
    if unknowns == 0 || unknowns > problem.target.rows() {
        return Err(Refusal::Unknowns { unknowns, target: problem.target });
    }
    let given = problem.free.len();
    let mut chain = chain(model, &rows, given);
    let samples = samples(model, problem, &chain);
    refuse_singular(model, problem, &rows, &chain, &samples)?;
    let rarest = rarest(&chain, problem.target, &samples)
        .ok_or(Refusal::NotFound { poses: POSES, starts: MOST_STARTS })?;
    chain.patience = rarest.patience();
    let origin = rarest.origin(chain.patience);

    let (mut values, first_given) = inputs(model, problem);
    let inputs = values.len();
    let names: Vec<String> = rows.unknowns.iter().map(|unknown| name(model, unknown.row)).collect();
    let roots: Vec<ValueId> = (inputs..inputs + unknowns).map(ValueId).collect();
    values.extend(names.iter().cloned());
    let value = |place: usize| match place.checked_sub(unknowns) {
        None => Scalar::Value(ValueId(inputs + place)),
        Some(given) => Scalar::Value(ValueId(first_given + given)),
    };
    let q = rows.q.iter().map(|form| sum(form, value)).collect();
    let stage = Stage {
        rows: rows
            .unknowns
            .iter()
            .fold(0, |mask, unknown| mask | 1_u32.checked_shl(unknown.row as u32).unwrap_or(0)),
        unknown: names.join(", "),
        measure: Measure::Ratio,
        equation: format!("what `{}` prescribes of the tool frame is the target's", problem.target.name()),
        definitions: Vec::new(),
        origin,
        plus: None,
    };
    let row = stage.rows.trailing_zeros() as usize;
    let whole = unknowns == problem.target.rows();
    Ok(Function {
        kind: FunctionKind::Inverse(index),
        values,
        inputs,
        free: problem.free.clone(),
        steps: vec![Step::Descents {
            stage: 0,
            chain,
            given: (0..given).map(|place| Scalar::Value(ValueId(first_given + place))).collect(),
            roots,
            body: vec![Step::Accept { q, tool: Vec::new(), polish: false }],
        }],
        outputs: Vec::new(),
        counts: Counts::default(),
        stages: vec![stage],
        motions: Vec::new(),
        unknowns: in_joints(&rows, given),
        constraints: super::constraints::of(model, index),
        branch: whole.then(|| BranchBit::new(0, BranchWord::Determinant, row)).into_iter().collect(),
        agreement: None,
    })
}

/// Whether a problem's unknowns move what its target prescribes in as many ways as there are of them.
///
/// # Errors
/// [`Refusal::Singular`] where they do so at no pose; and why they can't be written as such.
pub(super) fn regular(model: &Model, problem: &Problem) -> Result<(), Refusal> {
    let rows = rows::chain(model, problem)?;
    let chain = chain(model, &rows, problem.free.len());
    refuse_singular(model, problem, &rows, &chain, &samples(model, problem, &chain))
}

fn chain(model: &Model, rows: &Rows, given: usize) -> FollowingChain {
    let reach = model.reach();
    let dense = |form: &Linear| {
        let mut dense = vec![0.0; rows.unknowns.len() + given + 1];
        for &(place, factor) in &form.terms {
            if let Some(slot) = dense.get_mut(place) {
                *slot += factor;
            }
        }
        if let Some(last) = dense.last_mut() {
            *last = form.constant;
        }
        dense
    };
    let slides = |row: usize| model.rows.get(row).is_some_and(|row| row.kind == JointKind::Prismatic);
    FollowingChain {
        links: rows.links.clone(),
        prismatic: rows.rows.iter().map(|(row, _)| slides(*row)).collect(),
        forms: rows.rows.iter().map(|(_, form)| dense(form)).collect(),
        turns: rows.unknowns.iter().map(|unknown| unknown.turns).collect(),
        reach: if reach > 0.0 { reach } else { 1.0 },
        patience: 0,
    }
}

/// The unknowns in terms of joint values.
fn in_joints(rows: &Rows, given: usize) -> Vec<Option<Form>> {
    // `unknowns::of` has the given ones first.
    let unknowns = rows.unknowns.len();
    let turned = |form: &Linear| {
        let terms = form.terms.iter().map(|&(place, factor)| {
            (if place < unknowns { given + place } else { place - unknowns }, factor)
        });
        Linear { terms: terms.collect(), constant: form.constant }
    };
    let joints: Vec<Linear> = rows.q.iter().map(turned).collect();
    unknowns::of(&joints, given, given + unknowns)
}

/// `theta3`, `d3`
fn name(model: &Model, row: usize) -> String {
    let slides = model.rows.get(row).is_some_and(|row| row.kind == JointKind::Prismatic);
    format!("{}{}", if slides { "d" } else { "theta" }, row + 1)
}

/// Unknowns (rad, m), values that the caller gives, and the tip there: the same on every host.
struct Sample {
    x: [f64; 6],
    given: Vec<f64>,
    tip: Frame,
}

fn samples(model: &Model, problem: &Problem, chain: &FollowingChain) -> Vec<Sample> {
    let row = |joint: &usize| model.joints.get(*joint).and_then(|row| model.rows.get(*row));
    let slides = |joint: &usize| row(joint).is_some_and(|row| row.kind == JointKind::Prismatic);
    let mut random = super::general::Random::new();
    let mut sample = || {
        let mut x = [0.0; 6];
        for (value, turns) in x.iter_mut().zip(&chain.turns) {
            *value = random.value(*turns == 0, chain.reach) * f64::from((*turns).max(1));
        }
        let given: Vec<f64> =
            problem.free.iter().map(|joint| random.value(slides(joint), chain.reach)).collect();
        let tip = chain.with(|chain| chain.tip(&given, &x));
        Sample { x, given, tip }
    };
    (0..POSES).map(|_| sample()).collect()
}

/// What of the tip a target prescribes.
pub(super) fn asked(target: Target, tip: &Frame, reach: f64) -> Asked {
    match target {
        Target::Lookat => Asked::Lookat(tip.transform_point([0.0, 0.0, AHEAD * reach])),
        _ => Asked::of_frame(target_kind(target), tip),
    }
}

/// In how many ways the unknowns move what a target prescribes, at most.
fn rank(chain: &FollowingChain, target: Target, samples: &[Sample]) -> usize {
    let ranks = samples.iter().map(|sample| {
        let asked = asked(target, &sample.tip, chain.reach);
        chain.with(|chain| chain.rank(&asked, &sample.given, &sample.x))
    });
    ranks.max().unwrap_or(0)
}

/// An arm that is singular at every pose has curves of solutions only.
fn refuse_singular(
    model: &Model,
    problem: &Problem,
    rows: &Rows,
    chain: &FollowingChain,
    samples: &[Sample],
) -> Result<(), Refusal> {
    let ways = rank(chain, problem.target, samples);
    let unknowns = rows.unknowns.len();
    if ways == unknowns {
        return Ok(());
    }
    let suiting = Target::ALL.into_iter().filter(|other| other.rows() == unknowns);
    let suiting = suiting.filter(|other| rank(chain, *other, samples) == unknowns).collect();
    let whole = unknowns < Target::Pose.rows() && rank(chain, Target::Pose, samples) == unknowns;
    let idle = idle(model, problem, rows, chain, samples, ways).map(Box::new);
    let moves = |form: &Linear| form.terms.iter().any(|(place, _)| *place < unknowns);
    let joints = model.joints.iter().zip(&rows.q).filter(|(_, form)| moves(form));
    let joints = joints.filter_map(|(row, _)| model.rows.get(*row).map(|row| row.name.clone()));
    let joints = joints.collect();
    Err(Refusal::Singular { joints, idle, unknowns, ways, target: problem.target, suiting, whole })
}

/// An unknown that at no sample moves what a target prescribes, and what the others could meet: in so many ways they move.
fn idle(
    model: &Model,
    problem: &Problem,
    rows: &Rows,
    chain: &FollowingChain,
    samples: &[Sample],
    ways: usize,
) -> Option<Idle> {
    let moves = |place: usize| {
        samples.iter().any(|sample| {
            let asked = asked(problem.target, &sample.tip, chain.reach);
            chain.with(|chain| chain.moves(&asked, &sample.given, &sample.x, place))
        })
    };
    let (_, unknown) = rows.unknowns.iter().enumerate().find(|(place, _)| !moves(*place))?;
    let joint = model.joints.iter().position(|own| *own == unknown.row)?;
    let at_zero = without(model, problem, joint, ways, true).unwrap_or_default();
    let held = !at_zero.is_empty();
    let suiting =
        if held { at_zero } else { without(model, problem, joint, ways, false).unwrap_or_default() };
    let held = held.then(|| format!("q{} = 0", joint + 1));
    Some(Idle { joint: model.rows.get(unknown.row)?.name.clone(), held, suiting })
}

/// Targets with so many rows that the unknowns could meet if this joint were given, or at 0.
fn without(
    model: &Model,
    problem: &Problem,
    joint: usize,
    ways: usize,
    at_zero: bool,
) -> Option<Vec<Target>> {
    let mut others = problem.clone();
    others.free.push(joint);
    let rows = rows::chain(model, &others).ok()?;
    if rows.unknowns.len() != ways {
        return None;
    }
    let chain = chain(model, &rows, others.free.len());
    let mut samples = samples(model, &others, &chain);
    for sample in samples.iter_mut().filter(|_| at_zero) {
        *sample.given.last_mut()? = 0.0;
        sample.tip = chain.with(|chain| chain.tip(&sample.given, &sample.x));
    }
    let suiting = Target::ALL.into_iter().filter(|other| other.rows() == ways);
    Some(suiting.filter(|other| rank(&chain, *other, &samples) == ways).collect())
}

/// How often starts lead to the solution that fewest lead to, of all that were found at some poses.
struct Rarest {
    /// Whether it is noticed where one is missing.
    balanced: bool,
    met: u32,
    starts: u32,
    solutions: usize,
}

impl Rarest {
    /// So many starts miss it as seldom as [`MISSED_BALANCED`] and [`MISSED`] say.
    fn patience(&self) -> u32 {
        let share = f64::from(self.met) / f64::from(self.starts);
        let once_in = if self.balanced { MISSED_BALANCED } else { MISSED };
        let starts = libm::ceil(libm::log(once_in) / -libm::log1p(-share.min(0.999)));
        (starts as u32).max(LEAST_PATIENCE)
    }

    /// What is said of it.
    fn origin(&self, patience: u32) -> String {
        let one_in = f64::from(self.starts) / f64::from(self.met);
        let share = f64::from(self.met) / f64::from(self.starts);
        let missed = libm::pow(1.0 - share, f64::from(patience));
        let chance =
            if missed >= 1e-4 { format!("{:.2} %", 100.0 * missed) } else { "less than 0.01 %".to_owned() };
        let alone = if self.balanced {
            ", and that is noticed unless one with a determinant of the other sign is missed too"
        } else {
            ""
        };
        format!(
            "by damped Gauss-Newton steps from places spread evenly, until {patience} in a row lead to no new solution; of {} solutions at {POSES} sample poses the rarest was met by one place in {one_in:.0}: one as rare is missed with a chance of {chance}{alone}",
            self.solutions
        )
    }
}

/// `None` where no start leads to a solution.
fn rarest(chain: &FollowingChain, target: Target, samples: &[Sample]) -> Option<Rarest> {
    let balanced = samples.first().is_some_and(|sample| {
        let kind = asked(target, &sample.tip, chain.reach).kind();
        chain.with(|chain| chain.balances(kind))
    });
    let mut starts = STARTS;
    loop {
        let counts: Vec<u32> = samples.iter().flat_map(|sample| met(chain, target, sample, starts)).collect();
        let rarest = counts.iter().copied().min();
        if rarest.is_some_and(|met| met >= ENOUGH) || starts >= MOST_STARTS {
            return rarest.map(|met| Rarest { balanced, met, starts, solutions: counts.len() });
        }
        starts *= 2;
    }
}

/// How many starts lead to each solution.
fn met(chain: &FollowingChain, target: Target, sample: &Sample, starts: u32) -> Vec<u32> {
    let asked = asked(target, &sample.tip, chain.reach);
    let mut found: Vec<([f64; 6], u32)> = Vec::new();
    for number in 1..=starts {
        let Some(x) = chain.with(|chain| chain.descend(&asked, &sample.given, number)) else { continue };
        let same = |other: &[f64; 6]| {
            x.iter().zip(other).zip(&chain.turns).all(|((a, b), turns)| {
                let period = f64::from(*turns) * std::f64::consts::TAU;
                let apart = a - b;
                let apart = match turns {
                    0 => apart / chain.reach,
                    _ => apart - period * libm::round(apart / period),
                };
                apart.abs() <= SAME
            })
        };
        match found.iter_mut().find(|(other, _)| same(other)) {
            Some((_, count)) => *count += 1,
            None => found.push((x, 1)),
        }
    }
    found.into_iter().map(|(_, count)| count).collect()
}

#[cfg(test)]
mod tests;
