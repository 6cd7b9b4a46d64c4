//! What the generated documentation says: the table as it was written, and what each function computes.

use super::text::{clean, escaped, wrapped};

use crate::model::{
    AngleUnit, Convention, JointKind, LengthUnit, Limits, Model, Placement, Rotation, Row, Units,
};
use crate::plan::{Counts, Function, Step};

/// Columns of an equation in documentation.
const EQUATION_WIDTH: usize = 80;

/// Documentation of the struct, a paragraph each.
pub(super) fn of_robot(model: &Model, reach: &str) -> Vec<String> {
    let maker = model.manufacturer.as_ref().map_or(String::new(), |maker| format!("{} ", escaped(maker)));
    let mut paragraphs =
        vec![format!("Kinematics of the {maker}{}: {}.", escaped(&model.name), joints(model))];
    paragraphs.extend(model.source.as_ref().map(|source| format!("Numbers from: {}", escaped(source))));
    let hayati = model.rows.iter().any(|row| !row.beta.is_zero());
    paragraphs.push(format!(
        "Denavit-Hartenberg table, {}, lengths in {}, angles in {}:",
        convention(model.convention, hayati),
        length_unit(model.units),
        angle_unit(model.units)
    ));
    paragraphs.push(table(model, hayati));
    let frames: Vec<_> = [("Base", &model.base), ("Tool", &model.tool)]
        .into_iter()
        .filter_map(|(name, placement)| Some(format!("{name}: {}.", placed(placement, model.units)?)))
        .collect();
    if !frames.is_empty() {
        paragraphs.push(frames.join(" "));
    }
    paragraphs.push(format!(
        "Reach: {reach} m. The methods take and return metres and radians, whatever the units of the table."
    ));
    paragraphs
}

/// "6 multiplications, 2 additions and 1 sine-cosine pair".
pub(super) fn operations(counts: Counts) -> String {
    let plural = |count: usize, noun: &str| format!("{count} {noun}{}", if count == 1 { "" } else { "s" });
    let arguments = match counts.angle_add {
        0 => String::new(),
        adds => format!(" (and {} in their arguments)", plural(adds, "addition")),
    };
    format!(
        "{}, {}, {}{arguments}.",
        plural(counts.mul, "multiplication"),
        plural(counts.add, "addition"),
        plural(counts.sincos, "sine-cosine pair")
    )
}

/// The solving steps of an inverse function, as lines that are not prose.
pub(super) fn stages(function: &Function) -> Option<String> {
    let mut lines = vec!["```text".to_owned()];
    for (index, stage) in function.stages.iter().enumerate() {
        let sign = function.sign(index).map_or_else(Vec::new, |sign| wrapped(&clean(&sign), EQUATION_WIDTH));
        let equation: Vec<_> =
            stage.equation.split("; ").flat_map(|row| wrapped(&clean(row), EQUATION_WIDTH)).collect();
        let origin = wrapped(&format!("({})", clean(&stage.origin)), EQUATION_WIDTH);
        let definition =
            |(name, value): &(String, String)| wrapped(&clean(&format!("{name} = {value}")), EQUATION_WIDTH);
        let definitions: Vec<_> = stage.definitions.iter().flat_map(definition).collect();
        for (i, line) in equation.iter().chain(&definitions).chain(&origin).chain(&sign).enumerate() {
            let head = if i == 0 { format!("{}:", stage.unknown) } else { String::new() };
            lines.push(format!("{head:<9} {line}"));
        }
    }
    lines.push("```".to_owned());
    (!function.stages.is_empty()).then(|| lines.join("\n"))
}

/// How a nearly special arm is solved.
pub(super) fn meant(function: &Function) -> Option<String> {
    let [Step::Near { meant, .. }] = function.steps.as_slice() else { return None };
    Some(format!(
        "Solved as the arm that was meant ({}); each solution is brought to the target by Newton's method on the table as \
         written. Near singular poses also along the curve of what is missing, or the last step below solves the table as \
         it is.",
        clean(meant)
    ))
}

/// Unit of joint values: "rad", "m" or both.
pub(super) fn joint_units(model: &Model) -> &'static str {
    let slides = |row: &usize| model.rows.get(*row).is_some_and(|row| row.kind == JointKind::Prismatic);
    match model.joints.iter().filter(|row| slides(row)).count() {
        0 => "rad",
        prismatic if prismatic == model.joints.len() => "m",
        _ => "rad, or m for joints that slide",
    }
}

fn joints(model: &Model) -> String {
    let kind = |kind| {
        model.joints.iter().filter_map(|row| model.rows.get(*row)).filter(|row| row.kind == kind).count()
    };
    let (turning, sliding) = (kind(JointKind::Revolute), kind(JointKind::Prismatic));
    let count =
        |count: usize, kind: &str| format!("{count} {kind} joint{}", if count == 1 { "" } else { "s" });
    match (turning, sliding) {
        (_, 0) => count(turning, "revolute"),
        (0, _) => count(sliding, "prismatic"),
        _ => format!("{turning} revolute and {}", count(sliding, "prismatic")),
    }
}

fn convention(convention: Convention, hayati: bool) -> String {
    let beta = if hayati { " Ry(beta)" } else { "" };
    match convention {
        Convention::Standard => {
            format!("standard (distal) convention A = Rz(theta) Tz(d) Tx(a) Rx(alpha){beta}")
        }
        Convention::Modified => {
            format!("modified (proximal) convention A = Tx(a) Rx(alpha){beta} Rz(theta) Tz(d)")
        }
    }
}

/// The rows as a Markdown table, in the units in which they were written.
fn table(model: &Model, hayati: bool) -> String {
    let mut lines = Vec::new();
    let beta = if hayati { " beta |" } else { "" };
    lines.push(format!("| joint | theta | d | a | alpha |{beta} limits |"));
    lines.push(format!("|---|---|---|---|---|{}---|", if hayati { "---|" } else { "" }));
    for row in &model.rows {
        let revolute = row.kind == JointKind::Revolute;
        let (theta, d) = if revolute {
            (form(row.theta.value, row, model), length(row.d, model.units))
        } else {
            (angle(row.theta.value, model.units), form(row.d, row, model))
        };
        let beta = if hayati { format!(" {} |", angle(row.beta.value, model.units)) } else { String::new() };
        let (a, alpha) = (length(row.a, model.units), angle(row.alpha.value, model.units));
        let limits = row.limits.map_or("-".to_owned(), |limits| range(limits, row.kind, model.units));
        let held = if row.variable.is_none() { " (held)" } else { "" };
        lines.push(format!(
            "| {}{held} | {theta} | {d} | {a} | {alpha} |{beta} {limits} |",
            escaped(&row.name)
        ));
    }
    lines.join("\n")
}

/// theta of a revolute row or d of a prismatic one, as a form in the joint variables: `q3 - q2 + 90`.
fn form(zero: f64, row: &Row, model: &Model) -> String {
    let mut terms = Vec::new();
    for &(joint, coefficient) in &row.terms {
        let Some(&source) = model.joints.get(joint) else { continue };
        let Some(other) = model.rows.get(source) else { continue };
        // SI to the table's units, where the two rows are of unlike kinds.
        let coefficient = coefficient * per(row.kind, model.units) / per(other.kind, model.units);
        let factor = match trimmed(coefficient.abs()).as_str() {
            "1" => String::new(),
            factor => format!("{factor} "),
        };
        terms.push((coefficient < 0.0, format!("{factor}q{}", source + 1)));
    }
    let zero = zero * per(row.kind, model.units);
    if zero != 0.0 || terms.is_empty() {
        terms.push((zero < 0.0, trimmed(zero.abs())));
    }
    let signed = |(i, (negative, term)): (usize, &(bool, String))| match (negative, i) {
        (true, 0) => format!("-{term}"),
        (false, 0) => term.clone(),
        (true, _) => format!(" - {term}"),
        (false, _) => format!(" + {term}"),
    };
    terms.iter().enumerate().map(signed).collect()
}

/// A fixed frame in words, where it is one.
fn placed(placement: &Placement, units: Units) -> Option<String> {
    let mut parts = Vec::new();
    if placement.xyz != [0.0; 3] {
        parts.push(format!("x y z {}", placement.xyz.map(|x| length(x, units)).join(" ")));
    }
    match &placement.rotation {
        Rotation::Rpy(rpy) if rpy.iter().any(|a| !a.is_zero()) => {
            parts.push(format!("roll pitch yaw {}", rpy.map(|turn| angle(turn.value, units)).join(" ")));
        }
        Rotation::Rpy(_) => {}
        Rotation::Matrix(rows) => {
            let rows = rows.map(|row| row.map(trimmed).join(" "));
            parts.push(format!("rotation matrix {}", rows.join(", ")));
        }
    }
    (!parts.is_empty()).then(|| parts.join(", "))
}

fn range(limits: Limits, kind: JointKind, units: Units) -> String {
    let factor = per(kind, units);
    format!("{} to {}", trimmed(limits.min * factor), trimmed(limits.max * factor))
}

fn length(value: f64, units: Units) -> String {
    trimmed(value * per(JointKind::Prismatic, units))
}

fn angle(value: f64, units: Units) -> String {
    trimmed(value * per(JointKind::Revolute, units))
}

/// Table units a radian (revolute) or a metre (prismatic).
fn per(kind: JointKind, units: Units) -> f64 {
    match (kind, units.angle, units.length) {
        (JointKind::Revolute, AngleUnit::Degree, _) => 180.0 / core::f64::consts::PI,
        (JointKind::Prismatic, _, LengthUnit::Millimetre) => 1000.0,
        _ => 1.0,
    }
}

fn length_unit(units: Units) -> &'static str {
    match units.length {
        LengthUnit::Metre => "m",
        LengthUnit::Millimetre => "mm",
    }
}

fn angle_unit(units: Units) -> &'static str {
    match units.angle {
        AngleUnit::Radian => "rad",
        AngleUnit::Degree => "deg",
    }
}

/// To ten significant digits, which hides that a number went to SI and back.
pub(super) fn trimmed(value: f64) -> String {
    let rounded: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    let rounded = if rounded == 0.0 { 0.0 } else { rounded };
    format!("{rounded}")
}
