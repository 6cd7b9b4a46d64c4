//! What the benchmarks compare with: forward kinematics as people write it, one 4x4 matrix a joint with nalgebra.
//!
//! The rows come from the shipped tables through the reader of the tests, so that both sides have the same numbers. Only
//! arms of revolute joints without couplings are read; the arms that are compared are of that kind.

use dh_runtime::nalgebra::Matrix4;
use dh_tests::chain::{Chain, Convention};

/// A row of the table, as a program holds it (m, rad).
#[derive(Debug, Clone, Copy)]
struct Row {
    a: f64,
    alpha: f64,
    d: f64,
    offset: f64,
    direction: f64,
}

/// An arm whose matrices are built anew at every call.
#[derive(Debug, Clone)]
pub struct MatrixArm {
    modified: bool,
    rows: Vec<Row>,
    /// Sine and cosine of every alpha, for [`MatrixArm::fk_precomputed`].
    twists: Vec<(f64, f64)>,
    base: Matrix4<f64>,
    tool: Matrix4<f64>,
}

/// The matrix of a row: the convention's product of four, multiplied out, as textbooks print it.
fn row_matrix(modified: bool, row: &Row, theta: f64, (sa, ca): (f64, f64)) -> Matrix4<f64> {
    let (st, ct) = theta.sin_cos();
    let Row { a, d, .. } = *row;
    if modified {
        Matrix4::new(
            ct,
            -st,
            0.0,
            a, //
            st * ca,
            ct * ca,
            -sa,
            -sa * d, //
            st * sa,
            ct * sa,
            ca,
            ca * d, //
            0.0,
            0.0,
            0.0,
            1.0,
        )
    } else {
        Matrix4::new(
            ct,
            -st * ca,
            st * sa,
            a * ct, //
            st,
            ct * ca,
            -ct * sa,
            a * st, //
            0.0,
            sa,
            ca,
            d, //
            0.0,
            0.0,
            0.0,
            1.0,
        )
    }
}

impl MatrixArm {
    /// The shipped table of that name.
    ///
    /// # Errors
    /// There is no such table, or it has more than revolute joints of their own.
    pub fn shipped(name: &str) -> Result<Self, String> {
        let chain = Chain::read(dh_robots::table(name).ok_or_else(|| format!("no table `{name}`"))?)?;
        let mut rows = Vec::new();
        for row in &chain.rows {
            let [(_, direction)] = row.terms[..] else {
                return Err(format!("{name}: {} is coupled or held", row.name));
            };
            if row.prismatic || row.beta.to_f64() != 0.0 {
                return Err(format!("{name}: {} is not a plain revolute joint", row.name));
            }
            rows.push(Row {
                a: row.a.to_f64(),
                alpha: row.alpha.to_f64(),
                d: row.d.to_f64(),
                offset: row.theta.to_f64(),
                direction: direction.to_f64(),
            });
        }
        let matrix = |rows: [[f64; 4]; 4]| Matrix4::from_fn(|i, j| rows[i][j]);
        Ok(Self {
            modified: chain.convention == Convention::Modified,
            twists: rows.iter().map(|row| row.alpha.sin_cos()).collect(),
            rows,
            base: matrix(chain.base.to_f64()),
            tool: matrix(chain.tool.to_f64()),
        })
    }

    /// Tool pose; sine and cosine of theta and of alpha at every call.
    pub fn fk(&self, q: &[f64]) -> Matrix4<f64> {
        let mut pose = self.base;
        for (row, q) in self.rows.iter().zip(q) {
            pose *= row_matrix(self.modified, row, row.direction * q + row.offset, row.alpha.sin_cos());
        }
        pose * self.tool
    }

    /// The same with sine and cosine of alpha computed once, when the arm was read.
    pub fn fk_precomputed(&self, q: &[f64]) -> Matrix4<f64> {
        let mut pose = self.base;
        for ((row, twist), q) in self.rows.iter().zip(&self.twists).zip(q) {
            pose *= row_matrix(self.modified, row, row.direction * q + row.offset, *twist);
        }
        pose * self.tool
    }
}

/// Joint values in -pi ... pi, the same ones at every run (`SplitMix64`).
pub fn random_joints<const N: usize>(count: usize) -> Vec<[f64; N]> {
    let mut state = 0x0123_4567_89ab_cdef_u64;
    let mut next = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        std::f64::consts::PI * (2.0 * unit - 1.0)
    };
    (0..count).map(|_| std::array::from_fn(|_| next())).collect()
}

#[cfg(test)]
mod tests {
    use super::{MatrixArm, random_joints};
    use dh_tests::oracle::Oracle;

    #[test]
    fn both_conventions_agree_with_the_oracle() {
        for name in ["panda", "crane_x7"] {
            let (arm, oracle) = (MatrixArm::shipped(name).unwrap(), Oracle::shipped(name).unwrap());
            for q in random_joints::<7>(50) {
                let exact = oracle.fk(&q);
                for pose in [arm.fk(&q), arm.fk_precomputed(&q)] {
                    let off = (0..16)
                        .map(|i| (pose[(i / 4, i % 4)] - exact[i / 4][i % 4]).abs())
                        .fold(0.0, f64::max);
                    assert!(off < 1e-14, "{name}: {off:e}");
                }
            }
        }
        assert!(MatrixArm::shipped("scara").is_err());
        assert!(MatrixArm::shipped("uarm_swift_pro").is_err());
    }
}
