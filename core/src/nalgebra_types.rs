//! Conversions to and from nalgebra's types.

use nalgebra::{IsometryMatrix3, Matrix3, RealField, Rotation3, SMatrix, Translation3, Vector3};

use crate::{Float, Frame};

/// A pose: rotation matrix and translation (m).
pub type Pose<S = f64> = IsometryMatrix3<S>;

/// A geometric Jacobian: rows vx vy vz (m/s) wx wy wz (rad/s) in base axes, a column for each joint.
pub type Jacobian<const N: usize, S = f64> = SMatrix<S, 6, N>;

/// A Jacobian from its columns, as [`Kinematics::jacobian_into`](crate::Kinematics::jacobian_into) gives them.
pub fn jacobian_from_columns<const N: usize, S: Float + RealField>(columns: [[S; 6]; N]) -> Jacobian<N, S> {
    SMatrix::from_data(nalgebra::ArrayStorage(columns))
}

impl<S: Float + RealField> From<Frame<S>> for IsometryMatrix3<S> {
    fn from(frame: Frame<S>) -> Self {
        let [[r11, r12, r13], [r21, r22, r23], [r31, r32, r33]] = frame.rotation;
        let matrix = Matrix3::new(r11, r12, r13, r21, r22, r23, r31, r32, r33);
        let [x, y, z] = frame.translation;
        Self::from_parts(Translation3::new(x, y, z), Rotation3::from_matrix_unchecked(matrix))
    }
}

impl<S: Float + RealField> From<&Frame<S>> for IsometryMatrix3<S> {
    fn from(frame: &Frame<S>) -> Self {
        (*frame).into()
    }
}

impl<S: Float + RealField> From<IsometryMatrix3<S>> for Frame<S> {
    fn from(pose: IsometryMatrix3<S>) -> Self {
        (&pose).into()
    }
}

impl<S: Float + RealField> From<&IsometryMatrix3<S>> for Frame<S> {
    fn from(pose: &IsometryMatrix3<S>) -> Self {
        Self { rotation: rotation_rows(&pose.rotation), translation: vector_array(&pose.translation.vector) }
    }
}

fn rotation_rows<S: Float + RealField>(rotation: &Rotation3<S>) -> [[S; 3]; 3] {
    // nalgebra stores columns.
    let nalgebra::ArrayStorage(columns) = rotation.matrix().data;
    crate::frame::transpose(&columns)
}

fn vector_array<S: Float + RealField>(vector: &Vector3<S>) -> [S; 3] {
    let nalgebra::ArrayStorage([array]) = vector.data;
    array
}

/// A rotation as rows, for [`Target::Rotation`](crate::Target::Rotation).
impl<S: Float + RealField> From<&Rotation3<S>> for Frame<S> {
    fn from(rotation: &Rotation3<S>) -> Self {
        Self { rotation: rotation_rows(rotation), translation: [S::ZERO; 3] }
    }
}
