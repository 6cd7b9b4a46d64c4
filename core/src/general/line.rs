//! A line and its power products.

use crate::Frame;

/// How many power products a line has.
pub(super) const PRODUCTS: usize = 14;

/// p, l, p·p, p·l, p×l and (p·p) l - 2 (p·l) p of a line through p along l.
///
/// A rigid motion changes them linearly (affinely), so that along a chain they are linear in cosine and sine of every
/// joint angle \[Raghavan, Roth 1993, Inverse kinematics of the general 6R manipulator\].
pub(super) type Products = [f64; PRODUCTS];

/// Of the products, those that a turn about z leaves alone.
pub(super) const UNTURNED: [usize; 6] = [2, 5, 6, 7, 10, 13];
/// The others, in pairs that it turns.
pub(super) const TURNED: [[usize; 2]; 4] = [[0, 1], [3, 4], [8, 9], [11, 12]];
/// Of the products, those that a slide along z leaves alone.
const UNSLID: [usize; 6] = [0, 1, 3, 4, 5, 10];

/// A line with a point on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    point: [f64; 3],
    direction: [f64; 3],
}

impl Line {
    /// The z axis, with the origin.
    pub(super) const AXIS: Self = Self { point: [0.0; 3], direction: [0.0, 0.0, 1.0] };

    /// Given in a frame: where it is in the frame that this one is given in.
    pub(super) const fn moved(&self, frame: &Frame) -> Self {
        let [x, y, z] = turned(&frame.rotation, self.point);
        let [dx, dy, dz] = frame.translation;
        Self { point: [x + dx, y + dy, z + dz], direction: turned(&frame.rotation, self.direction) }
    }

    /// Moved by a joint.
    pub(super) const fn by(&self, joint: &Motion) -> Self {
        let (cos, sin) = (joint.cos, joint.sin);
        let ([x, y, z], [u, v, w]) = (self.point, self.direction);
        Self {
            point: [cos * x - sin * y, sin * x + cos * y, z + joint.slide],
            direction: [cos * u - sin * v, sin * u + cos * v, w],
        }
    }

    /// Its power products.
    pub(super) const fn products(&self) -> Products {
        let ([p1, p2, p3], [l1, l2, l3]) = (self.point, self.direction);
        let (pp, pl) = (p1 * p1 + p2 * p2 + p3 * p3, p1 * l1 + p2 * l2 + p3 * l3);
        let [n1, n2, n3] = [p2 * l3 - p3 * l2, p3 * l1 - p1 * l3, p1 * l2 - p2 * l1];
        let twice = 2.0 * pl;
        let [k1, k2, k3] = [pp * l1 - twice * p1, pp * l2 - twice * p2, pp * l3 - twice * p3];
        [p1, p2, p3, l1, l2, l3, pp, pl, n1, n2, n3, k1, k2, k3]
    }

    /// The products that a joint along z leaves alone.
    pub(super) fn invariants(&self, prismatic: bool) -> [f64; 6] {
        let products = self.products();
        let kept = if prismatic { UNSLID } else { UNTURNED };
        kept.map(|index| products.get(index).copied().unwrap_or(0.0))
    }

    /// What a joint along z must do to bring this line to another (rad, or the unit of length).
    pub(super) fn turn_to(&self, other: &Self, prismatic: bool) -> f64 {
        if prismatic {
            // The point is carried along.
            let [_, _, from] = self.point;
            let [_, _, to] = other.point;
            return to - from;
        }
        let (from, to) = (self.products(), other.products());
        let (mut sin, mut cos) = (0.0, 0.0);
        for [x, y] in TURNED {
            let pick = |list: &Products, index: usize| list.get(index).copied().unwrap_or(0.0);
            let (a, b, c, d) = (pick(&from, x), pick(&from, y), pick(&to, x), pick(&to, y));
            cos += a * c + b * d;
            sin += a * d - b * c;
        }
        libm::atan2(sin, cos)
    }
}

/// A vector in the frame that a rotation leads to.
const fn turned(rotation: &[[f64; 3]; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [[a, b, c], [d, e, f], [g, h, i]] = *rotation;
    [a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z]
}

/// What a joint does along and about its z axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    cos: f64,
    sin: f64,
    slide: f64,
}

impl Motion {
    /// By cosine and sine of the turn.
    pub(super) const fn turned(cos: f64, sin: f64) -> Self {
        Self { cos, sin, slide: 0.0 }
    }

    /// By the slide (the unit of length).
    pub(super) const fn slid(slide: f64) -> Self {
        Self { cos: 1.0, sin: 0.0, slide }
    }

    /// By a value (rad or the unit of length).
    pub(super) fn new(prismatic: bool, value: f64) -> Self {
        if prismatic {
            return Self::slid(value);
        }
        let (sin, cos) = libm::sincos(value);
        Self { cos, sin, slide: 0.0 }
    }

    /// The other way.
    pub(super) const fn reversed(&self) -> Self {
        Self { cos: self.cos, sin: -self.sin, slide: -self.slide }
    }

    /// As a frame.
    pub(super) const fn frame(&self) -> Frame {
        let (c, s) = (self.cos, self.sin);
        Frame { rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], translation: [0.0, 0.0, self.slide] }
    }
}
