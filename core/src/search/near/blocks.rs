//! The changes of six joints that make a twist, by blocks of three rows and columns: velocities and rates of turning, of the
//! first three joints and of the last three. Inverses of blocks are vector products, with one division each, where elimination
//! has six, one after the other.

use super::UNKNOWNS;
use super::above;
use crate::Float;
use crate::frame::{cross, dot};

/// Determinants of the last joints' rates of turning that are smaller cost more digits than the last step of Newton's method can
/// spare, which nothing checks: the cube of what divides them is lost.
const SMALL: f64 = 0.02;

/// The same of the first joints' velocities (reaches).
const SINGULAR: f64 = 1e-6;

/// A Jacobian as its blocks.
pub(super) struct Blocks<S> {
    /// Rows of the inverse of the last joints' rates of turning.
    turning: [[S; 3]; 3],
    /// The last joints' velocities.
    velocities: [[S; 3]; 3],
    /// By how much the last joints make up for what the first ones turn, for each of these.
    follow: [[S; 3]; 3],
    /// Rows of the inverse of the first joints' velocities when the last ones follow.
    moving: [[S; 3]; 3],
    /// The Jacobian's (reaches, rad).
    pub(super) determinant: S,
}

impl<S: Float> Blocks<S> {
    /// Of columns (m, rad); `None` where a block is nearly singular.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call would put the blocks into memory")]
    pub(super) fn new([a, b, c, d, e, f]: [&[S; 6]; UNKNOWNS], per_reach: S) -> Option<Self> {
        let (turning, first) = inverse([rates(d), rates(e), rates(f)]);
        let velocities = [velocity(d), velocity(e), velocity(f)];
        let [ra, rb, rc] =
            [product(&turning, rates(a)), product(&turning, rates(b)), product(&turning, rates(c))];
        let (moving, second) = inverse([
            less(velocity(a), &velocities, ra),
            less(velocity(b), &velocities, rb),
            less(velocity(c), &velocities, rc),
        ]);
        let second = second * per_reach * per_reach * per_reach;
        if !(above(first.abs(), S::from_f64(SMALL)) && above(second.abs(), S::from_f64(SINGULAR))) {
            return None;
        }
        Some(Self { turning, velocities, follow: [ra, rb, rc], moving, determinant: first * second })
    }

    /// The changes (rad, m) that make a displacement (m) and a turn (rad).
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call would put the blocks into memory")]
    pub(super) fn solution(&self, away: [S; 3], turned: [S; 3]) -> [S; UNKNOWNS] {
        let turned = product(&self.turning, turned);
        let first = product(&self.moving, less(away, &self.velocities, turned));
        let [a, b, c] = first;
        let [d, e, f] = less(turned, &self.follow, first);
        [a, b, c, d, e, f]
    }
}

fn velocity<S: Float>([x, y, z, ..]: &[S; 6]) -> [S; 3] {
    [*x, *y, *z]
}

fn rates<S: Float>([.., x, y, z]: &[S; 6]) -> [S; 3] {
    [*x, *y, *z]
}

/// Rows of the inverse of three columns, and their determinant.
#[inline]
fn inverse<S: Float>([a, b, c]: [[S; 3]; 3]) -> ([[S; 3]; 3], S) {
    let [bc, ca, ab] = [cross(b, c), cross(c, a), cross(a, b)];
    let determinant = dot(a, bc);
    let unit = S::ONE / determinant;
    let scaled = |[x, y, z]: [S; 3]| [x * unit, y * unit, z * unit];
    ([scaled(bc), scaled(ca), scaled(ab)], determinant)
}

/// Rows times a column.
#[inline]
fn product<S: Float>([a, b, c]: &[[S; 3]; 3], x: [S; 3]) -> [S; 3] {
    [dot(*a, x), dot(*b, x), dot(*c, x)]
}

/// A vector less so much of each column.
#[inline]
fn less<S: Float>([x, y, z]: [S; 3], [a, b, c]: &[[S; 3]; 3], [i, j, k]: [S; 3]) -> [S; 3] {
    [
        x - (a[0] * i + b[0] * j + c[0] * k),
        y - (a[1] * i + b[1] * j + c[1] * k),
        z - (a[2] * i + b[2] * j + c[2] * k),
    ]
}

#[cfg(test)]
mod tests {
    use super::{Blocks, UNKNOWNS};

    fn columns() -> [[f64; 6]; UNKNOWNS] {
        core::array::from_fn(|c| {
            core::array::from_fn(|r| libm::sin((r * r * c + 3 * r + 5 * c * c + 1) as f64 * 1.3))
        })
    }

    #[test]
    fn changes_make_the_twist() {
        let columns = columns();
        let blocks = Blocks::new(columns.each_ref(), 0.5).expect("no block is singular");
        let twist = [0.3, -0.1, 0.2, 0.5, -0.7, 0.4];
        let [x, y, z, roll, pitch, yaw] = twist;
        let changes = blocks.solution([x, y, z], [roll, pitch, yaw]);
        for (row, wanted) in twist.iter().enumerate() {
            let made: f64 = columns.iter().zip(changes).map(|(column, change)| column[row] * change).sum();
            assert!((made - wanted).abs() < 1e-12);
        }
    }

    #[test]
    fn blocks_that_are_singular_are_refused() {
        let mut parallel = columns();
        let [.., x, y, z] = parallel[4];
        parallel[5][3..].copy_from_slice(&[x, y, z]);
        assert!(Blocks::new(parallel.each_ref(), 1.0).is_none());
        let mut singular = columns();
        singular[1] = singular[0];
        assert!(Blocks::new(singular.each_ref(), 1.0).is_none());
        let mut none = columns();
        none[0][0] = f64::NAN;
        assert!(Blocks::new(none.each_ref(), 1.0).is_none());
    }
}
