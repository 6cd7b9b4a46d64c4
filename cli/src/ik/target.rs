//! Targets, from flags or from a line of JSON.

use crate::list::List;
use crate::units::Units;
use dh_core::{Frame, IkError, Target, TargetKind};

/// The numbers of a target, in the table's units.
#[derive(Debug, clap::Args)]
pub(crate) struct Flags {
    /// Tool point (of xy and `xy_yaw`: x and y), in the table's unit of length.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    position: Option<List>,
    /// Orientation, of any length but 0.
    #[arg(long, value_name = "X,Y,Z,W", allow_hyphen_values = true, conflicts_with = "rpy")]
    quaternion: Option<List>,
    /// Orientation: roll, pitch, yaw about fixed x, y, z, in the table's unit of angle.
    #[arg(long, value_name = "R,P,Y", allow_hyphen_values = true)]
    rpy: Option<List>,
    /// Direction of the tool's z axis, of any length but 0.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    direction: Option<List>,
    /// Turn of the tool's x axis about base z, in the table's unit of angle.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    yaw: Option<f64>,
}

/// Why there is no target.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Trouble {
    /// It is not written as it must be.
    Form(String),
    /// It is, but its numbers are none.
    Value(IkError),
}

impl Flags {
    /// Whether none is given.
    pub(crate) fn is_empty(&self) -> bool {
        let lists = [&self.position, &self.quaternion, &self.rpy, &self.direction];
        lists.iter().all(|list| list.is_none()) && self.yaw.is_none()
    }

    /// The target of a kind.
    ///
    /// # Errors
    /// What is missing or too much.
    pub(crate) fn target(&self, kind: TargetKind, units: Units<'_>) -> Result<Target, Trouble> {
        let list = |name: &'static str, list: &Option<List>| {
            list.as_ref().map(|List(numbers)| (name, numbers.clone()))
        };
        let given = [
            list("position", &self.position),
            list("quaternion", &self.quaternion),
            list("rpy", &self.rpy),
            list("direction", &self.direction),
            self.yaw.map(|yaw| ("yaw", vec![yaw])),
        ];
        Parts { given: given.into_iter().flatten().collect(), prefix: "--" }.target(kind, units)
    }
}

/// Keys and values of a line.
pub(crate) type Fields = serde_json::Map<String, serde_json::Value>;

/// The JSON object of a line.
///
/// # Errors
/// What is wrong with the line.
pub(crate) fn fields(line: &[u8], kind: TargetKind) -> Result<Fields, Trouble> {
    let value: serde_json::Value = serde_json::from_slice(line)
        .map_err(|error| Trouble::Form(format!("the line is not JSON: {error}")))?;
    match value {
        serde_json::Value::Object(fields) => Ok(fields),
        _ => Err(Trouble::Form(format!(
            "the line is not an object with the target's keys, {}",
            keys(kind, "")
        ))),
    }
}

/// Takes `free` out of a line: the value of the free joint, or a list where there are several.
///
/// # Errors
/// Where it is neither.
pub(crate) fn take_free(fields: &mut Fields) -> Result<Option<Vec<f64>>, Trouble> {
    let Some(value) = fields.remove("free") else { return Ok(None) };
    let numbers = value.as_f64().map(|value| vec![value]).or_else(|| numbers(&value));
    numbers.map(Some).ok_or_else(|| Trouble::Form("`free` is not a number or a list of numbers".to_owned()))
}

/// Takes `near` out of a line: joint values to be near to.
///
/// # Errors
/// Where it is no list of numbers.
pub(crate) fn take_near(fields: &mut Fields) -> Result<Option<Vec<f64>>, Trouble> {
    let Some(value) = fields.remove("near") else { return Ok(None) };
    numbers(&value).map(Some).ok_or_else(|| Trouble::Form("`near` is not a list of numbers".to_owned()))
}

fn numbers(value: &serde_json::Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(serde_json::Value::as_f64).collect()
}

/// The target of a kind, from a JSON object.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn read(fields: &Fields, kind: TargetKind, units: Units<'_>) -> Result<Target, Trouble> {
    let form = |message: String| Trouble::Form(message);
    let mut given = Vec::new();
    for (key, value) in fields {
        let name = ["position", "quaternion", "direction", "yaw"].into_iter().find(|known| known == key);
        let Some(name) = name else {
            let key = dh_codegen::diagnostic::shortened(key);
            return Err(form(format!("unknown key `{key}`; a target of kind {kind} has {}", keys(kind, ""))));
        };
        let numbers = if name == "yaw" { value.as_f64().map(|yaw| vec![yaw]) } else { numbers(value) };
        let wanted = if name == "yaw" { "a number" } else { "a list of numbers" };
        given.push((name, numbers.ok_or_else(|| form(format!("`{name}` is not {wanted}")))?));
    }
    Parts { given, prefix: "" }.target(kind, units)
}

/// What was given, by name, in the table's units.
struct Parts {
    given: Vec<(&'static str, Vec<f64>)>,
    /// `--` before flags.
    prefix: &'static str,
}

impl Parts {
    fn target(&self, kind: TargetKind, units: Units<'_>) -> Result<Target, Trouble> {
        let known = names(kind);
        if let Some((name, _)) = self.given.iter().find(|(name, _)| !known.contains(name)) {
            return Err(self.form(kind, &format!("{}{name} has no meaning", self.prefix)));
        }
        let point = |[x, y, z]: [f64; 3]| [x, y, z].map(|x| units.metres(x));
        let xy = |[x, y]: [f64; 2]| [units.metres(x), units.metres(y)];
        let yaw = || self.numbers::<1>(kind, "yaw").map(|[yaw]| units.radians(yaw));
        let position = || self.numbers(kind, "position").map(point);
        let direction = || self.numbers(kind, "direction");
        Ok(match kind {
            TargetKind::Pose => Target::Pose(self.frame(kind, position()?, units)?),
            TargetKind::Position => Target::Position(position()?),
            TargetKind::PositionDirection => {
                Target::PositionDirection { position: position()?, direction: direction()? }
            }
            TargetKind::PositionYaw => Target::PositionYaw { position: position()?, yaw: yaw()? },
            TargetKind::Rotation => Target::Rotation(self.frame(kind, [0.0; 3], units)?.rotation),
            TargetKind::Direction => Target::Direction(direction()?),
            TargetKind::Ray => Target::Ray { position: position()?, direction: direction()? },
            TargetKind::Lookat => Target::Lookat(position()?),
            TargetKind::Xy => Target::Xy(self.numbers(kind, "position").map(xy)?),
            TargetKind::XyYaw => {
                Target::XyYaw { position: self.numbers(kind, "position").map(xy)?, yaw: yaw()? }
            }
        })
    }

    fn frame(&self, kind: TargetKind, position: [f64; 3], units: Units<'_>) -> Result<Frame, Trouble> {
        if self.given.iter().any(|(name, _)| *name == "rpy") {
            let rpy = self.numbers::<3>(kind, "rpy")?.map(|angle| units.radians(angle));
            return Ok(Frame::from_rpy(position, rpy));
        }
        let quaternion: [f64; 4] = self.numbers(kind, "quaternion")?;
        let finite = quaternion.iter().all(|component| component.is_finite());
        let error = if finite { IkError::NotRigid { error: 1.0 } } else { IkError::NotFinite };
        Frame::from_quaternion(position, quaternion).ok_or(Trouble::Value(error))
    }

    /// The numbers of a name, which must be so many.
    fn numbers<const N: usize>(&self, kind: TargetKind, name: &str) -> Result<[f64; N], Trouble> {
        let prefix = self.prefix;
        let Some((_, numbers)) = self.given.iter().find(|(known, _)| *known == name) else {
            return Err(self.form(kind, &format!("{prefix}{name} is missing")));
        };
        <[f64; N]>::try_from(numbers.as_slice()).map_err(|_| {
            self.form(kind, &format!("{prefix}{name} has {} numbers where {N} are needed", numbers.len()))
        })
    }

    fn form(&self, kind: TargetKind, what: &str) -> Trouble {
        Trouble::Form(format!("{what}; a target of kind {kind} has {}", keys(kind, self.prefix)))
    }
}

/// Names of what a target of a kind is given by; an orientation is given by either of two.
fn names(kind: TargetKind) -> &'static [&'static str] {
    match kind {
        TargetKind::Pose => &["position", "quaternion", "rpy"],
        TargetKind::Position | TargetKind::Lookat | TargetKind::Xy => &["position"],
        TargetKind::PositionDirection | TargetKind::Ray => &["position", "direction"],
        TargetKind::PositionYaw | TargetKind::XyYaw => &["position", "yaw"],
        TargetKind::Rotation => &["quaternion", "rpy"],
        TargetKind::Direction => &["direction"],
    }
}

/// The same as people read it.
fn keys(kind: TargetKind, prefix: &str) -> String {
    // Lines of JSON have no rpy.
    let orientation = if prefix.is_empty() { "quaternion" } else { "--quaternion (or --rpy)" };
    let names = names(kind).iter().filter(|name| **name != "rpy");
    let written: Vec<String> = names
        .map(|name| if *name == "quaternion" { orientation.to_owned() } else { format!("{prefix}{name}") })
        .collect();
    written.join(" and ")
}
