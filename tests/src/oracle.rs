//! Forward kinematics and Jacobian as the textbook writes them: one matrix a row, multiplied.

use crate::chain::{Chain, Convention, Row};
use crate::double_double::DoubleDouble;
use crate::matrix::Matrix;

/// A table and what it computes. Joint values are in rad and m, poses in m.
#[derive(Debug, Clone)]
pub struct Oracle {
    chain: Chain,
}

/// What the forward pass finds.
struct Forward {
    /// `[base]`, then the frame of every row.
    frames: Vec<Matrix>,
    /// Of every row, a frame whose z axis is the joint's.
    axes: Vec<Matrix>,
    tool: Matrix,
}

fn cross(a: [DoubleDouble; 3], b: [DoubleDouble; 3]) -> [DoubleDouble; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Rz(theta) Tz(d).
fn about_z(row: &Row, q: &[f64]) -> Matrix {
    let added = row.terms.iter().fold(DoubleDouble::ZERO, |sum, &(i, c)| sum + c * DoubleDouble::from(q[i]));
    let (theta, d) = if row.prismatic { (row.theta, row.d + added) } else { (row.theta + added, row.d) };
    Matrix::rotation(2, theta).times(&Matrix::translation([DoubleDouble::ZERO, DoubleDouble::ZERO, d]))
}

/// Tx(a) Rx(alpha) Ry(beta).
fn about_x(row: &Row) -> Matrix {
    Matrix::translation([row.a, DoubleDouble::ZERO, DoubleDouble::ZERO])
        .times(&Matrix::rotation(0, row.alpha))
        .times(&Matrix::rotation(1, row.beta))
}

impl Oracle {
    /// Reads a table.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(text: &str) -> Result<Self, String> {
        Chain::read(text).map(|chain| Self { chain })
    }

    /// The shipped table of that name.
    ///
    /// # Errors
    /// There is none, or it can't be read.
    pub fn shipped(name: &str) -> Result<Self, String> {
        Self::read(dh_robots::table(name).ok_or_else(|| format!("no table `{name}`"))?)
    }

    /// What was read.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// How many joint variables there are.
    pub fn dof(&self) -> usize {
        self.chain.dof()
    }

    fn forward(&self, q: &[f64]) -> Forward {
        assert_eq!(q.len(), self.dof());
        let mut frame = self.chain.base;
        let mut frames = vec![frame];
        let mut axes = Vec::new();
        for row in &self.chain.rows {
            match self.chain.convention {
                Convention::Standard => {
                    axes.push(frame);
                    frame = frame.times(&about_z(row, q)).times(&about_x(row));
                }
                Convention::Modified => {
                    frame = frame.times(&about_x(row));
                    axes.push(frame);
                    frame = frame.times(&about_z(row, q));
                }
            }
            frames.push(frame);
        }
        Forward { tool: frame.times(&self.chain.tool), frames, axes }
    }

    /// The tool frame in the base frame.
    pub fn fk(&self, q: &[f64]) -> [[f64; 4]; 4] {
        self.forward(q).tool.to_f64()
    }

    /// The frame of the last row in the base frame: without `[tool]`.
    pub fn fk_flange(&self, q: &[f64]) -> [[f64; 4]; 4] {
        let forward = self.forward(q);
        forward.frames[forward.frames.len() - 1].to_f64()
    }

    /// The frame that `[base]` places, then the frame of every row, held ones included.
    pub fn frames(&self, q: &[f64]) -> Vec<[[f64; 4]; 4]> {
        self.forward(q).frames.iter().map(Matrix::to_f64).collect()
    }

    /// Columns vx vy vz wx wy wz of the geometric Jacobian at the tool point, in base axes (per rad or m).
    pub fn jacobian(&self, q: &[f64]) -> Vec<[f64; 6]> {
        let forward = self.forward(q);
        let point = forward.tool.column(3);
        let mut columns = vec![[DoubleDouble::ZERO; 6]; self.dof()];
        for (row, axis) in self.chain.rows.iter().zip(&forward.axes) {
            let z = axis.column(2);
            let origin = axis.column(3);
            let arm = [0, 1, 2].map(|i| point[i] - origin[i]);
            let (v, w) = if row.prismatic { (z, [DoubleDouble::ZERO; 3]) } else { (cross(z, arm), z) };
            // A coupled row moves with every joint that it is coupled to.
            for &(joint, factor) in &row.terms {
                for (entry, value) in columns[joint].iter_mut().zip(v.into_iter().chain(w)) {
                    *entry = *entry + factor * value;
                }
            }
        }
        columns.into_iter().map(|column| column.map(DoubleDouble::to_f64)).collect()
    }

    /// A bound on the distance between base and tool point (m): the sum of all lengths that are not cancelled by
    /// construction. A scale for tolerances.
    pub fn reach(&self) -> f64 {
        let length = |xyz: [DoubleDouble; 3]| xyz.iter().map(|x| x.to_f64().powi(2)).sum::<f64>().sqrt();
        let rows = self.chain.rows.iter().map(|row| row.d.to_f64().abs() + row.a.to_f64().abs()).sum::<f64>();
        length(self.chain.base.column(3)) + rows + length(self.chain.tool.column(3))
    }
}
