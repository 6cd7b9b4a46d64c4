//! Constraints and filters of inverse problems: texts -> linear forms in the thetas and ds of rows.

use super::form::Form;
use super::quantity::{literal_of, rounded_angle};
use super::{Angle, Filter, JointKind, Row, Units, names};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, nearest, shortened};
use crate::table::expression::{Scope, evaluate_part};
use crate::table::{Span, Text};
use std::ops::Range;

/// The robot as far as constraints speak of it.
pub(super) struct Joints<'a> {
    pub(super) rows: &'a [Row],
    /// `moving[i]` is the row of `q[i]`.
    pub(super) moving: &'a [usize],
    /// From thetas and ds to q.
    pub(super) inverse: &'a [Vec<f64>],
    pub(super) units: Units,
}

/// `left = right`, as left - right = 0: the model's constant is on the right-hand side.
pub(super) fn equation(text: &Text, joints: &Joints, diagnostics: &mut Diagnostics) -> Option<Form> {
    let sides: Vec<Range<usize>> = split(&text.value, &["="]).0;
    let inequality = text.value.contains(['<', '>']);
    let (false, [left, right]) = (inequality, sides.as_slice()) else {
        let (message, help) = match sides.len() {
            _ if inequality => ("an inequality stands among the equations", "write it in `where = [...]`"),
            3 if text.value.contains("==") => ("a constraint has one `=`", "write `=` for `==`"),
            1 => (
                "a constraint is an equation",
                "write `left = right`, such as `\"theta4 = pi/2 - theta2 - theta3\"`",
            ),
            _ => ("a constraint has one `=`", "write two constraints"),
        };
        diagnostics
            .push(Diagnostic::error(catalogue::BAD_CONSTRAINT, message).at(text.span.clone(), "").help(help));
        return None;
    };
    let mut form = difference(text, left, right, joints, diagnostics)?;
    form.linear.constant = form.linear.constant.times(-1.0);
    form.in_q.1 = -form.in_q.1;
    Some(form)
}

/// `left <= right` and its likes, as left - right <= 0.
pub(super) fn inequality(text: &Text, joints: &Joints, diagnostics: &mut Diagnostics) -> Option<Filter> {
    let (sides, operators) = split(&text.value, &["<=", ">=", "<", ">"]);
    let ([left, right], [operator]) = (sides.as_slice(), operators.as_slice()) else {
        let (message, help) = match operators.len() {
            0 if text.value.contains('=') => {
                ("an equation stands among the inequalities", "write it in `constraints = [...]`")
            }
            2 => ("an entry of `where` is one inequality", "write two entries, one for each bound"),
            _ => {
                ("an entry of `where` is one inequality", "write `left <= right`, such as `\"theta3 <= 0\"`")
            }
        };
        diagnostics
            .push(Diagnostic::error(catalogue::BAD_CONSTRAINT, message).at(text.span.clone(), "").help(help));
        return None;
    };
    let (least, greatest) = if operator.starts_with('<') { (left, right) } else { (right, left) };
    let form = difference(text, least, greatest, joints, diagnostics)?;
    if form.linear.terms.is_empty() {
        diagnostics.push(says_nothing(text));
        return None;
    }
    let (linear, q) = form.written;
    Some(Filter { form: linear, q, strict: !operator.ends_with('=') })
}

/// No joint is left in it.
pub(super) fn says_nothing(text: &Text) -> Diagnostic {
    Diagnostic::error(catalogue::REDUNDANT, "no joint is left in it, so it says nothing")
        .at(text.span.clone(), "")
        .help("leave it out")
}

/// The parts between operators, and the operators.
fn split<'a>(text: &str, operators: &[&'a str]) -> (Vec<Range<usize>>, Vec<&'a str>) {
    let (mut parts, mut found) = (Vec::new(), Vec::new());
    let (mut start, mut at) = (0, 0);
    while let Some(rest) = text.get(at..).filter(|rest| !rest.is_empty()) {
        if let Some(operator) = operators.iter().find(|operator| rest.starts_with(**operator)) {
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
    let scope = Scope { radians_per_angle: joints.units.radians_per_angle(), variable: &find };
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
    let form = Form::of(text, &value, joints, diagnostics)?;
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
        let message =
            format!("`{name}` is both {letter} of joint {number} and the name of joint {}", named + 1);
        let ambiguous = Diagnostic::error(catalogue::UNKNOWN_VARIABLE, message)
            .at(span, "")
            .help(format!("give joint {} another name", named + 1));
        return Err(Box::new(ambiguous));
    }
    let Some((letter, index)) =
        numbered.map(|(letter, number)| (letter, number - 1)).or(named.map(|row| ("q", row)))
    else {
        return Err(Box::new(unknown_variable(name, span, rows)));
    };
    let Some(row) = rows.get(index) else {
        let message = format!("`{name}`: there is no joint {}, the table has {}", index + 1, rows.len());
        let help = "joints are numbered from 1 by their rows, held ones included";
        return Err(Box::new(
            Diagnostic::error(catalogue::UNKNOWN_VARIABLE, message).at(span, "").help(help),
        ));
    };
    match (letter, row.kind, row.variable) {
        ("q", _, Some(variable)) => Ok(rows.len() + variable),
        ("q", _, None) => Err(Box::new(names::held(row, name, span))),
        ("theta", JointKind::Revolute, _) | ("d", JointKind::Prismatic, _) => Ok(index),
        (_, kind, _) => {
            let (kind, right) =
                if kind == JointKind::Revolute { ("revolute", "theta") } else { ("prismatic", "d") };
            let number = index + 1;
            let message =
                format!("`{name}` is fixed: joint {number} is {kind}, so what varies is {right}{number}");
            let help = format!("write `{right}{number}`");
            Err(Box::new(Diagnostic::error(catalogue::UNKNOWN_VARIABLE, message).at(span, "").help(help)))
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
    let diagnostic =
        Diagnostic::error(catalogue::UNKNOWN_VARIABLE, format!("`{}` is no variable", shortened(name)))
            .at(span, "");
    match nearest(name, known.iter().map(String::as_str)) {
        Some(near) => diagnostic.help(format!("write `{near}`")),
        None => diagnostic.help(
            "variables are theta1, theta2, ... (d1, ... of prismatic joints), q1, q2, ... and joint names",
        ),
    }
}
