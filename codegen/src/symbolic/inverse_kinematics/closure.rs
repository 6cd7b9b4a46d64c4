//! The equations of a problem: what is prescribed, written in every frame of the chain.
//!
//! A prescribed point (or direction) is carried from the base to the frame before each joint by the inverses of the
//! joints passed, and the same point is carried from the tip to that frame by the joints that follow. Both sides are
//! equal, row by row, whatever frame they are written in; which frame is simplest differs from arm to arm.

use super::atoms::{AngleData, Atoms};
pub(super) use super::equation::{Equation, Origin};
use super::polynomial::{Overflow, Polynomial};
use super::unknowns::Unknowns;
use super::walk::{Step, Vector, Walker};
use crate::model::chain::Element;
use crate::model::{JointKind, Model, Target};
use crate::symbolic::expression::{Arena, Expr, Leaf};
use crate::symbolic::number::Number;
use crate::symbolic::transform::{Mat3, Rigid};
use crate::symbolic::{chain, transform};

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

/// The end from which the chain is walked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seen {
    FromBase,
    /// The base is what moves then: an arm with its spherical joint next to the base is one with a spherical wrist.
    FromTool,
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

/// Writes the equations.
pub(super) fn build(
    arena: &mut Arena,
    model: &Model,
    target: Target,
    unknowns: &Unknowns,
    seen: Seen,
) -> Result<Closure, Trouble> {
    let plain = match seen {
        Seen::FromBase => model.chain(),
        Seen::FromTool => model.chain().reversed(),
    };
    let mut walker = Walker { arena, model, unknowns, atoms: Atoms::default() };
    walker.angles(&plain);
    let inputs: Vec<Expr> =
        target.input_names().iter().map(|name| walker.arena.leaf(name, Leaf::Known)).collect();
    let mut equations = Vec::new();
    let mut group = 0;
    for tracked in walker.tracked(&plain, target, &inputs, seen)? {
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
        seen: Seen,
    ) -> Result<Vec<Tracked>, Trouble> {
        let size = self.size();
        let (zero, one) = (Polynomial::zero(), Polynomial::number(size, Number::ONE));
        let origin = [zero.clone(), zero.clone(), zero.clone()];
        let base = plain.links.first().map_or(&[][..], |link| &link.elements);
        match (target, inputs) {
            (Target::Pose, _) => {}
            _ if seen == Seen::FromTool => return Err(Trouble::Target),
            _ => {}
        }
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
                let (rotation, [x, y, z]) =
                    self.seen(seen, [[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]], [*x, *y, *z]);
                let mut found = self.axes(base, &tool, rotation)?;
                // A point on the last axis, t from the tool's: p - R tool^T t.
                let (along, tip) = self.foot_on_last_axis(plain)?;
                let [tx, ty, tz] = tool.translation;
                let t = [tx, ty, self.arena.add(tz, along)];
                let back = transform::apply(self.arena, &transform::transpose(&tool.rotation), t);
                let arm = transform::apply(self.arena, &rotation, back);
                let frame = chain::rigid(self.arena, base);
                let origin_of_last = transform::sub(self.arena, [x, y, z], arm);
                let moved = transform::sub(self.arena, origin_of_last, frame.translation);
                let target = self.behind_base(&frame.rotation, moved, ["px", "py", "pz"], 1)?;
                found.push(Tracked {
                    what: "position",
                    letter: "",
                    point: true,
                    target,
                    after_base: true,
                    tip: [zero.clone(), zero, tip],
                    whole: false,
                });
                for tracked in found.iter_mut().filter(|_| seen == Seen::FromTool) {
                    tracked.what = match tracked.what {
                        "x axis" => "base's x axis",
                        "y axis" => "base's y axis",
                        "z axis" => "base's z axis",
                        _ => "base",
                    };
                }
                Ok(found)
            }
            _ => Err(Trouble::Target),
        }
    }

    /// How far the origin of the last joint's frame is beyond the last step before it that isn't along its axis: where that
    /// axis meets the one before, if they meet. As a length, and as the coordinate of that place.
    fn foot_on_last_axis(&mut self, plain: &crate::model::Chain) -> Result<(Expr, Polynomial), Overflow> {
        let (mut along, mut coordinate) = (self.arena.zero(), Polynomial::zero());
        let before = plain.links.len().checked_sub(2).filter(|index| *index > 0);
        let elements = before.and_then(|index| plain.links.get(index)).map_or(&[][..], |link| &link.elements);
        for element in elements.iter().rev() {
            let Element::Translate { axis: 2, value, name, note } = element else { break };
            let length = self.arena.parameter(name, *value, 1, note);
            along = self.arena.add(along, length);
            coordinate = coordinate.sub(&self.parameter(name, *value, note, 1))?;
        }
        Ok((along, coordinate))
    }

    /// The tool in the base frame, or the base in the tool frame.
    fn seen(&mut self, seen: Seen, rotation: Mat3, position: transform::Vec3) -> (Mat3, transform::Vec3) {
        match seen {
            Seen::FromBase => (rotation, position),
            Seen::FromTool => {
                let back = transform::transpose(&rotation);
                let position = transform::apply(self.arena, &back, position);
                (back, position.map(|x| self.arena.neg(x)))
            }
        }
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
        // From the tip: the vector in the frame before each joint, the tip first, as far as it stays short.
        let mut inner = Some(tracked.tip.clone());
        let mut from_tip = Vec::new();
        for (index, (joint, link)) in steps.iter().enumerate().rev() {
            if !(index == last && !tracked.whole && index > 0) {
                inner = self.through(link.iter().rev(), inner, tracked.point, false);
            }
            if let Some(joint) = joint {
                inner = self.through([joint].into_iter(), inner, tracked.point, false);
                from_tip.extend(inner.clone().map(|inner| (index, inner)));
            }
        }
        from_tip.reverse();
        let mut known = Some(tracked.target.clone());
        let mut norms = Vec::new();
        for (index, (joint, link)) in steps.iter().enumerate() {
            let Some(outer) = known.take() else { break };
            let mut next = Some(outer.clone());
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
                        norms.push((frame, squared(&outer).unwrap_or(None), squared(inner).unwrap_or(None)));
                    }
                }
                *group += 1;
                next = self.through([joint].into_iter(), next, tracked.point, true);
            }
            if index == last && joint.is_some() {
                break;
            }
            if index > 0 || !tracked.after_base {
                next = self.through(link.iter(), next, tracked.point, true);
            }
            known = next;
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

    /// A vector through steps, unless it grows so long there that no row of it can have one unknown.
    fn through<'s, 'p: 's>(
        &mut self,
        steps: impl Iterator<Item = &'s Step<'p>>,
        v: Option<Vector>,
        point: bool,
        inward: bool,
    ) -> Option<Vector> {
        let mut v = v?;
        for step in steps {
            v = self.carry(step, v, point, inward).ok()?;
        }
        v.iter().any(|entry| entry.len() <= LONGEST_ROW).then_some(v)
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
const LONGEST_ROW: usize = 192;

/// Vectors with longer entries are not squared.
const LONGEST_SQUARED: usize = 24;

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
        let angles = angles.filter(|(_, angle)| matches!(angle, AngleData::Free(_)));
        let slides = (0..self.atoms.list.len()).map(|index| index as super::polynomial::Atom);
        // A slide that no equation contains stays open, and the problem unsolved.
        let absent = unknowns.free.iter().filter(|free| free.kind == JointKind::Prismatic).count();
        let mut slides: Vec<_> = slides.filter(|atom| self.atoms.slide(*atom).is_some()).collect();
        while slides.len() < absent {
            slides.push(super::polynomial::Atom::MAX);
        }
        super::reading::Open { angles: angles.map(|(index, _)| index).collect(), slides }
    }
}
