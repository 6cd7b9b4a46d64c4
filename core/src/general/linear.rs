//! Small linear algebra of fixed size.

/// Gaussian elimination of the first columns, rows and columns both pivoted: the rows that are left when `columns`
/// pivots, or as many as are not vanishing, are taken. Also says how small the last pivot was beside the greatest.
pub(super) fn eliminate<const ROWS: usize, const COLUMNS: usize>(
    rows: &mut [[f64; COLUMNS]; ROWS],
    columns: usize,
) -> (usize, f64) {
    let (mut greatest, mut ratio) = (0.0, 1.0);
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
        ratio = pivot / greatest;
        if ratio <= VANISHING || ratio.is_nan() {
            return (rank, 0.0);
        }
        for row in rows.iter_mut() {
            swap(row, rank, column);
        }
        let Some((head, tail)) = rows.split_at_mut_checked(rank + 1) else { return (rank, 0.0) };
        let Some(top) = head.last_mut() else { return (rank, 0.0) };
        if let Some(other) = at.checked_sub(rank + 1).and_then(|index| tail.get_mut(index)) {
            core::mem::swap(top, other);
        }
        let Some(pivot) = top.get(rank).copied() else { return (rank, 0.0) };
        for row in tail {
            let factor = row.get(rank).copied().unwrap_or(0.0) / pivot;
            for (value, from) in row.iter_mut().zip(top.iter()) {
                *value -= factor * from;
            }
        }
    }
    (columns, ratio)
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
pub(crate) fn solve<const N: usize, const COLUMNS: usize>(a: &mut [[f64; COLUMNS]; N]) -> f64 {
    let mut determinant = 1.0;
    let mut inverses = [0.0; N];
    for k in 0..N {
        let (mut at, mut greatest) = (k, libm::fabs(a[k][k]));
        for (r, row) in a.iter().enumerate().skip(k + 1) {
            let size = libm::fabs(row[k]);
            if size > greatest {
                (at, greatest) = (r, size);
            }
        }
        let upper = a[k];
        if let Some(other) = a.get_mut(at).filter(|_| at != k) {
            let lower = *other;
            *other = upper;
            a[k] = lower;
            determinant = -determinant;
        }
        let pivot = a[k][k];
        determinant *= pivot;
        if pivot == 0.0 {
            return 0.0;
        }
        let inverse = 1.0 / pivot;
        inverses[k] = inverse;
        let top = a[k];
        for row in a.iter_mut().skip(k + 1) {
            let factor = row[k] * inverse;
            // All columns, for the sake of vector instructions: those up to here are not looked at any more.
            for (value, from) in row.iter_mut().zip(top) {
                *value -= factor * from;
            }
        }
    }
    for k in (0..N).rev() {
        for value in a[k].iter_mut().skip(N) {
            *value *= inverses[k];
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

/// The determinant of three rows.
pub(super) fn determinant(rows: &[[f64; 3]; 3]) -> f64 {
    let [a, b, c] = *rows;
    crate::frame::dot(a, crate::frame::cross(b, c))
}
