//! A robot's chain in polynomials: vectors carried through joints and links, outward and inward.

use super::atoms::{AngleData, Atoms, Source};
use super::polynomial::{Overflow, Polynomial};
use super::unknowns::{Form, Free, Unknowns};
use crate::model::chain::Element;
use crate::model::{Angle, Chain, JointKind, Model};
use crate::symbolic::angle::Turn;
use crate::symbolic::expression::{Arena, Expr, Node};
use crate::symbolic::number::Number;

/// Three polynomials.
pub(super) type Vector = [Polynomial; 3];

/// One step along the chain.
pub(super) enum Step<'a> {
    Fixed(&'a Element),
    /// Sine and cosine of theta.
    Turn(Polynomial, Polynomial),
    /// d
    Slide(Polynomial),
    /// By a known vector.
    Shift(Box<Vector>),
    /// By a known rotation, its rows.
    Rotation(Box<[Vector; 3]>),
}

/// A joint (the base has none) and the link behind it.
pub(super) type Stretch<'a> = (Option<Step<'a>>, Vec<Step<'a>>);

/// Writes polynomials for one robot.
pub(super) struct Walker<'a> {
    pub arena: &'a mut Arena,
    pub model: &'a Model,
    pub unknowns: &'a Unknowns,
    pub atoms: Atoms,
    /// Angles that are replaced by roots: see [`Polynomial::substitute`].
    pub roots: Vec<(usize, Vec<i16>)>,
}

impl Walker<'_> {
    /// Free angles first, then every constant that is no multiple of 15 degrees.
    pub(super) fn angles(&mut self, plain: &Chain) {
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

    pub(super) fn constant_angle(&mut self, name: &str, value: f64) {
        let known = |angle: &AngleData| matches!(angle, AngleData::Constant { value: v, .. } if v.abs() == value.abs());
        if !self.atoms.angles.iter().any(known) {
            self.atoms.angles.push(AngleData::Constant { name: name.to_string(), value });
        }
    }

    pub(super) fn size(&self) -> usize {
        self.atoms.angles.len()
    }

    /// (sine, cosine) of frequency . angles + fifteenths * 15 degrees + rest.
    pub(super) fn sin_cos(
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

    pub(super) fn form_sin_cos(&self, form: &Form) -> Result<(Polynomial, Polynomial), Overflow> {
        let (fifteenths, rest) = form.offset.split();
        let frequency = self.atoms.angles.iter().map(|angle| match angle {
            AngleData::Free(index) => form.coefficients.get(*index).map_or(0, |x| x.round() as i16),
            AngleData::Constant { .. } => 0,
        });
        let replaced = |mut frequency: Vec<i16>, (at, coefficients): &(usize, Vec<i16>)| {
            let multiple = frequency.get_mut(*at).map_or(0, std::mem::take);
            frequency.iter_mut().zip(coefficients).for_each(|(k, coefficient)| *k += multiple * coefficient);
            frequency
        };
        let frequency = self.roots.iter().fold(frequency.collect(), replaced);
        self.sin_cos(frequency, fifteenths, rest)
    }

    pub(super) fn parameter(&mut self, name: &str, value: f64, note: &str, dimension: u8) -> Polynomial {
        let expr = self.arena.parameter(name, value, dimension, note);
        self.atoms.polynomial(name, dimension, Source::Table(expr))
    }

    pub(super) fn known(&mut self, name: &str, expr: Expr, dimension: u8) -> Result<Polynomial, Overflow> {
        if self.arena.is_zero(expr) {
            return Ok(Polynomial::zero());
        }
        let (positive, bare) = self.arena.split_sign(expr);
        let leaf = match self.arena.node(bare) {
            Node::Leaf(index) => self.arena.leaf_at(index).map(|(name, _)| name.to_string()),
            _ => None,
        };
        self.arena.label(bare, name);
        let atom = self.atoms.polynomial(leaf.as_deref().unwrap_or(name), dimension, Source::Target(bare));
        atom.scaled(Number::integer(if positive { 1 } else { -1 }))
    }

    /// A vector of the tool frame in the base frame.
    pub(super) fn tip_in_base(
        &mut self,
        plain: &Chain,
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
    pub(super) fn steps<'p>(&mut self, plain: &'p Chain) -> Result<Vec<Stretch<'p>>, Overflow> {
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

    pub(super) fn joint<'p>(&mut self, row: usize, kind: JointKind) -> Result<Step<'p>, Overflow> {
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
    pub(super) fn carry(
        &mut self,
        step: &Step<'_>,
        v: Vector,
        point: bool,
        inward: bool,
    ) -> Result<Vector, Overflow> {
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
            Step::Fixed(Element::Translate { .. }) | Step::Shift(_) if !point => Ok(v),
            Step::Shift(by) => by.iter().enumerate().try_fold(v, |v, (axis, by)| shift(v, axis, by)),
            Step::Rotation(rows) => turned_by(rows, &v, inward),
            Step::Fixed(Element::Translate { axis, value, name, note }) => {
                let by = self.parameter(name, *value, note, 1);
                shift(v, *axis, &by)
            }
            Step::Fixed(Element::Rotate { axis, angle, .. }) => {
                let turn_by = Turn::new(*angle);
                let (sin, cos) = self.sin_cos(vec![0; self.size()], turn_by.fifteenths, turn_by.rest)?;
                turn(v, *axis, &sin, &cos, inward)
            }
            Step::Fixed(Element::Matrix { rows, name, note }) => self.matrix(&v, rows, name, note, inward),
        }
    }

    pub(super) fn matrix(
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
                    out.add_product(&entry, v, Number::ONE)?;
                }
            }
        }
        Ok(out)
    }
}

/// By the matrix with these rows, or by its transpose.
fn turned_by(rows: &[Vector; 3], v: &Vector, transposed: bool) -> Result<Vector, Overflow> {
    let mut out = [Polynomial::zero(), Polynomial::zero(), Polynomial::zero()];
    for (i, row) in rows.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let (to, from) = if transposed { (j, i) } else { (i, j) };
            if let (Some(out), Some(v)) = (out.get_mut(to), v.get(from)) {
                out.add_product(entry, v, Number::ONE)?;
            }
        }
    }
    Ok(out)
}

/// Turned about a coordinate axis, or back.
fn turn(v: Vector, axis: usize, sin: &Polynomial, cos: &Polynomial, back: bool) -> Result<Vector, Overflow> {
    let (plus, minus) = (Number::ONE, Number::integer(-1));
    let (along, against) = if back { (minus, plus) } else { (plus, minus) };
    let rotate = |a: &Polynomial, b: &Polynomial| -> Result<(Polynomial, Polynomial), Overflow> {
        let (mut first, mut second) = (cos.mul(a)?, cos.mul(b)?);
        first.add_product(sin, b, against)?;
        second.add_product(sin, a, along)?;
        Ok((first, second))
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
