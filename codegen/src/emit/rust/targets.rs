//! What inverse functions take: the arguments of a kind of target, and how they become a `Target`.

use super::paths::Paths;
use super::{ScalarType, Types};
use crate::model::Target;

/// Arguments of an inverse function.
pub(super) struct Arguments {
    /// `target: &Pose`, with the types of the methods.
    pub(super) parameters: Vec<String>,
    /// The names alone, to be passed on.
    pub(super) names: Vec<&'static str>,
    /// `Target::Pose(target.into())`
    pub(super) target: String,
    /// What is prescribed, in words.
    pub(super) meaning: &'static str,
}

/// The arguments for a kind of target.
pub(super) fn arguments(target: Target, types: Types, scalar: ScalarType, paths: &Paths) -> Arguments {
    let nalgebra = types == Types::Nalgebra;
    let number = scalar.name();
    let single = match scalar {
        ScalarType::F64 => "",
        ScalarType::F32 => "<f32>",
    };
    let vector = |name: &'static str, nalgebra_name: &str, length: usize| {
        if nalgebra {
            format!("{name}: &{}<{number}>", paths.nalgebra(nalgebra_name))
        } else {
            format!("{name}: &[{number}; {length}]")
        }
    };
    let point = || vector("position", "Point3", 3);
    let plane = || vector("position", "Point2", 2);
    let direction = || vector("direction", "UnitVector3", 3);
    let yaw = || format!("yaw: {number}");
    let position = if nalgebra { "(*position).into()" } else { "*position" };
    let unit = if nalgebra { "direction.into_inner().into()" } else { "*direction" };
    let variant = format!("{}::{target:?}", paths.runtime("Target"));

    let (parameters, names, target, meaning) = match target {
        Target::Pose if nalgebra => (
            vec![format!("target: &{}{single}", paths.runtime("Pose"))],
            vec!["target"],
            format!("{variant}(target.into())"),
            "`target`: pose of the tool frame in the base frame (m)",
        ),
        Target::Pose => (
            vec![format!("target: &{}{single}", paths.runtime("Frame"))],
            vec!["target"],
            format!("{variant}(*target)"),
            "`target`: pose of the tool frame in the base frame (m)",
        ),
        Target::Rotation if nalgebra => (
            vec![format!("rotation: &{}<{number}>", paths.nalgebra("Rotation3"))],
            vec!["rotation"],
            format!("{variant}({}::from(rotation).rotation)", paths.runtime("Frame")),
            "`rotation`: of the tool frame in the base frame",
        ),
        Target::Rotation => (
            vec![format!("rotation: &[[{number}; 3]; 3]")],
            vec!["rotation"],
            format!("{variant}(*rotation)"),
            "`rotation`: of the tool frame in the base frame, rows of the matrix",
        ),
        Target::Position => (
            vec![point()],
            vec!["position"],
            format!("{variant}({position})"),
            "`position`: of the tool point in the base frame (m)",
        ),
        Target::Lookat => (
            vec![point()],
            vec!["position"],
            format!("{variant}({position})"),
            "`position`: a point that the tool's z axis is to pass through (m, base frame)",
        ),
        Target::PositionDirection => (
            vec![point(), direction()],
            vec!["position", "direction"],
            format!("{variant} {{ position: {position}, direction: {unit} }}"),
            "`position`: of the tool point (m), `direction`: of the tool's z axis, both in the base frame",
        ),
        Target::Ray => (
            vec![point(), direction()],
            vec!["position", "direction"],
            format!("{variant} {{ position: {position}, direction: {unit} }}"),
            "`position` (m), `direction`: the line that the tool's z axis is to lie on, with its sense, in the base frame",
        ),
        Target::Direction => (
            vec![direction()],
            vec!["direction"],
            format!("{variant}({unit})"),
            "`direction`: of the tool's z axis in the base frame",
        ),
        Target::PositionYaw => (
            vec![point(), yaw()],
            vec!["position", "yaw"],
            format!("{variant} {{ position: {position}, yaw }}"),
            "`position`: of the tool point in the base frame (m), `yaw`: turn of the tool's x axis about base z (rad)",
        ),
        Target::Xy => (
            vec![plane()],
            vec!["position"],
            format!("{variant}({position})"),
            "`position`: x and y of the tool point in the base frame (m)",
        ),
        Target::XyYaw => (
            vec![plane(), yaw()],
            vec!["position", "yaw"],
            format!("{variant} {{ position: {position}, yaw }}"),
            "`position`: x and y of the tool point (m), `yaw`: turn of the tool's x axis about base z (rad)",
        ),
    };
    Arguments { parameters, names, target, meaning }
}
