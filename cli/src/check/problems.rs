//! How every inverse problem is solved, or why it is not.

use crate::robot::Robot;
use crate::text::{clean, columns};
use dh_codegen::model::Target;
use dh_codegen::plan::{Equation, Function, FunctionKind, GeneralChain, Step};
use dh_codegen::verify::FunctionReport;
use dh_core::{FULL_POSE, MAX_SOLUTIONS};

/// Where given joints stand when what the others are like is asked: at no multiple of a quarter turn.
const SOMEWHERE: f64 = 0.7;

/// The full pose, then the problems of the table.
pub(super) fn written(robot: &Robot) -> String {
    let problems = robot.model().problems.iter().enumerate();
    // A problem of the table may take its place.
    let full_pose = robot.model().problems.iter().all(|problem| problem.name != FULL_POSE);
    let full_pose = full_pose.then_some((None, FULL_POSE));
    let names = full_pose.into_iter().chain(problems.map(|(i, p)| (Some(i), p.name.as_str())));
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
    let given = given(robot, function, index);
    let most = branches(function);
    let way = format!("{}, up to {most} solution{}", way(function), if most == 1 { "" } else { "s" });
    let tried: Vec<String> = left_out(robot, index).map(|why| format!("    before that, {why}\n")).collect();
    let tried = tried.concat();
    format!("{title}: {given}{way}\n{tried}    {}\n{}", why(robot, function), columns("    ", &rows))
}

/// Joints that the caller gives.
fn given(robot: &Robot, function: &Function, index: Option<usize>) -> String {
    let model = robot.model();
    let rows = function.free.iter().filter_map(|joint| model.rows.get(*model.joints.get(*joint)?));
    let names: Vec<String> = rows.map(|row| clean(&row.name)).collect();
    let problem = index.and_then(|index| model.problems.get(index));
    let angle = model.row_for_arm_angle(problem, &function.free).map_or("", |_| " or the arm angle");
    if names.is_empty() { String::new() } else { format!("with {}{angle} given, ", names.join(", ")) }
}

/// By which method.
fn way(function: &Function) -> &'static str {
    match function.steps.as_slice() {
        [Step::Near { .. }] => "as the arm that was meant, corrected",
        steps => way_of(steps),
    }
}

fn way_of(steps: &[Step]) -> &'static str {
    if let [Step::Descents { .. }] = steps {
        return "by a search from many places";
    }
    match general(steps) {
        Some(chain) if chain.charts.is_empty() => "by Newton's method from many places",
        Some(_) => "by a polynomial in one joint",
        None => "in closed form",
    }
}

/// What kind of arm was meant, where a nearly special one is solved as that.
fn near(function: &Function) -> Option<&str> {
    match function.steps.as_slice() {
        [Step::Near { meant, .. }] => Some(meant),
        _ => None,
    }
}

/// What of the geometry, or of the problem, makes that the way.
fn why(robot: &Robot, function: &Function) -> String {
    let model = robot.model();
    if let Some(meant) = near(function) {
        let then = match function.steps.as_slice() {
            [Step::Near { nearly, otherwise, .. }] => match (way_of(otherwise), &nearly.joints) {
                (way, Some(_)) => format!("then {way}, then from targets around"),
                (way, None) => format!("then from targets around, then {way}"),
            },
            _ => String::new(),
        };
        return format!(
            "solved as {meant}; each solution is brought to the table as written by Newton's method; near singular poses along the curve of what is missing, {then}"
        );
    }
    if let [Step::Descents { .. }] = function.steps.as_slice() {
        return "no order of steps with one unknown each was found, nor a chain of six joints with one pose; nothing proves that the search finds all solutions".to_owned();
    }
    let problem = match function.kind {
        FunctionKind::Inverse(Some(index)) => model.problems.get(index),
        _ => None,
    };
    if let Some(problem) = problem.filter(|problem| !problem.constraints.is_empty()) {
        let many = if problem.constraints.len() == 1 { "constraint leaves" } else { "constraints leave" };
        let found = |count: usize| format!("{count} unknown{}", if count == 1 { "" } else { "s" });
        return match (general(&function.steps), function.stages.first()) {
            (Some(_), Some(stage)) => format!("the {many} {}", found(stage.rows.count_ones() as usize)),
            _ => format!("the {many} {}, one a step", found(function.stages.len())),
        };
    }
    let held: Vec<(usize, f64)> = function.free.iter().map(|joint| (*joint, SOMEWHERE)).collect();
    let geometry = model.geometry_holding(&held);
    let is_general = general(&function.steps).is_some();
    let spherical = geometry.spherical_joints().next().map(<[usize]>::to_vec);
    let parallel = geometry.parallel_runs().into_iter().find(|run| run.len() > 2);
    match (spherical, parallel) {
        (None, None) if is_general => {
            "no three neighbouring axes meet in one point or are parallel: no step has one unknown alone"
                .to_owned()
        }
        (Some(axes), _) if !is_general => {
            format!("axes {} meet in one point: position and orientation come apart", geometry.named(&axes))
        }
        (None, Some(run)) if !is_general => {
            format!("axes {} are parallel: they turn as one angle", geometry.named(&run))
        }
        _ if is_general => {
            let index = match function.kind {
                FunctionKind::Inverse(index) => index,
                _ => None,
            };
            let stands =
                if left_out(robot, index).next().is_some() { " that stands verification" } else { "" };
            format!("no order of steps with one unknown each was found{stands}")
        }
        _ => "every step has one unknown".to_owned(),
    }
}

/// The chain of a function that finds all joints at once.
fn general(steps: &[Step]) -> Option<&GeneralChain> {
    steps.iter().find_map(|step| match step {
        Step::General { chain, .. } => Some(chain),
        Step::Solve { body, .. } => general(body),
        Step::Descents { .. }
        | Step::Near { .. }
        | Step::Let { .. }
        | Step::SinCos { .. }
        | Step::Accept { .. } => None,
    })
}

/// Why ways that were tried first are not taken.
fn left_out(robot: &Robot, index: Option<usize>) -> impl Iterator<Item = String> + '_ {
    let kind = FunctionKind::Inverse(index);
    let failures = robot.output.report.functions.iter().filter(move |report| report.kind == kind);
    let why = |report: &FunctionReport| report.failure.as_ref().map(|failure| clean(failure));
    failures.filter_map(why).map(|failure| format!("a way that did not stand verification: {failure}"))
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
    if let Some(unsolved) = unsolved {
        return format!("not solved: {}", unsolved.refusal.text());
    }
    let model = robot.model();
    let (joints, rows) = (model.joints.len(), Target::Pose.rows());
    let more = joints.saturating_sub(rows);
    let free = model.joints.iter().take(more).filter_map(|joint| model.rows.get(*joint));
    let free: Vec<String> = free.map(|row| format!("\"{}\"", clean(&row.name))).collect();
    format!(
        "not solved: a pose has {rows} rows, and there are {joints} joints; in an [[ik]] entry with `target = \"pose\"` hold {more} of them by constraints, or leave {more} to the caller, as in `free = [{}]`",
        free.join(", ")
    )
}

/// How many roots each stage has at most, in order.
fn roots(steps: &[Step]) -> Vec<usize> {
    let mut found = Vec::new();
    for step in steps {
        match step {
            Step::Solve { equation, body, .. } => {
                found.push(match equation {
                    Equation::Trig { .. }
                    | Equation::TrigUnit { .. }
                    | Equation::TrigEither { .. }
                    | Equation::Quadratic { .. } => 2,
                    Equation::TrigPair { .. } | Equation::Linear { .. } => 1,
                    Equation::Quartic { .. } => 4,
                });
                found.extend(roots(body));
            }
            Step::General { chain, body, .. } => {
                found.push(chain.most_solutions());
                found.extend(roots(body));
            }
            Step::Descents { body, .. } => {
                found.push(MAX_SOLUTIONS);
                found.extend(roots(body));
            }
            Step::Near { body, otherwise, .. } => {
                found.extend(roots(body));
                found.extend(roots(otherwise));
            }
            _ => {}
        }
    }
    found
}

/// How many branches the solution has. A nearly special arm may have more than the one that was meant, near its singular poses.
fn branches(function: &Function) -> usize {
    match function.steps.as_slice() {
        [Step::Near { otherwise, .. }] => roots(otherwise),
        steps => roots(steps),
    }
    .into_iter()
    .product()
}
