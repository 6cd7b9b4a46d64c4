//! Plans of the inverse functions: one nested step an unknown.

use super::schedule::{Constants, Scheduler};
use super::{Equation, Function, FunctionKind, Measure, Scalar, Stage, Step};
use crate::model::{JointKind, Model, Problem, Target};
use crate::symbolic::expression::Expr;
use crate::symbolic::inverse_kinematics::{self, Derivation, Refusal, StageEquation};
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
    let pose = (model.joints.len() <= Target::Pose.rows()).then(|| (None, full_pose()));
    let entries = model.problems.iter().enumerate().map(|(index, problem)| (Some(index), problem.clone()));
    for (index, problem) in pose.into_iter().chain(entries) {
        let same = derived.iter().position(|(other, _)| {
            let forms = |p: &Problem| -> Vec<_> {
                p.constraints.iter().map(|c| (c.terms.clone(), c.constant)).collect()
            };
            other.target == problem.target && other.free == problem.free && forms(other) == forms(&problem)
        });
        let at = same.unwrap_or_else(|| {
            let derivation = inverse_kinematics::derive(model, &problem);
            derived.push((problem, derivation));
            derived.len() - 1
        });
        match derived.get(at) {
            Some((problem, Ok(derivation))) => {
                let polish = problem.target == Target::Pose
                    && problem.constraints.is_empty()
                    && index
                        .and_then(|index| model.problems.get(index))
                        .is_none_or(|own| own.filters.is_empty());
                functions.push(function(index, derivation, polish, constants));
            }
            Some((_, Err(refusal))) => {
                unsolved.push(Unsolved { problem: index, refusal: refusal.clone() });
            }
            None => {}
        }
    }
    (functions, unsolved)
}

/// The full pose as a problem of the table that prescribes it and constrains nothing.
fn full_pose() -> Problem {
    Problem {
        name: FULL_POSE.to_owned(),
        target: Target::Pose,
        constraints: Vec::new(),
        filters: Vec::new(),
        free: Vec::new(),
        span: 0..0,
        line: 0,
    }
}

fn function(
    problem: Option<usize>,
    derivation: &Derivation,
    polish: bool,
    constants: &mut Constants,
) -> Function {
    let arena = &derivation.arena;
    let inputs: Vec<String> = derivation
        .inputs
        .iter()
        .filter_map(|input| match arena.node(*input) {
            crate::symbolic::expression::Node::Leaf(index) => {
                arena.leaf_at(index).map(|(name, _)| name.to_string())
            }
            _ => None,
        })
        .collect();
    let coefficients = derivation.stages.iter().flat_map(|stage| stage.equation.coefficients());
    let computed: Vec<Expr> = coefficients.chain(derivation.tool.iter().copied()).collect();
    let mut scheduler = Scheduler::new(arena, constants, &inputs, &computed);
    for (index, input) in derivation.inputs.iter().enumerate() {
        scheduler.bind(*input, super::ValueId(index));
    }
    let stages = derivation.stages.iter().map(stage).collect();
    let steps = nested(&mut scheduler, derivation, polish, 0);
    Function {
        kind: FunctionKind::Inverse(problem),
        values: scheduler.values,
        inputs: inputs.len(),
        steps,
        outputs: Vec::new(),
        counts: scheduler.counts,
        stages,
    }
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
    let sin_cos = scheduler.sin_cos_of_variable(index);
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
