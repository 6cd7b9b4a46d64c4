//! What the solvers are made from: the arm of a shipped table, as axes and points at q = 0.

use crate::poses::Matrix;
use dh_codegen::compile;
use dh_codegen::model::geometry::RelationKind;
use dh_codegen::model::{Geometry, JointKind, Model};
use dh_codegen::verify::Level;
use std::path::Path;

pub type Vector = [f64; 3];

/// An arm of six revolute joints as a product of turns about axes.
pub struct Axes {
    /// Directions at q = 0.
    pub h: [Vector; 6],
    /// A point of each axis at q = 0 (m); neighbours that meet share it as far as they can.
    pub points: [Vector; 6],
    /// The tool frame at q = 0.
    pub home: Matrix,
    /// turn[i] = sum of turns[i][k] * q[k]: couplings and directions.
    turns: [[f64; 6]; 6],
    /// Parallel axes 2, 3, ... point the same way; where that reverses one of the table, -1.
    signs: [f64; 6],
}

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Axes {
    pub fn of(table: &str, fk: impl Fn(&[f64; 6]) -> Matrix) -> Self {
        let text = dh_robots::table(table).map_or_else(
            || std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(table)).expect("a table"),
            str::to_owned,
        );
        let model = compile(&text, Level::Quick).output.expect("without mistakes").model;
        let geometry = model.geometry();
        assert!(
            geometry.axes.len() == 6 && geometry.axes.iter().all(|axis| axis.kind == JointKind::Revolute)
        );
        let turns = turns(&model);
        let mut h = [[0.0; 3]; 6];
        let mut signs = [1.0; 6];
        for i in 0..6 {
            h[i] = geometry.axes[i].direction;
            if i > 0 && dot(h[i], h[i - 1]) < -1.0 + 1e-9 {
                h[i] = h[i].map(|x| -x);
                signs[i] = -1.0;
            }
        }
        Self { h, points: points(&geometry), home: fk(&[0.0; 6]), turns, signs }
    }

    /// Joint values of the table from turns about the axes.
    pub fn joints(&self, turned: &[f64; 6]) -> [f64; 6] {
        let mut q = [0.0; 6];
        for i in 0..6 {
            let row = &self.turns[i];
            let others: f64 = (0..6).filter(|k| *k != i).map(|k| row[k] * q[k]).sum();
            q[i] = (self.signs[i] * turned[i] - others) / row[i];
        }
        q
    }
}

fn turns(model: &Model) -> [[f64; 6]; 6] {
    let mut turns = [[0.0; 6]; 6];
    for (row, turn) in model.rows.iter().zip(&mut turns) {
        for &(joint, factor) in &row.terms {
            turn[joint] += factor;
        }
    }
    turns
}

/// Points of the axes: the centre of a spherical joint, else where neighbours meet, from the tip.
fn points(geometry: &Geometry) -> [Vector; 6] {
    let mut points = [0; 6].map(|_: i32| None);
    let on = |axis: usize, along: f64| {
        let axis = geometry.axes[axis];
        let mut point = axis.point;
        for (x, z) in point.iter_mut().zip(axis.direction) {
            *x += along * z;
        }
        point
    };
    for axes in geometry.spherical_joints() {
        let centre = on(axes[0], geometry.normals[axes[0]].start);
        axes.iter().for_each(|axis| points[*axis] = Some(centre));
    }
    let meeting = geometry.exact().filter(|relation| relation.kind == RelationKind::Meet);
    for pair in meeting.map(|relation| &relation.axes).collect::<Vec<_>>().into_iter().rev() {
        if pair.iter().all(|axis| points[*axis].is_none()) {
            let point = on(pair[0], geometry.normals[pair[0]].start);
            pair.iter().for_each(|axis| points[*axis] = Some(point));
        }
    }
    let mut index = 0;
    points.map(|point| {
        index += 1;
        point.unwrap_or(geometry.axes[index - 1].point)
    })
}

/// a b^T of two rotations, rows.
pub fn times_transposed(a: &Matrix, b: &Matrix) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[j][k]).sum()))
}
