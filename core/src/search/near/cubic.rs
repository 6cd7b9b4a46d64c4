//! Cubics by their values and slopes at both ends of an interval.

use crate::Float;

/// The least of a cubic is known to this many bits.
const BISECTED: u32 = 40;

/// The cubic with these values and slopes at 0 and 1.
fn cubic<S: Float>([a, b]: [S; 2], [da, db]: [S; 2], x: S) -> (S, S) {
    let (three, bend) = (S::from_f64(3.0), b - a);
    let second = three * bend - S::TWO * da - db;
    let third = da + db - S::TWO * bend;
    (a + x * (da + x * (second + x * third)), da + x * (S::TWO * second + x * three * third))
}

/// The root between 0 and 1 of a cubic that has opposite signs there.
pub(super) fn root<S: Float>(ends: [S; 2], slopes: [S; 2]) -> S {
    let (mut low, mut high) = (S::ZERO, S::ONE);
    let mut x = ends[0].abs() / (ends[0].abs() + ends[1].abs());
    for _ in 0..8 {
        let (value, slope) = cubic(ends, slopes, x);
        if (value < S::ZERO) == (ends[0] < S::ZERO) {
            low = x;
        } else {
            high = x;
        }
        let to = x - value / slope;
        x = if to >= low && to <= high { to } else { (low + high) / S::TWO };
    }
    x
}

/// Where a cubic that has one sign at 0 and 1 comes nearest to 0 between them, and its value there times that sign; `None`
/// where that is at an end.
pub(super) fn lowest<S: Float>(ends: [S; 2], slopes: [S; 2]) -> Option<(S, S)> {
    let sign = if ends[0] < S::ZERO { -S::ONE } else { S::ONE };
    if !(slopes[0] * sign < S::ZERO && slopes[1] * sign > S::ZERO) {
        return None;
    }
    let (mut low, mut high) = (S::ZERO, S::ONE);
    for _ in 0..BISECTED {
        let x = (low + high) / S::TWO;
        if cubic(ends, slopes, x).1 * sign < S::ZERO {
            low = x;
        } else {
            high = x;
        }
    }
    let x = (low + high) / S::TWO;
    Some((x, cubic(ends, slopes, x).0 * sign))
}

#[cfg(test)]
mod tests {
    use super::{cubic, lowest, root};

    #[test]
    fn cubics_are_solved() {
        // x^2 - 1/4 and 1 - 3 x + 3 x^2
        let (ends, slopes) = ([-0.25, 0.75], [0.0, 2.0]);
        assert!((root(ends, slopes) - 0.5_f64).abs() < 1e-3);
        assert!((cubic(ends, slopes, 0.3).0 - (0.09 - 0.25_f64)).abs() < 1e-12);
        let (share, least) = lowest([1.0, 1.0], [-3.0, 3.0]).expect("it has a least value");
        assert!((share - 0.5_f64).abs() < 1e-2 && (least - 0.25_f64).abs() < 1e-3);
        assert!(lowest([1.0, 2.0], [0.5, 0.5]).is_none());
    }
}
