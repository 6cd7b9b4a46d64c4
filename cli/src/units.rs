//! From the table's units to radians and metres, and back.

use crate::failure::Refusal;
use crate::json::Json;
use dh_codegen::model::{AngleUnit, JointKind, LengthUnit, Model};
use dh_core::Frame;

/// The units of a robot's table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Units<'m> {
    model: &'m Model,
}

impl<'m> Units<'m> {
    /// Those of a model.
    pub(crate) fn of(model: &'m Model) -> Self {
        Units { model }
    }

    /// `mm` or `m`.
    pub(crate) fn length_name(self) -> &'static str {
        match self.model.units.length {
            LengthUnit::Metre => "m",
            LengthUnit::Millimetre => "mm",
        }
    }

    /// `deg` or `rad`.
    pub(crate) fn angle_name(self) -> &'static str {
        match self.model.units.angle {
            AngleUnit::Radian => "rad",
            AngleUnit::Degree => "deg",
        }
    }

    /// m to the table's unit.
    pub(crate) fn length(self, metres: f64) -> f64 {
        self.power(metres, 1)
    }

    /// A power of m to that of the table's unit.
    pub(crate) fn power(self, value: f64, dimension: u8) -> f64 {
        match self.model.units.length {
            LengthUnit::Metre => value,
            LengthUnit::Millimetre => value * 1000_f64.powi(i32::from(dimension)),
        }
    }

    /// The table's unit to m.
    pub(crate) fn metres(self, length: f64) -> f64 {
        match self.model.units.length {
            LengthUnit::Metre => length,
            LengthUnit::Millimetre => length / 1000.0,
        }
    }

    /// rad to the table's unit.
    pub(crate) fn angle(self, radians: f64) -> f64 {
        match self.model.units.angle {
            AngleUnit::Radian => radians,
            AngleUnit::Degree => radians.to_degrees(),
        }
    }

    /// The table's unit to rad.
    pub(crate) fn radians(self, angle: f64) -> f64 {
        match self.model.units.angle {
            AngleUnit::Radian => angle,
            AngleUnit::Degree => angle.to_radians(),
        }
    }

    /// A value of a joint (rad or m) in the table's unit.
    pub(crate) fn variable(self, kind: JointKind, value: f64) -> f64 {
        match kind {
            JointKind::Revolute => self.angle(value),
            JointKind::Prismatic => self.length(value),
        }
    }

    /// The unit of a joint.
    pub(crate) fn name(self, kind: JointKind) -> &'static str {
        match kind {
            JointKind::Revolute => self.angle_name(),
            JointKind::Prismatic => self.length_name(),
        }
    }

    /// Kind and name of a joint, by its index in q.
    pub(crate) fn joint(self, index: usize) -> (JointKind, &'m str) {
        let row = self.model.joints.get(index).and_then(|row| self.model.rows.get(*row));
        row.map_or((JointKind::Revolute, ""), |row| (row.kind, &row.name))
    }

    /// Joint values (rad or m) in the table's units.
    pub(crate) fn joints(self, q: &[f64]) -> Vec<f64> {
        let value = |(index, value): (usize, &f64)| self.variable(self.joint(index).0, *value);
        q.iter().enumerate().map(value).collect()
    }

    /// Joint values as the user gives them, in rad or m.
    ///
    /// # Errors
    /// Too few or too many of them, or one that is not a number.
    pub(crate) fn joints_in_si(self, values: &[f64]) -> Result<Vec<f64>, Refusal> {
        let expected = self.model.joints.len();
        if values.len() != expected {
            let names: Vec<&str> = (0..expected).map(|index| self.joint(index).1).collect();
            let message = format!("{} joint values where {expected} are needed", values.len());
            let refusal =
                Refusal::new("length", message).with("expected", expected).with("got", values.len());
            return Err(refusal.help(format!("the joints are {}", names.join(", "))));
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            let name = self.joint(index).1;
            let message = format!("the value of joint {} ({name}) is not finite", index + 1);
            return Err(Refusal::new("not_finite", message).with("joint", index + 1).with("name", name));
        }
        let si = |(index, value): (usize, &f64)| match self.joint(index).0 {
            JointKind::Revolute => self.radians(*value),
            JointKind::Prismatic => self.metres(*value),
        };
        Ok(values.iter().enumerate().map(si).collect())
    }

    /// Values of some joints (indices of q) as the user gives them, in rad or m.
    ///
    /// # Errors
    /// Too few or too many of them, or one that is not a number.
    pub(crate) fn some_joints_in_si(self, joints: &[usize], values: &[f64]) -> Result<Vec<f64>, Refusal> {
        let names: Vec<&str> = joints.iter().map(|joint| self.joint(*joint).1).collect();
        let (expected, got) = (joints.len(), values.len());
        if got != expected {
            let message = format!("{got} values of free joints where {expected} are needed");
            let refusal = Refusal::new("length", message).with("expected", expected).with("got", got);
            return Err(match names.as_slice() {
                [] => refusal.help("the problem leaves no joint to the caller"),
                names => refusal.help(format!("the problem leaves {} to the caller", names.join(", "))),
            });
        }
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            let name = names.get(place).copied().unwrap_or_default();
            return Err(
                Refusal::new("not_finite", format!("the value of {name} is not finite")).with("name", name)
            );
        }
        let si = |(joint, value): (&usize, &f64)| match self.joint(*joint).0 {
            JointKind::Revolute => self.radians(*value),
            JointKind::Prismatic => self.metres(*value),
        };
        Ok(joints.iter().zip(values).map(si).collect())
    }

    /// A point (m) in the table's unit.
    pub(crate) fn point(self, point: [f64; 3]) -> [f64; 3] {
        point.map(|x| self.length(x))
    }

    /// `{"position": .., "quaternion": .., "matrix": ..}`
    pub(crate) fn pose(self, frame: &Frame) -> Json {
        let position = self.point(frame.translation);
        let rows = frame.rotation.iter().zip(position);
        let mut matrix: Vec<Json> =
            rows.map(|(row, p)| Json::numbers(row.iter().copied().chain([p]))).collect();
        matrix.push(Json::numbers([0.0, 0.0, 0.0, 1.0]));
        Json::Object(vec![
            ("position", Json::numbers(position)),
            ("quaternion", Json::numbers(frame.quaternion())),
            ("matrix", Json::List(matrix)),
        ])
    }

    /// A length for people, to the nanometre.
    pub(crate) fn show_length(self, length: f64) -> String {
        fixed(length, if self.model.units.length == LengthUnit::Metre { 9 } else { 6 })
    }

    /// An angle for people, to some nanoradians.
    pub(crate) fn show_angle(self, angle: f64) -> String {
        fixed(angle, if self.model.units.angle == AngleUnit::Radian { 9 } else { 6 })
    }

    /// A joint value for people.
    pub(crate) fn show(self, kind: JointKind, value: f64) -> String {
        match kind {
            JointKind::Revolute => self.show_angle(value),
            JointKind::Prismatic => self.show_length(value),
        }
    }
}

/// With so many decimals, and no sign before nothing.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(positive) if positive.bytes().all(|byte| matches!(byte, b'0' | b'.')) => positive.to_owned(),
        _ => text,
    }
}
