//! The angle of a point, in few operations that have nothing to wait for but one division.
//!
//! Inverse problems end in one arc tangent a joint and solution, which is most of their time with a library's function.
//! This one is the same on every host, and never more than two units in the last place from the `libm` crate's, over a
//! million points.

/// Angles are measured from those whose tangents are these; the last is never used.
const TANGENTS: [f64; 4] = [0.0, 0.5, 1.0, 0.0];

/// Up to this quotient of the smaller coordinate and the greater one an angle is measured from 0.
const FROM_ZERO: f64 = 0.25;

/// Up to this one from the arc tangent of 1/2, else from an eighth of a turn.
const FROM_HALF: f64 = 0.75;

/// (atan(sqrt z) / sqrt z - 1) / z for z in 0 ... 1/16, lowest power first: Chebyshev interpolation in 50 digits, off by
/// 3e-19 of the arc tangent.
const SERIES: [f64; 9] = [
    -0.333_333_333_333_333_3,
    0.199_999_999_999_989_33,
    -0.142_857_142_852_585_1,
    0.111_111_110_359_867_35,
    -0.090_909_028_749_694_16,
    0.076_920_178_772_373_85,
    -0.066_586_874_146_977_43,
    0.057_529_943_904_780_285,
    -0.041_034_266_985_419_496,
];

/// Whence the angle is measured, in which sense, and what its rounding leaves of it. By the quotient's range, then the
/// greater coordinate (x, y), then the sign of x; the rest is never used.
const ORIGINS: [(f64, f64, f64); 16] = {
    const HALF_TURN: (f64, f64) = (core::f64::consts::PI, 1.224_646_799_147_353_2e-16);
    const QUARTER: (f64, f64) = (core::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17);
    const EIGHTH: (f64, f64) = (core::f64::consts::FRAC_PI_4, 3.061_616_997_868_383e-17);
    const THREE_EIGHTHS: (f64, f64) = (2.356_194_490_192_345, 9.184_850_993_605_148e-17);
    const NONE: (f64, f64, f64) = (0.0, 1.0, 0.0);
    [
        (0.0, 1.0, 0.0),
        (0.463_647_609_000_806_1, 1.0, 2.269_877_745_296_168_7e-17),
        (EIGHTH.0, 1.0, EIGHTH.1),
        NONE,
        (QUARTER.0, -1.0, QUARTER.1),
        (1.107_148_717_794_090_4, -1.0, 9.404_471_373_566_38e-17),
        (EIGHTH.0, -1.0, EIGHTH.1),
        NONE,
        (HALF_TURN.0, -1.0, HALF_TURN.1),
        (2.677_945_044_588_987, -1.0, 1.552_770_536_930_314_7e-16),
        (THREE_EIGHTHS.0, -1.0, THREE_EIGHTHS.1),
        NONE,
        (QUARTER.0, 1.0, QUARTER.1),
        (2.034_443_935_795_703, 1.0, 2.841_996_617_907_152e-17),
        (THREE_EIGHTHS.0, 1.0, THREE_EIGHTHS.1),
        NONE,
    ]
};

/// The angle (rad) of the point (x, y), in \[-pi, pi\].
#[inline]
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    let (ay, ax) = (y.abs(), x.abs());
    let (less, greater) = if ay > ax { (ax, ay) } else { (ay, ax) };
    if !(greater > 1e-290 && greater < 1e290) {
        // Zeros, infinities, what is no number, and what would over- or underflow.
        return libm::atan2(y, x);
    }
    // Choices are places in tables: which of them is taken cannot be foreseen.
    let range = usize::from(less >= FROM_ZERO * greater) + usize::from(less >= FROM_HALF * greater);
    let place = range + 4 * usize::from(ay > ax) + 8 * usize::from(x.is_sign_negative());
    let origin = TANGENTS[range & 3];
    // The tangent of the difference; its numerator is exact.
    let r = (less - origin * greater) / (greater + origin * less);
    let z = r * r;
    let [s0, s1, s2, s3, s4, s5, s6, s7, s8] = SERIES;
    let z2 = z * z;
    let z4 = z2 * z2;
    let low = (s0 + s1 * z) + (s2 + s3 * z) * z2;
    let high = (s4 + s5 * z) + (s6 + s7 * z) * z2;
    let series = low + (high + s8 * z4) * z4;
    let (angle, sense, rest) = ORIGINS[place & 15];
    let turned = sense * r;
    (angle + (turned + (turned * (z * series) + rest))).copysign(y)
}

#[cfg(test)]
mod tests {
    use super::atan2;

    /// The difference in units of the last place of the result.
    fn off(y: f64, x: f64) -> f64 {
        let (own, wanted) = (atan2(y, x), libm::atan2(y, x));
        let unit = f64::from_bits(wanted.abs().to_bits() + 1) - wanted.abs();
        ((own - wanted) / unit).abs()
    }

    /// The library's function is within 1 unit of the truth.
    #[test]
    fn angles_are_those_of_the_library_to_the_last_digits() {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        let mut random = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let mut worst: f64 = 0.0;
        for _ in 0..400_000 {
            let (x, y, scale) = (random(), random(), random());
            worst = worst.max(off(y, x));
            worst = worst.max(off(y * libm::exp2(60.0 * scale), x));
            worst = worst.max(off(libm::sin(3.2 * x), libm::cos(3.2 * x)));
        }
        assert!(worst <= 2.0, "{worst}");
    }

    #[test]
    fn axes_and_eighths_are_exact_and_special_values_the_librarys() {
        let values =
            [0.0, -0.0, 1.0, -1.0, 0.5, -2.0, 1e-300, -1e300, 1e-320, f64::MIN_POSITIVE, f64::INFINITY];
        for y in values {
            for x in values {
                assert!(off(y, x) <= 1.0 || atan2(y, x) == libm::atan2(y, x), "{y} {x}");
                assert_eq!(atan2(y, x).is_sign_negative(), libm::atan2(y, x).is_sign_negative(), "{y} {x}");
            }
            assert_eq!(atan2(y, 0.0).to_bits(), libm::atan2(y, 0.0).to_bits());
            assert_eq!(atan2(0.0, y).to_bits(), libm::atan2(0.0, y).to_bits());
            assert_eq!(atan2(y, y).to_bits(), libm::atan2(y, y).to_bits());
            assert!(atan2(y, f64::NAN).is_nan() && atan2(f64::NAN, y).is_nan());
        }
    }
}
