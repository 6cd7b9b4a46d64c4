//! The robot at a few joint positions, to tell a coefficient that is always zero from one that only may be.

use super::atoms::{AngleData, AtomData, Atoms, Source};
use super::polynomial::Polynomial;
use super::unknowns::Unknowns;
use crate::model::chain::Element;
use crate::model::{JointKind, Model, Target};
use crate::symbolic::expression::{Arena, Expr, Leaf, Node};
use std::collections::HashMap;

/// How many there are; a coefficient that vanishes at all of them is taken to be zero.
const SAMPLES: usize = 3;

/// One position of the robot.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    /// Values of the angles of the frequencies; where one is replaced by a root, of the root.
    pub angles: Vec<f64>,
    /// Values of the free variables.
    pub free: Vec<f64>,
    /// Values of the atoms, those that were made last missing.
    atoms: Vec<f64>,
    inputs: HashMap<String, f64>,
}

/// Positions that the constraints allow, with the targets that belong to them.
pub(super) fn draw(model: &Model, target: Target, unknowns: &Unknowns, atoms: &Atoms) -> Vec<Sample> {
    (0..SAMPLES)
        .map(|index| {
            // Any irrational steps will do; lengths stay within a fraction of the metre.
            let value = |k: usize| (0.37 + 0.61 * k as f64 + 1.1 * index as f64).sin() * 2.3 + 0.21;
            let free: Vec<f64> = (0..unknowns.free.len()).map(value).collect();
            let angles = atoms.angles.iter().map(|angle| match angle {
                AngleData::Free(at) => free.get(*at).copied().unwrap_or(0.0),
                AngleData::Constant { value, .. } => *value,
            });
            let inputs = inputs(model, target, unknowns, &free);
            Sample { angles: angles.collect(), inputs, atoms: Vec::new(), free: free.clone() }
        })
        .collect()
}

impl Sample {
    /// The polynomial's value here.
    pub(super) fn value(&mut self, arena: &Arena, atoms: &Atoms, polynomial: &Polynomial) -> f64 {
        self.extend(arena, atoms);
        self.sum(polynomial)
    }

    fn sum(&self, polynomial: &Polynomial) -> f64 {
        let term = |(key, number): (&super::polynomial::Key, crate::symbolic::number::Number)| {
            let monomial: f64 = key
                .monomial
                .iter()
                .map(|(atom, power)| {
                    let value = self.atoms.get(usize::from(*atom)).copied().unwrap_or(f64::NAN);
                    libm::pow(value, f64::from(*power))
                })
                .product();
            let angle: f64 = key.frequency.iter().zip(&self.angles).map(|(k, x)| f64::from(*k) * x).sum();
            number.value() * monomial * if key.sine { libm::sin(angle) } else { libm::cos(angle) }
        };
        polynomial.terms().map(term).sum()
    }

    fn extend(&mut self, arena: &Arena, atoms: &Atoms) {
        for AtomData { source, .. } in atoms.list.iter().skip(self.atoms.len()) {
            let value = match source {
                Source::Table(expr) | Source::Target(expr) => evaluate(arena, *expr, &self.inputs),
                Source::Slide(index) => self.free.get(*index).copied().unwrap_or(0.0),
                Source::Abbreviation(polynomial) => self.sum(polynomial),
            };
            self.atoms.push(value);
        }
    }
}

fn evaluate(arena: &Arena, x: Expr, inputs: &HashMap<String, f64>) -> f64 {
    match arena.node(x) {
        Node::Number(number) => number.value(),
        Node::Leaf(index) => match arena.leaf_at(index) {
            Some((_, Leaf::Parameter { value, .. })) => *value,
            Some((name, _)) => inputs.get(name).copied().unwrap_or(f64::NAN),
            None => f64::NAN,
        },
        Node::Sin(_) | Node::Cos(_) => f64::NAN,
        Node::Neg(a) => -evaluate(arena, a, inputs),
        Node::Add(a, b) => evaluate(arena, a, inputs) + evaluate(arena, b, inputs),
        Node::Mul(a, b) => evaluate(arena, a, inputs) * evaluate(arena, b, inputs),
    }
}

/// The target that belongs to a position, number by number.
fn inputs(model: &Model, target: Target, unknowns: &Unknowns, free: &[f64]) -> HashMap<String, f64> {
    let [x, y, z, p] = pose(model, unknowns, free);
    let yaw = libm::atan2(x[1], x[0]);
    let all = [
        ("px", p[0]),
        ("py", p[1]),
        ("pz", p[2]),
        ("zx", z[0]),
        ("zy", z[1]),
        ("zz", z[2]),
        ("cyaw", libm::cos(yaw)),
        ("syaw", libm::sin(yaw)),
        ("r11", x[0]),
        ("r21", x[1]),
        ("r31", x[2]),
        ("r12", y[0]),
        ("r22", y[1]),
        ("r32", y[2]),
        ("r13", z[0]),
        ("r23", z[1]),
        ("r33", z[2]),
    ];
    let wanted = target.input_names();
    all.into_iter().filter(|(name, _)| wanted.contains(name)).map(|(name, v)| (name.to_string(), v)).collect()
}

/// Axes and origin of the tool frame in the base frame.
fn pose(model: &Model, unknowns: &Unknowns, free: &[f64]) -> [[f64; 3]; 4] {
    let chain = model.chain();
    let mut columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    for (index, link) in chain.links.iter().enumerate().rev() {
        for element in link.elements.iter().rev() {
            columns = apply(element, columns);
        }
        let Some(joint) = index.checked_sub(1).and_then(|index| chain.joints.get(index)) else { continue };
        let Some(form) = unknowns.rows.get(joint.row) else { continue };
        let sum: f64 = form.coefficients.iter().zip(free).map(|(k, v)| k * v).sum();
        let value = sum + form.offset.value();
        match joint.kind {
            JointKind::Revolute => {
                columns = columns.map(|v| turned(v, 2, libm::sin(value), libm::cos(value)));
            }
            JointKind::Prismatic => columns[3][2] += value,
        }
    }
    columns
}

fn apply(element: &Element, mut columns: [[f64; 3]; 4]) -> [[f64; 3]; 4] {
    match element {
        Element::Translate { axis, value, .. } => {
            if let Some(entry) = columns[3].get_mut(*axis) {
                *entry += value;
            }
            columns
        }
        Element::Rotate { axis, angle, .. } => {
            columns.map(|v| turned(v, *axis, libm::sin(angle.value), libm::cos(angle.value)))
        }
        Element::Matrix { rows, .. } => {
            columns.map(|v| rows.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum()))
        }
    }
}

fn turned([x, y, z]: [f64; 3], axis: usize, sin: f64, cos: f64) -> [f64; 3] {
    match axis {
        0 => [x, cos * y - sin * z, sin * y + cos * z],
        1 => [cos * x + sin * z, y, cos * z - sin * x],
        _ => [cos * x - sin * y, sin * x + cos * y, z],
    }
}
