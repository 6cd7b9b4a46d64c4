//! The robot as groups of parallel joints with fixed transforms between them, its numbers as expressions.

use super::angle::{AngleForm, Turn};
use super::expression::{Arena, Expr, Leaf};
use super::transform::{self, Rigid, Vec3};
use crate::model::chain::{ChainJoint, Element};
use crate::model::{JointKind, Model};

/// All joints of a robot, base to tip.
#[derive(Debug, Clone)]
pub struct Chain {
    /// Maximal runs of joints with parallel axes.
    pub groups: Vec<Group>,
    /// From behind the last joint to the tool.
    pub tip: Rigid,
}

/// Joints with parallel axes, one behind the other.
#[derive(Debug, Clone)]
pub struct Group {
    /// The fixed transform before the first joint.
    pub before: Rigid,
    /// Base to tip.
    pub joints: Vec<Joint>,
}

/// A joint inside its group. Vectors are in the axes of the frame before the group, turned back by `turn`.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Row of the table (0-based).
    pub row: usize,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Sum of all turns up to and including this joint.
    pub turn: AngleForm,
    /// Name of that sum: `234`.
    pub suffix: String,
    /// Whether the axis points against the axis of the group, and with it the frame behind the joint.
    pub flipped: bool,
    /// A prismatic joint's own slide; zero for a revolute one.
    pub slide: Vec3,
    /// From this joint's origin to the next one of the group, its own slide included.
    pub offset: Vec3,
}

/// The variable of a row: theta, or d.
#[derive(Debug, Clone)]
pub enum Variable {
    /// theta
    Angle(AngleForm),
    /// d
    Slide(Expr),
}

/// Writes the robot's links as expressions; `with_tool` false leaves `[tool]` out.
pub fn build(arena: &mut Arena, model: &Model, with_tool: bool) -> Chain {
    of_variables(arena, model, with_tool, |arena, row| {
        let data = model.rows.get(row)?;
        Some(match data.kind {
            JointKind::Revolute => {
                Variable::Angle(AngleForm { terms: sorted(&data.terms), turn: Turn::new(data.theta) })
            }
            JointKind::Prismatic => {
                let leaf = Leaf::Slide { terms: sorted(&data.terms), constant: data.d };
                Variable::Slide(arena.leaf(&format!("d{}", row + 1), leaf))
            }
        })
    })
}

/// The same with the variables of rows in other terms than the joint variables.
pub fn of_variables(
    arena: &mut Arena,
    model: &Model,
    with_tool: bool,
    mut variable: impl FnMut(&mut Arena, usize) -> Option<Variable>,
) -> Chain {
    let plain = model.chain();
    let last = plain.joints.len();
    let mut before = rigid(arena, plain.links.first().map_or(&[][..], |link| &link.elements));
    let mut groups: Vec<Group> = Vec::new();
    let mut run = Run::start();
    let mut continues = false;
    for (index, joint) in plain.joints.iter().enumerate() {
        if !continues {
            groups.push(Group { before, joints: Vec::new() });
            run = Run::start();
        }
        let variable = variable(arena, joint.row);
        let mut member = run.joint(arena, joint, variable);
        let link = plain.links.get(index + 1);
        let elements = link.map_or(&[][..], |link| match link.elements.get(..link.flange) {
            Some(flange) if !with_tool => flange,
            _ => &link.elements,
        });
        before = rigid(arena, elements);
        let axial = if index + 1 < last { axial(elements) } else { None };
        if let Some(step) = &axial {
            let offset = before.translation;
            let offset = if member.flipped { transform::flip(arena, offset) } else { offset };
            member.offset = transform::add(arena, member.offset, offset);
            run.pass(step);
        }
        continues = axial.is_some();
        if let Some(group) = groups.last_mut() {
            group.joints.push(member);
        }
    }
    Chain { groups, tip: before }
}

/// The running turn inside a group.
struct Run {
    turn: AngleForm,
    flipped: bool,
    rows: Vec<(usize, bool)>,
}

impl Run {
    fn start() -> Self {
        Self { turn: AngleForm::ZERO, flipped: false, rows: Vec::new() }
    }

    fn joint(&mut self, arena: &mut Arena, joint: &ChainJoint, variable: Option<Variable>) -> Joint {
        let mut offset = transform::zero_vector(arena);
        match variable {
            Some(Variable::Angle(theta)) => {
                self.turn = self.turn.plus(&theta, if self.flipped { -1.0 } else { 1.0 });
                self.rows.push((joint.row, !self.flipped));
            }
            Some(Variable::Slide(slide)) => {
                let [_, _, z] = &mut offset;
                *z = if self.flipped { arena.neg(slide) } else { slide };
            }
            None => {}
        }
        self.here(joint.row, joint.kind, offset)
    }

    fn here(&self, row: usize, kind: JointKind, offset: Vec3) -> Joint {
        Joint {
            row,
            kind,
            turn: self.turn.clone(),
            suffix: suffix(&self.rows),
            flipped: self.flipped,
            slide: offset,
            offset,
        }
    }

    fn pass(&mut self, step: &Axial) {
        let turn = if self.flipped { -step.turn } else { step.turn };
        self.turn.turn = self.turn.turn + turn;
        self.flipped ^= step.flips;
    }
}

/// Name of a sum of joint angles: `234`, `2m3` for theta2 - theta3; `_9_10` and `_12` where numbers have two digits,
/// so that theta12 is not theta1 + theta2.
pub fn suffix(rows: &[(usize, bool)]) -> String {
    let wide = rows.iter().any(|(row, _)| *row >= 9);
    let mut text = String::new();
    for (row, positive) in rows {
        if wide && *positive {
            text.push('_');
        }
        if !positive {
            text.push('m');
        }
        text.push_str(&(row + 1).to_string());
    }
    text
}

fn sorted(terms: &[(usize, f64)]) -> Vec<(usize, f64)> {
    let mut terms: Vec<_> = terms.iter().copied().filter(|term| term.1 != 0.0).collect();
    terms.sort_by_key(|term| term.0);
    terms
}

/// A link whose two axes are parallel: Rz(turn), then Rx(pi) where it flips.
struct Axial {
    turn: Turn,
    flips: bool,
}

fn axial(elements: &[Element]) -> Option<Axial> {
    let mut found = Axial { turn: Turn::ZERO, flips: false };
    for element in elements {
        match element {
            Element::Translate { .. } => {}
            Element::Matrix { .. } => return None,
            Element::Rotate { axis, angle, .. } => {
                let turn = Turn::new(*angle);
                let half = turn.rest == 0.0 && turn.fifteenths.rem_euclid(24) == 12;
                let turn = match axis {
                    2 => turn,
                    _ if turn.rest == 0.0 && turn.fifteenths.rem_euclid(24) == 0 => continue,
                    0 if half => Turn::ZERO,
                    1 if half => turn, // Ry(pi) = Rz(pi) Rx(pi)
                    _ => return None,
                };
                found.turn = found.turn + if found.flips { -turn } else { turn };
                found.flips ^= *axis != 2;
            }
        }
    }
    Some(found)
}

/// The product of elementary transforms.
pub fn rigid(arena: &mut Arena, elements: &[Element]) -> Rigid {
    let mut frame = transform::identity(arena);
    for element in elements {
        let step = element_rigid(arena, element);
        frame = transform::compose(arena, &frame, &step);
    }
    frame
}

fn element_rigid(arena: &mut Arena, element: &Element) -> Rigid {
    let mut step = transform::identity(arena);
    match element {
        Element::Translate { axis, value, name, note } => {
            let length = arena.parameter(name, *value, 1, note);
            if let Some(entry) = step.translation.get_mut(*axis) {
                *entry = length;
            }
        }
        Element::Rotate { axis, angle, name, .. } => {
            let form = AngleForm { terms: Vec::new(), turn: Turn::new(*angle) };
            let sin_cos = arena.sin_cos(name, &form);
            step.rotation = transform::rotation_about(arena, *axis, sin_cos);
        }
        Element::Matrix { rows, name, note } => {
            for (i, (row, numbers)) in step.rotation.iter_mut().zip(rows).enumerate() {
                for (j, (entry, number)) in row.iter_mut().zip(numbers).enumerate() {
                    *entry = arena.parameter(&format!("{name}{}{}", i + 1, j + 1), *number, 0, note);
                }
            }
        }
    }
    step
}
