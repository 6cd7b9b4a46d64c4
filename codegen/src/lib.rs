//! The compiler from Denavit-Hartenberg tables to kinematics code: table text in; model, equations, plan and printed
//! code out. It reads and writes no files.
//!
//! Modules in the order in which the data flows.

/// Codes, messages and labelled spans; the one renderer of them.
pub mod diagnostic;
/// Stage 5: printers.
pub mod emit;
/// Stage 2: rows -> a checked robot in SI units.
pub mod model;
/// Stage 4: equations -> functions as ordered, named scalar steps, and the interpreter of these.
pub mod plan;
/// Stage 3: model -> equations.
pub mod symbolic;
/// Stage 1: text -> rows as written, every value with its span. Knows TOML, no geometry.
pub mod table;
/// Every function of a plan against plain products of the table's matrices.
pub mod verify;

use diagnostic::{Diagnostic, Diagnostics, catalogue};
use emit::rust::Outline;
use model::Model;
use plan::{Plan, Unsolved};
use symbolic::inverse_kinematics::Refusal;
use verify::{Level, Report};

/// What is known of a table.
#[derive(Debug)]
pub struct Compilation {
    /// Every mistake and warning.
    pub diagnostics: Diagnostics,
    /// The functions that stood verification; `None` where the table has errors.
    pub output: Option<Output>,
    /// What the functions would be called, as far as it could be read.
    pub outline: Outline,
}

/// A compiled table.
#[derive(Debug, Clone)]
pub struct Output {
    /// The robot.
    pub model: Model,
    /// Its functions.
    pub plan: Plan,
    /// What they were verified with.
    pub report: Report,
    /// Inverse problems that have no function.
    pub unsolved: Vec<Unsolved>,
}

/// Compiles a table: the pipeline, one call a stage.
pub fn compile(text: &str, level: Level) -> Compilation {
    let mut diagnostics = Diagnostics::new();
    let table = table::parse(text, &mut diagnostics);
    let model = model::check(&table, &mut diagnostics);
    let outline = model.as_ref().map(outline).unwrap_or_default();
    let output = match model {
        Some(model) if !diagnostics.has_errors() => {
            let (mut plan, unsolved) = plan::build(&model);
            let unsolved: Vec<Unsolved> = unsolved
                .into_iter()
                .filter_map(|unsolved| {
                    if matches!(unsolved.refusal, Refusal::Singular { .. }) {
                        return Some(unsolved);
                    }
                    match plan::at_once(&model, unsolved.problem) {
                        Ok(function) => {
                            plan.functions.push(function);
                            None
                        }
                        Err(refusal) => Some(Unsolved { refusal, ..unsolved }),
                    }
                })
                .collect();
            for problem in &unsolved {
                if let Some(diagnostic) = not_solved(&model, problem) {
                    diagnostics.push(diagnostic);
                }
            }
            let (mut plan, report) = {
                let next = |failed: &_| plan::next(&model, failed);
                verify::verify_or_else(&model, plan, level, next, &mut diagnostics)
            };
            if level != Level::Quick {
                let second = |function: &_| plan::second(&model, function);
                verify::confirm(&model, &mut plan, level, second, &mut diagnostics);
            }
            Some(Output { model, plan, report, unsolved })
        }
        _ => None,
    };
    Compilation { diagnostics, output, outline }
}

fn outline(model: &Model) -> Outline {
    Outline {
        rows: model.rows.iter().map(|row| row.variable.is_some()).collect(),
        problems: model.problems.iter().map(|problem| (problem.name.clone(), problem.target)).collect(),
    }
}

/// A problem without a closed form has no function; the rest of the arm is not at fault. The full pose, which no
/// entry of the table asks for, is left out without a word.
fn not_solved(model: &Model, unsolved: &Unsolved) -> Option<Diagnostic> {
    let problem = model.problems.get(unsolved.problem?)?;
    let (name, why) = (&problem.name, unsolved.refusal.text());
    let message = format!("there is no `ik_{name}`: {why}");
    Some(
        Diagnostic::warning(catalogue::NO_CLOSED_FORM, message)
            .at(problem.span.clone(), "this problem")
            .help(unsolved.refusal.help()),
    )
}
