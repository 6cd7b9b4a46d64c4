//! Broken limits and rules, in the table's units.

use crate::failure::Refusal;
use crate::json::Json;
use crate::units::Units;
use dh_codegen::model::{JointKind, Model};
use dh_core::{Rule, Side, Violation};

/// A joint outside its limits (rad or m).
pub(crate) fn outside(units: Units<'_>, joint: usize, value: f64, min: f64, max: f64) -> Refusal {
    let (kind, name) = units.joint(joint);
    let [value, min, max] = [value, min, max].map(|x| units.variable(kind, x));
    let excess = (min - value).max(value - max);
    let show = |x: f64| units.show(kind, x);
    let message = format!(
        "joint {} ({name}) at {} {unit} is {} {unit} outside its limits {} to {}",
        joint + 1,
        show(value),
        show(excess),
        show(min),
        show(max),
        unit = units.name(kind)
    );
    Refusal::new("outside_limits", message)
        .with("joint", joint + 1)
        .with("name", name)
        .with("value", value)
        .with("min", min)
        .with("max", max)
        .with("excess", excess)
}

/// A rule other than the limits of one joint. `conditions` are the `where` of the inverse problem.
pub(crate) fn forbidden(model: &Model, rule: &Rule, conditions: &[&str]) -> Refusal {
    let units = Units::of(model);
    match *rule {
        Rule::Sum { index, value, min, max } => sum(model, index, [value, min, max]),
        Rule::Bound { bound, value } => {
            let [value, limit] = [value, bound.value].map(|x| units.length(x));
            let (relation, key) = match bound.side {
                Side::Min => ("below", "min"),
                Side::Max => ("above", "max"),
            };
            let unit = units.length_name();
            let message = format!(
                "the tool point's {} of {} {unit} is {} {unit} {relation} {}_{key} = {}",
                bound.axis,
                units.show_length(value),
                units.show_length((value - limit).abs()),
                bound.axis,
                units.show_length(limit)
            );
            let axis = bound.axis.to_string();
            refusal("bound", message).with("axis", axis.as_str()).with("value", value).with(key, limit)
        }
        Rule::KeepOut { index, position } => {
            let position = units.point(position);
            let message = format!(
                "the tool point {} {} is in keep-out box {}",
                position.map(|x| units.show_length(x)).join(", "),
                units.length_name(),
                index + 1
            );
            refusal("keep_out", message).with("box", index + 1).with("position", Json::numbers(position))
        }
        Rule::Where { index, excess } => {
            let condition = conditions.get(index).copied().unwrap_or_default();
            let message =
                format!("the only solutions break `{condition}`, the nearest by {excess:.6} rad or m");
            refusal("where", message).with("condition", index + 1).with("excess_si", excess)
        }
        _ => refusal("other", rule.to_string()),
    }
}

/// A sum of joints outside its range (rad or m).
fn sum(model: &Model, index: usize, numbers: [f64; 3]) -> Refusal {
    let units = Units::of(model);
    let terms = model.sums.get(index).map(|sum| sum.terms.as_slice()).unwrap_or_default();
    let kind = terms.first().map_or(JointKind::Revolute, |(joint, _)| units.joint(*joint).0);
    let [value, min, max] = numbers.map(|x| units.variable(kind, x));
    let term = |(joint, factor): &(usize, f64)| match *factor {
        1.0 => units.joint(*joint).1.to_owned(),
        -1.0 => format!("-{}", units.joint(*joint).1),
        factor => format!("{factor} {}", units.joint(*joint).1),
    };
    let written = terms.iter().map(term).collect::<Vec<_>>().join(" + ").replace("+ -", "- ");
    let show = |x: f64| units.show(kind, x);
    let message = format!(
        "{written} at {} {unit} is {} {unit} outside its range {} to {}",
        show(value),
        show((min - value).max(value - max)),
        show(min),
        show(max),
        unit = units.name(kind)
    );
    refusal("sum", message)
        .with("sum", index + 1)
        .with("value", value)
        .with("min", min)
        .with("max", max)
        .with("excess", (min - value).max(value - max))
}

fn refusal(rule: &str, message: String) -> Refusal {
    Refusal::new("forbidden", message).with("rule", rule)
}

/// What joint values break.
pub(crate) fn violation(model: &Model, violation: &Violation<'_>) -> Refusal {
    match violation {
        Violation::OutsideLimits { joint, value, min, max, .. } => {
            outside(Units::of(model), *joint, *value, *min, *max)
        }
        Violation::Forbidden(rule) => forbidden(model, rule, &[]),
        other => Refusal::new("invalid", other.to_string()),
    }
}
