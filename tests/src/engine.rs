//! The engines that compute a table's kinematics, behind the one trait.

use dh_codegen::compile;
use dh_codegen::diagnostic::Style;
use dh_codegen::plan::eval::Program;
use dh_codegen::verify::Level;
use dh_core::Kinematics;

/// The interpreter of a table read at run time. Every plan that it runs lives as long as the process.
///
/// # Errors
/// What the compiler says of the table, as a person would see it.
pub fn interpreter(text: &str) -> Result<Box<dyn Kinematics>, String> {
    let compilation = compile(text, Level::Quick);
    let Some(output) = compilation.output else {
        return Err(format!("{text}\n{}", compilation.diagnostics.render(text, "table.toml", Style::Plain)));
    };
    let output = Box::leak(Box::new(output));
    let program = Program::new(&output.model, &output.plan).map_err(|error| error.to_string())?;
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
