//! Arms that are nearly special: axes that are a little off parallel, or a little off meeting.
//!
//! Such an arm has no closed form, but the one that it was meant to be has. That is solved, and each of its solutions is
//! brought to the pose of the arm as it is by Newton's method. None is lost by this as long as every step of the closed form
//! is well-conditioned: joint values of the arm meet the steps' equations but for the deviation of the two arms, and so are
//! near a root of each, one after the other. What they may be off by is carried from step to step, and where it comes near
//! what would make two roots one, or no root of one, solutions are looked for along the curve on which the tool hardly moves
//! ([`curve`]); where that is not enough, by the general chain and at poses all around the target ([`seek`]).

mod asked;
mod blocks;
mod cubic;
mod curve;
mod newton;
mod reduced;
mod seek;
mod starts;
mod steps;

use super::conditions::held;
use super::{Roots, Search};
use crate::branch::bit_of;
use crate::frame::{dot, sub};
use crate::{
    Branch, Float, Frame, GeneralArm, IkError, MAX_SOLUTIONS, Polished, Rule, Solution, Solutions, Target,
    Winding, residual_tolerance,
};
use asked::Asked;
use curve::Arm;
use seek::Seek;

/// How many unknowns a pose has. Targets of fewer rows have as many as they have rows.
const UNKNOWNS: usize = 6;

/// What a nearly special arm is to the one that it was meant to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearly<'a> {
    /// The joints that are found (indices of q): as many as the target has rows.
    pub unknowns: &'a [usize],
    /// Joints that constraints make follow them: which unknown (an index into `unknowns`), which joint, by what factor.
    pub follow: &'a [(usize, usize, f64)],
    /// By how much each step of the closed form is off, in the size of its equation: first what the deviation of the two
    /// arms makes at most; then, for the unknown of every step before, what one that is off by 1 (rad, reaches) does.
    pub gains: &'a [f64],
    /// How far apart the tool frames of the two are at the same joint values, at most (reaches, rad).
    pub deviation: f64,
    /// Whether the determinants of the Jacobians by these joints and by those of the arm's chain differ in sign.
    pub mirrored: bool,
    /// The arm as it is as a chain of six joints, where that has each solution once and no joint is given.
    pub chain: Option<Exact<'a>>,
}

/// A nearly special arm as its table has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact<'a> {
    /// Its chain.
    pub arm: GeneralArm<'a>,
    /// Every joint of the arm as a form in those of the chain (rad, m).
    pub joints: &'a [Form],
}

/// A form in the joints of a chain: a factor each and a constant.
pub type Form = [f64; UNKNOWNS + 1];

/// A search of the arm that a nearly special one was meant to be.
///
/// It has the steps of [`Search`], which are to be done for every target of [`Near::next_target`]. Where no step came near its
/// singular condition, that is one alone.
#[derive(Debug, Clone)]
pub struct Near<'a, const N: usize, S = f64> {
    search: Search<'a, N, S>,
    unknowns: &'a [usize],
    follow: &'a [(usize, usize, f64)],
    gains: &'a [f64],
    /// What the unknown of each step may be off by (rad, reaches).
    off: [S; STEPS],
    doubtful: bool,
    /// What is singular among the steps that were solved last.
    singular: Singular,
    target: Target<S>,
    /// See [`asked::across`].
    across: [[S; 3]; 2],
    begun: bool,
    seek: Option<Seek<N, S>>,
    /// Whether a step has four roots: of these nothing is known at folds, and poses beside the target may have none.
    quartic: bool,
    deviation: f64,
    chain: Option<Exact<'a>>,
    labels: Labels<'a, S>,
}

/// Which steps are singular: bit i stands for step i.
#[derive(Debug, Clone, Copy, Default)]
struct Singular {
    /// Two roots have met, as far as is known; of these, those that have no root of the arm that was meant.
    folds: u32,
    beyond: u32,
    /// The two roots of an angle have met, by which another step loses its coefficients.
    poles: u32,
    /// Coefficients vanish: any value will do.
    idle: u32,
}

impl Singular {
    /// Without the steps of these bits.
    const fn without(self, bits: u32) -> Self {
        Self {
            folds: self.folds & !bits,
            beyond: self.beyond & !bits,
            poles: self.poles & !bits,
            idle: self.idle & !bits,
        }
    }

    const fn is_none(self) -> bool {
        (self.folds | self.poles | self.idle) == 0
    }
}

/// What solutions are labelled with.
#[derive(Debug, Clone, Copy)]
struct Labels<'a, S> {
    windings: &'a [Winding<'a, S>],
    /// The step that solves the arm as it is: it comes after those of the closed form.
    step: u8,
    /// See [`Nearly::mirrored`].
    mirrored: bool,
}

impl<S: Float> Labels<'_, S> {
    /// Joint values that were found, where the determinant of the Jacobian is negative or not.
    fn solution<const N: usize>(&self, found: &Polished<N, S>, negative: bool) -> Solution<N, S> {
        let Polished { mut q, position_error, rotation_error } = *found;
        crate::rules::wrap_all(self.windings, &mut q);
        let minus = negative != self.mirrored;
        let branch = if minus { Branch::of_steps(bit_of(self.step)) } else { Branch::PLUS };
        Solution { q, position_error, rotation_error, free: None, branch }
    }
}

/// The most steps that are kept track of.
const STEPS: usize = 16;

/// A coefficient is this many times what it may be off by, at least.
const MARGIN: f64 = 2.0;

/// What an unknown may be off by (rad, reaches) where its step is well-conditioned.
const UNSURE: f64 = 0.5;

/// From a solution of which the determinant is smaller, others that belong to no root of their own are no farther along its curve
/// than this (rad, reaches).
const NEIGHBOURS: f64 = 1.0;

/// A first step of Newton's method (rad, reaches) that is longer than this may have left its solution for another.
const SHORT: f64 = 0.2;

/// At a fold beyond reach, a target that is missed by more than so many times what the arm is off by (reaches, rad) has no
/// solution.
const APART: f64 = 8.0;

/// A candidate that misses the target (reaches, rad) by no more than so many machine epsilons does so by rounding.
const MET: f64 = 1e6;

impl<'a, const N: usize, S: Float> Near<'a, N, S> {
    /// A new search, see [`Search::new`], for a target.
    #[inline]
    pub fn new(reach: S, windings: &'a [Winding<'a, S>], nearly: &Nearly<'a>, target: &Target<S>) -> Self {
        Self {
            search: Search::new(reach, windings),
            unknowns: nearly.unknowns,
            follow: nearly.follow,
            gains: nearly.gains,
            off: [S::ZERO; STEPS],
            doubtful: false,
            singular: Singular::default(),
            target: *target,
            across: asked::across(target),
            begun: false,
            seek: None,
            quartic: false,
            deviation: nearly.deviation,
            chain: nearly.chain,
            labels: Labels { windings, step: steps(nearly.gains.len()), mirrored: nearly.mirrored },
        }
    }

    /// The next target that the arm that was meant is to be solved for.
    #[inline]
    pub fn next_target(&mut self) -> Option<Target<S>> {
        if self.begun {
            if self.seek.is_none() {
                let found = &self.search.solutions;
                self.doubtful |= !are_pairs(found) || found.len() == MAX_SOLUTIONS;
            }
            return if self.doubtful { self.next_neighbour() } else { None };
        }
        self.begun = true;
        Some(self.target)
    }

    /// The next root (rad or m) to go on with.
    #[inline]
    pub fn next(&mut self, roots: &mut Roots<S>) -> Option<S> {
        if self.stopped() { None } else { self.search.next(roots) }
    }

    /// The same for an angle (rad), with its sine and cosine.
    #[inline]
    pub fn next_angle(&mut self, roots: &mut Roots<S>) -> Option<(S, S, S)> {
        if self.stopped() { None } else { self.search.next_angle(roots) }
    }

    /// Whether the closed form alone was tried in vain.
    #[inline]
    fn stopped(&self) -> bool {
        self.doubtful && self.seek.is_none()
    }

    /// A solution of the arm that was meant, with its tool frame there: brought to the target by Newton's method on the arm
    /// as it is, of which `pose_and_jacobian` is the tool frame with the columns of the Jacobian.
    #[inline]
    pub fn accept(
        &mut self,
        q: [S; N],
        tool: &Frame<S>,
        mut pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        if self.seek.is_some() {
            self.seek_from(q, tool, pose_and_jacobian);
        } else {
            let met = self.is_met(tool);
            let range = if met { self.corrected(q, &mut pose_and_jacobian) } else { S::INFINITY };
            if range > S::ZERO {
                self.doubted(q, tool, met, range, pose_and_jacobian);
            }
        }
    }

    /// Whether a tool frame is the target's but for rounding.
    #[inline]
    fn is_met(&self, tool: &Frame<S>) -> bool {
        let most = (S::from_f64(MET) * S::EPSILON).min(residual_tolerance());
        let far = most * self.search.reach;
        let Target::Pose(target) = &self.target else {
            let (position_error, rotation_error) = self.target.errors(tool);
            return position_error <= far && rotation_error <= most;
        };
        let away = sub(tool.translation, target.translation);
        let [a, b, c] = tool.rotation;
        let [d, e, f] = target.rotation;
        let (a, b, c) = (sub(a, d), sub(b, e), sub(c, f));
        // The squares of the distance, and of the angle; twice that is what the rows are apart.
        above(far * far, dot(away, away)) && above(S::TWO * most * most, dot(a, a) + dot(b, b) + dot(c, c))
    }

    /// What is asked of the arm as it is.
    #[inline]
    fn asked<'t>(&self, target: &'t Target<S>) -> Asked<'t, S>
    where
        'a: 't,
    {
        Asked {
            target,
            unknowns: self.unknowns,
            follow: self.follow,
            across: self.across,
            reach: self.search.reach,
        }
    }

    /// Adds the solution of the arm as it is that is next to a root, and says how far from there (rad, reaches) others may be
    /// that belong to no other root.
    #[inline]
    fn corrected(
        &mut self,
        q: [S; N],
        pose_and_jacobian: &mut impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) -> S {
        let Some(found) = newton::solve(q, &self.asked(&self.target), pose_and_jacobian) else {
            return S::INFINITY;
        };
        let solution = self.labels.solution(&found.at, found.determinant < S::ZERO);
        let new = self.search.solutions.append_new(solution, self.search.windings);
        if !new || found.turned || found.first > S::from_f64(SHORT) {
            return S::INFINITY;
        }
        let simple = found.is_clear_of(S::from_f64(self.deviation));
        if simple { S::ZERO } else { S::from_f64(NEIGHBOURS) }
    }

    /// A candidate that is none of the arm that was meant, or beside which there may be any number of solutions.
    #[cold]
    #[inline(never)]
    fn doubted(
        &mut self,
        q: [S; N],
        tool: &Frame<S>,
        met: bool,
        range: S,
        pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        let target = self.target;
        let (position_error, rotation_error) = target.errors(tool);
        self.search.miss(position_error, rotation_error);
        if !met && self.singular.is_none() {
            // A false root of a squared equation; of one that nearly is none, nothing is known.
            let most = self.off.iter().fold(S::ZERO, |most, off| if *off > most { *off } else { most });
            let missed = (position_error / self.search.reach).max(rotation_error);
            if above(missed, S::from_f64(MARGIN) * most) {
                return;
            }
        }
        let deviation = S::from_f64(self.deviation);
        let mut arm = Arm { asked: self.asked(&target), labels: &self.labels, deviation, pose_and_jacobian };
        let vague = self.off.iter().any(|off| *off >= S::from_f64(UNSURE));
        let all = match [self.singular.folds, self.singular.poles, self.singular.idle].map(u32::count_ones) {
            [0, 0, 0] => arm.follow(q, range, &mut self.search.solutions),
            [0, 0 | 1, 0 | 1] => arm.follow(q, S::INFINITY, &mut self.search.solutions),
            [1, 0, idle] => {
                // What cannot be reached is missing at the fold, but for what the arm is off; nothing is amplified on the way.
                let apart = S::from_f64(APART) * deviation;
                let out = self.singular.beyond != 0
                    && idle == 0
                    && arm.missing(q).is_some_and(|missing| missing > apart);
                // Where the two roots are, at most. With another joint that nearly is any, there is more than a curve.
                let off =
                    self.off.get(self.singular.folds.trailing_zeros() as usize).map_or(S::ONE, |off| *off);
                let range = S::ONE + S::from_f64(4.0) * off;
                out || (idle == 0 && !vague && arm.follow(q, range, &mut self.search.solutions))
            }
            _ => false,
        };
        self.doubtful |= !all;
    }

    /// What was found, or that there is nothing to be found; `None` where that is not sure.
    #[inline]
    pub fn finish(&mut self) -> Option<Result<Solutions<N, S>, IkError<S>>> {
        if self.doubtful { self.sought() } else { Some(self.search.finish()) }
    }

    /// The same with the conditions of a problem: which of them joint values break.
    pub fn finish_where(
        &mut self,
        broken: impl Fn(&[S; N]) -> Option<Rule<S>>,
    ) -> Option<Result<Solutions<N, S>, IkError<S>>> {
        Some(self.finish()?.and_then(|found| held(&found, broken)))
    }
}

/// Where the gains of a step begin: step i has i + 1 of them.
const fn row(index: usize) -> usize {
    index * (index + 1) / 2
}

/// How many steps have so many gains.
const fn steps(gains: usize) -> u8 {
    let mut count = 0;
    while row(count as usize) < gains {
        count += 1;
    }
    count
}

/// Real solutions come and go in pairs, one on each side of a singularity.
#[inline]
fn are_pairs<const N: usize, S: Float>(found: &Solutions<N, S>) -> bool {
    let minus = found.iter().filter(|solution| solution.branch != Branch::PLUS).count();
    found.len() == 2 * minus
}

/// Whether a number is greater than another; not where one is none.
fn above<S: Float>(a: S, b: S) -> bool {
    a > b
}
