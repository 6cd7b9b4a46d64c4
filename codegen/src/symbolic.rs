//! Stage 3: model -> equations. Expressions are hash-consed and never changed.
//!
//! `number`, `angle` and `expression` are the algebra; `transform` and `chain` write the robot in it;
//! `forward_kinematics`, `jacobian` and `inverse_kinematics` derive the equations; `redundancy` says which joint to give
//! where there is one too many.

mod addition;
pub mod angle;
pub mod chain;
pub mod expression;
pub mod forward_kinematics;
pub mod inverse_kinematics;
pub mod jacobian;
pub mod number;
pub mod redundancy;
pub mod text;
pub mod transform;

use crate::model::Model;
use expression::{Arena, Expr};
use transform::Rigid;

/// Entries of one function's result, with the expressions that they are made of.
#[derive(Debug, Clone)]
pub struct Equations {
    /// All expressions.
    pub arena: Arena,
    /// The results, in the order of the function's outputs.
    pub outputs: Vec<Expr>,
}

/// The pose of the tool (or, without the tool, of the flange): r11 r12 r13 px r21 ...
pub fn pose(model: &Model, with_tool: bool) -> Equations {
    least(model, with_tool, |_, _, tool| forward_kinematics::entries(tool))
}

/// The geometric Jacobian, column after column.
pub fn jacobian(model: &Model) -> Equations {
    least(model, true, |arena, chain, tool| jacobian::columns(arena, chain, model, tool, &[]).concat())
}

/// Pose, then Jacobian.
pub fn pose_and_jacobian(model: &Model) -> Equations {
    least(model, true, |arena, chain, tool| {
        let mut outputs = forward_kinematics::entries(tool);
        let columns = jacobian::columns(arena, chain, model, tool, &outputs);
        outputs.extend(columns.concat());
        outputs
    })
}

/// The frames of the base and of every row, 12 entries each.
pub fn frames(model: &Model) -> Equations {
    let mut arena = Arena::default();
    let frames = forward_kinematics::frames(&mut arena, model);
    let outputs = frames.iter().flat_map(forward_kinematics::entries).collect();
    Equations { arena, outputs }
}

/// Multiplies the chain from both ends, at the place that leaves the fewest operations.
fn least(
    model: &Model,
    with_tool: bool,
    outputs: impl Fn(&mut Arena, &chain::Chain, &Rigid) -> Vec<Expr>,
) -> Equations {
    let mut arena = Arena::default();
    let chain = chain::build(&mut arena, model, with_tool);
    let mut best: Option<(usize, Vec<Expr>)> = None;
    for split in forward_kinematics::splits(&chain) {
        let tool = forward_kinematics::tool(&mut arena, &chain, split);
        let outputs = outputs(&mut arena, &chain, &tool);
        let cost = arena.operation_count(&outputs);
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, outputs));
        }
    }
    Equations { arena, outputs: best.map(|(_, outputs)| outputs).unwrap_or_default() }
}

#[cfg(test)]
mod fixtures;
#[cfg(test)]
mod tests;
