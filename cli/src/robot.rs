//! A table that was named on the command line, compiled.

use crate::failure::{Failure, Refusal, coloured, complain};
use crate::units::Units;
use dh_build::{FindError, Source};
use dh_codegen::diagnostic::{Diagnostics, Severity, Style};
use dh_codegen::model::Model;
use dh_codegen::plan::FunctionKind;
use dh_codegen::plan::eval::{PlanError, Program};
use dh_codegen::verify::Level;
use dh_codegen::{Output, compile};

/// A robot that can be computed.
#[derive(Debug)]
pub(crate) struct Robot {
    /// The table.
    pub(crate) source: Source,
    /// Its warnings.
    pub(crate) diagnostics: Diagnostics,
    /// What was made of it.
    pub(crate) output: Output,
}

impl Robot {
    /// Whether every problem of the table has its function.
    pub(crate) fn has_all(&self) -> bool {
        let solved = |index| {
            let kind = FunctionKind::Inverse(Some(index));
            self.output.plan.functions.iter().any(|function| function.kind == kind)
        };
        (0..self.output.model.problems.len()).all(solved)
    }

    /// Finds and compiles a table.
    ///
    /// # Errors
    /// Its mistakes, drawn.
    pub(crate) fn load(table: &str, level: Level) -> Result<Robot, Failure> {
        let source = Source::for_command_line(table).map_err(|error| missing(&error))?;
        let compilation = compile(&source.text, level);
        let diagnostics = compilation.diagnostics;
        match compilation.output {
            Some(output) if !diagnostics.has_errors() => Ok(Robot { source, diagnostics, output }),
            _ => Err(refused(&source, &diagnostics)),
        }
    }

    /// The robot itself.
    pub(crate) fn model(&self) -> &Model {
        &self.output.model
    }

    /// Its units.
    pub(crate) fn units(&self) -> Units<'_> {
        Units::of(self.model())
    }

    /// Its functions, to be run.
    ///
    /// # Errors
    /// Where verification has taken out a function that every arm needs.
    pub(crate) fn program(&self) -> Result<Program<'_>, Failure> {
        Program::new(self.model(), &self.output.plan).map_err(|error| self.unusable(&error))
    }

    /// What to say where a plan cannot be run.
    pub(crate) fn unusable(&self, error: &PlanError) -> Failure {
        let refusal = Refusal::new("verification", format!("the arm cannot be computed: {error}"));
        Failure::Table { drawn: format!("{}\n\n{refusal}", self.drawn()), refusal }
    }

    /// Draws warnings on stderr.
    pub(crate) fn warn(&self) {
        if !self.diagnostics.is_empty() {
            complain(&self.drawn());
        }
    }

    fn drawn(&self) -> String {
        draw(&self.source, &self.diagnostics)
    }
}

fn draw(source: &Source, diagnostics: &Diagnostics) -> String {
    diagnostics.render(&source.text, &source.name_shown, style())
}

fn style() -> Style {
    if coloured() { Style::Coloured } else { Style::Plain }
}

fn refused(source: &Source, diagnostics: &Diagnostics) -> Failure {
    let errors = diagnostics.sorted().iter().filter(|item| item.severity == Severity::Error).count();
    let message = format!("{} has {errors} error{}", source.name_shown, if errors == 1 { "" } else { "s" });
    let refusal = Refusal::new("table", message).with("errors", errors);
    Failure::Table { drawn: draw(source, diagnostics), refusal }
}

fn missing(error: &FindError) -> Failure {
    let diagnostic = error.diagnostic();
    let refusal = Refusal::new("table", diagnostic.message.clone());
    Failure::Table { drawn: diagnostic.render("", error.name(), style()), refusal }
}
