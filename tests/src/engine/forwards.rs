//! What an engine computes forwards, compared with the oracle.

use crate::oracle::Oracle;
use dh_core::{Frame, Kinematics};

/// Greatest difference between a frame and a matrix, in m and ratios alike.
pub fn difference(frame: &Frame, matrix: &[[f64; 4]; 4]) -> f64 {
    let rows = frame.rotation.iter().zip(frame.translation).zip(matrix);
    let mut worst = 0.0_f64;
    for ((rotation, translation), given) in rows {
        for (a, b) in rotation.iter().chain([&translation]).zip(given) {
            let off = (a - b).abs();
            worst = if off.is_nan() { f64::INFINITY } else { worst.max(off) };
        }
    }
    worst
}

/// Compares all that is computed forwards.
///
/// # Errors
/// What differs, and by how much.
pub fn compare(engine: &dyn Kinematics, oracle: &Oracle, q: &[f64], tolerance: f64) -> Result<(), String> {
    let close = |what: &str, difference: f64| {
        if difference <= tolerance {
            Ok(())
        } else {
            Err(format!("{what} differs by {difference:e} at {q:?}"))
        }
    };
    let told = |error: dh_core::LengthError| error.to_string();
    close("fk", difference(&engine.fk(q).map_err(told)?, &oracle.fk(q)))?;
    close("fk_flange", difference(&engine.fk_flange(q).map_err(told)?, &oracle.fk_flange(q)))?;

    let expected = oracle.frames(q);
    let mut frames = vec![Frame::IDENTITY; engine.rows() + 1];
    let count = engine.frames_into(q, &mut frames).map_err(told)?;
    if count != expected.len() {
        return Err(format!("{count} frames for {}", expected.len()));
    }
    for (row, (frame, matrix)) in frames.iter().zip(&expected).enumerate() {
        close(&format!("frame {row}"), difference(frame, matrix))?;
    }

    let mut columns = vec![[0.0; 6]; engine.dof()];
    engine.jacobian_into(q, &mut columns).map_err(told)?;
    for (joint, (column, expected)) in columns.iter().zip(oracle.jacobian(q)).enumerate() {
        let worst = column.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        close(&format!("jacobian column {}", joint + 1), worst)?;
    }
    Ok(())
}

/// What a product of f64 matrices may be off by: a few units in the last place of the arm's size.
pub fn tolerance(oracle: &Oracle) -> f64 {
    4e-15 * (1.0 + oracle.reach()) * oracle.chain().rows.len() as f64
}
