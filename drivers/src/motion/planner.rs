//! The checker: from what is asked for to commands that may be sent.

use super::checked::{Checked, Leg, Origin};
use super::clearance;
use super::command::Command;
use super::course::Course;
use super::dynamics::{Defaults, Dynamics};
use super::follow::{self, joint_name, joints_along, nearest};
use super::moves::{Goal, Move};
use super::narrowed::Narrowed;
use super::out_of_step;
use super::path::{self, NoPath, Path};
use super::refusal::{JointName, Reason, Reasons, Refusal, Sample};
use super::settings::Tolerance;
use super::timing;
use crate::driver::{JointMap, Pace};
use dh_runtime::{Joint, Kinematics, Limits, Rules, SumLimit, Target};
use std::fmt;
use std::time::Duration;

/// A move that would take longer than this (s) is a mistake: half an hour.
const LONGEST_MOVE: f64 = 1800.0;

/// Between setpoints of a stream joints move in straight lines, and so they do between these places where a device
/// makes its own profile (s).
const CHECK_PERIOD: f64 = 0.02;

/// Rounding may bring a joint so far beyond its limits on the way (rad or m); what is sent is on them then.
const LIMIT_ROUNDING: f64 = 1e-6;

/// Rounding of velocities, as a part of them.
const VELOCITY_ROUNDING: f64 = 1e-9;

/// A device that makes its own profiles is told to move its leading joint at this part of its greatest velocity at
/// least: less than a percent or two is nothing that such devices know.
const LEAST_PART: f64 = 0.02;

/// How far the hand of a device that makes its own profiles may leave a path between two goals: m and rad.
const GOAL_POSITION: f64 = 1e-3;
const GOAL_ROTATION: f64 = 1e-2;

/// The same where its joints do not keep in step (m).
const OUT_OF_STEP: f64 = 5e-3;

/// Plans and checks motions of one arm, without a device.
#[derive(Debug, Clone)]
pub struct Planner<'k> {
    arm: Narrowed<'k>,
    /// Greatest velocity and acceleration of each joint that the device can do.
    caps: Vec<(Option<f64>, Option<f64>)>,
    dynamics: Vec<Dynamics>,
    pace: Pace,
}

/// The driver is one of another arm's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OtherArm {
    /// The arm's fingerprint and number of joints.
    pub arm: (u64, usize),
    /// Those of the driver's table.
    pub driver: (u64, usize),
}

impl fmt::Display for OtherArm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((arm, joints), (driver, others)) = (self.arm, self.driver);
        write!(
            f,
            "the arm's table has the fingerprint {arm:016x} and {joints} joints, the driver's {driver:016x} and {others}"
        )
    }
}

impl std::error::Error for OtherArm {}

impl<'k> Planner<'k> {
    /// For an arm that this device moves: within the table's limits and what the servos leave of them.
    ///
    /// # Errors
    /// Where the joints are of another table than the arm.
    pub fn new(arm: &'k dyn Kinematics, joints: &JointMap, pace: Pace) -> Result<Self, OtherArm> {
        let (ours, theirs) = ((arm.fingerprint(), arm.dof()), (joints.fingerprint, joints.len()));
        if ours != theirs {
            return Err(OtherArm { arm: ours, driver: theirs });
        }
        let caps = joints.joints.iter().map(|joint| (joint.max_velocity, joint.max_acceleration));
        let (arm, caps) = (Narrowed::new(arm, &joints.joints), caps.collect());
        Ok(Self { arm, caps, dynamics: Vec::new(), pace }.with_defaults(&Defaults::default()))
    }

    /// With other limits of velocity, acceleration and jerk where the table has none.
    pub fn with_defaults(mut self, defaults: &Defaults) -> Self {
        self.set_defaults(defaults);
        self
    }

    pub(super) fn set_defaults(&mut self, defaults: &Defaults) {
        let joints = self.arm.joints().iter().zip(&self.caps);
        let dynamics = joints.map(|(joint, caps)| Dynamics::of_joint(joint, defaults).capped(*caps));
        self.dynamics = dynamics.collect();
    }

    /// The arm, with the limits that motion keeps.
    pub fn arm(&self) -> &dyn Kinematics {
        &self.arm
    }

    /// What the joints may do.
    pub fn dynamics(&self) -> &[Dynamics] {
        &self.dynamics
    }

    /// Checks moves, each from where the one before ends, the first from `start` (rad or m).
    ///
    /// # Errors
    /// The first thing that is wrong with any of them; then none may be run.
    pub fn plan(&self, start: &[f64], moves: &[Move]) -> Result<Checked, Refusal> {
        let mut legs: Vec<Leg> = Vec::new();
        for (step, asked) in moves.iter().enumerate() {
            let from = legs.last().map_or(start, Leg::goal).to_vec();
            legs.push(self.leg(&from, asked, step)?);
        }
        Ok(Checked { legs, origin: self.origin() })
    }

    /// What moves are checked for.
    pub(super) fn origin(&self) -> Origin {
        Origin::of(&self.arm, self.pace)
    }

    fn leg(&self, start: &[f64], asked: &Move, step: usize) -> Result<Leg, Refusal> {
        for (what, value, max) in [
            ("the part of the velocity", Some(asked.part), 1.0),
            ("the speed", asked.speed, f64::MAX),
            ("the time", asked.within, f64::MAX),
        ] {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && *value <= max)) {
                return Err(Reason::Setting { what, value }.of_step(step));
            }
        }
        self.may_begin(start, asked)
            .map_err(|reason| reason.at(step, Sample { index: 0, count: 1, part: 0.0 }))?;
        let courses = self.courses(start, asked, step)?;
        let needed = courses.iter().map(|(course, _)| course.duration()).sum();
        let allowed = asked.within.map_or(LONGEST_MOVE, |within| within.min(LONGEST_MOVE));
        if needed > allowed {
            return Err(Reason::TooLong { needed, allowed }.of_step(step));
        }
        let mut leg = Leg { start: start.to_vec(), commands: Vec::new(), times: Vec::new() };
        for (course, goals) in courses {
            let from = leg.goal().to_vec();
            leg.append(match self.pace {
                Pace::Stream { period } => self.stream(&from, &course, period, step)?,
                Pace::PointToPoint => self.goals(&from, &course, &goals, step)?,
            });
        }
        Ok(leg)
    }

    /// How the joints move, from rest to rest, and the places (times, s) that a device is sent to that makes profiles of
    /// its own.
    fn courses(&self, start: &[f64], asked: &Move, step: usize) -> Result<Vec<(Course, Vec<f64>)>, Refusal> {
        let dynamics: Vec<Dynamics> = self.dynamics.iter().map(|limits| limits.slowed(asked.part)).collect();
        let to = |goal: &[f64]| {
            let end = Sample { index: 1, count: 2, part: 1.0 };
            self.allowed(goal).map_err(|reason| reason.at(step, end))?;
            let course = Course::between(start, goal, &dynamics, self.pace);
            let course = course.map_err(|error| Reason::Profile(error).of_step(step))?;
            let duration = course.duration();
            Ok(vec![(course, vec![duration])])
        };
        match &asked.goal {
            Goal::Joints(q) => to(q),
            Goal::Nearest { problem, target } => {
                let goal = nearest(&self.arm, problem, target, start);
                to(&goal.map_err(|reason| reason.of_step(step))?)
            }
            Goal::Path { problem, through } => {
                let Some(path) = self.path(start, through).map_err(|reason| reason.of_step(step))? else {
                    return to(start);
                };
                let end = Sample { index: 1, count: 2, part: 1.0 };
                // An end that can't be reached says more than the place where the way there breaks off.
                nearest(&self.arm, problem, &path.at(path.length()), start)
                    .map_err(|reason| reason.at(step, end))?;
                let first = follow::onto(&self.arm, problem, &path, start);
                let first =
                    first.map_err(|reason| reason.at(step, Sample { index: 0, count: 1, part: 0.0 }))?;
                let mut courses = if first == start { Vec::new() } else { to(&first)? };
                let joints = joints_along(&self.arm, problem, &path, &first, step)?;
                let goal = joints.values().last().map_or(start, Vec::as_slice);
                self.allowed(goal).map_err(|reason| reason.at(step, end))?;
                let timing = timing::along(&self.arm, &dynamics, &joints, asked.speed, asked.part, step)?;
                let course = Course::Path { timing, joints };
                let goals = self.places_on(&path, &course);
                courses.push((course, goals));
                Ok(courses)
            }
        }
    }

    /// The path of targets from where the arm stands; `None` where it is there already.
    fn path(&self, start: &[f64], through: &[Target]) -> Result<Option<Path>, Reason> {
        let (Some(goal), Ok(tool)) = (through.last(), self.arm.fk(start)) else {
            return Ok(None);
        };
        let valid = through.iter().map(Target::validate).collect::<Result<Vec<_>, _>>();
        let valid = valid.map_err(Reason::NoSolution)?;
        let from = path::of_tool(goal.kind(), &tool, goal);
        let path = match valid.as_slice() {
            [goal] => Path::line(&from, goal),
            through => Path::curve(&from, through),
        };
        let path = path.map_err(|error| match error {
            NoPath::Kind(got) => Reason::Kinds { expected: goal.kind(), got },
            NoPath::HalfTurn => Reason::HalfTurn,
        })?;
        Ok((path.length() > follow::ON_PATH).then_some(path))
    }

    /// Setpoints, one a period, each checked, and what lies between them.
    fn stream(&self, start: &[f64], course: &Course, period: Duration, step: usize) -> Result<Leg, Refusal> {
        let period = period.as_secs_f64();
        let count = (course.duration() / period).ceil().max(1.0) as usize;
        let mut leg = Leg { start: start.to_vec(), commands: Vec::with_capacity(count), times: Vec::new() };
        let mut before = start.to_vec();
        for index in 1..=count {
            let time = index as f64 * period;
            let (positions, velocities) = course.at(time);
            let sample = Sample { index, count: count + 1, part: index as f64 / count as f64 };
            let refused = |reasons: Reasons| reasons.at(step, sample);
            let positions = self.on_the_way(positions, start).map_err(refused)?;
            self.not_too_fast(&before, &positions, period).map_err(refused)?;
            self.clear(&before, &positions).map_err(refused)?;
            before.clone_from(&positions);
            leg.commands.push(Command::new(self.arm.fingerprint(), positions, velocities));
            leg.times.push(time);
        }
        Ok(leg)
    }

    /// Goals at these times, and straight lines (in joint space) between them, checked.
    fn goals(&self, start: &[f64], course: &Course, times: &[f64], step: usize) -> Result<Leg, Refusal> {
        let mut leg = Leg { start: start.to_vec(), commands: Vec::new(), times: Vec::new() };
        let times = self.in_step(start, course, times);
        let (mut before, mut then) = (start.to_vec(), 0.0);
        for (place, time) in times.iter().enumerate() {
            let (positions, _) = course.at(*time);
            let sample = |part: f64| {
                let part = (then + part * (time - then)) / course.duration().max(f64::MIN_POSITIVE);
                Sample { index: place + 1, count: times.len() + 1, part }
            };
            let positions =
                self.on_the_way(positions, start).map_err(|reason| reason.at(step, sample(1.0)))?;
            let pieces = ((time - then) / CHECK_PERIOD).ceil().max(1.0) as usize;
            let mut here = before.clone();
            for piece in 1..=pieces {
                let part = piece as f64 / pieces as f64;
                let next =
                    before.iter().zip(&positions).map(|(from, to)| from + part * (to - from)).collect();
                let refused = |reasons: Reasons| reasons.at(step, sample(part));
                let next = self.on_the_way(next, start).map_err(refused)?;
                self.clear(&here, &next).map_err(refused)?;
                here = next;
            }
            let velocities = course.fastest(then, *time, before.iter().zip(&positions));
            let velocities = self.no_slower_than_devices_go(velocities);
            before.clone_from(&positions);
            then = *time;
            leg.commands.push(Command::new(self.arm.fingerprint(), positions, velocities));
            leg.times.push(*time);
        }
        Ok(leg)
    }

    /// The same goals, and others between them where the tool point could break a rule if the joints got out of step.
    fn in_step(&self, start: &[f64], course: &Course, times: &[f64]) -> Vec<f64> {
        let (mut all, mut before, mut then) = (Vec::new(), start.to_vec(), 0.0);
        // What is to be reached, the next last.
        let mut left: Vec<f64> = times.iter().rev().copied().collect();
        while let Some(time) = left.pop() {
            let (goal, _) = course.at(time);
            let middle = f64::midpoint(then, time);
            // In so short a time (s) nothing moves by more than does not matter.
            let divisible = time - then > 1e-3;
            if divisible && !out_of_step::keeps_rules(&self.arm, &before, &goal) {
                left.extend([time, middle]);
                continue;
            }
            all.push(time);
            (before, then) = (goal, time);
        }
        all
    }

    /// Velocities of a goal, raised together where the leading joint would be slower than devices can be told to be.
    fn no_slower_than_devices_go(&self, velocities: Vec<f64>) -> Vec<f64> {
        let parts =
            velocities.iter().zip(&self.dynamics).map(|(velocity, limits)| velocity / limits.velocity);
        let leading = parts.fold(0.0, f64::max);
        let factor = if leading > 0.0 { (LEAST_PART / leading).max(1.0) } else { 1.0 };
        velocities.into_iter().map(|velocity| velocity * factor).collect()
    }

    /// The places on a path (s) between which straight lines in joint space keep near to it.
    fn places_on(&self, path: &Path, course: &Course) -> Vec<f64> {
        let duration = course.duration();
        let Course::Path { timing, .. } = course else {
            return vec![duration];
        };
        let count = (duration / CHECK_PERIOD).ceil().max(1.0) as usize;
        let time = |place: usize| if place >= count { duration } else { place as f64 * CHECK_PERIOD };
        let way = |time: f64| timing.at(time).0;
        let near = |from: usize, to: usize| {
            let (start, end) = (course.at(time(from)).0, course.at(time(to)).0);
            out_of_step::stays_near(&self.arm, &start, &end, OUT_OF_STEP)
                && (from + 1..to).all(|between| {
                    let q = course.at(time(between)).0;
                    let (mut along, mut whole) = (0.0, 0.0);
                    for ((start, end), q) in start.iter().zip(&end).zip(&q) {
                        along += (q - start) * (end - start);
                        whole += (end - start).powi(2);
                    }
                    let part = if whole > 0.0 { along / whole } else { 0.0 };
                    let q: Vec<f64> = start.iter().zip(&end).map(|(a, b)| a + part * (b - a)).collect();
                    let target = path.at(way(time(between))).validate();
                    match (self.arm.fk(&q), target) {
                        (Ok(tool), Ok(target)) => {
                            let (position, rotation) = target.errors(&tool);
                            position <= GOAL_POSITION && rotation <= GOAL_ROTATION
                        }
                        _ => false,
                    }
                })
        };
        let (mut places, mut here) = (Vec::new(), 0);
        while here < count {
            // As far as it goes: twice as far as long as that is near, then halving.
            let (mut good, mut stride) = (here + 1, 2);
            while here + stride <= count && near(here, here + stride) {
                good = here + stride;
                stride *= 2;
            }
            let mut bad = (here + stride).min(count + 1);
            while good + 1 < bad {
                let middle = usize::midpoint(good, bad);
                if near(here, middle) { good = middle } else { bad = middle }
            }
            here = good.min(count);
            places.push(time(here));
        }
        places
    }

    /// Whether a move may begin there. One of all joints at once may lead out of what is forbidden; a path is solved, and
    /// solutions keep all limits and rules.
    fn may_begin(&self, start: &[f64], asked: &Move) -> Result<(), Reasons> {
        match (self.allowed(start), &asked.goal) {
            (
                Err(Reasons { first: Reason::OutsideLimits { .. } | Reason::Forbidden(_), .. }),
                Goal::Joints(_) | Goal::Nearest { .. },
            ) => Ok(()),
            (outcome, _) => outcome,
        }
    }

    /// Whether the arm may stand there.
    fn allowed(&self, q: &[f64]) -> Result<(), Reasons> {
        self.arm.check(q).map_err(|violations| {
            let nameless = || Reason::Setting { what: "a joint value", value: f64::NAN }.into();
            Reasons::of_violations(&violations).unwrap_or_else(nameless)
        })
    }

    /// Joint values of a sample on the way: limits and sums, with joints that rounding has brought beyond their limits
    /// on them. Limits and sums that are broken where the move starts may be so on the way, but by no more than there.
    fn on_the_way(&self, q: Vec<f64>, start: &[f64]) -> Result<Vec<f64>, Reasons> {
        let mut q = q;
        for (value, joint) in q.iter_mut().zip(self.arm.joints()) {
            if let Some(limits) = joint.limits {
                let inside = limits.clamp(*value);
                if (*value - inside).abs() <= LIMIT_ROUNDING {
                    *value = inside;
                }
            }
        }
        // The tool point is for `clearance`, which knows how far it may stray on the way.
        let all = self.arm.rules();
        let widened =
            |limits: Limits, start: f64| Limits { min: limits.min.min(start), max: limits.max.max(start) };
        let joints: Vec<Joint<'_>> = all
            .joints
            .iter()
            .zip(start)
            .map(|(joint, start)| Joint {
                limits: joint.limits.map(|limits| widened(limits, *start)),
                ..*joint
            })
            .collect();
        let sums: Vec<SumLimit<'_>> = all
            .sums
            .iter()
            .map(|sum| SumLimit { range: widened(sum.range, sum.value(start)), ..*sum })
            .collect();
        let rules = Rules { joints: &joints, sums: &sums, bounds: &[], keep_out: &[], ..all };
        Reasons::of_violations(&rules.violations(&q, [0.0; 3])).map_or(Ok(q), Err)
    }

    /// Whether the tool point keeps the rules from one sample to the next.
    fn clear(&self, from: &[f64], to: &[f64]) -> Result<(), Reasons> {
        clearance::check(&self.arm, from, to).map_err(|rule| Reason::Forbidden(rule).into())
    }

    /// Whether all joints can get from one sample to the next in this time (s).
    fn not_too_fast(&self, from: &[f64], to: &[f64], seconds: f64) -> Result<(), Reasons> {
        for (index, ((from, to), limits)) in from.iter().zip(to).zip(&self.dynamics).enumerate() {
            let needed = (to - from).abs() / seconds;
            let allowed = limits.velocity;
            if needed > allowed * (1.0 + VELOCITY_ROUNDING) {
                let joint = joint_name(&self.arm, index);
                return Err(Reason::Rushed { joint, needed, allowed }.into());
            }
        }
        Ok(())
    }

    /// Joint values that are beyond their limits by this much (rad or m) at most, brought back.
    pub(super) fn inside(&self, q: &[f64], tolerance: &Tolerance) -> Vec<f64> {
        let inside = |(value, joint): (&f64, &Joint<'_>)| {
            let near = |limits: &Limits| (limits.clamp(*value) - value).abs() <= tolerance.of(joint.kind);
            let limits = joint.limits.filter(near);
            limits.map_or(*value, |limits| limits.clamp(*value))
        };
        q.iter().zip(self.arm.joints()).map(inside).collect()
    }

    /// The name of a joint.
    pub(super) fn joint_name(&self, index: usize) -> JointName {
        joint_name(&self.arm, index)
    }
}
