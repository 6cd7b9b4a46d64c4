//! Quaternions of frames, in the order x, y, z, w.

use crate::Float;
use crate::Frame;

impl<S: Float> Frame<S> {
    /// The rotation as a unit quaternion `[x, y, z, w]` with w >= 0.
    ///
    /// Shepperd's method \[Shepperd 1978\]: the greatest of the four components is computed first, from the trace and
    /// the diagonal, so that nothing is divided by a small number.
    pub fn quaternion(&self) -> [S; 4] {
        let [[r11, r12, r13], [r21, r22, r23], [r31, r32, r33]] = self.rotation;
        let one = S::ONE;
        let trace = r11 + r22 + r33;
        // Four times the product of the greatest component with each.
        let [x, y, z, w] = if trace >= r11 && trace >= r22 && trace >= r33 {
            [r32 - r23, r13 - r31, r21 - r12, one + trace]
        } else if r11 >= r22 && r11 >= r33 {
            [one + r11 - r22 - r33, r21 + r12, r13 + r31, r32 - r23]
        } else if r22 >= r33 {
            [r21 + r12, one - r11 + r22 - r33, r32 + r23, r13 - r31]
        } else {
            [r13 + r31, r32 + r23, one - r11 - r22 + r33, r21 - r12]
        };
        let norm = (x * x + y * y + z * z + w * w).sqrt();
        let scale = if w < S::ZERO { -norm } else { norm };
        // Adding 0 makes a positive zero of a negative one.
        [x / scale, y / scale, z / scale, w / scale + S::ZERO]
    }

    /// From a quaternion `[x, y, z, w]` of any length but 0, and a translation (m). `None` where the quaternion has no
    /// direction: its length is 0 or not finite.
    pub fn from_quaternion(translation: [S; 3], [x, y, z, w]: [S; 4]) -> Option<Self> {
        let greatest = x.abs().max(y.abs()).max(z.abs()).max(w.abs());
        let finite = [x, y, z, w].iter().all(|component| component.is_finite());
        if !finite || greatest <= S::ZERO {
            return None;
        }
        // Scaled first, so that squares neither overflow nor vanish.
        let [x, y, z, w] = [x / greatest, y / greatest, z / greatest, w / greatest];
        let s = S::TWO / (x * x + y * y + z * z + w * w);
        let (xx, yy, zz) = (s * x * x, s * y * y, s * z * z);
        let (xy, xz, yz) = (s * x * y, s * x * z, s * y * z);
        let (wx, wy, wz) = (s * w * x, s * w * y, s * w * z);
        let one = S::ONE;
        let rotation = [
            [one - (yy + zz), xy - wz, xz + wy],
            [xy + wz, one - (xx + zz), yz - wx],
            [xz - wy, yz + wx, one - (xx + yy)],
        ];
        Some(Self { rotation, translation })
    }
}
