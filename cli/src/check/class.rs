//! What kind of arm it is.

use dh_codegen::model::{Angle, Convention, JointKind, Model, Row};

/// How many joints of which kind, and their names.
pub(super) fn joints(model: &Model) -> String {
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

/// Runs of neighbouring rows whose axes are parallel, by the names of their joints.
pub(super) fn parallel(model: &Model) -> String {
    let mut runs: Vec<Vec<String>> = Vec::new();
    let mut continues = false;
    for (index, row) in model.rows.iter().enumerate() {
        if !continues {
            runs.push(Vec::new());
        }
        if let Some(run) = runs.last_mut().filter(|_| !row.terms.is_empty()) {
            run.push(crate::text::clean(&row.name));
        }
        continues = model.rows.get(index + 1).is_some_and(|next| keeps_direction(model, row, next));
    }
    let runs: Vec<String> = runs.iter().filter(|run| run.len() > 1).map(|run| run.join(" ")).collect();
    if runs.is_empty() { "none that are neighbours".to_owned() } else { runs.join(", ") }
}

/// Whether the axis of a row and that of the next are parallel, whatever the joints do.
fn keeps_direction(model: &Model, row: &Row, next: &Row) -> bool {
    let between = match model.convention {
        Convention::Standard => row,
        Convention::Modified => next,
    };
    half_turns(between.alpha) && half_turns(between.beta)
}

/// Whether an angle is exactly a multiple of 180 degrees.
fn half_turns(angle: Angle) -> bool {
    angle.fifteenths.is_some_and(|fifteenths| fifteenths % 12 == 0)
}
