//! Double-double numbers: sums of two f64, some 32 digits.

use super::Number;
use crate::model::Angle;
use core::ops::{Add, Mul, Neg};

/// `high + low`, with `|low|` at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Double {
    high: f64,
    low: f64,
}

/// pi / 2
const QUARTER_TURN: Double = Double { high: core::f64::consts::FRAC_PI_2, low: 6.123_233_995_736_766e-17 };
/// 1 / 12 of pi
const FIFTEENTH: Double = Double { high: 0.261_799_387_799_149_46, low: -2.680_204_416_127_727_5e-17 };

/// Taylor terms of sine and cosine up to pi / 4, until they vanish.
const TERMS: i32 = 30;

impl Double {
    fn from_sum(one: f64, two: f64) -> Double {
        let high = one + two;
        let part = high - one;
        Double { high, low: (one - (high - part)) + (two - part) }
    }

    fn from_product(one: f64, two: f64) -> Double {
        let high = one * two;
        Double { high, low: libm::fma(one, two, -high) }
    }

    fn divided_by(self, divisor: f64) -> Double {
        let high = self.high / divisor;
        let rest = self + -Double::from_product(high, divisor);
        Double::from_sum(high, rest.high / divisor)
    }

    /// Sine and cosine within a quarter turn around zero.
    fn sin_cos_small(self) -> (Double, Double) {
        let mut sine = Double::of(0.0);
        let mut cosine = Double::of(1.0);
        let mut term = Double::of(1.0);
        for order in 1..TERMS {
            term = (term * self).divided_by(f64::from(order));
            let signed = if order % 4 < 2 { term } else { -term };
            if order % 2 == 1 {
                sine = sine + signed;
            } else {
                cosine = cosine + signed;
            }
        }
        (sine, cosine)
    }
}

impl Number for Double {
    fn of(value: f64) -> Double {
        Double { high: value, low: 0.0 }
    }

    fn nearest(self) -> f64 {
        self.high
    }

    fn sin_cos(angle: Angle, added: Double) -> (Double, Double) {
        let of_table = match angle.fifteenths {
            Some(count) => FIFTEENTH * Double::of(f64::from(count)),
            None => Double::of(angle.value),
        };
        let whole = of_table + added;
        let quarters = libm::round(whole.high / QUARTER_TURN.high);
        let (sine, cosine) = (whole + -(QUARTER_TURN * Double::of(quarters))).sin_cos_small();
        match libm::fmod(quarters, 4.0) as i32 {
            1 | -3 => (cosine, -sine),
            2 | -2 => (-sine, -cosine),
            3 | -1 => (-cosine, sine),
            _ => (sine, cosine),
        }
    }
}

impl Add for Double {
    type Output = Double;

    fn add(self, other: Double) -> Double {
        let high = Double::from_sum(self.high, other.high);
        let low = Double::from_sum(self.low, other.low);
        let sum = Double::from_sum(high.high, high.low + low.high);
        Double::from_sum(sum.high, sum.low + low.low)
    }
}

impl Mul for Double {
    type Output = Double;

    fn mul(self, other: Double) -> Double {
        let product = Double::from_product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        Double::from_sum(product.high, product.low + cross)
    }
}

impl Neg for Double {
    type Output = Double;

    fn neg(self) -> Double {
        Double { high: -self.high, low: -self.low }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_hold_to_thirty_digits() {
        for step in -50..50 {
            let added = Double::of(f64::from(step) * 0.37);
            let (sine, cosine) = Double::sin_cos(Angle::from_fifteenths(step), added);
            let one = sine * sine + cosine * cosine + Double::of(-1.0);
            assert!(one.high.abs() < 1e-30, "{step}: {one:?}");
            let plain = f64::from(step) * (core::f64::consts::PI / 12.0 + 0.37);
            assert!((sine.high - libm::sin(plain)).abs() < 1e-13, "{step}");
            assert!((cosine.high - libm::cos(plain)).abs() < 1e-13, "{step}");
        }
        let (sine, cosine) = Double::sin_cos(Angle::from_degrees(30.0), Double::of(0.0));
        assert!((sine + Double::of(-0.5)).high.abs() < 1e-31);
        let three_quarters = cosine * cosine + Double::of(-0.75);
        assert!(three_quarters.high.abs() < 1e-31);
    }
}
