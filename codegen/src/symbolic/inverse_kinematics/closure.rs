//! The equations of a problem: what is prescribed, written in every frame of the chain.
//!
//! A prescribed point (or direction) is carried from the base to the frame before each joint by the inverses of the
//! joints passed, and the same point is carried from the tip to that frame by the joints that follow. Both sides are
//! equal, row by row, whatever frame they are written in; which frame is simplest differs from arm to arm.

use super::atoms::{AngleData, Atoms, Source};
use super::polynomial::{Overflow, Polynomial};
use super::unknowns::{Form, Free, Unknowns};
use crate::model::chain::Element;
use crate::model::{Angle, JointKind, Model, Target};
use crate::symbolic::expression::{Arena, Expr, Leaf};
use crate::symbolic::number::Number;
use crate::symbolic::{chain, transform};

/// Three polynomials.
pub(super) type Vector = [Polynomial; 3];

/// polynomial = 0, and where it comes from.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    pub polynomial: Polynomial,
    /// Frame and tracked quantity; rows of one group are coordinates of one vector.
    pub group: usize,
    /// "row 2 of the position in frame 1"
    pub origin: String,
    /// What its known part is called: `y1`.
    pub name: String,
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

/// One step along the chain.
enum Step<'a> {
    Fixed(&'a Element),
    /// Sine and cosine of theta.
    Turn(Polynomial, Polynomial),
    /// d
    Slide(Polynomial),
}

/// A joint (the base has none) and the link behind it.
type Stretch<'a> = (Option<Step<'a>>, Vec<Step<'a>>);

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
) -> Result<Closure, Trouble> {
    let plain = model.chain();
    let mut builder = Builder { arena, model, unknowns, atoms: Atoms::default() };
    builder.angles(&plain);
    let inputs: Vec<Expr> =
        target.input_names().iter().map(|name| builder.arena.leaf(name, Leaf::Known)).collect();
    let mut equations = Vec::new();
    let mut group = 0;
    for tracked in builder.tracked(&plain, target, &inputs)? {
        builder.track(&plain, &tracked, &mut group, &mut equations)?;
    }
    if let Some((cos, sin)) = yaw_inputs(target, &inputs) {
        builder.yaw(&plain, cos, sin, &mut group, &mut equations)?;
    }
    Ok(Closure { atoms: builder.atoms, equations })
}

fn yaw_inputs(target: Target, inputs: &[Expr]) -> Option<(Expr, Expr)> {
    match (target, inputs) {
        (Target::PositionYaw | Target::XyYaw, [.., cos, sin]) => Some((*cos, *sin)),
        _ => None,
    }
}

struct Builder<'a> {
    arena: &'a mut Arena,
    model: &'a Model,
    unknowns: &'a Unknowns,
    atoms: Atoms,
}

impl Builder<'_> {
    /// Free angles first, then every constant that is no multiple of 15 degrees.
    fn angles(&mut self, plain: &crate::model::Chain) {
        let free = self.unknowns.free.iter().enumerate();
        let angles = free.filter(|(_, free)| free.kind == JointKind::Revolute);
        self.atoms.angles.extend(angles.map(|(index, _)| AngleData::Free(index)));
        for (row, form) in self.unknowns.rows.iter().enumerate() {
            let revolute = self.model.rows.get(row).is_some_and(|row| row.kind == JointKind::Revolute);
            if revolute && form.offset.split().1 != 0.0 {
                self.constant_angle(&format!("o{}", row + 1), form.offset.split().1);
            }
        }
        for element in plain.links.iter().flat_map(|link| &link.elements) {
            if let Element::Rotate { angle: Angle { value, fifteenths: None }, name, .. } = element {
                self.constant_angle(name, *value);
            }
        }
    }

    fn constant_angle(&mut self, name: &str, value: f64) {
        let known = |angle: &AngleData| matches!(angle, AngleData::Constant { value: v, .. } if v.abs() == value.abs());
        if !self.atoms.angles.iter().any(known) {
            self.atoms.angles.push(AngleData::Constant { name: name.to_string(), value });
        }
    }

    fn size(&self) -> usize {
        self.atoms.angles.len()
    }

    /// (sine, cosine) of frequency . angles + fifteenths * 15 degrees + rest.
    fn sin_cos(
        &self,
        mut frequency: Vec<i16>,
        fifteenths: i32,
        rest: f64,
    ) -> Result<(Polynomial, Polynomial), Overflow> {
        if rest != 0.0 {
            for (entry, angle) in frequency.iter_mut().zip(&self.atoms.angles) {
                if let AngleData::Constant { value, .. } = angle
                    && value.abs() == rest.abs()
                {
                    *entry += if *value == rest { 1 } else { -1 };
                }
            }
        }
        let (sin, cos) = (Polynomial::trig(&frequency, true), Polynomial::trig(&frequency, false));
        let (s, c) = (Number::sin(fifteenths), Number::cos(fifteenths));
        Ok((sin.scaled(c)?.add_scaled(&cos, s)?, cos.scaled(c)?.add_scaled(&sin, -s)?))
    }

    fn form_sin_cos(&self, form: &Form) -> Result<(Polynomial, Polynomial), Overflow> {
        let (fifteenths, rest) = form.offset.split();
        let frequency = self.atoms.angles.iter().map(|angle| match angle {
            AngleData::Free(index) => form.coefficients.get(*index).map_or(0, |x| x.round() as i16),
            AngleData::Constant { .. } => 0,
        });
        self.sin_cos(frequency.collect(), fifteenths, rest)
    }

    fn parameter(&mut self, name: &str, value: f64, note: &str, dimension: u8) -> Polynomial {
        let expr = self.arena.parameter(name, value, dimension, note);
        self.atoms.polynomial(name, dimension, Source::Table(expr))
    }

    fn known(&mut self, name: &str, expr: Expr, dimension: u8) -> Result<Polynomial, Overflow> {
        if self.arena.is_zero(expr) {
            return Ok(Polynomial::zero());
        }
        let (positive, bare) = self.arena.split_sign(expr);
        let leaf = match self.arena.node(bare) {
            crate::symbolic::expression::Node::Leaf(index) => {
                self.arena.leaf_at(index).map(|(name, _)| name.to_string())
            }
            _ => None,
        };
        self.arena.name(bare, name);
        let atom = self.atoms.polynomial(leaf.as_deref().unwrap_or(name), dimension, Source::Target(bare));
        atom.scaled(Number::integer(if positive { 1 } else { -1 }))
    }

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
                // R' = base^T R tool^T, so that neither mixes rows or columns.
                let tool = plain.links.last().map_or(&[][..], |link| &link.elements);
                let tool = if plain.links.len() > 1 {
                    chain::rigid(self.arena, tool)
                } else {
                    transform::identity(self.arena)
                };
                let whole = [[*a, *b, *c], [*d, *e, *f], [*g, *h, *i]];
                let turned = transform::product(self.arena, &whole, &transform::transpose(&tool.rotation));
                let frame = chain::rigid(self.arena, base);
                let mut found = Vec::new();
                for (index, column) in transform::transpose(&turned).into_iter().enumerate() {
                    let number = index + 1;
                    let names = [format!("r1{number}"), format!("r2{number}"), format!("r3{number}")];
                    let [x, y, z] = &names;
                    let target = self.behind_base(&frame.rotation, column, [x, y, z], 0)?;
                    let mut tip = [zero.clone(), zero.clone(), zero.clone()];
                    if let Some(entry) = tip.get_mut(index) {
                        *entry = one.clone();
                    }
                    let what = ["x axis", "y axis", "z axis"].get(index).copied().unwrap_or("axis");
                    let letter = ["x", "y", "z"].get(index).copied().unwrap_or("");
                    found.push(Tracked {
                        what,
                        letter,
                        point: false,
                        target,
                        after_base: true,
                        tip,
                        whole: false,
                    });
                }
                Ok(found)
            }
            _ => Err(Trouble::Target),
        }
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
        for (index, (joint, link)) in steps.iter().enumerate() {
            if let Some(joint) = joint {
                let frame = plain.joints.get(index.wrapping_sub(1)).map_or(0, |joint| joint.row);
                if let Some((_, inner)) = from_tip.iter().find(|(at, _)| *at == index) {
                    for (row, (left, right)) in outer.iter().zip(inner).enumerate() {
                        equations.push(Equation {
                            polynomial: left.sub(right)?,
                            group: *group,
                            origin: format!("row {} of the {} in frame {frame}", row + 1, tracked.what),
                            name: tracked.row_name(row, frame),
                        });
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
                origin: what.to_string(),
                name: "w".to_string(),
            });
        }
        *group += 1;
        Ok(())
    }

    /// A vector of the tool frame in the base frame.
    fn tip_in_base(
        &mut self,
        plain: &crate::model::Chain,
        tip: Vector,
        point: bool,
    ) -> Result<Vector, Overflow> {
        let steps = self.steps(plain)?;
        let mut inner = tip;
        for (joint, link) in steps.iter().rev() {
            for step in link.iter().rev() {
                inner = self.carry(step, inner, point, false)?;
            }
            if let Some(joint) = joint {
                inner = self.carry(joint, inner, point, false)?;
            }
        }
        Ok(inner)
    }

    /// Joints with the links behind them; the base's link comes first, without a joint.
    fn steps<'p>(&mut self, plain: &'p crate::model::Chain) -> Result<Vec<Stretch<'p>>, Overflow> {
        let mut steps = Vec::new();
        for (index, link) in plain.links.iter().enumerate() {
            let joint = match index.checked_sub(1).and_then(|index| plain.joints.get(index)) {
                Some(joint) => Some(self.joint(joint.row, joint.kind)?),
                None => None,
            };
            steps.push((joint, link.elements.iter().map(Step::Fixed).collect()));
        }
        Ok(steps)
    }

    fn joint<'p>(&mut self, row: usize, kind: JointKind) -> Result<Step<'p>, Overflow> {
        let Some(form) = self.unknowns.rows.get(row).cloned() else {
            return Ok(Step::Slide(Polynomial::zero()));
        };
        if kind == JointKind::Revolute {
            let (sin, cos) = self.form_sin_cos(&form)?;
            return Ok(Step::Turn(sin, cos));
        }
        let free: Vec<Free> = self.unknowns.free.clone();
        let mut slide = match form.offset.value() {
            0.0 => Polynomial::zero(),
            constant => {
                self.parameter(&format!("o{}", row + 1), constant, "constant part of a held slide", 1)
            }
        };
        for (index, (coefficient, free)) in form.coefficients.iter().zip(free).enumerate() {
            if *coefficient != 0.0 {
                let name = format!("d{}", free.row + 1);
                let atom = self.atoms.polynomial(&name, 1, Source::Slide(index));
                let factor = if let Some(number) = Number::from_f64(*coefficient) {
                    atom.scaled(number)?
                } else {
                    let name = format!("k{}_{}", row + 1, free.row + 1);
                    atom.mul(&self.parameter(&name, *coefficient, "coupling", 0))?
                };
                slide = slide.add(&factor)?;
            }
        }
        Ok(Step::Slide(slide))
    }

    /// A vector through a step, from its inside to its outside, or (`inward`) the other way.
    fn carry(&mut self, step: &Step<'_>, v: Vector, point: bool, inward: bool) -> Result<Vector, Overflow> {
        let shift = |v: Vector, axis: usize, by: &Polynomial| -> Result<Vector, Overflow> {
            let mut v = v;
            if let Some(entry) = v.get_mut(axis) {
                *entry = if inward { entry.sub(by)? } else { entry.add(by)? };
            }
            Ok(v)
        };
        match step {
            Step::Slide(by) if point => shift(v, 2, by),
            Step::Slide(_) => Ok(v),
            Step::Turn(sin, cos) => turn(v, 2, sin, cos, inward),
            Step::Fixed(Element::Translate { .. }) if !point => Ok(v),
            Step::Fixed(Element::Translate { axis, value, name, note }) => {
                let by = self.parameter(name, *value, note, 1);
                shift(v, *axis, &by)
            }
            Step::Fixed(Element::Rotate { axis, angle, .. }) => {
                let turn_by = crate::symbolic::angle::Turn::new(*angle);
                let (sin, cos) = self.sin_cos(vec![0; self.size()], turn_by.fifteenths, turn_by.rest)?;
                turn(v, *axis, &sin, &cos, inward)
            }
            Step::Fixed(Element::Matrix { rows, name, note }) => self.matrix(&v, rows, name, note, inward),
        }
    }

    fn matrix(
        &mut self,
        v: &Vector,
        rows: &[[f64; 3]; 3],
        name: &str,
        note: &str,
        inward: bool,
    ) -> Result<Vector, Overflow> {
        let mut out = [Polynomial::zero(), Polynomial::zero(), Polynomial::zero()];
        for (i, row) in rows.iter().enumerate() {
            for (j, number) in row.iter().enumerate() {
                let (to, from) = if inward { (j, i) } else { (i, j) };
                if *number == 0.0 {
                    continue;
                }
                let entry = self.parameter(&format!("{name}{}{}", i + 1, j + 1), *number, note, 0);
                if let (Some(out), Some(v)) = (out.get_mut(to), v.get(from)) {
                    *out = out.add(&entry.mul(v)?)?;
                }
            }
        }
        Ok(out)
    }
}

/// Turned about a coordinate axis, or back.
fn turn(v: Vector, axis: usize, sin: &Polynomial, cos: &Polynomial, back: bool) -> Result<Vector, Overflow> {
    let sin = if back { sin.scaled(Number::integer(-1))? } else { sin.clone() };
    let rotate = |a: &Polynomial, b: &Polynomial| -> Result<(Polynomial, Polynomial), Overflow> {
        Ok((cos.mul(a)?.sub(&sin.mul(b)?)?, sin.mul(a)?.add(&cos.mul(b)?)?))
    };
    let [x, y, z] = v;
    Ok(match axis {
        0 => {
            let (y, z) = rotate(&y, &z)?;
            [x, y, z]
        }
        1 => {
            let (z, x) = rotate(&z, &x)?;
            [x, y, z]
        }
        _ => {
            let (x, y) = rotate(&x, &y)?;
            [x, y, z]
        }
    })
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
