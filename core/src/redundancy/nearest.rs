//! The solution nearest to a seed, over the whole self-motion.
//!
//! From the seed, and from places around it, downhill leads to solutions; whether another is nearer is then looked for
//! where it could be: a solution at distance D leaves only values of the free joint within D of the seed's, since that
//! joint is part of the distance. These are sampled, and from every solution at a sample that may have a nearer one on its
//! stretch of curve the way goes downhill again. Where the bottom is outside limits, the curve is followed to them.

use super::curve::{Curve, Point};
use super::{Range, Redundancy, SAMPLES};
use crate::evenly::evenly;
use crate::frame::{norm, sub};
use crate::selection::nearest_winding;
use crate::solutions::travel;
use crate::{Branch, Float, Frame, IkError, Limits, Rules, Solution, Solutions, Target, TargetKind};

/// A stretch of a branch is longer than its tangent says by up to this factor.
const BENT: f64 = 1.5;
/// Where the free joint hardly moves along the curve, a stretch of it is longer than the tangent says. What is farther
/// away than this times the square root of half the distance of samples isn't looked at.
const TURNING: f64 = 4.0;
/// How much nearer to each other samples are where the free joint turns back.
const FINER: f64 = 8.0;
/// A seed counts as a solution up to this many machine epsilons (of the reach, and rad).
const EXACT: f64 = 256.0;
/// Joint values this near to a bottom of the curve (rad or m), in its direction, lead to it again.
const SAME_STRETCH: f64 = 0.5;
/// A bottom is no farther than this many times the slope towards it (both in rad or m).
const SLOWEST: f64 = 3.0;
/// From so many places around the seed the way goes downhill, within so much of it (rad or m) in each joint.
const PLACES: u32 = 8;
const AROUND: f64 = 1.0;
/// How many bottoms are remembered.
const BOTTOMS: usize = 8;

/// What a search for the nearest solution asks of the arm.
pub struct Arm<A, F> {
    /// The solutions with the free joint at a value (rad or m).
    pub at: A,
    /// The tool frame (m), and the columns of the Jacobian there: vx vy vz (m) wx wy wz (rad), per rad or m.
    pub state: F,
}

impl<A, F> Arm<A, F> {
    /// Both functions.
    pub const fn new(at: A, state: F) -> Self {
        Self { at, state }
    }
}

struct Nearest<'r, const N: usize, S, F> {
    /// The free joint (index of q).
    joint: usize,
    rules: Rules<'r, S>,
    /// Over the whole range of the free joint.
    samples: u32,
    curve: Curve<'r, N, S, F>,
    target: Target<S>,
    best: Option<(Solution<N, S>, S)>,
    /// Allowed bottoms that were found, and others.
    bottoms: [Option<[S; N]>; BOTTOMS],
    refused: [Option<[S; N]>; BOTTOMS],
    /// Whether the way from some sample led to a bottom that was known.
    returned: bool,
    /// Whether no solution is nearer than the best that is known.
    certain: bool,
    /// Why what was found isn't allowed.
    refusal: Option<IkError<S>>,
}

/// Whether there were solutions, but none that is allowed.
fn is_of_rules<S>(error: &IkError<S>) -> bool {
    matches!(error, IkError::OutsideLimits { .. } | IkError::Forbidden { .. })
}

impl<S: Float> Redundancy<'_, S> {
    /// The solution nearest to the seed (rad or m; by [`Solutions::nearest`]'s measure) that limits and rules allow,
    /// whatever the free joint. A seed that is itself a solution is returned as it is. For problems that prescribe the
    /// whole pose and nothing else. Where the way led along the curve, the branch is not known.
    ///
    /// That none is nearer is proved where the seed is near the curve. Else a curve of solutions that lies between two of
    /// 48 samples of the free joint's range is found from places around the seed only, and may be missed: with the
    /// Panda's geometry for 1 of 20,000 seeds up to 0.5 rad off in each joint, and for 29 of 10,000 up to 1.5 rad off.
    /// Without a closed form, the samples are 6, or 48 where these have nothing that is allowed.
    ///
    /// # Errors
    /// [`IkError::NotFinite`] for such a seed, and those of [`Target::validate_as`]; where no sample has an allowed solution, which limit or rule one of them
    /// breaks, else what is said at the sample nearest to the seed.
    pub fn nearest<const N: usize, A, F>(
        &self,
        arm: Arm<A, F>,
        position_of: impl Fn(&[S; N]) -> [S; 3],
        target: &Target<S>,
        seed: &[S; N],
    ) -> Result<Solution<N, S>, IkError<S>>
    where
        A: FnMut(S) -> Result<Solutions<N, S>, IkError<S>>,
        F: Fn(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    {
        if !seed.iter().all(|value| value.is_finite()) {
            return Err(IkError::NotFinite);
        }
        let Arm { mut at, state } = arm;
        let target = target.validate_as(TargetKind::Pose)?;
        let Target::Pose(pose) = &target else {
            return Err(IkError::WrongTarget { expected: TargetKind::Pose });
        };
        let at_seed = state(seed);
        let exact = S::from_f64(EXACT) * S::EPSILON;
        let close = norm(sub(at_seed.0.translation, pose.translation)) <= exact * self.reach;
        let errors = close.then(|| target.errors(&at_seed.0)).filter(|errors| errors.1 <= exact);
        // Where the tool is at the pose, so is the point that rules ask for.
        let allowed =
            || self.rules.allow_joints(seed) && self.rules.broken_workspace(position_of(seed)).is_none();
        if let Some((position_error, rotation_error)) = errors
            && allowed()
        {
            let branch = Branch::UNKNOWN;
            return Ok(Solution { q: *seed, position_error, rotation_error, free: None, branch });
        }
        let per_reach = if self.reach > S::ZERO { S::ONE / self.reach } else { S::ONE };
        let dof = self.rules.joints.len();
        let curve = Curve { pose, per_reach, dof, state, seed };
        let mut search = Nearest {
            joint: self.joint,
            rules: self.rules,
            samples: self.samples,
            curve,
            target,
            best: None,
            bottoms: [None; BOTTOMS],
            refused: [None; BOTTOMS],
            returned: false,
            certain: false,
            refusal: None,
        };
        let own = seed.get(self.joint).copied().unwrap_or(S::ZERO);
        let first = search.curve.local(&at_seed);
        if let Some(bottom) = search.curve.nearest_point(seed, &at_seed, first, |_, _| false) {
            search.bottom(seed, &bottom, false);
        }
        if !search.certain {
            search.around();
        }
        if !search.certain {
            search.run(own, self.range(own), &mut at, &position_of);
        }
        // What limits leave may lie between few samples.
        if search.best.is_none() && self.is_searched() {
            search.samples = SAMPLES;
            search.run(own, self.range(own), &mut at, &position_of);
        }
        match (search.best, search.refusal) {
            (Some((solution, _)), _) => match self.rules.broken_workspace(position_of(&solution.q)) {
                Some(rule) => Err(IkError::Forbidden { rule }),
                None => Ok(solution),
            },
            (None, Some(error)) => Err(error),
            (None, None) => Err(IkError::NotFinite),
        }
    }
}

impl<const N: usize, S, F> Nearest<'_, N, S, F>
where
    S: Float,
    F: Fn(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
{
    /// Downhill from places around the seed: to curves on which the free joint hardly moves, between samples of it.
    fn around(&mut self) {
        for number in 1..=PLACES {
            let radius = self.distance().min(S::from_f64(AROUND));
            let parts = evenly::<S, N>(number, self.curve.dof);
            let mut from = *self.curve.seed;
            for (value, part) in from.iter_mut().zip(&parts).take(self.curve.dof) {
                *value += S::TWO * radius * *part;
            }
            let state = (self.curve.state)(&from);
            let first = self.curve.local(&state);
            let is_known = |q: &[S; N], tangent: &[S; N]| {
                self.leads_to(&self.bottoms, q, tangent) || self.leads_to(&self.refused, q, tangent)
            };
            if let Some(bottom) = self.curve.nearest_point(&from, &state, first, is_known) {
                self.bottom(&from, &bottom, false);
            }
            if self.certain {
                return;
            }
        }
    }

    /// Solutions at samples of the free joint, and downhill from there.
    fn run(
        &mut self,
        own: S,
        range: Range<S>,
        mut at: impl FnMut(S) -> Result<Solutions<N, S>, IkError<S>>,
        position_of: impl Fn(&[S; N]) -> [S; 3],
    ) {
        let mut sample = |search: &mut Self, value: S, half: S| {
            let solutions = match at(value) {
                Ok(solutions) => solutions,
                Err(error) => {
                    search.refusal.get_or_insert(error);
                    return 0;
                }
            };
            if search.best.is_none() && !search.refusal.is_some_and(|known| is_of_rules(&known)) {
                let allowed = solutions.clone().within(&search.rules, &position_of, None);
                search.refusal = allowed.err().or(search.refusal);
            }
            solutions.iter().for_each(|solution| search.start(solution, half));
            solutions.len()
        };
        let start = range.max.min(range.min.max(own));
        let most = range.width() / S::from_f64(f64::from(self.samples));
        let fine = self.samples >= SAMPLES;
        let half = S::ONE / S::TWO;
        // A single sample where everything that counts is around it; more where that one does not know of what was
        // found, since the free joint turns back near there.
        let alone = self.distance() < most * half;
        let mut step = if alone { S::TWO * self.distance() } else { most };
        let first = sample(self, start, step * half);
        // A joint whose limits are one value has no others.
        let has_others = range.width() > S::ZERO;
        if !has_others {
            return;
        }
        if alone && fine && !self.returned {
            step /= S::from_f64(FINER);
        }
        let mut counts = [first; 2];
        let mut index = S::ZERO;
        loop {
            index += S::ONE;
            let mut inside = false;
            for (side, count) in [S::ONE, -S::ONE].into_iter().zip(&mut counts) {
                let value = start + side * index * step;
                // Whether the stretch around it is too far from the seed, or out of range.
                let near = (value - own).abs() - step * half;
                let beyond = value - step * half > range.max || value + step * half < range.min;
                if near >= self.distance() || beyond {
                    continue;
                }
                inside = true;
                let value = range.max.min(range.min.max(value));
                let before = core::mem::replace(count, sample(self, value, step * half));
                if before == *count || !fine {
                    continue;
                }
                // Branches end in between.
                let finer = step / S::from_f64(FINER);
                let mut between = finer;
                while between < step {
                    sample(self, value - side * between, finer * half);
                    between += finer;
                }
            }
            if !inside {
                return;
            }
        }
    }

    /// Distance of the best that is known.
    fn distance(&self) -> S {
        self.best.map_or(S::INFINITY, |(_, distance)| distance)
    }

    /// A solution at a sample, on a stretch of a curve on which the free joint moves by `half` to either side.
    fn start(&mut self, solution: &Solution<N, S>, half: S) {
        let q = nearest_winding(&self.rules, &solution.q, self.curve.seed);
        let distance = travel(&q, self.curve.seed).sqrt();
        if distance < self.distance() && self.rules.allow_joints(&q) {
            self.best = Some((Solution { q, ..*solution }, distance));
        }
        if distance - half - S::from_f64(TURNING) * half.sqrt() >= self.distance() {
            return;
        }
        let state = (self.curve.state)(&q);
        let local = self.curve.local(&state);
        let share = local.tangent.get(self.joint).map_or(S::ONE, |x| x.abs());
        let length = (half / share).min(half + S::from_f64(TURNING) * half.sqrt());
        if distance - S::from_f64(BENT) * length >= self.distance() {
            return;
        }
        if self.leads_to(&self.bottoms, &q, &local.tangent) {
            self.returned = true;
        } else if let Some(bottom) = self.curve.nearest_point(&q, &state, local, |_, _| false) {
            self.bottom(&q, &bottom, true);
        }
    }

    /// Whether the way from here leads to one of these bottoms: it lies ahead on the tangent, downhill, and no farther than
    /// the slope says.
    fn leads_to(&self, bottoms: &[Option<[S; N]>], q: &[S; N], tangent: &[S; N]) -> bool {
        let onto = |a: &[S; N], b: &[S; N]| {
            a.iter().zip(b).zip(tangent).fold(S::ZERO, |sum, ((a, b), t)| sum + (*a - *b) * *t)
        };
        let downhill = onto(self.curve.seed, q);
        bottoms.iter().flatten().any(|bottom| {
            let (square, along) = (travel(bottom, q), onto(bottom, q));
            let ahead = along * downhill >= S::ZERO && along.abs() <= S::from_f64(SLOWEST) * downhill.abs();
            // At most 20 degrees off.
            ahead
                && square <= S::from_f64(SAME_STRETCH * SAME_STRETCH)
                && along * along >= S::from_f64(0.88) * square
        })
    }

    /// The bottom of the curve downhill from somewhere; where it isn't allowed, the ends of what is.
    fn bottom(&mut self, from: &[S; N], (point, certain): &(Point<N, S>, bool), on_curve: bool) {
        let bottom = &point.q;
        if self.consider(point, *certain) {
            self.returned |= remember(&mut self.bottoms, bottom);
            return;
        }
        if travel(bottom, self.curve.seed).sqrt() >= self.distance() {
            return;
        }
        // Where nothing is allowed yet, what is may be a point, and is tried for again.
        let known = remember(&mut self.refused, bottom) && self.best.is_some();
        let points = [Some(bottom), on_curve.then_some(from)];
        let rules = self.rules;
        for (joint, limits) in rules.joints.iter().enumerate().filter_map(|(i, j)| Some((i, j.limits?))) {
            let value = |q: &[S; N]| q.get(joint).copied().unwrap_or(S::ZERO);
            self.ends(points, known, value, &limits);
        }
        for sum in rules.sums {
            self.ends(points, known, |q: &[S; N]| sum.value(q), &sum.range);
        }
    }

    /// Where a limit that one of two points breaks begins to hold, from either; from the second alone where the first is
    /// known.
    fn ends(
        &mut self,
        points: [Option<&[S; N]>; 2],
        known: bool,
        value: impl Fn(&[S; N]) -> S,
        limits: &Limits<S>,
    ) {
        for outside in points.into_iter().flatten().map(&value).filter(|own| !limits.contains(*own)) {
            for start in points.into_iter().skip(usize::from(known)).flatten() {
                if let Some(end) = self.curve.crossing(start, &value, limits.clamp(outside), self.distance())
                {
                    self.consider(&end, false);
                }
            }
        }
    }

    /// Takes a point of the curve for the best where it is; whether it is allowed. It may be certain that none is nearer.
    fn consider(&mut self, Point { q, tool }: &Point<N, S>, certain: bool) -> bool {
        if !self.rules.allow_joints(q) {
            return false;
        }
        let distance = travel(q, self.curve.seed).sqrt();
        if distance < self.distance() {
            let (position_error, rotation_error) = self.target.errors(tool);
            let tolerance = crate::residual_tolerance::<S>();
            if position_error * self.curve.per_reach > tolerance || rotation_error > tolerance {
                return false;
            }
            let branch = Branch::UNKNOWN;
            let solution = Solution { q: *q, position_error, rotation_error, free: None, branch };
            self.best = Some((solution, distance));
            self.certain = certain;
        }
        true
    }
}

/// Whether joint values were known; they are now, if there is room.
fn remember<const N: usize, S: Float>(list: &mut [Option<[S; N]>; BOTTOMS], q: &[S; N]) -> bool {
    let known = list.iter().flatten().any(|known| travel(known, q).sqrt() <= S::SQRT_EPSILON);
    if !known && let Some(slot) = list.iter_mut().find(|slot| slot.is_none()) {
        *slot = Some(*q);
    }
    known
}
