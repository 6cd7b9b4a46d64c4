//! Vectors, rotations and rigid transforms whose entries are expressions.

use super::expression::{Arena, Expr};

/// Three expressions.
pub type Vec3 = [Expr; 3];

/// Rows of a 3x3 matrix.
pub type Mat3 = [Vec3; 3];

/// Rotation and translation: x -> rotation x + translation.
#[derive(Debug, Clone, Copy)]
pub struct Rigid {
    /// Rows.
    pub rotation: Mat3,
    /// m
    pub translation: Vec3,
}

/// The zero vector.
pub fn zero_vector(arena: &mut Arena) -> Vec3 {
    [arena.zero(); 3]
}

/// The transform that changes nothing.
pub fn identity(arena: &mut Arena) -> Rigid {
    let (zero, one) = (arena.zero(), arena.one());
    Rigid { rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]], translation: [zero; 3] }
}

/// Rotation about a coordinate axis (0, 1, 2 for x, y, z) by the angle with this sine and cosine.
pub fn rotation_about(arena: &mut Arena, axis: usize, (sin, cos): (Expr, Expr)) -> Mat3 {
    let (zero, one, minus) = (arena.zero(), arena.one(), arena.neg(sin));
    match axis {
        0 => [[one, zero, zero], [zero, cos, minus], [zero, sin, cos]],
        1 => [[cos, zero, sin], [zero, one, zero], [minus, zero, cos]],
        _ => [[cos, minus, zero], [sin, cos, zero], [zero, zero, one]],
    }
}

/// a + b
pub fn add(arena: &mut Arena, a: Vec3, b: Vec3) -> Vec3 {
    zip(a, b, |x, y| arena.add(x, y))
}

/// a - b
pub fn sub(arena: &mut Arena, a: Vec3, b: Vec3) -> Vec3 {
    zip(a, b, |x, y| arena.sub(x, y))
}

/// a . b
pub fn dot(arena: &mut Arena, a: Vec3, b: Vec3) -> Expr {
    let [x, y, z] = zip(a, b, |x, y| arena.mul(x, y));
    let sum = arena.add(x, y);
    arena.add(sum, z)
}

/// a x b
pub fn cross(arena: &mut Arena, a: Vec3, b: Vec3) -> Vec3 {
    let [ax, ay, az] = a;
    let [bx, by, bz] = b;
    let mut minor = |p: Expr, q: Expr, r: Expr, s: Expr| {
        let (pq, rs) = (arena.mul(p, q), arena.mul(r, s));
        arena.sub(pq, rs)
    };
    [minor(ay, bz, az, by), minor(az, bx, ax, bz), minor(ax, by, ay, bx)]
}

/// Rz(angle) v for the angle with this sine and cosine.
pub fn turn(arena: &mut Arena, (sin, cos): (Expr, Expr), [x, y, z]: Vec3) -> Vec3 {
    let (cx, sy) = (arena.mul(cos, x), arena.mul(sin, y));
    let (sx, cy) = (arena.mul(sin, x), arena.mul(cos, y));
    [arena.sub(cx, sy), arena.add(sx, cy), z]
}

/// Half a turn about x.
pub fn flip(arena: &mut Arena, [x, y, z]: Vec3) -> Vec3 {
    [x, arena.neg(y), arena.neg(z)]
}

/// matrix v
pub fn apply(arena: &mut Arena, matrix: &Mat3, v: Vec3) -> Vec3 {
    matrix.map(|row| dot(arena, row, v))
}

/// Columns of a matrix as rows.
pub fn transpose(m: &Mat3) -> Mat3 {
    let [[a, b, c], [d, e, f], [g, h, i]] = *m;
    [[a, d, g], [b, e, h], [c, f, i]]
}

/// a b
pub fn product(arena: &mut Arena, a: &Mat3, b: &Mat3) -> Mat3 {
    let columns = transpose(b).map(|column| apply(arena, a, column));
    transpose(&columns)
}

/// a, then b inside a's frame.
pub fn compose(arena: &mut Arena, a: &Rigid, b: &Rigid) -> Rigid {
    let rotation = product(arena, &a.rotation, &b.rotation);
    let moved = apply(arena, &a.rotation, b.translation);
    Rigid { rotation, translation: add(arena, moved, a.translation) }
}

fn zip(a: Vec3, b: Vec3, mut f: impl FnMut(Expr, Expr) -> Expr) -> Vec3 {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    [f(ax, bx), f(ay, by), f(az, bz)]
}
