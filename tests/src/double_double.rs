//! Numbers of twice the precision of f64: an unevaluated sum of two, about 32 digits.
//!
//! Calibrated tables have offsets of kilometres that cancel to a tenth of a micrometre; a plain product of f64 matrices
//! loses nine digits there. The algorithms are the classical ones of Dekker and Knuth.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo` with `|lo|` at most half a unit in the last place of `hi`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

/// The sum and its rounding error.
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    let b_part = hi - a;
    DoubleDouble { hi, lo: (a - (hi - b_part)) + (b - b_part) }
}

/// The product and its rounding error.
fn two_product(a: f64, b: f64) -> DoubleDouble {
    let hi = a * b;
    DoubleDouble { hi, lo: a.mul_add(b, -hi) }
}

impl DoubleDouble {
    /// 0
    pub const ZERO: Self = Self { hi: 0.0, lo: 0.0 };
    /// 1
    pub const ONE: Self = Self { hi: 1.0, lo: 0.0 };
    /// Half a turn.
    pub const PI: Self = Self { hi: std::f64::consts::PI, lo: 1.224_646_799_147_353_2e-16 };

    /// The number nearest in f64.
    pub fn to_f64(self) -> f64 {
        self.hi + self.lo
    }

    /// Whether it is neither infinite nor a NaN.
    pub fn is_finite(self) -> bool {
        self.to_f64().is_finite()
    }

    /// Square root; NaN for negative numbers.
    pub fn sqrt(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        // One step of Newton from the f64 root doubles its digits.
        let root = Self::from(self.hi.sqrt());
        (root + self / root) * Self::from(0.5)
    }

    /// Sine and cosine of an angle in radians.
    pub fn sin_cos(self) -> (Self, Self) {
        let quarter = Self::PI * Self::from(0.5);
        let turns = (self.hi / quarter.hi).round();
        let rest = self - quarter * Self::from(turns);
        let square = rest * rest;
        // Taylor series; |rest| is at most pi/4, where 14 terms reach 1e-32.
        let (mut sin, mut cos) = (rest, Self::ONE);
        let (mut sin_term, mut cos_term) = (rest, Self::ONE);
        for k in 1..=14 {
            let n = f64::from(2 * k);
            cos_term = -(cos_term * square) / Self::from(n * (n - 1.0));
            sin_term = -(sin_term * square) / Self::from(n * (n + 1.0));
            cos = cos + cos_term;
            sin = sin + sin_term;
        }
        match turns.rem_euclid(4.0) as i32 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    /// The angle of the point (x, y), in (-pi, pi].
    pub fn atan2(y: Self, x: Self) -> Self {
        let length = (x * x + y * y).sqrt();
        if length == Self::ZERO {
            return Self::ZERO;
        }
        // The f64 angle is off by so little that the sine of the error is the error.
        let guess = Self::from(y.hi.atan2(x.hi));
        let (sin, cos) = guess.sin_cos();
        guess + (y * cos - x * sin) / length
    }
}

impl From<f64> for DoubleDouble {
    fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = two_sum(self.hi, other.hi);
        let low = two_sum(self.lo, other.lo);
        let sum = two_sum(high.hi, high.lo + low.hi);
        two_sum(sum.hi, sum.lo + low.lo)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.hi, other.hi);
        two_sum(product.hi, product.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = Self::from(self.hi / other.hi);
        let rest = self - first * other;
        let second = Self::from(rest.hi / other.hi);
        let rest = rest - second * other;
        first + second + Self::from(rest.hi / other.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::DoubleDouble;

    fn close(a: DoubleDouble, b: DoubleDouble) -> bool {
        (a - b).to_f64().abs() < 1e-30
    }

    #[test]
    fn sines_of_known_angles() {
        let sixth = DoubleDouble::PI / DoubleDouble::from(6.0);
        for turns in [-7.0, 0.0, 1.0, 40.0] {
            let (sin, cos) = (sixth + DoubleDouble::PI * DoubleDouble::from(2.0 * turns)).sin_cos();
            assert!((sin.to_f64() - 0.5).abs() < 1e-16);
            assert!((sin - DoubleDouble::from(0.5)).to_f64().abs() < 1e-29);
            assert!((cos * cos - DoubleDouble::from(0.75)).to_f64().abs() < 1e-29);
        }
    }

    #[test]
    fn arctangent_inverts() {
        for degrees in -179..180 {
            let angle = DoubleDouble::PI * DoubleDouble::from(f64::from(degrees)) / DoubleDouble::from(180.0);
            let (sin, cos) = angle.sin_cos();
            assert!(close(sin * sin + cos * cos, DoubleDouble::ONE));
            assert!(close(DoubleDouble::atan2(sin, cos), angle), "{degrees}");
        }
    }

    #[test]
    fn square_roots_square() {
        let two = DoubleDouble::from(2.0);
        assert!(close(two.sqrt() * two.sqrt(), two));
    }
}
