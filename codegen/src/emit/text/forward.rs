//! Pose and Jacobian.

use super::algebra::Sum;
use super::layout::Text;
use super::scope::{Scope, SinCos, Writer};
use super::variables::{self, Form};
use crate::model::{JointKind, Model};
use crate::plan::{Function, FunctionKind, Scalar, Step};
use std::collections::BTreeSet;

/// Entries of `[R | p]`, row after row.
const POSE: [&str; 12] = ["r11", "r12", "r13", "px", "r21", "r22", "r23", "py", "r31", "r32", "r33", "pz"];
/// In the order of a textbook: the rotation, then the position.
const ORDER: [usize; 12] = [0, 1, 2, 4, 5, 6, 8, 9, 10, 3, 7, 11];

/// One forward function. `printed` are sines that were explained before.
pub(super) fn print<'a>(
    writer: &mut Writer<'a>,
    function: &'a Function,
    printed: &mut BTreeSet<String>,
    text: &mut Text,
) {
    let model = writer.model;
    let slides: BTreeSet<String> = slides(model).collect();
    let kept = function.values.iter().map(String::as_str).filter(|name| slides.contains(*name)).collect();
    let mut scope = Scope::new(writer, function, kept);
    let mut angles: Vec<(SinCos, &Scalar)> = Vec::new();
    let mut definitions: Vec<(&str, Sum)> = Vec::new();
    for step in &function.steps {
        match step {
            Step::Let { name, value } => {
                let sum = scope.define(*name, value);
                let written = sum.filter(|_| !slides.contains(scope.name(*name)));
                definitions.extend(written.map(|sum| (scope.name(*name), sum)));
            }
            Step::SinCos { sin, cos, angle } => angles.push((scope.sin_cos(*sin, *cos), angle)),
            Step::Solve { .. }
            | Step::General { .. }
            | Step::Descents { .. }
            | Step::Near { .. }
            | Step::Accept { .. } => {}
        }
    }
    let outputs: Vec<Sum> = function.outputs.iter().map(|output| scope.sum(output)).collect();
    let lines: Vec<String> = match function.kind {
        FunctionKind::Jacobian => jacobian(model, &outputs),
        _ => pose(&outputs),
    };
    let definitions: Vec<String> = definitions.iter().map(|(name, sum)| format!("{name} = {sum}")).collect();
    let written = || definitions.iter().chain(&lines);
    let abbreviations: Vec<[String; 2]> = angles
        .iter()
        .filter(|(angle, _)| written().any(|line| names(line, &angle.sin) || names(line, &angle.cos)))
        .map(|(angle, argument)| {
            let text = angle_text(model, &scope, angle, argument);
            [format!("{} = sin({text})", angle.sin), format!("{} = cos({text})", angle.cos)]
        })
        .filter(|[sin, _]| printed.insert(sin.clone()))
        .collect();
    text.line(0, heading(&function.kind));
    if !abbreviations.is_empty() {
        text.columns(1, &abbreviations);
        text.gap();
    }
    written().for_each(|line| text.line(1, line));
}

fn heading(kind: &FunctionKind) -> &'static str {
    match kind {
        FunctionKind::Jacobian => {
            "Geometric Jacobian: rows vx vy vz wx wy wz of the tool in base axes, a column a joint (per rad or length)"
        }
        _ => "Forward kinematics: the tool frame in the base frame, axes r, origin p",
    }
}

/// Names of the lengths that vary.
fn slides(model: &Model) -> impl Iterator<Item = String> {
    let rows = model.rows.iter().enumerate();
    let slide = rows.filter(|(_, row)| row.kind == JointKind::Prismatic && !row.terms.is_empty());
    slide.map(|(index, row)| variables::variable(row.kind, index))
}

fn pose(outputs: &[Sum]) -> Vec<String> {
    let entry = |place: usize| Some(format!("{} = {}", POSE.get(place)?, outputs.get(place)?));
    ORDER.into_iter().filter_map(entry).collect()
}

/// Column after column.
fn jacobian(model: &Model, outputs: &[Sum]) -> Vec<String> {
    let separator = if model.joints.len() > 9 { "_" } else { "" };
    let name = |at: usize| format!("J{}{separator}{}", at % 6 + 1, at / 6 + 1);
    outputs.iter().enumerate().map(|(at, sum)| format!("{} = {sum}", name(at))).collect()
}

/// The angle that a name speaks of: in theta, else in q.
fn angle_text(model: &Model, scope: &Scope<'_, '_>, angle: &SinCos, argument: &Scalar) -> String {
    let whole = scope.form(argument).map(|mut form| {
        form.coefficients.truncate(model.joints.len());
        Form { constant: form.constant + angle.quarters, ..form }
    });
    let sum = whole.as_ref().and_then(|whole| variables::sum_of_thetas(model, &angle.suffix, whole));
    sum.or_else(|| whole.map(|whole| variables::in_q(model, &whole))).unwrap_or_default()
}

/// Whether a name occurs in a line, as a whole word.
fn names(line: &str, name: &str) -> bool {
    line.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == name)
}
