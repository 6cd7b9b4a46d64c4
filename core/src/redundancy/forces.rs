//! How the tool's second derivatives bend the square of the distance from a seed, as forces at the tool that pull the joints
//! away from it.

use crate::Float;
use crate::frame::{add, cross, dot, norm};

/// Beyond this sum of angles (rad) the bound on third derivatives isn't one.
const FARTHEST: f64 = 1.25;

/// With the offset from the seed `Jᵀλ` across the curve, the multipliers λ are a force at the tool and a torque. Their work
/// on the second derivatives of the tool frame is a symmetric matrix H: for joints i <= j with axes ω and columns v of
/// velocities ωi · (vj x f + ωj x m / 2), since the position's derivatives are ωi x vj, and half of ωi x ωj those of the
/// antisymmetric part of a rotation that is 1 there.
pub(super) struct Forces<const N: usize, S> {
    /// vj x f + ωj x m / 2
    pulls: [[S; 3]; N],
    /// Of force and torque, in reaches and rad.
    sizes: [S; 2],
    /// 1/m
    per_reach: S,
}

impl<const N: usize, S: Float> Forces<N, S> {
    /// At columns of the Jacobian (rad, m), of multipliers of its rows (reaches, rad).
    pub(super) fn new(columns: &[[S; 6]; N], [l1, l2, l3, l4, l5, l6]: [S; 6], per_reach: S) -> Self {
        let force = [l1 * per_reach, l2 * per_reach, l3 * per_reach];
        let half = S::ONE / S::TWO;
        let torque = [l4 * half, l5 * half, l6 * half];
        let mut pulls = [[S::ZERO; 3]; N];
        for (pull, [vx, vy, vz, ax, ay, az]) in pulls.iter_mut().zip(columns) {
            *pull = add(cross([*vx, *vy, *vz], force), cross([*ax, *ay, *az], torque));
        }
        Self { pulls, sizes: [norm([l1, l2, l3]), norm([l4, l5, l6])], per_reach }
    }

    /// H times a vector.
    pub(super) fn bend(&self, columns: &[[S; 6]; N], vector: &[S; N]) -> [S; N] {
        let mut product = [S::ZERO; N];
        let mut turned = [S::ZERO; 3];
        for (((out, pull), [.., ax, ay, az]), x) in
            product.iter_mut().zip(&self.pulls).zip(columns).zip(vector)
        {
            turned = add(turned, [*ax * *x, *ay * *x, *az * *x]);
            *out = dot(*pull, turned);
        }
        let mut pulled = [S::ZERO; 3];
        let ends = product.iter_mut().zip(&self.pulls).zip(columns).zip(vector);
        for (((out, [px, py, pz]), [.., ax, ay, az]), x) in ends.rev() {
            *out += dot([*ax, *ay, *az], pulled);
            pulled = add(pulled, [*px * *x, *py * *x, *pz * *x]);
        }
        product
    }

    /// What is left of 1 where no solution is nearer to the seed than where this is, which is at this distance D and from
    /// where the seed is across the curve; negative where one may be.
    ///
    /// Another solution, v away, is at a squared distance of D² + |v|² - 2 λ·r, where r is what the forward kinematics of
    /// it has beyond its linear part J v: the second-order condition of Lagrange multipliers, made one for every v up to 2 D
    /// by bounds on r. 2 λ·r is vᵀHv and a third of third derivatives between. These turn second ones by the angles of
    /// the joints; second ones are, of the position in joints i <= j, as long as column j, and of the orientation 1. The columns
    /// of joints from one on grow with the exponential of the sum of angles at most.
    pub(super) fn room(&self, columns: &[[S; 6]; N], dof: usize, distance: S) -> S {
        let joints = S::from_f64(dof as f64);
        let angles = S::TWO * joints.sqrt() * distance;
        if angles > S::from_f64(FARTHEST) {
            return -S::ONE;
        }
        // The root of the sum of squares of H: of (ωi · pj)² over i < j twice, by the sum of ωi ωiᵀ.
        let mut square = S::ZERO;
        let mut axes = [[S::ZERO; 3]; 3];
        for (pull, [.., ax, ay, az]) in self.pulls.iter().zip(columns) {
            let axis = [*ax, *ay, *az];
            let own = dot(axis, *pull);
            let [x, y, z] = axes;
            square += own * own + S::TWO * dot(*pull, [dot(x, *pull), dot(y, *pull), dot(z, *pull)]);
            for (row, a) in axes.iter_mut().zip(axis) {
                *row = add(*row, axis.map(|b| a * b));
            }
        }
        // From the last joint to the first: the greatest column from there on, and the greatest sum of a row of bounds.
        let (mut longest, mut behind, mut position) = (S::ZERO, S::ZERO, S::ZERO);
        let mut place = joints;
        for [vx, vy, vz, ..] in columns.iter().take(dof).rev() {
            longest = longest.max(norm([*vx, *vy, *vz]) * self.per_reach);
            position = position.max(place * longest + behind);
            behind += longest;
            place -= S::ONE;
        }
        let [at, turned] = self.sizes;
        let grown = S::ONE + S::TWO * angles;
        let third = (at * position * grown + turned * joints) * angles / S::from_f64(3.0);
        let room = S::ONE - third - square.sqrt();
        if room > S::ZERO { room } else { self.room_by_pivots(columns, dof, S::ONE - third) }
    }

    /// A tenth of `room`, if 9 tenths of it less H are positive definite.
    #[cold]
    #[inline(never)]
    fn room_by_pivots(&self, columns: &[[S; 6]; N], dof: usize, room: S) -> S {
        let tenth = room / S::from_f64(10.0);
        // Rows of the triangular factor, and one over their pivots.
        let mut rows = [([S::ZERO; N], S::ZERO); N];
        for (place, [.., ax, ay, az]) in columns.iter().enumerate().take(dof) {
            let Some((before, [(row, inverse), ..])) = rows.split_at_mut_checked(place) else { break };
            for (entry, pull) in row.iter_mut().zip(&self.pulls).take(dof).skip(place) {
                *entry = -dot([*ax, *ay, *az], *pull);
            }
            let Some(own) = row.get_mut(place) else { break };
            *own += room - tenth;
            for (other, inverse) in before.iter() {
                let share = other.get(place).map_or(S::ZERO, |x| *x * *inverse);
                for (entry, x) in row.iter_mut().zip(other).skip(place) {
                    *entry -= share * *x;
                }
            }
            let pivot = row.get(place).copied().unwrap_or(S::ZERO);
            if pivot.is_nan() || pivot <= S::ZERO {
                return -S::ONE;
            }
            *inverse = S::ONE / pivot;
        }
        tenth
    }
}
