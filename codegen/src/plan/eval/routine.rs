//! Lowering: a function of a plan, checked once, as instructions over numbered registers.
//!
//! Registers are the function's values, then the numbers it uses, then temporaries. After the checks here no
//! register number can be out of range and no value is read before it is defined.

use super::error::PlanError;
use super::lowering::Lowering;
use crate::model::{JointKind, Model, Target};
use crate::plan::{
    FollowingChain, Function, FunctionKind, GeneralChain, Measure, Nearly, Plan, Stage, target_inputs,
};
use dh_core::{Float, MAX_JOINTS};

/// Number of a register.
pub(super) type Register = usize;

/// One operation on registers. Operands are read before the result is written.
#[derive(Debug, Clone)]
pub(super) enum Instruction {
    Copy {
        to: Register,
        from: Register,
    },
    Negate {
        to: Register,
        from: Register,
    },
    Add {
        to: Register,
        left: Register,
        right: Register,
    },
    Subtract {
        to: Register,
        left: Register,
        right: Register,
    },
    Multiply {
        to: Register,
        left: Register,
        right: Register,
    },
    Divide {
        to: Register,
        left: Register,
        right: Register,
    },
    SinCos {
        sin: Register,
        cos: Register,
        angle: Register,
    },
    /// A named value is complete; for traces only.
    Named(Register),
    Solve(Box<Solve>),
    AtOnce(Box<AtOnce>),
    Near(Box<Near>),
    /// A candidate: the registers of q, and of the tool frame where there are any.
    Accept {
        q: Vec<Register>,
        tool: Vec<Register>,
        polish: bool,
    },
}

/// For every root of an equation: the instructions of `body`.
#[derive(Debug, Clone)]
pub(super) struct Solve {
    pub(super) stage: usize,
    pub(super) root: Register,
    /// Whether the root is an angle, and where its sine and cosine go.
    pub(super) angle: bool,
    pub(super) sin_cos: Option<[Register; 2]>,
    pub(super) equation: Kernel,
    pub(super) body: Vec<Instruction>,
}

/// For every solution of all unknowns: the instructions of `body`.
#[derive(Debug, Clone)]
pub(super) struct AtOnce {
    pub(super) stage: usize,
    pub(super) chain: Chain,
    pub(super) given: Vec<Register>,
    pub(super) roots: Vec<Register>,
    pub(super) body: Vec<Instruction>,
}

/// What is solved for all unknowns at once.
#[derive(Debug, Clone)]
pub(super) enum Chain {
    General(GeneralChain),
    Following(FollowingChain),
}

/// The closed form of the arm that a nearly special one was meant to be, and what is done where it isn't sure.
#[derive(Debug, Clone)]
pub(super) struct Near {
    pub(super) nearly: Box<Nearly>,
    pub(super) body: Vec<Instruction>,
    pub(super) otherwise: Vec<Instruction>,
}

/// Which numeric kernel solves an equation, with the registers of its coefficients.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kernel {
    Trig([Register; 3]),
    TrigUnit([Register; 3], [Register; 2]),
    TrigPair([Register; 3], [Register; 3]),
    TrigEither([Register; 3], [Register; 3]),
    Linear([Register; 2]),
    Quadratic([Register; 3]),
    Quartic([[Register; 3]; 2], Register),
    QuarticUnit([[Register; 3]; 2], Register, [[Register; 3]; 2], [Register; 3]),
}

/// A checked function in the scalar type `S`.
#[derive(Debug, Clone)]
pub(super) struct Routine<S> {
    /// How many of the first registers are inputs.
    pub(super) inputs: usize,
    /// The registers at the start: numbers in place, the rest zero.
    pub(super) start: Vec<S>,
    pub(super) code: Vec<Instruction>,
    pub(super) outputs: Vec<Register>,
    pub(super) stages: Vec<dh_core::Step>,
    /// See [`Function::motions`].
    pub(super) motions: Vec<(dh_core::Step, [S; MAX_JOINTS])>,
}

impl<S: Float> Routine<S> {
    /// Checks and lowers one function of a plan.
    pub(super) fn lower(model: &Model, plan: &Plan, function: &Function) -> Result<Self, PlanError> {
        let shape = Shape::of(model, &function.kind, &function.free)?;
        shape.check(function)?;
        let mut lowering = Lowering {
            plan,
            function,
            joints: model.joints.len(),
            start: vec![S::ZERO; function.values.len()],
            defined: (0..function.values.len()).map(|value| value < function.inputs).collect(),
        };
        let mut code = lowering.steps(&function.steps, 0)?;
        let outputs = function.outputs.iter().map(|output| lowering.scalar(output, &mut code));
        let outputs = outputs.collect::<Result<_, _>>()?;
        let stages = stages(model, function)?;
        let motions = stages.iter().zip(&function.motions).map(|(step, motion)| {
            let mut padded = [S::ZERO; MAX_JOINTS];
            padded.iter_mut().zip(motion).for_each(|(to, from)| *to = S::from_f64(*from));
            (*step, padded)
        });
        let motions = motions.collect();
        Ok(Routine { inputs: function.inputs, start: lowering.start, code, outputs, stages, motions })
    }
}

/// How many inputs and outputs a kind of function has.
struct Shape {
    inputs: usize,
    outputs: usize,
}

impl Shape {
    fn of(model: &Model, kind: &FunctionKind, free: &[usize]) -> Result<Self, PlanError> {
        let joints = model.joints.len();
        let forward = |outputs| Shape { inputs: joints, outputs };
        Ok(match kind {
            FunctionKind::Fk | FunctionKind::FkFlange => forward(12),
            FunctionKind::Jacobian => forward(6 * joints),
            FunctionKind::FkJacobian => forward(12 + 6 * joints),
            FunctionKind::Frames => forward(12 * (model.rows.len() + 1)),
            FunctionKind::Inverse(problem) => {
                let target = match problem {
                    None => Target::Pose,
                    Some(index) => {
                        model.problems.get(*index).ok_or(PlanError::Problem { index: *index })?.target
                    }
                };
                Shape { inputs: target_inputs(target).len() + free.len(), outputs: 0 }
            }
        })
    }

    fn check(&self, function: &Function) -> Result<(), PlanError> {
        if function.inputs != self.inputs || function.inputs > function.values.len() {
            return Err(PlanError::Inputs { expected: self.inputs, got: function.inputs });
        }
        if function.outputs.len() != self.outputs {
            return Err(PlanError::Outputs { expected: self.outputs, got: function.outputs.len() });
        }
        Ok(())
    }
}

/// The stages in the form in which the numeric kernels take them.
fn stages(model: &Model, function: &Function) -> Result<Vec<dh_core::Step>, PlanError> {
    let step = |(index, stage): (usize, &Stage)| {
        let measure = match stage.measure {
            Measure::Ratio => dh_core::Measure::Ratio,
            Measure::Length => dh_core::Measure::Length,
            Measure::Area => dh_core::Measure::Area,
            Measure::Power(power) => dh_core::Measure::Power(power),
        };
        let first = model.rows.get(stage.rows.trailing_zeros() as usize);
        let prismatic =
            first.is_some_and(|row| row.kind == JointKind::Prismatic) && !function.searches(index);
        let index = u8::try_from(index).map_err(|_| PlanError::Stage { index })?;
        let step = dh_core::Step::new(index, stage.rows, prismatic, measure);
        let step = if function.searches(usize::from(index)) { step.at_once() } else { step };
        Ok(if function.is_unsigned(usize::from(index)) { step.unsigned() } else { step })
    };
    function.stages.iter().enumerate().map(step).collect()
}
