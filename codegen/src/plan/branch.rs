//! Words for the signs of steps with two roots: which part the joint that a step solves for plays in its problem.

use super::Stage;
use crate::model::{JointKind, Model, Target};
use crate::symbolic::inverse_kinematics::Begins;
use dh_core::{BranchBit, BranchWord};

/// The steps with two roots, with the word for each, in the order of the rows.
///
/// Of the joints that a problem solves for, the first ones bring the tool (or the wrist) to its place, as many as it has
/// coordinates: the first of these with two roots is the shoulder's, the last the elbow's. Those behind turn the wrist. An
/// arm that was solved from its tip is the same the other way round. A word that two steps would share, or a slide would get, says
/// nothing: then it is the joint's own.
///
/// Where the target prescribes more than the joints can do, there are none: of the equations, more than the joints, some are
/// singular where the arm is not.
pub(super) fn bits(model: &Model, target: Target, stages: &[Stage], begins: Begins) -> Vec<BranchBit> {
    let solved = stages.iter().fold(0, |rows, stage| rows | stage.rows);
    let mut rows: Vec<usize> = (0..model.rows.len()).filter(|row| solved >> row & 1 == 1).collect();
    if rows.len() < target.rows() {
        return Vec::new();
    }
    let from_tip = begins == Begins::Tip;
    if from_tip {
        rows.reverse();
    }
    let two_roots = stages.iter().enumerate().filter(|(_, stage)| stage.plus.is_some());
    let mut bits: Vec<(usize, BranchBit)> = two_roots
        .map(|(step, stage)| {
            // A sum of joints is about the one that is farthest along.
            let place = rows.iter().rposition(|row| stage.rows >> row & 1 == 1).unwrap_or(0);
            let row = rows.get(place).copied().unwrap_or(0);
            (place, BranchBit::new(u8::try_from(step).unwrap_or(u8::MAX), BranchWord::Joint, row))
        })
        .collect();
    let placing = coordinates(target);
    let [first, behind] = if from_tip {
        [BranchWord::Wrist, BranchWord::Shoulder]
    } else {
        [BranchWord::Shoulder, BranchWord::Wrist]
    };
    let turns = |row: &usize| model.rows.get(*row).is_some_and(|row| row.kind == JointKind::Revolute);
    // Two joints that turn and place the tool make an elbow, whichever joint's step has its roots.
    let bends = rows.iter().take(placing).filter(|row| turns(row)).count() > 1;
    let turning = bits.iter().filter(|(_, bit)| turns(&bit.row)).map(|(place, _)| *place);
    let mut places: Vec<usize> = turning.collect();
    places.sort_unstable();
    let placed = places.partition_point(|place| *place < placing);
    let (shoulder, elbow) = match places.get(..placed).unwrap_or(&[]) {
        [] if bends => (None, places.first().copied()),
        [only] if bends => (None, Some(*only)),
        [] => (None, None),
        [only] => (Some(*only), None),
        [nearest, .., last] => (Some(*nearest), Some(*last)),
    };
    for (place, bit) in &mut bits {
        let own = Some(*place);
        bit.word = if !turns(&bit.row) || begins == Begins::Between {
            BranchWord::Joint
        } else if own == elbow {
            BranchWord::Elbow
        } else if own == shoulder {
            first
        } else if *place >= placing {
            behind
        } else {
            BranchWord::Joint
        };
    }
    let bits: Vec<BranchBit> = bits.into_iter().map(|(_, bit)| bit).collect();
    let shared = |bit: &BranchBit| bits.iter().filter(|other| other.word == bit.word).count() > 1;
    let mut bits: Vec<BranchBit> = bits
        .iter()
        .map(|bit| if shared(bit) { BranchBit { word: BranchWord::Joint, ..*bit } } else { *bit })
        .collect();
    bits.sort_by_key(|bit| bit.row);
    bits
}

/// How many coordinates of the tool's place a target prescribes.
fn coordinates(target: Target) -> usize {
    match target {
        Target::Pose | Target::Position | Target::PositionDirection | Target::PositionYaw => 3,
        Target::Xy | Target::XyYaw | Target::Ray => 2,
        Target::Rotation | Target::Direction | Target::Lookat => 0,
    }
}
