//! Joints by their names.

use super::{JointKind, Row};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, nearest, shortened};
use crate::table::Text;

/// The index of q of the joint that is named, or a diagnostic.
pub(super) fn variable(rows: &[Row], name: &Text, diagnostics: &mut Diagnostics) -> Option<usize> {
    let Some(row) = rows.iter().find(|row| row.name == name.value) else {
        diagnostics.push(unknown_joint(rows, name));
        return None;
    };
    if row.variable.is_none() {
        diagnostics.push(held(row, &name.value, name.span.clone()));
    }
    row.variable
}

fn unknown_joint(rows: &[Row], name: &Text) -> Diagnostic {
    let names = rows.iter().map(|row| row.name.as_str());
    let help = match nearest(&name.value, names.clone()) {
        Some(near) => format!("write `{near}`"),
        None => format!("the joints are {}", names.map(shortened).collect::<Vec<_>>().join(", ")),
    };
    Diagnostic::error(catalogue::UNKNOWN_JOINT, format!("there is no joint `{}`", shortened(&name.value)))
        .at(name.span.clone(), "")
        .help(help)
}

/// Something refers to the q of a held joint.
pub(super) fn held(row: &Row, name: &str, span: crate::table::Span) -> Diagnostic {
    let variable = if row.kind == JointKind::Revolute { "theta" } else { "d" };
    Diagnostic::error(
        catalogue::HELD_JOINT,
        format!("`{}` is held by `fixed`: it has a {variable}, but no q", shortened(name)),
    )
    .at(span, "")
    .help("leave it out, or leave out `fixed`")
}
