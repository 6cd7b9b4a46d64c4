//! Expressions as the field writes them: `c1 (a2 c2 + a3 c23) - s1 d4`.

use super::expression::{Arena, Expr, Node};

/// The expression, fully written out.
pub fn expression(arena: &Arena, x: Expr) -> String {
    written(arena, x, Place::Sum)
}

/// What surrounds an expression, and so whether it needs parentheses.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Sum,
    Subtracted,
    Factor,
}

fn written(arena: &Arena, x: Expr, place: Place) -> String {
    match arena.node(x) {
        Node::Number(number) => {
            let text = number.to_string();
            if place == Place::Factor && text.contains([' ', '+', '-']) { format!("({text})") } else { text }
        }
        Node::Leaf(index) => arena.leaf_at(index).map_or_else(String::new, |(name, _)| name.to_string()),
        Node::Sin(index) => arena.angle_at(index).map_or_else(String::new, |(suffix, _)| format!("s{suffix}")),
        Node::Cos(index) => arena.angle_at(index).map_or_else(String::new, |(suffix, _)| format!("c{suffix}")),
        Node::Neg(inner) => {
            let text = format!("-{}", written(arena, inner, Place::Subtracted));
            if place == Place::Sum { text } else { format!("({text})") }
        }
        Node::Add(a, b) => {
            let first = written(arena, a, Place::Sum);
            let text = match arena.node(b) {
                Node::Neg(inner) => format!("{first} - {}", written(arena, inner, Place::Subtracted)),
                _ => format!("{first} + {}", written(arena, b, Place::Sum)),
            };
            if place == Place::Sum { text } else { format!("({text})") }
        }
        Node::Mul(a, b) => format!("{} {}", written(arena, a, Place::Factor), written(arena, b, Place::Factor)),
    }
}
