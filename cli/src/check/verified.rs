//! What was verified, and with which figures.

use crate::robot::Robot;
use crate::text::{clean, columns, small};
use dh_codegen::plan::{Agreement, Function};
use dh_codegen::verify::{FunctionReport, InverseReport};

/// A line a function.
pub(super) fn written(robot: &Robot) -> String {
    let mut rows = vec![["function", "poses", "greatest errors", ""].map(str::to_owned)];
    rows.extend(robot.output.report.functions.iter().map(row));
    let second: Vec<String> =
        robot.output.plan.functions.iter().filter_map(|f| agreement(robot, f)).collect();
    let title = "verified against products of the table's matrices";
    format!("\n  {title}\n{}{}", columns("    ", &rows), second.concat())
}

/// What another method says of a function that was kept.
fn agreement(robot: &Robot, function: &Function) -> Option<String> {
    let Agreement { method, poses, agreed, missing } = function.agreement.as_ref()?;
    let missing =
        if *missing == 0 { String::new() } else { format!("; it finds {missing} that are missing") };
    let report = robot.output.report.functions.iter();
    let report = report.rev().find(|report| report.kind == function.kind && report.failure.is_none())?;
    let name = &report.name;
    let method = clean(method);
    Some(format!(
        "    {name}: another method ({method}) finds the same solutions at {agreed} of {poses} random poses{missing}\n"
    ))
}

fn row(function: &FunctionReport) -> [String; 4] {
    let errors = format!("{} m, {} rad", small(function.position_error), small(function.rotation_error));
    let findings = match (&function.failure, &function.inverse) {
        (Some(failure), _) => format!("LEFT OUT: {}", clean(failure)),
        (None, Some(inverse)) => solutions(inverse),
        (None, None) => String::new(),
    };
    [function.name.clone(), function.poses.to_string(), errors, findings]
}

/// Which poses were found again, and how many solutions they had.
fn solutions(inverse: &InverseReport) -> String {
    let counts = inverse.solutions.iter().enumerate().filter(|(_, poses)| **poses > 0);
    let counts: Vec<String> = counts.map(|(solutions, poses)| format!("{solutions} at {poses}")).collect();
    let InverseReport { originals, originals_found, singular, arm_angles, .. } = inverse;
    let singular = if *singular == 0 { String::new() } else { format!(" ({singular} more were singular)") };
    let arm_angles =
        if *arm_angles == 0 { String::new() } else { format!(", {arm_angles} of them by their arm angle") };
    format!(
        "found {originals_found} of {originals} poses again{singular}{arm_angles}; solutions: {}",
        counts.join(", ")
    )
}
