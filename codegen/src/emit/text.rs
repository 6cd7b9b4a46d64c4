//! Prints the equations of a plan as plain text, expanded, to be read like a derivation in a textbook.

mod algebra;
mod folded;
mod forward;
mod inverse;
mod layout;
mod number;
mod scope;
mod variables;

use crate::model::{Convention, Model};
use crate::plan::{FunctionKind, Plan};
use layout::Text;
use scope::Writer;
use std::collections::BTreeSet;

/// How the equations are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Which of them.
    pub part: Part,
    /// Numbers of the table in its units, instead of names.
    pub numeric: bool,
}

/// Which equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Pose of the tool frame.
    ForwardKinematics,
    /// Geometric Jacobian.
    Jacobian,
    /// All inverse problems that are solved.
    InverseKinematics,
    /// Everything.
    All,
}

impl Part {
    fn has(self, kind: &FunctionKind) -> bool {
        match kind {
            FunctionKind::Fk => matches!(self, Self::ForwardKinematics | Self::All),
            FunctionKind::Jacobian => matches!(self, Self::Jacobian | Self::All),
            FunctionKind::Inverse(_) => matches!(self, Self::InverseKinematics | Self::All),
            FunctionKind::FkFlange | FunctionKind::FkJacobian | FunctionKind::Frames => false,
        }
    }
}

/// The equations, ending with a new line.
pub fn print(model: &Model, plan: &Plan, options: &Options) -> String {
    let mut text = Text::default();
    text.line(0, &title(model));
    text.gap();
    text.line(0, "Joint variables");
    text.lines(1, &variables::definitions(model));
    let mut writer = Writer { model, plan, numeric: options.numeric, used: BTreeSet::new() };
    let (mut angles, mut derivations) = (BTreeSet::new(), Vec::new());
    for function in plan.functions.iter().filter(|function| options.part.has(&function.kind)) {
        text.gap();
        match function.kind {
            FunctionKind::Inverse(problem) => {
                inverse::print(&mut writer, function, problem, &mut derivations, &mut text);
            }
            _ => forward::print(&mut writer, function, &mut angles, &mut text),
        }
    }
    legend(&writer, &mut text);
    text.into_string()
}

/// What it is of, and in which units and convention.
fn title(model: &Model) -> String {
    let convention = match model.convention {
        Convention::Standard => "standard",
        Convention::Modified => "modified",
    };
    format!(
        "{} ({convention} Denavit-Hartenberg convention, lengths in {}, angles in {})",
        model.name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>(),
        number::length_unit(model.units),
        number::angle_unit(model.units)
    )
}

/// The parameters that the equations name, with their values.
fn legend(writer: &Writer<'_>, text: &mut Text) {
    let units = writer.model.units;
    let constants = writer.used.iter().filter_map(|place| writer.plan.constants.get(*place));
    let mut rows: Vec<[String; 2]> = constants
        .map(|constant| {
            let value = number::trimmed(number::in_units(constant.value, constant.dimension, units));
            let unit = match constant.dimension {
                0 => String::new(),
                1 => format!(" {}", number::length_unit(units)),
                power => format!(" {}^{power}", number::length_unit(units)),
            };
            [format!("{} = {value}{unit}", constant.name), constant.note.clone()]
        })
        .collect();
    rows.sort();
    if !rows.is_empty() {
        text.gap();
        text.line(0, "Parameters");
        text.columns(1, &rows);
    }
}
