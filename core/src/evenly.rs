//! Points that fill a space evenly: places for descents to start from.

use crate::Float;
use crate::unknowns::UNKNOWNS;

/// The inverses of the roots of x^(n+1) = x + 1: multiples of the powers of the nth fill n dimensions evenly \[Roberts 2018,
/// The unreasonable effectiveness of quasirandom sequences\].
const RATIOS: [f64; UNKNOWNS] = [
    0.618_033_988_749_894_9,
    0.754_877_666_246_692_8,
    0.819_172_513_396_164_4,
    0.856_674_883_854_502_9,
    0.881_271_523_466_977_5,
    0.898_653_712_628_699_3,
];

/// The point of this number of those that fill so many dimensions evenly, each coordinate in -0.5 ... 0.5.
pub(crate) fn evenly<S: Float>(number: u32, dimensions: usize) -> [S; UNKNOWNS] {
    let ratio = RATIOS.get(dimensions.saturating_sub(1)).copied().unwrap_or_default();
    let mut multiple = f64::from(number);
    [(); UNKNOWNS].map(|()| {
        multiple *= ratio;
        S::from_f64(multiple - libm::floor(multiple) - 0.5)
    })
}
