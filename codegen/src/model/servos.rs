//! Servos: from joint variables to what the device is sent.

use super::quantity::Converter;
use super::{JointKind, Model, NamedServo, Servo};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, shortened};
use crate::table::{self, Number, Span, Table};
use core::f64::consts::{PI, TAU};
use std::collections::HashMap;

/// `servo = {...}` of a joint.
pub(super) fn of_joint(servo: &table::Servo, kind: JointKind, converter: &mut Converter) -> Servo {
    let (right, wrong) = match kind {
        JointKind::Revolute => {
            (("counts_per_turn", &servo.counts_per_turn), ("counts_per_unit", &servo.counts_per_unit))
        }
        JointKind::Prismatic => {
            (("counts_per_unit", &servo.counts_per_unit), ("counts_per_turn", &servo.counts_per_turn))
        }
    };
    if let Some(number) = wrong.1 {
        let name = if kind == JointKind::Revolute { "revolute" } else { "prismatic" };
        converter.diagnostics.push(
            Diagnostic::error(
                catalogue::WRONG_JOINT_TYPE,
                format!("the servo of a {name} joint has `{}`, not `{}`", right.0, wrong.0),
            )
            .at(number.span(), "")
            .help(format!("write `{} = {}`", right.0, super::quantity::written(number))),
        );
    }
    let counts = right.1.as_ref().and_then(|number| positive(number, right.0, converter));
    build(servo, kind, counts, converter)
}

/// `[[servo]]`.
pub(super) fn outside_the_chain(named: &table::NamedServo, converter: &mut Converter) -> NamedServo {
    let servo = &named.servo;
    let kind = if servo.counts_per_unit.is_some() { JointKind::Prismatic } else { JointKind::Revolute };
    let servo = of_joint(servo, kind, converter);
    NamedServo { name: named.name.value.clone(), servo }
}

/// Two servos of one id would both do what either is told.
pub(super) fn ids_differ(table: &Table, model: &Model, diagnostics: &mut Diagnostics) {
    let joints = model.rows.iter().zip(&table.joints);
    let joints = joints.map(|(row, joint)| (row.name.as_str(), row.servo.as_ref(), joint.servo.as_ref()));
    let others = model.servos.iter().zip(&table.servos);
    let others =
        others.map(|(named, written)| (named.name.as_str(), Some(&named.servo), Some(&written.servo)));
    let mut first: HashMap<u32, (&str, Span)> = HashMap::new();
    for (name, servo, written) in joints.chain(others) {
        let (Some(id), Some(place)) =
            (servo.and_then(|servo| servo.id), written.and_then(|written| written.id.as_ref()))
        else {
            continue;
        };
        if let Some((before, span)) = first.get(&id) {
            let message = format!(
                "the servos of `{}` and `{}` have the same id {id}",
                shortened(before),
                shortened(name)
            );
            diagnostics.push(
                Diagnostic::error(catalogue::DUPLICATE_ID, message)
                    .at(place.span(), "the second")
                    .beside(span.clone(), "the first")
                    .help("write the number that each has on the bus; a servo's own is set with its maker's tools"),
            );
        } else {
            first.insert(id, (name, place.span()));
        }
    }
}

fn build(servo: &table::Servo, kind: JointKind, counts: Option<f64>, converter: &mut Converter) -> Servo {
    let per_si = match (kind, counts) {
        (JointKind::Revolute, Some(counts)) => counts / TAU,
        (JointKind::Revolute, None) => 180.0 / PI,
        (JointKind::Prismatic, Some(counts)) => counts / converter.units.per_unit(kind),
        (JointKind::Prismatic, None) => 1000.0,
    };
    let sign = servo.sign.as_ref().map_or(1.0, |number| match converter.plain(number) {
        Some(sign) if sign.abs() == 1.0 => sign,
        Some(_) => {
            converter.diagnostics.push(
                Diagnostic::error(catalogue::WRONG_VALUE, "`sign` is 1 or -1")
                    .at(number.span(), "")
                    .help("write `sign = -1` if the servo counts the other way round, else leave it out"),
            );
            1.0
        }
        None => 1.0,
    });
    Servo {
        id: servo.id.as_ref().and_then(|number| bus_id(number, converter)),
        scale: sign * per_si,
        zero: servo.zero.as_ref().and_then(|number| converter.plain(number)).unwrap_or(0.0),
        range: servo.range.as_ref().and_then(|range| converter.limits(range, Converter::plain)),
        model: servo.model.as_ref().map(|model| model.value.clone()),
    }
}

fn positive(number: &Number, key: &str, converter: &mut Converter) -> Option<f64> {
    let value = converter.plain(number)?;
    if value > 0.0 {
        return Some(value);
    }
    converter.diagnostics.push(
        Diagnostic::error(catalogue::WRONG_VALUE, format!("`{key}` has to be greater than 0"))
            .at(number.span(), "")
            .help("write the number of counts, and `sign = -1` if the servo counts the other way round"),
    );
    None
}

fn bus_id(number: &Number, converter: &mut Converter) -> Option<u32> {
    let value = converter.plain(number)?;
    if value >= 0.0 && value <= f64::from(u32::MAX) && value == libm::floor(value) {
        return Some(value as u32);
    }
    converter.diagnostics.push(
        Diagnostic::error(catalogue::WRONG_VALUE, "`id` is a whole number, 0 or more")
            .at(number.span(), "")
            .help("write the number that the servo has on its bus"),
    );
    None
}
