//! The tool frame of a candidate, from the sines and cosines that its steps found.
//!
//! It tells true roots from false ones, and how far a solution is from its target; nothing of it needs another sine.

use super::unknowns::Unknowns;
use super::{Linear, Stage};
use crate::model::{JointKind, Model};
use crate::symbolic::angle::{AngleForm, Turn};
use crate::symbolic::chain::{self, Variable};
use crate::symbolic::expression::{Arena, Expr, Leaf, Node};
use crate::symbolic::{forward_kinematics, transform};
use std::collections::{BTreeMap, HashMap};

/// Entries of the tool frame, as [`forward_kinematics::entries`] has them. `rows` are the rows' variables in terms of what
/// is given and of the roots, constants aside.
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
    let given = unknowns.given().count();
    let chain = chain::of_variables(arena, model, true, |arena, row| {
        let (form, linear) = (unknowns.rows.get(row)?, rows.get(row)?);
        let constant = unknowns.constant(form);
        let mut terms = linear.terms.clone();
        terms.sort_by_key(|(variable, _)| *variable);
        Some(match model.rows.get(row)?.kind {
            JointKind::Revolute => {
                let (fifteenths, rest) = constant.split();
                let turn = Turn { fifteenths: fifteenths.rem_euclid(24), rest };
                Variable::Angle(AngleForm { terms, turn })
            }
            JointKind::Prismatic => {
                Variable::Slide(slide(arena, row, &terms, constant.value(), given, stages))
            }
        })
    });
    let mut best: Option<(usize, Vec<Expr>)> = None;
    for split in forward_kinematics::splits(&chain) {
        let rest = forward_kinematics::suffixes(arena, &chain, split)
            .first()
            .map_or(chain.tip, |suffix| suffix.tool);
        let prefix = forward_kinematics::prefix(arena, &chain, split);
        let entries = forward_kinematics::entries(&transform::compose(arena, &prefix, &rest));
        let cost = cost(arena, &entries, given, stages);
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, entries));
        }
    }
    best.map(|(_, entries)| entries).unwrap_or_default()
}

/// The d of a row in terms of the slides that are given and of those that were found.
fn slide(
    arena: &mut Arena,
    row: usize,
    terms: &[(usize, f64)],
    constant: f64,
    given: usize,
    stages: &[Stage],
) -> Expr {
    let at_zero = format!("d{}", row + 1);
    let mut sum =
        arena.parameter(&format!("{at_zero}_0"), constant, 1, &format!("{at_zero}, its variable part aside"));
    for (variable, factor) in terms {
        let found = variable.checked_sub(given).and_then(|stage| stages.get(stage));
        let root = if *variable < given {
            // The joint as it is given.
            arena.leaf(
                &format!("g{}", variable + 1),
                Leaf::Slide { terms: vec![(*variable, 1.0)], constant: 0.0 },
            )
        } else if let Some(root) = found.and_then(|stage| stage.slide) {
            root
        } else {
            continue;
        };
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
fn cost(arena: &Arena, entries: &[Expr], given: usize, stages: &[Stage]) -> usize {
    let slides: BTreeMap<Expr, usize> =
        stages.iter().enumerate().filter_map(|(index, stage)| Some((stage.slide?, index + 1))).collect();
    let mut times = vec![1];
    for stage in stages {
        times.push(times.last().copied().unwrap_or(1) * stage.equation.roots());
    }
    let mut levels = HashMap::new();
    for entry in entries {
        level(arena, *entry, given, &slides, &mut levels);
    }
    let computed = levels
        .iter()
        .filter(|(x, _)| matches!(arena.node(**x), Node::Add(..) | Node::Mul(..)) && !arena.is_constant(**x));
    computed.map(|(_, level)| times.get(*level).copied().unwrap_or(1)).sum()
}

/// How many roots must be known before an expression can be computed.
fn level(
    arena: &Arena,
    x: Expr,
    given: usize,
    slides: &BTreeMap<Expr, usize>,
    levels: &mut HashMap<Expr, usize>,
) -> usize {
    if let Some(known) = levels.get(&x) {
        return *known;
    }
    let found = match arena.node(x) {
        Node::Number(_) => 0,
        Node::Leaf(_) => slides.get(&x).copied().unwrap_or(0),
        Node::Sin(index) | Node::Cos(index) => {
            let form = arena.angle_at(index).map(|(_, form)| form);
            let variables = form.into_iter().flat_map(|form| &form.terms);
            variables.map(|(variable, _)| (variable + 1).saturating_sub(given)).max().unwrap_or(0)
        }
        Node::Neg(a) => level(arena, a, given, slides, levels),
        Node::Add(a, b) | Node::Mul(a, b) => {
            let first = level(arena, a, given, slides, levels);
            first.max(level(arena, b, given, slides, levels))
        }
    };
    levels.insert(x, found);
    found
}
