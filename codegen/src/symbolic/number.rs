//! Exact constants: (n0 + n1 sqrt 2 + n2 sqrt 3 + n3 sqrt 6) / den.
//!
//! The sines and cosines of all multiples of 15 degrees are of this form, and so are their sums and products, so
//! that whatever cancels on paper cancels here.

use std::fmt;

/// An element of the field Q(sqrt 2, sqrt 3) with bounded integers.
///
/// Kept reduced with a positive denominator, so that equal numbers have equal parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Number {
    parts: [i64; 4],
    denominator: i64,
}

const ROOTS: [f64; 4] = [1.0, std::f64::consts::SQRT_2, 1.732_050_807_568_877_2, 2.449_489_742_783_178];

impl Number {
    /// 0
    pub const ZERO: Self = Self::integer(0);
    /// 1
    pub const ONE: Self = Self::integer(1);
    /// 2
    pub const TWO: Self = Self::integer(2);
    /// 1/2
    pub const HALF: Self = Self { parts: [1, 0, 0, 0], denominator: 2 };

    /// A whole number.
    pub const fn integer(value: i64) -> Self {
        Self { parts: [value, 0, 0, 0], denominator: 1 }
    }

    /// The whole number or fraction with a denominator of at most 64 that `value` is, if it is one.
    pub fn from_f64(value: f64) -> Option<Self> {
        (1..=64).find_map(|denominator| {
            let scaled = value * f64::from(denominator);
            (scaled.abs() < 1e9 && scaled == scaled.round())
                .then(|| Self::reduced([scaled as i128, 0, 0, 0], i128::from(denominator)))
                .flatten()
        })
    }

    /// Sine of a multiple of 15 degrees.
    pub fn sin(fifteenths: i32) -> Self {
        Self::cos(fifteenths.wrapping_sub(6))
    }

    /// Cosine of a multiple of 15 degrees.
    pub fn cos(fifteenths: i32) -> Self {
        let folded = fifteenths.rem_euclid(24);
        let folded = if folded > 12 { 24 - folded } else { folded };
        let (folded, sign) = if folded > 6 { (12 - folded, -1) } else { (folded, 1) };
        let (parts, denominator) = match folded {
            0 => ([1, 0, 0, 0], 1),
            1 => ([0, 1, 0, 1], 4), // cos 15 = (sqrt 2 + sqrt 6) / 4
            2 => ([0, 0, 1, 0], 2),
            3 => ([0, 1, 0, 0], 2),
            4 => ([1, 0, 0, 0], 2),
            5 => ([0, -1, 0, 1], 4), // cos 75 = (sqrt 6 - sqrt 2) / 4
            _ => ([0; 4], 1),
        };
        Self { parts: parts.map(|part| part * sign), denominator }
    }

    /// Whether the number is 0.
    pub fn is_zero(self) -> bool {
        self.parts == [0; 4]
    }

    /// Sum; `None` where the integers overflow.
    pub fn checked_add(self, other: Self) -> Option<Self> {
        if let (Some(a), Some(b)) = (self.whole(), other.whole()) {
            return a.checked_add(b).filter(|sum| *sum != i64::MIN).map(Self::integer);
        }
        let (d1, d2) = (i128::from(self.denominator), i128::from(other.denominator));
        let (f1, f2, denominator) = if d1 == d2 { (1, 1, d1) } else { (d2, d1, d1 * d2) };
        let mut parts = [0; 4];
        for (part, (a, b)) in parts.iter_mut().zip(self.parts.into_iter().zip(other.parts)) {
            *part = i128::from(a) * f1 + i128::from(b) * f2;
        }
        Self::reduced(parts, denominator)
    }

    /// Product; `None` where the integers overflow.
    pub fn checked_mul(self, other: Self) -> Option<Self> {
        if let (Some(a), Some(b)) = (self.whole(), other.whole()) {
            return a.checked_mul(b).filter(|product| *product != i64::MIN).map(Self::integer);
        }
        let [a0, a1, a2, a3] = self.parts.map(i128::from);
        let [b0, b1, b2, b3] = other.parts.map(i128::from);
        let denominator = i128::from(self.denominator) * i128::from(other.denominator);
        if self.is_rational() && other.is_rational() {
            return Self::reduced([a0 * b0, 0, 0, 0], denominator);
        }
        let sum = |list: [i128; 4]| list.into_iter().try_fold(0_i128, i128::checked_add);
        let parts = [
            sum([
                a0.checked_mul(b0)?,
                a1.checked_mul(2 * b1)?,
                a2.checked_mul(3 * b2)?,
                a3.checked_mul(6 * b3)?,
            ])?,
            sum([
                a0.checked_mul(b1)?,
                a1.checked_mul(b0)?,
                a2.checked_mul(3 * b3)?,
                a3.checked_mul(3 * b2)?,
            ])?,
            sum([
                a0.checked_mul(b2)?,
                a2.checked_mul(b0)?,
                a1.checked_mul(2 * b3)?,
                a3.checked_mul(2 * b1)?,
            ])?,
            sum([a0.checked_mul(b3)?, a3.checked_mul(b0)?, a1.checked_mul(b2)?, a2.checked_mul(b1)?])?,
        ];
        Self::reduced(parts, denominator)
    }

    /// The whole number that it is, if it is one: most are.
    fn whole(self) -> Option<i64> {
        match self {
            Self { parts: [value, 0, 0, 0], denominator: 1 } => Some(value),
            _ => None,
        }
    }

    /// Whether no root is in it.
    fn is_rational(self) -> bool {
        let [_, two, three, six] = self.parts;
        two == 0 && three == 0 && six == 0
    }

    /// 1 / self; `None` for 0 and where the integers overflow.
    pub fn recip(self) -> Option<Self> {
        // (p + q sqrt 3)(p - q sqrt 3) = p^2 - 3 q^2 with p, q in Q(sqrt 2), and the same once more for sqrt 2.
        let [n0, n1, n2, n3] = self.parts;
        let conjugate = Self { parts: [n0, n1, -n2, -n3], denominator: self.denominator };
        let inner = self.checked_mul(conjugate)?;
        let [m0, m1, ..] = inner.parts;
        let inner_conjugate = Self { parts: [m0, -m1, 0, 0], denominator: inner.denominator };
        let norm = inner.checked_mul(inner_conjugate)?;
        let [rational, ..] = norm.parts;
        if rational == 0 {
            return None;
        }
        let inverse = Self::reduced([i128::from(norm.denominator), 0, 0, 0], i128::from(rational))?;
        conjugate.checked_mul(inner_conjugate)?.checked_mul(inverse)
    }

    /// The nearest f64, up to the rounding of the sum.
    pub fn value(self) -> f64 {
        let sum: f64 = self.parts.iter().zip(ROOTS).map(|(&part, root)| part as f64 * root).sum();
        sum / self.denominator as f64
    }

    /// Whether the number is less than 0.
    pub fn is_negative(self) -> bool {
        let [rational, ..] = self.parts;
        if self.is_rational() { rational < 0 } else { self.value() < 0.0 }
    }

    fn reduced(parts: [i128; 4], denominator: i128) -> Option<Self> {
        let narrow = |value: i128| i64::try_from(value).ok().filter(|narrowed| *narrowed != i64::MIN);
        let [n0, n1, n2, n3] = parts;
        if denominator == 1 {
            return Some(Self {
                parts: [narrow(n0)?, narrow(n1)?, narrow(n2)?, narrow(n3)?],
                denominator: 1,
            });
        }
        let divisor =
            parts.iter().fold(denominator.unsigned_abs(), |acc, part| gcd(acc, part.unsigned_abs()));
        let divisor = i128::try_from(divisor.max(1)).ok()? * denominator.signum();
        Some(Self {
            parts: [
                narrow(n0 / divisor)?,
                narrow(n1 / divisor)?,
                narrow(n2 / divisor)?,
                narrow(n3 / divisor)?,
            ],
            denominator: narrow(denominator / divisor)?,
        })
    }
}

/// Greatest common divisor; in the narrow type as soon as the numbers fit, which is much faster.
fn gcd(a: u128, b: u128) -> u128 {
    if let (Ok(mut a), Ok(mut b)) = (u64::try_from(a), u64::try_from(b)) {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        return u128::from(a);
    }
    if b == 0 { a } else { gcd(b, a % b) }
}

impl std::ops::Neg for Number {
    type Output = Self;

    fn neg(self) -> Self {
        Self { parts: self.parts.map(|part| -part), denominator: self.denominator }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = String::new();
        for (&part, root) in self.parts.iter().zip(["", "sqrt(2)", "sqrt(3)", "sqrt(6)"]) {
            if part == 0 {
                continue;
            }
            let sign = if part < 0 {
                "-"
            } else if text.is_empty() {
                ""
            } else {
                "+"
            };
            let magnitude = part.unsigned_abs();
            let body = match (root, magnitude) {
                ("", _) => magnitude.to_string(),
                (_, 1) => root.to_string(),
                _ => format!("{magnitude} {root}"),
            };
            text = format!("{text}{sign}{body}");
        }
        let several = self.parts.iter().filter(|part| **part != 0).count() > 1;
        match (text.is_empty(), self.denominator, several) {
            (true, ..) => f.write_str("0"),
            (_, 1, _) => f.write_str(&text),
            (_, denominator, true) => write!(f, "({text})/{denominator}"),
            (_, denominator, false) => write!(f, "{text}/{denominator}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Number;

    #[test]
    fn every_multiple_of_15_degrees_agrees_with_the_library_and_lies_on_the_circle() {
        for k in -48..48 {
            let angle = f64::from(k) * std::f64::consts::PI / 12.0;
            assert!((Number::cos(k).value() - angle.cos()).abs() < 1e-14, "cos {k}");
            assert!((Number::sin(k).value() - angle.sin()).abs() < 1e-14, "sin {k}");
            let square = |x: Number| x.checked_mul(x).unwrap();
            assert_eq!(square(Number::cos(k)).checked_add(square(Number::sin(k))), Some(Number::ONE));
        }
    }

    #[test]
    fn reciprocals_are_exact() {
        for k in 0..6 {
            let x = Number::cos(k).checked_add(Number::integer(i64::from(k) - 7)).unwrap();
            assert_eq!(x.checked_mul(x.recip().unwrap()), Some(Number::ONE), "{x}");
        }
        assert_eq!(Number::ZERO.recip(), None);
    }

    #[test]
    fn overflow_is_none_and_not_a_wrong_number() {
        let large = Number::integer(i64::MAX / 2);
        assert_eq!(large.checked_mul(large), None);
        assert_eq!(Number::from_f64(0.301_234), None);
        assert_eq!(Number::from_f64(-0.75).map(|x| x.to_string()), Some("-3/4".to_string()));
    }
}
