//! From a path of targets to a path of joints.

use super::narrowed::Narrowed;
use super::path::Path;
use super::refusal::{JointName, Reason, Refusal, Sample};
use super::singular;
use super::spline::Spline;
use dh_runtime::{IkError, JointKind, Kinematics, SolutionSet, Target, Violation};

/// Between neighbouring solutions no joint moves further than this (rad, or this times [`SLIDE`] m). A cubic through
/// solutions as near as that leaves the path by nanometres.
const LONGEST_STEP: f64 = 0.05;

/// Metres of a joint that slides that count as much as a radian of one that turns.
const SLIDE: f64 = 0.1;

/// The path is solved at this many places at least, besides its start.
const LEAST_SAMPLES: f64 = 24.0;

/// Solutions that are still a long step apart after so small a part of the way are two branches; where there is none
/// so near to one, they end.
const SMALLEST_PART: f64 = 1e-6;

/// How far joints may stand from the path's first solution (rad, or this times [`SLIDE`] m) and still count as standing
/// on it; and how far, so that they are brought there first. Servos do not stand quite where they were sent, and say
/// where they stand in whole counts.
pub(super) const ON_PATH: f64 = 1e-6;
const NEAR_PATH: f64 = 0.05;

/// How far the curve through the solutions may be from the path between them: m and rad.
const POSITION_TOLERANCE: f64 = 1e-5;
const ROTATION_TOLERANCE: f64 = 1e-4;

/// How often the step is halved where the curve is further off than that.
const REFINEMENTS: usize = 6;

/// The joints at the start of a path, for an arm that stands there or nearly so.
pub(super) fn onto(
    arm: &Narrowed<'_>,
    problem: &str,
    path: &Path,
    start: &[f64],
) -> Result<Vec<f64>, Reason> {
    let first = nearest(arm, problem, &path.at(0.0), start).map_err(|reason| match reason {
        Reason::NoSolution(error) => Reason::NoStart(error),
        other => other,
    })?;
    let (index, step) = furthest(arm, start, &first);
    if step <= ON_PATH {
        return Ok(start.to_vec());
    }
    if step <= NEAR_PATH {
        return Ok(first);
    }
    let value = |q: &[f64]| q.get(index).copied().unwrap_or(f64::NAN);
    let joint = joint_name(arm, index);
    Err(Reason::NotOnPath { joint, value: value(start), solution: value(&first) })
}

/// The joint that moves furthest, and how far, as a multiple of a radian or of [`SLIDE`] metres.
fn furthest(arm: &Narrowed<'_>, from: &[f64], to: &[f64]) -> (usize, f64) {
    let steps = from.iter().zip(to).zip(arm.joints());
    let steps = steps.enumerate().map(|(index, ((from, to), joint))| match joint.kind {
        JointKind::Revolute => (index, (to - from).abs()),
        JointKind::Prismatic => (index, (to - from).abs() / SLIDE),
    });
    steps.fold((0, 0.0), |worst, step| if step.1 > worst.1 { step } else { worst })
}

/// The joints along a path of targets, starting from `start`; by the way made on it, as [`Path`] measures it.
pub(super) fn joints_along(
    arm: &Narrowed<'_>,
    problem: &str,
    path: &Path,
    start: &[f64],
    step: usize,
) -> Result<Spline, Refusal> {
    let mut longest = LONGEST_STEP;
    let mut worst = None;
    for _ in 0..REFINEMENTS {
        let walk = Walk { arm, problem, path, step, longest };
        let (knots, values) = walk.run(start)?;
        let count = knots.len();
        let Some(spline) = Spline::through(knots, values) else {
            break;
        };
        worst = furthest_off(arm, path, &spline);
        let Some((index, way)) = worst else {
            return Ok(spline);
        };
        worst = Some((index.min(count), way));
        longest /= 2.0;
    }
    // Where even close solutions make no smooth curve, the solution has none: it is singular there.
    let (index, way) = worst.unwrap_or((0, 0.0));
    let sample = Sample { index, count: index + 1, part: way / path.length() };
    Err(Reason::Singular { value: 0.0, least: 0.0 }.at(step, sample))
}

/// The place between knots where the curve is further from the path than it may be.
fn furthest_off(arm: &Narrowed<'_>, path: &Path, spline: &Spline) -> Option<(usize, f64)> {
    spline.knots().windows(2).enumerate().find_map(|(index, pair)| {
        let [left, right] = pair else { return None };
        [0.25, 0.5, 0.75].into_iter().find_map(|part| {
            let way = left + part * (right - left);
            let tool = arm.fk(&spline.at(way).value).ok()?;
            let target = path.at(way).validate().ok()?;
            let (position, rotation) = target.errors(&tool);
            let near = position <= POSITION_TOLERANCE && rotation <= ROTATION_TOLERANCE;
            (!near).then_some((index, way))
        })
    })
}

/// One walk along a path.
struct Walk<'w, 'k> {
    arm: &'w Narrowed<'k>,
    problem: &'w str,
    path: &'w Path,
    step: usize,
    longest: f64,
}

impl Walk<'_, '_> {
    /// Places along the path and the joints there.
    fn run(&self, start: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), Refusal> {
        let length = self.path.length();
        let (mut knots, mut values) = (vec![0.0], vec![start.to_vec()]);
        self.singular(&self.path.at(0.0), start, 0, 0.0)?;
        let greatest = length / LEAST_SAMPLES;
        let mut stride = greatest;
        let (mut way, mut here) = (0.0, start.to_vec());
        while way < length {
            // The rest in equal halves, lest the last stride be a sliver.
            let rest = length - way;
            let next = if rest <= stride { length } else { way + stride.min(rest / 2.0) };
            let target = self.path.at(next);
            let solved = self.solve(&target, &here);
            let near = |solution: &Vec<f64>| furthest(self.arm, &here, solution).1 <= self.longest;
            if !solved.as_ref().is_ok_and(near) && next - way > length * SMALLEST_PART {
                stride = (next - way) / 2.0;
                continue;
            }
            let solution = solved
                .map_err(|reason| self.at(self.ended(&target, &here).unwrap_or(reason), knots.len(), next))?;
            if !near(&solution) {
                let reason = self.ended(&target, &here).unwrap_or_else(|| self.jump(&here, &solution));
                return Err(self.at(reason, knots.len(), next));
            }
            let longest = furthest(self.arm, &here, &solution).1;
            self.singular(&target, &solution, knots.len(), next)?;
            knots.push(next);
            values.push(solution.clone());
            (way, here) = (next, solution);
            if longest < self.longest / 3.0 {
                stride = (stride * 1.5).min(greatest);
            }
        }
        Ok((knots, values))
    }

    /// The allowed solution nearest to these joint values.
    fn solve(&self, target: &Target, near: &[f64]) -> Result<Vec<f64>, Reason> {
        nearest(self.arm, self.problem, target, near)
    }

    /// Why solutions that are allowed do not go on from here: what the one that goes on breaks; or that none does, and
    /// the nearest is elsewhere. Nothing where there is no solution at all; nor where a joint is free, so that there are
    /// solutions all around.
    fn ended(&self, target: &Target, here: &[f64]) -> Option<Reason> {
        if self.arm.redundancy(self.problem).is_some() {
            return None;
        }
        let solution = singular::solve(self.arm, self.problem, target, here)?;
        if furthest(self.arm, here, &solution).1 > self.longest {
            return Some(self.jump(here, &solution));
        }
        let violations = self.arm.check(&solution).err()?;
        violations.iter().next().map(|violation: Violation<'_>| violation.into())
    }

    fn singular(&self, target: &Target, q: &[f64], index: usize, way: f64) -> Result<(), Refusal> {
        let singular =
            |error: singular::Singular| Reason::Singular { value: error.value, least: error.least };
        singular::check(self.arm, self.problem, target, q)
            .map_err(|error| self.at(singular(error), index, way))
    }

    fn jump(&self, from: &[f64], to: &[f64]) -> Reason {
        let (index, _) = furthest(self.arm, from, to);
        let value = |q: &[f64]| q.get(index).copied().unwrap_or(f64::NAN);
        Reason::Jump { joint: joint_name(self.arm, index), from: value(from), to: value(to) }
    }

    fn at(&self, reason: Reason, index: usize, way: f64) -> Refusal {
        let length = self.path.length();
        let part = if length > 0.0 { way / length } else { 1.0 };
        reason.at(self.step, Sample { index, count: index + 1, part })
    }
}

/// The solution of a problem that limits and rules allow and that is nearest to these joint values.
pub(super) fn nearest(
    arm: &Narrowed<'_>,
    problem: &str,
    target: &Target,
    near: &[f64],
) -> Result<Vec<f64>, Reason> {
    let mut solutions = SolutionSet::new();
    match arm.ik_within(problem, target, Some(near), &mut solutions) {
        Ok(()) => {}
        Err(IkError::UnknownProblem) => {
            let known = arm.problems().iter().map(|problem| problem.name.to_owned()).collect();
            return Err(Reason::UnknownProblem { problem: problem.to_owned(), known });
        }
        Err(error) => return Err(Reason::NoSolution(error)),
    }
    let solution = solutions.nearest(near).map(|solution| solution.q.to_vec());
    solution.ok_or(Reason::NoSolution(IkError::NotFinite))
}

/// The name of a joint.
pub(super) fn joint_name(arm: &Narrowed<'_>, index: usize) -> JointName {
    let joint = arm.joints().get(index);
    JointName {
        index,
        name: joint.map_or("", |joint| joint.name).into(),
        kind: joint.map_or(JointKind::Revolute, |joint| joint.kind),
    }
}
