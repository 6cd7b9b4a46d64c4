//! Plans of the inverse functions: one nested step an unknown.

use super::schedule::{Constants, Scheduler};
use super::{Equation, Function, FunctionKind, Measure, Scalar, Stage, Step};
use crate::model::{JointKind, Model, Problem};
use crate::symbolic::expression::Expr;
use crate::symbolic::inverse_kinematics::{self, Derivation, Refusal, StageEquation};

/// A problem that has no function, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unsolved {
    /// Index into `Model::problems`.
    pub problem: usize,
    /// Why.
    pub refusal: Refusal,
}

/// The functions of all problems that have a closed form.
///
/// Problems that differ only in their `where` share one derivation.
pub(super) fn functions(model: &Model, constants: &mut Constants) -> (Vec<Function>, Vec<Unsolved>) {
    let (mut functions, mut unsolved) = (Vec::new(), Vec::new());
    let mut derived: Vec<(usize, Result<Derivation, Refusal>)> = Vec::new();
    for (index, problem) in model.problems.iter().enumerate() {
        let same = derived.iter().position(|(other, _)| {
            model.problems.get(*other).is_some_and(|other| {
                let forms = |p: &Problem| -> Vec<_> {
                    p.constraints.iter().map(|c| (c.terms.clone(), c.constant)).collect()
                };
                other.target == problem.target && other.free == problem.free && forms(other) == forms(problem)
            })
        });
        let at = same.unwrap_or_else(|| {
            derived.push((index, inverse_kinematics::derive(model, problem)));
            derived.len() - 1
        });
        match derived.get(at) {
            Some((_, Ok(derivation))) => functions.push(function(index, derivation, constants)),
            Some((_, Err(refusal))) => {
                unsolved.push(Unsolved { problem: index, refusal: refusal.clone() });
            }
            None => {}
        }
    }
    (functions, unsolved)
}

fn function(problem: usize, derivation: &Derivation, constants: &mut Constants) -> Function {
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
    let coefficients: Vec<Expr> =
        derivation.stages.iter().flat_map(|stage| stage.equation.coefficients()).collect();
    let target = inputs.len();
    inputs.extend(derivation.given.iter().cloned());
    let mut scheduler = Scheduler::new(arena, constants, &inputs, &coefficients);
    for (index, input) in derivation.inputs.iter().enumerate() {
        scheduler.bind(*input, super::ValueId(index));
    }
    scheduler.variables = (target..inputs.len()).map(super::ValueId).collect();
    // What depends on the given joints alone is the same in every branch.
    scheduler.leaves_of(derivation.given.len(), &coefficients);
    let mut steps = std::mem::take(&mut scheduler.steps);
    let stages = derivation.stages.iter().map(stage).collect();
    steps.extend(nested(&mut scheduler, derivation, 0));
    Function {
        kind: FunctionKind::Inverse(Some(problem)),
        values: scheduler.values,
        inputs: inputs.len(),
        steps,
        outputs: Vec::new(),
        counts: scheduler.counts,
        stages,
    }
}

/// The steps from a stage on, inside the loop over the roots of the one before.
fn nested(scheduler: &mut Scheduler<'_>, derivation: &Derivation, index: usize) -> Vec<Step> {
    let Some(stage) = derivation.stages.get(index) else {
        let q =
            derivation.joints.iter().map(|joint| scheduler.linear(&joint.terms, joint.constant)).collect();
        return vec![Step::Accept { q }];
    };
    let outer = std::mem::take(&mut scheduler.steps);
    let scalars = scheduler.scalars(&stage.equation.coefficients());
    let mut steps = std::mem::replace(&mut scheduler.steps, outer);
    let root = scheduler.value(&stage.unknown);
    scheduler.variables.push(root);
    if let Some(slide) = stage.slide {
        scheduler.bind(slide, root);
    }
    let body = nested(scheduler, derivation, index + 1);
    if let Some(equation) = equation(&stage.equation, scalars) {
        steps.push(Step::Solve { stage: index, root, equation, body });
    }
    steps
}

fn equation(kind: &StageEquation, scalars: Vec<Scalar>) -> Option<Equation> {
    let mut scalars = scalars.into_iter();
    let mut next = || scalars.next();
    Some(match kind {
        StageEquation::Trig(_) => Equation::Trig { a: next()?, b: next()?, c: next()? },
        StageEquation::TrigPair(..) => {
            Equation::TrigPair { first: [next()?, next()?, next()?], second: [next()?, next()?, next()?] }
        }
        StageEquation::Linear(_) => Equation::Linear { a: next()?, c: next()? },
        StageEquation::Quadratic(_) => Equation::Quadratic { a: next()?, b: next()?, c: next()? },
    })
}

fn stage(stage: &inverse_kinematics::Stage) -> Stage {
    Stage {
        rows: stage.rows.iter().fold(0, |mask, row| mask | 1_u32.checked_shl(*row as u32).unwrap_or(0)),
        unknown: stage.unknown.clone(),
        measure: match (stage.dimension, stage.kind) {
            (0, _) => Measure::Ratio,
            (1, _) => Measure::Length,
            (_, JointKind::Revolute | JointKind::Prismatic) => Measure::Area,
        },
        equation: stage.text.clone(),
        definitions: stage.definitions.clone(),
        origin: stage.origin.clone(),
    }
}
