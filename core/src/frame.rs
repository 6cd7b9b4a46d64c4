//! Rigid motions: a rotation matrix with a translation.

use core::ops::Mul;

use crate::Float;

/// A pose of one frame in another: a rotation matrix and a translation.
///
/// A matrix rather than a quaternion, because Denavit-Hartenberg products give one, and turning it into a quaternion
/// costs more than the product itself; ask for [`Frame::quaternion`] where you need it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<S = f64> {
    /// Rows of the rotation matrix; its columns are the axes of the frame.
    pub rotation: [[S; 3]; 3],
    /// Origin of the frame (m).
    pub translation: [S; 3],
}

impl<S: Float> Frame<S> {
    /// The frame itself.
    pub const IDENTITY: Self = Self {
        rotation: [[S::ONE, S::ZERO, S::ZERO], [S::ZERO, S::ONE, S::ZERO], [S::ZERO, S::ZERO, S::ONE]],
        translation: [S::ZERO; 3],
    };

    /// The frame itself; [`Frame::IDENTITY`] for those who look for a function.
    pub const fn identity() -> Self {
        Self::IDENTITY
    }

    /// From the rows of `[R | p]`: `r11 r12 r13 px  r21 r22 r23 py  r31 r32 r33 pz` (m).
    pub const fn from_rows(rows: [S; 12]) -> Self {
        let [r11, r12, r13, px, r21, r22, r23, py, r31, r32, r33, pz] = rows;
        Self { rotation: [[r11, r12, r13], [r21, r22, r23], [r31, r32, r33]], translation: [px, py, pz] }
    }

    /// The rows of `[R | p]`, as [`Frame::from_rows`] takes them.
    pub const fn rows(&self) -> [S; 12] {
        let [[r11, r12, r13], [r21, r22, r23], [r31, r32, r33]] = self.rotation;
        let [px, py, pz] = self.translation;
        [r11, r12, r13, px, r21, r22, r23, py, r31, r32, r33, pz]
    }

    /// A pure translation (m).
    pub const fn from_translation(translation: [S; 3]) -> Self {
        Self { rotation: Self::IDENTITY.rotation, translation }
    }

    /// Rotation about fixed x, y, z: Rz(yaw) Ry(pitch) Rx(roll), angles in radians; translation in metres.
    pub fn from_rpy(translation: [S; 3], [roll, pitch, yaw]: [S; 3]) -> Self {
        let (sr, cr) = roll.sin_cos();
        let (sp, cp) = pitch.sin_cos();
        let (sy, cy) = yaw.sin_cos();
        let rotation = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        Self { rotation, translation }
    }

    /// `self * other`: where `other`, given in this frame, is in the frame that this one is given in.
    pub fn compose(&self, other: &Self) -> Self {
        Self {
            rotation: matrix_product(&self.rotation, &other.rotation),
            translation: self.transform_point(other.translation),
        }
    }

    /// The inverse motion (by the transpose: the rotation must be one).
    pub fn inverse(&self) -> Self {
        let rotation = transpose(&self.rotation);
        let translation = matrix_vector(&rotation, self.translation).map(|x| -x);
        Self { rotation, translation }
    }

    /// A point of this frame (m) in the frame that this one is given in.
    pub fn transform_point(&self, point: [S; 3]) -> [S; 3] {
        add(matrix_vector(&self.rotation, point), self.translation)
    }

    /// A direction of this frame in the frame that this one is given in.
    pub fn transform_vector(&self, vector: [S; 3]) -> [S; 3] {
        matrix_vector(&self.rotation, vector)
    }

    /// Direction of the frame's x axis.
    pub const fn x_axis(&self) -> [S; 3] {
        let [[x1, _, _], [x2, _, _], [x3, _, _]] = self.rotation;
        [x1, x2, x3]
    }

    /// Direction of the frame's z axis.
    pub const fn z_axis(&self) -> [S; 3] {
        let [[_, _, z1], [_, _, z2], [_, _, z3]] = self.rotation;
        [z1, z2, z3]
    }

    /// Roll, pitch, yaw (rad) about fixed x, y, z: the inverse of [`Frame::from_rpy`]. Where pitch is a quarter turn,
    /// only a sum of roll and yaw is determined; roll is 0 then.
    pub fn rpy(&self) -> [S; 3] {
        let [[r11, r12, _], [r21, r22, _], [r31, r32, r33]] = self.rotation;
        let horizontal = r11.hypot(r21);
        let pitch = (-r31).atan2(horizontal);
        if horizontal > S::from_f64(GIMBAL) * S::EPSILON {
            [r32.atan2(r33), pitch, r21.atan2(r11)]
        } else {
            [S::ZERO, pitch, (-r12).atan2(r22)]
        }
    }

    /// How far the rotation is from being one: the greatest entry of |`RᵀR` - 1| and |det R - 1|. NaN where an entry is.
    pub fn rigidity_error(&self) -> S {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.rotation;
        let determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
        let gram = matrix_product(&transpose(&self.rotation), &self.rotation);
        // Every entry is in the determinant: it is NaN where any of them is.
        let mut worst = (determinant - S::ONE).abs();
        for (row, unit) in gram.iter().zip(&Self::IDENTITY.rotation) {
            for (x, one) in row.iter().zip(unit) {
                let error = (*x - *one).abs();
                if error > worst {
                    worst = error;
                }
            }
        }
        worst
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.rows().iter().all(|x| x.is_finite())
    }
}

/// The horizontal part of the x axis, in machine epsilons, under which roll and yaw are no longer told apart.
const GIMBAL: f64 = 16.0;

impl<S: Float> From<&Frame<S>> for Frame<S> {
    fn from(frame: &Frame<S>) -> Self {
        *frame
    }
}

impl<S: Float> Default for Frame<S> {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl<S: Float> Mul for Frame<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.compose(&other)
    }
}

impl<S: Float> Mul<&Frame<S>> for &Frame<S> {
    type Output = Frame<S>;
    fn mul(self, other: &Frame<S>) -> Frame<S> {
        self.compose(other)
    }
}

/// The angle (rad, 0 to pi) of the rotation that turns `a` into `b`.
///
/// Small angles come from |a - b|, which is 2 sqrt(2) sin(angle / 2) in the Frobenius norm; others from sine and cosine
/// of the angle, read off the antisymmetric part and the trace of aᵀb. Neither loses digits near 0 or near pi, as the
/// arc cosine of the trace does.
///
/// ```
/// use dh_core::{Frame, rotation_error};
/// let turned = Frame::from_rpy([0.0; 3], [0.0, 0.0, 1e-12]);
/// let angle: f64 = rotation_error(&Frame::identity().rotation, &turned.rotation);
/// assert!((angle - 1e-12).abs() < 1e-24);
/// ```
#[inline]
pub fn rotation_error<S: Float>(a: &[[S; 3]; 3], b: &[[S; 3]; 3]) -> S {
    let mut square = S::ZERO;
    for (row_a, row_b) in a.iter().zip(b) {
        let difference = sub(*row_b, *row_a);
        square += dot(difference, difference);
    }
    // sin^2 of half the angle.
    let half_sine_square = square / S::from_f64(8.0);
    if half_sine_square < S::from_f64(SMALL_HALF_SINE_SQUARE) {
        // 2 asin(x) = 2 x + x^3 / 3 + 3 x^5 / 20 + ...
        let twice = S::TWO * half_sine_square.sqrt();
        return twice + twice * half_sine_square / S::from_f64(6.0);
    }
    large_angle(a, b)
}

/// [`rotation_error`], of any but small angles.
#[inline(never)]
fn large_angle<S: Float>(a: &[[S; 3]; 3], b: &[[S; 3]; 3]) -> S {
    let [[e11, e12, e13], [e21, e22, e23], [e31, e32, e33]] = matrix_product(&transpose(a), b);
    let twice_sine = norm([e32 - e23, e13 - e31, e21 - e12]);
    let twice_cosine = e11 + e22 + e33 - S::ONE;
    twice_sine.atan2(twice_cosine)
}

/// Up to here the series in [`rotation_error`] is exact to the last digits of f64 (its next term is 3e-17 of the first).
const SMALL_HALF_SINE_SQUARE: f64 = 2e-8;

pub(crate) fn dot<S: Float>([a1, a2, a3]: [S; 3], [b1, b2, b3]: [S; 3]) -> S {
    a1 * b1 + a2 * b2 + a3 * b3
}

pub(crate) fn cross<S: Float>([a1, a2, a3]: [S; 3], [b1, b2, b3]: [S; 3]) -> [S; 3] {
    [a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1]
}

pub(crate) fn norm<S: Float>(v: [S; 3]) -> S {
    dot(v, v).sqrt()
}

pub(crate) fn add<S: Float>([a1, a2, a3]: [S; 3], [b1, b2, b3]: [S; 3]) -> [S; 3] {
    [a1 + b1, a2 + b2, a3 + b3]
}

pub(crate) fn sub<S: Float>([a1, a2, a3]: [S; 3], [b1, b2, b3]: [S; 3]) -> [S; 3] {
    [a1 - b1, a2 - b2, a3 - b3]
}

pub(crate) fn transpose<S: Float>(m: &[[S; 3]; 3]) -> [[S; 3]; 3] {
    let [[a, b, c], [d, e, f], [g, h, i]] = *m;
    [[a, d, g], [b, e, h], [c, f, i]]
}

/// The turn from one orientation to another: its axis, as long as the sine of its angle, and the trace of its matrix, which
/// is 1 and twice the cosine.
#[inline]
pub(crate) fn turn<S: Float>(from: &[[S; 3]; 3], to: &[[S; 3]; 3]) -> ([S; 3], S) {
    let [[ax, bx, cx], [ay, by, cy], [az, bz, cz]] = *from;
    let [[dx, ex, fx], [dy, ey, fy], [dz, ez, fz]] = *to;
    let [a, b, c] = [[ax, ay, az], [bx, by, bz], [cx, cy, cz]];
    let [d, e, f] = [[dx, dy, dz], [ex, ey, ez], [fx, fy, fz]];
    let [x, y, z] = add(add(cross(a, d), cross(b, e)), cross(c, f));
    let half = S::ONE / S::TWO;
    ([x * half, y * half, z * half], dot(a, d) + dot(b, e) + dot(c, f))
}

pub(crate) fn matrix_vector<S: Float>(m: &[[S; 3]; 3], v: [S; 3]) -> [S; 3] {
    let [a, b, c] = *m;
    [dot(a, v), dot(b, v), dot(c, v)]
}

pub(crate) fn matrix_product<S: Float>(a: &[[S; 3]; 3], b: &[[S; 3]; 3]) -> [[S; 3]; 3] {
    // Written out: `map` of arrays is a call in optimised code.
    let [x, y, z] = transpose(b);
    let row = |own: [S; 3]| [dot(own, x), dot(own, y), dot(own, z)];
    let [a, b, c] = *a;
    [row(a), row(b), row(c)]
}
