//! The common normal of two neighbouring axes, from the numbers of the link between them.

use super::super::chain::{Element, Link};
use super::super::{Angle, Rotation};
use super::NEARLY_PARALLEL;

/// The shortest segment between two axes. Each axis is the z axis of its joint's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonNormal {
    /// Angle between the directions of the axes (rad), 0 ... pi.
    pub angle: f64,
    /// Its length (m). Of axes that are nearly parallel: from the origin of the second joint's frame to the first
    /// axis.
    pub distance: f64,
    /// Its foot on the first axis, from the origin of that joint's frame (m).
    pub start: f64,
    /// Its foot on the second axis, from the origin of that joint's frame (m); 0 for axes that are nearly parallel.
    pub end: f64,
}

impl CommonNormal {
    /// Across a link, from the frame of the joint before it to that of the joint after it.
    pub(super) fn of(link: &Transform) -> Self {
        let [zx, zy, zz] = link.axis();
        let [x, y, z] = link.translation;
        let sine = libm::hypot(zx, zy);
        let angle = libm::atan2(sine, zz);
        if libm::atan2(sine, zz.abs()) <= NEARLY_PARALLEL {
            return Self { angle, distance: libm::hypot(x, y), start: z, end: 0.0 };
        }
        // Along the normal, (-zy, zx, 0) / sine, and along its own normal in the plane of x and y.
        let distance = ((y * zx - x * zy) / sine).abs();
        let end = -(x * zx + y * zy) / (sine * sine);
        Self { angle, distance, start: z + end * zz, end }
    }

    /// By how much the axes are off parallel (rad), whichever way they point.
    pub fn tilt(&self) -> f64 {
        self.angle.min(core::f64::consts::PI - self.angle)
    }
}

/// By how much two directions are off parallel (rad), whichever way they point.
pub(super) fn tilt([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> f64 {
    let cross = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    let [x, y, z] = cross;
    libm::atan2(libm::hypot(libm::hypot(x, y), z), (ax * bx + ay * by + az * bz).abs())
}

/// A rigid transform in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::model) struct Transform {
    pub(super) rotation: [[f64; 3]; 3],
    /// m
    pub(in crate::model) translation: [f64; 3],
}

impl Transform {
    pub(super) fn identity() -> Self {
        Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] }
    }

    /// A translation along x, y or z (m).
    pub(super) fn along(axis: usize, by: f64) -> Self {
        let mut transform = Self::identity();
        if let Some(slot) = transform.translation.get_mut(axis) {
            *slot = by;
        }
        transform
    }

    pub(super) fn from_rotation(rotation: [[f64; 3]; 3]) -> Self {
        Self { rotation, translation: [0.0; 3] }
    }

    /// A turn that the table gives.
    pub(super) fn of_rotation(rotation: &Rotation) -> Self {
        match rotation {
            Rotation::Rpy([roll, pitch, yaw]) => {
                Self::about(2, *yaw).times(&Self::about(1, *pitch)).times(&Self::about(0, *roll))
            }
            Rotation::Matrix(rows) => Self::from_rotation(*rows),
        }
    }

    /// The turn back, without the way back.
    pub(super) fn inverse_rotation(&self) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.rotation;
        Self::from_rotation([[a, d, g], [b, e, h], [c, f, i]])
    }

    /// A turn about z.
    pub(super) fn turned(angle: Angle) -> Self {
        Self::about(2, angle)
    }

    fn about(axis: usize, angle: Angle) -> Self {
        let (s, c) = angle.sin_cos();
        let rotation = match axis {
            0 => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
            1 => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
            _ => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
        };
        Self::from_rotation(rotation)
    }

    pub(in crate::model) fn of_link(link: &Link) -> Self {
        link.elements.iter().fold(Self::identity(), |product, element| {
            product.times(&match element {
                Element::Translate { axis, value, .. } => Self::along(*axis, *value),
                Element::Rotate { axis, angle, .. } => Self::about(*axis, *angle),
                Element::Matrix { rows, .. } => Self::from_rotation(*rows),
            })
        })
    }

    /// The z axis.
    pub(in crate::model) fn axis(&self) -> [f64; 3] {
        self.rotation.map(|[_, _, z]| z)
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let dot = |row: [f64; 3], column: [f64; 3]| row.iter().zip(column).map(|(a, b)| a * b).sum::<f64>();
        let [ox, oy, oz] = other.rotation;
        let columns = [0, 1, 2]
            .map(|column: usize| [ox, oy, oz].map(|row| row.get(column).copied().unwrap_or_default()));
        let mut translation = self.rotation.map(|row| dot(row, other.translation));
        for (sum, own) in translation.iter_mut().zip(self.translation) {
            *sum += own;
        }
        Self { rotation: self.rotation.map(|row| columns.map(|column| dot(row, column))), translation }
    }
}
