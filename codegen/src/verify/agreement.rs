//! Whether another method finds the same solutions.

use super::constraints::Constraints;
use super::prescribed::target_of;
use super::where_clause::Wheres;
use super::{Level, inverse, poses, reference};
use crate::model::{self, Model};
use crate::plan::eval::{Given, Program};
use crate::plan::{Agreement, Function, FunctionKind, Plan};
use dh_core::{Target, Winding};

/// How many random poses are solved by both methods.
const POSES: usize = 32;

/// Solutions that are nearer than this (rad or m) are one: less accurate next to singular poses than elsewhere.
const SAME: f64 = 1e-5;

/// Notes for every inverse function how often another one of the same problem, by another method, finds the same
/// solutions at random poses. `other` gives that function, where there is one.
pub(super) fn confirm(model: &Model, plan: &mut Plan, other: impl Fn(&Function) -> Option<Function>) {
    let Some(fk) = plan.functions.iter().find(|function| function.kind == FunctionKind::Fk).cloned() else {
        return;
    };
    let both = plan.functions.iter().find(|function| function.kind == FunctionKind::FkJacobian).cloned();
    let constants = plan.constants.clone();
    let alone = |function: &Function| Plan {
        constants: constants.clone(),
        functions: [Some(fk.clone()), both.clone(), Some(function.clone())].into_iter().flatten().collect(),
    };
    for function in &mut plan.functions {
        let FunctionKind::Inverse(problem) = function.kind else { continue };
        let Some(second) = other(function).filter(|second| second.free == function.free) else { continue };
        let (own, other) = (alone(function), alone(&second));
        if let (Ok(own), Ok(other)) = (Program::new(model, &own), Program::new(model, &other)) {
            let programs = [&own, &other];
            function.agreement = compare(model, problem, &function.free, programs, &second);
        }
    }
}

fn compare(
    model: &Model,
    problem: Option<usize>,
    free: &[usize],
    programs: [&Program<'_>; 2],
    second: &Function,
) -> Option<Agreement> {
    let entry = problem.and_then(|index| model.problems.get(index));
    let constraints = Constraints::of(model, entry);
    let wheres = Wheres::of(model, problem);
    let reach = model.reach();
    let wanted = |q: &[f64]| wheres.clearly_keep(q);
    let poses = poses::poses(model, &constraints, Level::Full, reach, wanted);
    let windings = programs.map(Program::windings);
    let kind = entry.map_or(model::Target::Pose, |problem| problem.target);
    let method = second.stages.first().map_or_else(String::new, |stage| stage.equation.clone());
    let mut agreement = Agreement { method, poses: 0, agreed: 0 };
    let mut applies = false;
    // The first ones are random.
    for (number, q) in poses.iter().take(POSES).enumerate() {
        let Some(target) = target_of(kind, &reference::tool(model, q), number, reach) else { continue };
        let free: Vec<f64> = free.iter().map(|joint| q.get(*joint).copied().unwrap_or(0.0)).collect();
        let [own, other] = [0, 1].map(|index: usize| {
            let (program, windings) = (programs.get(index), windings.get(index));
            program.zip(windings).map_or_else(Vec::new, |(program, windings)| {
                solutions(program, problem, &target, &free, windings, q.len())
            })
        });
        let among = |q: &Vec<f64>, others: &[Vec<f64>]| {
            others.iter().any(|other| inverse::travel(model, q, other) <= SAME)
        };
        agreement.poses += 1;
        applies |= !other.is_empty();
        let same = own.len() == other.len() && own.iter().all(|q| among(q, &other));
        agreement.agreed += usize::from(same && other.iter().all(|q| among(q, &own)));
    }
    // A method that finds nothing anywhere says nothing.
    applies.then_some(agreement)
}

/// Joint values of every solution.
fn solutions(
    program: &Program<'_>,
    problem: Option<usize>,
    target: &Target<f64>,
    free: &[f64],
    windings: &[Winding<'_>],
    joints: usize,
) -> Vec<Vec<f64>> {
    let answer = program.inverse(problem, target, Given { free, seed: None }, windings, |_| ());
    let found = answer.into_iter().flatten();
    found.flatten().map(|solution| solution.q.get(..joints).unwrap_or_default().to_vec()).collect()
}
