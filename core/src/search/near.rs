//! Arms that are nearly special: axes that are a little off parallel, or a little off meeting.
//!
//! Such an arm has no closed form, but the one that it was meant to be has. That is solved, and each of its solutions is
//! brought to the pose of the arm as it is by Newton's method. None is lost by this as long as every step of the closed form
//! is well-conditioned: joint values of the arm meet the steps' equations but for the deviation of the two arms, and so are
//! near a root of each, one after the other. What they may be off by is carried from step to step, and where it comes near
//! what would make two roots one, or no root of one, poses all around the target are solved as well ([`seek`]).

mod curve;
mod newton;
mod seek;

use super::{Roots, Search};
use crate::branch::bit_of;
use crate::frame::{norm, sub};
use crate::{
    Branch, Float, Frame, GeneralArm, IkError, Polished, Solution, Solutions, Step, Winding, rotation_error,
};
use seek::Seek;

/// How many joints are found.
const UNKNOWNS: usize = 6;

/// What a nearly special arm is to the one that it was meant to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearly<'a> {
    /// The joints that are found (indices of q).
    pub unknowns: [usize; UNKNOWNS],
    /// By how much each step of the closed form is off, in the size of its equation: first what the deviation of the two
    /// arms makes at most; then, for the unknown of every step before, what one that is off by 1 (rad, reaches) does.
    pub gains: &'a [f64],
    /// How far apart the tool frames of the two are at the same joint values, at most (reaches, rad).
    pub deviation: f64,
    /// Whether the determinants of the Jacobians by these joints and by those of the arm's chain differ in sign.
    pub mirrored: bool,
    /// The arm as it is, where all its joints are found.
    pub chain: Option<Exact<'a>>,
}

/// A nearly special arm as its table has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact<'a> {
    /// Its chain.
    pub arm: GeneralArm<'a>,
    /// The joints that are found, each as a form in those of the chain (rad, m): six factors and a constant.
    pub joints: Forms,
}

/// Forms in six numbers: a factor each and a constant.
pub type Forms = [[f64; UNKNOWNS + 1]; UNKNOWNS];

/// A search of the arm that a nearly special one was meant to be.
///
/// It has the steps of [`Search`], which are to be done for every pose of [`Near::next_pose`]. Where no step came near its
/// singular condition, that is the target alone.
#[derive(Debug, Clone)]
pub struct Near<'a, const N: usize, S = f64> {
    search: Search<'a, N, S>,
    unknowns: [usize; UNKNOWNS],
    gains: &'a [f64],
    /// What the unknown of each step may be off by (rad, reaches).
    off: [S; STEPS],
    doubtful: bool,
    target: Frame<S>,
    begun: bool,
    seek: Option<Seek<N, S>>,
    deviation: f64,
    chain: Option<Exact<'a>>,
    labels: Labels<'a, S>,
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

/// Steps that follow are off in proportion to what earlier unknowns are, up to here (rad, reaches). Where none follows, the
/// whole pose decides.
const UNSURE: f64 = 0.1;
const UNSURE_AT_LAST: f64 = 0.4;

/// Cosine and sine that are off the unit circle by more than this belong to no root.
const FALSE: f64 = 0.25;

/// An error (reaches, rad) of so many machine epsilons of the target is none: it comes of rounding in the closed form.
const MET: f64 = 1e6;

impl<'a, const N: usize, S: Float> Near<'a, N, S> {
    /// A new search, see [`Search::new`], for a pose of the tool.
    #[inline]
    pub fn new(reach: S, windings: &'a [Winding<'a, S>], nearly: &Nearly<'a>, target: &Frame<S>) -> Self {
        Self {
            search: Search::new(reach, windings),
            unknowns: nearly.unknowns,
            gains: nearly.gains,
            off: [S::ZERO; STEPS],
            doubtful: false,
            target: *target,
            begun: false,
            seek: None,
            deviation: nearly.deviation,
            chain: nearly.chain,
            labels: Labels { windings, step: steps(nearly.gains.len()), mirrored: nearly.mirrored },
        }
    }

    /// The next pose that the arm that was meant is to be solved for.
    #[inline]
    pub fn next_pose(&mut self) -> Option<Frame<S>> {
        if self.begun {
            return if self.doubtful { self.next_neighbour() } else { None };
        }
        self.begun = true;
        Some(self.target)
    }

    /// What a step's equation may be off by, in its own dimension.
    #[inline]
    fn begin(&mut self, step: Step) -> S {
        let index = usize::from(step.index);
        let Some([deviation, gains @ ..]) = self.gains.get(row(index)..row(index + 1)) else {
            return S::INFINITY;
        };
        let mut off = S::from_f64(*deviation);
        for (gain, by) in gains.iter().zip(&self.off) {
            off += S::from_f64(*gain) * *by;
        }
        off * step.measure.scale(self.search.reach)
    }

    /// Whether it is the last one.
    fn is_last(&self, step: Step) -> bool {
        row(usize::from(step.index) + 1) == self.gains.len()
    }

    /// Notes by how much (rad, reaches) the unknown of a step may be off.
    #[inline]
    fn end(&mut self, step: Step, by: S) {
        let unsure = if self.is_last(step) { UNSURE_AT_LAST } else { UNSURE };
        match self.off.get_mut(usize::from(step.index)) {
            Some(off) if above(S::from_f64(unsure), by) => *off = by,
            _ => self.doubtful = true,
        }
    }

    #[cold]
    fn doubt(&mut self) -> Roots<S> {
        self.doubtful = true;
        Roots::NONE
    }

    /// [`Search::trig`]: its two roots meet where a² + b² = c².
    #[inline]
    pub fn trig(&mut self, step: Step, a: S, b: S, c: S) -> Roots<S> {
        if self.seek.is_some() {
            return self.search.trig(step, a, b, c);
        }
        let off = self.begin(step);
        let (square, inside) = (a * a + b * b, c * c);
        let rest = square - inside;
        // (h - c)(h + c) is twice as much off as h - c, in units of h.
        let margin = S::TWO * S::from_f64(MARGIN) * off;
        if rest > S::ZERO && rest * rest > margin * margin * square {
            let root = rest.sqrt();
            self.end(step, off / root);
            return super::trigonometric::both(a, b, c, root, S::ONE / square);
        }
        let h = square.sqrt();
        let excess = c.abs() - h;
        if excess > S::from_f64(MARGIN) * off && off.is_finite() {
            return self.search.unreachable_by(step, excess, h);
        }
        self.doubt()
    }

    /// [`Search::trig_unit`]: its two roots meet where d and e vanish.
    #[inline]
    pub fn trig_unit(&mut self, step: Step, row: [S; 3], others: [S; 2]) -> Roots<S> {
        if self.seek.is_some() {
            return self.search.trig_unit(step, row, others);
        }
        let ([a, b, c], [d, e]) = (row, others);
        let off = self.begin(step);
        let rest = d * d + e * e;
        let margin = S::from_f64(MARGIN) * off;
        if !above(rest, margin * margin) {
            return self.doubt();
        }
        self.end(step, off);
        let unit = S::ONE / (rest + c * c);
        let root = unit.sqrt();
        super::trigonometric::both(a, b, c * root, rest.sqrt() * root, S::ONE)
    }

    /// [`Search::trig_pair`]: it has no root where the rows are one, or vanish.
    #[inline]
    pub fn trig_pair(&mut self, step: Step, first: [S; 3], second: [S; 3]) -> Roots<S> {
        if self.seek.is_some() {
            return self.search.trig_pair(step, first, second);
        }
        let off = self.begin(step);
        let ([a1, b1, c1], [a2, b2, c2]) = (first, second);
        let determinant = a1 * b2 - a2 * b1;
        let (h1, h2) = (a1 * a1 + b1 * b1, a2 * a2 + b2 * b2);
        let h = if h1 > h2 { h1 } else { h2 };
        let inverse = S::ONE / determinant;
        let by = off * h.sqrt() * inverse.abs();
        let (cos, sin) = ((c1 * b2 - c2 * b1) * inverse, (a1 * c2 - a2 * c1) * inverse);
        let length = (cos * cos + sin * sin).sqrt();
        let miss = (length - S::ONE).abs();
        self.end(step, by);
        if miss > S::from_f64(MARGIN) * by + S::from_f64(FALSE) {
            return self.search.unreachable_by(step, miss * h.sqrt(), h.sqrt());
        }
        if !above(S::from_f64(MET) * S::EPSILON, miss) {
            return self.doubt();
        }
        let unit = S::ONE / length;
        Roots::angle([sin * unit, cos * unit])
    }

    /// [`Search::linear`]: it has no root where a vanishes.
    pub fn linear(&mut self, step: Step, a: S, c: S) -> Roots<S> {
        if self.seek.is_some() {
            return self.search.linear(step, a, c);
        }
        let off = self.begin(step);
        let unit = if step.prismatic { self.search.reach } else { S::ONE };
        let slope = (a * unit).abs();
        if !above(slope, S::from_f64(MARGIN) * off) {
            return self.doubt();
        }
        let root = c / a;
        self.end(step, off * (S::ONE + (root / unit).abs()) / slope);
        Roots::value(root)
    }

    /// [`Search::quadratic`]: its two roots meet where b² = 4 a c.
    pub fn quadratic(&mut self, step: Step, a: S, b: S, c: S) -> Roots<S> {
        if self.seek.is_some() {
            return self.search.quadratic(step, a, b, c);
        }
        let off = self.begin(step);
        let unit = if step.prismatic { self.search.reach } else { S::ONE };
        let (a, half) = (a * unit * unit, b * unit / S::TWO);
        let (square, product) = (half * half, a * c);
        let rest = square - product;
        let size = half.abs() + a.abs() + c.abs();
        let margin = S::TWO * S::from_f64(MARGIN) * off;
        if !(above(rest.abs(), margin * size) && above(a.abs(), margin)) {
            return self.doubt();
        }
        if rest < S::ZERO {
            let excess = (product.sqrt() - half.abs()) / a.abs();
            return self.search.unreachable_by(step, excess * unit, S::ONE);
        }
        let root = rest.sqrt();
        let greater = if half < S::ZERO { root - half } else { -(half + root) };
        let (first, second) = (greater / a, c / greater);
        let far = first.abs().max(second.abs()).max(S::ONE);
        self.end(step, off * far * far / root);
        Roots::values(first * unit, second * unit)
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
    pub fn accept_pose(
        &mut self,
        q: [S; N],
        tool: &Frame<S>,
        pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        if self.doubtful {
            self.seek_from(q, tool, pose_and_jacobian);
            return;
        }
        let target = &self.target;
        let position_error = norm(sub(tool.translation, target.translation));
        let rotation_error = rotation_error(&target.rotation, &tool.rotation);
        let miss = (position_error / self.search.reach).max(rotation_error);
        if !above(S::from_f64(MET) * S::EPSILON, miss) {
            // A false root of a squared equation; of one that nearly is none, nothing is known.
            let most = self.off.iter().fold(S::ZERO, |most, off| if *off > most { *off } else { most });
            self.doubtful |= !above(miss, S::from_f64(MARGIN) * most);
            self.search.miss(position_error, rotation_error);
            return;
        }
        let reach = self.search.reach;
        match newton::solve(q, &self.unknowns, target, reach, pose_and_jacobian) {
            Some((found, negative)) => self.add(&found, negative),
            None => self.doubtful = true,
        }
    }

    fn add(&mut self, found: &Polished<N, S>, negative: bool) {
        let solution = self.labels.solution(found, negative);
        // Two that have become one: another was lost.
        self.doubtful |= !self.search.solutions.append_new(solution, self.search.windings);
    }

    /// What was found, or that there is nothing to be found; `None` where that is not sure.
    #[inline]
    pub fn finish(&mut self) -> Option<Result<Solutions<N, S>, IkError<S>>> {
        if self.doubtful { self.sought() } else { Some(self.search.finish()) }
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

/// Whether a number is greater than another; not where one is none.
fn above<S: Float>(a: S, b: S) -> bool {
    a > b
}
