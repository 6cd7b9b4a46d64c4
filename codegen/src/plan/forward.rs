//! Plans of the functions from joint variables to frames and Jacobians.

use super::schedule::{Constants, Scheduler};
use super::{Function, FunctionKind, ValueId};
use crate::model::Model;
use crate::symbolic::{self, Equations};

/// Forward kinematics, Jacobian and frames, in the order in which they are printed.
pub(super) fn functions(model: &Model, constants: &mut Constants) -> Vec<Function> {
    let all = [
        (FunctionKind::Fk, symbolic::pose(model, true)),
        (FunctionKind::FkFlange, symbolic::pose(model, false)),
        (FunctionKind::Jacobian, symbolic::jacobian(model)),
        (FunctionKind::FkJacobian, symbolic::pose_and_jacobian(model)),
        (FunctionKind::Frames, symbolic::frames(model)),
    ];
    all.into_iter()
        .map(|(kind, equations)| function(kind, &equations, model.joints.len(), constants))
        .collect()
}

fn function(kind: FunctionKind, equations: &Equations, joints: usize, constants: &mut Constants) -> Function {
    let inputs: Vec<String> = (1..=joints).map(|number| format!("q{number}")).collect();
    let mut scheduler = Scheduler::new(&equations.arena, constants, &inputs, &equations.outputs);
    scheduler.variables = (0..joints).map(ValueId).collect();
    let outputs = scheduler.scalars(&equations.outputs);
    Function {
        kind,
        values: scheduler.values,
        inputs: joints,
        free: Vec::new(),
        steps: scheduler.steps,
        outputs,
        counts: scheduler.counts,
        stages: Vec::new(),
        unknowns: Vec::new(),
        motions: Vec::new(),
        constraints: Vec::new(),
        branch: Vec::new(),
        agreement: None,
    }
}
