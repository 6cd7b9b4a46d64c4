//! Forward functions against the product of the rows.

use super::reference::{Reference, distance, position};
use super::report::FunctionReport;
use super::{FORWARD_TOLERANCE, Tolerance};
use crate::model::product::Matrix;
use crate::plan::FunctionKind;
use crate::plan::eval::Program;

/// What a forward function must give at one joint vector.
struct Expected {
    matrices: Vec<Matrix>,
    /// Jacobian columns, each with the distance that its rounding is relative to (m).
    columns: Vec<([f64; 6], f64)>,
}

impl Expected {
    fn of(kind: &FunctionKind, reference: &Reference<'_>) -> Self {
        let tool = reference.frames.tool;
        let (matrices, columns) = match kind {
            FunctionKind::Fk => (vec![tool], Vec::new()),
            FunctionKind::FkFlange => (vec![reference.flange()], Vec::new()),
            FunctionKind::Jacobian => (Vec::new(), reference.jacobian()),
            FunctionKind::FkJacobian => (vec![tool], reference.jacobian()),
            FunctionKind::Frames => (reference.frames.rows.clone(), Vec::new()),
            FunctionKind::Inverse(_) => (Vec::new(), Vec::new()),
        };
        Expected { matrices, columns }
    }
}

/// Runs a forward function at every pose; the first pose at which it is wrong ends up in the report as its failure.
pub(super) fn verify(
    program: &Program<'_>,
    references: &[Reference<'_>],
    reach: f64,
    report: &mut FunctionReport,
) {
    for reference in references {
        report.poses += 1;
        let failure = match program.forward(&report.kind, &reference.q) {
            Some(outputs) => compare(&outputs, &Expected::of(&report.kind, reference), reach, report),
            None => Some("it cannot be run".to_owned()),
        };
        if let Some(failure) = failure {
            report.failure = Some(format!("{failure}, at q = {:?}", reference.q));
            return;
        }
    }
}

/// Compares the outputs of one run; says what is wrong.
fn compare(outputs: &[f64], expected: &Expected, reach: f64, report: &mut FunctionReport) -> Option<String> {
    let Some((matrices, columns)) = outputs.split_at_checked(12 * expected.matrices.len()) else {
        return Some("outputs are missing".to_owned());
    };
    for (index, (output, matrix)) in matrices.chunks_exact(12).zip(&expected.matrices).enumerate() {
        let mut computed = Matrix::default();
        computed.as_flattened_mut().iter_mut().zip(output).for_each(|(entry, output)| *entry = *output);
        let (position_error, rotation_error) = distance(&computed, matrix);
        // Frames of tables with huge offsets may lie far outside of the arm; a coordinate is rounded to its size.
        let far = position(matrix).into_iter().fold(0.0, |far, p| f64::max(far, p.abs()));
        let tolerance = Tolerance {
            position: FORWARD_TOLERANCE * reach + 4.0 * f64::EPSILON * far,
            rotation: FORWARD_TOLERANCE,
        };
        report.errors(position_error, rotation_error);
        if !tolerance.holds(position_error, rotation_error) {
            let which =
                if expected.matrices.len() > 1 { format!("frame {index}") } else { "the frame".to_owned() };
            return Some(format!(
                "{which} is {position_error:.3e} m and {rotation_error:.3e} rad from the product of the rows"
            ));
        }
    }
    for (index, (output, (column, arm))) in columns.chunks_exact(6).zip(&expected.columns).enumerate() {
        let mut squares = [0.0_f64; 2];
        for (row, (output, entry)) in output.iter().zip(column).enumerate() {
            let square = (output - entry) * (output - entry);
            *(if row < 3 { &mut squares[0] } else { &mut squares[1] }) += square;
        }
        let [linear, angular] = squares.map(f64::sqrt);
        // 1 m/m is as large as it gets for joints that slide, reach for those that turn.
        let size = reach.max(1.0);
        let tolerance = Tolerance {
            position: FORWARD_TOLERANCE * size + 4.0 * f64::EPSILON * arm,
            rotation: FORWARD_TOLERANCE,
        };
        report.errors(linear, angular);
        if !tolerance.holds(linear, angular) {
            return Some(format!(
                "column {} differs by {linear:.3e} m and {angular:.3e} rad per unit of the joint from the product of the rows",
                index + 1
            ));
        }
    }
    None
}
