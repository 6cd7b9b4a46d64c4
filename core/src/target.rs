//! What an inverse problem prescribes of the tool frame.

mod missing;

pub(crate) use missing::axes_across;

use core::fmt;
use core::ops::Deref;

use crate::frame::{add, cross, dot, matrix_product, norm, sub, transpose};
use crate::{Float, Frame, IkError, rotation_error};

/// Kinds of targets; the names are those of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TargetKind {
    /// Position and orientation: 6 rows.
    Pose,
    /// x, y, z: 3 rows.
    Position,
    /// Position and the direction of the tool's z axis: 5 rows.
    PositionDirection,
    /// Position and the turn of the tool's x axis about base z: 4 rows.
    PositionYaw,
    /// Orientation: 3 rows.
    Rotation,
    /// The direction of the tool's z axis: 2 rows.
    Direction,
    /// A line that the tool's z axis lies on, with its sense: 4 rows.
    Ray,
    /// A point that the line along the tool's z axis passes through: 2 rows.
    Lookat,
    /// x, y (planar arms): 2 rows.
    Xy,
    /// x, y and the turn of the tool's x axis about base z (planar arms): 3 rows.
    XyYaw,
}

impl TargetKind {
    /// How many rows it prescribes.
    pub const fn rows(self) -> usize {
        match self {
            Self::Pose => 6,
            Self::PositionDirection => 5,
            Self::PositionYaw | Self::Ray => 4,
            Self::Position | Self::Rotation | Self::XyYaw => 3,
            Self::Direction | Self::Lookat | Self::Xy => 2,
        }
    }
}

impl fmt::Display for TargetKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pose => "pose",
            Self::Position => "position",
            Self::PositionDirection => "position_direction",
            Self::PositionYaw => "position_yaw",
            Self::Rotation => "rotation",
            Self::Direction => "direction",
            Self::Ray => "ray",
            Self::Lookat => "lookat",
            Self::Xy => "xy",
            Self::XyYaw => "xy_yaw",
        })
    }
}

/// A target of an inverse problem, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no heap to box the pose in, and it is the usual target")]
pub enum Target<S = f64> {
    /// Pose of the tool frame.
    Pose(Frame<S>),
    /// Tool point (m).
    Position([S; 3]),
    /// Tool point and direction of the tool's z axis.
    PositionDirection {
        /// m
        position: [S; 3],
        /// Any length but 0.
        direction: [S; 3],
    },
    /// Tool point and turn of the tool's x axis about base z.
    PositionYaw {
        /// m
        position: [S; 3],
        /// rad
        yaw: S,
    },
    /// Rows of the rotation matrix of the tool frame.
    Rotation([[S; 3]; 3]),
    /// Direction of the tool's z axis; any length but 0.
    Direction([S; 3]),
    /// A line for the tool's z axis to lie on.
    Ray {
        /// Any point of the line (m).
        position: [S; 3],
        /// Its direction; any length but 0.
        direction: [S; 3],
    },
    /// A point (m) for the line along the tool's z axis to pass through, before the tool or behind it.
    Lookat([S; 3]),
    /// x and y of the tool point (m).
    Xy([S; 2]),
    /// x and y of the tool point and turn of the tool's x axis about base z.
    XyYaw {
        /// m
        position: [S; 2],
        /// rad
        yaw: S,
    },
}

impl<S> From<Frame<S>> for Target<S> {
    fn from(pose: Frame<S>) -> Self {
        Self::Pose(pose)
    }
}

/// How far a matrix may be from a rotation, as [`Frame::rigidity_error`] measures it, to be taken for one: what seven
/// written decimals leave. In f32, where the last digits are greater than that, a few of those.
fn rigidity_tolerance<S: Float>() -> S {
    S::from_f64(1e-6).max(S::from_f64(16.0) * S::EPSILON)
}

/// See [`Target::frame_of_chain`] (rad).
const ODD_ANGLES: [f64; 3] = [0.73, 0.41, -1.19];

/// Rotations nearer than this many machine epsilons to a rigid one are left as they are, to the bit.
const RIGID: f64 = 8.0;

impl<S: Float> Target<S> {
    /// Which kind of target this is.
    pub const fn kind(&self) -> TargetKind {
        match self {
            Self::Pose(_) => TargetKind::Pose,
            Self::Position(_) => TargetKind::Position,
            Self::PositionDirection { .. } => TargetKind::PositionDirection,
            Self::PositionYaw { .. } => TargetKind::PositionYaw,
            Self::Rotation(_) => TargetKind::Rotation,
            Self::Direction(_) => TargetKind::Direction,
            Self::Ray { .. } => TargetKind::Ray,
            Self::Lookat(_) => TargetKind::Lookat,
            Self::Xy(_) => TargetKind::Xy,
            Self::XyYaw { .. } => TargetKind::XyYaw,
        }
    }

    /// The target as it is to be solved for: directions of length 1, rotations with the last decimals put right.
    ///
    /// # Errors
    /// [`IkError::NotFinite`]; [`IkError::NotRigid`] where a rotation is off by more than 1e-6, or a direction has no
    /// length.
    pub fn validate(&self) -> Result<Self, IkError<S>> {
        if !self.numbers().iter().all(|x| x.is_finite()) {
            return Err(IkError::NotFinite);
        }
        Ok(match *self {
            Self::Pose(frame) => Self::Pose(frame.validated()?),
            Self::Rotation(rotation) => Self::Rotation(rigid(&Frame { rotation, ..Frame::IDENTITY })?),
            Self::PositionDirection { position, direction } => {
                Self::PositionDirection { position, direction: unit(direction)? }
            }
            Self::Ray { position, direction } => Self::Ray { position, direction: unit(direction)? },
            Self::Direction(direction) => Self::Direction(unit(direction)?),
            other => other,
        })
    }

    /// The same in f64.
    pub(crate) fn in_f64(&self) -> Target {
        let three = |v: &[S; 3]| v.map(Float::to_f64);
        let two = |v: &[S; 2]| v.map(Float::to_f64);
        let rows = |rotation: &[[S; 3]; 3]| rotation.map(|row| row.map(Float::to_f64));
        match self {
            Self::Pose(frame) => Target::Pose(frame.in_f64()),
            Self::Position(position) => Target::Position(three(position)),
            Self::PositionDirection { position, direction } => {
                Target::PositionDirection { position: three(position), direction: three(direction) }
            }
            Self::PositionYaw { position, yaw } => {
                Target::PositionYaw { position: three(position), yaw: yaw.to_f64() }
            }
            Self::Rotation(rotation) => Target::Rotation(rows(rotation)),
            Self::Direction(direction) => Target::Direction(three(direction)),
            Self::Ray { position, direction } => {
                Target::Ray { position: three(position), direction: three(direction) }
            }
            Self::Lookat(position) => Target::Lookat(three(position)),
            Self::Xy(position) => Target::Xy(two(position)),
            Self::XyYaw { position, yaw } => Target::XyYaw { position: two(position), yaw: yaw.to_f64() },
        }
    }

    /// The target of this kind that a tool frame meets; of a line its point is the tool point, and so is what it looks at.
    pub fn of_frame(kind: TargetKind, tool: &Frame<S>) -> Self {
        let (position, direction) = (tool.translation, tool.z_axis());
        let ([px, py, _], [x, y, _]) = (position, tool.x_axis());
        let yaw = || y.atan2(x);
        match kind {
            TargetKind::Pose => Self::Pose(*tool),
            TargetKind::Position => Self::Position(position),
            TargetKind::PositionDirection => Self::PositionDirection { position, direction },
            TargetKind::PositionYaw => Self::PositionYaw { position, yaw: yaw() },
            TargetKind::Rotation => Self::Rotation(tool.rotation),
            TargetKind::Direction => Self::Direction(direction),
            TargetKind::Ray => Self::Ray { position, direction },
            TargetKind::Lookat => Self::Lookat(position),
            TargetKind::Xy => Self::Xy([px, py]),
            TargetKind::XyYaw => Self::XyYaw { position: [px, py], yaw: yaw() },
        }
    }

    /// A tool frame that meets the target: the only one that meets a pose. `None` where the target has no point or
    /// prescribes the tool of planar arms only.
    pub fn frame(&self) -> Option<Frame<S>> {
        match self {
            Self::Rotation(_) | Self::Direction(_) | Self::Xy(_) | Self::XyYaw { .. } => None,
            _ => Some(self.any_frame()),
        }
    }

    /// The same with anything for what the target does not speak of.
    pub(crate) fn any_frame(&self) -> Frame<S> {
        let level = |[x, y]: [S; 2]| [x, y, S::ZERO];
        match self {
            Self::Pose(frame) => *frame,
            Self::Position(position) | Self::Lookat(position) => Frame::from_translation(*position),
            Self::PositionDirection { position, direction } | Self::Ray { position, direction } => {
                Frame { rotation: along(*direction), translation: *position }
            }
            Self::PositionYaw { position, yaw } => Frame::from_rpy(*position, [S::ZERO, S::ZERO, *yaw]),
            Self::Rotation(rotation) => Frame { rotation: *rotation, ..Frame::IDENTITY },
            Self::Direction(direction) => Frame { rotation: along(*direction), ..Frame::IDENTITY },
            Self::Xy(position) => Frame::from_translation(level(*position)),
            Self::XyYaw { position, yaw } => Frame::from_rpy(level(*position), [S::ZERO, S::ZERO, *yaw]),
        }
    }

    /// A frame for the tip of a chain of six joints that ends in a spherical joint where the target leaves the orientation open:
    /// turned by angles that no arm has, so that its axes are in one plane at no pose that anyone would ask for.
    pub(crate) fn frame_of_chain(&self) -> Option<Frame<S>> {
        match self {
            Self::Position(position) | Self::Lookat(position) => {
                Some(Frame::from_rpy(*position, ODD_ANGLES.map(S::from_f64)))
            }
            _ => self.frame(),
        }
    }

    /// How far a tool frame is from the target, in what the target prescribes: position (m) and rotation error (rad).
    ///
    /// The position error of a ray is the distance of the tool point from the line, that of a lookat target the distance of
    /// the target from the line along the tool's z axis. A yaw is compared in the base's xy plane. Directions must have
    /// length 1 (see [`Target::validate`]).
    pub fn errors(&self, tool: &Frame<S>) -> (S, S) {
        let point = tool.translation;
        match self {
            Self::Pose(frame) => {
                (norm(sub(point, frame.translation)), rotation_error(&frame.rotation, &tool.rotation))
            }
            Self::Position(position) => (norm(sub(point, *position)), S::ZERO),
            Self::PositionDirection { position, direction } => {
                (norm(sub(point, *position)), angle_between(*direction, tool.z_axis()))
            }
            Self::PositionYaw { position, yaw } => (norm(sub(point, *position)), yaw_error(*yaw, tool)),
            Self::Rotation(rotation) => (S::ZERO, rotation_error(rotation, &tool.rotation)),
            Self::Direction(direction) => (S::ZERO, angle_between(*direction, tool.z_axis())),
            Self::Ray { position, direction } => {
                (norm(cross(*direction, sub(point, *position))), angle_between(*direction, tool.z_axis()))
            }
            Self::Lookat(position) => (norm(cross(tool.z_axis(), sub(*position, point))), S::ZERO),
            Self::Xy(position) => (distance_xy(*position, point), S::ZERO),
            Self::XyYaw { position, yaw } => (distance_xy(*position, point), yaw_error(*yaw, tool)),
        }
    }

    /// The target's numbers in the order in which solutions take them: the rows of `[R | p]` of a pose, the rows of a
    /// rotation; else position, then direction, or cosine and sine of the yaw.
    pub fn numbers(&self) -> Numbers<S> {
        match self {
            Self::Pose(frame) => Numbers::of(frame.rows()),
            Self::Position(position) | Self::Lookat(position) => Numbers::of(*position),
            Self::PositionDirection { position: [px, py, pz], direction: [zx, zy, zz] }
            | Self::Ray { position: [px, py, pz], direction: [zx, zy, zz] } => {
                Numbers::of([*px, *py, *pz, *zx, *zy, *zz])
            }
            Self::PositionYaw { position: [px, py, pz], yaw } => {
                let (sin, cos) = yaw.sin_cos();
                Numbers::of([*px, *py, *pz, cos, sin])
            }
            Self::Rotation([[r11, r12, r13], [r21, r22, r23], [r31, r32, r33]]) => {
                Numbers::of([*r11, *r12, *r13, *r21, *r22, *r23, *r31, *r32, *r33])
            }
            Self::Direction(direction) => Numbers::of(*direction),
            Self::Xy(position) => Numbers::of(*position),
            Self::XyYaw { position: [px, py], yaw } => {
                let (sin, cos) = yaw.sin_cos();
                Numbers::of([*px, *py, cos, sin])
            }
        }
    }
}

/// The numbers of a [`Target`]; a slice in all respects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numbers<S = f64> {
    values: [S; 12],
    len: usize,
}

impl<S: Float> Numbers<S> {
    fn of<const N: usize>(values: [S; N]) -> Self {
        let mut numbers = Self { values: [S::ZERO; 12], len: N };
        for (to, from) in numbers.values.iter_mut().zip(values) {
            *to = from;
        }
        numbers
    }
}

impl<S> Deref for Numbers<S> {
    type Target = [S];
    fn deref(&self) -> &[S] {
        self.values.get(..self.len).unwrap_or(&self.values)
    }
}

impl<S: Float> Frame<S> {
    /// The same in f64.
    pub(crate) fn in_f64(&self) -> Frame {
        Frame {
            rotation: self.rotation.map(|row| row.map(Float::to_f64)),
            translation: self.translation.map(Float::to_f64),
        }
    }

    /// The frame with the last decimals of its rotation put right, see [`Target::validate`].
    pub(crate) fn validated(&self) -> Result<Self, IkError<S>> {
        // Those of the rotation are found out by `rigid`.
        if !self.translation.iter().all(|x| x.is_finite()) {
            return Err(IkError::NotFinite);
        }
        Ok(Self { rotation: rigid(self)?, ..*self })
    }
}

/// The nearest rotation.
fn rigid<S: Float>(frame: &Frame<S>) -> Result<[[S; 3]; 3], IkError<S>> {
    let error = frame.rigidity_error();
    if error <= S::from_f64(RIGID) * S::EPSILON {
        return Ok(frame.rotation);
    }
    if error <= rigidity_tolerance() {
        // Newton's iteration for the polar factor, R (3 - RᵀR) / 2; the error is squared each time: 1e-6, 1e-12, 1e-24.
        return Ok(polar_step(&polar_step(&frame.rotation)));
    }
    Err(if error.is_finite() { IkError::NotRigid { error } } else { IkError::NotFinite })
}

fn polar_step<S: Float>(r: &[[S; 3]; 3]) -> [[S; 3]; 3] {
    let half = S::ONE / S::TWO;
    let [[a, b, c], [d, e, f], [g, h, i]] =
        matrix_product(&transpose(r), r).map(|row| row.map(|x| -(x * half)));
    let three_halves = S::ONE + half;
    matrix_product(r, &[[a + three_halves, b, c], [d, e + three_halves, f], [g, h, i + three_halves]])
}

fn unit<S: Float>(direction: [S; 3]) -> Result<[S; 3], IkError<S>> {
    let [x, y, z] = direction.map(Float::abs);
    let greatest = x.max(y).max(z);
    if greatest <= S::ZERO {
        return Err(IkError::NotRigid { error: S::ONE });
    }
    // Scaled first, so that squares neither overflow nor vanish.
    let scaled = direction.map(|x| x / greatest);
    let length = norm(scaled);
    if length.is_finite() { Ok(scaled.map(|x| x / length)) } else { Err(IkError::NotFinite) }
}

/// A rotation whose z axis is a unit vector, without a case in which it loses digits \[Duff et al. 2017, Building an
/// orthonormal basis, revisited\].
fn along<S: Float>([x, y, z]: [S; 3]) -> [[S; 3]; 3] {
    let sign = if z < S::ZERO { -S::ONE } else { S::ONE };
    let a = -(S::ONE / (sign + z));
    let b = x * y * a;
    [[S::ONE + sign * x * x * a, b, x], [sign * b, sign + y * y * a, y], [-(sign * x), -y, z]]
}

/// The angle between unit vectors, as accurate near 0 and near pi as between \[Kahan 2006\].
fn angle_between<S: Float>(a: [S; 3], b: [S; 3]) -> S {
    S::TWO * norm(sub(a, b)).atan2(norm(add(a, b)))
}

fn yaw_error<S: Float>(yaw: S, tool: &Frame<S>) -> S {
    let (sin, cos) = yaw.sin_cos();
    let [x, y, _] = tool.x_axis();
    (y * cos - x * sin).atan2(x * cos + y * sin).abs()
}

fn distance_xy<S: Float>([x, y]: [S; 2], [px, py, _]: [S; 3]) -> S {
    let difference = [px - x, py - y, S::ZERO];
    dot(difference, difference).sqrt()
}
