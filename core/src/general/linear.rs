//! Small linear algebra of fixed size.

/// Gaussian elimination of the first columns, rows and columns both pivoted: the rows that are left when `columns`
/// pivots, or as many as are not vanishing, are taken.
pub(super) fn eliminate<const ROWS: usize, const COLUMNS: usize>(
    rows: &mut [[f64; COLUMNS]; ROWS],
    columns: usize,
) -> usize {
    let mut greatest = 0.0;
    for rank in 0..columns.min(ROWS) {
        let (mut pivot, mut at, mut column) = (0.0, rank, rank);
        for (index, row) in rows.iter().enumerate().skip(rank) {
            for (k, value) in row.iter().enumerate().take(columns).skip(rank) {
                if libm::fabs(*value) > pivot {
                    (pivot, at, column) = (libm::fabs(*value), index, k);
                }
            }
        }
        greatest = if pivot > greatest { pivot } else { greatest };
        if pivot <= greatest * VANISHING {
            return rank;
        }
        for row in rows.iter_mut() {
            swap(row, rank, column);
        }
        let Some((head, tail)) = rows.split_at_mut_checked(rank + 1) else { return rank };
        let Some(top) = head.last_mut() else { return rank };
        if let Some(other) = at.checked_sub(rank + 1).and_then(|index| tail.get_mut(index)) {
            core::mem::swap(top, other);
        }
        let Some(pivot) = top.get(rank).copied() else { return rank };
        for row in tail {
            let factor = row.get(rank).copied().unwrap_or(0.0) / pivot;
            for (value, from) in row.iter_mut().zip(top.iter()) {
                *value -= factor * from;
            }
        }
    }
    columns
}

/// A pivot this far below the greatest is what rounding leaves of 0.
const VANISHING: f64 = 1e-12;

fn swap(row: &mut [f64], i: usize, j: usize) {
    if i != j
        && let (Some(a), Some(b)) = (row.get(i).copied(), row.get(j).copied())
    {
        if let Some(place) = row.get_mut(i) {
            *place = b;
        }
        if let Some(place) = row.get_mut(j) {
            *place = a;
        }
    }
}

/// Solves `N` equations with `M` right-hand sides, `N` + `M` = `COLUMNS`, in place: the solutions are in the last
/// columns then. Returns the determinant, 0 where a pivot vanishes.
#[inline]
pub(super) fn solve<const N: usize, const COLUMNS: usize>(a: &mut [[f64; COLUMNS]; N]) -> f64 {
    let mut determinant = 1.0;
    for k in 0..N {
        for r in k + 1..N {
            if libm::fabs(a[r][k]) > libm::fabs(a[k][k]) {
                let (upper, lower) = (a[k], a[r]);
                a[k] = lower;
                a[r] = upper;
                determinant = -determinant;
            }
        }
        let pivot = a[k][k];
        determinant *= pivot;
        if pivot == 0.0 {
            return 0.0;
        }
        let top = a[k];
        for row in a.iter_mut().skip(k + 1) {
            let factor = row[k] / pivot;
            for (value, from) in row.iter_mut().zip(top).skip(k + 1) {
                *value -= factor * from;
            }
        }
    }
    for k in (0..N).rev() {
        let pivot = a[k][k];
        for value in a[k].iter_mut().skip(N) {
            *value /= pivot;
        }
        let solved = a[k];
        for row in a.iter_mut().take(k) {
            let factor = row[k];
            for (value, from) in row.iter_mut().zip(solved).skip(N) {
                *value -= factor * from;
            }
        }
    }
    determinant
}

/// The vector that is nearest to being sent to 0 by a matrix of rank 2: the greatest cross product of two rows.
pub(super) fn null_vector(rows: &[[f64; 3]; 3]) -> [f64; 3] {
    let [a, b, c] = *rows;
    let mut best = [0.0; 3];
    let mut greatest = -1.0;
    for vector in [crate::frame::cross(a, b), crate::frame::cross(b, c), crate::frame::cross(c, a)] {
        let size = crate::frame::dot(vector, vector);
        if size > greatest {
            (best, greatest) = (vector, size);
        }
    }
    best
}

/// The determinant of three rows.
pub(super) fn determinant(rows: &[[f64; 3]; 3]) -> f64 {
    let [a, b, c] = *rows;
    crate::frame::dot(a, crate::frame::cross(b, c))
}
