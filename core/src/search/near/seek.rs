//! Where the closed form is not sure to find everything: it is asked for poses all around the target as well.
//!
//! Joint values that bring the arm as it is to the target bring the one that was meant to a pose near by. Where its closed
//! form is singular at the target, it is not at most of these; roots that have met at the target part on one side of it.

use super::asked::Asked;
use super::curve::{Arm, apart};
use super::{Exact, Form, Near, UNKNOWNS, are_pairs};
use crate::evenly::evenly;
use crate::polish::Polished;
use crate::search::Search;
use crate::{Float, Frame, IkError, MAX_SOLUTIONS, Solution, Solutions, Target, Wanted, Winding};

/// What has been found at poses around the target.
#[derive(Debug, Clone)]
pub(super) struct Seek<const N: usize, S> {
    /// The target that is asked for.
    target: Target<S>,
    /// How many were.
    asked: u32,
    /// Of them, those since the last that led to something new.
    pub(super) idle: u32,
    pub(super) found: Solutions<N, S>,
    /// Whether that is all, as the general chain says.
    complete: bool,
    /// Whether one is so nearly singular that others may be beside it.
    pub(super) crowded: bool,
    /// Whether what was found before there were neighbours has been looked at.
    sifted: bool,
    /// What was found on curves of solutions.
    on_curves: Solutions<N, S>,
    /// Solutions from which curves were followed, or to which.
    walked: [[S; N]; PLACES],
    places: usize,
}

/// So many poses in a row that lead to nothing new are the last.
pub(super) const PATIENCE: u32 = 7;

/// The same for targets that leave something of the pose open.
const LONGER: u32 = 15;

/// But no more than this.
const MOST: u32 = 200;

/// How far off (reaches, rad) the farthest are; the nearest are as far off as the arm is.
const FARTHEST: f64 = 4e-2;
const NEAREST: f64 = 1e-6;

/// How many distances there are.
const DISTANCES: u32 = 5;

/// A candidate that misses the pose asked for by more than this (reaches, rad) is a false root.
const HOPELESS: f64 = 1e-3;

/// So many solutions on curves are remembered; they are one where they are no farther apart than this (rad, reaches).
const PLACES: usize = 16;
const SAME: f64 = 1e-5;

/// Where Newton's method does not converge, curves are followed at so many poses.
const FOLLOWED: u32 = 5;

/// Where there are more solutions than there is room for, one of those stays that are not farther apart than this (rad, m).
const THIN: f64 = 0.1;

/// Where the tool moves as little as this with a joint (reaches, rad), solutions may be near to each other.
const NEARLY_SINGULAR: f64 = 0.03;

/// Where it moves as little as this, they may be so near that some are missing.
const CROWDED: f64 = 5e-4;

/// Where it doesn't move but for rounding, solutions go on. Two that have met are known to 1e-8, and so is how little it moves there.
const STILL: f64 = 1e-9;

impl<const N: usize, S: Float> Near<'_, N, S> {
    /// The next target to be asked for: first the one that is wanted, then others about it in opposite pairs.
    #[cold]
    #[inline(never)]
    pub(super) fn next_neighbour(&mut self) -> Option<Target<S>> {
        let (target, is_pose) = (self.target, self.asks_for_pose());
        if self.seek.is_none() {
            self.seek = Some(self.ask());
        }
        let seek = self.seek.as_mut()?;
        // What is no pose the chain is asked for again, with all that it has against its doubts.
        if seek.complete || (!is_pose && self.chain.is_some() && seek.has_pairs()) {
            return None;
        }
        let number = seek.asked;
        seek.asked += 1;
        seek.idle += 1;
        let patience = if is_pose { PATIENCE } else { LONGER };
        if seek.idle > patience || seek.asked > MOST {
            return None;
        }
        if number > 0 {
            let mut step = aside(number - 1, self.deviation);
            if !is_pose && number.is_multiple_of(2) {
                // What a direction alone leaves open stays so.
                step.iter_mut().skip(3).for_each(|turn| *turn = 0.0);
            }
            let [x, y, z, roll, pitch, yaw] = step.map(S::from_f64);
            let reach = self.search.reach;
            let step = Frame::from_rpy([x * reach, y * reach, z * reach], [roll, pitch, yaw]);
            seek.target = Target::of_frame(target.kind(), &target.any_frame().compose(&step));
        }
        self.search = Search::new(self.search.reach, self.search.windings);
        Some(seek.target)
    }

    pub(super) const fn asks_for_pose(&self) -> bool {
        matches!(self.target, Target::Pose(_))
    }

    /// What the general chain finds as long as its doubts cost nothing.
    fn ask(&self) -> Seek<N, S> {
        let mut seek = Seek {
            target: self.target,
            asked: 0,
            idle: 0,
            found: if self.search.solutions.len() == MAX_SOLUTIONS {
                Solutions::EMPTY
            } else {
                self.search.solutions.copied()
            },
            complete: false,
            crowded: false,
            sifted: false,
            on_curves: Solutions::EMPTY,
            walked: [[S::ZERO; N]; PLACES],
            places: 0,
        };
        let Some(Exact { arm, joints }) = &self.chain else { return seek };
        let Some(six) = arm.six(&[]) else { return seek };
        let (target, pose) = (self.target.in_f64(), self.target.any_frame().in_f64());
        let (_, sure) = six.solve_plainly(&pose, |values, determinant| {
            let (position_error, rotation_error) = target.errors(&six.tip(values));
            let q = joint_values(joints, values);
            let [position_error, rotation_error] = [position_error, rotation_error].map(S::from_f64);
            let found = Polished { q, position_error, rotation_error };
            let negative = (determinant < 0.0) != self.labels.mirrored;
            seek.add(self.labels.solution(&found, negative), self.search.windings);
        });
        seek.complete = sure && seek.has_pairs();
        seek
    }

    /// A candidate for the pose that is asked for.
    #[cold]
    #[inline(never)]
    pub(super) fn seek_from(
        &mut self,
        q: [S; N],
        tool: &Frame<S>,
        pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        let Some(seek) = &mut self.seek else { return };
        let (reach, target) = (self.search.reach, self.target);
        let (position_error, rotation_error) = seek.target.errors(tool);
        self.search.accept(q, position_error, rotation_error);
        let hopeless = S::from_f64(HOPELESS);
        if !(position_error <= hopeless * reach && rotation_error <= hopeless) {
            return;
        }
        // Of a step that any value meets, this one will do.
        self.search.accepted += 1;
        let (across, unknowns, follow) = (self.across, self.unknowns, self.follow);
        let asked = Asked { target: &target, unknowns, follow, across, reach };
        let deviation = S::from_f64(self.deviation);
        let mut arm = Arm { asked, labels: &self.labels, deviation, pose_and_jacobian };
        let before = if seek.sifted { seek.found.len() } else { 0 };
        seek.sifted = true;
        let from = match arm.bring(q) {
            Some(found) => {
                arm.add(found, &mut seek.found);
                seek.sift(before, |q| arm.stiffness(q));
                let stiffness = arm.stiffness(found.q).unwrap_or(S::ZERO);
                seek.crowded |= stiffness < S::from_f64(CROWDED);
                if seek.was_at(&found.q) || stiffness > S::from_f64(NEARLY_SINGULAR) {
                    return;
                }
                found.q
            }
            None if seek.asked <= FOLLOWED => q,
            None => return,
        };
        // There may be others on the curve along which the tool hardly moves.
        seek.note(from);
        arm.follow(from, S::INFINITY, &mut seek.found);
        seek.sift(before, |q| arm.stiffness(q));
    }

    /// What was found, where nothing speaks against its being all.
    #[cold]
    pub(super) fn sought(&self) -> Option<Result<Solutions<N, S>, IkError<S>>> {
        let seek = self.seek.as_ref()?;
        let all = seek.complete
            || (seek.has_pairs()
                && !seek.crowded
                && !seek.is_full()
                && self.asks_for_pose()
                && !self.quartic);
        all.then(|| Ok(seek.found.copied()))
    }

    /// A search about what is wanted that has what was found already.
    pub fn otherwise<'w, const K: usize>(
        &mut self,
        wanted: &'w Wanted<K, S>,
        pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) -> Search<'w, N, S>
    where
        Self: 'w,
    {
        self.seek_all_over(pose_and_jacobian);
        let mut search = Search::about(self.search.reach, self.search.windings, wanted);
        if let Some(seek) = &self.seek {
            search.solutions = seek.thinned();
            let before = search.solutions.len();
            seek.on_curves.iter().for_each(|solution| search.solutions.push(*solution, search.windings));
            search.on_curves = (before, search.solutions.len());
        }
        search
    }
}

impl<const N: usize, S: Float> Seek<N, S> {
    /// Takes what was found.
    fn add(&mut self, solution: Solution<N, S>, windings: &[Winding<'_, S>]) {
        let before = self.found.len();
        self.found.push(solution, windings);
        if self.found.len() > before {
            self.idle = 0;
        }
    }

    /// Puts what is on a curve of solutions aside: the chain has one point of it and marks that. Only what has come since there were
    /// `before` is looked at.
    pub(super) fn sift(&mut self, before: usize, mut stiffness: impl FnMut([S; N]) -> Option<S>) {
        for (place, solution) in self.found.take().into_iter().enumerate() {
            let is_still = |stiffness| stiffness < S::from_f64(STILL);
            if place >= before && stiffness(solution.q).is_some_and(is_still) {
                self.crowded = true;
                self.on_curves.append(solution);
            } else {
                self.found.append(solution);
            }
        }
        if self.found.len() > before {
            self.idle = 0;
        }
    }

    fn has_pairs(&self) -> bool {
        !self.found.is_empty() && are_pairs(&self.found)
    }

    pub(super) fn has_nothing(&self) -> bool {
        self.found.is_empty() && self.on_curves.is_empty()
    }

    fn is_full(&self) -> bool {
        self.found.len() == MAX_SOLUTIONS
    }

    /// What was found; if that is as many as there is room for, one of those that are beside each other.
    fn thinned(&self) -> Solutions<N, S> {
        if !self.is_full() {
            return self.found.copied();
        }
        let mut kept = Solutions::EMPTY;
        for solution in &self.found {
            if !kept.iter().any(|known: &Solution<N, S>| apart(&known.q, &solution.q) < S::from_f64(THIN)) {
                kept.append(*solution);
            }
        }
        kept
    }

    /// Whether a curve was followed from a solution, or to it.
    fn was_at(&self, q: &[S; N]) -> bool {
        let mut walked = self.walked.iter().take(self.places);
        walked.any(|place| apart(place, q) <= S::from_f64(SAME))
    }

    fn note(&mut self, q: [S; N]) {
        if let Some(slot) = self.walked.get_mut(self.places) {
            *slot = q;
            self.places += 1;
        }
    }
}

/// The arm's joint values, from those of its chain.
pub(super) fn joint_values<const N: usize, S: Float>(joints: &[Form], values: &[f64; UNKNOWNS]) -> [S; N] {
    let mut q = [S::ZERO; N];
    for (slot, [factors @ .., constant]) in q.iter_mut().zip(joints) {
        let value = factors.iter().zip(values).fold(*constant, |sum, (factor, x)| sum + factor * x);
        *slot = S::from_f64(value);
    }
    q
}

/// Where the pose of a number is, beside the target (reaches, rad): in all directions evenly, and opposite to the one before.
fn aside(number: u32, deviation: f64) -> [f64; 6] {
    let pair = number / 2;
    let near = if deviation > NEAREST { deviation } else { NEAREST };
    let half = libm::sqrt(near * FARTHEST);
    let size = match pair % DISTANCES {
        0 => near,
        1 => libm::sqrt(near * half),
        2 => half,
        3 => libm::sqrt(half * FARTHEST),
        _ => FARTHEST,
    };
    let size = if number.is_multiple_of(2) { size } else { -size };
    evenly::<f64, 6>(pair + 1, 6).map(|part| 2.0 * size * part)
}
