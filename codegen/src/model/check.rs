//! The whole table, fact by fact.

use super::constraint::Joints;
use super::quantity::{Converter, word};
use super::{
    AngleUnit, Convention, Device, LengthUnit, Model, Row, Units, fingerprint, placement, problems, recentre,
    rows, rules, servos, topology,
};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, shortened};
use crate::table::{Span, Table, Text};

/// A table has at most so many rows.
pub(super) const MOST_ROWS: usize = 32;

/// Facts about whole tables, each checked by itself. Facts about one value are checked where it is converted.
const FACTS: [fn(&Table, &Model, &mut Diagnostics); 7] = [
    something_moves,
    rows_are_few_enough,
    joint_names_differ,
    problem_names_differ,
    servo_names_differ,
    servos::ids_differ,
    servos_reach_the_limits,
];

/// Checks a table. There is a model as soon as the rows could be read, so that what follows can offer the functions
/// of an arm that has mistakes; it is to be used only if there are no errors.
pub fn check(table: &Table, diagnostics: &mut Diagnostics) -> Option<Model> {
    let robot = table.robot.clone().unwrap_or_default();
    let conventions = [("standard", Convention::Standard), ("modified", Convention::Modified)];
    let convention = known(robot.convention.as_ref(), "convention", &conventions, diagnostics);
    let lengths = [("m", LengthUnit::Metre), ("mm", LengthUnit::Millimetre)];
    let length = known(robot.length.as_ref(), "unit of length", &lengths, diagnostics);
    let angles = [("rad", AngleUnit::Radian), ("deg", AngleUnit::Degree)];
    let angle = known(robot.angle.as_ref(), "unit of angle", &angles, diagnostics);
    let units =
        Units { length: length.unwrap_or(LengthUnit::Metre), angle: angle.unwrap_or(AngleUnit::Radian) };
    let convention = convention.unwrap_or(Convention::Standard);

    let mut converter = Converter { units, diagnostics };
    let mut rows = rows::rows(table, &mut converter);
    recentre::recentre(convention, &mut rows);
    let joints: Vec<usize> =
        (0..rows.len()).filter(|index| rows.get(*index).is_some_and(Row::moves)).collect();
    let inverse = couplings_do_not_cancel(table, &rows, &joints, converter.diagnostics);
    let windings =
        inverse.as_ref().map(|inverse| topology::windings(&rows, &joints, inverse)).unwrap_or_default();

    let mut model = Model {
        name: robot.name.map(|name| name.value).unwrap_or_default(),
        manufacturer: robot.manufacturer.map(|text| text.value),
        source: robot.source.map(|text| text.value),
        convention,
        units,
        base: placement::placement(table.base.as_ref(), &mut converter),
        tool: placement::placement(table.tool.as_ref(), &mut converter),
        workspace: rules::workspace(&table.workspace, &mut converter),
        servos: table.servos.iter().map(|servo| servos::outside_the_chain(servo, &mut converter)).collect(),
        device: table
            .device
            .as_ref()
            .map(|device| Device { driver: device.driver.value.clone(), keys: device.keys.clone() }),
        sums: Vec::new(),
        poses: Vec::new(),
        problems: Vec::new(),
        windings,
        fingerprint: 0,
        rows,
        joints,
    };
    // Where rows are missing, what refers to them is not wrong for it.
    let all_rows = table.complete && !table.joints.is_empty() && table.joints.len() <= MOST_ROWS;
    if all_rows {
        model.sums = table
            .limits
            .iter()
            .filter_map(|limit| rules::sum_limit(limit, &model.rows, &mut converter))
            .collect();
        model.poses = table
            .poses
            .iter()
            .filter_map(|pose| rules::pose(pose, &model.rows, &model.joints, &model.sums, &mut converter))
            .collect();
    }
    let whole = Joints {
        rows: &model.rows,
        moving: &model.joints,
        inverse: inverse.as_deref().unwrap_or(&[]),
        units,
    };
    let whole = (all_rows && inverse.is_some()).then_some(&whole);
    model.problems =
        table.problems.iter().filter_map(|written| problems::problem(written, whole, diagnostics)).collect();
    for fact in FACTS {
        fact(table, &model, diagnostics);
    }
    model.fingerprint = fingerprint::of(&model);
    (!model.joints.is_empty() && table.joints.len() <= MOST_ROWS).then_some(model)
}

fn known<T: Copy>(
    text: Option<&Text>,
    what: &str,
    words: &[(&str, T)],
    diagnostics: &mut Diagnostics,
) -> Option<T> {
    text.and_then(|text| word(text, what, words, diagnostics))
}

fn couplings_do_not_cancel(
    table: &Table,
    rows: &[Row],
    joints: &[usize],
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Vec<f64>>> {
    let inverse = topology::inverse(rows, joints);
    if inverse.is_none() {
        let mut coupled =
            table.joints.iter().filter_map(|joint| joint.couple.first()).map(|(name, _)| name.span.clone());
        let mut diagnostic = Diagnostic::error(
            catalogue::SINGULAR_COUPLING,
            "the couplings cancel: joints can be moved together without moving the arm",
        )
        .at(coupled.next().unwrap_or(0..0), "");
        for other in coupled {
            diagnostic = diagnostic.beside(other, "");
        }
        diagnostics.push(diagnostic.help("couple one of the joints to the other, not each to each"));
    }
    inverse
}

fn something_moves(table: &Table, model: &Model, diagnostics: &mut Diagnostics) {
    if !table.complete || !model.joints.is_empty() {
        return;
    }
    let (message, help) = if table.joints.is_empty() {
        ("the table has no joints", "write a `[[joint]]` for each, base to tip")
    } else {
        ("all joints are held, so nothing moves", "leave `fixed` out of one of them")
    };
    let at = table.joints.first().map_or_else(|| robot_header(table), |joint| joint.header.clone());
    diagnostics.push(Diagnostic::error(catalogue::JOINT_COUNT, message).at(at, "").help(help));
}

fn robot_header(table: &Table) -> Span {
    table.robot.as_ref().map_or(0..0, |robot| robot.span.start..robot.span.start)
}

fn rows_are_few_enough(table: &Table, _: &Model, diagnostics: &mut Diagnostics) {
    if let Some(joint) = table.joints.get(MOST_ROWS) {
        diagnostics.push(
            Diagnostic::error(
                catalogue::JOINT_COUNT,
                format!(
                    "the table has {} joints, more than the {MOST_ROWS} that a robot may have",
                    table.joints.len()
                ),
            )
            .at(joint.header.clone(), "one too many")
            .help("split the robot into several tables"),
        );
    }
}

fn joint_names_differ(table: &Table, model: &Model, diagnostics: &mut Diagnostics) {
    let places: Vec<(&str, Span)> = model
        .rows
        .iter()
        .zip(&table.joints)
        .map(|(row, joint)| {
            (row.name.as_str(), joint.name.as_ref().map_or(joint.header.clone(), |name| name.span.clone()))
        })
        .collect();
    if let Some((_, span)) = places.iter().find(|(name, _)| name.trim().is_empty()) {
        diagnostics.push(
            Diagnostic::error(catalogue::BAD_NAME, "a joint's name is empty")
                .at(span.clone(), "")
                .help("write a name, or leave `name` out for J1, J2, ..."),
        );
    }
    names_differ("joints", &places, diagnostics);
}

fn problem_names_differ(table: &Table, _: &Model, diagnostics: &mut Diagnostics) {
    let places: Vec<(&str, Span)> = table
        .problems
        .iter()
        .filter_map(|problem| problem.name.as_ref())
        .map(|name| (name.value.as_str(), name.span.clone()))
        .collect();
    names_differ("problems", &places, diagnostics);
}

fn servo_names_differ(table: &Table, _: &Model, diagnostics: &mut Diagnostics) {
    let places: Vec<(&str, Span)> =
        table.servos.iter().map(|servo| (servo.name.value.as_str(), servo.name.span.clone())).collect();
    names_differ("servos", &places, diagnostics);
}

fn names_differ(what: &str, places: &[(&str, Span)], diagnostics: &mut Diagnostics) {
    let mut first = std::collections::HashMap::new();
    for (name, span) in places {
        if let Some(before) = first.get(name) {
            let before: &Span = before;
            diagnostics.push(
                Diagnostic::error(
                    catalogue::DUPLICATE_NAME,
                    format!("two {what} have the name `{}`", shortened(name)),
                )
                .at(span.clone(), "the second")
                .beside(before.clone(), "the first")
                .help("give one of them another name"),
            );
        } else {
            first.insert(*name, span.clone());
        }
    }
}

/// Where a servo does not reach the limits of its joint, motion uses what both allow.
fn servos_reach_the_limits(table: &Table, model: &Model, diagnostics: &mut Diagnostics) {
    for (row, joint) in model.rows.iter().zip(&table.joints) {
        let (Some(limits), Some(servo), Some(written)) = (row.limits, &row.servo, &joint.servo) else {
            continue;
        };
        let (Some(range), Some(place)) = (servo.range, written.range.as_ref()) else {
            continue;
        };
        let sent = |q: f64| servo.scale * q + servo.zero;
        let (one, two) = (sent(limits.min), sent(limits.max));
        let (least, greatest) = (one.min(two), one.max(two));
        // Half a count is rounded away when it is sent.
        if least < range.min - 0.5 || greatest > range.max + 0.5 {
            let shown = |value: f64| libm::round(value * 10.0) / 10.0;
            diagnostics.push(
                Diagnostic::warning(
                    catalogue::SERVO_RANGE,
                    format!(
                        "the limits of {} are {} ... {} for its servo, which takes {} ... {}",
                        shortened(&row.name),
                        shown(least),
                        shown(greatest),
                        range.min,
                        range.max,
                    ),
                )
                .at(place.span.clone(), "")
                .help("motion uses what both allow; change `limits`, `zero` or `range` if that is not meant"),
            );
        }
    }
}
