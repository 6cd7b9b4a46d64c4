//! Axes that are nearly parallel, with offsets of kilometres that cancel: where the frames are moved to.
//!
//! DH puts the frame of an axis at the foot of the common normal with the next one. For axes that meet at 1e-5 rad
//! that foot can lie kilometres away, and the next row's `d` comes all the way back. Along its own axis a frame can be
//! moved freely, since that commutes with the joint; so it is moved back to where it started, before anything is
//! computed. Then no length is out of proportion to the arm.

use super::{Convention, JointKind, Row};

/// Axes that meet at more than this are no candidates (rad): their offsets are real.
const NEARLY_PARALLEL: f64 = 0.1;

/// An offset is out of proportion when it is so many times the reach.
const OUT_OF_PROPORTION: f64 = 10.0;

/// From one joint axis to the next, in either convention: Tz(d) Tx(a) Rx(alpha) Ry(beta).
struct Gap {
    /// m
    d: f64,
    /// m
    a: f64,
    /// 1 or -1: whether the next axis points the same way.
    sense: f64,
    /// Sine of the angle between the axes.
    tilt: f64,
    /// The row that keeps the shift of the next axis; none after the last joint of the modified convention.
    row: Option<usize>,
    /// Whether the next axis may be moved along.
    movable: bool,
}

/// Sets `shift` of every row: 0 except where huge offsets cancel.
pub(crate) fn recentre(convention: Convention, rows: &mut [Row]) {
    let gaps = gaps(convention, rows);
    let reach = reach_of_cancelled(&gaps);
    let mut before = 0.0;
    let mut in_use = false;
    for gap in &gaps {
        let offset = gap.d - before;
        let near = gap.tilt <= NEARLY_PARALLEL && gap.movable;
        // Exactly parallel axes only hand on what a nearly parallel one has begun.
        let begins = gap.tilt > 0.0 || in_use;
        let moved = near && begins && offset.abs() > OUT_OF_PROPORTION * reach;
        before = if moved { -gap.sense * offset } else { 0.0 };
        in_use = moved;
        if let Some(row) = gap.row.and_then(|index| rows.get_mut(index)) {
            row.shift = before;
        }
    }
}

fn gaps(convention: Convention, rows: &[Row]) -> Vec<Gap> {
    rows.iter()
        .enumerate()
        .map(|(index, row)| {
            // The frame after the last row is the flange, which the table fixes; so is the base.
            let next = rows.get(index + 1);
            let (twisted, keeper) = match convention {
                Convention::Standard => (Some(row), Some(index)),
                Convention::Modified => (next, next.map(|_| index + 1)),
            };
            let (a, sense, tilt) = twisted.map_or((0.0, 1.0, 1.0), |twisted| {
                let (sin_alpha, cos_alpha) = twisted.alpha.sin_cos();
                let (sin_beta, cos_beta) = twisted.beta.sin_cos();
                let cosine = cos_alpha * cos_beta;
                (
                    twisted.a,
                    if cosine < 0.0 { -1.0 } else { 1.0 },
                    libm::hypot(sin_beta, sin_alpha * cos_beta),
                )
            });
            // The own translation of a prismatic joint stays what the table calls d.
            let slides = |row: &Row| row.kind == JointKind::Prismatic && !row.terms.is_empty();
            Gap {
                d: if slides(row) { 0.0 } else { row.d },
                a,
                sense,
                tilt,
                row: keeper,
                movable: next.is_some_and(|next| !slides(next)),
            }
        })
        .collect()
}

/// How far the arm reaches once offsets along nearly parallel axes have cancelled (m).
fn reach_of_cancelled(gaps: &[Gap]) -> f64 {
    let mut reach = 0.0;
    let mut along = 0.0;
    for gap in gaps {
        reach += gap.a.abs();
        along += gap.d;
        if gap.tilt <= NEARLY_PARALLEL && gap.movable {
            along *= gap.sense;
        } else {
            reach += f64::abs(along);
            along = 0.0;
        }
    }
    reach + along.abs()
}
