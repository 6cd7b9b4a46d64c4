//! Newton's method on the whole pose.

use super::{JOINTS, SixJoints, linear};
use crate::Frame;
use crate::frame::{cross, sub};

/// A solution after Newton's method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polished {
    /// Joint values (rad, m).
    pub q: [f64; JOINTS],
    /// The greatest error that is left: of the position in reaches, of the rotation in rad.
    pub error: f64,
}

/// Steps at most: near a singular pose each one halves the error, elsewhere two or three are enough.
const STEPS: usize = 40;
/// An error (reaches, rad) that can't be made smaller.
const ROUNDING: f64 = 4e-16;
/// Damping that makes singular steps harmless; beside a regular one it is nothing.
const DAMPING: f64 = 1e-14;

/// Brings joint values nearer to the pose (in reaches) as long as that is possible.
pub(super) fn polish(arm: &SixJoints<'_>, pose: &Frame, q: [f64; JOINTS]) -> Polished {
    let mut best = Polished { q, error: f64::INFINITY };
    let mut trial = q;
    let mut failures = 0;
    let mut damping = DAMPING;
    let mut step = [0.0; JOINTS];
    for _ in 0..STEPS {
        let (tool, columns) = columns(arm, &trial);
        let miss = twist(&tool, pose);
        let error = size(&miss);
        if error < best.error {
            let slow = error > best.error / 2.0;
            best = Polished { q: trial, error };
            if error <= ROUNDING || (slow && error < 1e-13) {
                break;
            }
            damping = if damping > DAMPING { damping / 16.0 } else { DAMPING };
            step = gauss_newton(&columns, &miss, damping);
        } else if best.error < 1e-13 || failures > 8 {
            break;
        } else {
            // Too far: halfway back, and more carefully from there on.
            failures += 1;
            damping *= 16.0;
            for value in &mut step {
                *value /= 4.0;
            }
        }
        trial = best.q;
        for (value, change) in trial.iter_mut().zip(step) {
            *value += change;
        }
    }
    best
}

/// The tip, and the columns of the Jacobian.
fn columns(arm: &SixJoints<'_>, q: &[f64; JOINTS]) -> (Frame, [[f64; 6]; JOINTS]) {
    let [base, links @ ..] = &arm.links;
    let mut frame = *base;
    let mut axes = [([0.0; 3], [0.0; 3]); JOINTS];
    for (((value, link), slides), axis) in q.iter().zip(links).zip(arm.prismatic).zip(&mut axes) {
        *axis = (frame.z_axis(), frame.translation);
        frame = frame.compose(&super::line::Motion::new(slides, *value).frame()).compose(link);
    }
    let mut columns = [[0.0; 6]; JOINTS];
    for ((column, (axis, origin)), slides) in columns.iter_mut().zip(axes).zip(arm.prismatic) {
        let [wx, wy, wz] = if slides { [0.0; 3] } else { axis };
        let [vx, vy, vz] = if slides { axis } else { cross(axis, sub(frame.translation, origin)) };
        *column = [vx, vy, vz, wx, wy, wz];
    }
    (frame, columns)
}

/// What brings a frame to another: a translation and a rotation vector.
fn twist(from: &Frame, to: &Frame) -> [f64; 6] {
    let [vx, vy, vz] = sub(to.translation, from.translation);
    let columns = |frame: &Frame| crate::frame::transpose(&frame.rotation);
    let (mut turn, mut cosine) = ([0.0; 3], 0.0);
    for (a, b) in columns(from).into_iter().zip(columns(to)) {
        turn = crate::frame::add(turn, cross(a, b));
        cosine += crate::frame::dot(a, b);
    }
    // Twice the sine along the axis; near half a turn any way round will do to begin with.
    let sine = crate::frame::norm(turn) / 2.0;
    let angle = libm::atan2(sine, (cosine - 1.0) / 2.0);
    let factor = if sine > 1e-8 { angle / (2.0 * sine) } else { 0.5 };
    let [wx, wy, wz] = turn.map(|x| x * factor);
    [vx, vy, vz, wx, wy, wz]
}

fn size(miss: &[f64; 6]) -> f64 {
    let [vx, vy, vz, wx, wy, wz] = miss;
    let (position, rotation) = (vx * vx + vy * vy + vz * vz, wx * wx + wy * wy + wz * wz);
    libm::sqrt(if position > rotation { position } else { rotation })
}

/// The step that makes |J step - miss|² + damping |step|² least.
fn gauss_newton(columns: &[[f64; 6]; JOINTS], miss: &[f64; 6], damping: f64) -> [f64; JOINTS] {
    let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
    let mut equations = [[0.0; JOINTS + 1]; JOINTS];
    for ((row, column), k) in equations.iter_mut().zip(columns).zip(0..) {
        let [left @ .., right] = row;
        for ((place, other), l) in left.iter_mut().zip(columns).zip(0..) {
            *place = dot(column, other) + if k == l { damping } else { 0.0 };
        }
        *right = dot(column, miss);
    }
    let _ = linear::solve(&mut equations);
    equations.map(|[.., step]| if step.is_finite() { step.clamp(-1.0, 1.0) } else { 0.0 })
}
