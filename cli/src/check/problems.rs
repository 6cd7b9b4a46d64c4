//! How every inverse problem is solved, or why it is not.

use crate::robot::Robot;
use crate::text::{clean, columns};
use dh_codegen::model::Target;
use dh_codegen::plan::{Equation, Function, FunctionKind, Step};
use dh_core::FULL_POSE;

/// The full pose, then the problems of the table.
pub(super) fn written(robot: &Robot) -> String {
    let problems = robot.model().problems.iter().enumerate();
    let names = [(None, FULL_POSE)].into_iter().chain(problems.map(|(i, p)| (Some(i), p.name.as_str())));
    names.map(|(index, name)| problem(robot, index, name)).collect()
}

fn problem(robot: &Robot, index: Option<usize>, name: &str) -> String {
    let kind = FunctionKind::Inverse(index);
    let function = robot.output.plan.functions.iter().find(|function| function.kind == kind);
    let title = match robot.model().problems.get(index.unwrap_or(usize::MAX)) {
        Some(problem) => format!("\n  inverse problem {name} ({})", target(problem.target)),
        None => format!("\n  inverse problem {name}"),
    };
    let Some(function) = function else {
        return format!("{title}\n    {}\n", reason(robot, index));
    };
    let rows: Vec<[String; 4]> = function
        .stages
        .iter()
        .zip(roots(&function.steps))
        .map(|(stage, roots)| {
            let plural = if roots == 1 { "" } else { "s" };
            [
                stage.unknown.clone(),
                format!("{roots} root{plural}"),
                stage.equation.clone(),
                format!("[{}]", stage.origin),
            ]
        })
        .collect();
    format!(
        "{title}: up to {} solutions{}\n{}",
        branches(function),
        given(robot, function),
        columns("    ", &rows)
    )
}

/// Which joints the caller gives.
fn given(robot: &Robot, function: &Function) -> String {
    let names: Vec<String> = function.free.iter().map(|joint| clean(robot.units().joint(*joint).1)).collect();
    if names.is_empty() { String::new() } else { format!(" with {} given", names.join(", ")) }
}

/// A target as tables call it.
fn target(target: Target) -> &'static str {
    match target {
        Target::Pose => "pose",
        Target::Position => "position",
        Target::PositionDirection => "position_direction",
        Target::PositionYaw => "position_yaw",
        Target::Rotation => "rotation",
        Target::Direction => "direction",
        Target::Ray => "ray",
        Target::Lookat => "lookat",
        Target::Xy => "xy",
        Target::XyYaw => "xy_yaw",
    }
}

/// Why a problem has no function.
fn reason(robot: &Robot, index: Option<usize>) -> String {
    let kind = FunctionKind::Inverse(index);
    let failure = robot.output.report.functions.iter().find(|function| function.kind == kind);
    if let Some(failure) = failure.and_then(|function| function.failure.as_ref()) {
        return format!("left out, since it did not stand verification: {}", clean(failure));
    }
    let unsolved = robot.output.unsolved.iter().find(|unsolved| unsolved.problem == index);
    match unsolved {
        Some(unsolved) => format!("not solved: {}", unsolved.refusal.text()),
        None => "not solved".to_owned(),
    }
}

/// How many roots each stage has at most, in order.
fn roots(steps: &[Step]) -> Vec<usize> {
    let mut found = Vec::new();
    for step in steps {
        if let Step::Solve { equation, body, .. } = step {
            found.push(match equation {
                Equation::Trig { .. } | Equation::TrigUnit { .. } | Equation::Quadratic { .. } => 2,
                Equation::TrigPair { .. } | Equation::Linear { .. } => 1,
            });
            found.extend(roots(body));
        }
    }
    found
}

/// How many branches the solution has.
fn branches(function: &Function) -> usize {
    roots(&function.steps).into_iter().product()
}
