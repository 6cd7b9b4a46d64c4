//! Plans of the inverse functions: one nested step an unknown.

use super::schedule::{Constants, Scheduler};
use super::unknowns;
use super::{Equation, Function, FunctionKind, Measure, Scalar, Stage, Step};
use super::{descents, near};
use crate::model::{Model, Problem, Target};
use crate::symbolic::expression::Expr;
use crate::symbolic::inverse_kinematics::{
    self, Closures, Derivation, Linear, OfVector, Refusal, StageEquation,
};
use crate::symbolic::redundancy;
use dh_core::FULL_POSE;

/// A problem that has no function, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unsolved {
    /// Index into `Model::problems`; `None` is the full pose.
    pub problem: Option<usize>,
    /// Why.
    pub refusal: Refusal,
}

/// The functions of the full pose and of all problems of the table. Several of one kind are strategies for the same
/// problem, the best first; verification keeps the first that stands it.
///
/// Problems that differ only in their `where` share one derivation.
pub(super) fn functions(model: &Model, constants: &mut Constants) -> (Vec<Function>, Vec<Unsolved>) {
    let (mut functions, mut unsolved) = (Vec::new(), Vec::new());
    let mut derived: Vec<(Problem, Result<Derivation, Refusal>)> = Vec::new();
    let named = model.problems.iter().any(|problem| problem.name == FULL_POSE);
    let excess = model.joints.len().saturating_sub(Target::Pose.rows());
    if !named && excess == 1 {
        match redundant(model) {
            Ok((problem, derivation)) => {
                functions.push(function(model, None, &problem, &derivation, true, constants));
            }
            Err(refusal) => match near::full_pose(model, constants) {
                Some(function) => functions.push(function),
                None => unsolved.push(Unsolved { problem: None, refusal }),
            },
        }
    }
    let pose = (!named && excess == 0).then(|| (None, full_pose(Vec::new())));
    let entries = model.problems.iter().enumerate().map(|(index, problem)| (Some(index), problem.clone()));
    for (index, problem) in pose.into_iter().chain(entries) {
        let same = derived.iter().position(|(other, _)| {
            let forms = |p: &Problem| -> Vec<_> {
                p.constraints.iter().map(|c| (c.terms.clone(), c.constant)).collect()
            };
            other.target == problem.target && other.free == problem.free && forms(other) == forms(&problem)
        });
        let at = same.unwrap_or_else(|| {
            // Steps might be found for an arm that is regular nowhere: equations that follow from each other are not seen to.
            let derivation = match descents::regular(model, &problem) {
                Err(refusal @ Refusal::Singular { .. }) => Err(refusal),
                _ => inverse_kinematics::derive(model, &problem),
            };
            derived.push((problem.clone(), derivation));
            derived.len() - 1
        });
        match derived.get(at) {
            Some((problem, Ok(derivation))) => {
                let index_of = index.and_then(|index| model.problems.get(index));
                let polish = problem.is_whole_pose() && index_of.is_none_or(Problem::is_whole_pose);
                functions.push(function(model, index, problem, derivation, polish, constants));
            }
            Some((_, Err(refusal))) => {
                let near = match index {
                    Some(index) => near::problem(model, index, &problem, constants),
                    None => near::full_pose(model, constants),
                };
                match near {
                    Some(function) => functions.push(function),
                    None => unsolved.push(Unsolved { problem: index, refusal: refusal.clone() }),
                }
            }
            None => {}
        }
    }
    (functions, unsolved)
}

/// Six revolute joints have no fewer branches than this: a joint that leaves so many is taken without trying others.
const FEW_BRANCHES: usize = 8;

/// The full pose of an arm with one joint too many: with that joint left to the caller which leaves the fewest
/// branches, of equal ones the one that takes the greatest part in the self-motion.
fn redundant(model: &Model) -> Result<(Problem, Derivation), Refusal> {
    least(model, redundancy::joints(model).into_iter().map(|joint| vec![joint]))
}

/// The full pose with those of some joints left to the caller (all of one entry) that leave the fewest branches.
///
/// # Errors
/// Why there is none.
pub(super) fn least(
    model: &Model,
    free: impl IntoIterator<Item = Vec<usize>>,
) -> Result<(Problem, Derivation), Refusal> {
    let mut best: Option<(Problem, Derivation)> = None;
    let mut refused = Refusal::NoClosedForm;
    let mut closures = Closures::of(model);
    for free in free {
        let problem = full_pose(free);
        match inverse_kinematics::derive_with(&mut closures, &problem) {
            Ok(derivation) => {
                let branches = derivation.branches();
                if best.as_ref().is_none_or(|(_, least)| branches < least.branches()) {
                    best = Some((problem, derivation));
                }
                if branches <= FEW_BRANCHES {
                    break;
                }
            }
            Err(refusal) => refused = refusal,
        }
    }
    best.ok_or(refused)
}

/// The full pose as a problem of the table that prescribes it and constrains nothing.
pub(super) fn full_pose(free: Vec<usize>) -> Problem {
    Problem {
        name: FULL_POSE.to_owned(),
        target: Target::Pose,
        constraints: Vec::new(),
        filters: Vec::new(),
        free,
        span: 0..0,
        line: 0,
    }
}

pub(super) fn function(
    model: &Model,
    index: Option<usize>,
    problem: &Problem,
    derivation: &Derivation,
    polish: bool,
    constants: &mut Constants,
) -> Function {
    let arena = &derivation.arena;
    let mut inputs: Vec<String> = derivation
        .inputs
        .iter()
        .filter_map(|input| match arena.node(*input) {
            crate::symbolic::expression::Node::Leaf(index) => {
                arena.leaf_at(index).map(|(name, _)| name.to_string())
            }
            _ => None,
        })
        .collect();
    let target = inputs.len();
    inputs.extend(derivation.given.iter().cloned());
    let coefficients = derivation.stages.iter().flat_map(|stage| stage.equation.coefficients());
    let computed: Vec<Expr> = coefficients.chain(derivation.tool.iter().copied()).collect();
    let mut scheduler = Scheduler::new(arena, constants, &inputs, &computed);
    for (index, input) in derivation.inputs.iter().enumerate() {
        scheduler.bind(*input, super::ValueId(index));
    }
    scheduler.variables = (target..inputs.len()).map(super::ValueId).collect();
    // What depends on the given joints alone is the same in every branch.
    scheduler.leaves_of(derivation.given.len(), &computed);
    let mut steps = std::mem::take(&mut scheduler.steps);
    let stages: Vec<Stage> = derivation.stages.iter().map(stage).collect();
    let branch = super::branch::bits(model, problem.target, &stages, derivation.begins);
    let given = derivation.given.len();
    let unknowns = unknowns::of(&derivation.joints, given, given + stages.len());
    let motions =
        (given..given + stages.len()).map(|variable| motion(&derivation.joints, variable)).collect();
    steps.extend(nested(&mut scheduler, derivation, polish, 0));
    Function {
        kind: FunctionKind::Inverse(index),
        values: scheduler.values,
        inputs: inputs.len(),
        free: problem.free.clone(),
        steps,
        outputs: Vec::new(),
        counts: scheduler.counts,
        stages,
        unknowns,
        motions,
        constraints: super::constraints::of(model, index),
        branch,
        agreement: None,
    }
}

/// What one unit of a variable adds to the joint values.
fn motion(joints: &[Linear], variable: usize) -> Vec<f64> {
    let share = |joint: &Linear| {
        joint.terms.iter().filter(|(of, _)| *of == variable).fold(0.0, |sum, (_, factor)| sum + factor)
    };
    joints.iter().map(share).collect()
}

/// The steps from a stage on, inside the loop over the roots of the one before.
fn nested(scheduler: &mut Scheduler<'_>, derivation: &Derivation, polish: bool, index: usize) -> Vec<Step> {
    let Some(stage) = derivation.stages.get(index) else {
        let q =
            derivation.joints.iter().map(|joint| scheduler.linear(&joint.terms, joint.constant)).collect();
        let outer = std::mem::take(&mut scheduler.steps);
        let tool = scheduler.scalars(&derivation.tool);
        let mut steps = std::mem::replace(&mut scheduler.steps, outer);
        steps.push(Step::Accept { q, tool, polish });
        return steps;
    };
    let outer = std::mem::take(&mut scheduler.steps);
    let scalars = scheduler.scalars(&stage.equation.coefficients());
    let mut steps = std::mem::replace(&mut scheduler.steps, outer);
    let root = scheduler.value(&stage.unknown);
    scheduler.variables.push(root);
    if let Some(slide) = stage.slide {
        scheduler.bind(slide, root);
    }
    let sin_cos = scheduler.sin_cos_of_variable(derivation.given.len() + index);
    let body = nested(scheduler, derivation, polish, index + 1);
    if let Some(equation) = equation(&stage.equation, scalars) {
        steps.push(Step::Solve { stage: index, root, sin_cos, equation, body });
    }
    steps
}

fn equation(kind: &StageEquation, scalars: Vec<Scalar>) -> Option<Equation> {
    let mut scalars = scalars.into_iter();
    let mut next = || scalars.next();
    Some(match kind {
        StageEquation::Trig(_) => Equation::Trig { a: next()?, b: next()?, c: next()? },
        StageEquation::TrigUnit(..) => {
            Equation::TrigUnit { row: [next()?, next()?, next()?], others: [next()?, next()?] }
        }
        StageEquation::TrigPair(..) => {
            Equation::TrigPair { first: [next()?, next()?, next()?], second: [next()?, next()?, next()?] }
        }
        StageEquation::TrigEither(..) => {
            Equation::TrigEither { first: [next()?, next()?, next()?], second: [next()?, next()?, next()?] }
        }
        StageEquation::Linear(_) => Equation::Linear { a: next()?, c: next()? },
        StageEquation::Quadratic(_) => Equation::Quadratic { a: next()?, b: next()?, c: next()? },
        StageEquation::Quartic(_, _, vector) => {
            let mut form = || Some([next()?, next()?, next()?]);
            let (forms, right) = ([form()?, form()?], next()?);
            let vector = match vector {
                Some(_) => {
                    let mut form = || Some([next()?, next()?, next()?]);
                    Some(Box::new(OfVector { others: [form()?, form()?], length: form()? }))
                }
                None => None,
            };
            Equation::Quartic { forms, right, vector }
        }
    })
}

fn stage(stage: &inverse_kinematics::Stage) -> Stage {
    Stage {
        rows: stage.rows.iter().fold(0, |mask, row| mask | 1_u32.checked_shl(*row as u32).unwrap_or(0)),
        unknown: stage.unknown.clone(),
        measure: match stage.dimension {
            0 => Measure::Ratio,
            1 => Measure::Length,
            2 => Measure::Area,
            power => Measure::Power(power),
        },
        equation: stage.text.clone(),
        definitions: stage.definitions.clone(),
        origin: stage.origin.clone(),
        plus: stage.plus.clone(),
    }
}
