//! Ways to solve an inverse problem that has no closed form, or whose closed form does not stand verification.

use super::{Function, FunctionKind, Step, descents as search, general as chain, inverse};
use crate::model::{Model, Target};
use crate::symbolic::{inverse_kinematics::Refusal, redundancy};

/// A function that finds all joints of an inverse problem (an index into `Model::problems`, or the full pose) at once,
/// for what has no closed form or whose closed form does not stand verification.
///
/// # Errors
/// Why there is none.
pub fn general(model: &Model, problem: Option<usize>) -> Result<Function, Refusal> {
    if let Some(index) = problem {
        let entry = model.problems.get(index).ok_or(Refusal::NotByThisMethod)?;
        return chain::function(model, problem, entry).map(|rated| rated.function);
    }
    let excess = model.joints.len().saturating_sub(Target::Pose.rows());
    let choices = if excess == 1 { redundancy::joints(model) } else { Vec::new() };
    let mut choices = choices.into_iter().take(CHOICES).map(|joint| inverse::full_pose(vec![joint]));
    let first = choices.next().unwrap_or_else(|| inverse::full_pose(Vec::new()));
    let rated = choices.fold(chain::function(model, None, &first), |found, other| {
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
///
/// # Errors
/// Why there is none.
pub fn descents(model: &Model, problem: Option<usize>) -> Result<Function, Refusal> {
    if let Some(index) = problem {
        let entry = model.problems.get(index).ok_or(Refusal::NotByThisMethod)?;
        return search::function(model, problem, entry);
    }
    let excess = model.joints.len().saturating_sub(Target::Pose.rows());
    let free = if excess == 1 { redundancy::joints(model).into_iter().take(1).collect() } else { Vec::new() };
    search::function(model, None, &inverse::full_pose(free))
}

/// The function that an inverse problem is tried with next, where this one does not stand verification.
pub fn next(model: &Model, failed: &Function) -> Option<Function> {
    let FunctionKind::Inverse(problem) = failed.kind else { return None };
    match failed.steps.as_slice() {
        [Step::Descents { .. }] => None,
        [Step::General { .. }] => descents(model, problem).ok(),
        _ => general(model, problem).or_else(|_| descents(model, problem)).ok(),
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
