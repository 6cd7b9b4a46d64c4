//! Kinematics types and numeric kernels shared by generated code and the compiler.
//!
//! Lengths are metres and angles radians everywhere. Nothing here allocates, and nothing panics, whatever the input:
//! refusals are typed errors with numbers in them.
//!
//! In the order in which data flows: a [`Target`] is validated, a [`Search`] solves it step by step with the kernels,
//! [`Solutions`] hold what it found, [`Rules`] say which of them are allowed. [`Kinematics`] is the object-safe view of
//! all this that motion, drivers and the command line know.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod arctangent;
mod branch;
mod descents;
mod error;
mod evenly;
mod float;
mod frame;
mod general;
mod generated;
mod joint;
mod kinematics;
mod mounted;
#[cfg(feature = "nalgebra")]
mod nalgebra_types;
mod polish;
mod quaternion;
mod reachable;
mod redundancy;
mod rules;
mod search;
mod seed;
mod selection;
mod self_motion;
mod sine;
mod solution_set;
mod solutions;
mod step;
mod tables;
mod target;
mod travel;
mod unknowns;
mod windings;

pub use branch::{Branch, BranchBit, BranchWord, NamedBranch};
pub use descents::RowChain;
pub use error::{IkError, LengthError};
pub use float::Float;
pub use frame::{Frame, rotation_error};
pub use general::{Chart, GeneralArm, Outcome, SixJoints, Triple};
pub use generated::{copy_into, joint_array};
pub use joint::{Joint, JointKind, Limits, NamedPose, Servo};
pub use kinematics::{FULL_POSE, Kinematics, ProblemInfo};
pub use mounted::Mounted;
#[cfg(feature = "nalgebra")]
pub use nalgebra_types::{Jacobian, Pose, jacobian_from_columns};
pub use polish::{Polished, polish};
pub use reachable::{ConstraintTerm, Reachable};
pub use redundancy::{Arm, FreeValues, Redundancy, SWEEP_SAMPLES};
pub use rules::{Axis, Bound, KeepOut, Rule, Rules, Side, SumLimit, Violation, Violations, Winding};
pub use search::{Candidates, Condition, Exact, Form, Near, Nearly, QuarticRoots, Roots, Search};
pub use seed::{Seed, Wanted};
pub use solution_set::{SolutionSet, SolutionView};
pub use solutions::{Solution, Solutions};
pub use step::{Measure, Step};
pub use target::{Numbers, Target, TargetKind};
pub use travel::{Norm, TrackError, Travel, track};
pub use windings::Windings;

/// The most joints that a robot may have.
pub const MAX_JOINTS: usize = 32;

/// The most solutions that [`Solutions`] and [`SolutionSet`] hold. Sixteen is the greatest number that an arm of six
/// joints can have.
pub const MAX_SOLUTIONS: usize = 16;

/// A candidate counts as a solution if its position error, divided by the reach, and its rotation error (rad) are at
/// most this: about 1e-7 in f64, 3e-3 in f32.
///
/// It scales with the square root of the machine epsilon because that is how accurately a joint is determined at the
/// edge of its equation's domain, where two branches meet; a joint found there passes such an error on to what follows.
/// False roots of squared equations miss their target by far more.
pub fn residual_tolerance<S: Float>() -> S {
    S::from_f64(8.0) * S::SQRT_EPSILON
}
