//! The engines that compute a table's kinematics, behind the one trait.

use dh_codegen::diagnostic::{Diagnostics, Style};
use dh_codegen::plan::eval::Program;
use dh_codegen::{model, plan, table};
use dh_core::Kinematics;

/// The interpreter of a table read at run time. Every plan that it runs lives as long as the process.
///
/// # Errors
/// What the compiler says of the table, as a person would see it.
pub fn interpreter(text: &str) -> Result<Box<dyn Kinematics>, String> {
    let mut diagnostics = Diagnostics::default();
    let table = table::parse(text, &mut diagnostics);
    let model = model::check(&table, &mut diagnostics);
    let Some(model) = model.filter(|_| !diagnostics.has_errors()) else {
        return Err(format!("{text}\n{}", diagnostics.render(text, "table.toml", Style::Plain)));
    };
    let model = Box::leak(Box::new(model));
    let (plan, unsolved) = plan::build(model);
    for problem in &unsolved {
        eprintln!("{}: {problem:?}", model.name);
    }
    let program = Program::new(model, Box::leak(Box::new(plan))).map_err(|error| error.to_string())?;
    let interpreter = Box::leak(Box::new(program)).interpreter().map_err(|error| error.to_string())?;
    Ok(Box::new(interpreter))
}

/// The interpreter of a shipped table.
///
/// # Errors
/// There is no such table, or the compiler refuses it.
pub fn shipped(name: &str) -> Result<Box<dyn Kinematics>, String> {
    interpreter(dh_robots::table(name).ok_or_else(|| format!("no table `{name}`"))?)
}
