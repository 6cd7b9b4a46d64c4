//! The joints of the arm.

use dh_codegen::model::{JointKind, Model, Row};

/// How many joints of which kind, and their names.
pub(super) fn written(model: &Model) -> String {
    let rows: Vec<&Row> = model.joints.iter().filter_map(|row| model.rows.get(*row)).collect();
    let names: Vec<String> = rows.iter().map(|row| crate::text::clean(&row.name)).collect();
    let sliding = rows.iter().filter(|row| row.kind == JointKind::Prismatic).count();
    let kinds = match (rows.len() - sliding, sliding) {
        (turning, 0) => format!("{turning} revolute"),
        (0, sliding) => format!("{sliding} prismatic"),
        (turning, sliding) => format!("{turning} revolute, {sliding} prismatic"),
    };
    let others = model.rows.iter().filter(|row| row.variable.is_none());
    let (following, held): (Vec<&Row>, Vec<&Row>) = others.partition(|row| !row.terms.is_empty());
    let counted = |rows: &[&Row], what| match rows.len() {
        0 => String::new(),
        count => format!(", {count} {what}"),
    };
    let (held, following) = (counted(&held, "held"), counted(&following, "following others"));
    format!("{kinds}{held}{following} ({})", names.join(" "))
}
