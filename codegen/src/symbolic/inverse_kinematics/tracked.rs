//! What is prescribed, as points and directions that the chain carries from the base and from the tip.
//!
//! A prescribed pose can be read from either end: it says where the tool is as seen from the base, and where the base
//! is as seen from the tool. An arm whose last joints are known, or whose shoulder rather than wrist is spherical, is
//! solved the second way.

use super::closure::Trouble;
use super::polynomial::{Overflow, Polynomial};
use super::walk::{Vector, Walker};
use crate::model::Target;
use crate::model::chain::Element;
use crate::symbolic::expression::Expr;
use crate::symbolic::number::Number;
use crate::symbolic::transform::{Mat3, Rigid, Vec3};
use crate::symbolic::{chain, transform};

/// From which end a prescribed pose is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seen {
    /// The tool, as seen from the base.
    FromBase,
    /// The base, as seen from the tool.
    FromTool,
}

/// Something prescribed that moves with the tool.
pub(super) struct Tracked {
    pub what: &'static str,
    pub letter: &'static str,
    /// A point, or a direction.
    pub point: bool,
    /// In the frame before the first joint's fixed transform (`after_base` false) or behind it.
    pub target: Vector,
    pub after_base: bool,
    /// In the frame behind the last link (`whole` true) or before it.
    pub tip: Vector,
    pub whole: bool,
}

impl Tracked {
    /// `y1` is the second coordinate of the point in frame 1, less what is known of it on the other side.
    pub(super) fn row_name(&self, row: usize, frame: usize) -> String {
        let axis = ["x", "y", "z"].get(row).copied().unwrap_or("w");
        if self.point { format!("{axis}{frame}") } else { format!("{}{axis}{frame}", self.letter) }
    }
}

impl Walker<'_> {
    /// What a target prescribes, as seen from the base.
    pub(super) fn tracked(
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
            (Target::PositionDirection, [x, y, z, zx, zy, zz]) => {
                Ok(self.axis_and_foot(plain, [*x, *y, *z], [*zx, *zy, *zz])?.into())
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
    pub(super) fn last_origin(&mut self, base: &Rigid, tool: &Rigid, rotation: &Mat3, p: Vec3) -> Vec3 {
        let back = transform::apply(self.arena, &transform::transpose(&tool.rotation), tool.translation);
        let arm = transform::apply(self.arena, rotation, back);
        let origin = transform::sub(self.arena, p, arm);
        transform::sub(self.arena, origin, base.translation)
    }

    /// The direction of the tool's z axis, and the foot on it of the common normal with the last joint's axis: both are known, and
    /// neither changes with a turn about that axis.
    fn axis_and_foot(
        &mut self,
        plain: &crate::model::Chain,
        position: Vec3,
        direction: Vec3,
    ) -> Result<[Tracked; 2], Overflow> {
        let (zero, one) = (Polynomial::zero(), Polynomial::number(self.size(), Number::ONE));
        let mut ahead = (self.arena.zero(), zero.clone());
        let behind = plain.links.last().map_or(&[][..], |link| &link.elements);
        for element in behind.iter().rev() {
            let Element::Translate { axis: 2, value, name, note } = element else { break };
            let by = self.parameter(name, *value, note, 1);
            let along = self.arena.parameter(name, *value, 1, note);
            ahead = (self.arena.add(ahead.0, along), ahead.1.add(&by)?);
        }
        let base = chain::rigid(self.arena, plain.links.first().map_or(&[][..], |link| &link.elements));
        let tip = direction.map(|entry| self.arena.mul(ahead.0, entry));
        let foot = transform::sub(self.arena, position, tip);
        let moved = transform::sub(self.arena, foot, base.translation);
        let target = self.behind_base(&base.rotation, moved, ["px", "py", "pz"], 1)?;
        let along = self.behind_base(&base.rotation, direction, ["zx", "zy", "zz"], 0)?;
        let foot = Tracked {
            what: "foot on the tool's axis",
            letter: "",
            point: true,
            target,
            after_base: true,
            tip: [zero.clone(), zero.clone(), zero.sub(&ahead.1)?],
            whole: true,
        };
        let axis = Tracked {
            what: "direction of the tool's axis",
            letter: "z",
            point: false,
            target: along,
            after_base: true,
            tip: [zero.clone(), zero, one],
            whole: true,
        };
        Ok([axis, foot])
    }

    /// The base as the tool sees it: its axes, and the point of the first axis from which the second one starts.
    pub(super) fn tracked_base(
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
    pub(super) fn behind_last_joint(&mut self, plain: &crate::model::Chain) -> Rigid {
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
}
