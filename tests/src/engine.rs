//! The engines that compute a table's kinematics, behind the one trait.

pub mod everything;
pub mod forwards;

use dh_codegen::diagnostic::Style;
use dh_codegen::plan::eval::Program;
use dh_codegen::verify::Level;
use dh_codegen::{Compilation, Output, compile};
use dh_core::Kinematics;
use std::collections::BTreeMap;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{LazyLock, OnceLock};

/// The interpreter of a table read at run time. Every plan that it runs lives as long as the process.
///
/// # Errors
/// What the compiler says of the table, as a person would see it.
pub fn interpreter(text: &str) -> Result<Box<dyn Kinematics + Send + Sync>, String> {
    let compilation = compile(text, Level::Quick);
    let Some(output) = compilation.output else {
        return Err(format!("{text}\n{}", compilation.diagnostics.render(text, "table.toml", Style::Plain)));
    };
    of_output(Box::leak(Box::new(output)))
}

/// The interpreter of a shipped table.
///
/// # Errors
/// There is no such table, or the compiler refuses it.
pub fn shipped(name: &str) -> Result<Box<dyn Kinematics + Send + Sync>, String> {
    let compilation = compiled(name)?;
    of_output(compilation.output.as_ref().ok_or_else(|| format!("{name} has mistakes"))?)
}

/// What the compiler makes of a shipped table. It is asked once in a process.
///
/// # Errors
/// There is no such table.
pub fn compiled(name: &str) -> Result<&'static Compilation, String> {
    static TABLES: LazyLock<BTreeMap<&str, OnceLock<Compilation>>> =
        LazyLock::new(|| dh_robots::names().map(|name| (name, OnceLock::new())).collect());
    let no_table = || format!("no table `{name}`");
    let table = dh_robots::table(name).ok_or_else(no_table)?;
    Ok(TABLES.get(name).ok_or_else(no_table)?.get_or_init(|| compile(table, Level::Full)))
}

/// What the compiler makes of all shipped tables, by name; compiled by as many threads as there are processors.
pub fn every_shipped() -> impl Iterator<Item = (&'static str, &'static Compilation)> {
    let names: Vec<&str> = dh_robots::names().collect();
    let next = AtomicUsize::new(0);
    let compile = || {
        while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
            let _ = compiled(name);
        }
    };
    std::thread::scope(|scope| {
        let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
        for _ in 0..processors {
            scope.spawn(compile);
        }
    });
    names.into_iter().filter_map(|name| Some((name, compiled(name).ok()?)))
}

fn of_output(output: &'static Output) -> Result<Box<dyn Kinematics + Send + Sync>, String> {
    let program = Program::new(&output.model, &output.plan).map_err(|error| error.to_string())?;
    let interpreter = Box::leak(Box::new(program)).interpreter().map_err(|error| error.to_string())?;
    Ok(Box::new(interpreter))
}
