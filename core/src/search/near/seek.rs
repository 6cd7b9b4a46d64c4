//! Where the closed form is not sure to find everything: it is asked for poses all around the target as well.
//!
//! Joint values that bring the arm as it is to the target bring the one that was meant to a pose near by. Where its closed
//! form is singular at the target, it is not at most of these; roots that have met at the target part on one side of it.

use super::newton::{self, Place};
use super::{Near, UNKNOWNS};
use crate::frame::{norm, sub};
use crate::polish::{Polished, polish};
use crate::search::Search;
use crate::{Float, Frame, GeneralArm, IkError, Solution, Solutions, Wanted, Winding, rotation_error};

/// What has been found at poses around the target.
#[derive(Debug, Clone)]
pub(super) struct Seek<const N: usize, S> {
    /// The pose that is asked for.
    pose: Frame<S>,
    /// How many were.
    asked: u32,
    /// Of them, those since the last that led to something new.
    idle: u32,
    found: Solutions<N, S>,
    /// Whether that is all, as the general chain says.
    complete: bool,
    /// Solutions from which curves were followed, or to which.
    walked: [[S; N]; PLACES],
    places: usize,
}

/// So many poses in a row that lead to nothing new are the last.
const PATIENCE: u32 = 7;

/// But no more than this.
const MOST: u32 = 200;

/// How far off (reaches, rad) the farthest are; the nearest are as far off as the arm is.
const FARTHEST: f64 = 4e-2;
const NEAREST: f64 = 1e-6;

/// How many distances there are.
const DISTANCES: u32 = 5;

/// A candidate that misses the pose asked for by more than this (reaches, rad) is a false root.
const HOPELESS: f64 = 1e-3;

/// A candidate whose error (reaches, rad) Newton's method doesn't bring below this is none.
const FOUND: f64 = 1e-10;

/// Damped steps at most.
const STEPS: usize = 24;

/// Places along a curve are so far apart (rad, reaches), and so many; the other joints follow by so many steps; farther than
/// this (reaches, rad) from the target the curve is left.
const STRIDE: f64 = 0.25;
const FINER: f64 = 0.1;
const WALK: u32 = 28;
const CORRECTIONS: usize = 2;
const AWAY: f64 = 0.05;

/// So many solutions on curves are remembered; they are one where they are no farther apart than this (rad, reaches).
const PLACES: usize = 16;
const SAME: f64 = 1e-5;

/// Where Newton's method does not converge, curves are followed at so many poses.
const FOLLOWED: u32 = 5;

/// Two solutions may have met where no more than this (reaches, rad) is missing.
const TOUCHES: f64 = 1e-6;

/// Where a pivot is this small, solutions may be near to each other.
const NEARLY_SINGULAR: f64 = 0.03;

impl<const N: usize, S: Float> Near<'_, N, S> {
    /// The next pose to be asked for: first the target itself, then others in opposite pairs.
    #[cold]
    #[inline(never)]
    pub(super) fn next_neighbour(&mut self) -> Option<Frame<S>> {
        let target = self.target;
        let seek = if let Some(seek) = &mut self.seek {
            seek
        } else {
            let mut seek = Seek {
                pose: target,
                asked: 0,
                idle: 0,
                found: Solutions::EMPTY,
                complete: false,
                walked: [[S::ZERO; N]; PLACES],
                places: 0,
            };
            if let Some((chain, offsets)) = &self.chain {
                seek.ask(chain, offsets, &target, self.search.windings);
            }
            self.seek.insert(seek)
        };
        if seek.complete {
            return None;
        }
        let number = seek.asked;
        seek.asked += 1;
        seek.idle += 1;
        if seek.idle > PATIENCE || seek.asked > MOST {
            return None;
        }
        if number > 0 {
            let [x, y, z, roll, pitch, yaw] = aside(number - 1, self.deviation).map(S::from_f64);
            let reach = self.search.reach;
            let step = Frame::from_rpy([x * reach, y * reach, z * reach], [roll, pitch, yaw]);
            seek.pose = target.compose(&step);
        }
        self.search = Search::new(self.search.reach, self.search.windings);
        Some(seek.pose)
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
        let position_error = norm(sub(tool.translation, seek.pose.translation));
        let rotation_error = rotation_error(&seek.pose.rotation, &tool.rotation);
        self.search.accept(q, position_error, rotation_error);
        let hopeless = S::from_f64(HOPELESS);
        if !(position_error <= hopeless * reach && rotation_error <= hopeless) {
            return;
        }
        let unknowns = &self.unknowns;
        let windings = self.search.windings;
        let mut arm = Arm { unknowns, target: &target, reach, pose_and_jacobian };
        let from = match arm.bring(q) {
            Some(found) => {
                seek.add(&found, windings);
                let regular = |at: Place<S>| at.pivot > S::from_f64(NEARLY_SINGULAR);
                if seek.was_at(&found.q, unknowns) || arm.place(&found.q).is_some_and(regular) {
                    return;
                }
                found.q
            }
            None if seek.asked <= FOLLOWED => q,
            None => return,
        };
        // There may be others on the curve along which the tool hardly moves.
        for side in [S::ONE, -S::ONE] {
            if arm.walk(from, side * S::from_f64(STRIDE), 1, seek, windings) {
                break;
            }
        }
    }

    /// What was found, where nothing speaks against its being all.
    #[cold]
    pub(super) fn sought(&self) -> Option<Result<Solutions<N, S>, IkError<S>>> {
        let seek = self.seek.as_ref()?;
        // Real solutions come and go in pairs.
        let all = seek.complete || (!seek.found.is_empty() && seek.found.len().is_multiple_of(2));
        all.then(|| Ok(seek.found.copied()))
    }

    /// A search about what is wanted that has what was found already.
    pub fn otherwise<'w, const K: usize>(&self, wanted: &'w Wanted<K, S>) -> Search<'w, N, S>
    where
        Self: 'w,
    {
        let mut search = Search::about(self.search.reach, self.search.windings, wanted);
        match &self.seek {
            Some(seek) => search.solutions = seek.found.copied(),
            _ => {}
        }
        search
    }
}

impl<const N: usize, S: Float> Seek<N, S> {
    /// Asks the general chain, as long as its doubts cost nothing.
    fn ask(
        &mut self,
        chain: &GeneralArm<'_>,
        offsets: &[f64],
        target: &Frame<S>,
        windings: &[Winding<'_, S>],
    ) {
        let Some(six) = chain.six(&[]) else { return };
        let pose = Frame {
            rotation: target.rotation.map(|row| row.map(Float::to_f64)),
            translation: target.translation.map(Float::to_f64),
        };
        let (_, sure) = six.solve_plainly(&pose, |solution| {
            let tip = six.tip(solution);
            let mut q = [S::ZERO; N];
            for (slot, (value, offset)) in q.iter_mut().zip(solution.iter().zip(offsets)) {
                *slot = S::from_f64(value - offset);
            }
            let found = Polished {
                q,
                position_error: S::from_f64(norm(sub(tip.translation, pose.translation))),
                rotation_error: S::from_f64(crate::rotation_error(&pose.rotation, &tip.rotation)),
            };
            self.add(&found, windings);
        });
        self.complete = sure && !self.found.is_empty();
    }

    /// Takes what was found.
    fn add(&mut self, found: &Polished<N, S>, windings: &[Winding<'_, S>]) {
        let Polished { mut q, position_error, rotation_error } = *found;
        crate::rules::wrap_all(windings, &mut q);
        let before = self.found.len();
        self.found.push(Solution { q, position_error, rotation_error, free: None }, windings);
        if self.found.len() > before {
            self.idle = 0;
        }
    }

    /// Whether a curve was followed from a solution, or to it.
    fn was_at(&self, q: &[S; N], unknowns: &[usize; UNKNOWNS]) -> bool {
        let mut walked = self.walked.iter().take(self.places);
        walked.any(|place| apart(place, q, unknowns) <= S::from_f64(SAME))
    }

    fn note(&mut self, q: [S; N]) {
        if let Some(slot) = self.walked.get_mut(self.places) {
            *slot = q;
            self.places += 1;
        }
    }
}

/// The greatest difference of two sets of joint values, whole turns aside.
fn apart<const N: usize, S: Float>(a: &[S; N], b: &[S; N], unknowns: &[usize; UNKNOWNS]) -> S {
    let mut away = S::ZERO;
    for joint in unknowns {
        if let (Some(a), Some(b)) = (a.get(*joint), b.get(*joint)) {
            away = away.max((*a - *b).wrap_angle().abs());
        }
    }
    away
}

/// The arm as it is, to be brought to the target.
struct Arm<'a, const N: usize, S, F> {
    unknowns: &'a [usize; UNKNOWNS],
    target: &'a Frame<S>,
    reach: S,
    pose_and_jacobian: F,
}

impl<const N: usize, S: Float, F: FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N])> Arm<'_, N, S, F> {
    fn newton(&mut self, q: [S; N]) -> Option<Polished<N, S>> {
        newton::solve(q, self.unknowns, self.target, self.reach, &mut self.pose_and_jacobian)
    }

    /// Brings joint values to the target.
    fn bring(&mut self, q: [S; N]) -> Option<Polished<N, S>> {
        if let Some(found) = self.newton(q) {
            return Some(found);
        }
        let met = S::from_f64(FOUND).max(S::from_f64(64.0) * S::EPSILON);
        let found = self.polish(q, STEPS, None);
        (found.position_error <= met * self.reach && found.rotation_error <= met).then_some(found)
    }

    fn place(&mut self, q: &[S; N]) -> Option<Place<S>> {
        let (tool, columns) = (self.pose_and_jacobian)(q);
        newton::place(self.unknowns, &tool, &columns, self.target, self.reach)
    }

    /// By damped steps of the unknowns but one.
    fn polish(&mut self, q: [S; N], steps: usize, held: Option<usize>) -> Polished<N, S> {
        let unknowns = self.unknowns;
        let exact = &mut self.pose_and_jacobian;
        polish(q, self.target, self.reach, steps, |q| {
            let (tool, mut columns) = exact(q);
            for (joint, column) in columns.iter_mut().enumerate() {
                if !unknowns.contains(&joint) || Some(joint) == held {
                    *column = [S::ZERO; 6];
                }
            }
            (tool, columns)
        })
    }

    /// Goes along the curve on which five joints make up for what the sixth does as well as they can. What is missing there
    /// has one direction, and is 0 at a solution. Says whether the curve was closed.
    fn walk(
        &mut self,
        from: [S; N],
        stride: S,
        finer: u32,
        seek: &mut Seek<N, S>,
        windings: &[Winding<'_, S>],
    ) -> bool {
        let Some(mut at) = self.place(&from) else { return false };
        let (mut q, mut before) = (from, None);
        seek.note(from);
        for step in 0..WALK {
            let mut on = q;
            for (joint, part) in self.unknowns.iter().zip(at.idle) {
                if let Some(value) = on.get_mut(*joint) {
                    *value += stride * part;
                }
            }
            let Some(held) = self.unknowns.get(at.leads) else { return false };
            on = self.polish(on, CORRECTIONS, Some(*held)).q;
            let Some(mut next) = self.place(&on) else { return false };
            if dot(&next.idle, &at.idle) < S::ZERO {
                next.idle = next.idle.map(|part| -part);
            }
            let [last, size] = [&at.missing, &next.missing].map(|missing| dot(missing, missing).sqrt());
            if !(size <= S::from_f64(AWAY)) {
                return false;
            }
            if dot(&at.missing, &next.missing) < S::ZERO {
                let mut between = q;
                let share = last / (last + size);
                between.iter_mut().zip(on).for_each(|(value, on)| *value += share * (on - *value));
                if let Some(hit) = self.bring(between) {
                    seek.add(&hit, windings);
                    if apart(&hit.q, &between, self.unknowns) < S::from_f64(0.5) * stride.abs() {
                        seek.note(hit.q);
                    }
                }
                before = None;
            } else if let Some((start, longer)) = before
                && last <= longer
                && last < size
                && may_vanish([longer, last, size])
            {
                // Two may be so near to each other that the sign has changed twice.
                if finer > 0 {
                    self.walk(start, stride * S::from_f64(FINER), finer - 1, seek, windings);
                } else if let Some(hit) = self.bring(q) {
                    seek.add(&hit, windings);
                }
                before = Some((q, last));
            } else {
                before = Some((q, last));
            }
            (q, at) = (on, next);
            if finer > 0 {
                if step > 2 && apart(&q, &from, self.unknowns) < S::from_f64(0.6) * stride.abs() {
                    return true;
                }
            }
        }
        false
    }
}

/// Whether the parabola through three values, of which that in the middle is the least, comes near to 0.
fn may_vanish<S: Float>([before, least, after]: [S; 3]) -> bool {
    let (rise, bend) = (after - before, before - least + after - least);
    let vertex = least - rise * rise / (S::from_f64(8.0) * bend);
    vertex <= S::from_f64(0.5) * least || least <= S::from_f64(TOUCHES)
}

fn dot<S: Float>(a: &[S; UNKNOWNS], b: &[S; UNKNOWNS]) -> S {
    a.iter().zip(b).fold(S::ZERO, |sum, (a, b)| sum + *a * *b)
}

/// Where the pose of a number is, beside the target (reaches, rad): multiples of the powers of 1/g, with g^7 = g + 1, fill all
/// directions evenly \[Roberts 2018, The unreasonable effectiveness of quasirandom sequences\].
fn aside(number: u32, deviation: f64) -> [f64; 6] {
    const INVERSE: f64 = 0.898_653_712_628_699_3;
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
    let size = if number % 2 == 0 { size } else { -size };
    let mut power = f64::from(pair + 1);
    [0; 6].map(|_| {
        power *= INVERSE;
        2.0 * size * (power - libm::floor(power) - 0.5)
    })
}
