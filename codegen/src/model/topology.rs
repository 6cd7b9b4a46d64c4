//! How joint variables move the rows: couplings, their inverse, and the whole turns that change nothing.

use super::{JointKind, Row, Winding};
use core::f64::consts::TAU;

/// Coefficients that ought to be whole numbers are, to within this.
const WHOLE: f64 = 1e-9;

/// Held rows that follow joints through gears come back after at most so many turns, or are taken never to.
const MOST_TURNS: i32 = 360;

/// The coefficients of a row's theta (or d) in all joint variables.
pub(super) fn coefficients(row: &Row, variables: usize) -> Vec<f64> {
    let mut dense = vec![0.0; variables];
    for &(variable, coefficient) in &row.terms {
        if let Some(entry) = dense.get_mut(variable) {
            *entry += coefficient;
        }
    }
    dense
}

/// Joint variables from the thetas and ds of their own rows: q = inverse * (theta - theta at zero). `None` where the
/// couplings cancel.
pub(super) fn inverse(rows: &[Row], joints: &[usize]) -> Option<Vec<Vec<f64>>> {
    let size = joints.len();
    let mut left: Vec<Vec<f64>> =
        joints.iter().filter_map(|index| rows.get(*index)).map(|row| coefficients(row, size)).collect();
    let mut right: Vec<Vec<f64>> =
        (0..size).map(|i| (0..size).map(|j| if i == j { 1.0 } else { 0.0 }).collect()).collect();
    for column in 0..size {
        let size_at = |row: &Vec<f64>| row.get(column).map_or(0.0, |value| value.abs());
        let (pivot, _) = left
            .iter()
            .enumerate()
            .skip(column)
            .max_by(|(_, one), (_, two)| size_at(one).total_cmp(&size_at(two)))?;
        let largest = left.iter().flatten().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        left.swap(column, pivot);
        right.swap(column, pivot);
        let divisor = *left.get(column)?.get(column)?;
        if divisor.abs() <= WHOLE * largest || !divisor.is_finite() {
            return None;
        }
        let (pivot_left, pivot_right) = (left.get(column)?.clone(), right.get(column)?.clone());
        for row in 0..size {
            let factor = left.get(row)?.get(column)? / divisor;
            let this = row == column;
            for (matrix, pivot) in [(&mut left, &pivot_left), (&mut right, &pivot_right)] {
                for (value, pivot) in matrix.get_mut(row)?.iter_mut().zip(pivot) {
                    *value = if this { *pivot / divisor } else { *value - factor * pivot };
                }
            }
        }
    }
    for value in right.iter_mut().flatten() {
        if (*value - libm::round(*value)).abs() < 1e-12 {
            *value = libm::round(*value);
        }
    }
    Some(right)
}

/// The least whole turn of each revolute joint, with what it carries along, in an order such that a joint comes before
/// those that it carries. Of held rows that only come back for a turn of several joints together, none is found.
pub(super) fn windings(rows: &[Row], joints: &[usize], inverse: &[Vec<f64>]) -> Vec<Winding> {
    let revolute = |joint: usize| {
        joints
            .get(joint)
            .and_then(|index| rows.get(*index))
            .is_some_and(|row| row.kind == JointKind::Revolute)
    };
    let mut found: Vec<Winding> = (0..joints.len())
        .filter(|joint| revolute(*joint))
        .filter_map(|joint| winding(rows, joint, inverse))
        .collect();
    let mut ordered = Vec::new();
    while !found.is_empty() {
        let carried = |joint: usize| found.iter().any(|other| other.carries.iter().any(|(k, _)| *k == joint));
        // In a ring of couplings there is no such order; then the first one goes first.
        let next = found.iter().position(|winding| !carried(winding.joint)).unwrap_or(0);
        ordered.push(found.remove(next));
    }
    without_whole_turns(&ordered)
}

/// The same windings with as little carried as can be: whole turns of the joints carried are windings of their own.
fn without_whole_turns(ordered: &[Winding]) -> Vec<Winding> {
    let mut reduced = Vec::new();
    for (index, winding) in ordered.iter().enumerate() {
        let mut carries: std::collections::BTreeMap<usize, f64> = winding.carries.iter().copied().collect();
        for other in ordered.iter().skip(index + 1) {
            let moves = carries.get(&other.joint).copied().unwrap_or(0.0) / other.turn;
            // Half a turn is carried forwards rather than backwards.
            let whole = libm::ceil(moves - 0.5 - WHOLE);
            if whole == 0.0 {
                continue;
            }
            *carries.entry(other.joint).or_insert(0.0) -= whole * other.turn;
            for (joint, by) in &other.carries {
                *carries.entry(*joint).or_insert(0.0) -= whole * by;
            }
        }
        let carries = carries.into_iter().filter(|(_, by)| by.abs() > WHOLE).collect();
        reduced.push(Winding { carries, ..winding.clone() });
    }
    reduced
}

fn winding(rows: &[Row], joint: usize, inverse: &[Vec<f64>]) -> Option<Winding> {
    // What one turn of this joint's theta is in all joint variables, every other own theta standing still.
    let turn: Vec<f64> = inverse.iter().map(|row| row.get(joint).copied().unwrap_or(0.0)).collect();
    let held: Vec<(JointKind, f64)> = rows
        .iter()
        .filter(|row| row.variable.is_none() && !row.terms.is_empty())
        .map(|row| (row.kind, row.terms.iter().map(|(k, c)| c * turn.get(*k).copied().unwrap_or(0.0)).sum()))
        .collect();
    let turns = (1..=MOST_TURNS).map(f64::from).find(|turns| {
        held.iter().all(|(kind, moves)| match kind {
            JointKind::Revolute => (moves * turns - libm::round(moves * turns)).abs() < WHOLE,
            JointKind::Prismatic => moves.abs() < WHOLE,
        })
    })?;
    let own = turn.get(joint).copied().filter(|own| *own != 0.0)?;
    let sign = own.signum();
    let carries = turn
        .iter()
        .enumerate()
        .filter(|(k, moves)| *k != joint && moves.abs() > WHOLE)
        .map(|(k, moves)| (k, moves * turns * sign * TAU))
        .collect();
    Some(Winding { joint, turn: own.abs() * turns * TAU, carries })
}
