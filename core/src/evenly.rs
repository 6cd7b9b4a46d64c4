//! Points that fill a space evenly: places for descents to start from.

use crate::{Float, MAX_JOINTS};

/// The inverse of the positive root of x^(n+1) = x + 1, for n = 1 to [`MAX_JOINTS`]: multiples of the powers of the nth fill n
/// dimensions evenly \[Roberts 2018, The unreasonable effectiveness of quasirandom sequences\].
const RATIOS: [f64; MAX_JOINTS] = ratios();

const fn ratios() -> [f64; MAX_JOINTS] {
    let mut ratios = [0.0; MAX_JOINTS];
    let mut open = ratios.as_mut_slice();
    let mut n = 1.0;
    while let Some((ratio, others)) = open.split_first_mut() {
        *ratio = ratio_in(n);
        (open, n) = (others, n + 1.0);
    }
    ratios
}

/// The same for one n, by Newton's method on 1/x: y^n + y^(n+1) = 1 has one positive root, and is steeper beyond it.
const fn ratio_in(n: f64) -> f64 {
    let mut y = 1.0;
    let mut steps = 0;
    while steps < 64 {
        let (mut power, mut factors) = (1.0, 1.0);
        while factors < n {
            power *= y;
            factors += 1.0;
        }
        // y^(n - 1)
        y -= (power * y * (1.0 + y) - 1.0) / (power * (n + (n + 1.0) * y));
        steps += 1;
    }
    y
}

/// The point of this number of those that fill so many dimensions evenly, each coordinate in -0.5 ... 0.5.
pub(crate) fn evenly<S: Float, const N: usize>(number: u32, dimensions: usize) -> [S; N] {
    let ratio = RATIOS.get(dimensions.saturating_sub(1)).copied().unwrap_or_default();
    let mut multiple = f64::from(number);
    [(); N].map(|()| {
        multiple *= ratio;
        S::from_f64(multiple - libm::floor(multiple) - 0.5)
    })
}

#[cfg(test)]
mod tests {
    use super::RATIOS;

    #[test]
    fn ratios_are_inverse_roots() {
        let known = [0.618_033_988_749_894_9, 0.754_877_666_246_692_8, 0.819_172_513_396_164_4];
        let apart = RATIOS.iter().zip(known).map(|(ratio, known)| (ratio - known).abs());
        assert!(apart.fold(0.0, f64::max) <= f64::EPSILON);
        for (ratio, n) in RATIOS.iter().zip(1..) {
            let x = 1.0 / ratio;
            assert!((libm::pow(x, f64::from(n) + 1.0) - x - 1.0).abs() < 1e-13, "{n}: {ratio}");
        }
    }
}
