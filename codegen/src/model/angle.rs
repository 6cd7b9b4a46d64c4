//! Angles that know when they are multiples of 15 degrees.

use super::Angle;
use core::f64::consts::{FRAC_PI_2, PI};

/// How near a multiple of 15 degrees an angle must be to count as one (rad).
pub const EXACT_ANGLE_TOLERANCE: f64 = 1e-12;

/// 15 degrees (rad).
const FIFTEENTH: f64 = PI / 12.0;

/// Beyond this an f64 resolves no multiples of 15 degrees to within the tolerance (rad).
const LARGEST_EXACT: f64 = 4096.0;

/// sin 15 degrees = (sqrt 6 - sqrt 2) / 4.
const SIN_15: f64 = 0.258_819_045_102_520_74;
/// sin 45 degrees.
const SIN_45: f64 = core::f64::consts::FRAC_1_SQRT_2;
/// sin 60 degrees.
const SIN_60: f64 = 0.866_025_403_784_438_6;
/// sin 75 degrees = (sqrt 6 + sqrt 2) / 4.
const SIN_75: f64 = 0.965_925_826_289_068_3;

impl Angle {
    /// No turn.
    pub const ZERO: Angle = Angle { value: 0.0, fifteenths: Some(0) };

    /// From radians.
    pub fn from_radians(value: f64) -> Angle {
        if value.abs() <= LARGEST_EXACT {
            let nearest = libm::round(value / FIFTEENTH);
            if (value - nearest * FIFTEENTH).abs() <= EXACT_ANGLE_TOLERANCE {
                return Angle::from_fifteenths(nearest as i32);
            }
        }
        Angle { value, fifteenths: None }
    }

    /// From degrees. Multiples of 15 are found in degrees, where they are exact.
    pub fn from_degrees(degrees: f64) -> Angle {
        let nearest = libm::round(degrees / 15.0);
        let exact = degrees.abs() <= LARGEST_EXACT && degrees == nearest * 15.0;
        if exact { Angle::from_fifteenths(nearest as i32) } else { Angle::from_radians(degrees / 180.0 * PI) }
    }

    /// A multiple of 15 degrees.
    pub fn from_fifteenths(count: i32) -> Angle {
        // One rounding where the multiple is one of a half turn's simple fractions, two elsewhere.
        let value =
            if count % 6 == 0 { f64::from(count / 6) * FRAC_PI_2 } else { f64::from(count) * PI / 12.0 };
        Angle { value, fifteenths: Some(count) }
    }

    /// Whether the turn is exactly zero.
    pub fn is_zero(&self) -> bool {
        self.fifteenths == Some(0) || self.value == 0.0
    }

    /// Sine and cosine: of the exact multiple where the angle is one, so that 90 degrees has the cosine 0.
    pub fn sin_cos(&self) -> (f64, f64) {
        match self.fifteenths {
            Some(count) => (sine_of_fifteenths(count), sine_of_fifteenths(count.rem_euclid(24) + 6)),
            None => (libm::sin(self.value), libm::cos(self.value)),
        }
    }

    /// The sum; exact where both are.
    pub fn plus(&self, other: Angle) -> Angle {
        match (self.fifteenths, other.fifteenths) {
            (Some(one), Some(two)) => match one.checked_add(two) {
                Some(sum) => Angle::from_fifteenths(sum),
                None => Angle::from_radians(self.value + other.value),
            },
            _ => Angle::from_radians(self.value + other.value),
        }
    }

    /// The angle times a number; exact where the product is such a multiple.
    pub fn times(&self, factor: f64) -> Angle {
        if let Some(count) = self.fifteenths {
            let product = f64::from(count) * factor;
            if product == libm::round(product) && product.abs() < 1e9 {
                return Angle::from_fifteenths(product as i32);
            }
        }
        Angle::from_radians(self.value * factor)
    }
}

/// sin(15 degrees * count).
fn sine_of_fifteenths(count: i32) -> f64 {
    let turn = count.rem_euclid(24);
    let (sign, half) = if turn >= 12 { (-1.0, turn - 12) } else { (1.0, turn) };
    let first_quarter = if half > 6 { 12 - half } else { half };
    let sine = match first_quarter {
        0 => return 0.0,
        1 => SIN_15,
        2 => 0.5,
        3 => SIN_45,
        4 => SIN_60,
        5 => SIN_75,
        _ => 1.0,
    };
    sign * sine
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_multiple_of_15_degrees_has_the_sine_of_the_library_or_a_cleaner_one() {
        for count in -48..=48 {
            let angle = Angle::from_fifteenths(count);
            let (sine, cosine) = angle.sin_cos();
            assert!((sine - libm::sin(angle.value)).abs() < 2e-15, "{count}");
            assert!((cosine - libm::cos(angle.value)).abs() < 2e-15, "{count}");
        }
        assert_eq!(Angle::from_degrees(90.0).sin_cos(), (1.0, 0.0));
        assert_eq!(Angle::from_degrees(-90.0).sin_cos(), (-1.0, 0.0));
        assert_eq!(Angle::from_radians(PI).sin_cos(), (0.0, -1.0));
    }

    #[test]
    fn exactness_ends_at_the_tolerance() {
        assert_eq!(Angle::from_radians(FRAC_PI_2 + 5e-13).fifteenths, Some(6));
        assert_eq!(Angle::from_radians(FRAC_PI_2 + 5e-13).value, FRAC_PI_2);
        assert_eq!(Angle::from_radians(FRAC_PI_2 + 2e-12).fifteenths, None);
        assert_eq!(Angle::from_radians(1.5711).fifteenths, None);
        assert_eq!(Angle::from_degrees(-105.0).fifteenths, Some(-7));
    }

    #[test]
    fn sums_and_products_stay_exact() {
        let quarter = Angle::from_degrees(90.0);
        assert_eq!(quarter.plus(Angle::from_degrees(-30.0)).fifteenths, Some(4));
        assert_eq!(quarter.times(0.5).fifteenths, Some(3));
        assert_eq!(quarter.times(1.0 / 4.0).fifteenths, None);
        assert_eq!(Angle::from_radians(f64::MAX).plus(quarter).fifteenths, None);
    }
}
