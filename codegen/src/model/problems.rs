//! `[[ik]]`: inverse problems, their constraints, and whether they come out even.

use super::constraint::{Joints, equation, inequality, says_nothing};
use super::form::Form;
use super::linear::{Added, System};
use super::quantity::word;
use super::{Problem, Target, names};
use crate::diagnostic::{Diagnostic, Diagnostics, catalogue, shortened};
use crate::table::{self, Text};
use core::f64::consts::TAU;

/// Names of functions that an arm has besides its problems', after `ik_`.
const RESERVED: [&str; 12] = [
    "all",
    "batch",
    "track",
    "free",
    "at",
    "near",
    "sweep",
    "nearest",
    "intervals",
    "into",
    "within",
    "by_arm_angle",
];

/// Names that begin with these and an underscore would be variants of another problem's functions.
const VARIANTS: [&str; 7] = ["all_", "at_", "sweep_", "nearest_", "intervals_", "track_", "by_arm_angle_"];

/// Constants that differ by less than this are equal (rad or m).
const EQUAL: f64 = 1e-9;

const TARGETS: [(&str, Target); 10] = [
    ("pose", Target::Pose),
    ("position", Target::Position),
    ("position_direction", Target::PositionDirection),
    ("position_yaw", Target::PositionYaw),
    ("rotation", Target::Rotation),
    ("direction", Target::Direction),
    ("ray", Target::Ray),
    ("lookat", Target::Lookat),
    ("xy", Target::Xy),
    ("xy_yaw", Target::XyYaw),
];

impl Target {
    /// All of them.
    pub(crate) const ALL: [Self; TARGETS.len()] = {
        let mut all = [Self::Pose; TARGETS.len()];
        let mut place = 0;
        while place < all.len() {
            all[place] = TARGETS[place].1;
            place += 1;
        }
        all
    };

    /// How many rows it prescribes.
    pub fn rows(self) -> usize {
        match self {
            Target::Pose => 6,
            Target::PositionDirection => 5,
            Target::PositionYaw | Target::Ray => 4,
            Target::Position | Target::Rotation | Target::XyYaw => 3,
            Target::Direction | Target::Lookat | Target::Xy => 2,
        }
    }

    /// As written in tables.
    pub fn name(self) -> &'static str {
        TARGETS.iter().find(|(_, target)| *target == self).map_or("", |(name, _)| name)
    }
}

/// One problem, with what could be read of it. `joints` is `None` where the rows are not known well enough.
pub(super) fn problem(
    written: &table::Problem,
    joints: Option<&Joints>,
    diagnostics: &mut Diagnostics,
) -> Option<Problem> {
    let target = written.target.as_ref().and_then(|text| word(text, "target", &TARGETS, diagnostics));
    if let Some(name) = &written.name {
        name_makes_a_function(name, target, diagnostics);
    }
    let joints = joints?;
    let before = diagnostics.errors();
    let mut system = System::default();
    let mut constraints = Vec::new();
    let mut read = Vec::new();
    for text in &written.constraints {
        let Some(form) = equation(text, joints, diagnostics) else {
            continue;
        };
        let number = read.len();
        read.push(text);
        if takes_an_unknown_away(&mut system, number, text, &form, &read, diagnostics) {
            constraints.push(form.linear);
        }
    }
    let filters = written.filters.iter().filter_map(|text| inequality(text, joints, diagnostics)).collect();
    let mut free = Vec::new();
    for name in &written.free {
        let Some(variable) = names::variable(joints.rows, name, diagnostics) else {
            continue;
        };
        let mut alone = vec![0.0; joints.moving.len()];
        if let Some(entry) = alone.get_mut(variable) {
            *entry = 1.0;
        }
        if system.add(usize::MAX, &alone, 0.0) == Added::Independent {
            free.push(variable);
        } else {
            diagnostics.push(
                Diagnostic::error(
                    catalogue::REDUNDANT,
                    format!("`{}` cannot be left to the caller: it is held already", shortened(&name.value)),
                )
                .at(name.span.clone(), "")
                .help("leave it out of `free`"),
            );
        }
    }
    let sound = written.complete && diagnostics.errors() == before;
    if let Some(target) = target.filter(|_| sound) {
        comes_out_even(written, target, joints, system.rank(), diagnostics);
    }
    Some(Problem {
        name: written.name.as_ref()?.value.clone(),
        target: target?,
        constraints,
        filters,
        free,
        span: written.span.clone(),
        line: written.line,
    })
}

fn takes_an_unknown_away(
    system: &mut System,
    number: usize,
    text: &Text,
    form: &Form,
    read: &[&Text],
    diagnostics: &mut Diagnostics,
) -> bool {
    let (coefficients, constant) = &form.in_q;
    if coefficients.iter().all(|coefficient| coefficient.abs() < EQUAL) {
        diagnostics.push(if constant.abs() < EQUAL {
            says_nothing(text)
        } else {
            Diagnostic::error(catalogue::NO_SOLUTION, "no joint is left in it, and what is left is not true")
                .at(text.span.clone(), "")
                .help("leave it out, or write what is meant")
        });
        return false;
    }
    let Added::Dependent { difference, on } = system.add(number, coefficients, *constant) else {
        return true;
    };
    let turns = difference / TAU;
    let same = difference.abs() < EQUAL;
    let same_but_for_turns = form.of_angles && (turns - libm::round(turns)).abs() < EQUAL;
    let mut diagnostic = if same || same_but_for_turns {
        let turns = if same { "" } else { ", but for whole turns" };
        let message =
            format!("the constraint follows from those beside it{turns}, so it takes no unknown away");
        Diagnostic::error(catalogue::REDUNDANT, message).at(text.span.clone(), "").help("leave it out")
    } else {
        let message = "the constraint contradicts those beside it: they cannot hold together";
        Diagnostic::error(catalogue::CONTRADICTION, message)
            .at(text.span.clone(), "")
            .help("leave one of them out")
    };
    for other in on.iter().filter_map(|other| read.get(*other)) {
        diagnostic = diagnostic.beside(other.span.clone(), "");
    }
    diagnostics.push(diagnostic);
    false
}

/// As many unknowns as rows; the full pose may have fewer.
fn comes_out_even(
    written: &table::Problem,
    target: Target,
    joints: &Joints,
    taken: usize,
    diagnostics: &mut Diagnostics,
) {
    let moving = joints.moving.len();
    let unknowns = moving.saturating_sub(taken);
    let rows = target.rows();
    if unknowns == rows || (target == Target::Pose && unknowns < rows && unknowns > 0) {
        return;
    }
    let count = |count: usize, noun: &str| {
        if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
    };
    let free = written.free.len();
    let mut reasons = vec![format!("{} that move", count(moving, "joint"))];
    if !written.constraints.is_empty() {
        reasons.push(count(written.constraints.len(), "constraint"));
    }
    if free > 0 {
        reasons.push(format!("{free} free"));
    }
    let message = format!(
        "the problem has {} ({}), and `{}` prescribes {}",
        count(unknowns, "unknown"),
        reasons.join(", less "),
        target.name(),
        count(rows, "row"),
    );
    let at = written.target.as_ref().map_or_else(|| written.span.clone(), |target| target.span.clone());
    let diagnostic = Diagnostic::error(catalogue::UNEVEN, message).at(at, "");
    let help = if unknowns > rows {
        let more = unknowns - rows;
        let free = if more == 1 { "a joint" } else { "joints" };
        format!(
            "write {} more, or leave {free} to the caller, as in `free = [\"{}\"]`",
            count(more, "constraint"),
            last_joint(joints)
        )
    } else if taken == 0 {
        let fitting: Vec<&str> =
            TARGETS.iter().filter(|(_, other)| other.rows() == unknowns).map(|(name, _)| *name).collect();
        if fitting.is_empty() {
            "the arm has too few joints for it: leave the problem out".to_owned()
        } else {
            format!(
                "the arm has too few joints for it; with {} it comes out even for: {}",
                count(unknowns, "unknown"),
                fitting.join(", ")
            )
        }
    } else if written.constraints.is_empty() {
        format!("leave {} out of `free`", count((rows - unknowns).min(free), "joint"))
    } else {
        let choice = if free > 0 { ", or joints out of `free`" } else { "" };
        format!("leave out {}{choice}", count((rows - unknowns).min(taken), "constraint"))
    };
    diagnostics.push(diagnostic.help(help));
}

fn last_joint<'a>(joints: &'a Joints) -> &'a str {
    joints.moving.last().and_then(|row| joints.rows.get(*row)).map_or("", |row| &row.name)
}

/// The name can be part of `ik_NAME`, and `ik_NAME` is no other function.
fn name_makes_a_function(name: &Text, target: Option<Target>, diagnostics: &mut Diagnostics) {
    let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let value = name.value.as_str();
    if value.is_empty() || !value.chars().all(letters) || value.starts_with(|c: char| c.is_ascii_digit()) {
        let mended: String = value.to_lowercase().chars().map(|c| if letters(c) { c } else { '_' }).collect();
        let words: Vec<&str> = mended.split('_').filter(|word| !word.is_empty()).collect();
        let mended = words.join("_");
        let mended =
            if mended.starts_with(|c: char| c.is_ascii_digit()) { format!("_{mended}") } else { mended };
        let mended = if mended.is_empty() { "tool_down".to_owned() } else { mended };
        diagnostics.push(
            Diagnostic::error(
                catalogue::BAD_NAME,
                format!("`{}` cannot be part of a function's name", shortened(value)),
            )
            .at(name.span.clone(), "")
            .help(format!("write letters, digits and underscores, such as `\"{}\"`", shortened(&mended))),
        );
        return;
    }
    let variant = VARIANTS.iter().any(|start| value.starts_with(start)) || value.ends_with("_near");
    let taken = RESERVED.contains(&value) || variant;
    if taken || (value == "pose" && target.is_some_and(|target| target != Target::Pose)) {
        let what = match value {
            "pose" => "is the full pose, which every arm has".to_owned(),
            _ => format!("would make `ik_{value}`, which is another function of the arm"),
        };
        diagnostics.push(
            Diagnostic::error(catalogue::RESERVED_NAME, format!("`{value}` {what}"))
                .at(name.span.clone(), "")
                .help("choose another name"),
        );
    }
}
