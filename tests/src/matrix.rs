//! Plain 4x4 matrices of [`DoubleDouble`]: the elementary transforms, and their product element by element.

use crate::double_double::DoubleDouble;

/// Rows of a homogeneous transform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matrix(pub [[DoubleDouble; 4]; 4]);

impl Matrix {
    /// The transform that changes nothing.
    pub fn identity() -> Self {
        let mut rows = [[DoubleDouble::ZERO; 4]; 4];
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] = DoubleDouble::ONE;
        }
        Self(rows)
    }

    /// A translation (m).
    pub fn translation(xyz: [DoubleDouble; 3]) -> Self {
        let mut matrix = Self::identity();
        for (row, value) in matrix.0.iter_mut().zip(xyz) {
            row[3] = value;
        }
        matrix
    }

    /// A rotation about axis 0, 1 or 2 (x, y, z), in radians.
    pub fn rotation(axis: usize, angle: DoubleDouble) -> Self {
        let (sin, cos) = angle.sin_cos();
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut matrix = Self::identity();
        matrix.0[j][j] = cos;
        matrix.0[k][k] = cos;
        matrix.0[k][j] = sin;
        matrix.0[j][k] = -sin;
        matrix
    }

    /// A rotation given by a quaternion x, y, z, w of any length but zero.
    pub fn quaternion([x, y, z, w]: [DoubleDouble; 4]) -> Self {
        let two = DoubleDouble::from(2.0) / (x * x + y * y + z * z + w * w);
        let mut matrix = Self::identity();
        let one = DoubleDouble::ONE;
        let rows = [
            [one - two * (y * y + z * z), two * (x * y - z * w), two * (x * z + y * w)],
            [two * (x * y + z * w), one - two * (x * x + z * z), two * (y * z - x * w)],
            [two * (x * z - y * w), two * (y * z + x * w), one - two * (x * x + y * y)],
        ];
        for (row, values) in matrix.0.iter_mut().zip(rows) {
            row[..3].copy_from_slice(&values);
        }
        matrix
    }

    /// `self` times `other`.
    pub fn times(&self, other: &Self) -> Self {
        let mut rows = [[DoubleDouble::ZERO; 4]; 4];
        for (i, row) in rows.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                for k in 0..4 {
                    *value = *value + self.0[i][k] * other.0[k][j];
                }
            }
        }
        Self(rows)
    }

    /// Column 0, 1, 2 (the axes x, y, z of the frame) or 3 (its origin).
    pub fn column(&self, column: usize) -> [DoubleDouble; 3] {
        [self.0[0][column], self.0[1][column], self.0[2][column]]
    }

    /// The same numbers as f64.
    pub fn to_f64(&self) -> [[f64; 4]; 4] {
        self.0.map(|row| row.map(DoubleDouble::to_f64))
    }
}

/// The quaternion x, y, z, w (w >= 0) of a rotation matrix's rows.
pub fn quaternion_of(m: &[[f64; 4]; 4]) -> [f64; 4] {
    // Of the four squares the greatest is at least 1/4: no cancellation in the others (Shepperd).
    let squares = [
        1.0 + m[0][0] - m[1][1] - m[2][2],
        1.0 - m[0][0] + m[1][1] - m[2][2],
        1.0 - m[0][0] - m[1][1] + m[2][2],
        1.0 + m[0][0] + m[1][1] + m[2][2],
    ];
    let greatest = (0..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let s = 2.0 * squares[greatest].sqrt();
    let (yz, zx, xy) = (m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]);
    let (yz_sum, zx_sum, xy_sum) = (m[2][1] + m[1][2], m[0][2] + m[2][0], m[1][0] + m[0][1]);
    let q = match greatest {
        0 => [s / 4.0, xy_sum / s, zx_sum / s, yz / s],
        1 => [xy_sum / s, s / 4.0, yz_sum / s, zx / s],
        2 => [zx_sum / s, yz_sum / s, s / 4.0, xy / s],
        _ => [yz / s, zx / s, xy / s, s / 4.0],
    };
    if q[3] < 0.0 { q.map(|value| -value) } else { q }
}

#[cfg(test)]
mod tests {
    use super::{Matrix, quaternion_of};
    use crate::double_double::DoubleDouble;

    #[test]
    fn quaternions_and_axes_agree() {
        let angle = DoubleDouble::from(2.9);
        let (half_sin, half_cos) = (angle * DoubleDouble::from(0.5)).sin_cos();
        for axis in 0..3 {
            let mut q = [DoubleDouble::ZERO, DoubleDouble::ZERO, DoubleDouble::ZERO, half_cos];
            q[axis] = half_sin;
            let (a, b) = (Matrix::quaternion(q).to_f64(), Matrix::rotation(axis, angle).to_f64());
            for (left, right) in a.iter().flatten().zip(b.iter().flatten()) {
                assert!((left - right).abs() < 1e-15);
            }
            let back = quaternion_of(&a);
            for (left, right) in back.iter().zip(q) {
                assert!((left - right.to_f64()).abs() < 1e-15, "{axis} {back:?}");
            }
        }
    }
}
