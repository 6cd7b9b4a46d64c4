//! What verification found.

use crate::plan::FunctionKind;

/// The findings on every function of a plan, in the plan's order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// One a function.
    pub functions: Vec<FunctionReport>,
}

/// The findings on one function.
#[derive(Debug, Clone, PartialEq)]
pub struct FunctionReport {
    /// Which function.
    pub kind: FunctionKind,
    /// Its name in generated code: `fk`, `jacobian`, `ik_all`, `ik_all_tool_down`.
    pub name: String,
    /// At how many joint poses it was run.
    pub poses: usize,
    /// Greatest error of a position against the product of the rows (m). For Jacobians, of a velocity of the tool
    /// point (m/rad, or m/m); for inverse problems, of the pose of a solution against its target.
    pub position_error: f64,
    /// Greatest error of an orientation (rad); for Jacobians, of an angular velocity (rad/rad, or rad/m).
    pub rotation_error: f64,
    /// Inverse problems only.
    pub inverse: Option<InverseReport>,
    /// Why the function was taken out of the plan.
    pub failure: Option<String>,
}

/// The findings on an inverse problem.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InverseReport {
    /// Poses whose own joint vector had to be among the solutions.
    pub originals: usize,
    /// Where it was.
    pub originals_found: usize,
    /// Poses too near a singular one for that to be asked: smallest singular value of the problem's Jacobian under
    /// [`super::SINGULAR`].
    pub singular: usize,
    /// Poses whose own joint vector was found by its arm angle; 0 where the problem has none.
    pub arm_angles: usize,
    /// `solutions[n]`: poses that had n solutions.
    pub solutions: Vec<usize>,
    /// Whether an original was lost where there are more solutions than are kept (`dh_core::MAX_SOLUTIONS`).
    pub overfull: bool,
    /// Of a function that failed: the median of the smallest singular values of the problem's Jacobian at some poses (m/rad, 1,
    /// ...). Where that is next to nothing, the problem is nearly singular nearly everywhere.
    pub stiffness: Option<f64>,
}

impl FunctionReport {
    pub(super) fn new(kind: FunctionKind, name: String) -> Self {
        let inverse = matches!(kind, FunctionKind::Inverse(_)).then(InverseReport::default);
        FunctionReport {
            kind,
            name,
            poses: 0,
            position_error: 0.0,
            rotation_error: 0.0,
            inverse,
            failure: None,
        }
    }

    /// Takes note of errors (m, rad).
    pub(super) fn errors(&mut self, position: f64, rotation: f64) {
        self.position_error = self.position_error.max(position);
        self.rotation_error = self.rotation_error.max(rotation);
    }
}

impl InverseReport {
    pub(super) fn count(&mut self, solutions: usize) {
        if self.solutions.len() <= solutions {
            self.solutions.resize(solutions + 1, 0);
        }
        if let Some(slot) = self.solutions.get_mut(solutions) {
            *slot += 1;
        }
    }
}
