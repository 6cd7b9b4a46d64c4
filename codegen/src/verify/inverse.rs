//! Inverse problems: forward kinematics of what they return, and whether what they were asked from is among it.

use super::constraints::Constraints;
use super::prescribed::{prescribed, target_of};
use super::report::{FunctionReport, InverseReport};
use super::where_clause::Wheres;
use super::{
    COMPLETE, COMPLETE_NEAR_SINGULAR, Level, RESIDUAL, RESIDUAL_SINGULAR, SINGULAR, Tolerance, poses,
    reference, singular_values,
};
use crate::model::{self, Model};
use crate::plan::eval::{Given, Program};
use dh_core::{MAX_SOLUTIONS, Target, Winding};
use std::cell::OnceCell;

/// Step of the finite differences (rad or m): their error is then some 1e-10, far below [`SINGULAR`].
const DIFFERENCE: f64 = 1e-6;

/// A problem is judged at about so many poses.
const ASKED: usize = 32;

/// One inverse problem under verification.
pub(super) struct Inverse<'v> {
    pub(super) model: &'v Model,
    pub(super) program: &'v Program<'v>,
    /// Index into `Model::problems`; `None` for the full pose.
    pub(super) problem: Option<usize>,
    pub(super) constraints: &'v Constraints,
    /// Joints that the caller gives.
    pub(super) free: &'v [usize],
    /// Whole turns that make no difference.
    pub(super) windings: &'v [Winding<'v>],
    /// m
    pub(super) reach: f64,
    /// [`Model::row_for_arm_angle`]
    pub(super) row_for_arm_angle: Option<usize>,
}

impl Inverse<'_> {
    /// Asks for the pose at every joint vector; the first wrong answer ends up in the report as the failure.
    pub(super) fn verify(&self, level: Level, report: &mut FunctionReport) {
        let wheres = Wheres::of(self.model, self.problem);
        let wanted = |q: &[f64]| wheres.clearly_keep(q);
        let poses = poses::poses(self.model, self.constraints, level, self.reach, wanted);
        for (number, q) in poses.iter().enumerate() {
            let Some(target) = target_of(self.kind(), &reference::tool(self.model, q), number, self.reach)
            else {
                continue;
            };
            report.poses += 1;
            if let Err(failure) = self.pose(q, &target, &wheres, report) {
                report.failure = Some(format!("{failure}, asked for the pose at q = {q:?}"));
                if let Some(inverse) = &mut report.inverse {
                    inverse.stiffness = self.stiffness(&poses);
                }
                return;
            }
        }
        // A `where` that keeps next to nothing may hold at none of the poses: then there was nothing to find.
        if report.poses == 0 {
            report.failure = Some("no pose was found at which it could be verified".to_owned());
        }
    }

    fn pose(
        &self,
        q: &[f64],
        target: &Target<f64>,
        wheres: &Wheres<'_>,
        report: &mut FunctionReport,
    ) -> Result<(), String> {
        let free: Vec<f64> = self.free.iter().map(|joint| q.get(*joint).copied().unwrap_or(0.0)).collect();
        let given = Given { free: &free, seed: None };
        let answer = self.program.inverse(self.problem, target, given, self.windings, |_| ());
        let Some(answer) = answer else { return Err("it cannot be run".to_owned()) };
        let allowed = wheres.clearly_keep(q);
        let solutions = match &answer {
            Ok(solutions) => solutions.as_slice(),
            Err(_) if !allowed => &[],
            Err(error) => return Err(format!("no solution found ({error})")),
        };
        let smallest = OnceCell::new();
        let smallest = || *smallest.get_or_init(|| self.smallest_singular_value(q, target));
        let mut nearest = f64::INFINITY;
        for solution in solutions {
            let joints = solution.q.get(..q.len()).unwrap_or_default();
            self.solution(joints, target, wheres, smallest, report)?;
            nearest = nearest.min(travel(self.model, q, joints));
        }
        let Some(inverse) = &mut report.inverse else {
            return Ok(());
        };
        inverse.count(solutions.len());
        if !allowed {
            return Ok(());
        }
        let full = answer.as_ref().is_ok_and(|solutions| solutions.dropped() > 0);
        let found = original(nearest, smallest, inverse);
        inverse.overfull |= full && found.is_err();
        found.map_err(|failure| {
            if full {
                format!("there are more than {MAX_SOLUTIONS} solutions, as many as are kept: {failure}")
            } else {
                failure
            }
        })?;
        inverse.arm_angles += usize::from(self.arm_angle(q, target, inverse.arm_angles, smallest)?);
        Ok(())
    }

    /// One returned solution: target, constraints and `where`.
    fn solution(
        &self,
        q: &[f64],
        target: &Target<f64>,
        wheres: &Wheres<'_>,
        smallest: impl Fn() -> f64,
        report: &mut FunctionReport,
    ) -> Result<(), String> {
        let (position, rotation) = target.errors(&reference::tool(self.model, q));
        report.errors(position, rotation);
        let allowed = |residual: f64| Tolerance { position: residual * self.reach, rotation: residual };
        let hits = allowed(RESIDUAL).holds(position, rotation)
            || (allowed(RESIDUAL_SINGULAR).holds(position, rotation) && smallest() < SINGULAR);
        if !hits {
            return Err(format!(
                "the solution {q:?} misses its target by {position:.3e} m and {rotation:.3e} rad"
            ));
        }
        let excess = self.constraints.excess(q);
        if excess.is_nan() || excess > RESIDUAL_SINGULAR {
            return Err(format!("the solution {q:?} breaks a constraint by {excess:.3e}"));
        }
        if wheres.clearly_refuse(q) {
            return Err(format!("the solution {q:?} is not one that `where` keeps"));
        }
        Ok(())
    }

    fn kind(&self) -> model::Target {
        let problem = self.problem.and_then(|index| self.model.problems.get(index));
        problem.map_or(model::Target::Pose, |problem| problem.target)
    }

    /// The middle one of the smallest singular values at some of these poses.
    fn stiffness(&self, poses: &[Vec<f64>]) -> Option<f64> {
        let some = poses.iter().enumerate().step_by(1 + poses.len() / ASKED);
        let smallest = some.filter_map(|(number, q)| {
            let target = target_of(self.kind(), &reference::tool(self.model, q), number, self.reach)?;
            Some(self.smallest_singular_value(q, &target))
        });
        let mut smallest: Vec<f64> = smallest.collect();
        smallest.sort_by(f64::total_cmp);
        smallest.get(smallest.len() / 2).copied()
    }

    /// The smallest singular value of how the prescribed numbers change with the unknowns (m/rad, 1, ...), by central
    /// differences of the product of the rows.
    pub(super) fn smallest_singular_value(&self, q: &[f64], target: &Target<f64>) -> f64 {
        let unknowns = self.constraints.independent.iter().filter(|joint| !self.free.contains(joint));
        let column = |joint: &usize| {
            let direction = self.constraints.direction(*joint, q.len());
            let at = |step: f64| {
                let moved: Vec<f64> = q.iter().zip(&direction).map(|(q, rate)| q + step * rate).collect();
                prescribed(target, &reference::tool(self.model, &moved))
            };
            let pairs = at(DIFFERENCE).into_iter().zip(at(-DIFFERENCE));
            pairs.map(|(after, before)| (after - before) / (2.0 * DIFFERENCE)).collect()
        };
        singular_values::smallest(unknowns.map(column).collect())
    }
}

/// The greatest difference of two joint vectors (rad or m), whole turns aside.
pub(super) fn travel(model: &Model, left: &[f64], right: &[f64]) -> f64 {
    let mut difference: Vec<f64> = left.iter().zip(right).map(|(left, right)| left - right).collect();
    for winding in &model.windings {
        let Some(own) = difference.get_mut(winding.joint) else {
            continue;
        };
        let turns = (*own / winding.turn).round();
        *own -= turns * winding.turn;
        for (joint, turn) in &winding.carries {
            if let Some(carried) = difference.get_mut(*joint) {
                *carried -= turns * turn;
            }
        }
    }
    difference.into_iter().fold(0.0, |greatest, difference| f64::max(greatest, difference.abs()))
}

/// Whether the joint vector that a target was made from was found again, `nearest` (rad or m) being the solution
/// nearest to it.
fn original(nearest: f64, smallest: impl Fn() -> f64, report: &mut InverseReport) -> Result<(), String> {
    if nearest <= COMPLETE {
        report.originals += 1;
        report.originals_found += 1;
        return Ok(());
    }
    let smallest = smallest();
    if smallest < SINGULAR {
        report.singular += 1;
        return Ok(());
    }
    report.originals += 1;
    let tolerance = COMPLETE.max(COMPLETE_NEAR_SINGULAR / (smallest * smallest));
    if nearest > tolerance {
        return Err(format!(
            "a branch is missing: the nearest solution is {nearest:.3e} (rad or m) away, {tolerance:.1e} is allowed"
        ));
    }
    report.originals_found += 1;
    Ok(())
}
