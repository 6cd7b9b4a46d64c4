//! The curve on which five joints make up for what the sixth does, but for one direction in which they can't: along it the tool
//! hardly moves, and what is missing is one number. Solutions are where that is 0.
//!
//! So it is about a singular pose, of whatever kind: two solutions that meet at a fold lie on one curve, and so do those that
//! the self-motion of a singular arm leaves when the arm is a little other \[the reduction of Lyapunov and Schmidt; Golubitsky
//! and Schaeffer, Singularities and Groups in Bifurcation Theory, §I.3\].

use super::asked::Asked;
use super::cubic::{lowest, root};
use super::newton;
use super::reduced::Reduced;
use super::{Labels, UNKNOWNS};
use crate::polish::{Polished, descend};
use crate::{Float, Frame, Solution, Solutions};

/// A candidate whose error (reaches, rad) Newton's method doesn't bring below this is none.
const FOUND: f64 = 1e-12;

/// What rounding leaves of a target that is met (reaches, rad), and how far apart (rad, m) joint values may be that are asked
/// whether they are one solution.
const MET: f64 = 1e-13;
const CROWD: f64 = 0.02;

/// Damped steps at most.
const STEPS: usize = 24;

/// The leading joint goes this far (rad, reaches) from one place to the next, or by half of it so often where the others don't
/// follow; so many places at most.
const STRIDE: f64 = 0.3;
const HALVED: u32 = 16;
const PLACES: u32 = 96;

/// A curve that comes back as near as this (rad) to where it began is closed.
const CLOSED: f64 = 0.03;

/// A stride is short enough where the mean of the slopes at its ends predicts the change of what is missing to this share.
const OFF: f64 = 0.02;

/// Corrections of the other joints at most, and how far (rad, reaches) one may go.
const CORRECTIONS: usize = 6;
const LONG: f64 = 0.5;

/// What the other joints leave is at most this share of what is missing, or of what a step of this size makes of it.
const SHARE: f64 = 1e-2;

/// Five joints of which one moves the tool by less than this (reaches, rad) in a direction of its own are singular themselves.
const WEAK: f64 = 1e-3;

/// The same in multiples of what the arm is off by: the greater of the two counts.
const WEAKEST: f64 = 3.0;

/// The curve is left where more than this (reaches, rad) is missing and more would be.
const AWAY: f64 = 0.05;

/// The same in multiples of what the arm is off by: the less of the two counts. What the arm is off by makes solutions no farther
/// from a pose than some of them.
const FAR: f64 = 6.0;

/// A curve that is lost where more than so many times what the arm is off by are missing has left the target.
const CLEAR: f64 = 3.0;

/// An interval is divided so often where the missing is least, as long as it may vanish there.
const DIVIDED: u32 = 6;

/// The joint values of a place and a solution beside it differ by at most so many strides.
const BESIDE: f64 = 1.0;

/// The greatest difference of two sets of joint values, whole turns aside.
pub(super) fn apart<const N: usize, S: Float>(a: &[S; N], b: &[S; N]) -> S {
    a.iter().zip(b).fold(S::ZERO, |away, (a, b)| away.max((*a - *b).wrap_angle().abs()))
}

/// A place on the curve.
#[derive(Debug, Clone, Copy)]
struct Place<const N: usize, S> {
    q: [S; N],
    /// Which of the unknowns leads.
    lead: usize,
    /// What is missing, and how it changes with the leading joint.
    missing: S,
    slope: S,
    /// How the unknowns change with it.
    rates: [S; UNKNOWNS],
    /// The direction in which it is missing.
    normal: [S; UNKNOWNS],
}

impl<const N: usize, S: Float> Place<N, S> {
    /// Whether it is a double root, as far as rounding tells.
    fn is_double(&self) -> bool {
        self.missing.abs() <= S::from_f64(NOISE) * S::EPSILON && self.slope.abs() <= S::SQRT_EPSILON
    }

    /// Whether a cubic is as good as what is missing up to another place, of which the leading joint is a stride apart.
    fn leads_to(&self, next: &Self, stride: S) -> bool {
        let change = (self.slope + next.slope * turned_to(self, next)) * stride / S::TWO;
        let most = self.missing.abs().max(next.missing.abs());
        let off = (next.missing - self.missing - change).abs();
        off <= S::from_f64(OFF) * most + S::from_f64(512.0) * S::EPSILON
    }
}

/// So many machine epsilons (reaches, rad) of what is missing may be rounding.
const NOISE: f64 = 256.0;

/// How a curve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// Where it began.
    Closed,
    /// Far from the target.
    Away,
    /// Somewhere unknown: solutions may be missing.
    Lost,
}

/// The arm as it is, to be brought to the target.
pub(super) struct Arm<'a, const N: usize, S, F> {
    pub(super) asked: Asked<'a, S>,
    pub(super) labels: &'a Labels<'a, S>,
    /// How far it is from that which was meant (reaches, rad).
    pub(super) deviation: S,
    pub(super) pose_and_jacobian: F,
}

impl<const N: usize, S: Float, F: FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N])> Arm<'_, N, S, F> {
    /// Brings joint values to the target.
    pub(super) fn bring(&mut self, q: [S; N]) -> Option<Solution<N, S>> {
        if let Some(found) = newton::solve(q, &self.asked, &mut self.pose_and_jacobian) {
            return Some(self.labels.solution(&found.at, found.determinant < S::ZERO));
        }
        let met = S::from_f64(FOUND).max(S::from_f64(64.0) * S::EPSILON);
        let found = self.polish(q, STEPS);
        if !(found.position_error <= met * self.asked.reach && found.rotation_error <= met) {
            return None;
        }
        let (tool, columns) = (self.pose_and_jacobian)(&found.q);
        let negative = newton::is_negative(&self.asked, &tool, &columns);
        Some(self.labels.solution(&found, negative))
    }

    /// Adds a solution, unless nothing tells it from one beside it: where roots have met in threes and more, there is a crowd of
    /// joint values that meet the target, and so does what is between them.
    pub(super) fn add(&mut self, solution: Solution<N, S>, found: &mut Solutions<N, S>) {
        if !found.iter().any(|known| self.are_one(known, &solution)) {
            found.push(solution, self.labels.windings);
        }
    }

    fn are_one(&mut self, one: &Solution<N, S>, other: &Solution<N, S>) -> bool {
        let mut way = other.q;
        way.iter_mut().zip(one.q).for_each(|(to, from)| *to = (*to - from).wrap_angle());
        if !way.iter().all(|part| part.abs() <= S::from_f64(CROWD)) {
            return false;
        }
        let reach = self.asked.reach;
        let error = |(position, rotation): (S, S)| (position / reach).max(rotation);
        let own = [one, other].map(|one| error((one.position_error, one.rotation_error)));
        let most = S::TWO * own[0].max(own[1]);
        let met = S::from_f64(MET).max(S::from_f64(64.0) * S::EPSILON).max(most);
        [0.25, 0.5, 0.75].into_iter().all(|share| {
            let mut q = one.q;
            q.iter_mut().zip(way).for_each(|(value, part)| *value += S::from_f64(share) * part);
            let (tool, _) = (self.pose_and_jacobian)(&q);
            error(self.asked.target.errors(&tool)) <= met
        })
    }

    /// Joint values to which damped steps lead, if no more is missing there (reaches, rad).
    pub(super) fn descend(&mut self, from: [S; N], steps: usize, most: S) -> Option<[S; N]> {
        let end = self.polish(from, steps);
        let met = end.position_error <= most * self.asked.reach && end.rotation_error <= most;
        met.then_some(end.q)
    }

    /// By damped steps of the unknowns.
    fn polish(&mut self, from: [S; N], steps: usize) -> Polished<N, S> {
        let (asked, exact) = (self.asked, &mut self.pose_and_jacobian);
        let at = |changes: &[S; UNKNOWNS]| {
            let mut q = from;
            asked.go(&mut q, changes);
            q
        };
        let (changes, tool) = descend([S::ZERO; UNKNOWNS], steps, S::ZERO, |changes| {
            let (tool, columns) = exact(&at(changes));
            (tool, asked.missing(&tool), asked.columns(&tool, &columns))
        });
        let (position_error, rotation_error) = asked.target.errors(&tool);
        Polished { q: at(&changes), position_error, rotation_error }
    }

    /// How little (reaches, rad) the tool moves at joint values with a joint that goes by 1; `None` where it hardly moves with
    /// another one either.
    pub(super) fn stiffness(&mut self, q: [S; N]) -> Option<S> {
        self.place(q, self.asked.last(), None).map(|place| place.slope.abs())
    }

    /// How much is missing (reaches, rad) at a place of the curve beside joint values.
    pub(super) fn missing(&mut self, from: [S; N]) -> Option<S> {
        self.start(from).map(|start| start.missing.abs())
    }

    /// The place of the curve beside joint values.
    fn start(&mut self, from: [S; N]) -> Option<Place<N, S>> {
        let start = self.place(from, self.asked.last(), None)?;
        super::above(S::from_f64(LONG), apart(&start.q, &from)).then_some(start)
    }

    /// Adds the solutions on the curve beside joint values, as far as the leading joint goes within a range (rad, reaches).
    /// Says whether these are all.
    pub(super) fn follow(&mut self, from: [S; N], range: S, found: &mut Solutions<N, S>) -> bool {
        let Some(start) = self.start(from) else { return false };
        // Where it is itself a double root, it is none between two places.
        if start.is_double()
            && let Some(hit) = self.bring(start.q)
        {
            self.add(hit, found);
        }
        for side in [S::ONE, -S::ONE] {
            match self.walk(&start, side, range, found) {
                End::Closed => return true,
                End::Away => {}
                End::Lost => return false,
            }
        }
        true
    }

    /// Goes along the curve to one side.
    fn walk(&mut self, start: &Place<N, S>, side: S, range: S, found: &mut Solutions<N, S>) -> End {
        let stride = S::from_f64(STRIDE);
        let least = S::TWO * start.missing.abs();
        let far = least.max(S::from_f64(AWAY).min(S::from_f64(FAR) * self.deviation));
        let clear = least.max(S::from_f64(CLEAR) * self.deviation);
        let (mut at, mut ahead, mut step) = (*start, side, stride);
        let mut gone = S::ZERO;
        for _ in 0..PLACES {
            let mut halved = 0;
            let mut next = self.next(&at, ahead * step);
            while halved < HALVED && !next.is_some_and(|next| at.leads_to(&next, ahead * step)) {
                halved += 1;
                step /= S::TWO;
                next = self.next(&at, ahead * step);
            }
            let Some(next) = next.filter(|_| halved < HALVED) else {
                // Far from the target there may be no such curve.
                return if at.missing.abs() > clear { End::Away } else { End::Lost };
            };
            if !self.between(&at, &next, ahead * step, DIVIDED, found) {
                return End::Lost;
            }
            // Where another joint leads, it may do so in the other direction.
            if at.rates.get(next.lead).is_some_and(|rate| *rate * ahead < S::ZERO) {
                ahead = -S::ONE;
            } else {
                ahead = S::ONE;
            }
            at = next;
            gone += step;
            step = stride.min(S::TWO * step);
            if gone > range || (at.missing.abs() > far && at.missing * at.slope * ahead > S::ZERO) {
                return End::Away;
            }
            // Another strand of the curve may pass by the start, the other way.
            let onward = start.rates.get(at.lead).is_some_and(|rate| *rate * side * ahead > S::ZERO);
            let back = onward && gone > S::TWO * S::TWO * stride && apart(&at.q, &start.q) < S::TWO * stride;
            if back && self.close(&at, start, ahead, found) {
                return End::Closed;
            }
        }
        End::Lost
    }

    /// Goes the last stride of a closed curve, if it can be one.
    fn close(
        &mut self,
        at: &Place<N, S>,
        start: &Place<N, S>,
        ahead: S,
        found: &mut Solutions<N, S>,
    ) -> bool {
        let joint = self.asked.unknowns.get(at.lead).copied().unwrap_or(0);
        let [from, to] = [&at.q, &start.q].map(|q| q.get(joint).copied().unwrap_or(S::ZERO));
        let rest = (to - from).wrap_angle();
        let last = self.next(at, rest);
        let Some(last) = last.filter(|last| apart(&last.q, &start.q) < S::from_f64(CLOSED)) else {
            return false;
        };
        rest * ahead <= S::ZERO || self.between(at, &last, rest, DIVIDED, found)
    }

    /// The place where the leading joint is farther by a stride.
    fn next(&mut self, at: &Place<N, S>, stride: S) -> Option<Place<N, S>> {
        let mut q = at.q;
        self.asked.go(&mut q, &at.rates.map(|rate| stride * rate));
        let next = self.place(q, at.lead, Some(&at.normal))?;
        (apart(&next.q, &q) < S::from_f64(0.5) * stride.abs()).then_some(next)
    }

    /// Adds the solutions between two places, of which the leading joint of the first is a stride apart. Says whether these
    /// are all.
    fn between(
        &mut self,
        a: &Place<N, S>,
        b: &Place<N, S>,
        stride: S,
        divided: u32,
        found: &mut Solutions<N, S>,
    ) -> bool {
        let turned = turned_to(a, b);
        let ends = [a.missing, b.missing];
        let slopes = [a.slope * stride, b.slope * turned * stride];
        let share = if ends[0] * ends[1] <= S::ZERO {
            root(ends, slopes)
        } else if let Some((share, least)) = lowest(ends, slopes) {
            // Far from 0 the cubic is as good as what is missing.
            if least > S::from_f64(0.5) * ends[0].abs().min(ends[1].abs()) {
                return true;
            }
            let Some(middle) = self.next(a, stride * share) else { return false };
            if middle.is_double() {
                if let Some(hit) = self.bring(middle.q) {
                    self.add(hit, found);
                }
                return true;
            }
            if divided == 0 {
                return false;
            }
            return self.between(a, &middle, stride * share, divided - 1, found)
                && self.between(
                    &middle,
                    b,
                    stride * (S::ONE - share) * turned_to(a, &middle),
                    divided - 1,
                    found,
                );
        } else {
            return true;
        };
        let mut q = a.q;
        for (value, to) in q.iter_mut().zip(b.q) {
            *value += share * (to - *value);
        }
        let size = S::from_f64(BESIDE) * stride.abs();
        if let Some(hit) = newton::solve(q, &self.asked, &mut self.pose_and_jacobian)
            && apart(&hit.at.q, &q) <= size
        {
            let hit = self.labels.solution(&hit.at, hit.determinant < S::ZERO);
            self.add(hit, found);
            return true;
        }
        if divided == 0 {
            let Some(hit) = self.bring(q) else { return false };
            self.add(hit, found);
            return apart(&hit.q, &q) <= size;
        }
        let Some(middle) = self.next(a, stride * share) else { return false };
        self.between(a, &middle, stride * share, divided - 1, found)
            && self.between(&middle, b, stride * (S::ONE - share) * turned_to(a, &middle), divided - 1, found)
    }

    /// The place on the curve at joint values, as far as the leading joint is concerned.
    fn place(
        &mut self,
        mut q: [S; N],
        mut lead: usize,
        normal: Option<&[S; UNKNOWNS]>,
    ) -> Option<Place<N, S>> {
        let long = S::from_f64(LONG);
        for _ in 0..CORRECTIONS {
            let (tool, jacobian) = (self.pose_and_jacobian)(&q);
            let (columns, missing) = (self.asked.columns(&tool, &jacobian), self.asked.missing(&tool));
            let mut reduced = Reduced::new(&columns, &missing, lead, normal);
            for _ in 0..UNKNOWNS {
                let Some(other) = reduced.ahead() else { break };
                lead = other;
                reduced = Reduced::new(&columns, &missing, lead, normal);
            }
            if !super::above(reduced.weakest, S::from_f64(WEAK).max(S::from_f64(WEAKEST) * self.deviation)) {
                return None;
            }
            let rounding = S::from_f64(8.0) * S::EPSILON;
            let left = reduced.left;
            let along = reduced.missing.abs() + S::from_f64(SHARE) * reduced.slope.abs();
            if left <= rounding || left <= S::from_f64(SHARE) * along {
                let Reduced { missing, slope, rates, normal, .. } = reduced;
                return Some(Place { q, lead, missing, slope, rates, normal });
            }
            if !reduced.change.iter().all(|change| super::above(long, change.abs())) {
                return None;
            }
            self.asked.go(&mut q, &reduced.change);
        }
        None
    }
}

/// What a stride of the leading joint of one place is for that of another.
fn turned_to<const N: usize, S: Float>(a: &Place<N, S>, b: &Place<N, S>) -> S {
    let rate = b.rates.get(a.lead).copied().unwrap_or(S::ONE);
    if rate == S::ZERO { S::ONE } else { S::ONE / rate }
}

#[cfg(test)]
mod tests {
    use super::apart;

    #[test]
    fn whole_turns_are_no_distance() {
        let q = [0.1, -0.2, 3.1, 0.0, 1.0, -3.0];
        let turned = q.map(|x| x + core::f64::consts::TAU);
        assert!(apart(&q, &turned) < 1e-12);
        let mut other = turned;
        other[5] -= 0.25;
        assert!((apart(&q, &other) - 0.25_f64).abs() < 1e-12);
    }
}
