//! Newton's method for six joints where it converges as it should.

use super::jacobian::pose_and_jacobian;
use super::linear::solve;
use super::{JOINTS, SixJoints};
use crate::Frame;
use crate::frame::{cross, sub};

/// The most steps.
const STEPS: usize = 5;
/// A longer step (rad, reaches) is not one of the quadratic convergence that is hoped for.
const LONGEST: f64 = 0.1;
/// After a step this short (rad, reaches) the pose is met to the last digit: what is left of the error is its square.
const SHORT: f64 = 1e-8;

/// The joint values near others at which the tip is at its target, lengths in reaches, and the determinant of the
/// Jacobian. `None` where the Jacobian is
/// singular or the way far: there, damped steps may help.
pub(super) fn newton(
    arm: &SixJoints<'_>,
    target: &Frame,
    from: &[f64; JOINTS],
) -> Option<([f64; JOINTS], f64)> {
    let mut q = *from;
    for _ in 0..STEPS {
        let (tip, columns) = pose_and_jacobian(arm, &q);
        let error = error(&tip, target)?;
        let [a, b, c, d, e, f] = columns;
        let mut rows = [[0.0; JOINTS + 1]; JOINTS];
        for (k, (row, error)) in rows.iter_mut().zip(error).enumerate() {
            *row = [a[k], b[k], c[k], d[k], e[k], f[k], error];
        }
        let determinant = solve(&mut rows);
        if determinant == 0.0 {
            return None;
        }
        let mut longest = 0.0;
        for (value, [.., step]) in q.iter_mut().zip(rows) {
            *value += step;
            let size = libm::fabs(step);
            // Not a number is longest.
            longest = if size <= longest { longest } else { size };
        }
        if longest <= SHORT {
            return Some((q, determinant));
        }
        if longest > LONGEST || longest.is_nan() {
            return None;
        }
    }
    None
}

/// What is left of the way to a target: position in reaches, then the turn (rad), for small ones. `None` for a turn of
/// more than a quarter.
fn error(tip: &Frame, target: &Frame) -> Option<[f64; 6]> {
    let [px, py, pz] = sub(target.translation, tip.translation);
    let [[ax, bx, cx], [ay, by, cy], [az, bz, cz]] = tip.rotation;
    let [[dx, ex, fx], [dy, ey, fy], [dz, ez, fz]] = target.rotation;
    let [a, b, c] = [
        cross([ax, ay, az], [dx, dy, dz]),
        cross([bx, by, bz], [ex, ey, ez]),
        cross([cx, cy, cz], [fx, fy, fz]),
    ];
    let trace = ax * dx + ay * dy + az * dz + bx * ex + by * ey + bz * ez + cx * fx + cy * fy + cz * fz;
    let turn = |a: f64, b: f64, c: f64| (a + b + c) / 2.0;
    let [x, y, z] = [turn(a[0], b[0], c[0]), turn(a[1], b[1], c[1]), turn(a[2], b[2], c[2])];
    (trace > 1.0).then_some([px, py, pz, x, y, z])
}
