//! What functions are held against: the product of the rows' matrices of the very table, which shares nothing with
//! the equations and the plan.

use crate::model::Model;
use crate::model::product::{self, Frames, Matrix};
use dh_core::Frame;

/// The robot at one joint vector, from the product alone.
pub(super) struct Reference<'m> {
    model: &'m Model,
    /// rad or m
    pub(super) q: Vec<f64>,
    pub(super) frames: Frames,
}

impl<'m> Reference<'m> {
    pub(super) fn at(model: &'m Model, q: Vec<f64>) -> Self {
        let frames = product::frames(model, &q);
        Reference { model, q, frames }
    }

    /// The flange, which is the frame of the last row.
    pub(super) fn flange(&self) -> Matrix {
        self.frames.rows.last().copied().unwrap_or(self.frames.tool)
    }

    /// Columns of the geometric Jacobian at the tool point, see [`product::jacobian`].
    pub(super) fn jacobian(&self) -> Vec<([f64; 6], f64)> {
        product::jacobian(self.model, &self.frames)
    }
}

/// The tool frame at a joint vector.
pub(super) fn tool(model: &Model, q: &[f64]) -> Frame<f64> {
    frame(&product::frames(model, q).tool)
}

/// A matrix of the product as a frame.
pub(super) fn frame([x, y, z]: &Matrix) -> Frame<f64> {
    let [x, y, z] = [x, y, z].map(|[r1, r2, r3, p]| ([*r1, *r2, *r3], *p));
    Frame { rotation: [x.0, y.0, z.0], translation: [x.1, y.1, z.1] }
}

/// The origin of a frame (m).
pub(super) fn position(matrix: &Matrix) -> [f64; 3] {
    matrix.map(|[_, _, _, p]| p)
}

/// Distance of two matrices' origins (m) and Frobenius distance of their rotations over sqrt(2), which is the angle
/// between them where it is small (rad), and unlike an angle by `acos` keeps its digits there.
pub(super) fn distance(left: &Matrix, right: &Matrix) -> (f64, f64) {
    let (mut position, mut rotation) = (0.0, 0.0);
    for (left, right) in left.iter().zip(right) {
        for (column, (left, right)) in left.iter().zip(right).enumerate() {
            let square = (left - right) * (left - right);
            *(if column == 3 { &mut position } else { &mut rotation }) += square;
        }
    }
    (f64::sqrt(position), f64::sqrt(rotation / 2.0))
}
