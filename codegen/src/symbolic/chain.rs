//! The robot as groups of parallel joints with fixed transforms between them, its numbers as expressions.

use super::angle::{AngleForm, Turn};
use super::expression::{Arena, Expr, Leaf};
use super::transform::{self, Rigid, Vec3};
use crate::model::chain::{Element, Link};
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
    /// From this joint's origin to the next one of the group, its own slide included.
    pub offset: Vec3,
}

/// Writes the robot's links as expressions. `with_tool` false leaves `[tool]` out.
pub fn build(arena: &mut Arena, model: &Model, with_tool: bool) -> Chain {
    let mut groups: Vec<Group> = Vec::new();
    let links = model.links(with_tool);
    let mut before = links.first().map_or_else(|| transform::identity(arena), |link| rigid(arena, link));
    let mut run = Run::start();
    let mut continues = false;
    for (&row, link) in model.moving_rows().iter().zip(links.iter().skip(1)) {
        if !continues {
            groups.push(Group { before, joints: Vec::new() });
            run = Run::start();
        }
        let mut joint = run.joint(arena, model, row);
        let axial = axial(link);
        match axial {
            Some(step) => {
                let link = rigid(arena, link);
                let offset = if joint.flipped { transform::flip(arena, link.translation) } else { link.translation };
                joint.offset = transform::add(arena, joint.offset, offset);
                run.pass(&step);
                before = transform::identity(arena);
            }
            None => before = rigid(arena, link),
        }
        continues = axial.is_some();
        if let Some(group) = groups.last_mut() {
            group.joints.push(joint);
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

    fn joint(&mut self, arena: &mut Arena, model: &Model, row: usize) -> Joint {
        let mut offset = transform::zero_vector(arena);
        let Some(data) = model.rows.get(row) else {
            return self.here(row, JointKind::Revolute, offset);
        };
        match data.kind {
            JointKind::Revolute => {
                let theta = AngleForm { terms: sorted(&data.terms), turn: Turn::new(data.theta) };
                self.turn = self.turn.add(&theta, if self.flipped { -1.0 } else { 1.0 });
                self.rows.push((row, !self.flipped));
            }
            JointKind::Prismatic => {
                let [_, _, z] = &mut offset;
                let leaf = Leaf::Slide { terms: sorted(&data.terms), constant: data.d };
                let slide = arena.leaf(&format!("d{}", row + 1), leaf);
                *z = if self.flipped { arena.neg(slide) } else { slide };
            }
        }
        self.here(row, data.kind, offset)
    }

    fn here(&self, row: usize, kind: JointKind, offset: Vec3) -> Joint {
        Joint { row, kind, turn: self.turn.clone(), suffix: suffix(&self.rows), flipped: self.flipped, offset }
    }

    fn pass(&mut self, step: &Axial) {
        let turn = if self.flipped { step.turn.neg() } else { step.turn };
        self.turn.turn = self.turn.turn.add(turn);
        self.flipped ^= step.flips;
    }
}

/// Name of a sum of joint angles: `234`, `2m3` for theta2 - theta3, `9_10` where numbers have two digits.
pub fn suffix(rows: &[(usize, bool)]) -> String {
    let wide = rows.iter().any(|(row, _)| *row >= 9);
    let mut text = String::new();
    for (row, positive) in rows {
        if wide && !text.is_empty() && *positive {
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

fn axial(link: &Link) -> Option<Axial> {
    let mut found = Axial { turn: Turn::ZERO, flips: false };
    for element in &link.elements {
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
                found.turn = found.turn.add(if found.flips { turn.neg() } else { turn });
                found.flips ^= *axis != 2;
            }
        }
    }
    Some(found)
}

fn rigid(arena: &mut Arena, link: &Link) -> Rigid {
    let mut frame = transform::identity(arena);
    for element in &link.elements {
        let step = element_rigid(arena, element);
        frame = transform::compose(arena, &frame, &step);
    }
    frame
}

fn element_rigid(arena: &mut Arena, element: &Element) -> Rigid {
    let mut step = transform::identity(arena);
    match element {
        Element::Translate { axis, value, name, note } => {
            let length = parameter(arena, name, *value, note);
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
                    *entry = parameter(arena, &format!("{name}{}{}", i + 1, j + 1), *number, note);
                }
            }
        }
    }
    step
}

/// Lengths are parameters with names; a negative one is the negative of a positive parameter nowhere, so that a
/// printed `d4` always has the table's sign.
fn parameter(arena: &mut Arena, name: &str, value: f64, note: &str) -> Expr {
    arena.parameter(name, value, note)
}
