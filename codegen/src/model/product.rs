//! Forward kinematics as the plain product of the rows' matrices, to hold everything else against.
//!
//! It shares nothing with the chain or the equations. Recentred tables, whose offsets of kilometres cancel, are
//! multiplied in double-double numbers; the others in f64.

use super::{Angle, Convention, JointKind, Model, Placement, Rotation, Row};
use double::Double;

mod double;

/// A frame in the base frame: rows of `[R | p]`, p in metres.
pub type Matrix = [[f64; 4]; 3];

/// Frames of one joint pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// The base frame (after `[base]`), then the frame of every row; one more than there are rows.
    pub rows: Vec<Matrix>,
    /// The tool frame.
    pub tool: Matrix,
}

/// The frames at `q` (rad or m, one a joint; missing ones count as 0).
pub fn frames(model: &Model, q: &[f64]) -> Frames {
    if model.rows.iter().any(|row| row.shift != 0.0) {
        product::<Double>(model, q)
    } else {
        product::<f64>(model, q)
    }
}

/// Columns of the geometric Jacobian at the tool point, each with the distance of its axis' origin (m), to which
/// rounding is relative: z x (p - o) and z for a row that turns, z and 0 for one that slides.
pub fn jacobian(model: &Model, frames: &Frames) -> Vec<([f64; 6], f64)> {
    let mut columns = vec![([0.0; 6], 0.0); model.joints.len()];
    let [tx, ty, tz] = frames.tool.map(|[_, _, _, p]| p);
    for (index, row) in model.rows.iter().enumerate() {
        // Standard rows turn about the z axis of the frame before theirs, modified ones about their own.
        let frame = match model.convention {
            Convention::Standard => index,
            Convention::Modified => index + 1,
        };
        let Some(frame) = frames.rows.get(frame) else {
            continue;
        };
        let [ox, oy, oz] = frame.map(|[_, _, _, p]| p);
        let [zx, zy, zz] = frame.map(|[_, _, z, _]| z);
        let (lx, ly, lz) = (tx - ox, ty - oy, tz - oz);
        let (rates, arm) = match row.kind {
            JointKind::Revolute => {
                let velocity = [zy * lz - zz * ly, zz * lx - zx * lz, zx * ly - zy * lx];
                ([velocity, [zx, zy, zz]], (lx * lx + ly * ly + lz * lz).sqrt())
            }
            JointKind::Prismatic => ([[zx, zy, zz], [0.0; 3]], 0.0),
        };
        for (joint, factor) in &row.terms {
            let Some((column, distance)) = columns.get_mut(*joint) else {
                continue;
            };
            column.iter_mut().zip(rates.as_flattened()).for_each(|(sum, rate)| *sum += factor * rate);
            *distance += factor.abs() * arm;
        }
    }
    columns
}

/// What the product is computed in.
trait Number:
    Copy + core::ops::Add<Output = Self> + core::ops::Mul<Output = Self> + core::ops::Neg<Output = Self>
{
    fn of(value: f64) -> Self;
    fn nearest(self) -> f64;
    /// Sine and cosine of an angle of the table and what is added to it (rad).
    fn sin_cos(angle: Angle, added: Self) -> (Self, Self);
}

impl Number for f64 {
    fn of(value: f64) -> f64 {
        value
    }

    fn nearest(self) -> f64 {
        self
    }

    fn sin_cos(angle: Angle, added: f64) -> (f64, f64) {
        if added == 0.0 {
            return angle.sin_cos();
        }
        let sum = angle.value + added;
        (libm::sin(sum), libm::cos(sum))
    }
}

/// `[R | p]` in the numbers of the computation.
#[derive(Clone, Copy)]
struct Transform<T> {
    rotation: [[T; 3]; 3],
    translation: [T; 3],
}

impl<T: Number> Transform<T> {
    fn identity() -> Self {
        let (one, zero) = (T::of(1.0), T::of(0.0));
        Transform {
            rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
            translation: [zero; 3],
        }
    }

    /// Along x, y, z.
    fn translation(along: [T; 3]) -> Self {
        Transform { translation: along, ..Self::identity() }
    }

    /// About x, y or z, for `axis` 0, 1, 2.
    fn rotation(axis: usize, angle: Angle, added: T) -> Self {
        let (sine, cosine) = T::sin_cos(angle, added);
        let (one, zero) = (T::of(1.0), T::of(0.0));
        let rotation = match axis {
            0 => [[one, zero, zero], [zero, cosine, -sine], [zero, sine, cosine]],
            1 => [[cosine, zero, sine], [zero, one, zero], [-sine, zero, cosine]],
            _ => [[cosine, -sine, zero], [sine, cosine, zero], [zero, zero, one]],
        };
        Transform { rotation, ..Self::identity() }
    }

    fn fixed(axis: usize, angle: Angle) -> Self {
        Self::rotation(axis, angle, T::of(0.0))
    }

    fn then(&self, next: &Self) -> Self {
        let turned = |[x, y, z]: [T; 3]| self.rotation.map(|[r1, r2, r3]| r1 * x + r2 * y + r3 * z);
        let [[a, b, c], [d, e, f], [g, h, i]] = next.rotation;
        let [[a, d, g], [b, e, h], [c, f, i]] = [turned([a, d, g]), turned([b, e, h]), turned([c, f, i])];
        let [x, y, z] = turned(next.translation);
        let [px, py, pz] = self.translation;
        Transform { rotation: [[a, b, c], [d, e, f], [g, h, i]], translation: [px + x, py + y, pz + z] }
    }

    fn matrix(&self) -> Matrix {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.rotation.map(|row| row.map(T::nearest));
        let [x, y, z] = self.translation.map(T::nearest);
        [[a, b, c, x], [d, e, f, y], [g, h, i, z]]
    }
}

fn product<T: Number>(model: &Model, q: &[f64]) -> Frames {
    let mut frame = placement::<T>(&model.base);
    let mut rows = vec![frame.matrix()];
    for row in &model.rows {
        let along_and_about_z = joint::<T>(row, q);
        let link = Transform::translation([T::of(row.a), T::of(0.0), T::of(0.0)])
            .then(&Transform::fixed(0, row.alpha))
            .then(&Transform::fixed(1, row.beta));
        frame = match model.convention {
            Convention::Standard => frame.then(&along_and_about_z).then(&link),
            Convention::Modified => frame.then(&link).then(&along_and_about_z),
        };
        rows.push(frame.matrix());
    }
    Frames { rows, tool: frame.then(&placement(&model.tool)).matrix() }
}

/// Rz(theta) Tz(d) of a row at `q`.
fn joint<T: Number>(row: &Row, q: &[f64]) -> Transform<T> {
    let mut varies = T::of(0.0);
    for &(index, coefficient) in &row.terms {
        let value = q.get(index).copied().unwrap_or(0.0);
        varies = varies + T::of(coefficient) * T::of(value);
    }
    let (turn, slide) = match row.kind {
        JointKind::Revolute => (varies, T::of(0.0)),
        JointKind::Prismatic => (T::of(0.0), varies),
    };
    let zero = T::of(0.0);
    Transform::rotation(2, row.theta, turn).then(&Transform::translation([zero, zero, T::of(row.d) + slide]))
}

fn placement<T: Number>(placement: &Placement) -> Transform<T> {
    let along = Transform::translation(placement.xyz.map(T::of));
    let turn = match &placement.rotation {
        Rotation::Rpy([roll, pitch, yaw]) => {
            Transform::fixed(2, *yaw).then(&Transform::fixed(1, *pitch)).then(&Transform::fixed(0, *roll))
        }
        Rotation::Matrix(rows) => {
            Transform { rotation: rows.map(|row| row.map(T::of)), translation: [T::of(0.0); 3] }
        }
    };
    along.then(&turn)
}
