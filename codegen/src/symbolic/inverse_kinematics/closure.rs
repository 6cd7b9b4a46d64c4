//! The equations of a problem: what is prescribed, written in every frame of the chain.
//!
//! A prescribed point (or direction) is carried from the base to the frame before each joint by the inverses of the
//! joints passed, and the same point is carried from the tip to that frame by the joints that follow. Both sides are
//! equal, row by row, whatever frame they are written in; which frame is simplest differs from arm to arm.
//!
//! A prescribed pose can be read from either end: it says where the tool is as seen from the base, and where the base
//! is as seen from the tool. An arm whose last joints are known, or whose shoulder rather than wrist is spherical, is
//! solved the second way.

use super::atoms::{AngleData, Atoms};
use super::polynomial::{Overflow, Polynomial};
use super::unknowns::{Free, Unknowns};
use super::walk::{Vector, Walker};
use crate::model::chain::Element;
use crate::model::{JointKind, Model, Target};
use crate::symbolic::expression::{Arena, Expr, Leaf};
use crate::symbolic::number::Number;
use crate::symbolic::transform::{Mat3, Rigid, Vec3};
use crate::symbolic::{chain, transform};
use std::fmt;

/// polynomial = 0, and where it comes from.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    pub polynomial: Polynomial,
    /// Frame and tracked quantity; rows of one group are coordinates of one vector.
    pub group: usize,
    /// Where it comes from.
    pub origin: Origin,
    /// What its known part is called: `y1`.
    pub name: String,
}

/// Where an equation comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Origin {
    /// Whether it is a sum of squares.
    pub squares: bool,
    /// Rows of a vector (1-based); none where `of` says it all.
    pub rows: Vec<usize>,
    /// "the position in frame 1"
    pub of: String,
    /// A second equation beside it, of another vector.
    pub and: Option<Box<Origin>>,
}

impl Origin {
    fn whole(of: String) -> Self {
        Self { squares: false, rows: Vec::new(), of, and: None }
    }

    /// Of two equations together.
    pub(super) fn with(&self, other: &Self) -> Self {
        if self.of == other.of && self.squares == other.squares && !self.rows.is_empty() {
            let rows = [self.rows.as_slice(), &other.rows].concat();
            return Self { rows, ..self.clone() };
        }
        Self { and: Some(Box::new(other.clone())), ..self.clone() }
    }
}

/// "squares of rows 1 and 2 of the position in frame 1"
impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.squares {
            f.write_str("squares of ")?;
        }
        match self.rows.as_slice() {
            [] => {}
            [row] => write!(f, "row {row} of ")?,
            [first, second] => write!(f, "rows {first} and {second} of ")?,
            _ => f.write_str("all rows of ")?,
        }
        f.write_str(&self.of)?;
        match &self.and {
            Some(other) => write!(f, "; {other}"),
            None => Ok(()),
        }
    }
}

/// Why no equations could be written.
#[derive(Debug, Clone, Copy)]
pub(super) enum Trouble {
    /// See [`Overflow`].
    Overflow,
    /// This target is not solved by this method.
    Target,
}

impl From<Overflow> for Trouble {
    fn from(_: Overflow) -> Self {
        Self::Overflow
    }
}

/// Something prescribed that moves with the tool.
struct Tracked {
    what: &'static str,
    letter: &'static str,
    /// A point, or a direction.
    point: bool,
    /// In the frame before the first joint's fixed transform (`after_base` false) or behind it.
    target: Vector,
    after_base: bool,
    /// In the frame behind the last link (`whole` true) or before it.
    tip: Vector,
    whole: bool,
}

impl Tracked {
    /// `y1` is the second coordinate of the point in frame 1, less what is known of it on the other side.
    fn row_name(&self, row: usize, frame: usize) -> String {
        let axis = ["x", "y", "z"].get(row).copied().unwrap_or("w");
        if self.point { format!("{axis}{frame}") } else { format!("{}{axis}{frame}", self.letter) }
    }
}

/// Vocabulary, prescribed numbers and equations of a problem.
pub(super) struct Closure {
    pub atoms: Atoms,
    pub equations: Vec<Equation>,
}

/// From which end a prescribed pose is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seen {
    /// The tool, as seen from the base.
    FromBase,
    /// The base, as seen from the tool.
    FromTool,
}

/// Writes the equations.
pub(super) fn build(
    arena: &mut Arena,
    model: &Model,
    target: Target,
    unknowns: &Unknowns,
    seen: Seen,
) -> Result<Closure, Trouble> {
    let plain = model.chain();
    let mut walker = Walker { arena, model, unknowns, atoms: Atoms::default() };
    walker.angles(&plain);
    let inputs: Vec<Expr> =
        target.input_names().iter().map(|name| walker.arena.leaf(name, Leaf::Known)).collect();
    let mut equations = Vec::new();
    let mut group = 0;
    let tracked = match seen {
        Seen::FromBase => walker.tracked(&plain, target, &inputs)?,
        Seen::FromTool => walker.tracked_base(&plain, target, &inputs)?,
    };
    for tracked in tracked {
        walker.track(&plain, &tracked, &mut group, &mut equations)?;
    }
    if let Some((cos, sin)) = yaw_inputs(target, &inputs) {
        walker.yaw(&plain, cos, sin, &mut group, &mut equations)?;
    }
    Ok(Closure { atoms: walker.atoms, equations })
}

fn yaw_inputs(target: Target, inputs: &[Expr]) -> Option<(Expr, Expr)> {
    match (target, inputs) {
        (Target::PositionYaw | Target::XyYaw, [.., cos, sin]) => Some((*cos, *sin)),
        _ => None,
    }
}

impl Walker<'_> {
    fn tracked(
        &mut self,
        plain: &crate::model::Chain,
        target: Target,
        inputs: &[Expr],
    ) -> Result<Vec<Tracked>, Trouble> {
        let size = self.size();
        let (zero, one) = (Polynomial::zero(), Polynomial::number(size, Number::ONE));
        let origin = [zero.clone(), zero.clone(), zero.clone()];
        let base = plain.links.first().map_or(&[][..], |link| &link.elements);
        match (target, inputs) {
            (Target::Position | Target::PositionYaw, [x, y, z, ..]) => {
                let frame = chain::rigid(self.arena, base);
                let moved = transform::sub(self.arena, [*x, *y, *z], frame.translation);
                let target = self.behind_base(&frame.rotation, moved, ["px", "py", "pz"], 1)?;
                Ok(vec![Tracked {
                    what: "position",
                    letter: "",
                    point: true,
                    target,
                    after_base: true,
                    tip: origin,
                    whole: true,
                }])
            }
            (Target::Xy | Target::XyYaw, [x, y, ..]) => {
                let [_, _, height] = self.tip_in_base(plain, origin.clone(), true)?;
                let target = [self.known("px", *x, 1)?, self.known("py", *y, 1)?, height];
                Ok(vec![Tracked {
                    what: "position",
                    letter: "",
                    point: true,
                    target,
                    after_base: false,
                    tip: origin,
                    whole: true,
                }])
            }
            (Target::Direction, [x, y, z]) => {
                let frame = chain::rigid(self.arena, base);
                let target = self.behind_base(&frame.rotation, [*x, *y, *z], ["zx", "zy", "zz"], 0)?;
                let tip = [zero.clone(), zero, one];
                Ok(vec![Tracked {
                    what: "direction",
                    letter: "z",
                    point: false,
                    target,
                    after_base: true,
                    tip,
                    whole: true,
                }])
            }
            (Target::Rotation, [a, b, c, d, e, f, g, h, i]) => {
                let tool = self.behind_last_joint(plain);
                Ok(self.axes(base, &tool, [[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]])?)
            }
            (Target::Pose, [a, b, c, x, d, e, f, y, g, h, i, z]) => {
                let tool = self.behind_last_joint(plain);
                let rotation = [[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]];
                let mut found = self.axes(base, &tool, rotation)?;
                let frame = chain::rigid(self.arena, base);
                let moved = self.last_origin(&frame, &tool, &rotation, [*x, *y, *z]);
                let target = self.behind_base(&frame.rotation, moved, ["px", "py", "pz"], 1)?;
                found.push(Tracked {
                    what: "position",
                    letter: "",
                    point: true,
                    target,
                    after_base: true,
                    tip: origin,
                    whole: false,
                });
                Ok(found)
            }
            _ => Err(Trouble::Target),
        }
    }

    /// From the origin behind the base's fixed transform to that of the last joint's frame, p - R tool^T t, in the axes
    /// of the base frame.
    fn last_origin(&mut self, base: &Rigid, tool: &Rigid, rotation: &Mat3, p: Vec3) -> Vec3 {
        let back = transform::apply(self.arena, &transform::transpose(&tool.rotation), tool.translation);
        let arm = transform::apply(self.arena, rotation, back);
        let origin = transform::sub(self.arena, p, arm);
        transform::sub(self.arena, origin, base.translation)
    }

    /// The base as the tool sees it: its axes, and the point of the first axis from which the second one starts.
    fn tracked_base(
        &mut self,
        plain: &crate::model::Chain,
        target: Target,
        inputs: &[Expr],
    ) -> Result<Vec<Tracked>, Trouble> {
        let (rotation, position) = match (target, inputs) {
            (Target::Rotation, [a, b, c, d, e, f, g, h, i]) => {
                ([[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]], None)
            }
            (Target::Pose, [a, b, c, x, d, e, f, y, g, h, i, z]) => {
                ([[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]], Some([*x, *y, *z]))
            }
            _ => return Err(Trouble::Target),
        };
        let (zero, one) = (Polynomial::zero(), Polynomial::number(self.size(), Number::ONE));
        let elements = plain.links.first().map_or(&[][..], |link| &link.elements);
        let base = chain::rigid(self.arena, elements);
        let tool = self.behind_last_joint(plain);
        let turned = transform::product(self.arena, &rotation, &transform::transpose(&tool.rotation));
        let whole = transform::product(self.arena, &transform::transpose(&base.rotation), &turned);
        let mut found = Vec::new();
        for (index, (row, letter)) in whole.into_iter().zip(["x", "y", "z"]).enumerate() {
            let [x, y, z] = [1, 2, 3].map(|column| format!("r{}{column}0", index + 1));
            let [rx, ry, rz] = row;
            let tip = [self.known(&x, rx, 0)?, self.known(&y, ry, 0)?, self.known(&z, rz, 0)?];
            let mut target = [zero.clone(), zero.clone(), zero.clone()];
            if let Some(entry) = target.get_mut(index) {
                *entry = one.clone();
            }
            let what = ["base's x axis", "base's y axis", "base's z axis"].get(index).copied();
            let what = what.unwrap_or("base's axis");
            found.push(Tracked { what, letter, point: false, target, after_base: true, tip, whole: false });
        }
        let Some(position) = position else { return Ok(found) };
        // Along the first axis, to the common normal with the second.
        let mut foot = [zero.clone(), zero.clone(), zero];
        let mut start = [self.arena.zero(); 3];
        for element in plain.links.get(1).map_or(&[][..], |link| &link.elements) {
            let Element::Translate { axis: 2, value, name, note } = element else { break };
            let along = self.parameter(name, *value, note, 1);
            let [_, _, z] = &mut foot;
            *z = z.add(&along)?;
            let along = self.arena.parameter(name, *value, 1, note);
            let [_, _, z] = &mut start;
            *z = self.arena.add(*z, along);
        }
        let moved = self.last_origin(&base, &tool, &rotation, position);
        let moved = transform::apply(self.arena, &transform::transpose(&base.rotation), moved);
        let back = transform::sub(self.arena, start, moved);
        let [x, y, z] = transform::apply(self.arena, &transform::transpose(&whole), back);
        let tip = [self.known("bx", x, 1)?, self.known("by", y, 1)?, self.known("bz", z, 1)?];
        found.push(Tracked {
            what: "start of the second axis",
            letter: "",
            point: true,
            target: foot,
            after_base: true,
            tip,
            whole: false,
        });
        Ok(found)
    }

    /// What is behind the last joint.
    fn behind_last_joint(&mut self, plain: &crate::model::Chain) -> Rigid {
        match plain.links.as_slice() {
            [_, .., last] => chain::rigid(self.arena, &last.elements),
            _ => transform::identity(self.arena),
        }
    }

    /// The axes of the last joint's frame. R' = base^T R tool^T, so that neither mixes rows or columns.
    fn axes(&mut self, base: &[Element], tool: &Rigid, rotation: Mat3) -> Result<Vec<Tracked>, Overflow> {
        let (zero, one) = (Polynomial::zero(), Polynomial::number(self.size(), Number::ONE));
        let turned = transform::product(self.arena, &rotation, &transform::transpose(&tool.rotation));
        let frame = chain::rigid(self.arena, base);
        let mut found = Vec::new();
        let columns = transform::transpose(&turned).into_iter().zip(["x", "y", "z"]);
        for (index, (column, letter)) in columns.enumerate() {
            let names = [1, 2, 3].map(|row| format!("r{row}{}", index + 1));
            let [x, y, z] = &names;
            let target = self.behind_base(&frame.rotation, column, [x, y, z], 0)?;
            let mut tip = [zero.clone(), zero.clone(), zero.clone()];
            if let Some(entry) = tip.get_mut(index) {
                *entry = one.clone();
            }
            let what = ["x axis", "y axis", "z axis"].get(index).copied().unwrap_or("axis");
            found.push(Tracked { what, letter, point: false, target, after_base: true, tip, whole: false });
        }
        Ok(found)
    }

    /// A known vector of the base frame, turned into the frame behind the base's fixed transform.
    fn behind_base(
        &mut self,
        rotation: &transform::Mat3,
        v: transform::Vec3,
        names: [&str; 3],
        dimension: u8,
    ) -> Result<Vector, Overflow> {
        let turned = transform::apply(self.arena, &transform::transpose(rotation), v);
        let [x, y, z] = turned;
        let [nx, ny, nz] = names.map(|name| format!("{name}0"));
        Ok([self.known(&nx, x, dimension)?, self.known(&ny, y, dimension)?, self.known(&nz, z, dimension)?])
    }

    /// Equations of one tracked vector in the frame before every joint.
    fn track(
        &mut self,
        plain: &crate::model::Chain,
        tracked: &Tracked,
        group: &mut usize,
        equations: &mut Vec<Equation>,
    ) -> Result<(), Trouble> {
        let steps = self.steps(plain)?;
        let last = steps.len().saturating_sub(1);
        // From the tip: the vector in the frame before each joint, the tip first.
        let mut inner = tracked.tip.clone();
        let mut from_tip = Vec::new();
        for (index, (joint, link)) in steps.iter().enumerate().rev() {
            if !(index == last && !tracked.whole && index > 0) {
                for step in link.iter().rev() {
                    inner = self.carry(step, inner, tracked.point, false)?;
                }
            }
            if let Some(joint) = joint {
                inner = self.carry(joint, inner, tracked.point, false)?;
                from_tip.push((index, inner.clone()));
            }
        }
        from_tip.reverse();
        let mut outer = tracked.target.clone();
        let mut norms = Vec::new();
        for (index, (joint, link)) in steps.iter().enumerate() {
            if let Some(joint) = joint {
                let frame = plain.joints.get(index.wrapping_sub(1)).map_or(0, |joint| joint.row);
                if let Some((_, inner)) = from_tip.iter().find(|(at, _)| *at == index) {
                    for (row, (left, right)) in outer.iter().zip(inner).enumerate() {
                        if left.len().max(right.len()) > LONGEST_ROW {
                            continue;
                        }
                        equations.push(Equation {
                            polynomial: left.sub(right)?,
                            group: *group,
                            origin: Origin {
                                rows: vec![row + 1],
                                ..Origin::whole(format!("the {} in frame {frame}", tracked.what))
                            },
                            name: tracked.row_name(row, frame),
                        });
                    }
                    if tracked.point {
                        norms.push((frame, squared(&outer)?, squared(inner)?));
                    }
                }
                *group += 1;
                outer = self.carry(joint, outer, tracked.point, true)?;
            }
            if index == last && joint.is_some() {
                break;
            }
            if index > 0 || !tracked.after_base {
                for step in link {
                    outer = self.carry(step, outer, tracked.point, true)?;
                }
            }
        }
        // Where axes meet, a distance knows less of the joints than the coordinates do.
        for (frame, outer, inner) in norms {
            if let (Some(outer), Some(inner)) = (outer, inner) {
                *group += 1;
                equations.push(Equation {
                    polynomial: outer.sub(&inner)?,
                    group: *group,
                    origin: Origin::whole(format!(
                        "squared distance of the {} from the origin of frame {frame}",
                        tracked.what
                    )),
                    name: format!("n{frame}"),
                });
            }
        }
        Ok(())
    }

    /// The heading of the tool's x axis in the base frame is the yaw.
    fn yaw(
        &mut self,
        plain: &crate::model::Chain,
        cos: Expr,
        sin: Expr,
        group: &mut usize,
        equations: &mut Vec<Equation>,
    ) -> Result<(), Trouble> {
        let size = self.size();
        let one = Polynomial::number(size, Number::ONE);
        let axis = [one.clone(), Polynomial::zero(), Polynomial::zero()];
        let [x, y, _] = self.tip_in_base(plain, axis, false)?;
        let (cos, sin) = (self.known("cyaw", cos, 0)?, self.known("syaw", sin, 0)?);
        let level = x.mul(&x)?.add(&y.mul(&y)?)?.sub(&one)?.is_zero();
        let rows = if level {
            vec![(x.sub(&cos)?, "cosine of the yaw"), (y.sub(&sin)?, "sine of the yaw")]
        } else {
            vec![(x.mul(&sin)?.sub(&y.mul(&cos)?)?, "yaw")]
        };
        for (polynomial, what) in rows {
            equations.push(Equation {
                polynomial,
                group: *group,
                origin: Origin::whole(what.to_string()),
                name: "w".to_string(),
            });
        }
        *group += 1;
        Ok(())
    }
}

/// Longer rows are not made equations: they never have one unknown.
const LONGEST_ROW: usize = 96;

/// Vectors with longer entries are not squared.
const LONGEST_SQUARED: usize = 12;

/// x^2 + y^2 + z^2, unless it would be too long.
fn squared(v: &Vector) -> Result<Option<Polynomial>, Overflow> {
    if v.iter().any(|entry| entry.len() > LONGEST_SQUARED) {
        return Ok(None);
    }
    let mut sum = Polynomial::zero();
    for entry in v {
        sum = sum.add(&entry.mul(entry)?)?;
    }
    Ok(Some(sum))
}

impl Closure {
    /// Everything that has to be found.
    pub(super) fn open(&self, unknowns: &Unknowns) -> super::reading::Open {
        let angles = self.atoms.angles.iter().enumerate();
        let unknown = |index: usize| unknowns.free.get(index).is_some_and(|free| free.given.is_none());
        let angles = angles.filter(|(_, angle)| matches!(angle, AngleData::Free(index) if unknown(*index)));
        let slides = (0..self.atoms.list.len()).map(|index| index as super::polynomial::Atom);
        // A slide that no equation contains stays open, and the problem unsolved.
        let slide = |free: &&Free| free.kind == JointKind::Prismatic && free.given.is_none();
        let absent = unknowns.free.iter().filter(slide).count();
        let mut slides: Vec<_> = slides.filter(|atom| self.atoms.slide(*atom).is_some_and(unknown)).collect();
        while slides.len() < absent {
            slides.push(super::polynomial::Atom::MAX);
        }
        super::reading::Open { angles: angles.map(|(index, _)| index).collect(), slides }
    }
}
