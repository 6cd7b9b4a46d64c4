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
    let held = model.rows.len() - rows.len();
    let held = if held == 0 { String::new() } else { format!(", {held} held") };
    format!("{kinds}{held} ({})", names.join(" "))
}
