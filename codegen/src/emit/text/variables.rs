//! theta and d of the rows in the joint variables, and the sums of theta that sines and cosines are named after.

use super::number::{angle, in_units, table_angle, trimmed};
use crate::model::{AngleUnit, JointKind, LengthUnit, Model, Units};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Differences of angles (rad) and coefficients that rounding leaves.
const ROUNDING: f64 = 1e-9;

/// A linear form: coefficients by index, and a constant (rad or m).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Form {
    /// One a variable.
    pub(super) coefficients: Vec<f64>,
    /// rad or m
    pub(super) constant: f64,
}

impl Form {
    /// 0 in so many variables.
    pub(super) fn zero(variables: usize) -> Form {
        Form { coefficients: vec![0.0; variables], constant: 0.0 }
    }

    /// self += factor * other
    pub(super) fn add(&mut self, other: &Form, factor: f64) {
        let coefficients = self.coefficients.iter_mut().zip(&other.coefficients);
        coefficients.for_each(|(own, other)| *own += factor * other);
        self.constant += factor * other.constant;
    }
}

/// `theta2 = q2 + 90`, one line a row whose theta or d is not a number of the table.
pub(super) fn definitions(model: &Model) -> Vec<String> {
    let rows = model.rows.iter().enumerate().filter(|(_, row)| !row.terms.is_empty());
    rows.map(|(index, row)| {
        let terms = row.terms.iter().filter_map(|(joint, coefficient)| {
            let source = *model.joints.get(*joint)?;
            let other = model.rows.get(source)?;
            let coefficient = coefficient * per(row.kind, model.units) / per(other.kind, model.units);
            Some((coefficient, format!("q{}", source + 1)))
        });
        let zero = match row.kind {
            JointKind::Revolute => table_angle(row.theta, model.units),
            JointKind::Prismatic => trimmed(in_units(row.d, 1, model.units)),
        };
        format!("{} = {}", variable(row.kind, index), linear(terms, &zero))
    })
    .collect()
}

/// `theta3`, `d3`.
pub(super) fn variable(kind: JointKind, row: usize) -> String {
    match kind {
        JointKind::Revolute => format!("theta{}", row + 1),
        JointKind::Prismatic => format!("d{}", row + 1),
    }
}

/// `-q3 - 0.5 q2 + 90`; the constant is written already.
pub(super) fn linear(terms: impl Iterator<Item = (f64, String)>, constant: &str) -> String {
    let mut sum = String::new();
    let mut add = |negative: bool, term: &str| {
        sum += match (sum.is_empty(), negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        sum += term;
    };
    for (coefficient, name) in terms.filter(|(coefficient, _)| *coefficient != 0.0) {
        match trimmed(coefficient.abs()).as_str() {
            "1" => add(coefficient < 0.0, &name),
            factor => add(coefficient < 0.0, &format!("{factor} {name}")),
        }
    }
    match constant.strip_prefix('-') {
        Some(positive) => add(true, positive),
        None if constant == "0" => {}
        None => add(false, constant),
    }
    if sum.is_empty() { "0".to_owned() } else { sum }
}

/// Table units a radian (revolute) or a metre (prismatic).
pub(super) fn per(kind: JointKind, units: Units) -> f64 {
    match (kind, units.angle, units.length) {
        (JointKind::Revolute, AngleUnit::Degree, _) => 180.0 / std::f64::consts::PI,
        (JointKind::Prismatic, _, LengthUnit::Millimetre) => 1000.0,
        _ => 1.0,
    }
}

/// theta of a row as a form in q.
fn theta(model: &Model, row: usize) -> Option<Form> {
    let row = model.rows.get(row)?;
    let mut form = Form { constant: row.theta.value, ..Form::zero(model.joints.len()) };
    if row.kind == JointKind::Revolute {
        for (joint, coefficient) in &row.terms {
            *form.coefficients.get_mut(*joint)? += coefficient;
        }
    }
    Some(form)
}

/// An angle as a form in q, `q1 + 2 q2 + 90`.
pub(super) fn in_q(model: &Model, form: &Form) -> String {
    let joints = model.joints.iter().zip(&form.coefficients);
    let terms = joints.map(|(row, coefficient)| {
        let kind = model.rows.get(*row).map_or(JointKind::Revolute, |row| row.kind);
        let factor = per(JointKind::Revolute, model.units) / per(kind, model.units);
        (coefficient * factor, format!("q{}", row + 1))
    });
    linear(terms, &angle(form.constant, model.units))
}

/// What an angle is whose sine is called `s234`: `theta2 + theta3 + theta4`, where that is what the angle (a form in
/// q, up to whole turns) is; a turn between the axes is added to it. `None` where the name says something else.
pub(super) fn sum_of_thetas(model: &Model, suffix: &str, whole: &Form) -> Option<String> {
    readings(suffix).into_iter().find_map(|rows| {
        let mut rest = whole.clone();
        for (row, sign) in &rows {
            rest.add(&theta(model, *row)?, -sign);
        }
        if rest.coefficients.iter().any(|coefficient| coefficient.abs() > ROUNDING) {
            return None;
        }
        let turn = rest.constant - TAU * (rest.constant / TAU).round();
        let turn = if turn.abs() < ROUNDING { 0.0 } else { turn };
        Some(linear(thetas(&rows), &angle(turn, model.units)))
    })
}

/// The same for an unknown whose rows are known as bits.
pub(super) fn sum_of_rows(suffix: &str, mask: u32) -> Option<String> {
    let bits = |rows: &[(usize, f64)]| rows.iter().fold(0_u32, |bits, (row, _)| bits | 1 << (row % 32));
    let rows = readings(suffix).into_iter().find(|rows| bits(rows) == mask)?;
    Some(linear(thetas(&rows), "0"))
}

fn thetas(rows: &[(usize, f64)]) -> impl Iterator<Item = (f64, String)> {
    rows.iter().map(|(row, sign)| (*sign, variable(JointKind::Revolute, *row)))
}

/// Rows and signs that a name may stand for: `2m3` is theta2 - theta3, `9_10` is theta9 + theta10, `12` is either
/// theta1 + theta2 or theta12.
fn readings(suffix: &str) -> Vec<Vec<(usize, f64)>> {
    let narrow = read(suffix, |rest| rest.len().min(1));
    let wide = read(suffix, |rest| rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len()));
    narrow.into_iter().chain(wide).collect()
}

/// `digits` says how many digits the next number has.
fn read(suffix: &str, digits: impl Fn(&str) -> usize) -> Option<Vec<(usize, f64)>> {
    let mut rows = Vec::new();
    let mut rest = suffix;
    while !rest.is_empty() {
        let (sign, number) = match rest.strip_prefix('m') {
            Some(number) => (-1.0, number),
            None => (1.0, rest.strip_prefix('_').unwrap_or(rest)),
        };
        let (number, next) = number.split_at_checked(digits(number))?;
        let number: usize = number.parse().ok()?;
        rows.push((number.checked_sub(1)?, sign));
        rest = next;
    }
    Some(rows)
}

/// The whole angle behind the names that a sine-cosine pair is given: whole quarter turns are taken out of its
/// argument and put into the names.
pub(super) fn quarters(sin: &str, cos: &str) -> f64 {
    let turned = match (sin.starts_with('n'), cos.starts_with('n')) {
        (true, false) => 1.0,
        (true, true) => 2.0,
        (false, true) => 3.0,
        (false, false) => 0.0,
    };
    turned * FRAC_PI_2
}

#[cfg(test)]
mod tests {
    use super::{linear, readings};

    #[test]
    fn names_of_sums() {
        assert_eq!(readings("2m3"), [vec![(1, 1.0), (2, -1.0)], vec![(1, 1.0), (2, -1.0)]]);
        assert_eq!(readings("12"), [vec![(0, 1.0), (1, 1.0)], vec![(11, 1.0)]]);
        assert_eq!(readings("9_10m11").last(), Some(&vec![(8, 1.0), (9, 1.0), (10, -1.0)]));
        assert!(readings("3_alpha").is_empty());
        assert!(readings("x").is_empty());
    }

    #[test]
    fn forms() {
        let terms =
            |list: &[(f64, &str)]| list.iter().map(|(x, n)| (*x, (*n).to_owned())).collect::<Vec<_>>();
        assert_eq!(linear(terms(&[(-1.0, "q3"), (0.5, "q2")]).into_iter(), "-90"), "-q3 + 0.5 q2 - 90");
        assert_eq!(linear(terms(&[(0.0, "q3")]).into_iter(), "0"), "0");
        assert_eq!(linear(terms(&[(0.0, "q3")]).into_iter(), "pi/2"), "pi/2");
    }
}
