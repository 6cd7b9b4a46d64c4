//! Expressions as the field writes them: `c1 (a2 c2 + a3 c23) - s1 d4`.

use super::expression::{Arena, Expr, Node};

/// The expression, fully written out.
pub fn expression(arena: &Arena, x: Expr) -> String {
    written(arena, x, Place::Sum, false)
}

/// What surrounds an expression, and so whether it needs parentheses.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Sum,
    Subtracted,
    Factor,
}

/// Written out; `names` says whether parts that have a name are written by it.
fn written(arena: &Arena, x: Expr, place: Place, names: bool) -> String {
    let part =
        |x: Expr, place: Place| if names { named(arena, x, place) } else { written(arena, x, place, false) };
    match arena.node(x) {
        Node::Number(number) => {
            let text = number.to_string();
            if place == Place::Factor && text.contains([' ', '+', '-']) { format!("({text})") } else { text }
        }
        Node::Leaf(index) => arena.leaf_at(index).map_or_else(String::new, |(name, _)| name.to_string()),
        Node::Sin(index) => {
            arena.angle_at(index).map_or_else(String::new, |(suffix, _)| format!("s{suffix}"))
        }
        Node::Cos(index) => {
            arena.angle_at(index).map_or_else(String::new, |(suffix, _)| format!("c{suffix}"))
        }
        Node::Neg(inner) => {
            let text = format!("-{}", part(inner, Place::Subtracted));
            if place == Place::Sum { text } else { format!("({text})") }
        }
        Node::Add(a, b) => {
            let first = part(a, Place::Sum);
            let text = match arena.node(b) {
                Node::Neg(inner) => format!("{first} - {}", part(inner, Place::Subtracted)),
                _ => format!("{first} + {}", part(b, Place::Sum)),
            };
            if place == Place::Sum { text } else { format!("({text})") }
        }
        Node::Mul(a, b) => product(arena, &[a, b], names),
    }
}

/// Factors in a row: numbers first, then constants, equal ones as powers.
fn product(arena: &Arena, factors: &[Expr], names: bool) -> String {
    let mut flat: Vec<Expr> = Vec::new();
    let mut open: Vec<Expr> = factors.iter().rev().copied().collect();
    while let Some(x) = open.pop() {
        match arena.node(x) {
            Node::Mul(a, b) if !(names && arena.name_of(x).is_some()) => open.extend([b, a]),
            _ => flat.push(x),
        }
    }
    flat.sort_by_key(|x| match arena.node(*x) {
        Node::Number(_) => 0,
        _ if arena.is_constant(*x) => 1,
        _ => 2,
    });
    let mut parts: Vec<(Expr, usize)> = Vec::new();
    for x in flat {
        match parts.iter_mut().find(|(known, _)| *known == x) {
            Some((_, power)) => *power += 1,
            None => parts.push((x, 1)),
        }
    }
    let part = |&(x, power): &(Expr, usize)| {
        let base =
            if names { named(arena, x, Place::Factor) } else { written(arena, x, Place::Factor, false) };
        if power == 1 { base } else { format!("{base}^{power}") }
    };
    parts.iter().map(part).collect::<Vec<_>>().join(" ")
}

/// Sum of coefficient * symbol, written with names for what has one; an empty symbol is a plain term.
pub fn combination(arena: &Arena, terms: &[(Expr, &str)]) -> String {
    let mut sum = String::new();
    for (coefficient, symbol) in terms.iter().filter(|(coefficient, _)| !arena.is_zero(*coefficient)) {
        let (positive, bare) = arena.split_sign(*coefficient);
        let one = matches!(arena.node(bare), Node::Number(number) if number == super::number::Number::ONE);
        let factor = named(arena, bare, if symbol.is_empty() { Place::Subtracted } else { Place::Factor });
        let term = match (one, symbol.is_empty()) {
            (true, false) => (*symbol).to_string(),
            (_, true) => factor,
            _ => format!("{factor} {symbol}"),
        };
        sum = match (sum.is_empty(), positive) {
            (true, true) => term,
            (true, false) => format!("-{term}"),
            (false, true) => format!("{sum} + {term}"),
            (false, false) => format!("{sum} - {term}"),
        };
    }
    if sum.is_empty() { "0".to_string() } else { sum }
}

/// The expression, named parts by their names.
pub fn abbreviated(arena: &Arena, x: Expr) -> String {
    named(arena, x, Place::Sum)
}

/// (name, definition) of all named parts of the expressions, those that others use first.
pub fn definitions(arena: &Arena, roots: &[Expr]) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for root in roots {
        define(arena, *root, &mut found);
    }
    found
}

fn define(arena: &Arena, x: Expr, found: &mut Vec<(String, String)>) {
    if let Node::Neg(a) = arena.node(x) {
        return define(arena, a, found);
    }
    if let Node::Add(a, b) | Node::Mul(a, b) = arena.node(x) {
        define(arena, a, found);
        define(arena, b, found);
        if let Some(name) = arena.name_of(x)
            && !found.iter().any(|(known, _)| known == name)
        {
            found.push((name.to_string(), written(arena, x, Place::Sum, true)));
        }
    }
}

fn named(arena: &Arena, x: Expr, place: Place) -> String {
    match arena.name_of(x) {
        Some(name) => name.to_string(),
        None => written(arena, x, place, true),
    }
}
