//! The rows.

use super::quantity::{Converter, word};
use super::{Angle, JointKind, Row, names, servos};
use crate::diagnostic::{Diagnostic, catalogue, shortened};
use crate::table::{Joint, Number, Table};

/// The rows of the table, with what could be read of each.
pub(super) fn rows(table: &Table, converter: &mut Converter) -> Vec<Row> {
    let mut variables = 0;
    let mut rows: Vec<Row> = Vec::new();
    for (index, joint) in table.joints.iter().enumerate().take(super::check::MOST_ROWS) {
        let variable = joint.fixed.is_none().then_some(variables);
        variables += usize::from(variable.is_some());
        rows.push(row(index, joint, variable, converter));
    }
    // Joints are coupled by name, so after all of them are known.
    for (index, joint) in table.joints.iter().enumerate().take(rows.len()) {
        couple(&mut rows, index, joint, converter);
    }
    rows
}

fn row(index: usize, joint: &Joint, variable: Option<usize>, converter: &mut Converter) -> Row {
    let kinds = [("revolute", JointKind::Revolute), ("prismatic", JointKind::Prismatic)];
    let kind = match &joint.kind {
        Some(text) => word(text, "type of joint", &kinds, converter.diagnostics),
        None => Some(JointKind::Revolute),
    };
    if let Some(kind) = kind {
        what_q_varies_is_not_given(joint, kind, converter);
    }
    let known = kind.is_some();
    let kind = kind.unwrap_or(JointKind::Revolute);
    let direction = direction(joint, converter);
    let mut row = Row {
        name: joint.name.as_ref().map_or_else(|| format!("J{}", index + 1), |name| name.value.clone()),
        kind,
        d: 0.0,
        a: length(joint.a.as_ref(), converter),
        alpha: angle(joint.alpha.as_ref(), converter),
        beta: angle(joint.beta.as_ref(), converter),
        theta: Angle::ZERO,
        shift: 0.0,
        terms: variable.map(|variable| (variable, direction)).into_iter().collect(),
        variable,
        limits: None,
        max_velocity: None,
        max_acceleration: None,
        max_jerk: None,
        servo: None,
        span: joint.span.clone(),
        line: joint.line,
    };
    // What is in the unit of a joint whose type is not known says nothing.
    if !known {
        return row;
    }
    match kind {
        JointKind::Revolute => {
            row.d = length(joint.d.as_ref(), converter);
            let held = angle(joint.fixed.as_ref(), converter).times(direction);
            row.theta = angle(joint.offset.as_ref(), converter).plus(held);
        }
        JointKind::Prismatic => {
            row.theta = angle(joint.theta.as_ref(), converter);
            row.d = length(joint.offset.as_ref(), converter)
                + direction * length(joint.fixed.as_ref(), converter);
        }
    }
    row.limits = joint.limits.as_ref().and_then(|limits| converter.joint_limits(limits, kind));
    let mut rate =
        |number: &Option<Number>, key| number.as_ref().and_then(|number| converter.rate(number, kind, key));
    row.max_velocity = rate(&joint.max_velocity, "max_velocity");
    row.max_acceleration = rate(&joint.max_acceleration, "max_acceleration");
    row.max_jerk = rate(&joint.max_jerk, "max_jerk");
    row.servo = joint.servo.as_ref().map(|servo| servos::of_joint(servo, kind, converter));
    row
}

fn length(number: Option<&Number>, converter: &mut Converter) -> f64 {
    number.and_then(|number| converter.length(number)).unwrap_or(0.0)
}

fn angle(number: Option<&Number>, converter: &mut Converter) -> Angle {
    number.and_then(|number| converter.angle(number)).unwrap_or(Angle::ZERO)
}

/// A revolute joint has `d` and no `theta`, a prismatic one `theta` and no `d`.
fn what_q_varies_is_not_given(joint: &Joint, kind: JointKind, converter: &mut Converter) {
    let (key, span, number, name, varies) = match kind {
        JointKind::Revolute => ("theta", &joint.theta_key, &joint.theta, "revolute", "turns"),
        JointKind::Prismatic => ("d", &joint.d_key, &joint.d, "prismatic", "moves"),
    };
    let Some(number) = number else { return };
    let written = super::quantity::written(number);
    converter.diagnostics.push(
        Diagnostic::error(
            catalogue::WRONG_JOINT_TYPE,
            format!("a {name} joint has no `{key}`: that is what its q {varies}"),
        )
        .at(span.clone(), "")
        .help(format!("write `offset = {written}` for the {key} at q = 0"))
        .help(format!("write `fixed = {written}` if the joint is held there")),
    );
}

/// 1 or -1.
fn direction(joint: &Joint, converter: &mut Converter) -> f64 {
    let Some(number) = &joint.direction else {
        return 1.0;
    };
    match converter.plain(number) {
        Some(value) if value.abs() == 1.0 => value,
        Some(_) => {
            converter.diagnostics.push(
                Diagnostic::error(catalogue::WRONG_VALUE, "`direction` is 1 or -1")
                    .at(number.span(), "")
                    .help(
                        "write `direction = -1` if the maker counts the other way round, else leave it out",
                    ),
            );
            1.0
        }
        None => 1.0,
    }
}

/// Adds the multiples of other joints' q.
fn couple(rows: &mut [Row], index: usize, joint: &Joint, converter: &mut Converter) {
    for (name, number) in &joint.couple {
        let coefficient = converter.plain(number);
        let Some(own) = rows.get(index) else { return };
        if own.name == name.value && own.variable.is_some() {
            converter.diagnostics.push(
                Diagnostic::error(
                    catalogue::WRONG_VALUE,
                    format!("`{}` is coupled to itself", shortened(&name.value)),
                )
                .at(name.span.clone(), "")
                .help("its own q counts once, with the sign of `direction`: leave it out"),
            );
            continue;
        }
        let Some(variable) = names::variable(rows, name, converter.diagnostics) else {
            continue;
        };
        let Some(coefficient) = coefficient.filter(|value| *value != 0.0) else {
            continue;
        };
        let other = rows.iter().find(|row| row.variable == Some(variable)).map_or(own.kind, |row| row.kind);
        let scale = if other == own.kind {
            1.0
        } else {
            converter.units.per_unit(own.kind) / converter.units.per_unit(other)
        };
        if let Some(row) = rows.get_mut(index) {
            row.terms.push((variable, coefficient * scale));
            row.terms.sort_by_key(|(index, _)| *index);
        }
    }
}
