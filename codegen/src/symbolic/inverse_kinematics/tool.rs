//! The tool frame of a candidate, from the sines and cosines that its steps found.
//!
//! It tells true roots from false ones, and how far a solution is from its target; nothing of it needs another sine.

use super::unknowns::Unknowns;
use super::{Linear, Stage, StageEquation};
use crate::model::{JointKind, Model};
use crate::symbolic::angle::{AngleForm, Turn};
use crate::symbolic::chain::{self, Variable};
use crate::symbolic::expression::{Arena, Expr, Node};
use crate::symbolic::{forward_kinematics, transform};
use std::collections::{BTreeMap, HashMap};

/// Entries of the tool frame, as [`forward_kinematics::entries`] has them. `rows` are the rows' variables in terms of the
/// roots, constants aside.
///
/// The chain is multiplied from both ends, at the place that leaves the least to be done, counting what depends on the
/// last roots once for every branch and what depends on the first ones alone only as often as these occur.
pub(super) fn entries(
    arena: &mut Arena,
    model: &Model,
    unknowns: &Unknowns,
    rows: &[Linear],
    stages: &[Stage],
) -> Vec<Expr> {
    let chain = chain::of_variables(arena, model, true, |arena, row| {
        let (form, linear) = (unknowns.rows.get(row)?, rows.get(row)?);
        let mut terms = linear.terms.clone();
        terms.sort_by_key(|(stage, _)| *stage);
        Some(match model.rows.get(row)?.kind {
            JointKind::Revolute => {
                let (fifteenths, rest) = form.offset.split();
                let turn = Turn { fifteenths: fifteenths.rem_euclid(24), rest };
                Variable::Angle(AngleForm { terms, turn })
            }
            JointKind::Prismatic => Variable::Slide(slide(arena, row, &terms, form.offset.value(), stages)),
        })
    });
    let mut best: Option<(usize, Vec<Expr>)> = None;
    for split in forward_kinematics::splits(&chain) {
        let rest = forward_kinematics::suffixes(arena, &chain, split)
            .first()
            .map_or(chain.tip, |suffix| suffix.tool);
        let prefix = forward_kinematics::prefix(arena, &chain, split);
        let entries = forward_kinematics::entries(&transform::compose(arena, &prefix, &rest));
        let cost = cost(arena, &entries, stages);
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, entries));
        }
    }
    best.map(|(_, entries)| entries).unwrap_or_default()
}

/// The d of a row in terms of the slides that were found.
fn slide(arena: &mut Arena, row: usize, terms: &[(usize, f64)], constant: f64, stages: &[Stage]) -> Expr {
    let at_zero = format!("d{}", row + 1);
    let mut sum =
        arena.parameter(&format!("{at_zero}_0"), constant, 1, &format!("{at_zero}, its variable part aside"));
    for (stage, factor) in terms {
        let Some(root) = stages.get(*stage).and_then(|stage| stage.slide) else { continue };
        let term = match *factor {
            1.0 => root,
            -1.0 => arena.neg(root),
            factor => {
                let factor = arena.parameter(&format!("f{}", row + 1), factor, 0, "by which the row follows");
                arena.mul(factor, root)
            }
        };
        sum = arena.add(term, sum);
    }
    sum
}

/// Products and sums, each as often as it is computed.
fn cost(arena: &Arena, entries: &[Expr], stages: &[Stage]) -> usize {
    let slides: BTreeMap<Expr, usize> =
        stages.iter().enumerate().filter_map(|(index, stage)| Some((stage.slide?, index + 1))).collect();
    let mut times = vec![1];
    for stage in stages {
        let roots = match stage.equation {
            StageEquation::TrigPair(..) | StageEquation::Linear(_) => 1,
            StageEquation::Trig(_) | StageEquation::TrigUnit(..) | StageEquation::Quadratic(_) => 2,
        };
        times.push(times.last().copied().unwrap_or(1) * roots);
    }
    let mut levels = HashMap::new();
    for entry in entries {
        level(arena, *entry, &slides, &mut levels);
    }
    let computed = levels
        .iter()
        .filter(|(x, _)| matches!(arena.node(**x), Node::Add(..) | Node::Mul(..)) && !arena.is_constant(**x));
    computed.map(|(_, level)| times.get(*level).copied().unwrap_or(1)).sum()
}

/// How many roots must be known before an expression can be computed.
fn level(arena: &Arena, x: Expr, slides: &BTreeMap<Expr, usize>, levels: &mut HashMap<Expr, usize>) -> usize {
    if let Some(known) = levels.get(&x) {
        return *known;
    }
    let found = match arena.node(x) {
        Node::Number(_) => 0,
        Node::Leaf(_) => slides.get(&x).copied().unwrap_or(0),
        Node::Sin(index) | Node::Cos(index) => {
            let form = arena.angle_at(index).map(|(_, form)| form);
            form.and_then(|form| form.terms.iter().map(|(stage, _)| stage + 1).max()).unwrap_or(0)
        }
        Node::Neg(a) => level(arena, a, slides, levels),
        Node::Add(a, b) | Node::Mul(a, b) => {
            let first = level(arena, a, slides, levels);
            first.max(level(arena, b, slides, levels))
        }
    };
    levels.insert(x, found);
    found
}
