//! The pipeline, one call a stage.

use crate::diagnostic::Diagnostics;
use crate::model::{self, Model};
use crate::plan::{self, Plan};
use crate::table;
use crate::verify::{self, Level, Report};

/// What was made of a table.
#[derive(Debug)]
pub struct Compilation {
    /// Mistakes and warnings.
    pub diagnostics: Diagnostics,
    /// The robot as far as it could be read, mistakes or not; for signatures only where there are errors.
    pub model: Option<Model>,
    /// What was made, unless there are errors.
    pub output: Option<Output>,
}

/// What printers, interpreter and reports read, besides the model.
#[derive(Debug)]
pub struct Output {
    /// Every function that stood verification.
    pub plan: Plan,
    /// What verification found.
    pub report: Report,
}

/// Compiles the text of a table.
pub fn compile(text: &str, level: Level) -> Compilation {
    let mut diagnostics = Diagnostics::new();
    let table = table::parse(text, &mut diagnostics);
    let model = model::check(&table, &mut diagnostics);
    let output = model.as_ref().filter(|_| !diagnostics.has_errors()).map(|model| {
        let plan = plan::build(model);
        let (plan, report) = verify::verify(model, plan, level, &mut diagnostics);
        Output { plan, report }
    });
    Compilation { diagnostics, model, output }
}
