//! Words for the signs of steps with two roots: which part the joint that a step solves for plays in its problem.

use super::Stage;
use crate::model::{JointKind, Model, Target};
use dh_core::{BranchBit, BranchWord};

/// The steps with two roots, in order, with the word for each.
///
/// Of the joints that a problem solves for, the first ones bring the tool (or the wrist) to its place, as many as it has
/// coordinates: the first of these is the shoulder's, the later the elbow's. Those behind turn the wrist. An arm that was
/// solved from its tip is the same the other way round. A word that two steps would share, or a slide would get, says
/// nothing: then it is the joint's own.
pub(super) fn bits(model: &Model, target: Target, stages: &[Stage], from_tip: bool) -> Vec<BranchBit> {
    let solved = stages.iter().fold(0, |rows, stage| rows | stage.rows);
    let mut rows: Vec<usize> = (0..model.rows.len()).filter(|row| solved >> row & 1 == 1).collect();
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
    for (place, bit) in &mut bits {
        let turns = model.rows.get(bit.row).is_some_and(|row| row.kind == JointKind::Revolute);
        bit.word = match *place {
            _ if !turns => BranchWord::Joint,
            place if place >= placing => behind,
            0 => first,
            _ => BranchWord::Elbow,
        };
    }
    let bits: Vec<BranchBit> = bits.into_iter().map(|(_, bit)| bit).collect();
    let shared = |bit: &BranchBit| bits.iter().filter(|other| other.word == bit.word).count() > 1;
    bits.iter()
        .map(|bit| if shared(bit) { BranchBit { word: BranchWord::Joint, ..*bit } } else { *bit })
        .collect()
}

/// How many coordinates of the tool's place a target prescribes.
fn coordinates(target: Target) -> usize {
    match target {
        Target::Pose | Target::Position | Target::PositionDirection | Target::PositionYaw => 3,
        Target::Xy | Target::XyYaw | Target::Ray => 2,
        Target::Rotation | Target::Direction | Target::Lookat => 0,
    }
}
