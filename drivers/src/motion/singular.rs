//! How near an arm is to a singularity of what it is asked to do.

use super::narrowed::Narrowed;
use dh_runtime::nalgebra::SMatrix;
use dh_runtime::{Frame, Kinematics, SolutionSet, Target};

/// How much of the arm's lever the smallest singular value must be. At this, the hand moves a thousandth of what the
/// joints could make of it.
const LEAST_PART: f64 = 1e-3;

/// The lever counts as this at least (m): what is smaller than that is the joints' own, not the hand's.
const LEAST_LEVER: f64 = 0.01;

/// By so much a target is moved (m, or rad times the lever) to see what joints make of it.
const STEP: f64 = 1e-6;

/// A smallest singular value that is too small, and what it must be at least (both m per rad of the joints).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Singular {
    pub(super) value: f64,
    pub(super) least: f64,
}

/// Whether the arm, which meets the target at `q`, could follow it in every direction.
///
/// For a full pose that is in the Jacobian; with fewer joints than rows, the joints themselves have to be independent.
/// What a table's problem holds fast is not in it. There the derivative is taken of the solution: its greatest singular
/// value is the inverse of the smallest one of the map from joints to target.
pub(super) fn check(arm: &Narrowed<'_>, problem: &str, target: &Target, q: &[f64]) -> Result<(), Singular> {
    let mut columns = vec![[0.0; 6]; arm.dof()];
    if arm.jacobian_into(q, &mut columns).is_err() {
        return Ok(());
    }
    let lever =
        columns.iter().map(|[x, y, z, ..]| (x * x + y * y + z * z).sqrt()).fold(LEAST_LEVER, f64::max);
    let least = LEAST_PART * lever;
    let value = if matches!(target, Target::Pose(_)) {
        of_columns(&columns, lever)
    } else {
        of_solutions(arm, problem, target, q, lever)
    };
    if value < least { Err(Singular { value, least }) } else { Ok(()) }
}

/// The smallest singular value of a Jacobian, its angular rows in metres at the lever.
fn of_columns(columns: &[[f64; 6]], lever: f64) -> f64 {
    let scaled: Vec<[f64; 6]> =
        columns.iter().map(|[a, b, c, d, e, f]| [*a, *b, *c, d * lever, e * lever, f * lever]).collect();
    let mut gram = SMatrix::<f64, 6, 6>::zeros();
    if scaled.len() < 6 {
        // The squares of the columns; what is left over of the matrix is no direction at all.
        gram.fill_diagonal(f64::MAX.sqrt());
        for (i, left) in scaled.iter().enumerate() {
            for (j, right) in scaled.iter().enumerate() {
                gram[(i, j)] = left.iter().zip(right).map(|(x, y)| x * y).sum();
            }
        }
    } else {
        for column in &scaled {
            for (i, x) in column.iter().enumerate() {
                for (j, y) in column.iter().enumerate() {
                    gram[(i, j)] += x * y;
                }
            }
        }
    }
    gram.symmetric_eigenvalues().min().max(0.0).sqrt()
}

/// The same from the solutions of the problem beside the target; 0 where there is none on either side of it.
fn of_solutions(arm: &Narrowed<'_>, problem: &str, target: &Target, q: &[f64], lever: f64) -> f64 {
    let mut gram = SMatrix::<f64, 6, 6>::zeros();
    let mut derivatives: Vec<Vec<f64>> = Vec::new();
    for direction in 0..6 {
        let sides = [STEP, -STEP].map(|step| (step, moved(target, direction, step, lever)));
        let mut solved = None;
        let mut exists = false;
        for (step, beside) in sides {
            let Some(beside) = beside.filter(|_| solved.is_none()) else { continue };
            exists = true;
            solved = solve(arm, problem, &beside, q).map(|solution| (step, solution));
        }
        match solved {
            Some((step, solution)) => {
                derivatives.push(solution.iter().zip(q).map(|(there, here)| (there - here) / step).collect());
            }
            None if exists => return 0.0,
            // The kind has no such direction.
            None => {}
        }
    }
    for (i, left) in derivatives.iter().enumerate() {
        for (j, right) in derivatives.iter().enumerate() {
            gram[(i, j)] = left.iter().zip(right).map(|(x, y)| x * y).sum();
        }
    }
    1.0 / gram.symmetric_eigenvalues().max().max(0.0).sqrt()
}

/// The geometric solution nearest to `q`, whether or not it is allowed.
pub(super) fn solve(arm: &Narrowed<'_>, problem: &str, target: &Target, q: &[f64]) -> Option<Vec<f64>> {
    let mut solutions = SolutionSet::new();
    arm.ik_into(problem, target, &mut solutions).ok()?;
    let turned = |solution: &[f64]| -> Vec<f64> {
        let mut turned = solution.to_vec();
        for winding in arm.rules().windings {
            let (Some(value), Some(wanted)) = (turned.get(winding.joint), q.get(winding.joint)) else {
                continue;
            };
            let turns = ((wanted - value) / winding.turn).round();
            if let Some(value) = turned.get_mut(winding.joint) {
                *value += turns * winding.turn;
            }
            for (joint, carried) in winding.carries {
                if let Some(value) = turned.get_mut(*joint) {
                    *value += turns * carried;
                }
            }
        }
        turned
    };
    let distance = |other: &Vec<f64>| -> f64 { other.iter().zip(q).map(|(a, b)| (a - b).powi(2)).sum() };
    let candidates = solutions.iter().map(|solution| turned(solution.q));
    candidates.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The target a little further in one of the directions that its kind has.
fn moved(target: &Target, direction: usize, step: f64, lever: f64) -> Option<Target> {
    let place = |position: [f64; 3]| -> Option<[f64; 3]> {
        let mut position = position;
        *position.get_mut(direction)? += step;
        Some(position)
    };
    let flat = |[x, y]: [f64; 2]| match direction {
        0 => Some([x + step, y]),
        1 => Some([x, y + step]),
        _ => None,
    };
    let turned = |vector: [f64; 3], axis: usize| -> Option<[f64; 3]> {
        let mut rpy = [0.0; 3];
        *rpy.get_mut(axis)? = step / lever;
        Some(Frame::from_rpy([0.0; 3], rpy).transform_vector(vector))
    };
    Some(match *target {
        Target::Pose(_) => return None,
        Target::Position(position) => Target::Position(place(position)?),
        Target::Lookat(position) => Target::Lookat(place(position)?),
        Target::PositionYaw { position, yaw } if direction == 3 => {
            Target::PositionYaw { position, yaw: yaw + step / lever }
        }
        Target::PositionYaw { position, yaw } => Target::PositionYaw { position: place(position)?, yaw },
        Target::PositionDirection { position, direction: vector } => match direction.checked_sub(3) {
            Some(axis) => Target::PositionDirection { position, direction: turned(vector, axis)? },
            None => Target::PositionDirection { position: place(position)?, direction: vector },
        },
        Target::Ray { position, direction: vector } => match direction.checked_sub(3) {
            Some(axis) => Target::Ray { position, direction: turned(vector, axis)? },
            None => Target::Ray { position: place(position)?, direction: vector },
        },
        Target::Direction(vector) => Target::Direction(turned(vector, direction)?),
        Target::Rotation(rotation) => {
            let mut rpy = [0.0; 3];
            *rpy.get_mut(direction)? = step / lever;
            let frame = Frame { rotation, ..Frame::IDENTITY };
            Target::Rotation((Frame::from_rpy([0.0; 3], rpy) * frame).rotation)
        }
        Target::Xy(position) => Target::Xy(flat(position)?),
        Target::XyYaw { position, yaw } if direction == 2 => {
            Target::XyYaw { position, yaw: yaw + step / lever }
        }
        Target::XyYaw { position, yaw } => Target::XyYaw { position: flat(position)?, yaw },
    })
}
