//! Constraints and filters of inverse problems: texts -> linear forms in the thetas and ds of rows.

use super::quantity::{literal_of, rounded_angle};
use super::{Angle, Filter, JointKind, Linear, Row, Units, names, topology};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, nearest, shortened};
use crate::table::expression::{Scope, Value, evaluate_part, mixed_units};
use crate::table::{Span, Text};
use std::collections::BTreeMap;
use std::ops::Range;

/// The robot as far as constraints speak of it.
pub(super) struct Joints<'a> {
    pub(super) rows: &'a [Row],
    /// `joints[i]` is the row of `q[i]`.
    pub(super) joints: &'a [usize],
    /// From thetas and ds to q.
    pub(super) inverse: &'a [Vec<f64>],
    pub(super) units: Units,
}

/// A linear form in both kinds of variables.
pub(super) struct Form {
    /// In thetas and ds of rows, as the model keeps it.
    pub(super) linear: Linear,
    /// The same in q: coefficients, and the constant on the same side.
    pub(super) in_q: (Vec<f64>, f64),
    /// Whether it speaks of angles.
    pub(super) of_angles: bool,
}

/// `left = right`, as left - right = 0: the model's constant is on the right-hand side.
pub(super) fn equation(
    text: &Text,
    joints: &Joints,
    diagnostics: &mut Diagnostics,
) -> Option<Form> {
    let sides: Vec<Range<usize>> = split(&text.value, &["="]).0;
    let [left, right] = sides.as_slice() else {
        let message = if text.value.contains(['<', '>']) {
            "an inequality stands among the equations".to_owned()
        } else {
            format!(
                "a constraint is an equation with one `=`, and this has {}",
                sides.len().saturating_sub(1)
            )
        };
        let help = if text.value.contains(['<', '>']) {
            "write it in `where = [...]`"
        } else {
            "write `left = right`, such as \"theta4 = pi/2 - theta2 - theta3\""
        };
        diagnostics.push(
            Diagnostic::error(catalogue::BAD_CONSTRAINT, message)
                .at(text.span.clone(), "")
                .help(help),
        );
        return None;
    };
    let mut form = difference(text, left, right, joints, diagnostics)?;
    form.linear.constant = form.linear.constant.times(-1.0);
    form.in_q.1 = -form.in_q.1;
    Some(form)
}

/// `left <= right` and its likes, as left - right <= 0.
pub(super) fn inequality(
    text: &Text,
    joints: &Joints,
    diagnostics: &mut Diagnostics,
) -> Option<Filter> {
    let (sides, operators) = split(&text.value, &["<=", ">=", "<", ">"]);
    let ([left, right], [operator]) = (sides.as_slice(), operators.as_slice()) else {
        let (message, help) = if operators.is_empty() && text.value.contains('=') {
            (
                "an equation stands among the inequalities",
                "write it in `constraints = [...]`",
            )
        } else {
            (
                "an entry of `where` is one inequality",
                "write `left <= right`, such as \"theta3 <= 0\"; two bounds are two entries",
            )
        };
        diagnostics.push(
            Diagnostic::error(catalogue::BAD_CONSTRAINT, message)
                .at(text.span.clone(), "")
                .help(help),
        );
        return None;
    };
    let (least, greatest) = if operator.starts_with('<') {
        (left, right)
    } else {
        (right, left)
    };
    let form = difference(text, least, greatest, joints, diagnostics)?;
    if form.linear.terms.is_empty() {
        diagnostics.push(says_nothing(text));
        return None;
    }
    Some(Filter {
        form: form.linear,
        strict: !operator.ends_with('='),
    })
}

/// No joint is left in it.
pub(super) fn says_nothing(text: &Text) -> Diagnostic {
    Diagnostic::error(
        catalogue::REDUNDANT,
        "no joint is left in it, so it says nothing",
    )
    .at(text.span.clone(), "")
    .help("leave it out")
}

/// The parts between operators, and the operators.
fn split<'a>(text: &str, operators: &[&'a str]) -> (Vec<Range<usize>>, Vec<&'a str>) {
    let (mut parts, mut found) = (Vec::new(), Vec::new());
    let (mut start, mut at) = (0, 0);
    while let Some(rest) = text.get(at..).filter(|rest| !rest.is_empty()) {
        if let Some(operator) = operators
            .iter()
            .find(|operator| rest.starts_with(**operator))
        {
            parts.push(start..at);
            found.push(*operator);
            at += operator.len();
            start = at;
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    parts.push(start..text.len());
    (parts, found)
}

fn difference(
    text: &Text,
    left: &Range<usize>,
    right: &Range<usize>,
    joints: &Joints,
    diagnostics: &mut Diagnostics,
) -> Option<Form> {
    let find = |name: &str, span: Span| variable(name, span, joints);
    let scope = Scope {
        radians_per_angle: joints.units.radians_per_angle(),
        variable: &find,
    };
    let mut sides = [left, right].map(|side| match evaluate_part(text, side.clone(), &scope) {
        Ok(value) => Some(value),
        Err(diagnostic) => {
            diagnostics.push(*diagnostic);
            None
        }
    });
    let (Some(value), Some(other)) = (sides[0].take(), sides[1].take()) else {
        return None;
    };
    let mut value = value;
    value.add(&other, -1.0);
    let form = form(text, &value, joints, diagnostics)?;
    if form.of_angles {
        for side in [left, right] {
            let written = text.value.get(side.clone()).unwrap_or("");
            let Some((digits, in_radians)) = literal_of(written, joints.units) else {
                continue;
            };
            let Ok(number) = digits.parse::<f64>() else {
                continue;
            };
            let blank = written.len() - written.trim_start().len();
            let place = text.place(&(side.start + blank..side.start + written.trim_end().len()));
            let angle = Angle::from_radians(number);
            if let Some(warning) = rounded_angle(digits, in_radians, angle, place) {
                diagnostics.push(warning);
            }
        }
    }
    Some(form)
}

/// Variables are numbered: first theta (or d) of every row, then every q.
fn variable(name: &str, span: Span, joints: &Joints) -> Result<usize, Box<Diagnostic>> {
    let rows = joints.rows;
    let numbered = ["theta", "d", "q"].into_iter().find_map(|letter| {
        let number: usize = name
            .strip_prefix(letter)
            .filter(|digits| digits.starts_with(|c| c != '0' && c != '+'))?
            .parse()
            .ok()?;
        Some((letter, number))
    });
    let named = rows.iter().position(|row| row.name == name);
    if let (Some((letter, number)), Some(named)) = (numbered, named)
        && !(letter == "q" && number == named + 1)
    {
        let message = format!(
            "`{name}` is both {letter} of joint {number} and the name of joint {}",
            named + 1
        );
        let ambiguous = Diagnostic::error(catalogue::UNKNOWN_VARIABLE, message)
            .at(span, "")
            .help(format!("give joint {} another name", named + 1));
        return Err(Box::new(ambiguous));
    }
    let Some((letter, index)) = numbered
        .map(|(letter, number)| (letter, number - 1))
        .or(named.map(|row| ("q", row)))
    else {
        return Err(Box::new(unknown_variable(name, span, rows)));
    };
    let Some(row) = rows.get(index) else {
        let message = format!(
            "`{name}`: there is no joint {}, the table has {}",
            index + 1,
            rows.len()
        );
        let help = "joints are numbered from 1 by their rows, held ones included";
        return Err(Box::new(
            Diagnostic::error(catalogue::UNKNOWN_VARIABLE, message)
                .at(span, "")
                .help(help),
        ));
    };
    match (letter, row.kind, row.variable) {
        ("q", _, Some(variable)) => Ok(rows.len() + variable),
        ("q", _, None) => Err(Box::new(names::held(row, name, span))),
        ("theta", JointKind::Revolute, _) | ("d", JointKind::Prismatic, _) => Ok(index),
        (_, kind, _) => {
            let (kind, right) = if kind == JointKind::Revolute {
                ("revolute", "theta")
            } else {
                ("prismatic", "d")
            };
            let number = index + 1;
            let message = format!(
                "`{name}` is fixed: joint {number} is {kind}, so what varies is {right}{number}"
            );
            let help = format!("write `{right}{number}`");
            Err(Box::new(
                Diagnostic::error(catalogue::UNKNOWN_VARIABLE, message)
                    .at(span, "")
                    .help(help),
            ))
        }
    }
}

fn unknown_variable(name: &str, span: Span, rows: &[Row]) -> Diagnostic {
    let numbers = 1..=rows.len();
    let known: Vec<String> = numbers
        .clone()
        .map(|number| format!("theta{number}"))
        .chain(numbers.map(|number| format!("q{number}")))
        .chain(rows.iter().map(|row| row.name.clone()))
        .chain(["pi".to_owned()])
        .collect();
    let diagnostic = Diagnostic::error(
        catalogue::UNKNOWN_VARIABLE,
        format!("`{}` is no variable", shortened(name)),
    )
    .at(span, "");
    match nearest(name, known.iter().map(String::as_str)) {
        Some(near) => diagnostic.help(format!("write `{near}`")),
        None => diagnostic.help("variables are theta1, theta2, ... (d1, ... of prismatic joints), q1, q2, ... and joint names"),
    }
}

/// A value in both kinds of variables as a form in each.
fn form(
    text: &Text,
    value: &Value,
    joints: &Joints,
    diagnostics: &mut Diagnostics,
) -> Option<Form> {
    let rows = joints.rows;
    let row_of = |variable: usize| match variable.checked_sub(rows.len()) {
        None => Some(variable),
        Some(q) => joints.joints.get(q).copied(),
    };
    let kinds: Vec<JointKind> = value
        .terms
        .keys()
        .filter_map(|variable| rows.get(row_of(*variable)?))
        .map(|row| row.kind)
        .collect();
    let lengths =
        kinds.contains(&JointKind::Prismatic) || (kinds.is_empty() && value.length.is_some());
    let angles =
        kinds.contains(&JointKind::Revolute) || (kinds.is_empty() && value.angle.is_some());
    let bare = value.bare.filter(|bare| *bare != 0.0);
    let other = if lengths { value.angle } else { value.length };
    if (lengths && angles) || other.is_some_and(|other| other != 0.0) {
        let message = "an angle and a length are added";
        let help = "theta and q of revolute joints are angles, d and q of prismatic ones lengths";
        diagnostics.push(
            Diagnostic::error(catalogue::WRONG_UNIT, message)
                .at(text.span.clone(), "")
                .help(help),
        );
        return None;
    }
    let written = if lengths { value.length } else { value.angle };
    if bare.is_some() && written.is_some_and(|written| written != 0.0) {
        diagnostics.push(mixed_units(text));
        return None;
    }
    let exact_or_not = |value: f64| {
        if lengths {
            Angle {
                value,
                fifteenths: (value == 0.0).then_some(0),
            }
        } else {
            Angle::from_radians(value)
        }
    };
    let mut constant = match bare {
        Some(bare) if lengths => exact_or_not(joints.units.length_of(bare)),
        Some(bare) => joints.units.angle_of(bare),
        None => exact_or_not(written.unwrap_or(0.0)),
    };

    let size = joints.joints.len();
    let mut in_q = (vec![0.0; size], constant.value);
    let mut terms: BTreeMap<usize, f64> = BTreeMap::new();
    let at_zero = |row: &Row| {
        if row.kind == JointKind::Revolute {
            row.theta
        } else {
            exact_or_not(row.d)
        }
    };
    let sum = |one: Angle, two: Angle| {
        if lengths {
            exact_or_not(one.value + two.value)
        } else {
            one.plus(two)
        }
    };
    let product = |angle: Angle, factor: f64| {
        if lengths {
            exact_or_not(angle.value * factor)
        } else {
            angle.times(factor)
        }
    };
    for (&variable, &coefficient) in &value.terms {
        if let Some(q) = variable.checked_sub(rows.len()) {
            // q = inverse * (theta - theta at zero)
            if let Some(entry) = in_q.0.get_mut(q) {
                *entry += coefficient;
            }
            for (&inverse, &index) in joints.inverse.get(q)?.iter().zip(joints.joints) {
                if inverse != 0.0 {
                    *terms.entry(index).or_insert(0.0) += coefficient * inverse;
                    constant = sum(
                        constant,
                        product(at_zero(rows.get(index)?), -coefficient * inverse),
                    );
                }
            }
        } else {
            let row = rows.get(variable)?;
            for (entry, moves) in in_q.0.iter_mut().zip(topology::coefficients(row, size)) {
                *entry += coefficient * moves;
            }
            in_q.1 += coefficient * at_zero(row).value;
            if row.terms.is_empty() {
                constant = sum(constant, product(at_zero(row), coefficient));
            } else {
                *terms.entry(variable).or_insert(0.0) += coefficient;
            }
        }
    }
    let largest = value
        .terms
        .values()
        .fold(0.0_f64, |largest, value| largest.max(value.abs()));
    terms.retain(|_, coefficient| coefficient.abs() > 1e-12 * largest);
    let linear = Linear {
        terms: terms.into_iter().collect(),
        constant,
        text: text.value.clone(),
        span: text.span.clone(),
    };
    Some(Form {
        linear,
        in_q,
        of_angles: !lengths,
    })
}
