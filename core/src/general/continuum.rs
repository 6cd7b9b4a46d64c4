//! Solutions that form a curve: the unknowns move, what is prescribed stays.

use super::directions::{Directions, null_space};
use super::jacobian::pose_and_jacobian;
use super::{FOUND, JOINTS, SixJoints};
use crate::polish::polish;
use crate::{Float, Frame};

/// The smallest pivot of the Jacobian (in reaches and rad) at which joints may move by themselves. Solutions that have met
/// are known to 1e-8 or so, and so is a Jacobian that vanishes there.
const SINGULAR: f64 = 1e-6;

/// The same where two solutions may be near to each other.
const WEAK: f64 = 0.05;

/// How far from each other (rad, reaches) they are looked for.
const BESIDE: [f64; 6] = [0.02, -0.02, 0.06, -0.06, 0.2, -0.2];

/// How far (rad, reaches) joint values are moved to see whether there is a curve.
const TRIALS: [f64; 3] = [0.02, 0.05, 0.1];

/// An unknown that takes less part than this in a direction of length 1 takes none.
const PART: f64 = 0.01;

/// The part of a step that has to be left of it after solutions were found again: of one along a curve, and of one of which it
/// is asked whether there is a curve.
const ALONG: f64 = 0.5;
const LEFT: f64 = 0.125;

/// The longest step along a curve (rad, reaches).
const LONGEST: f64 = 0.25;

/// How many steps along a curve are made.
const MOST: usize = 80;

/// Steps (rad, reaches) in which a curve is followed as a whole, and how many on either side.
const STRIDE: f64 = 0.15;
const STRIDES: usize = 160;

/// Points that are no farther (rad, reaches) than this from the line between two such steps are on the curve, if on any.
const BESIDE_CHORD: f64 = 0.05;

/// Steps from a point beside a curve onto it at most: two or three where it is regular.
const STEPS: usize = 40;

/// Steps from between two solutions, onto the curve if there is one: more would lead to either.
const BETWEEN: usize = 2;

/// What rounding leaves (reaches, rad) of a pose that is met.
const MET: f64 = 1e-13;

/// The nearest point is found when the next step is shorter than this (rad, reaches).
const ARRIVED: f64 = 1e-10;

/// What is to be kept along a curve, in `K` unknowns (rad, reaches).
pub(crate) trait Equations<const K: usize> {
    /// How what is prescribed changes with each unknown (reaches, rad).
    fn columns(&self, q: &[f64; K]) -> [[f64; 6]; K];

    /// The solution downhill from values of the unknowns.
    fn onto(&self, q: &[f64; K]) -> Option<[f64; K]>;

    /// Whether an unknown is a length.
    fn slides(&self, place: usize) -> bool;
}

/// A point of a curve of solutions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OnCurve<const K: usize> {
    /// Values of the unknowns.
    pub(crate) q: [f64; K],
    /// Of those that are asked for, the one that takes the greatest part, if one takes any.
    pub(crate) joint: Option<usize>,
}

/// Where solutions form a curve through this one: the point of it, downhill from here, that is nearest to what is wanted
/// (NaN where nothing is), or from there on until the unknown that takes the greatest part has gone so many times pi, half
/// its period (reaches). Only the first `own` unknowns are asked for.
pub(crate) fn on_curve<const K: usize>(
    equations: &impl Equations<K>,
    start: &[f64; K],
    wanted: &[f64; K],
    aside: f64,
    own: usize,
) -> Option<OnCurve<K>> {
    let curve = Curve(equations);
    let tangent = curve.way(start, own)?;
    let mut q = curve.nearest(*start, wanted);
    let joint = curve.ways(&q).find_map(|way| greatest(&way, own)).or(greatest(&tangent, own));
    if let Some(joint) = joint.filter(|_| aside != 0.0) {
        q = curve.along(q, joint, aside * if equations.slides(joint) { 1.0 } else { core::f64::consts::PI });
    }
    Some(OnCurve { q, joint })
}

/// In how many ways unknowns change what is prescribed, to first order.
pub(crate) fn rank<const K: usize>(columns: &[[f64; 6]; K]) -> usize {
    K - null_space(columns, SINGULAR).count
}

/// Places beside a solution where another one may be that it nearly meets: such solutions lie along a direction in which
/// what is prescribed hardly changes.
pub(crate) fn beside<const K: usize>(
    q: &[f64; K],
    columns: &[[f64; 6]; K],
) -> impl Iterator<Item = [f64; K]> + use<K> {
    let (q, Directions { list, count }) = (*q, null_space(columns, WEAK));
    let ways = list.into_iter().take(count);
    ways.flat_map(move |way| BESIDE.map(|length| moved(&q, &way, length)))
}

impl SixJoints<'_> {
    /// [`on_curve`] of solutions (rad, m) for a pose.
    pub(crate) fn on_curve(
        &self,
        pose: &Frame,
        q: &[f64; JOINTS],
        wanted: &[f64; JOINTS],
        aside: f64,
        own: usize,
    ) -> Option<OnCurve<JOINTS>> {
        let equations = Pose { arm: self.scaled(), target: self.in_reaches(pose) };
        let in_reaches = |q: &[f64; JOINTS]| {
            let mut q = *q;
            self.each_slide(&mut q, |value| value / self.reach);
            q
        };
        let mut found = on_curve(&equations, &in_reaches(q), &in_reaches(wanted), aside, own)?;
        self.each_slide(&mut found.q, |value| value * self.reach);
        Some(found)
    }

    /// Follows the curve of solutions (rad, m) for a pose through one of them as a whole: says of which of `others` it comes by,
    /// and its point that is nearest to what is wanted.
    pub(crate) fn follow(
        &self,
        pose: &Frame,
        q: &[f64; JOINTS],
        wanted: &[f64; JOINTS],
        own: usize,
        others: &(impl Iterator<Item = [f64; JOINTS]> + Clone),
    ) -> (u64, [f64; JOINTS]) {
        let equations = Pose { arm: self.scaled(), target: self.in_reaches(pose) };
        let in_reaches = |q: &[f64; JOINTS]| {
            let mut q = *q;
            self.each_slide(&mut q, |value| value / self.reach);
            q
        };
        let (start, wanted) = (in_reaches(q), in_reaches(wanted));
        let (mut passed, mut nearest) = (0, (start, f64::INFINITY));
        Curve(&equations).follow(&start, own, &mut |from, to| {
            let far = square(&equations.way(to, &wanted));
            if far < nearest.1 {
                nearest = (*to, far);
            }
            let chord = difference(to, from);
            for (place, other) in others.clone().enumerate() {
                let away = equations.way(from, &in_reaches(&other));
                let share = (dot(&away, &chord) / square(&chord)).clamp(0.0, 1.0);
                let beside = moved(&away, &chord, -share);
                if beside.iter().all(|part| libm::fabs(*part) <= BESIDE_CHORD) {
                    passed |= 1_u64.wrapping_shl(place as u32);
                }
            }
        });
        let mut nearest = nearest.0;
        self.each_slide(&mut nearest, |value| value * self.reach);
        (passed, nearest)
    }

    /// A solution (rad, m) as near to its pose as steps bring it: where several have met, to the place where they did.
    pub(crate) fn polished(&self, pose: &Frame, q: &[f64; JOINTS]) -> [f64; JOINTS] {
        let mut start = *q;
        self.each_slide(&mut start, |value| value / self.reach);
        let equations = Pose { arm: self.scaled(), target: self.in_reaches(pose) };
        self.in_metres(equations.miss(&start, STEPS).0)
    }

    /// Whether nothing tells two solutions (rad, m) apart: joints may move by themselves at either, to first order, and on the way
    /// from one to the other the pose is met as well as it is by them.
    pub(crate) fn are_one(&self, pose: &Frame, a: &[f64; JOINTS], b: &[f64; JOINTS]) -> bool {
        let equations = Pose { arm: self.scaled(), target: self.in_reaches(pose) };
        let [start, end] = [a, b].map(|q| {
            let mut q = *q;
            self.each_slide(&mut q, |value| value / self.reach);
            q
        });
        let way = equations.way(&start, &end);
        let most = Float::max(MET, 2.0 * Float::max(equations.miss(&start, 0).1, equations.miss(&end, 0).1));
        let is_between = |share: f64| {
            let (q, miss) = equations.miss(&moved(&start, &way, share), BETWEEN);
            miss <= most && rank(&equations.columns(&q)) < JOINTS
        };
        way.iter().all(|part| libm::fabs(*part) <= LONGEST)
            && self.is_singular(a)
            && self.is_singular(b)
            && [0.25, 0.5, 0.75].into_iter().all(is_between)
    }

    /// How far (reaches, rad) the tip is from a pose at joint values (rad, m).
    pub(crate) fn miss(&self, pose: &Frame, q: &[f64; JOINTS]) -> f64 {
        let mut q = *q;
        self.each_slide(&mut q, |value| value / self.reach);
        Pose { arm: self.scaled(), target: self.in_reaches(pose) }.miss(&q, 0).1
    }

    /// Whether joints may move by themselves there (rad, m), to first order.
    pub fn is_singular(&self, q: &[f64; JOINTS]) -> bool {
        let mut q = *q;
        self.each_slide(&mut q, |value| value / self.reach);
        rank(&pose_and_jacobian(&self.scaled(), &q).1) < JOINTS
    }

    /// [`beside`] of a solution, all in reaches.
    pub(super) fn beside(&self, q: &[f64; JOINTS]) -> impl Iterator<Item = [f64; JOINTS]> + use<> {
        beside(q, &pose_and_jacobian(self, q).1)
    }

    pub(super) fn each_slide(&self, q: &mut [f64; JOINTS], change: impl Fn(f64) -> f64) {
        let slides = q.iter_mut().zip(self.prismatic).filter(|(_, slides)| *slides);
        slides.for_each(|(value, _)| *value = change(*value));
    }
}

/// That the tip of six joints has a pose; lengths are reaches.
struct Pose<'a> {
    arm: SixJoints<'a>,
    target: Frame,
}

impl Pose<'_> {
    /// From joint values to others, by no more than half a turn; 0 where nothing is wanted.
    fn way(&self, from: &[f64; JOINTS], to: &[f64; JOINTS]) -> [f64; JOINTS] {
        let mut way = missing(from, to);
        for (place, part) in way.iter_mut().enumerate() {
            *part = if self.slides(place) { *part } else { part.wrap_angle() };
        }
        way
    }
}

impl Pose<'_> {
    /// Joint values after so many steps towards the target, and what they miss it by (reaches, rad).
    fn miss(&self, q: &[f64; JOINTS], steps: usize) -> ([f64; JOINTS], f64) {
        let better = polish(*q, &self.target, 1.0, steps, |q| pose_and_jacobian(&self.arm, q));
        (better.q, Float::max(better.position_error, better.rotation_error))
    }
}

impl Equations<JOINTS> for Pose<'_> {
    fn columns(&self, q: &[f64; JOINTS]) -> [[f64; 6]; JOINTS] {
        pose_and_jacobian(&self.arm, q).1
    }

    fn onto(&self, q: &[f64; JOINTS]) -> Option<[f64; JOINTS]> {
        let (q, miss) = self.miss(q, STEPS);
        (miss <= FOUND).then_some(q)
    }

    fn slides(&self, place: usize) -> bool {
        self.arm.prismatic.get(place).copied().unwrap_or(false)
    }
}

/// A curve of solutions, or a surface.
struct Curve<'e, const K: usize, E>(&'e E);

impl<const K: usize, E: Equations<K>> Curve<'_, K, E> {
    /// Directions in which what is prescribed stays, to first order.
    fn directions(&self, q: &[f64; K]) -> Directions<K> {
        null_space(&self.0.columns(q), SINGULAR)
    }

    /// The solution a step along the curve, unless there is none, or little of the step is left.
    fn step(&self, q: &[f64; K], tangent: &[f64; K], length: f64, least: f64) -> Option<[f64; K]> {
        let next = self.0.onto(&moved(q, tangent, length))?;
        let gone = difference(&next, q);
        (dot(&gone, tangent) * length >= least * length * length).then_some(next)
    }

    /// Where solutions go on from there: of the directions in which what is prescribed stays, some across each other, then that with
    /// the greatest part of each unknown, the ones along which there are solutions at several distances, to one side or the other.
    /// Such a direction may be part of a curve and part one in which two solutions have met, so it is that in which the farthest of
    /// them is that is returned.
    fn ways<'s>(&'s self, q: &'s [f64; K]) -> impl Iterator<Item = [f64; K]> + 's {
        let directions = self.directions(q);
        let of_unknown = move |place: usize| {
            let mut unknown = [0.0; K];
            *unknown.get_mut(place)? = 1.0;
            unit(&directions.part(&unknown), PART)
        };
        let across = directions.list.into_iter().take(directions.count);
        across.chain((0..K).filter_map(of_unknown)).filter_map(move |direction| {
            [1.0, -1.0].into_iter().find_map(|side| {
                let mut farthest = None;
                for length in TRIALS {
                    farthest = Some(self.step(q, &direction, side * length, LEFT)?);
                }
                unit(&difference(&farthest?, q).map(|part| side * part), 0.0)
            })
        })
    }

    /// One of them, if there is one with one of the first `own` unknowns among those that move.
    fn way(&self, q: &[f64; K], own: usize) -> Option<[f64; K]> {
        let moves = |way: &[f64; K]| greatest(way, own).is_some();
        self.ways(q).find(moves).or_else(|| self.ways(q).next())
    }

    /// Downhill from a point of the curve, or of the surface where unknowns may move by themselves in several ways.
    fn nearest(&self, start: [f64; K], wanted: &[f64; K]) -> [f64; K] {
        let mut q = start;
        // The whole turns that are nearest to what is wanted.
        for (place, (value, wanted)) in q.iter_mut().zip(wanted).enumerate() {
            if !self.0.slides(place) && wanted.is_finite() {
                *value = wanted + (*value - wanted).wrap_angle();
            }
        }
        let mut longest = LONGEST;
        for _ in 0..MOST {
            let missing = missing(&q, wanted);
            let downhill = self.directions(&q).part(&missing);
            let slope = libm::sqrt(dot(&downhill, &downhill));
            if !(slope > ARRIVED && longest > ARRIVED) {
                break;
            }
            let share = Float::min(longest / slope, 1.0);
            let next = self.0.onto(&moved(&q, &downhill, share));
            let nearer = |next: &[f64; K]| square(&self::missing(next, wanted)) < square(&missing);
            match next.filter(nearer) {
                Some(next) => q = next,
                None => longest = share * slope / 4.0,
            }
        }
        q
    }

    /// Hands every piece of the curve on, to both sides until it closes or ends.
    fn follow(&self, start: &[f64; K], own: usize, each: &mut impl FnMut(&[f64; K], &[f64; K])) {
        let Some(first) = self.way(start, own) else { return };
        for side in [1.0, -1.0] {
            let (mut q, mut ahead) = (*start, first.map(|part| side * part));
            let mut has_left = false;
            for _ in 0..STRIDES {
                // Of the directions in which what is prescribed stays, the one that goes on as before.
                let along = self.directions(&q).part(&ahead);
                let length = libm::sqrt(square(&along));
                let tangent = along.map(|part| part / length);
                let next = [1.0, 0.3].iter().find_map(|part| self.step(&q, &tangent, part * STRIDE, ALONG));
                let Some(next) = next.filter(|_| length > 0.5) else { break };
                each(&q, &next);
                ahead = difference(&next, &q);
                let size = libm::sqrt(square(&ahead));
                ahead = ahead.map(|part| part / size);
                q = next;
                has_left |= !self.is_beside(&q, start, 2.0 * STRIDE);
                if has_left && self.is_beside(&q, start, STRIDE) {
                    return;
                }
            }
        }
    }

    fn is_beside(&self, q: &[f64; K], other: &[f64; K], distance: f64) -> bool {
        difference(q, other).iter().enumerate().all(|(place, part)| {
            libm::fabs(if self.0.slides(place) { *part } else { part.wrap_angle() }) <= distance
        })
    }

    /// From a point of the curve until an unknown has gone this far (rad, reaches), or the curve turns back.
    fn along(&self, start: [f64; K], joint: usize, distance: f64) -> [f64; K] {
        let own = |q: &[f64; K]| q.get(joint).copied().unwrap_or(0.0);
        let (mut q, from) = (start, own(&start));
        for _ in 0..MOST {
            let left = distance - (own(&q) - from);
            let moves = |way: &[f64; K]| libm::fabs(own(way)) > PART && libm::fabs(left) > ARRIVED;
            let Some(tangent) = self.ways(&q).find(moves) else { break };
            let length = Float::max(Float::min(left / own(&tangent), LONGEST), -LONGEST);
            let Some(next) = self.step(&q, &tangent, length, ALONG) else { break };
            q = next;
        }
        q
    }
}

pub(super) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn square<const N: usize>(a: &[f64; N]) -> f64 {
    dot(a, a)
}

/// A vector, with length 1, that is longer than so much.
fn unit<const K: usize>(vector: &[f64; K], least: f64) -> Option<[f64; K]> {
    let length = libm::sqrt(square(vector));
    (length > least).then(|| vector.map(|part| part / length))
}

/// How far values are from what is wanted, where something is.
fn missing<const K: usize>(q: &[f64; K], wanted: &[f64; K]) -> [f64; K] {
    difference(wanted, q).map(|way| if way.is_finite() { way } else { 0.0 })
}

fn difference<const K: usize>(a: &[f64; K], b: &[f64; K]) -> [f64; K] {
    moved(a, b, -1.0)
}

/// q + length * direction
pub(super) fn moved<const N: usize>(q: &[f64; N], direction: &[f64; N], length: f64) -> [f64; N] {
    let mut q = *q;
    q.iter_mut().zip(direction).for_each(|(value, part)| *value += length * part);
    q
}

/// The place of the greatest of the first `own` entries, if one takes part at all.
fn greatest<const K: usize>(direction: &[f64; K], own: usize) -> Option<usize> {
    let sizes = direction.iter().take(own).map(|part| libm::fabs(*part)).enumerate();
    let greater = |best: (usize, f64), other: (usize, f64)| if other.1 > best.1 { other } else { best };
    sizes.filter(|(_, size)| *size > PART).reduce(greater).map(|(place, _)| place)
}
