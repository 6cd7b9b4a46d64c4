//! The robot as fixed transforms between joints: F0 J1 F1 J2 ... Jn Fn, in both conventions.
//!
//! A joint is Rz(theta) or Tz(d) about the z axis of the frame before it, with theta (or d) = the row's value at zero
//! + sum of its terms. Everything else is fixed and stands in the links as a product of elementary transforms:
//!
//! - standard: row i is its joint, then what is fixed of Rz(theta) Tz(d), then Tx(a) Rx(alpha) Ry(beta);
//! - modified: row i is Tx(a) Rx(alpha) Ry(beta), its joint, then what is fixed of Rz(theta) Tz(d).
//!
//! Held rows without couplings are no joints; they are part of a link. Where the axes were recentred, the translations
//! between one axis and the next, Tz(d - shift before) Tx(a) Rx(alpha) Ry(beta) Tz(shift after), stand as one small
//! translation before the rotations.

use super::{Angle, Convention, JointKind, Placement, Rotation, Row};

/// A chain of joints with fixed transforms between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// The joints, base to tip: rows whose theta (or d) varies, coupled held rows included.
    pub joints: Vec<ChainJoint>,
    /// One more than there are joints: `links[0]` is before the first joint and holds `[base]`, the last one holds
    /// `[tool]`.
    pub links: Vec<Link>,
}

/// A joint of the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChainJoint {
    /// The row that it belongs to.
    pub row: usize,
    /// Rz(theta) or Tz(d).
    pub kind: JointKind,
}

/// A fixed transform: the product of its elements from left to right.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Link {
    /// Elements that do nothing are left out.
    pub elements: Vec<Element>,
    /// The table's own frames that stand in this link.
    pub frames: Vec<RowFrame>,
    /// In the last link: how many elements come before `[tool]`, that is up to the flange. Elsewhere all of them.
    pub flange: usize,
}

/// One elementary transform.
#[derive(Debug, Clone, PartialEq)]
pub enum Element {
    /// Along an axis.
    Translate {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// m
        value: f64,
        /// As the field writes it: `d1`, `a2`, `tool_z`.
        name: String,
        /// What it is and where it stands.
        note: String,
    },
    /// About an axis.
    Rotate {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// How far.
        angle: Angle,
        /// As the field writes it: `alpha3`, `theta2` (a held joint), `tool_yaw`.
        name: String,
        /// What it is and where it stands.
        note: String,
    },
    /// A rotation that the table gives as a quaternion.
    Matrix {
        /// Rows of the matrix.
        rows: [[f64; 3]; 3],
        /// `base_r` or `tool_r`.
        name: String,
        /// What it is and where it stands.
        note: String,
    },
}

/// Where a frame of the table stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowFrame {
    /// The row; `None` for the base frame, which is before the first row and after `[base]`.
    pub row: Option<usize>,
    /// How many of the link's elements come before it.
    pub after: usize,
    /// How far it lies beyond that place, along z there (m); 0 except in recentred tables.
    pub along_z: f64,
}

/// The chain of these rows.
pub(crate) fn build(convention: Convention, rows: &[Row], base: &Placement, tool: &Placement) -> Chain {
    let mut builder = Builder {
        chain: Chain { joints: Vec::new(), links: Vec::new() },
        link: Link::default(),
        pending: Pending::default(),
    };
    builder.placement("base", base);
    builder.frame(None, 0.0);
    for (index, row) in rows.iter().enumerate() {
        match convention {
            Convention::Standard => {
                builder.joint(index, row);
                builder.twist(index, row, row.shift);
                builder.frame(Some(index), -row.shift);
            }
            Convention::Modified => {
                builder.twist(index, row, row.shift);
                builder.joint(index, row);
                // Where the next axis is recentred, this offset and that shift cancel and must meet first.
                let recentred = rows.get(index + 1).is_some_and(|next| next.shift != 0.0);
                if recentred {
                    builder.frame(Some(index), builder.pending.d);
                } else {
                    builder.flush();
                    builder.frame(Some(index), 0.0);
                }
            }
        }
    }
    builder.flush();
    builder.link.flange = builder.link.elements.len();
    builder.placement("tool", tool);
    let mut chain = builder.chain;
    chain.links.push(builder.link);
    chain
}

/// What is still to be translated along the present axis.
#[derive(Default)]
struct Pending {
    /// d of the row, less the shift of its axis (m).
    d: f64,
    /// The shift of its axis (m).
    shift: f64,
    /// Whose d it is, with the line of its row.
    row: Option<(usize, usize)>,
}

struct Builder {
    chain: Chain,
    link: Link,
    pending: Pending,
}

impl Builder {
    /// The joint of a row, or its fixed rotation; its fixed translation waits in `pending`.
    fn joint(&mut self, index: usize, row: &Row) {
        let before = self.pending.shift;
        let moves = !row.terms.is_empty();
        if moves {
            self.flush();
            let mut link = core::mem::take(&mut self.link);
            link.flange = link.elements.len();
            self.chain.links.push(link);
            self.chain.joints.push(ChainJoint { row: index, kind: row.kind });
        }
        if !(moves && row.kind == JointKind::Revolute) {
            let note = format!("fixed joint angle of joint {}, table line {}", index + 1, row.line);
            self.rotate(2, row.theta, format!("theta{}", index + 1), note);
        }
        let d = if moves && row.kind == JointKind::Prismatic { 0.0 } else { row.d };
        self.pending = Pending { d: d - before, shift: 0.0, row: Some((index, row.line)) };
    }

    /// To the next axis: what is pending, then Tx(a) Rx(alpha) Ry(beta), then the shift of that axis.
    fn twist(&mut self, index: usize, row: &Row, shift: f64) {
        let number = index + 1;
        let length = format!("link length of joint {number}, table line {}", row.line);
        if shift == 0.0 {
            self.flush();
            self.translate(0, row.a, format!("a{number}"), length);
        } else {
            let pending = core::mem::take(&mut self.pending);
            let [x, y, z] = between(pending.d, row.a, row.alpha, row.beta, shift);
            let note =
                |what: &str| format!("{what} of joint {number}, axis recentred, table line {}", row.line);
            let of = pending.row.map_or(number, |(index, _)| index + 1);
            self.translate(2, z, format!("d{of}"), note("link offset"));
            self.translate(0, x, format!("a{number}"), note("link length"));
            self.translate(1, y, format!("y{number}"), note("distance along y"));
        }
        let note = |what: &str| format!("{what} of joint {number}, table line {}", row.line);
        self.rotate(0, row.alpha, format!("alpha{number}"), note("link twist"));
        self.rotate(1, row.beta, format!("beta{number}"), note("turn about y"));
        self.pending = Pending { d: 0.0, shift, row: None };
    }

    /// Puts down the translation that is pending.
    fn flush(&mut self) {
        let shift = self.pending.shift;
        let pending = core::mem::replace(&mut self.pending, Pending { shift, ..Pending::default() });
        if let Some((index, line)) = pending.row {
            let note = format!("link offset of joint {}, table line {line}", index + 1);
            self.translate(2, pending.d, format!("d{}", index + 1), note);
        }
    }

    fn frame(&mut self, row: Option<usize>, along_z: f64) {
        self.link.frames.push(RowFrame { row, after: self.link.elements.len(), along_z });
    }

    fn translate(&mut self, axis: usize, value: f64, name: String, note: String) {
        if value != 0.0 {
            self.link.elements.push(Element::Translate { axis, value, name, note });
        }
    }

    fn rotate(&mut self, axis: usize, angle: Angle, name: String, note: String) {
        if !angle.is_zero() {
            self.link.elements.push(Element::Rotate { axis, angle, name, note });
        }
    }

    /// `[base]` or `[tool]`: the translation, then Rz(yaw) Ry(pitch) Rx(roll).
    fn placement(&mut self, which: &str, placement: &Placement) {
        for (axis, (value, letter)) in placement.xyz.into_iter().zip(["x", "y", "z"]).enumerate() {
            self.translate(axis, value, format!("{which}_{letter}"), format!("{letter} of [{which}]"));
        }
        match &placement.rotation {
            Rotation::Rpy([roll, pitch, yaw]) => {
                for (axis, angle, word) in [(2, yaw, "yaw"), (1, pitch, "pitch"), (0, roll, "roll")] {
                    self.rotate(axis, *angle, format!("{which}_{word}"), format!("{word} of [{which}]"));
                }
            }
            Rotation::Matrix(rows) => {
                let note = format!("rotation of [{which}], from its quaternion");
                self.link.elements.push(Element::Matrix { rows: *rows, name: format!("{which}_r"), note });
            }
        }
    }
}

/// The translation of Tz(d) Tx(a) Rx(alpha) Ry(beta) Tz(shift), without cancellation where `d` and `shift` are huge
/// and the axes nearly parallel (m).
pub(crate) fn between(d: f64, a: f64, alpha: Angle, beta: Angle, shift: f64) -> [f64; 3] {
    let (sin_alpha, cos_alpha) = alpha.sin_cos();
    let (sin_beta, cos_beta) = beta.sin_cos();
    let (size_alpha, less_alpha) = cosine_parts(alpha, cos_alpha);
    let (_, less_beta) = cosine_parts(beta, cos_beta);
    // cos(alpha) cos(beta) = sense (1 - less), so that the sum of d and the shift comes first, and exactly.
    let sense = if cos_alpha * cos_beta < 0.0 { -1.0 } else { 1.0 };
    let less = less_alpha + size_alpha * less_beta;
    let x = a + sin_beta * shift;
    let y = -sin_alpha * cos_beta * shift;
    let z = (d + sense * shift) - sense * less * shift;
    [x, y, z]
}

/// |cos| and 1 - |cos| of an angle, the latter accurate where it is small.
fn cosine_parts(angle: Angle, cosine: f64) -> (f64, f64) {
    if angle.fifteenths.is_some() {
        return (cosine.abs(), 1.0 - cosine.abs());
    }
    let half = if cosine < 0.0 { libm::cos(angle.value / 2.0) } else { libm::sin(angle.value / 2.0) };
    (cosine.abs(), 2.0 * half * half)
}
