//! Smooth curves through points of any dimension.

/// A cubic spline: through all its points, with two continuous derivatives. The slopes at its ends are those of the
/// polynomial through the points nearest to them.
#[derive(Debug, Clone)]
pub(super) struct Spline {
    /// Ascending.
    knots: Vec<f64>,
    /// One a knot.
    values: Vec<Vec<f64>>,
    /// First derivatives, one a knot.
    slopes: Vec<Vec<f64>>,
}

/// A point of a spline with its first three derivatives.
#[derive(Debug, Clone, Default)]
pub(super) struct Derivatives {
    pub(super) value: Vec<f64>,
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
    pub(super) third: Vec<f64>,
}

/// So many points give the slope at an end: a polynomial of degree 4.
const END_POINTS: usize = 5;

impl Spline {
    /// Through `values` at `knots`; `None` unless there are two at least, as many of one as of the other, and the knots
    /// ascend.
    pub(super) fn through(knots: Vec<f64>, values: Vec<Vec<f64>>) -> Option<Self> {
        let ascending = knots.windows(2).all(|pair| matches!(pair, [a, b] if a < b));
        let width = values.first()?.len();
        if knots.len() < 2 || knots.len() != values.len() || !ascending {
            return None;
        }
        if values.iter().any(|value| value.len() != width) {
            return None;
        }
        let mut slopes = vec![Vec::with_capacity(width); knots.len()];
        for column in 0..width {
            let values: Vec<f64> = values.iter().filter_map(|value| value.get(column).copied()).collect();
            for (slopes, slope) in slopes.iter_mut().zip(slopes_of(&knots, &values)) {
                slopes.push(slope);
            }
        }
        Some(Self { knots, values, slopes })
    }

    /// The first knot.
    pub(super) fn start(&self) -> f64 {
        self.knots.first().copied().unwrap_or(0.0)
    }

    /// The last knot.
    pub(super) fn end(&self) -> f64 {
        self.knots.last().copied().unwrap_or(0.0)
    }

    /// The knots.
    pub(super) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The values at the knots.
    pub(super) fn values(&self) -> &[Vec<f64>] {
        &self.values
    }

    /// The point at a place between the first and the last knot; beyond them, at the nearest of both.
    pub(super) fn at(&self, place: f64) -> Derivatives {
        let place = place.max(self.start()).min(self.end());
        let after = self.knots.partition_point(|knot| *knot <= place).clamp(1, self.knots.len().max(2) - 1);
        let pair = |list: &[Vec<f64>]| -> Option<(Vec<f64>, Vec<f64>)> {
            Some((list.get(after - 1)?.clone(), list.get(after)?.clone()))
        };
        let (Some(left), Some(right)) = (self.knots.get(after - 1), self.knots.get(after)) else {
            return Derivatives::default();
        };
        let (Some((p0, p1)), Some((m0, m1))) = (pair(&self.values), pair(&self.slopes)) else {
            return Derivatives::default();
        };
        let (h, x) = (right - left, place - left);
        let mut out = Derivatives::default();
        for ((p0, p1), (m0, m1)) in p0.iter().zip(&p1).zip(m0.iter().zip(&m1)) {
            // p0 + m0 x + c x^2 + d x^3 with the values and slopes of both ends.
            let mean = (p1 - p0) / h;
            let c = (3.0 * mean - 2.0 * m0 - m1) / h;
            let d = (m0 + m1 - 2.0 * mean) / (h * h);
            out.value.push(if place >= *right { *p1 } else { p0 + x * (m0 + x * (c + x * d)) });
            out.first.push(m0 + x * (2.0 * c + 3.0 * x * d));
            out.second.push(2.0 * c + 6.0 * x * d);
            out.third.push(6.0 * d);
        }
        out
    }
}

/// The slopes of one coordinate: those that make the second derivative continuous, which is a tridiagonal system.
fn slopes_of(knots: &[f64], values: &[f64]) -> Vec<f64> {
    let count = knots.len();
    let take = END_POINTS.min(count);
    let first = end_slope(knots.iter().take(take), values.iter().take(take));
    let last = end_slope(knots.iter().rev().take(take), values.iter().rev().take(take));
    // Thomas's algorithm: after the sweep, slope[i] = right[i] - ratio[i] slope[i + 1].
    let (mut ratios, mut rights) = (vec![0.0], vec![first]);
    for (knots, values) in knots.windows(3).zip(values.windows(3)) {
        let ([k0, k1, k2], [v0, v1, v2]) = (knots, values) else {
            break;
        };
        let (before, after) = (k1 - k0, k2 - k1);
        let right = 3.0 * (after * (v1 - v0) / before + before * (v2 - v1) / after);
        let (ratio, above) = (ratios.last().copied().unwrap_or(0.0), rights.last().copied().unwrap_or(0.0));
        let pivot = 2.0 * (before + after) - after * ratio;
        ratios.push(before / pivot);
        rights.push((right - after * above) / pivot);
    }
    let mut slopes = vec![last];
    for (ratio, right) in ratios.iter().zip(&rights).rev() {
        let next = slopes.last().copied().unwrap_or(last);
        slopes.push(right - ratio * next);
    }
    slopes.reverse();
    slopes
}

/// The slope at the first of these points of the polynomial through all of them (Newton's divided differences).
fn end_slope<'a>(knots: impl Iterator<Item = &'a f64>, values: impl Iterator<Item = &'a f64>) -> f64 {
    let knots: Vec<f64> = knots.copied().collect();
    let mut differences: Vec<f64> = values.copied().collect();
    let (mut slope, mut factor) = (0.0, 1.0);
    for order in 1..knots.len() {
        let next = differences.windows(2).zip(knots.iter().zip(knots.iter().skip(order)));
        differences = next
            .filter_map(|(pair, (left, right))| match pair {
                [a, b] => Some((b - a) / (right - left)),
                _ => None,
            })
            .collect();
        slope += factor * differences.first().copied().unwrap_or(0.0);
        if let (Some(first), Some(knot)) = (knots.first(), knots.get(order)) {
            factor *= first - knot;
        }
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::Spline;

    #[test]
    fn a_cubic_is_reproduced_with_its_derivatives() {
        let f = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x + 0.25 * x.powi(3);
        let knots = vec![-1.0, -0.7, 0.1, 0.2, 0.9, 2.0];
        let values = knots.iter().map(|x| vec![f(*x), -f(*x)]).collect();
        let spline = Spline::through(knots, values).unwrap();
        for step in 0..=300 {
            let x = -1.0 + 0.01 * f64::from(step);
            let at = spline.at(x);
            assert!((at.value[0] - f(x)).abs() < 1e-12 && (at.value[1] + f(x)).abs() < 1e-12, "{x}");
            assert!((at.first[0] - (-2.0 + x + 0.75 * x * x)).abs() < 1e-11, "{x}");
            assert!((at.second[0] - (1.0 + 1.5 * x)).abs() < 1e-10, "{x}");
            assert!((at.third[0] - 1.5).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn it_goes_through_its_points_with_two_continuous_derivatives() {
        let knots: Vec<f64> = [0.0, 0.3, 0.4, 1.0, 1.7, 1.8, 2.5].to_vec();
        let values: Vec<Vec<f64>> = knots.iter().map(|x| vec![(3.0 * x).sin()]).collect();
        let spline = Spline::through(knots.clone(), values.clone()).unwrap();
        for (knot, value) in knots.iter().zip(&values) {
            let (before, after) = (spline.at(knot - 1e-9), spline.at(knot + 1e-9));
            assert!((spline.at(*knot).value[0] - value[0]).abs() < 1e-12);
            assert!((before.first[0] - after.first[0]).abs() < 1e-6);
            assert!((before.second[0] - after.second[0]).abs() < 1e-6);
        }
    }

    #[test]
    fn its_error_falls_with_the_fourth_power_of_the_spacing() {
        let error = |count: u32| {
            let knots: Vec<f64> = (0..=count).map(|i| f64::from(i) / f64::from(count)).collect();
            let values = knots.iter().map(|x| vec![(4.0 * x).exp()]).collect();
            let spline = Spline::through(knots, values).unwrap();
            (0..1000)
                .map(|i| f64::from(i) / 999.0)
                .fold(0.0, |worst: f64, x| worst.max((spline.at(x).value[0] - (4.0 * x).exp()).abs()))
        };
        let ratio = error(20) / error(40);
        assert!(ratio > 12.0, "{ratio}");
    }

    #[test]
    fn what_is_no_curve_is_none() {
        assert!(Spline::through(vec![0.0], vec![vec![1.0]]).is_none());
        assert!(Spline::through(vec![0.0, 0.0], vec![vec![1.0], vec![2.0]]).is_none());
        assert!(Spline::through(vec![0.0, 1.0], vec![vec![1.0]]).is_none());
        assert!(Spline::through(vec![0.0, 1.0], vec![vec![1.0], vec![]]).is_none());
    }
}
