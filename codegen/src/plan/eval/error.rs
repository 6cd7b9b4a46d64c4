//! What a plan must not be.

use crate::plan::FunctionKind;
use std::fmt;

/// Why a plan cannot be interpreted. A plan that the compiler made is never refused; hand-made ones may be.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlanError {
    /// The plan lacks a function that every arm has.
    Missing {
        /// Which function.
        kind: FunctionKind,
    },
    /// The robot has more joints than [`dh_core::MAX_JOINTS`].
    Joints {
        /// How many it has.
        joints: usize,
    },
    /// An inverse function for a problem that the model does not have.
    Problem {
        /// Index into `Model::problems`.
        index: usize,
    },
    /// A function with too few or too many inputs.
    Inputs {
        /// What its kind asks for.
        expected: usize,
        /// What it has.
        got: usize,
    },
    /// A function with too few or too many outputs.
    Outputs {
        /// What its kind asks for.
        expected: usize,
        /// What it has.
        got: usize,
    },
    /// A candidate with too few or too many joint variables.
    Candidate {
        /// Joints of the robot.
        expected: usize,
        /// Joint variables of the candidate.
        got: usize,
    },
    /// A value that the function does not name.
    Value {
        /// Index into `Function::values`.
        index: usize,
    },
    /// A value that is read where it is not defined.
    Undefined {
        /// Its name.
        value: String,
    },
    /// A constant that the plan does not have.
    Constant {
        /// Index into `Plan::constants`.
        index: usize,
    },
    /// A stage that the function does not have, or one nested too deeply.
    Stage {
        /// Index into `Function::stages`.
        index: usize,
    },
    /// A forward function that solves an equation or accepts a candidate.
    Solving,
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlanError::Missing { kind } => write!(f, "the plan has no function {kind:?}"),
            PlanError::Joints { joints } => {
                write!(f, "the robot has {joints} joints, at most {} can be computed", dh_core::MAX_JOINTS)
            }
            PlanError::Problem { index } => write!(f, "the model has no inverse problem {index}"),
            PlanError::Inputs { expected, got } => {
                write!(f, "the function takes {expected} inputs, its plan {got}")
            }
            PlanError::Outputs { expected, got } => {
                write!(f, "the function has {expected} outputs, its plan {got}")
            }
            PlanError::Candidate { expected, got } => {
                write!(f, "a candidate of {got} joint variables for a robot of {expected} joints")
            }
            PlanError::Value { index } => write!(f, "the function has no value {index}"),
            PlanError::Undefined { value } => {
                write!(f, "the value `{value}` is read where it is not defined")
            }
            PlanError::Constant { index } => write!(f, "the plan has no constant {index}"),
            PlanError::Stage { index } => {
                write!(f, "stage {index} is not listed or nested too deeply")
            }
            PlanError::Solving => write!(f, "a forward function solves equations"),
        }
    }
}

impl std::error::Error for PlanError {}
