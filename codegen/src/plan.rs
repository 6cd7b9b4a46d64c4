//! Stage 4: equations -> functions as ordered, named scalar steps.
//!
//! A plan holds no tokens and no language, and nothing in it assumes f64. Printers (`emit`) and the interpreter
//! (`plan::eval`) walk it and decide nothing.

mod branch;
mod constraints;
mod descents;
mod dimension;
/// The interpreter.
pub mod eval;
#[cfg(test)]
pub(crate) mod fixtures;
mod forward;
mod general;
mod inverse;
mod near;
mod schedule;
mod unknowns;
mod ways;

use crate::symbolic::inverse_kinematics::OfVector;
pub use descents::FollowingChain;
pub use general::GeneralChain;
pub use inverse::Unsolved;
pub use near::Nearly;
pub use ways::{at_once, general, next, second};

/// Every function that the robot has, and the problems that have none.
pub fn build(model: &crate::model::Model) -> (Plan, Vec<Unsolved>) {
    let mut constants = schedule::Constants::of(model);
    let mut functions = forward::functions(model, &mut constants);
    let (inverse, unsolved) = inverse::functions(model, &mut constants);
    functions.extend(inverse);
    (Plan { constants: constants.into_list(), functions }, unsolved)
}

/// All functions of one robot.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Named numbers of the table (`D1`, `A2`, ...), in the order of the rows.
    pub constants: Vec<Constant>,
    /// In the order in which they are printed.
    pub functions: Vec<Function>,
}

/// A named number of the table or one folded from them.
#[derive(Debug, Clone)]
pub struct Constant {
    /// Lower-case name as the field writes it: `d1`, `a2`, `ca3`.
    pub name: String,
    /// SI.
    pub value: f64,
    /// Power of the metre: 1 for a length, 0 for a ratio.
    pub dimension: u8,
    /// What it is and where it stands: "link length of joint 2, table line 31".
    pub note: String,
}

/// Index into [`Plan::constants`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ConstantId(pub usize);

/// Index into [`Function::values`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ValueId(pub usize);

/// What a function computes; decides its signature and what its outputs mean.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FunctionKind {
    /// q -> pose of the tool frame in the base frame. 12 outputs: the rows of `[R | p]`.
    Fk,
    /// The same without `[tool]`.
    FkFlange,
    /// q -> 6 x N geometric Jacobian. 6 N outputs, column after column: vx vy vz wx wy wz.
    Jacobian,
    /// q -> pose and Jacobian. 12 + 6 N outputs.
    FkJacobian,
    /// q -> the frame of every row, base first. 12 (rows + 1) outputs.
    Frames,
    /// Target -> joint variables, by nested solving; no outputs, [`Step::Accept`] instead. Index into
    /// `Model::problems`, or `None` for the full pose.
    Inverse(Option<usize>),
}

/// One function: straight-line steps, or nested ones for inverse problems.
#[derive(Debug, Clone)]
pub struct Function {
    /// What it computes.
    pub kind: FunctionKind,
    /// Names of all values, inputs first. Forward functions: `q1` ... `qN`. Inverse: the target's numbers, see
    /// [`target_inputs`].
    pub values: Vec<String>,
    /// How many of `values` are inputs.
    pub inputs: usize,
    /// Joints that the caller gives (indices of q), behind the target's numbers among the inputs.
    pub free: Vec<usize>,
    /// What is computed, in order.
    pub steps: Vec<Step>,
    /// Results of forward functions.
    pub outputs: Vec<Scalar>,
    /// Operations besides constants.
    pub counts: Counts,
    /// Inverse problems: the solving steps in order, for docs and errors.
    pub stages: Vec<Stage>,
    /// Inverse problems: every unknown, in the order in which they are found, as a form in the joint values; `None` for
    /// one that no joint of the arm tells.
    pub unknowns: Vec<Option<Form>>,
    /// Inverse problems that are solved in closed form: what one unit (rad, m) of the unknown of each stage adds to the joint
    /// values.
    pub motions: Vec<Vec<f64>>,
    /// Inverse problems: the equations between joint values that are prescribed besides the target.
    pub constraints: Vec<dh_core::ConstraintTerm>,
    /// Inverse problems: the steps whose roots have signs, with a word for each.
    pub branch: Vec<dh_core::BranchBit>,
    /// Inverse problems: how often another method found the same solutions, where that was tried.
    pub agreement: Option<Agreement>,
}

/// What became of a comparison with another method.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Agreement {
    /// Its equation: "a trigonometric polynomial of degree 8 in theta4 is 0".
    pub method: String,
    /// At how many random poses both were asked.
    pub poses: usize,
    /// At how many of them they found the same solutions.
    pub agreed: usize,
    /// How many solutions the other one found that meet their target at regular poses, and are not among those of the function.
    pub missing: usize,
}

/// Sum of coefficient * joint value, and a constant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Form {
    /// (index of q, coefficient).
    pub terms: Vec<(usize, f64)>,
    /// rad or m
    pub constant: f64,
}

impl Function {
    /// Whether a stage has roots to choose from whose sign is no part of a solution's branch.
    pub fn is_unsigned(&self, stage: usize) -> bool {
        let choice = self.stages.get(stage).is_some_and(|stage| stage.plus.is_some());
        (choice || self.searches(stage)) && !self.branch.iter().any(|bit| usize::from(bit.step) == stage)
    }

    /// The sign of a stage's root in words: "elbow + where a2 s3 > 0, else -".
    pub fn sign(&self, stage: usize) -> Option<String> {
        let bit = self.branch.iter().find(|bit| usize::from(bit.step) == stage)?;
        Some(match &self.stages.get(stage)?.plus {
            Some(plus) => format!("{bit} + where {plus}, else -"),
            None => format!("{bit} + or -: that of the Jacobian, which several solutions may share"),
        })
    }

    /// Whether a stage finds all joints at once.
    pub fn searches(&self, stage: usize) -> bool {
        let steps = match self.steps.as_slice() {
            [Step::Near { otherwise, .. }] => otherwise,
            steps => steps,
        };
        let all = |step: &Step| match step {
            Step::General { stage: at, .. } | Step::Descents { stage: at, .. } => *at == stage,
            _ => false,
        };
        steps.iter().any(all)
    }

    /// Whether its solutions are all searched for at once, without a closed form.
    pub fn is_searched(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Step::General { .. } | Step::Descents { .. }))
    }
}

/// Names of the numbers that a target is made of, in the order in which they are inputs.
pub fn target_inputs(target: crate::model::Target) -> &'static [&'static str] {
    target.input_names()
}

/// The runtime's word for what a problem prescribes.
pub fn target_kind(target: crate::model::Target) -> dh_core::TargetKind {
    use crate::model::Target;
    use dh_core::TargetKind;
    match target {
        Target::Pose => TargetKind::Pose,
        Target::Position => TargetKind::Position,
        Target::PositionDirection => TargetKind::PositionDirection,
        Target::PositionYaw => TargetKind::PositionYaw,
        Target::Rotation => TargetKind::Rotation,
        Target::Direction => TargetKind::Direction,
        Target::Ray => TargetKind::Ray,
        Target::Lookat => TargetKind::Lookat,
        Target::Xy => TargetKind::Xy,
        Target::XyYaw => TargetKind::XyYaw,
    }
}

/// Operation counts of a function, of what is left after constants are folded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Multiplications (and divisions).
    pub mul: usize,
    /// Additions and subtractions.
    pub add: usize,
    /// Sine-cosine pairs.
    pub sincos: usize,
    /// Additions in the arguments of sines and cosines.
    pub angle_add: usize,
}

/// A step of a function.
#[derive(Debug, Clone)]
pub enum Step {
    /// `name = value`.
    Let {
        /// What is defined.
        name: ValueId,
        /// Its definition.
        value: Scalar,
    },
    /// `(sin, cos) = sincos(angle)`.
    SinCos {
        /// Sine.
        sin: ValueId,
        /// Cosine.
        cos: ValueId,
        /// Argument (rad).
        angle: Scalar,
    },
    /// For every root of an equation: the steps of `body`. The index of the stage is into [`Function::stages`].
    Solve {
        /// Which stage.
        stage: usize,
        /// The unknown, defined inside `body`.
        root: ValueId,
        /// Its sine and cosine, of an angle of which the steps read them.
        sin_cos: Option<[ValueId; 2]>,
        /// The equation.
        equation: Equation,
        /// What follows for each root.
        body: Vec<Step>,
    },
    /// All unknowns at once: for every solution of a chain of six joints, the steps of `body`.
    General {
        /// Which stage.
        stage: usize,
        /// The chain.
        chain: GeneralChain,
        /// Values of the chain's given joints (rad or m).
        given: Vec<Scalar>,
        /// The six others, defined inside `body`.
        roots: Vec<ValueId>,
        /// What follows for each solution.
        body: Vec<Step>,
    },
    /// All unknowns at once: for every solution that a search finds, the steps of `body`.
    Descents {
        /// Which stage.
        stage: usize,
        /// The chain.
        chain: FollowingChain,
        /// Values of the joints that the caller gives (rad or m).
        given: Vec<Scalar>,
        /// The unknowns, defined inside `body`.
        roots: Vec<ValueId>,
        /// What follows for each solution.
        body: Vec<Step>,
    },
    /// The arm that a nearly special one was meant to be: candidates of `body` are solutions of that one, brought to the
    /// pose. Where those are not sure to be all, `otherwise` is done instead.
    Near {
        /// What the two arms are to each other.
        nearly: Box<Nearly>,
        /// What kind of arm was meant, in the field's words.
        meant: String,
        /// Closed form of the arm that was meant.
        body: Vec<Step>,
        /// The arm as it is.
        otherwise: Vec<Step>,
    },
    /// A candidate: the joint variables q, one a joint (not yet wrapped into (-pi, pi], nor checked).
    Accept {
        /// One a joint.
        q: Vec<Scalar>,
        /// The tool frame there, as the outputs of [`FunctionKind::Fk`]; empty where that function is to be asked.
        tool: Vec<Scalar>,
        /// Whether a candidate that is slightly off is brought nearer to the pose: its joints are free to move then.
        polish: bool,
    },
}

/// An equation in one unknown x, with known coefficients.
#[derive(Debug, Clone)]
pub enum Equation {
    /// a cos x + b sin x = c: two roots.
    Trig {
        /// Coefficient of the cosine.
        a: Scalar,
        /// Coefficient of the sine.
        b: Scalar,
        /// Right-hand side.
        c: Scalar,
    },
    /// The same where (a, b) has length 1 and (c, d, e) too: a sin x - b cos x = ± the length of (d, e).
    TrigUnit {
        /// Coefficients of cosine and sine, and the right-hand side.
        row: [Scalar; 3],
        /// d and e.
        others: [Scalar; 2],
    },
    /// a1 cos x + b1 sin x = c1 and a2 cos x + b2 sin x = c2: one root.
    TrigPair {
        /// First equation: a, b, c.
        first: [Scalar; 3],
        /// Second equation: a, b, c.
        second: [Scalar; 3],
    },
    /// The same where each follows from the other at targets that can be met, wherever both say something: two roots.
    TrigEither {
        /// First equation: a, b, c.
        first: [Scalar; 3],
        /// Second equation: a, b, c.
        second: [Scalar; 3],
    },
    /// a x = c: one root.
    Linear {
        /// Coefficient.
        a: Scalar,
        /// Right-hand side.
        c: Scalar,
    },
    /// a x^2 + b x + c = 0: two roots.
    Quadratic {
        /// Coefficient of the square.
        a: Scalar,
        /// Coefficient of x.
        b: Scalar,
        /// Constant.
        c: Scalar,
    },
    /// (k1 + l1 cos x + m1 sin x)^2 + (k2 + l2 cos x + m2 sin x)^2 = n^2: four roots.
    Quartic {
        /// k, l and m of both squares.
        forms: [[Scalar; 3]; 2],
        /// n
        right: Scalar,
        /// Where the first sum is a coordinate of a vector that keeps its length, less a number.
        vector: Option<Box<OfVector<Scalar>>>,
    },
}

/// What one solving step finds, for docs, traces and errors.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Bit i is set where theta (or d) of row i is part of the unknown.
    pub rows: u32,
    /// Name of the unknown: `theta1`, `theta23` (a sum), `d3`.
    pub unknown: String,
    /// Whether the coefficients are lengths, areas or ratios; gives tolerances and the excess of errors their scale.
    pub measure: Measure,
    /// The equation as text, for the generated comments: "px s1 - py c1 = d4".
    pub equation: String,
    /// Abbreviations that the equation uses and that no earlier stage defined: (name, definition).
    pub definitions: Vec<(String, String)>,
    /// Where it comes from: "row 2 of the position in frame 1".
    pub origin: String,
    /// Of two roots, what tells the `+` root: "a2 s3 > 0". `None` where there is one root, or the step finds all joints.
    pub plus: Option<String>,
}

/// Dimension of the coefficients of an equation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Dimensionless.
    Ratio,
    /// m
    Length,
    /// m^2
    Area,
    /// A higher power of the metre.
    Power(u8),
}

/// A scalar expression; a tree, since what is shared has a name of its own.
#[derive(Debug, Clone, PartialEq)]
pub enum Scalar {
    /// A named value.
    Value(ValueId),
    /// A named number of the table.
    Constant(ConstantId),
    /// A number, as the f64 nearest to the exact one.
    Number(f64),
    /// -x
    Neg(Box<Scalar>),
    /// x + y
    Add(Box<Scalar>, Box<Scalar>),
    /// x - y
    Sub(Box<Scalar>, Box<Scalar>),
    /// x y
    Mul(Box<Scalar>, Box<Scalar>),
    /// x / y
    Div(Box<Scalar>, Box<Scalar>),
}
