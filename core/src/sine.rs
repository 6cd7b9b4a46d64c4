//! Sine and cosine of an angle at once, in operations that none of them decides: which quarter turn an angle is in cannot be
//! foreseen, and a branch that is guessed wrong takes as long as a polynomial.
//!
//! The same on every host, and never more than one unit in the last place from the `libm` crate's, over a million angles.

/// Up to here (rad) quarter turns are taken away here, beyond it by the library.
const MOST: f64 = 1e3;

/// Below it the library looks after what underflows and after the sign of 0.
const LEAST: f64 = 1e-20;

/// Added to a number and taken away again it leaves the nearest whole number; the sum's last bits are that number.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// A quarter turn in three parts, of which the first two have 33 bits: their products with whole numbers of up to 20 bits are
/// exact \[Cody and Waite 1980\].
const QUARTER: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// (sin(sqrt z) / sqrt z - 1) / z for z up to the square of an eighth of a turn, lowest power first: Chebyshev interpolation
/// in 60 digits; the sine is off by 1.6e-17.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_66,
    0.008_333_333_333_330_918,
    -0.000_198_412_698_367_124_95,
    2.755_731_607_868_067e-6,
    -2.505_112_687_608_533_8e-8,
    1.591_777_175_934_191_7e-10,
];

/// (cos(sqrt z) - 1 + z / 2) / z²; the cosine is off by 9e-19.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_737_8,
    2.480_158_729_873_686_3e-5,
    -2.755_731_725_679_604e-7,
    2.087_614_315_990_944e-9,
    -1.138_240_875_415_325_4e-11,
];

/// Sine and cosine of an angle (rad).
#[inline]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    let size = x.abs();
    if !(size > LEAST && size < MOST) {
        return libm::sincos(x);
    }
    near(x)
}

/// Of several angles (rad) at once. No operation depends on an angle, so that compilers do two or more of them with every
/// instruction; the numbers are those of [`sin_cos`].
#[inline]
pub(crate) fn all<const K: usize>(angles: [f64; K]) -> [(f64, f64); K] {
    let inside = angles.iter().fold(true, |inside, x| inside & (x.abs() > LEAST) & (x.abs() < MOST));
    if !inside {
        return angles.map(sin_cos);
    }
    let (mut sines, mut cosines) = ([0.0; K], [0.0; K]);
    for ((sine, cosine), x) in sines.iter_mut().zip(&mut cosines).zip(angles) {
        (*sine, *cosine) = near(x);
    }
    core::array::from_fn(|k| (sines[k], cosines[k]))
}

/// Of an angle (rad) for which the library is not needed.
#[inline(always)]
#[allow(clippy::inline_always, reason = "a loop over calls is not one over vectors")]
fn near(x: f64) -> (f64, f64) {
    let sum = x * core::f64::consts::FRAC_2_PI + WHOLE;
    let (place, quarters) = (sum.to_bits(), sum - WHOLE);
    // What is left of the angle, and what rounding leaves of that.
    let [first, second, third] = QUARTER;
    let rest = x - quarters * first;
    let less = quarters * second;
    let shorter = rest - less;
    let less = quarters * third - ((rest - shorter) - less);
    let y = shorter - less;
    let tail = (shorter - y) - less;
    let z = y * y;
    let z2 = z * z;
    let polynomial =
        |[a, b, c, d, e, f]: [f64; 6]| ((a + b * z) + (c + d * z) * z2) + (e + f * z) * (z2 * z2);
    let half = 0.5 * z;
    let sine = y + (y * (z * polynomial(SINE)) + tail * (1.0 - half));
    let whole = 1.0 - half;
    let cosine = whole + (((1.0 - whole) - half) + (z2 * polynomial(COSINE) - y * tail));
    // Every quarter turn changes the two over, and every second one their signs.
    let (sine, cosine) = (sine.to_bits(), cosine.to_bits());
    let other = (sine ^ cosine) & 0_u64.wrapping_sub(place & 1);
    let sine = sine ^ other ^ ((place & 2) << 62);
    let cosine = cosine ^ other ^ ((place.wrapping_add(1) & 2) << 62);
    (f64::from_bits(sine), f64::from_bits(cosine))
}

#[cfg(test)]
mod tests {
    use super::{all, sin_cos};
    use core::f64::consts::FRAC_PI_2;

    /// The greatest difference in units of the last place.
    fn off(x: f64) -> f64 {
        let (own, wanted) = (sin_cos(x), libm::sincos(x));
        let units = |own: f64, wanted: f64| {
            let unit = f64::from_bits(wanted.abs().to_bits() + 1) - wanted.abs();
            ((own - wanted) / unit).abs()
        };
        units(own.0, wanted.0).max(units(own.1, wanted.1))
    }

    /// The library's functions are within 1 unit of the truth.
    #[test]
    fn sines_are_those_of_the_library_to_the_last_digit() {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let mut worst: f64 = 0.0;
        for _ in 0..300_000 {
            let (x, scale) = (random(), random());
            for angle in [4.0 * x, 1e3 * x, x * libm::exp2(60.0 * scale)] {
                worst = worst.max(off(angle));
            }
        }
        assert!(worst <= 1.0, "{worst}");
    }

    #[test]
    fn quarter_turns_keep_their_last_digits_and_special_values_are_the_librarys() {
        for quarter in -600..=600 {
            let angle = f64::from(quarter) * FRAC_PI_2;
            for bits in -3_i64..=3 {
                let near = f64::from_bits(angle.to_bits().wrapping_add_signed(bits));
                assert!(near.is_nan() || off(near) <= 1.0, "{near:e}");
            }
        }
        for x in [0.0, -0.0, 1e-300, -1e-25, f64::MIN_POSITIVE, 1e3, -1e22] {
            let (own, wanted) = (sin_cos(x), libm::sincos(x));
            assert_eq!([own.0, own.1].map(f64::to_bits), [wanted.0, wanted.1].map(f64::to_bits), "{x}");
        }
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(sin_cos(x).0.is_nan() && sin_cos(x).1.is_nan());
        }
    }

    #[test]
    fn sines_of_several_angles_are_those_of_each() {
        for angles in [[0.3, -2.0, 3.1, 1e-9, 700.0], [0.3, -2.0, 0.0, 1e4, f64::NAN]] {
            let each = angles.map(sin_cos).map(|(sine, cosine)| [sine.to_bits(), cosine.to_bits()]);
            assert_eq!(all(angles).map(|(sine, cosine)| [sine.to_bits(), cosine.to_bits()]), each);
        }
    }
}
