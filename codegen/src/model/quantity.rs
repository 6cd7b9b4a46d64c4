//! Numbers of the table -> SI, with their dimensions checked.

use super::{Angle, AngleUnit, JointKind, LengthUnit, Limits, Units};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue};
use crate::table::expression::{Scope, Value, evaluate, mixed_units};
use crate::table::{Number, Numbers, Span, Text};
use core::f64::consts::PI;

impl Units {
    /// A bare number of the table as an angle.
    pub fn angle_of(self, number: f64) -> Angle {
        match self.angle {
            AngleUnit::Radian => Angle::from_radians(number),
            AngleUnit::Degree => Angle::from_degrees(number),
        }
    }

    /// A bare number of the table as a length (m). Division keeps what is a short decimal in mm the nearest f64 in m.
    pub fn length_of(self, number: f64) -> f64 {
        match self.length {
            LengthUnit::Metre => number,
            LengthUnit::Millimetre => number / 1000.0,
        }
    }

    /// rad in the table's unit of angle.
    pub fn radians_per_angle(self) -> f64 {
        match self.angle {
            AngleUnit::Radian => 1.0,
            AngleUnit::Degree => PI / 180.0,
        }
    }

    /// SI units in the table's unit of a joint variable: rad or m.
    pub fn per_unit(self, kind: JointKind) -> f64 {
        match (kind, self.length) {
            (JointKind::Revolute, _) => self.radians_per_angle(),
            (JointKind::Prismatic, LengthUnit::Metre) => 1.0,
            (JointKind::Prismatic, LengthUnit::Millimetre) => 1e-3,
        }
    }

    /// Name of the unit of angle.
    pub fn angle_name(self) -> &'static str {
        match self.angle {
            AngleUnit::Radian => "rad",
            AngleUnit::Degree => "deg",
        }
    }

    /// Name of the unit of length.
    pub fn length_name(self) -> &'static str {
        match self.length {
            LengthUnit::Metre => "m",
            LengthUnit::Millimetre => "mm",
        }
    }
}

/// Converts numbers, and reports those that are of the wrong kind.
pub(super) struct Converter<'a> {
    pub(super) units: Units,
    pub(super) diagnostics: &'a mut Diagnostics,
}

impl Converter<'_> {
    /// A length (m).
    pub(super) fn length(&mut self, number: &Number) -> Option<f64> {
        match self.value(number)? {
            Value { length: Some(length), angle: None, bare: None | Some(0.0), .. } => Some(length),
            Value { length: None, angle: None, bare, .. } => Some(self.units.length_of(bare.unwrap_or(0.0))),
            value => self.refuse(&value, number, &Wanted::Length),
        }
    }

    /// An angle. Rounded multiples of 15 degrees get a warning.
    pub(super) fn angle(&mut self, number: &Number) -> Option<Angle> {
        let angle = self.quantity_of_angle(number)?;
        if let Some(warning) = self.rounded(number, angle) {
            self.diagnostics.push(warning);
        }
        Some(angle)
    }

    fn quantity_of_angle(&mut self, number: &Number) -> Option<Angle> {
        match self.value(number)? {
            Value { angle: Some(angle), length: None, bare: None | Some(0.0), .. } => {
                Some(Angle::from_radians(angle))
            }
            Value { angle: None, length: None, bare, .. } => Some(self.units.angle_of(bare.unwrap_or(0.0))),
            value => self.refuse(&value, number, &Wanted::Angle),
        }
    }

    /// A number without a dimension.
    pub(super) fn plain(&mut self, number: &Number) -> Option<f64> {
        let value = self.value(number)?;
        match value.only_bare() {
            Some(bare) => Some(bare),
            None => self.refuse(&value, number, &Wanted::Plain),
        }
    }

    /// A value of a joint variable (rad or m).
    pub(super) fn joint_value(&mut self, number: &Number, kind: JointKind) -> Option<f64> {
        match kind {
            JointKind::Revolute => Some(self.angle(number)?.value),
            JointKind::Prismatic => self.length(number),
        }
    }

    /// Two values of a joint variable.
    pub(super) fn joint_limits(&mut self, numbers: &Numbers, kind: JointKind) -> Option<Limits> {
        self.limits(numbers, |converter, number| converter.joint_value(number, kind))
    }

    /// Least and greatest value, in this order.
    pub(super) fn limits(
        &mut self,
        numbers: &Numbers,
        convert: impl Fn(&mut Self, &Number) -> Option<f64>,
    ) -> Option<Limits> {
        let [min, max] = numbers.value.as_slice() else {
            return None;
        };
        let (least, greatest) = (convert(self, min), convert(self, max));
        let limits = Limits { min: least?, max: greatest? };
        if limits.min > limits.max {
            self.diagnostics.push(
                Diagnostic::error(catalogue::LIMITS_ORDER, "the lower limit is above the upper one")
                    .at(numbers.span.clone(), "")
                    .help(format!("write `[{}, {}]`", written(max), written(min))),
            );
            return None;
        }
        Some(limits)
    }

    /// A number greater than 0, of a joint variable per some power of a second.
    pub(super) fn rate(&mut self, number: &Number, kind: JointKind, key: &str) -> Option<f64> {
        let rate = match kind {
            JointKind::Revolute => self.quantity_of_angle(number)?.value,
            JointKind::Prismatic => self.length(number)?,
        };
        if rate > 0.0 {
            return Some(rate);
        }
        self.diagnostics.push(
            Diagnostic::error(catalogue::WRONG_VALUE, format!("`{key}` has to be greater than 0"))
                .at(number.span(), "")
                .help(format!("leave `{key}` out if there is none")),
        );
        None
    }

    fn value(&mut self, number: &Number) -> Option<Value> {
        match number {
            Number::Literal { value, .. } => Some(Value { bare: Some(*value), ..Value::default() }),
            Number::Expression(text) => {
                match evaluate(text, &Scope::of_numbers(self.units.radians_per_angle())) {
                    Ok(value) => Some(value),
                    Err(diagnostic) => {
                        self.diagnostics.push(*diagnostic);
                        None
                    }
                }
            }
        }
    }

    fn refuse<T>(&mut self, value: &Value, number: &Number, wanted: &Wanted) -> Option<T> {
        // Where a number with the right unit is added to one without any, the one without is the mistake.
        let right = match wanted {
            Wanted::Length => value.length.is_some() && value.angle.is_none(),
            Wanted::Angle => value.angle.is_some() && value.length.is_none(),
            Wanted::Plain => false,
        };
        if let Number::Expression(text) = number
            && right
        {
            self.diagnostics.push(mixed_units(text));
            return None;
        }
        let found = match (value.angle, value.length) {
            (Some(_), Some(_)) => "the sum of an angle and a length",
            (Some(_), None) => "an angle",
            _ => "a length",
        };
        let (wanted, example) = match wanted {
            Wanted::Length => ("a length", "\"140 mm\", \"0.14 m\" or a number in the table's unit"),
            Wanted::Angle => ("an angle", "\"90 deg\", \"pi/2\" or a number in the table's unit"),
            Wanted::Plain => ("a number without a unit", "a plain number"),
        };
        self.diagnostics.push(
            Diagnostic::error(catalogue::WRONG_UNIT, format!("{wanted} is wanted here, and this is {found}"))
                .at(number.span(), "")
                .help(format!("write {example}")),
        );
        None
    }

    /// The warning for a literal that is a multiple of 15 degrees rounded to its own digits.
    fn rounded(&self, number: &Number, angle: Angle) -> Option<Diagnostic> {
        let (digits, in_radians) = match number {
            Number::Literal { digits, .. } => (digits.as_str(), self.units.angle == AngleUnit::Radian),
            Number::Expression(text) => literal_of(&text.value, self.units)?,
        };
        rounded_angle(digits, in_radians, angle, number.span())
    }
}

/// The only literal of an expression such as "-1.5708 rad", and whether it is in radians.
pub(super) fn literal_of(text: &str, units: Units) -> Option<(&str, bool)> {
    let text = text.trim();
    match text.strip_suffix("rad") {
        Some(number) => Some((number.trim(), true)),
        None => {
            text.ends_with(|c: char| c.is_ascii_digit()).then_some((text, units.angle == AngleUnit::Radian))
        }
    }
}

/// What a rounded multiple of 15 degrees is to be written as, if the digits are one.
pub(super) fn rounded_angle(digits: &str, in_radians: bool, angle: Angle, span: Span) -> Option<Diagnostic> {
    if !in_radians || angle.fifteenths.is_some() {
        return None;
    }
    let unsigned = digits.trim_start_matches(['+', '-']).trim();
    let (whole, decimals) = unsigned.split_once('.')?;
    let is_decimal = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !is_decimal(whole) || !is_decimal(decimals) || decimals.len() > 17 {
        return None;
    }
    let nearest = Angle::from_fifteenths(libm::round(angle.value / (PI / 12.0)) as i32);
    let significant = unsigned.trim_start_matches(['0', '.']).bytes().filter(u8::is_ascii_digit).count();
    // Three digits are few: only quarter turns are so common that 1.57 is no accident.
    let needed = if nearest.fifteenths.is_some_and(|count| count % 6 == 0) { 3 } else { 4 };
    if significant < needed || nearest.is_zero() {
        return None;
    }
    let rounded = format!("{:.*}", decimals.len(), nearest.value.abs());
    if rounded.trim_start_matches('0') != unsigned.trim_start_matches('0') {
        return None;
    }
    let fraction = fraction_of_pi(nearest.fifteenths?);
    Some(
        Diagnostic::warning(
            catalogue::ROUNDED_ANGLE,
            format!("{} is {fraction} rounded, and not exact", digits.trim()),
        )
        .at(span, "")
        .help(format!("write `\"{fraction}\"` if that is meant")),
    )
}

/// "pi/2", "-3*pi/4".
fn fraction_of_pi(fifteenths: i32) -> String {
    let divisor = (1..=12).rev().find(|divisor| 12 % divisor == 0 && fifteenths % divisor == 0).unwrap_or(1);
    let (above, below) = ((fifteenths / divisor).abs(), 12 / divisor);
    let sign = if fifteenths < 0 { "-" } else { "" };
    let above = if above == 1 { "pi".to_owned() } else { format!("{above}*pi") };
    if below == 1 { format!("{sign}{above}") } else { format!("{sign}{above}/{below}") }
}

/// What stands in the table for a number.
pub(super) fn written(number: &Number) -> String {
    match number {
        Number::Literal { digits, .. } => digits.clone(),
        Number::Expression(text) => format!("\"{}\"", crate::diagnostic::shortened(&text.value)),
    }
}

enum Wanted {
    Length,
    Angle,
    Plain,
}

/// The meaning of a word out of a short list.
pub(super) fn word<T: Copy>(
    text: &Text,
    what: &str,
    known: &[(&str, T)],
    diagnostics: &mut Diagnostics,
) -> Option<T> {
    if let Some((_, meaning)) = known.iter().find(|(name, _)| *name == text.value) {
        return Some(*meaning);
    }
    let names: Vec<String> = known.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    let near = crate::diagnostic::nearest(&text.value, known.iter().map(|(name, _)| *name));
    let message = format!("`{}` is no {what}", crate::diagnostic::shortened(&text.value));
    let help = match near {
        Some(near) => format!("write `\"{near}\"`"),
        None => format!("write one of {}", names.join(", ")),
    };
    diagnostics
        .push(Diagnostic::error(catalogue::UNKNOWN_WORD, message).at(text.span.clone(), "").help(help));
    None
}
