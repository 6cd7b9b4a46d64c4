//! Stage 2: rows as written -> a checked robot in SI units (radians, metres), whatever the table's units.
//!
//! Everything after this stage reads the robot from here. Spans point into the table's text, so that a later stage
//! can still show the row that it speaks of.

use std::ops::Range;

mod angle;
// Fixed transforms between joints.
pub mod chain;
mod check;
mod constraint;
mod fingerprint;
mod form;
// How the joint axes lie to each other.
pub mod geometry;
mod linear;
mod names;
mod placement;
mod problems;
// The plain product of the rows, for verification.
pub mod product;
mod quantity;
mod reach;
mod recentre;
mod rows;
mod rules;
mod servos;
mod tool_axis;
mod topology;

pub use angle::EXACT_ANGLE_TOLERANCE;
pub use chain::Chain;
pub use check::check;
pub use geometry::Geometry;

/// Byte range in the table's text.
pub type Span = Range<usize>;

/// A checked robot. Joint angles are in radians, lengths in metres.
#[derive(Debug, Clone)]
pub struct Model {
    /// `[robot] name`.
    pub name: String,
    /// `[robot] manufacturer`.
    pub manufacturer: Option<String>,
    /// `[robot] source`.
    pub source: Option<String>,
    /// Which Denavit-Hartenberg convention the rows follow.
    pub convention: Convention,
    /// The units of the table, in which `dhc` speaks.
    pub units: Units,
    /// Every row, base to tip, held rows included.
    pub rows: Vec<Row>,
    /// Rows with a variable, in order: `joints[i]` is the row of `q[i]`.
    pub joints: Vec<usize>,
    /// `[base]`: base frame to the frame of the first row.
    pub base: Placement,
    /// `[tool]`: the frame of the last row to the tool frame.
    pub tool: Placement,
    /// `[workspace]`.
    pub workspace: Workspace,
    /// `[[limit]]`: limits on sums of joints.
    pub sums: Vec<SumLimit>,
    /// `[poses]`.
    pub poses: Vec<NamedPose>,
    /// `[[ik]]`, as checked; the full pose is not among them.
    pub problems: Vec<Problem>,
    /// Whole turns of the joint variables that leave every frame where it is.
    pub windings: Vec<Winding>,
    /// `[[servo]]`: servos outside the chain.
    pub servos: Vec<NamedServo>,
    /// `[device]`: keys and values as text, unchecked here (the driver's own schema checks them).
    pub device: Option<Device>,
    /// A hash of everything in the table that changes what is computed or sent (not of comments or layout).
    pub fingerprint: u64,
}

impl Model {
    /// The robot as fixed transforms between joints, axes recentred where the table needs it.
    pub fn chain(&self) -> Chain {
        chain::build(self.convention, &self.rows, &self.base, &self.tool)
    }
}

/// Denavit-Hartenberg convention.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// Distal: A = Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta).
    Standard,
    /// Proximal (Craig): A = Tx(a) Rx(alpha) Ry(beta) Rz(theta) Tz(d).
    Modified,
}

/// Units of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Units {
    /// Metres or millimetres.
    pub length: LengthUnit,
    /// Radians or degrees.
    pub angle: AngleUnit,
}

/// Unit of length of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// m
    Metre,
    /// mm
    Millimetre,
}

/// Unit of angle of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// rad
    Radian,
    /// deg
    Degree,
}

/// An angle in radians that knows whether it is a multiple of 15 degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle {
    /// Radians. Where `fifteenths` is set, the nearest f64 to it.
    pub value: f64,
    /// The angle in units of 15 degrees, where it is such a multiple to within 1e-12 rad.
    pub fifteenths: Option<i32>,
}

/// One row of the table: a joint, or a held one.
#[derive(Debug, Clone)]
pub struct Row {
    /// `name`, or J1, J2, ... by its place among all rows.
    pub name: String,
    /// Whether theta or d varies.
    pub kind: JointKind,
    /// Link offset d (m). For a prismatic row, d at q = 0: its `offset` (plus direction * `fixed` of a held one).
    pub d: f64,
    /// Link length a (m).
    pub a: f64,
    /// Link twist alpha.
    pub alpha: Angle,
    /// Hayati's beta.
    pub beta: Angle,
    /// Joint angle theta at q = 0 of all joints: `offset` of a revolute row (plus direction * `fixed` of a held one, which
    /// stays at that q), `theta` of a prismatic one.
    pub theta: Angle,
    /// How far an origin is moved along a joint axis before anything is computed (m); 0 except where rows with huge
    /// `d` cancel. In the standard convention it is the origin of this row's own frame, along the axis of the next
    /// joint; in the modified one the origin before this row's joint, along its own axis. See [`chain`].
    pub shift: f64,
    /// What the joint variables add: theta (revolute) or d (prismatic) = its value at zero + sum of
    /// coefficient * q\[index\]. The own variable (coefficient `direction`) and couplings alike; empty for a held row
    /// without couplings. Indices are into [`Model::joints`]. Coefficients between unlike kinds are in SI
    /// (rad per m, m per rad).
    pub terms: Vec<(usize, f64)>,
    /// Index of the row's own variable; `None` for a held row.
    pub variable: Option<usize>,
    /// Limits of q (rad or m).
    pub limits: Option<Limits>,
    /// rad/s or m/s.
    pub max_velocity: Option<f64>,
    /// rad/s^2 or m/s^2.
    pub max_acceleration: Option<f64>,
    /// rad/s^3 or m/s^3.
    pub max_jerk: Option<f64>,
    /// `servo = {...}`.
    pub servo: Option<Servo>,
    /// The whole entry in the table.
    pub span: Span,
    /// 1-based line of the entry's header.
    pub line: usize,
}

impl Row {
    /// Whether it has a variable of its own.
    pub fn moves(&self) -> bool {
        self.variable.is_some()
    }
}

/// Kind of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// theta varies.
    Revolute,
    /// d varies.
    Prismatic,
}

/// A closed interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

/// A fixed frame given by the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// Translation (m).
    pub xyz: [f64; 3],
    /// Rotation.
    pub rotation: Rotation,
}

/// A fixed rotation given by the table.
#[derive(Debug, Clone, PartialEq)]
pub enum Rotation {
    /// Rz(rpy\[2\]) Ry(rpy\[1\]) Rx(rpy\[0\]). A quaternion whose angles are multiples of 15 degrees ends here too.
    Rpy([Angle; 3]),
    /// Rows of the matrix of a quaternion that is not such a rotation.
    Matrix([[f64; 3]; 3]),
}

/// `[workspace]`: where the tool point may not be (base frame, m).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Workspace {
    /// `x_min` ... `z_max`, in the order of the table's reference: x min, x max, y min, ...
    pub bounds: Vec<Bound>,
    /// `keep_out` boxes.
    pub keep_out: Vec<KeepOut>,
}

/// One bound on a coordinate of the tool point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether smaller (`_min`) or greater (`_max`) values are refused.
    pub is_min: bool,
    /// m
    pub value: f64,
}

/// A box that the tool point must stay out of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeepOut {
    /// m
    pub min: [f64; 3],
    /// m
    pub max: [f64; 3],
}

/// A limit on a weighted sum of joint variables.
#[derive(Debug, Clone, PartialEq)]
pub struct SumLimit {
    /// (index of q, coefficient).
    pub terms: Vec<(usize, f64)>,
    /// rad or m.
    pub range: Limits,
}

/// A whole turn of one joint that leaves every frame where it is: `q[joint] += turn` and `q[k] += c` for every carried
/// (k, c). Joints that are coupled by whole numbers, or not at all, carry nothing and turn by 2 pi; a coupling of 1/2
/// carries pi. In an order such that a joint's own winding comes before those of the joints it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Winding {
    /// Index of q.
    pub joint: usize,
    /// rad
    pub turn: f64,
    /// (index of q, rad).
    pub carries: Vec<(usize, f64)>,
}

/// A named joint pose.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPose {
    /// Key in `[poses]`.
    pub name: String,
    /// rad or m, one a joint.
    pub q: Vec<f64>,
    /// Whether torque may be cut there.
    pub safe: bool,
}

/// device = scale * q + zero, q in rad or m. `scale` carries the sign.
#[derive(Debug, Clone, PartialEq)]
pub struct Servo {
    /// Bus id.
    pub id: Option<u32>,
    /// Device units per radian (or metre), signed: counts where the table gives counts, else degrees (millimetres).
    pub scale: f64,
    /// Device value at q = 0.
    pub zero: f64,
    /// What the register takes.
    pub range: Option<Limits>,
    /// `model`.
    pub model: Option<String>,
}

/// A servo outside the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedServo {
    /// `name`.
    pub name: String,
    /// Its map.
    pub servo: Servo,
}

/// `[device]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Device {
    /// `driver`.
    pub driver: String,
    /// The other keys with their values as written.
    pub keys: Vec<(String, String)>,
}

/// A checked `[[ik]]` entry.
#[derive(Debug, Clone)]
pub struct Problem {
    /// `name`: gives `ik_NAME` and `ik_all_NAME`.
    pub name: String,
    /// What is prescribed.
    pub target: Target,
    /// Each says: sum of coefficient * variable = constant.
    pub constraints: Vec<Linear>,
    /// Each says: sum of coefficient * variable + constant <= 0 (or < 0).
    pub filters: Vec<Filter>,
    /// Joints left to the caller (indices of q).
    pub free: Vec<usize>,
    /// The entry in the table.
    pub span: Span,
    /// 1-based line of the entry's header.
    pub line: usize,
}

impl Problem {
    /// Whether it prescribes the whole pose of the tool frame and nothing else.
    pub fn is_whole_pose(&self) -> bool {
        self.target == Target::Pose && self.constraints.is_empty() && self.filters.is_empty()
    }
}

/// What an inverse problem prescribes; the rows of `table-format`'s list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are those of the table's reference")]
pub enum Target {
    Pose,
    Position,
    PositionDirection,
    PositionYaw,
    Rotation,
    Direction,
    Ray,
    Lookat,
    Xy,
    XyYaw,
}

impl Target {
    /// Whether all that it leaves open of the tool frame is how that is turned about its z axis.
    pub fn is_any_turn(self) -> bool {
        self == Self::PositionDirection
    }

    /// Names of the numbers that a target is made of, in the order in which functions take them.
    pub fn input_names(self) -> &'static [&'static str] {
        match self {
            Self::Pose => &["r11", "r12", "r13", "px", "r21", "r22", "r23", "py", "r31", "r32", "r33", "pz"],
            Self::Position | Self::Lookat => &["px", "py", "pz"],
            Self::PositionDirection | Self::Ray => &["px", "py", "pz", "zx", "zy", "zz"],
            Self::PositionYaw => &["px", "py", "pz", "cyaw", "syaw"],
            Self::Rotation => &["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"],
            Self::Direction => &["zx", "zy", "zz"],
            Self::Xy => &["px", "py"],
            Self::XyYaw => &["px", "py", "cyaw", "syaw"],
        }
    }
}

/// A linear form in row variables: coefficients of the thetas and ds of rows, and a constant. `q*` and joint names are
/// already expressed in theta and d. In a constraint the constant is on the other side (terms = constant), in a
/// filter on the same (terms + constant <= 0).
#[derive(Debug, Clone)]
pub struct Linear {
    /// (row index, coefficient): theta of a revolute row, d of a prismatic one.
    pub terms: Vec<(usize, f64)>,
    /// rad or m; exact multiples of 15 degrees are kept as such.
    pub constant: Angle,
    /// As written.
    pub text: String,
    /// Its place in the table.
    pub span: Span,
}

/// An inequality: `form + q <= 0`, or `< 0` where `strict`. Variables stay as they are written, since theta and q are
/// each taken in (-pi, pi] before they are added up.
#[derive(Debug, Clone)]
pub struct Filter {
    /// Thetas and ds of rows, and the constant.
    pub form: Linear,
    /// (index of q, coefficient).
    pub q: Vec<(usize, f64)>,
    /// `<` rather than `<=`.
    pub strict: bool,
}

#[cfg(test)]
mod tests;
