//! Numbers as they are read by people.

use crate::model::{Angle, AngleUnit, LengthUnit, Units};
use std::f64::consts::PI;

/// To ten significant digits, which hides that a number went to SI and back.
pub(super) fn trimmed(value: f64) -> String {
    let rounded: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    // Adding 0 makes a positive zero of a negative one.
    format!("{}", rounded + 0.0)
}

/// A constant of this power of the metre, in the table's units.
pub(super) fn in_units(value: f64, dimension: u8, units: Units) -> f64 {
    match units.length {
        LengthUnit::Metre => value,
        LengthUnit::Millimetre => value * 1000_f64.powi(i32::from(dimension)),
    }
}

/// An angle (rad) without its unit: degrees, or radians as a fraction of pi where they are one.
pub(super) fn angle(value: f64, units: Units) -> String {
    let fifteenths = value / (PI / 12.0);
    let whole = fifteenths.round();
    let exact = (fifteenths - whole).abs() < 1e-9 && whole.abs() < 1e6;
    match units.angle {
        AngleUnit::Degree if exact => trimmed(whole * 15.0),
        AngleUnit::Degree => trimmed(value.to_degrees()),
        AngleUnit::Radian if exact => fraction_of_pi(whole as i64),
        AngleUnit::Radian => trimmed(value),
    }
}

/// The same of an angle of the table.
pub(super) fn table_angle(value: Angle, units: Units) -> String {
    angle(value.value, units)
}

/// So many twelfths of pi.
fn fraction_of_pi(twelfths: i64) -> String {
    let divisor = [12, 6, 4, 3, 2, 1].into_iter().find(|divisor| twelfths % divisor == 0).unwrap_or(1);
    let (above, below) = (twelfths / divisor, 12 / divisor);
    let above = match above {
        0 => return "0".to_owned(),
        1 => "pi".to_owned(),
        -1 => "-pi".to_owned(),
        _ => format!("{above} pi"),
    };
    if below == 1 { above } else { format!("{above}/{below}") }
}

/// `mm` or `m`.
pub(super) fn length_unit(units: Units) -> &'static str {
    match units.length {
        LengthUnit::Metre => "m",
        LengthUnit::Millimetre => "mm",
    }
}

/// `deg` or `rad`.
pub(super) fn angle_unit(units: Units) -> &'static str {
    match units.angle {
        AngleUnit::Radian => "rad",
        AngleUnit::Degree => "deg",
    }
}

#[cfg(test)]
mod tests {
    use super::{angle, trimmed};
    use crate::model::{AngleUnit, LengthUnit, Units};

    #[test]
    fn angles_in_the_units_of_the_table() {
        let rad = Units { length: LengthUnit::Metre, angle: AngleUnit::Radian };
        let deg = Units { angle: AngleUnit::Degree, ..rad };
        let show = |degrees: f64, units| angle(degrees.to_radians(), units);
        assert_eq!(show(90.0, deg), "90");
        assert_eq!(show(-90.0, rad), "-pi/2");
        assert_eq!(show(75.0, rad), "5 pi/12");
        assert_eq!(show(360.0, rad), "2 pi");
        assert_eq!(show(0.0, rad), "0");
        assert_eq!(show(12.3, deg), "12.3");
        assert_eq!(angle(0.1, rad), "0.1");
    }

    #[test]
    fn numbers_that_went_to_si_and_back() {
        assert_eq!(trimmed(0.073_180_000_000_000_01 * 1000.0), "73.18");
        assert_eq!(trimmed(-0.0), "0");
    }
}
