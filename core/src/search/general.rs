//! Chains without a closed form: all joints at once.

use super::Search;
use crate::descents::{Found, RowChain};
use crate::general::{GeneralArm, JOINTS, SixJoints, same};
use crate::{Float, Frame, IkError, MAX_JOINTS, MAX_SOLUTIONS, Step, Target};

/// How many candidates are kept: the sixteen solutions that six joints can have, and what double roots add.
const MAX_CANDIDATES: usize = 64;

/// Two candidates that are nearer than this (rad; m, in an arm of 1 m) are one.
const SAME: f64 = 1e-6;

/// Points of curves of solutions that are nearest to what is wanted are one, if they are nearer than this (rad; m, in an arm
/// of 1 m): the way to them is slow.
const SAME_POINT: f64 = 0.02;

/// Points of a curve of solutions that are nearer than this (rad; m, in an arm of 1 m) are as good as one, once there are
/// more solutions than an arm can have without such a curve.
const SAME_STRETCH: f64 = 0.3;

/// Values of six joints each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidates {
    step: Step,
    list: [Candidate; MAX_CANDIDATES],
    len: usize,
    next: usize,
}

/// Values of the unknowns, and which of them is free.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Candidate {
    q: [f64; JOINTS],
    free: Option<usize>,
    /// The sign of the determinant of the Jacobian, as a branch has it.
    minus: bool,
}

impl Candidates {
    const fn none(step: Step) -> Self {
        let nothing = Candidate { q: [0.0; JOINTS], free: None, minus: false };
        Self { step, list: [nothing; MAX_CANDIDATES], len: 0, next: 0 }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    fn as_slice(&self) -> &[Candidate] {
        self.list.get(..self.len).unwrap_or(&self.list)
    }

    fn as_mut_slice(&mut self) -> &mut [Candidate] {
        self.list.get_mut(..self.len).unwrap_or_default()
    }

    fn push(&mut self, candidate: Candidate) {
        if let Some(place) = self.list.get_mut(self.len) {
            *place = candidate;
            self.len += 1;
        }
    }
}

/// Values of joints that the caller gives, then zeros.
fn in_f64<S: Float>(given: &[S]) -> [f64; MAX_JOINTS] {
    let mut values = [0.0; MAX_JOINTS];
    values.iter_mut().zip(given).for_each(|(value, given)| *value = given.to_f64());
    values
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The values (rad, m) of the six joints of a chain that are not given, for a target that prescribes its tip wholly
    /// or with the help of joints at the tip that only the chain has. Computed in f64.
    ///
    /// Of solutions that form a curve, those points are returned that are nearest to what is wanted.
    pub fn general(
        &mut self,
        step: Step,
        arm: &GeneralArm<'_>,
        target: &Target<S>,
        given: &[S],
    ) -> Candidates {
        let _ = self.begin(step);
        let mut candidates = Candidates::none(step);
        let values = in_f64(given);
        let (Some(pose), Some(six)) = (target.frame_of_chain(), arm.six(&values)) else {
            return candidates;
        };
        let pose = pose.in_f64();
        // Angles are compared in rad, slides in m.
        let scale = if arm.reach < 1.0 { arm.reach } else { 1.0 };
        let behind = JOINTS.saturating_sub(step.rows.count_ones() as usize);
        let outcome = six.solve(&pose, |solution, determinant| {
            // Either way that three joints make up an orientation is the same solution of the arm.
            let (solution, turned) = if behind >= 3 { six.turned_back(solution) } else { (*solution, false) };
            let solution = &solution;
            let crowded = candidates.len >= MAX_SOLUTIONS && six.is_singular(solution);
            let near = scale * if crowded { SAME_STRETCH } else { SAME };
            if !candidates.as_slice().iter().any(|other| same(&other.q, solution, six.prismatic, near)) {
                let minus = (determinant < 0.0) != turned;
                candidates.push(Candidate { q: *solution, free: None, minus });
            }
        });
        if outcome.doubted || candidates.len > MAX_SOLUTIONS {
            candidates = self.without_curves(&six, &pose, &candidates, scale);
        }
        if candidates.is_empty() {
            let excess = S::from_f64(outcome.miss);
            self.fail_step(step, excess, IkError::Unreachable { step, excess });
        }
        candidates
    }

    /// The values (rad, m) of the unknowns of a chain whose rows follow them, for any target: all that descents from many
    /// places find. Computed in f64.
    ///
    /// Of solutions that form a curve, those points are returned that are nearest to what is wanted.
    pub fn descents(
        &mut self,
        step: Step,
        chain: &RowChain<'_>,
        target: &Target<S>,
        given: &[S],
    ) -> Candidates {
        let _ = self.begin(step);
        let mut candidates = Candidates::none(step);
        let values = in_f64(given);
        let given = values.get(..given.len()).unwrap_or(&values);
        let (wanted, aside) = self.wanted_of_all();
        // Rounding to S leaves rotations and directions that f64 can tell from such.
        let target = target.in_f64();
        let target = target.validate().unwrap_or(target);
        let least = chain.solve(&target, given, (&wanted, aside), &mut |found| {
            let Found { x: q, free, determinant } = *found;
            candidates.push(Candidate { q, free, minus: determinant < 0.0 });
        });
        if candidates.is_empty() {
            let excess = S::from_f64(least);
            self.fail_step(step, excess, IkError::Unreachable { step, excess });
        }
        candidates
    }

    /// What is wanted (rad, m; NaN where nothing is) of unknowns that are found at once, and how far from there.
    fn wanted_of_all(&self) -> ([f64; JOINTS], f64) {
        let Some((unknowns, seed)) = self.wanted else { return ([0.0; JOINTS], 0.0) };
        let mut wanted = [f64::NAN; JOINTS];
        wanted.iter_mut().zip(unknowns).for_each(|(to, from)| *to = from.to_f64());
        (wanted, seed.aside.to_f64())
    }

    /// One point of every curve.
    #[cold]
    #[inline(never)]
    fn without_curves(
        &self,
        six: &SixJoints<'_>,
        pose: &Frame,
        found: &Candidates,
        scale: f64,
    ) -> Candidates {
        let (wanted, aside) = self.wanted_of_all();
        let mut list = Candidates::none(found.step);
        let own = found.step.rows.count_ones() as usize;
        let mut passed = 0_u64;
        for (place, candidate) in found.as_slice().iter().enumerate() {
            let q = six.polished(pose, &candidate.q);
            let mut candidate = Candidate { q, ..*candidate };
            // Where joints move that only the chain has, the arm stands still.
            let on_curve = |q: &[f64; JOINTS]| six.on_curve(pose, q, &wanted, aside, own);
            if let Some(mut point) = on_curve(&q) {
                if passed & 1_u64.wrapping_shl(place as u32) != 0 {
                    continue;
                }
                let others = found.as_slice().iter().map(|other| other.q);
                let (also, nearest) = six.follow(pose, &q, &wanted, own, &others);
                passed |= also;
                point = on_curve(&nearest).unwrap_or(point);
                let (q, _) = if own + 3 <= JOINTS { six.turned_back(&point.q) } else { (point.q, false) };
                candidate = Candidate { q, free: point.joint, minus: six.determinant(&q) < 0.0 };
            }
            let is_known = |other: &Candidate| {
                let both = other.free.is_some() && candidate.free.is_some();
                let near = scale * if both { SAME_POINT } else { SAME };
                same(&other.q, &candidate.q, six.prismatic, near)
                    || (other.free == candidate.free && six.are_one(pose, &other.q, &candidate.q))
            };
            // A marked one before others, and the solution itself before what is nearly one beside it.
            let rank = |one: &Candidate| (one.free.is_none(), six.miss(pose, &one.q));
            match list.as_mut_slice().iter_mut().find(|other| is_known(other)) {
                Some(other) if rank(&candidate) < rank(other) => *other = candidate,
                Some(_) => {}
                None => list.push(candidate),
            }
        }
        list
    }

    /// The next candidate to go on with.
    #[inline]
    pub fn next_candidate(&mut self, candidates: &mut Candidates) -> Option<[S; JOINTS]> {
        let candidate = *candidates.as_slice().get(candidates.next)?;
        candidates.next += 1;
        let step = candidates.step;
        self.free_steps &= !step.bit();
        // No roots that have parted clearly say that this one is another than those that there are.
        self.doubtful = true;
        self.branch = if candidate.minus && step.signed { step.bit() } else { 0 };
        // The joints to be found are the step's rows, base to tip; behind them are those that only the chain has.
        let mut rows = (0..u32::BITS).filter(|row| step.rows & (1 << row) != 0);
        let row = candidate.free.and_then(|place| rows.nth(place));
        if let Some(row) = row {
            // Other points of curves that are known.
            let (from, to) = core::mem::take(&mut self.on_curves);
            self.solutions.drop_places(from, to);
            self.free_steps |= step.bit();
            if let Some(slot) = self.free_rows.get_mut(usize::from(step.index)) {
                *slot = row as u8;
            }
        }
        Some(candidate.q.map(S::from_f64))
    }
}
