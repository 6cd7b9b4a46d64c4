//! The solution nearest to a seed, over the whole self-motion.
//!
//! The distance to the seed is a function of the free joint's value on every branch. A solution at distance D bounds
//! where a nearer one may be: the free joint itself is part of the distance, so that only values within D of the seed's
//! count. These are sampled; neighbouring samples are matched branch by branch, and a stretch of a branch is looked
//! into unless its length says that it cannot come nearer than what is known: on a path of length L between points at
//! distances A and B no point is nearer than (A + B - L) / 2. Minima are refined by parabolas, the ends of branches by
//! bisection.

use super::Redundancy;
use crate::solutions::travel;
use crate::{Float, IkError, MAX_SOLUTIONS, Solution, Solutions};

/// How many samples the whole range of the free joint takes.
const SAMPLES: f64 = 48.0;
/// A branch between two samples is longer than their distance by up to this factor.
const BENT: f64 = 1.25;
/// Stretches longer than this (rad or m) are cut in two before a parabola is laid through them.
const TAME: f64 = 0.5;
/// How often a stretch is cut in two.
const DEPTH: u32 = 8;
/// How many parabolas are tried on one stretch.
const PARABOLAS: u32 = 24;
/// How often the end of a branch is bisected.
const BISECTIONS: u32 = 40;
/// Branches that end are followed to their end if they are no farther from the seed than the best by this (rad or m).
const LAST_STRETCH: f64 = 1.5;

/// A point of a branch: the value of the free joint, the joint values in the winding nearest to the seed, and their
/// distance from it.
#[derive(Clone, Copy)]
struct Point<const N: usize, S> {
    value: S,
    q: [S; N],
    distance: S,
}

/// The allowed solutions at one value.
struct Sample<const N: usize, S> {
    value: S,
    points: [Option<Point<N, S>>; MAX_SOLUTIONS],
}

impl<const N: usize, S: Float> Sample<N, S> {
    fn points(&self) -> impl Iterator<Item = &Point<N, S>> {
        self.points.iter().flatten()
    }

    /// The point nearest to some joint values.
    fn nearest(&self, q: &[S; N]) -> Option<&Point<N, S>> {
        let mut best: Option<(&Point<N, S>, S)> = None;
        for point in self.points() {
            let distance = travel(&point.q, q);
            if best.is_none_or(|(_, least)| distance < least) {
                best = Some((point, distance));
            }
        }
        best.map(|(point, _)| point)
    }

    /// The point on the same branch as a point of another sample: each is the other's nearest.
    fn follow(&self, other: &Self, point: &Point<N, S>) -> Option<&Point<N, S>> {
        let next = self.nearest(&point.q)?;
        other.nearest(&next.q).is_some_and(|back| back.q == point.q).then_some(next)
    }
}

/// A search for the nearest solution.
struct Nearest<'r, const N: usize, S, A, P> {
    redundancy: &'r Redundancy<'r, S>,
    seed: &'r [S; N],
    at: A,
    position_of: P,
    best: Option<(Solution<N, S>, S)>,
    /// Why there is none: the last refusal of one that has solutions, else of any.
    refusal: Option<IkError<S>>,
}

impl<S: Float> Redundancy<'_, S> {
    /// The solution nearest to the seed (rad or m; by [`Solutions::nearest`]'s measure) that limits and rules allow,
    /// whatever the free joint. A seed that is itself a solution is returned as it is.
    ///
    /// `errors_of` gives position (m) and rotation error (rad) of joint values against the target, `position_of` the
    /// tool point (m) in the frame of the rules.
    ///
    /// A branch that lies between two of 48 samples of the free joint's range may be missed, if it is no part of one that
    /// goes on.
    ///
    /// # Errors
    /// Where there is none at any sample: what is said at the value nearest to the seed's at which there are
    /// solutions, else at the seed's own.
    pub fn nearest<const N: usize>(
        &self,
        at: impl FnMut(S) -> Result<Solutions<N, S>, IkError<S>>,
        position_of: impl Fn(&[S; N]) -> [S; 3],
        errors_of: impl Fn(&[S; N]) -> (S, S),
        seed: &[S; N],
    ) -> Result<Solution<N, S>, IkError<S>> {
        if !seed.iter().all(|value| value.is_finite()) {
            return Err(IkError::NotFinite);
        }
        let (position_error, rotation_error) = errors_of(seed);
        let exact = S::from_f64(EXACT) * S::EPSILON;
        if position_error <= exact * self.reach
            && rotation_error <= exact
            && self.rules.check(seed, position_of(seed)).is_ok()
        {
            return Ok(Solution { q: *seed, position_error, rotation_error, free: None });
        }
        let mut search = Nearest { redundancy: self, seed, at, position_of, best: None, refusal: None };
        search.run();
        match (search.best, search.refusal) {
            (Some((solution, _)), _) => Ok(solution),
            (None, Some(error)) => Err(error),
            (None, None) => Err(IkError::NotFinite),
        }
    }
}

/// A seed counts as a solution up to this many machine epsilons (of the reach, and rad).
const EXACT: f64 = 256.0;

impl<const N: usize, S, A, P> Nearest<'_, N, S, A, P>
where
    S: Float,
    A: FnMut(S) -> Result<Solutions<N, S>, IkError<S>>,
    P: Fn(&[S; N]) -> [S; 3],
{
    fn run(&mut self) {
        let own = self.seed.get(self.redundancy.joint).copied().unwrap_or(S::ZERO);
        let range = self.redundancy.range(own);
        let start = range.max.min(range.min.max(own));
        let middle = self.sample(start);
        let most = range.width() / S::from_f64(SAMPLES);
        // Within the distance of what is known already; at least one sample to each side.
        let window = self.distance().min(range.width());
        let (min, max) = (range.min.max(start - window), range.max.min(start + window));
        let count = |width: S| (width / most).ceil().max(S::ONE);
        let below = if start > min { count(start - min) } else { S::ZERO };
        let above = if max > start { count(max - start) } else { S::ZERO };
        // Outwards from the seed, so that what is found bounds what has to be looked at.
        let side = |count: S, end: S| if count > S::ZERO { (end - start) / count } else { S::ZERO };
        let steps = [(below, side(below, min)), (above, side(above, max))];
        let [first, second] = steps.map(|(count, step)| (count > S::ZERO).then_some(step));
        let next = [first, second].map(|step| step.map(|step| self.sample(start + step)));
        let [before, after] = &next;
        self.stretches(before.as_ref(), &middle, after.as_ref());
        for ((count, step), next) in steps.into_iter().zip(next) {
            let Some(next) = next else { continue };
            let (mut inner, mut here) = (None, next);
            let mut index = S::ONE;
            while index < count && (here.value - own).abs() < self.distance() {
                index += S::ONE;
                let outer = self.sample(start + index * step);
                self.stretches(Some(inner.as_ref().unwrap_or(&middle)), &here, Some(&outer));
                inner = Some(here);
                here = outer;
            }
            self.stretches(Some(inner.as_ref().unwrap_or(&middle)), &here, None);
        }
    }

    /// Distance of the best that is known.
    fn distance(&self) -> S {
        self.best.map_or(S::INFINITY, |(_, distance)| distance)
    }

    /// What is allowed at a value of the free joint; the best is kept.
    fn sample(&mut self, value: S) -> Sample<N, S> {
        let mut sample = Sample { value, points: [None; MAX_SOLUTIONS] };
        let rules = &self.redundancy.rules;
        let found = (self.at)(value)
            .and_then(|solutions| solutions.within(rules, &self.position_of, Some(self.seed)));
        let solutions = match found {
            Ok(solutions) => solutions,
            Err(error) => {
                let says_more = |error: &IkError<S>| {
                    matches!(error, IkError::OutsideLimits { .. } | IkError::Forbidden { .. })
                };
                if self.refusal.is_none_or(|old| says_more(&error) && !says_more(&old)) {
                    self.refusal = Some(error);
                }
                return sample;
            }
        };
        for (slot, solution) in sample.points.iter_mut().zip(&solutions) {
            let distance = travel(&solution.q, self.seed).sqrt();
            if distance < self.distance() {
                self.best = Some((*solution, distance));
            }
            *slot = Some(Point { value, q: solution.q, distance });
        }
        sample
    }

    /// The branches at a sample, between those before and after it.
    fn stretches(
        &mut self,
        before: Option<&Sample<N, S>>,
        here: &Sample<N, S>,
        after: Option<&Sample<N, S>>,
    ) {
        for point in here.points() {
            let [left, right] =
                [before, after].map(|side| side.and_then(|side| side.follow(here, point)).copied());
            if let (Some(left), Some(right)) = (left, right) {
                self.stretch(&left, point, &right, 0);
            } else {
                for other in [left, right].into_iter().flatten() {
                    self.halves(point, &other, 0);
                }
            }
            for (side, matched) in [(before, left), (after, right)] {
                if let (Some(side), None) = (side, matched) {
                    self.end(point, side.value);
                }
            }
        }
    }

    /// Whether a stretch between two points may come nearer than what is known.
    fn may_improve(&self, a: &Point<N, S>, b: &Point<N, S>) -> bool {
        let length = S::from_f64(BENT) * travel(&a.q, &b.q).sqrt();
        (a.distance + b.distance - length) / S::TWO < self.distance()
    }

    /// A stretch between two points, cut in two.
    fn halves(&mut self, a: &Point<N, S>, b: &Point<N, S>, depth: u32) {
        if !self.may_improve(a, b) {
            return;
        }
        let value = (a.value + b.value) / S::TWO;
        let sample = self.sample(value);
        if let Some(middle) = sample.nearest(&between(a, b)) {
            self.stretch(a, middle, b, depth);
        }
    }

    /// A stretch of a branch, given by three of its points.
    fn stretch(&mut self, a: &Point<N, S>, middle: &Point<N, S>, b: &Point<N, S>, depth: u32) {
        if !(self.may_improve(a, middle) || self.may_improve(middle, b)) {
            return;
        }
        let length = |a: &Point<N, S>, b: &Point<N, S>| travel(&a.q, &b.q).sqrt();
        let longest = length(a, middle).max(length(middle, b));
        if longest > S::from_f64(TAME) && depth < DEPTH {
            self.halves(a, middle, depth + 1);
            self.halves(middle, b, depth + 1);
            return;
        }
        self.parabolas(*a, *middle, *b);
    }

    /// Refines a minimum between three points of one branch.
    fn parabolas(&mut self, a: Point<N, S>, middle: Point<N, S>, b: Point<N, S>) {
        let (mut a, mut middle, mut b) = (a, middle, b);
        let square = |point: &Point<N, S>| point.distance * point.distance;
        for _ in 0..PARABOLAS {
            let (left, right) = (middle.value - a.value, b.value - middle.value);
            let (down, up) = (square(&middle) - square(&a), square(&b) - square(&middle));
            // Slopes of the two chords; their mean over the second difference leads to the vertex.
            let (slope_left, slope_right) = (down / left, up / right);
            let bend = (slope_right - slope_left) / (left + right);
            let slope = slope_left + bend * left;
            let mut step = -slope / (S::TWO * bend);
            let (least, most) = (a.value - middle.value, b.value - middle.value);
            let (least, most) = (least.min(most), most.max(least));
            let lowest = square(&middle) <= square(&a).min(square(&b));
            let inside = bend > S::ZERO && step > least && step < most;
            if !inside {
                if !lowest {
                    return;
                }
                step = if most > -least { most / S::TWO } else { least / S::TWO };
            }
            // Rounding of the square of the distance hides smaller steps.
            let hidden = S::from_f64(4.0) * (middle.distance * S::EPSILON).sqrt();
            if step.abs() <= hidden.max(S::EPSILON) {
                return;
            }
            let value = middle.value + step;
            let guess = if (step > S::ZERO) == (b.value > middle.value) {
                between(&middle, &b)
            } else {
                between(&a, &middle)
            };
            let sample = self.sample(value);
            let Some(new) = sample.nearest(&guess).copied() else { return };
            // Keep the three that enclose the lowest.
            let towards_b = (value > middle.value) == (b.value > middle.value);
            match (square(&new) <= square(&middle), towards_b) {
                (true, true) => (a, middle) = (middle, new),
                (true, false) => (b, middle) = (middle, new),
                (false, true) => b = new,
                (false, false) => a = new,
            }
        }
    }

    /// A branch that is there at a point and no more at a value: the stretches up to its end.
    fn end(&mut self, point: &Point<N, S>, gone: S) {
        let (mut inside, mut outside) = (*point, gone);
        for _ in 0..BISECTIONS {
            if inside.distance - S::from_f64(LAST_STRETCH) > self.distance()
                || (outside - inside.value).abs() <= S::EPSILON * S::from_f64(16.0)
            {
                return;
            }
            let value = (inside.value + outside) / S::TWO;
            let sample = self.sample(value);
            let limit = S::from_f64(LAST_STRETCH);
            let next = sample.nearest(&inside.q).filter(|next| travel(&next.q, &inside.q) < limit * limit);
            match next.copied() {
                Some(next) => {
                    self.halves(&inside, &next, 0);
                    inside = next;
                }
                None => outside = value,
            }
        }
    }
}

/// Halfway between two points.
fn between<const N: usize, S: Float>(a: &Point<N, S>, b: &Point<N, S>) -> [S; N] {
    let mut q = a.q;
    for (value, other) in q.iter_mut().zip(&b.q) {
        *value = (*value + *other) / S::TWO;
    }
    q
}
