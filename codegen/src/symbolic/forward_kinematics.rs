//! Pose of the tool and of every row's frame.
//!
//! Axes that are parallel form a group, inside which positions lie in a plane and turns add up. A chain of groups can
//! be multiplied from the base, from the tip, or from both ends to somewhere in between; which is least work depends
//! on the arm, so all are tried and counted.

use super::chain::{self, Chain, Group, Joint};
use super::expression::{Arena, Expr};
use super::transform::{self, Mat3, Rigid, Vec3};
use crate::model::Model;
use crate::model::chain::Link;

/// What the walk from the tip leaves behind at one group, in the axes of the frame before the group.
#[derive(Debug, Clone)]
pub struct Suffix {
    /// The tool frame seen from before the group.
    pub tool: Rigid,
    /// For every joint of the group: the tool point seen from that joint's origin.
    pub arms: Vec<Vec3>,
}

/// The tool frame in the base frame, multiplied from both ends and joined before group `split`.
pub fn tool(arena: &mut Arena, chain: &Chain, split: usize) -> Rigid {
    let rest = suffixes(arena, chain, split).first().map_or(chain.tip, |suffix| suffix.tool);
    let prefix = prefix(arena, chain, split);
    let tool = transform::compose(arena, &prefix, &rest);
    name_frame(arena, &tool, "");
    tool
}

/// Chains of more groups than this are multiplied in few ways, since trying all takes longer than anybody waits.
pub const MANY_GROUPS: usize = 12;

/// Splits a chain can be multiplied at; of a long one, only its ends.
pub fn splits(chain: &Chain) -> impl Iterator<Item = usize> + use<> {
    let count = chain.groups.len();
    (0..=count).filter(move |split| count <= MANY_GROUPS || *split == 0 || *split == count)
}

/// The entries of a frame: r11 r12 r13 px r21 ...
pub fn entries(frame: &Rigid) -> Vec<Expr> {
    let rows = frame.rotation.iter().zip(frame.translation);
    rows.flat_map(|(row, p)| row.iter().copied().chain([p]).collect::<Vec<_>>()).collect()
}

/// From the tip to before group `split`: one suffix a group, in the order of the groups.
pub fn suffixes(arena: &mut Arena, chain: &Chain, split: usize) -> Vec<Suffix> {
    let mut rest = chain.tip;
    let mut found = Vec::new();
    for group in chain.groups.iter().skip(split).rev() {
        let suffix = group_suffix(arena, group, &rest);
        rest = transform::compose(arena, &group.before, &suffix.tool);
        found.push(suffix);
    }
    found.reverse();
    found
}

/// The frame before the first joint of group `split` in the base frame; behind all joints where there is no such
/// group.
pub fn prefix(arena: &mut Arena, chain: &Chain, split: usize) -> Rigid {
    let mut frame = transform::identity(arena);
    for (index, group) in chain.groups.iter().enumerate().take(split + 1) {
        frame = transform::compose(arena, &frame, &group.before);
        if index < split {
            frame = behind(arena, &frame, group, group.joints.len());
        }
    }
    frame
}

/// The frames of the base and of every row in the base frame, base first.
///
/// Joints are walked from the base; inside a group each frame is reached from the group's own, so that parallel axes
/// keep their merged angles.
pub fn frames(arena: &mut Arena, model: &Model) -> Vec<Rigid> {
    let chain = chain::build(arena, model, false);
    let plain = model.chain();
    let mut frames = Vec::new();
    let identity = transform::identity(arena);
    if let Some(link) = plain.links.first() {
        row_frames(arena, link, &identity, &mut frames);
    }
    let mut links = plain.links.iter().skip(1);
    for (index, group) in chain.groups.iter().enumerate() {
        let before = prefix(arena, &chain, index);
        for (count, joint) in group.joints.iter().enumerate() {
            let origin = behind(arena, &before, group, count);
            let turned = Rigid { rotation: turn_of(arena, joint), translation: joint.slide };
            let frame = joint_frame(arena, &before, &origin, &turned);
            if let Some(link) = links.next() {
                row_frames(arena, link, &frame, &mut frames);
            }
        }
    }
    frames.sort_by_key(|(row, _)| *row);
    frames.into_iter().map(|(_, frame)| frame).collect()
}

/// The frame just behind a joint: its origin moved by the joint's slide, its axes those of the turned frame.
fn joint_frame(arena: &mut Arena, before: &Rigid, origin: &Rigid, turned: &Rigid) -> Rigid {
    let moved = transform::apply(arena, &before.rotation, turned.translation);
    let translation = transform::add(arena, origin.translation, moved);
    Rigid { rotation: transform::product(arena, &before.rotation, &turned.rotation), translation }
}

/// The table's frames that stand in a link, from the frame where the link begins. The base is before row 0.
fn row_frames(arena: &mut Arena, link: &Link, start: &Rigid, found: &mut Vec<(Option<usize>, Rigid)>) {
    for mark in &link.frames {
        let elements = link.elements.get(..mark.after).unwrap_or(&link.elements);
        let step = chain::rigid(arena, elements);
        let mut frame = transform::compose(arena, start, &step);
        if mark.along_z != 0.0 {
            let row = mark.row.map_or(0, |row| row + 1);
            let zero = arena.zero();
            let along = arena.parameter(
                &format!("along{row}"),
                mark.along_z,
                1,
                "from the recentred origin to the table's",
            );
            let moved = transform::apply(arena, &frame.rotation, [zero, zero, along]);
            frame.translation = transform::add(arena, frame.translation, moved);
        }
        found.push((mark.row, frame));
    }
}

/// The frame behind the first `count` joints of a group (slide and link offset of the last one included), from the
/// frame before the group.
pub fn behind(arena: &mut Arena, before: &Rigid, group: &Group, count: usize) -> Rigid {
    let origin = origin_behind(arena, group, count);
    let moved = transform::apply(arena, &before.rotation, origin);
    let translation = transform::add(arena, moved, before.translation);
    let rotation = match count.checked_sub(1).and_then(|last| group.joints.get(last)) {
        Some(joint) => {
            let turn = turn_of(arena, joint);
            transform::product(arena, &before.rotation, &turn)
        }
        None => before.rotation,
    };
    Rigid { rotation, translation }
}

/// Where the origin is behind the first `count` joints of a group, in the axes of the frame before the group.
pub fn origin_behind(arena: &mut Arena, group: &Group, count: usize) -> Vec3 {
    let mut sum = transform::zero_vector(arena);
    for (run, offset) in runs(arena, group, 0, count) {
        let term = transform::turn(arena, run, offset);
        sum = transform::add(arena, sum, term);
    }
    sum
}

/// The rotation of a joint's outgoing frame in the axes of the frame before its group: Rz(turn), or Rz(turn) Rx(pi).
fn turn_of(arena: &mut Arena, joint: &Joint) -> Mat3 {
    let angle = arena.sin_cos(&joint.suffix, &joint.turn);
    let rotation = transform::rotation_about(arena, 2, angle);
    if !joint.flipped {
        return rotation;
    }
    rotation.map(|row| transform::flip(arena, row))
}

fn group_suffix(arena: &mut Arena, group: &Group, rest: &Rigid) -> Suffix {
    let last = group.joints.last();
    let (angle, flipped) = match last {
        Some(joint) => (arena.sin_cos(&joint.suffix, &joint.turn), joint.flipped),
        None => ((arena.zero(), arena.one()), false),
    };
    let oriented = |arena: &mut Arena, v: Vec3| if flipped { transform::flip(arena, v) } else { v };
    let rotation = {
        let columns = transform::transpose(&rest.rotation);
        let turned = columns.map(|column| {
            let column = oriented(arena, column);
            transform::turn(arena, angle, column)
        });
        transform::transpose(&turned)
    };
    // The last joint's own slide and what lies behind it turn by the same angle.
    let mut local = oriented(arena, rest.translation);
    if let Some(joint) = last {
        local = transform::add(arena, local, joint.offset);
    }
    let mut arm = transform::turn(arena, angle, local);
    let mut arms = vec![arm];
    for joint in group.joints.iter().rev().skip(1) {
        let angle = arena.sin_cos(&joint.suffix, &joint.turn);
        let term = transform::turn(arena, angle, joint.offset);
        arm = transform::add(arena, arm, term);
        arms.push(arm);
    }
    arms.reverse();
    let tool = Rigid { rotation, translation: arm };
    if let Some(first) = group.joints.first().map(|joint| joint.row).filter(|row| *row > 0) {
        name_frame(arena, &tool, &first.to_string());
        for (joint, arm) in group.joints.iter().zip(&arms).skip(1) {
            name_point(arena, *arm, &format!("{first}_{}", joint.row));
        }
    }
    Suffix { tool, arms }
}

/// Offsets of the joints `from..to` of a group, those of equal turn added up before they are turned.
fn runs(arena: &mut Arena, group: &Group, from: usize, to: usize) -> Vec<((Expr, Expr), Vec3)> {
    let mut runs: Vec<((Expr, Expr), Vec3)> = Vec::new();
    for joint in group.joints.iter().take(to).skip(from) {
        let angle = arena.sin_cos(&joint.suffix, &joint.turn);
        match runs.last_mut().filter(|(known, _)| *known == angle) {
            Some((_, offset)) => *offset = transform::add(arena, *offset, joint.offset),
            None => runs.push((angle, joint.offset)),
        }
    }
    runs
}

/// Names the entries of the tool frame as seen from an earlier one: `r11_3`, `x3`; without a number, from the base.
fn name_frame(arena: &mut Arena, frame: &Rigid, name: &str) {
    let separator = if name.is_empty() { "" } else { "_" };
    for (i, row) in frame.rotation.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            arena.name(*entry, &format!("r{}{}{separator}{name}", i + 1, j + 1));
        }
    }
    name_point(arena, frame.translation, name);
}

/// Names the coordinates of the tool point: `x3`, in frame 3; `x1_3`, from the origin of frame 3 in the axes of
/// frame 1; `px`, in the base frame.
fn name_point(arena: &mut Arena, point: Vec3, name: &str) {
    for (axis, entry) in ["x", "y", "z"].iter().zip(point) {
        let name = if name.is_empty() { format!("p{axis}") } else { format!("{axis}{name}") };
        arena.name(entry, &name);
    }
}
