//! What undoes the six rows of a Jacobian with more columns than that, and the direction that they leave.

use crate::Float;

/// A row of the Jacobian (in reaches and rad) that others leave less than this of says nothing.
const VANISHING: f64 = 1e-9;

/// What undoes six rows: the columns of their pseudo-inverse.
pub(super) struct PseudoInverse<const N: usize, S> {
    columns: [[S; N]; 6],
    /// Whether every row is more than what others leave of it by rounding.
    pub(super) independent: bool,
}

impl<const N: usize, S: Float> PseudoInverse<N, S> {
    /// The rows are a triangular matrix, whose diagonal is 1, times orthogonal rows, by modified Gram-Schmidt. Every row is
    /// taken out of all that follow at once: products that do not wait for each other. Besides, the direction across all
    /// rows, over so many joints.
    #[inline]
    pub(super) fn of(rows: [[S; N]; 6], dof: usize) -> (Self, [S; N]) {
        let [r1, mut r2, mut r3, mut r4, mut r5, mut r6] = rows;
        let i1 = over(&r1);
        let [l21, l31, l41, l51, l61] = clear(&r1, i1, [&mut r2, &mut r3, &mut r4, &mut r5, &mut r6]);
        let i2 = over(&r2);
        let [l32, l42, l52, l62] = clear(&r2, i2, [&mut r3, &mut r4, &mut r5, &mut r6]);
        let i3 = over(&r3);
        let [l43, l53, l63] = clear(&r3, i3, [&mut r4, &mut r5, &mut r6]);
        let i4 = over(&r4);
        let [l54, l64] = clear(&r4, i4, [&mut r5, &mut r6]);
        let i5 = over(&r5);
        let [l65] = clear(&r5, i5, [&mut r6]);
        let i6 = over(&r6);
        let inverses = [i1, i2, i3, i4, i5, i6];
        let rows = [r1, r2, r3, r4, r5, r6];
        let tangent = across(&rows, &inverses, dof);
        let [r1, r2, r3, r4, r5, r6] = rows;
        let c6 = less(&r6, i6, []);
        let c5 = less(&r5, i5, [(l65, &c6)]);
        let c4 = less(&r4, i4, [(l54, &c5), (l64, &c6)]);
        let c3 = less(&r3, i3, [(l43, &c4), (l53, &c5), (l63, &c6)]);
        let c2 = less(&r2, i2, [(l32, &c3), (l42, &c4), (l52, &c5), (l62, &c6)]);
        let c1 = less(&r1, i1, [(l21, &c2), (l31, &c3), (l41, &c4), (l51, &c5), (l61, &c6)]);
        let independent = inverses.iter().all(|inverse| *inverse > S::ZERO);
        (Self { columns: [c1, c2, c3, c4, c5, c6], independent }, tangent)
    }

    /// The least unknowns that give these right sides.
    pub(super) fn least(&self, sides: &[S; 6]) -> [S; N] {
        let mut unknowns = [S::ZERO; N];
        self.columns.iter().zip(sides).for_each(|(column, side)| add(&mut unknowns, column, *side));
        unknowns
    }

    /// How much of each row a vector is, but for what is across all of them.
    pub(super) fn multipliers(&self, vector: &[S; N]) -> [S; 6] {
        let [c1, c2, c3, c4, c5, c6] = &self.columns;
        [dot(c1, vector), dot(c2, vector), dot(c3, vector), dot(c4, vector), dot(c5, vector), dot(c6, vector)]
    }
}

/// One over the square of a row's length; 0 where it vanishes.
#[inline]
fn over<const N: usize, S: Float>(row: &[S; N]) -> S {
    let square = dot(row, row);
    if square > S::from_f64(VANISHING * VANISHING) { S::ONE / square } else { S::ZERO }
}

/// Takes out of others what they have of a row, and says how much.
#[inline]
fn clear<const N: usize, const K: usize, S: Float>(
    row: &[S; N],
    inverse: S,
    others: [&mut [S; N]; K],
) -> [S; K] {
    let mut shares = [S::ZERO; K];
    for (other, share) in others.into_iter().zip(&mut shares) {
        *share = dot(other, row) * inverse;
        add(other, row, -*share);
    }
    shares
}

/// A row times a factor, less shares of others.
#[inline]
fn less<const N: usize, const K: usize, S: Float>(
    row: &[S; N],
    factor: S,
    others: [(S, &[S; N]); K],
) -> [S; N] {
    let mut rest = [S::ZERO; N];
    add(&mut rest, row, factor);
    for (share, other) in others {
        add(&mut rest, other, -share);
    }
    rest
}

/// The direction across orthogonal rows: what they leave of the joint that takes the least part in them, which is so much
/// that nothing is lost.
#[inline]
fn across<const N: usize, S: Float>(rows: &[[S; N]; 6], inverses: &[S; 6], dof: usize) -> [S; N] {
    let mut parts = [S::ZERO; N];
    for (row, inverse) in rows.iter().zip(inverses) {
        parts.iter_mut().zip(row).for_each(|(part, x)| *part += *x * *x * *inverse);
    }
    let mut least = (0, S::INFINITY);
    for (joint, part) in parts.iter().enumerate().take(dof) {
        if *part < least.1 {
            least = (joint, *part);
        }
    }
    let mut tangent = [S::ZERO; N];
    if let Some(slot) = tangent.get_mut(least.0) {
        *slot = S::ONE;
    }
    for (row, inverse) in rows.iter().zip(inverses) {
        let share = row.get(least.0).copied().unwrap_or(S::ZERO) * *inverse;
        add(&mut tangent, row, -share);
    }
    let inverse = S::ONE / dot(&tangent, &tangent).sqrt();
    tangent.map(|x| x * inverse)
}

/// In four sums, which do not wait for each other.
pub(super) fn dot<const N: usize, S: Float>(a: &[S; N], b: &[S; N]) -> S {
    let (a, a_rest) = a.as_chunks::<4>();
    let (b, b_rest) = b.as_chunks::<4>();
    let mut sums = [S::ZERO; 4];
    for ([a1, a2, a3, a4], [b1, b2, b3, b4]) in a.iter().zip(b) {
        let [s1, s2, s3, s4] = sums;
        sums = [s1 + *a1 * *b1, s2 + *a2 * *b2, s3 + *a3 * *b3, s4 + *a4 * *b4];
    }
    for (sum, (a, b)) in sums.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *sum += *a * *b;
    }
    let [s1, s2, s3, s4] = sums;
    (s1 + s3) + (s2 + s4)
}

/// a += factor * b
pub(super) fn add<const N: usize, S: Float>(a: &mut [S; N], b: &[S; N], factor: S) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * *b);
}
