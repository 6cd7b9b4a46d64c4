//! Ways to solve an inverse problem that has no closed form, or whose closed form does not stand verification.

use super::{Function, FunctionKind, Step, descents as search, general as chain, inverse};
use crate::model::{Model, Problem, Target};
use crate::symbolic::{inverse_kinematics::Refusal, redundancy};

/// A function that solves an inverse problem (an index into `Model::problems`, or the full pose) as a chain of six joints.
///
/// # Errors
/// Why there is none.
pub fn general(model: &Model, problem: Option<usize>) -> Result<Function, Refusal> {
    if let Some(index) = problem {
        let entry = model.problems.get(index).ok_or(Refusal::NotByThisMethod)?;
        return chain::function(model, problem, entry).map(|rated| rated.function);
    }
    let (first, others) = full_poses(model);
    let others = others.take(CHOICES.saturating_sub(1));
    let rated = others.fold(chain::function(model, None, &first), |found, other| {
        match (found, chain::function(model, None, &other)) {
            (Ok(found), Ok(other)) if found.badness <= other.badness => Ok(found),
            (found, Err(_)) => found,
            (_, other) => other,
        }
    });
    rated.map(|rated| rated.function)
}

/// A function that searches for all unknowns of an inverse problem (an index into `Model::problems`, or the full pose),
/// for what nothing else solves.
fn descents(model: &Model, problem: Option<usize>) -> Result<Function, Refusal> {
    if let Some(index) = problem {
        let entry = model.problems.get(index).ok_or(Refusal::NotByThisMethod)?;
        return search::function(model, problem, entry);
    }
    search::function(model, None, &full_poses(model).0)
}

/// The full pose; of an arm with one joint too many, with each joint in turn left to the caller, the one first that takes the
/// greatest part in the self-motion.
fn full_poses(model: &Model) -> (Problem, impl Iterator<Item = Problem>) {
    let excess = model.joints.len().saturating_sub(Target::Pose.rows());
    let joints = if excess == 1 { redundancy::joints(model) } else { Vec::new() };
    let mut choices = joints.into_iter().map(|joint| inverse::full_pose(vec![joint]));
    (choices.next().unwrap_or_else(|| inverse::full_pose(Vec::new())), choices)
}

/// A function that finds all unknowns of an inverse problem (an index into `Model::problems`, or the full pose) at once: a
/// chain of six joints, or else a search.
///
/// # Errors
/// Why there is none.
pub fn at_once(model: &Model, problem: Option<usize>) -> Result<Function, Refusal> {
    general(model, problem).or_else(|_| descents(model, problem))
}

/// The function that an inverse problem is tried with next, where this one does not stand verification.
pub fn next(model: &Model, failed: &Function) -> Option<Function> {
    let FunctionKind::Inverse(problem) = failed.kind else { return None };
    match failed.steps.as_slice() {
        [Step::Descents { .. }] => None,
        [Step::General { .. }] => descents(model, problem).ok(),
        _ => at_once(model, problem).ok(),
    }
}

/// A function of the same problem by another method: for a closed form, all joints at once; for those found at once,
/// another joint first.
pub fn second(model: &Model, function: &Function) -> Option<Function> {
    let FunctionKind::Inverse(problem) = function.kind else { return None };
    match function.steps.as_slice() {
        [Step::General { .. }] => return chain::rotated(function),
        // Newton's method on the product of matrices shares less with it.
        [Step::Descents { .. }] => return None,
        _ => {}
    }
    let own = problem.and_then(|index| model.problems.get(index)).cloned();
    let entry = own.unwrap_or_else(|| inverse::full_pose(function.free.clone()));
    chain::function(model, problem, &entry).ok().map(|rated| rated.function)
}

/// How many joints of an arm with one too many are tried as the one that is given: those behind them hardly take part in
/// the self-motion.
const CHOICES: usize = 4;
