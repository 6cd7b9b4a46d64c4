//! The model's joints and rules in the runtime's words and an interpreter's scalar type.

use super::Program;
use crate::model::{self, Model};
use dh_core::{Axis, Bound, Float, Joint, JointKind, KeepOut, Limits, Servo, Side, SumLimit, Winding};

/// The joints in the order of q.
pub(super) fn joints<S: Float>(model: &Model) -> Vec<Joint<'_, S>> {
    let rows = model.joints.iter().filter_map(|row| model.rows.get(*row));
    rows.map(joint).collect()
}

fn joint<S: Float>(row: &model::Row) -> Joint<'_, S> {
    Joint {
        name: &row.name,
        kind: match row.kind {
            model::JointKind::Revolute => JointKind::Revolute,
            model::JointKind::Prismatic => JointKind::Prismatic,
        },
        limits: row.limits.map(limits),
        max_velocity: row.max_velocity.map(S::from_f64),
        max_acceleration: row.max_acceleration.map(S::from_f64),
        max_jerk: row.max_jerk.map(S::from_f64),
        servo: row.servo.as_ref().map(|servo| Servo {
            id: servo.id,
            scale: S::from_f64(servo.scale),
            zero: S::from_f64(servo.zero),
            range: servo.range.map(limits),
            model: servo.model.as_deref(),
        }),
    }
}

fn limits<S: Float>(limits: model::Limits) -> Limits<S> {
    Limits { min: S::from_f64(limits.min), max: S::from_f64(limits.max) }
}

/// Limits on sums of joints; their terms stand in the program.
pub(super) fn sums<'p, S: Float>(program: &'p Program<'_, S>) -> Vec<SumLimit<'p, S>> {
    let sums = program.model.sums.iter().zip(&program.sum_terms);
    sums.map(|(sum, terms)| SumLimit { terms, range: limits(sum.range) }).collect()
}

/// Whole turns; what they carry stands in the program.
pub(super) fn windings<'p, S: Float>(program: &'p Program<'_, S>) -> Vec<Winding<'p, S>> {
    let windings = program.model.windings.iter().zip(&program.carried);
    windings
        .map(|(winding, carries)| Winding { joint: winding.joint, turn: S::from_f64(winding.turn), carries })
        .collect()
}

/// Bounds on the tool point.
pub(super) fn bounds<S: Float>(model: &Model) -> Vec<Bound<S>> {
    let bound = |bound: &model::Bound| Bound {
        axis: match bound.axis {
            0 => Axis::X,
            1 => Axis::Y,
            _ => Axis::Z,
        },
        side: if bound.is_min { Side::Min } else { Side::Max },
        value: S::from_f64(bound.value),
    };
    model.workspace.bounds.iter().map(bound).collect()
}

/// Boxes that the tool point stays out of.
pub(super) fn keep_out<S: Float>(model: &Model) -> Vec<KeepOut<S>> {
    let corner = |corner: [f64; 3]| corner.map(S::from_f64);
    let boxes = model.workspace.keep_out.iter();
    boxes.map(|keep_out| KeepOut { min: corner(keep_out.min), max: corner(keep_out.max) }).collect()
}
