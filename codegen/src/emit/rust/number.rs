//! Numbers as Rust literals: the shortest that read back as the same bits, on every host.

use super::ScalarType;
use super::paths::Paths;

/// Constants of `core::f64::consts` (and `f32`) that stand for themselves where a number has exactly their bits.
const NAMED: [(&str, f64); 10] = [
    ("PI", std::f64::consts::PI),
    ("TAU", std::f64::consts::TAU),
    ("FRAC_PI_2", std::f64::consts::FRAC_PI_2),
    ("FRAC_PI_3", std::f64::consts::FRAC_PI_3),
    ("FRAC_PI_4", std::f64::consts::FRAC_PI_4),
    ("FRAC_PI_6", std::f64::consts::FRAC_PI_6),
    ("FRAC_PI_8", std::f64::consts::FRAC_PI_8),
    ("FRAC_1_PI", std::f64::consts::FRAC_1_PI),
    ("SQRT_2", std::f64::consts::SQRT_2),
    ("FRAC_1_SQRT_2", std::f64::consts::FRAC_1_SQRT_2),
];

/// Numbers that clippy takes a short literal near them for; what is not in [`NAMED`] is only ever near by chance.
const OTHERS: [f64; 10] = [
    std::f64::consts::E,
    std::f64::consts::FRAC_2_PI,
    std::f64::consts::FRAC_2_SQRT_PI,
    std::f64::consts::LN_2,
    std::f64::consts::LN_10,
    std::f64::consts::LOG2_E,
    std::f64::consts::LOG2_10,
    std::f64::consts::LOG10_E,
    std::f64::consts::LOG10_2,
    1.618_033_988_749_895,
];

/// How clippy's `approx_constant` is met where a table says 3.14.
pub(super) const APPROXIMATE: &str = "clippy::approx_constant";

/// `value` (of either sign) as an expression, in the scalar type of the generated code.
pub(super) fn number(value: f64, scalar: ScalarType, paths: &Paths) -> String {
    if value.is_sign_negative() && !value.is_nan() {
        return format!("-{}", number(-value, scalar, paths));
    }
    for (name, named) in NAMED {
        let same = match scalar {
            ScalarType::F64 => value.to_bits() == named.to_bits(),
            ScalarType::F32 => (value as f32).to_bits() == (named as f32).to_bits(),
        };
        if same {
            return paths.constant(name, scalar);
        }
    }
    let digits = match scalar {
        ScalarType::F64 => format!("{value:?}"),
        ScalarType::F32 => format!("{:?}", value as f32),
    };
    separated(&digits)
}

/// Whether a literal of `value` would look like a carelessly written constant of mathematics.
pub(super) fn looks_approximate(value: f64) -> bool {
    let value = value.abs();
    NAMED
        .iter()
        .map(|&(_, constant)| constant)
        .chain(OTHERS)
        .any(|constant| (value / constant - 1.0).abs() < 1e-3)
}

/// A decimal number with underscores between groups of three digits, from the point outwards.
fn separated(digits: &str) -> String {
    let (mantissa, exponent) = digits.split_once('e').map_or((digits, None), |(m, e)| (m, Some(e)));
    let (whole, fraction) = mantissa.split_once('.').map_or((mantissa, None), |(w, f)| (w, Some(f)));
    let mut text = grouped(whole, 3);
    if let Some(fraction) = fraction {
        let reversed = |text: &str| text.chars().rev().collect::<String>();
        text.push('.');
        text.push_str(&reversed(&grouped(&reversed(fraction), 3)));
    }
    if let Some(exponent) = exponent {
        text.push('e');
        text.push_str(exponent);
    }
    text
}

/// Underscores between groups of digits, counted from the right; short runs stay whole.
pub(super) fn grouped(digits: &str, size: usize) -> String {
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if digits.len() > 4 && i > 0 && (digits.len() - i).is_multiple_of(size) {
            text.push('_');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{ScalarType, looks_approximate, number};
    use crate::emit::rust::paths::{Paths, Style};

    fn f64_text(value: f64) -> String {
        number(value, ScalarType::F64, &Paths::new(Style::File, "Arm"))
    }

    #[test]
    fn literals_are_short_and_read_back() {
        assert_eq!(f64_text(0.14), "0.14");
        assert_eq!(f64_text(-0.0), "-0.0");
        assert_eq!(f64_text(3.0), "3.0");
        assert_eq!(f64_text(12345.25), "12_345.25");
        assert_eq!(f64_text(1e-7), "1e-7");
        assert_eq!(f64_text(0.866_025_403_784_438_6), "0.866_025_403_784_438_6");
        assert_eq!(f64_text(1e300), "1e300");
        for value in [0.1 + 0.2, 1.0 / 3.0, 6.1e-5, f64::MIN_POSITIVE] {
            let text = f64_text(value).replace('_', "");
            assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(value.to_bits()), "{text}");
        }
    }

    #[test]
    fn constants_of_mathematics_keep_their_names() {
        assert_eq!(f64_text(-std::f64::consts::FRAC_PI_2), "-FRAC_PI_2");
        let attribute = Paths::new(Style::Attribute, "Arm");
        assert_eq!(number(std::f64::consts::PI, ScalarType::F32, &attribute), "::core::f32::consts::PI");
        assert!(looks_approximate(-std::f64::consts::PI * 0.9995) && !looks_approximate(0.14));
    }

    #[test]
    fn single_precision_is_rounded_once() {
        assert_eq!(number(0.1, ScalarType::F32, &Paths::new(Style::File, "Arm")), "0.1");
    }
}
