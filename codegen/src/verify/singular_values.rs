//! Singular values of a small matrix given by its columns.

/// Sweeps after which the columns of any matrix of this size are orthogonal to rounding.
const MAX_SWEEPS: usize = 30;

/// The smallest singular value of the matrix with these columns (all of one length). 0 for a matrix with more columns
/// than rows, whose columns cannot be independent; infinite for one without columns.
pub(super) fn smallest(columns: Vec<Vec<f64>>) -> f64 {
    singular_values(columns).last().copied().unwrap_or(f64::INFINITY)
}

/// The singular values of the matrix with these columns (all of one length), one a column, greatest first: one-sided
/// Jacobi, which keeps small values accurate where the eigenvalues of the squared matrix would lose half the digits.
pub fn singular_values(mut columns: Vec<Vec<f64>>) -> Vec<f64> {
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for right in 1..columns.len() {
            let (head, tail) = columns.split_at_mut(right);
            let Some(second) = tail.first_mut() else {
                break;
            };
            for first in head {
                rotated |= orthogonalise(first, second);
            }
        }
        if !rotated {
            break;
        }
    }
    let mut values: Vec<f64> = columns.iter().map(|column| dot(column, column).sqrt()).collect();
    values.sort_by(|one, other| other.total_cmp(one));
    values
}

/// Rotates two columns in their plane until they are orthogonal; false where they already are.
fn orthogonalise(first: &mut [f64], second: &mut [f64]) -> bool {
    let (p, q, r) = (dot(first, first), dot(second, second), dot(first, second));
    if r == 0.0 || r.abs() <= f64::EPSILON * (p * q).sqrt() {
        return false;
    }
    let half = (q - p) / (2.0 * r);
    let tangent = half.signum() / (half.abs() + half.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = cosine * tangent;
    for (x, y) in first.iter_mut().zip(second.iter_mut()) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
    true
}

fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::smallest;

    #[test]
    fn of_known_matrices() {
        assert!((smallest(vec![vec![3.0, 0.0, 0.0], vec![0.0, 2.0, 0.0]]) - 2.0).abs() < 1e-15);
        // [[1, 1], [0, e]]: the product of the values is e, their squares sum to 2 + e^2.
        let small = smallest(vec![vec![1.0, 0.0], vec![1.0, 1e-9]]);
        assert!((small / (1e-9 / 2.0_f64.sqrt()) - 1.0).abs() < 1e-6, "{small}");
        assert!(smallest(vec![vec![1.0, 2.0], vec![2.0, 4.0]]) < 1e-15);
        assert!(smallest(vec![vec![1.0, 0.0], vec![0.0, 1.0], vec![1.0, 1.0]]) < 1e-15);
        assert!(smallest(Vec::new()).is_infinite());
    }
}
