//! Targets that cannot be handed on to the arm: what solves them is searched in the joints of the mounted arm.

use super::draw;
use crate::kinematics::padded;
use crate::polish::descend;
use crate::reachable::size;
use crate::rules::wrap_all;
use crate::search::indifferent;
use crate::self_motion::free_unknown;
use crate::solutions::{Solution, Solutions};
use crate::unknowns::{UNKNOWNS, Unknowns};
use crate::{
    Branch, Float, Frame, IkError, JointKind, Kinematics, MAX_JOINTS, ProblemInfo, Rule, Seed, SolutionSet,
    Target, residual_tolerance,
};

/// See [`Mounted::QUIET`](crate::Mounted::QUIET). With it, of 2,888 targets of arms of four and five unknowns (general
/// axes, and a UR5 on a tilted base) the joint values that they were made from were missed once.
pub(super) const QUIET: u32 = 24;

/// The most steps from one start. Ten are usual; where two solutions nearly meet, the way along the valley is long.
const STEPS: usize = 100;

/// The arm's problem is asked for so many frames at first, then for one out of so many: it may take much longer than a
/// start.
const FIRST: u32 = 6;
const SELDOM: u32 = 4;

/// Where it isn't asked, or has no answer, so many starts are made instead.
const STARTS: u32 = 3;

/// A problem of a mounted arm with its target.
pub(super) struct Search<'s, S: Float> {
    arm: &'s dyn Kinematics<S>,
    info: &'s ProblemInfo<'s>,
    target: &'s Target<S>,
    unknowns: Unknowns<S>,
    reach: S,
}

/// What was found so far.
struct Found<S: Float> {
    solutions: Solutions<MAX_JOINTS, S>,
    /// The least errors (m, rad) of starts that led nowhere.
    nearest: (S, S),
    refused: Option<Rule<S>>,
}

/// What the equations are at values of the unknowns: the tool frame, what is missing, and how much less of it with each.
type Place<S> = (Frame<S>, [S; 6], [[S; 6]; UNKNOWNS]);

impl<'s, S: Float> Search<'s, S> {
    pub(super) fn new(
        arm: &'s dyn Kinematics<S>,
        info: &'s ProblemInfo<'s>,
        target: &'s Target<S>,
        free: &[S],
    ) -> Result<Self, IkError<S>> {
        let reach = size(arm)?;
        Ok(Self { arm, info, target, unknowns: Unknowns::of(arm, info, free, reach), reach })
    }

    /// Fills the set. `of_arm` gives what the arm's own problem answers for a frame of the mounted tool, and whether there
    /// is anything; frames are drawn about `middle` (m).
    pub(super) fn run(
        &self,
        of_arm: &dyn Fn(&Frame<S>, &mut SolutionSet<S>) -> bool,
        middle: [S; 3],
        seed: Option<Seed<'_, S>>,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        let none = (S::INFINITY, S::INFINITY);
        let mut found = Found { solutions: Solutions::EMPTY, nearest: none, refused: None };
        if let Some(seed) = seed {
            self.follow(&self.unknowns.at(seed.q), seed, &mut found);
        }
        let middle_of_limits = self.arm.rules().middle::<MAX_JOINTS>();
        let wanted = seed.unwrap_or(Seed::new(&middle_of_limits));
        let mut begun = SolutionSet::new();
        let (mut number, mut quiet) = (0, 0);
        while quiet < QUIET {
            number += 1;
            quiet += 1;
            let asks = number <= FIRST || number % SELDOM == 0;
            let frame = draw::frame(self.target, number, self.reach, middle);
            if asks && of_arm(&frame, &mut begun) {
                for solution in begun.iter() {
                    if self.follow(&self.unknowns.at(solution.q), wanted, &mut found) {
                        quiet = 0;
                    }
                }
            } else {
                for start in 0..STARTS {
                    let start = self.unknowns.sample(self.arm, STARTS * number + start);
                    if self.follow(&start, wanted, &mut found) {
                        quiet = 0;
                    }
                }
            }
        }
        found.solutions.drop_misses(self.reach);
        if found.solutions.is_empty() {
            let (position_error, rotation_error) = found.nearest;
            let missed = IkError::Failed { position_error, rotation_error };
            return Err(found.refused.map_or(missed, |rule| IkError::Forbidden { rule }));
        }
        out.fill_padded(self.arm.dof(), found.solutions);
        Ok(())
    }

    /// Goes downhill from values of the unknowns. Whether that led to a solution that is new.
    fn follow(&self, start: &[S; UNKNOWNS], wanted: Seed<'_, S>, found: &mut Found<S>) -> bool {
        let (x, tool) = self.onto(&self.unknowns, start);
        let (position_error, rotation_error) = self.target.errors(&tool);
        if !self.is_met((position_error, rotation_error)) {
            let miss = |(position, rotation): (S, S)| (position / self.reach).max(rotation);
            if miss((position_error, rotation_error)) < miss(found.nearest) {
                found.nearest = (position_error, rotation_error);
            }
            return false;
        }
        let rules = self.arm.rules();
        let mut q = self.unknowns.q(&x);
        wrap_all(rules.windings, &mut q);
        if found.solutions.contains(&q, rules.windings) {
            return false;
        }
        let (mut q, free) = self.representative(&x, wanted);
        wrap_all(rules.windings, &mut q);
        let joints = q.get(..self.arm.dof()).unwrap_or(&q);
        if let Some(rule) = self.arm.broken_condition(self.info.name, joints) {
            found.refused = Some(rule);
            return false;
        }
        let Ok(tool) = self.arm.fk(joints) else { return false };
        let (position_error, rotation_error) = self.target.errors(&tool);
        let before = found.solutions.len();
        // The table's own problem has not been solved for it.
        let branch = Branch::UNKNOWN;
        found.solutions.push(Solution { q, position_error, rotation_error, free, branch }, rules.windings);
        found.solutions.len() > before
    }

    fn is_met(&self, (position_error, rotation_error): (S, S)) -> bool {
        let tolerance = residual_tolerance::<S>();
        position_error <= tolerance * self.reach && rotation_error <= tolerance
    }

    /// The values of the unknowns downhill from others, and the tool frame there.
    fn onto(&self, unknowns: &Unknowns<S>, start: &[S; UNKNOWNS]) -> ([S; UNKNOWNS], Frame<S>) {
        descend(*start, STEPS, S::ZERO, |x| self.at(unknowns, x))
    }

    fn at(&self, unknowns: &Unknowns<S>, x: &[S; UNKNOWNS]) -> Place<S> {
        let padded = unknowns.q(x);
        let q = padded.get(..self.arm.dof()).unwrap_or(&padded);
        let mut twists = [[S::ZERO; 6]; MAX_JOINTS];
        let nowhere = Frame { translation: [S::NAN; 3], ..Frame::IDENTITY };
        let jacobian = self.arm.jacobian_into(q, &mut twists);
        let tool = jacobian.and_then(|()| self.arm.fk(q)).unwrap_or(nowhere);
        let per_reach = S::ONE / self.reach;
        let columns = unknowns.columns(&twists).map(|twist| self.target.gained(&tool, &twist, per_reach));
        (tool, self.target.missing(&tool, per_reach), columns)
    }

    /// The joint values of a solution; where solutions form a curve through it, of the one with the joint that moves most as
    /// it is wanted, and that joint's row.
    fn representative(&self, x: &[S; UNKNOWNS], wanted: Seed<'_, S>) -> ([S; MAX_JOINTS], Option<usize>) {
        let own = self.unknowns.q(x);
        let joints = self.unknowns.joints();
        let asked = core::array::from_fn(|place| place < joints.len());
        let free = free_unknown(asked, None, indifferent(), |away: &[S; UNKNOWNS]| {
            let mut there = *x;
            there.iter_mut().zip(away).for_each(|(value, away)| *value += *away);
            let (_, missing, columns) = self.at(&self.unknowns, &there);
            (missing, columns)
        });
        let Some(joint) = free.and_then(|free| joints.get(free.place)).copied() else { return (own, None) };
        let slides = self.arm.joints().get(joint).is_some_and(|joint| joint.kind == JointKind::Prismatic);
        let aside = wanted.aside * if slides { self.reach } else { S::PI };
        let value = wanted.q.get(joint).copied().unwrap_or(S::ZERO) + aside;
        // With that joint given, the others follow.
        let held = self.unknowns.holding(joint, value);
        let (x, tool) = self.onto(&held, x);
        let q = if self.is_met(self.target.errors(&tool)) { held.q(&x) } else { own };
        (q, Some(self.row(joint)))
    }

    /// The row of a joint: the first whose frame moves with it.
    fn row(&self, joint: usize) -> usize {
        let mut frames = [[Frame::IDENTITY; 2 * MAX_JOINTS]; 2];
        let mut q = padded(&[]);
        for frames in &mut frames {
            let count = self.arm.frames_into(q.get(..self.arm.dof()).unwrap_or(&q), frames);
            if count.is_err() {
                return joint;
            }
            q.iter_mut().skip(joint).take(1).for_each(|value| *value = S::ONE);
        }
        let [before, after] = &frames;
        let moved = before.iter().zip(after).position(|(before, after)| before != after);
        moved.map_or(joint, |frame| frame.saturating_sub(1))
    }
}
