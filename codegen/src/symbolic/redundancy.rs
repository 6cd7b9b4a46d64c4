//! Which joint of an arm with one too many is best left to the caller.
//!
//! The joint rates that leave the tool where it is are one direction n, the self-motion. With joint i held, the
//! determinant of what is left of the Jacobian is proportional to n_i: a joint that hardly takes part in the
//! self-motion is a bad one to give, since the others run away where it moves.

use crate::model::product;
use crate::model::{JointKind, Model};

/// At how many joint vectors the self-motion is looked at.
const SAMPLES: usize = 16;
/// A share of the self-motion below this is none.
const LEAST: f64 = 1e-6;
/// Rows of a pose.
const ROWS: usize = 6;

/// The joints of a robot with seven (indices of q), the best to give first: by the geometric mean of their share in the
/// self-motion, lengths being relative to the reach.
pub fn joints(model: &Model) -> Vec<usize> {
    let count = model.joints.len();
    let mut scores = vec![0.0; count];
    for sample in 0..SAMPLES {
        let motion = self_motion(model, &joint_vector(model, sample));
        for (score, share) in scores.iter_mut().zip(motion) {
            *score += libm::log(share.abs().max(LEAST));
        }
    }
    let mut joints: Vec<usize> = (0..count).collect();
    // Shares that differ by less than a quarter are equal; such joints stay in their order.
    let score =
        |joint: &usize| scores.get(*joint).map_or(0.0, |score| (4.0 * score / SAMPLES as f64).round());
    joints.sort_by(|a, b| score(b).total_cmp(&score(a)));
    joints
}

/// Any irrational steps will do: revolute joints take the whole turn, slides a part of the reach or of their limits.
fn joint_vector(model: &Model, sample: usize) -> Vec<f64> {
    let rows = model.joints.iter().filter_map(|row| model.rows.get(*row)).enumerate();
    rows.map(|(joint, row)| {
        let phase = (0.754_877_666 * sample as f64 + 0.618_033_989 * joint as f64 + 0.1).fract();
        match (row.kind, row.limits) {
            (JointKind::Revolute, _) => core::f64::consts::TAU * (phase - 0.5),
            (JointKind::Prismatic, Some(limits)) => limits.min + phase * (limits.max - limits.min),
            (JointKind::Prismatic, None) => phase * model.reach(),
        }
    })
    .collect()
}

/// Unit joint rates that leave the tool where it is: elimination of the Jacobian's rows, pivots anywhere.
fn self_motion(model: &Model, q: &[f64]) -> Vec<f64> {
    let reach = model.reach();
    let length = |joint: usize| {
        let row = model.joints.get(joint).and_then(|row| model.rows.get(*row));
        if row.is_some_and(|row| row.kind == JointKind::Prismatic) { reach } else { 1.0 }
    };
    let columns: Vec<[f64; ROWS]> = product::jacobian(model, &product::frames(model, q))
        .iter()
        .enumerate()
        .map(|(joint, ([vx, vy, vz, wx, wy, wz], _))| {
            let unit = length(joint);
            [vx / reach, vy / reach, vz / reach, *wx, *wy, *wz].map(|x| x * unit)
        })
        .collect();
    let mut rows: Vec<Vec<f64>> = (0..ROWS)
        .map(|row| columns.iter().map(|column| column.get(row).copied().unwrap_or(0.0)).collect())
        .collect();
    // Reduced row by row: each pivot's joint is minus the row times the joint that is left.
    let mut pivots: Vec<(usize, usize)> = Vec::new();
    for _ in 0..ROWS {
        let open = |row: &usize| pivots.iter().all(|(other, _)| other != row);
        let places = (0..ROWS).filter(open).flat_map(|row| (0..columns.len()).map(move |joint| (row, joint)));
        let size = |(row, joint): &(usize, usize)| {
            rows.get(*row).and_then(|row| row.get(*joint)).map_or(0.0, |x| x.abs())
        };
        let Some((row, joint)) = places.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
        let Some(pivot) = rows.get(row).cloned() else { break };
        let own = pivot.get(joint).copied().unwrap_or(0.0);
        if own.abs() < LEAST {
            break;
        }
        for (index, other) in rows.iter_mut().enumerate() {
            let factor = other.get(joint).copied().unwrap_or(0.0) / own;
            let (factor, keep) = if index == row { (0.0, 1.0 / own) } else { (factor, 1.0) };
            other.iter_mut().zip(&pivot).for_each(|(x, p)| *x = keep * (*x - factor * p));
        }
        pivots.push((row, joint));
    }
    let mut motion = vec![0.0; columns.len()];
    let Some(left) = (0..columns.len()).find(|joint| pivots.iter().all(|(_, other)| other != joint)) else {
        return motion;
    };
    for (joint, share) in motion.iter_mut().enumerate() {
        let row = pivots.iter().find(|(_, other)| *other == joint).and_then(|(row, _)| rows.get(*row));
        *share = row.map_or(1.0, |row| -row.get(left).copied().unwrap_or(0.0));
        if row.is_none() && joint != left {
            *share = 0.0;
        }
    }
    let norm = motion.iter().map(|x| x * x).sum::<f64>().sqrt();
    motion.iter().map(|x| x / norm).collect()
}
