//! What inverse functions take: the arguments of a kind of target, and how they become a `Target`.

use super::layout::Expression;
use super::{Printer, Types};
use crate::model::Target;

/// Arguments of an inverse function.
pub(super) struct Arguments {
    /// `target: &Pose`, with the types of the methods.
    pub(super) parameters: Vec<String>,
    /// The names alone, to be passed on.
    pub(super) names: &'static [&'static str],
    /// `&Target::Pose(target.into())`
    pub(super) target: Expression,
    /// What is prescribed, in words.
    pub(super) meaning: &'static str,
}

impl Printer<'_> {
    /// The arguments for a kind of target.
    pub(super) fn arguments(&self, target: Target) -> Arguments {
        let names = names(target);
        let variant = format!("&{}::{target:?}", self.paths.runtime("Target"));
        let value = |name: &&'static str| (*name, Expression::Atom(self.value(name)));
        let made = match names {
            [name] => Expression::Call(variant, vec![value(name).1]),
            _ => Expression::Struct(variant, names.iter().map(value).collect()),
        };
        Arguments {
            parameters: names
                .iter()
                .map(|name| format!("{name}: {}", self.parameter(name, target)))
                .collect(),
            names,
            target: made,
            meaning: meaning(target),
        }
    }

    /// The type of a parameter.
    fn parameter(&self, name: &str, target: Target) -> String {
        let number = self.scalar();
        let planar = matches!(target, Target::Xy | Target::XyYaw);
        let nalgebra = |name: &str| format!("&{}<{number}>", self.paths.nalgebra(name));
        match (name, self.options.types) {
            ("target", _) => format!("&{}", self.pose_type()),
            ("rotation", Types::Nalgebra) => nalgebra("Rotation3"),
            ("rotation", Types::Plain) => format!("&[[{number}; 3]; 3]"),
            ("position", Types::Nalgebra) => nalgebra(if planar { "Point2" } else { "Point3" }),
            ("direction", Types::Nalgebra) => nalgebra("UnitVector3"),
            ("position", Types::Plain) if planar => format!("&[{number}; 2]"),
            ("position" | "direction", Types::Plain) => format!("&[{number}; 3]"),
            _ => number.to_owned(),
        }
    }

    /// A parameter as a field of the target.
    fn value(&self, name: &str) -> String {
        match (name, self.options.types) {
            ("yaw", _) => "yaw".to_owned(),
            (_, Types::Plain) => format!("*{name}"),
            ("target", _) => "target.into()".to_owned(),
            ("rotation", _) => format!("{}::from(rotation).rotation", self.paths.runtime("Frame")),
            ("direction", _) => "direction.into_inner().into()".to_owned(),
            _ => format!("(*{name}).into()"),
        }
    }
}

/// The parameters of a kind of target; those of a target with two are its fields.
fn names(target: Target) -> &'static [&'static str] {
    match target {
        Target::Pose => &["target"],
        Target::Rotation => &["rotation"],
        Target::Position | Target::Lookat | Target::Xy => &["position"],
        Target::Direction => &["direction"],
        Target::PositionDirection | Target::Ray => &["position", "direction"],
        Target::PositionYaw | Target::XyYaw => &["position", "yaw"],
    }
}

fn meaning(target: Target) -> &'static str {
    match target {
        Target::Pose => "`target`: pose of the tool frame in the base frame (m)",
        Target::Rotation => "`rotation`: of the tool frame in the base frame (rows, where it is an array)",
        Target::Position => "`position`: of the tool point in the base frame (m)",
        Target::Lookat => "`position`: a point that the tool's z axis is to pass through (m, base frame)",
        Target::PositionDirection => {
            "`position`: of the tool point (m), `direction`: of the tool's z axis, both in the base frame"
        }
        Target::Ray => {
            "`position` (m), `direction`: the line that the tool's z axis is to lie on, with its sense, in the base frame"
        }
        Target::Direction => "`direction`: of the tool's z axis in the base frame",
        Target::PositionYaw => {
            "`position`: of the tool point in the base frame (m), `yaw`: turn of the tool's x axis about base z (rad)"
        }
        Target::Xy => "`position`: x and y of the tool point in the base frame (m)",
        Target::XyYaw => {
            "`position`: x and y of the tool point (m), `yaw`: turn of the tool's x axis about base z (rad)"
        }
    }
}
