//! Why there is no solution, in the table's units.

use crate::failure::Refusal;
use crate::json::Json;
use crate::rule;
use crate::units::{Units, fixed};
use dh_codegen::model::{Model, Problem};
use dh_codegen::plan::{Function, Measure};
use dh_core::{IkError, Reachable, Step};

/// An error of a problem (the full pose where there is none) that a function solves.
pub(super) fn of(error: &IkError, model: &Model, problem: Option<&Problem>, function: &Function) -> Refusal {
    let units = Units::of(model);
    match *error {
        IkError::Singular { joint, gap } => singular(model, function, joint, gap),
        IkError::Unreachable { step, excess } => unreachable(model, function, step, excess),
        IkError::OutsideLimits { joint, value, min, max } => {
            let mut refusal = rule::outside(units, joint, value, min, max);
            refusal.message =
                format!("no solution is within the limits; in the one nearest to them {}", refusal.message);
            refusal.help("--all shows every solution, whatever the limits")
        }
        IkError::Forbidden { rule } => {
            let conditions: Vec<&str> = problem
                .map(|problem| problem.filters.iter().map(|filter| filter.form.text.as_str()).collect())
                .unwrap_or_default();
            let mut refusal = rule::forbidden(model, &rule, &conditions);
            if !matches!(rule, dh_core::Rule::Where { .. }) {
                refusal.message = format!("no solution is allowed: {}", refusal.message);
                refusal = refusal.help("--all shows every solution, whatever the limits and rules");
            }
            refusal
        }
        IkError::NotFinite => Refusal::new("not_finite", error.to_string()),
        IkError::NotRigid { error: off } => {
            Refusal::new("not_rigid", "the target's quaternion or direction has no length")
                .with("off_by", off)
        }
        IkError::Failed { position_error, rotation_error } => {
            let message = format!(
                "no joint values reach the target: the best candidate misses it by {position_error:.3e} m and {rotation_error:.3e} rad"
            );
            Refusal::new("failed", message)
                .with("position_error", position_error)
                .with("rotation_error", rotation_error)
        }
        _ => Refusal::new("wrong_target", error.to_string()),
    }
}

/// What is computed of the target's finite numbers is not finite.
pub(super) fn too_far() -> Refusal {
    Refusal::new(
        "too_far",
        "the target is so far away that the squares of its numbers exceed what can be computed",
    )
}

/// The nearest target that can be reached, besides.
pub(super) fn with_nearest(refusal: Refusal, units: Units<'_>, nearest: &Reachable) -> Refusal {
    let Reachable { tool, position_error, rotation_error, .. } = nearest;
    let position = units.point(tool.translation).map(|x| units.show_length(x)).join(",");
    let quaternion = tool.quaternion().map(|x| fixed(x, 6)).join(",");
    let q: Vec<String> = units.joints(nearest.q()).into_iter().map(|value| fixed(value, 4)).collect();
    let off = format!(
        "off by {} {} and {} {}",
        units.show_length(units.length(*position_error)),
        units.length_name(),
        units.show_angle(units.angle(*rotation_error)),
        units.angle_name()
    );
    let text = format!(
        "the nearest that was found within the limits and rules is {off}: position {position}, quaternion {quaternion}, with the joints at {}",
        q.join(",")
    );
    let text = match &refusal.help {
        Some(help) => format!("{help}\nhelp: {text}"),
        None => text,
    };
    let fields = vec![
        ("pose", units.pose(tool)),
        ("position_error", (*position_error).into()),
        ("rotation_error", (*rotation_error).into()),
        ("q", Json::numbers(units.joints(nearest.q()))),
    ];
    refusal.with("nearest", Json::Object(fields)).help(text)
}

/// The coefficients of a step's unknown vanish.
fn singular(model: &Model, function: &Function, row: usize, gap: f64) -> Refusal {
    let units = Units::of(model);
    let name = model.rows.get(row).map_or("", |row| row.name.as_str());
    let stage = function.stages.iter().find(|stage| stage.rows.trailing_zeros() as usize == row);
    let (dimension, unit) = match stage.map_or(Measure::Ratio, |stage| stage.measure) {
        Measure::Ratio => (0, String::new()),
        Measure::Length => (1, format!(" {}", units.length_name())),
        Measure::Area => (2, format!(" {}^2", units.length_name())),
        Measure::Power(power) => (power, format!(" {}^{power}", units.length_name())),
    };
    let gap = units.power(gap, dimension);
    let unknown = stage.map_or("its equation", |stage| stage.unknown.as_str());
    let message = format!(
        "singular: at this target joint {name} (row {}) has no effect on the equation of {unknown}, and {gap:.6}{unit} is missing there",
        row + 1
    );
    Refusal::new("singular", message)
        .with("row", row + 1)
        .with("name", name)
        .with("unknown", unknown)
        .with("gap", gap)
        .with("unit", unit.trim())
}

/// The argument of a step leaves its domain.
fn unreachable(model: &Model, function: &Function, step: Step, excess: f64) -> Refusal {
    let units = Units::of(model);
    let stage = function.stages.get(usize::from(step.index));
    let unknown = stage.map_or("?", |stage| stage.unknown.as_str());
    let rows = (0..u32::BITS as usize).filter(|row| step.rows & (1 << row) != 0);
    let names: Vec<&str> =
        rows.clone().filter_map(|row| model.rows.get(row)).map(|row| row.name.as_str()).collect();
    let (excess, unit, by) = if step.excess_is_length() {
        let excess = units.length(excess);
        let unit = units.length_name();
        (excess, unit, format!("{} {unit} are missing", units.show_length(excess)))
    } else {
        (excess, "ratio", format!("its argument exceeds the domain by {}", percent(excess * 100.0)))
    };
    // All joints at once: what is said of a polynomial's value is no excess.
    let at_once = function.searches(usize::from(step.index));
    if at_once {
        let message = format!("out of reach: no value of {unknown} leads to the target");
        let equation = stage.map_or("", |stage| stage.equation.as_str());
        return Refusal::new("unreachable", message)
            .with("step", usize::from(step.index) + 1)
            .with("unknown", unknown)
            .help(format!("{unknown} is found where {equation}"));
    }
    let message = format!(
        "out of reach: step {} ({unknown}, joint {}) has no root, {by}",
        step.index + 1,
        names.join(" + ")
    );
    let equation = stage.map_or("", |stage| stage.equation.as_str());
    let list = |items: Vec<Json>| Json::List(items);
    let refusal = Refusal::new("unreachable", message)
        .with("step", usize::from(step.index) + 1)
        .with("unknown", unknown)
        .with("rows", list(rows.map(|row| Json::from(row + 1)).collect()))
        .with("joints", list(names.iter().map(|name| Json::from(*name)).collect()))
        .with("excess", excess)
        .with("unit", unit);
    if equation.is_empty() {
        refusal
    } else {
        refusal.help(format!("the equation of this step is {equation}"))
    }
}

/// With as many digits as say something.
fn percent(percent: f64) -> String {
    if percent < 0.05 { format!("{percent:.1e} %") } else { format!("{percent:.2} %") }
}
