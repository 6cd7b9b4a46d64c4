//! `[workspace]`, `[[limit]]` and `[poses]`.

use super::quantity::{Converter, written};
use super::{Bound, JointKind, KeepOut, NamedPose, Row, SumLimit, Workspace, names};
use crate::diagnostic::{Diagnostic, catalogue, shortened};
use crate::table::{self, BOUNDS};

/// Bounds and boxes.
pub(super) fn workspace(written: &table::Workspace, converter: &mut Converter) -> Workspace {
    let mut bounds: Vec<Bound> = Vec::new();
    for (index, number) in &written.bounds {
        let Some(value) = converter.length(number) else {
            continue;
        };
        let bound = Bound { axis: index / 2, is_min: index % 2 == 0, value };
        let least = bounds.last().filter(|least| least.axis == bound.axis && least.is_min && !bound.is_min);
        if least.is_some_and(|least| least.value > value) {
            let least_key = BOUNDS.get(index.wrapping_sub(1)).copied().unwrap_or("");
            let key = BOUNDS.get(*index).copied().unwrap_or("");
            converter.diagnostics.push(
                Diagnostic::error(
                    catalogue::LIMITS_ORDER,
                    format!("`{least_key}` is above `{key}`, which leaves no place"),
                )
                .at(number.span(), "")
                .help(format!("write the smaller number as `{least_key}`")),
            );
        }
        bounds.push(bound);
    }
    let keep_out = written.keep_out.iter().filter_map(|forbidden| keep_out(forbidden, converter)).collect();
    Workspace { bounds, keep_out }
}

fn keep_out(forbidden: &table::KeepOut, converter: &mut Converter) -> Option<KeepOut> {
    let mut corner = |numbers: &table::Numbers| -> Option<[f64; 3]> {
        let lengths: Vec<Option<f64>> = numbers.value.iter().map(|number| converter.length(number)).collect();
        lengths.into_iter().collect::<Option<Vec<f64>>>()?.try_into().ok()
    };
    let (min, max) = (corner(&forbidden.min), corner(&forbidden.max));
    let (min, max) = (min?, max?);
    let axis = min.iter().zip(&max).position(|(min, max)| min > max);
    if let Some(letter) = axis.and_then(|axis| ["x", "y", "z"].get(axis).copied()) {
        converter.diagnostics.push(
            Diagnostic::error(
                catalogue::LIMITS_ORDER,
                format!("the box has a `min` above its `max` in {letter}"),
            )
            .at(forbidden.min.span.clone(), "")
            .beside(forbidden.max.span.clone(), "")
            .help(format!("write the smaller {letter} in `min`")),
        );
    }
    Some(KeepOut { min, max })
}

/// A limit on a sum of joints, all of them angles or all of them lengths.
pub(super) fn sum_limit(
    limit: &table::SumLimit,
    rows: &[Row],
    converter: &mut Converter,
) -> Option<SumLimit> {
    let mut terms = Vec::new();
    let mut kinds = Vec::new();
    for (name, number) in &limit.of {
        let coefficient = converter.plain(number);
        let Some(variable) = names::variable(rows, name, converter.diagnostics) else {
            continue;
        };
        let Some(row) = rows.iter().find(|row| row.variable == Some(variable)) else {
            continue;
        };
        kinds.push((row.kind, name));
        if let Some(coefficient) = coefficient {
            terms.push((variable, coefficient));
        }
    }
    if limit.of.is_empty() {
        converter.diagnostics.push(
            Diagnostic::error(catalogue::MISSING_KEY, "the limit names no joint")
                .at(limit.span.clone(), "")
                .help("write `of = { J2 = 1, J3 = 1 }`"),
        );
    }
    let kind = kinds.first().map(|(kind, _)| *kind)?;
    if let Some((_, name)) = kinds.iter().find(|(other, _)| *other != kind) {
        converter.diagnostics.push(
            Diagnostic::error(catalogue::WRONG_UNIT, "the sum adds an angle and a length")
                .at(name.span.clone(), "")
                .help("write a limit of revolute joints, or one of prismatic ones"),
        );
        return None;
    }
    let range = converter.joint_limits(&limit.range, kind)?;
    terms.sort_by_key(|(variable, _)| *variable);
    (terms.len() == limit.of.len()).then_some(SumLimit { terms, range })
}

/// A named pose, with a value for each joint and inside all limits.
pub(super) fn pose(
    pose: &table::Pose,
    rows: &[Row],
    joints: &[usize],
    sums: &[SumLimit],
    converter: &mut Converter,
) -> Option<NamedPose> {
    if pose.q.value.len() != joints.len() {
        let held = rows.len() - joints.len();
        let note = if held > 0 && pose.q.value.len() == rows.len() { " (held joints have none)" } else { "" };
        let names: Vec<String> =
            joints.iter().filter_map(|index| rows.get(*index)).map(|row| shortened(&row.name)).collect();
        converter.diagnostics.push(
            Diagnostic::error(
                catalogue::POSE_LENGTH,
                format!(
                    "the pose `{}` has {}, and {} move{note}",
                    shortened(&pose.name.value),
                    count(pose.q.value.len(), "value"),
                    count(joints.len(), "joint"),
                ),
            )
            .at(pose.q.span.clone(), "")
            .help(format!("write one value each for {}", names.join(", "))),
        );
        return None;
    }
    let values: Vec<Option<f64>> = joints
        .iter()
        .zip(&pose.q.value)
        .map(|(index, number)| converter.joint_value(number, rows.get(*index)?.kind))
        .collect();
    let before = converter.diagnostics.errors();
    for ((index, number), value) in joints.iter().zip(&pose.q.value).zip(&values) {
        if let (Some(row), Some(value)) = (rows.get(*index), value) {
            inside_the_limits_of_its_joint(pose, row, number, *value, converter);
        }
    }
    let q: Vec<f64> = values.into_iter().collect::<Option<_>>()?;
    // A joint outside its limits is one mistake, whatever it is added to.
    let sums = if converter.diagnostics.errors() == before { sums } else { &[] };
    for sum in sums {
        let value: f64 = sum.terms.iter().map(|(index, c)| c * q.get(*index).copied().unwrap_or(0.0)).sum();
        if is_outside(value, sum.range) {
            // The arm refuses to go there whatever the table calls it, so this is a doubt and no mistake.
            converter.diagnostics.push(
                Diagnostic::warning(
                    catalogue::POSE_OUTSIDE_LIMITS,
                    format!(
                        "the pose `{}` is outside a `[[limit]]` on a sum of joints",
                        shortened(&pose.name.value)
                    ),
                )
                .at(pose.q.span.clone(), "")
                .help("change the pose, or the limit's `range`"),
            );
        }
    }
    Some(NamedPose { name: pose.name.value.clone(), q, safe: pose.safe })
}

fn inside_the_limits_of_its_joint(
    pose: &table::Pose,
    row: &Row,
    number: &table::Number,
    value: f64,
    converter: &mut Converter,
) {
    let Some(limits) = row.limits.filter(|limits| is_outside(value, *limits)) else {
        return;
    };
    let (unit, name) = match row.kind {
        JointKind::Revolute => (converter.units.radians_per_angle(), converter.units.angle_name()),
        JointKind::Prismatic => (converter.units.per_unit(row.kind), converter.units.length_name()),
    };
    let shown = |value: f64| format!("{}", libm::round(value / unit * 1e6) / 1e6);
    converter.diagnostics.push(
        Diagnostic::error(
            catalogue::POSE_OUTSIDE_LIMITS,
            format!(
                "the pose `{}` has {} at {}, outside its limits {} ... {} {name}",
                shortened(&pose.name.value),
                shortened(&row.name),
                written(number).trim_matches('"'),
                shown(limits.min),
                shown(limits.max),
            ),
        )
        .at(number.span(), "")
        .help("change the pose, or the joint's `limits`"),
    );
}

/// Limits and poses are rounded alike; what is lost in their conversion is no violation.
fn is_outside(value: f64, limits: super::Limits) -> bool {
    const ROUNDING: f64 = 1e-9;
    value < limits.min - ROUNDING || value > limits.max + ROUNDING
}

fn count(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}
