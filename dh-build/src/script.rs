//! Build scripts: a table in, a Rust file in `OUT_DIR` out.

use super::{FindError, Source};
use dh_codegen::diagnostic::{Diagnostics, Severity, Style};
use dh_codegen::emit::rust::{self, Options, ScalarType, Types};
use dh_codegen::verify::Level;
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};

/// The whole of a `build.rs`: generates the code of one table into `OUT_DIR`.
///
/// ```no_run
/// fn main() -> Result<(), dh_build::BuildError> {
///     dh_build::Build::new().table("arm.toml").struct_name("Arm").compile()?;
///     Ok(())
/// }
/// ```
///
/// The crate then has `include!(concat!(env!("OUT_DIR"), "/arm.rs"));` where `Arm` is wanted.
#[derive(Debug, Clone, Default)]
pub struct Build {
    options: Options,
}

impl Build {
    /// A build of no table yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The table: `arm.toml` in the crate's root or in its `robots/` folder; a name without `.toml` is a shipped
    /// table.
    #[must_use]
    pub fn table(mut self, name: impl Into<String>) -> Self {
        self.options.table = name.into();
        self
    }

    /// The name of the generated struct, where it is not to be made from the robot's.
    #[must_use]
    pub fn struct_name(mut self, name: impl Into<String>) -> Self {
        self.options.name = Some(name.into());
        self
    }

    /// The type of all numbers, where it is not to be f64.
    #[must_use]
    pub fn scalar(mut self, scalar: ScalarType) -> Self {
        self.options.scalar = scalar;
        self
    }

    /// The types that the methods take and return, where they are not to be nalgebra's.
    #[must_use]
    pub fn types(mut self, types: Types) -> Self {
        self.options.types = types;
        self
    }

    /// Finds the table, compiles it, writes the code to `$OUT_DIR/<table>.rs`, and tells cargo on stdout what to watch
    /// and what to warn of. Returns the file written.
    ///
    /// # Errors
    /// The table cannot be found, read or compiled, or the code not written; the message has the drawn diagnostics.
    pub fn compile(&self) -> Result<PathBuf, BuildError> {
        let variable =
            |name| std::env::var_os(name).map(PathBuf::from).ok_or(BuildError::Environment { name });
        let (root, out) = (variable("CARGO_MANIFEST_DIR")?, variable("OUT_DIR")?);
        self.run(&root, &out, |line| println!("{line}"))
    }

    pub(crate) fn run(
        &self,
        root: &Path,
        out: &Path,
        mut tell_cargo: impl FnMut(&str),
    ) -> Result<PathBuf, BuildError> {
        let source = Source::for_build_script(&self.options.table, root).map_err(BuildError::Find)?;
        if let Some(path) = &source.path {
            tell_cargo(&format!("cargo::rerun-if-changed={}", path.display()));
        }
        let compilation = dh_codegen::compile(&source.text, Level::Quick);
        let drawn = |severity| drawn(&compilation.diagnostics, severity, &source);
        let Some(output) = &compilation.output else {
            return Err(BuildError::Table { drawn: drawn(Severity::Error).join("\n\n") });
        };
        for line in drawn(Severity::Warning).iter().flat_map(|warning| warning.lines()) {
            tell_cargo(&format!("cargo::warning={line}"));
        }
        let options = Options { table: source.name_shown.clone(), ..self.options.clone() };
        let code = rust::print(&output.model, &output.plan, &options);
        let stem = Path::new(&self.options.table).file_stem().unwrap_or(OsStr::new("robot"));
        let file = out.join(stem).with_extension("rs");
        std::fs::write(&file, code)
            .map_err(|error| BuildError::Write { file: file.clone(), reason: error.to_string() })?;
        Ok(file)
    }
}

/// The diagnostics of one severity, each drawn over the table.
fn drawn(diagnostics: &Diagnostics, severity: Severity, source: &Source) -> Vec<String> {
    let sorted = diagnostics.sorted().into_iter().filter(|diagnostic| diagnostic.severity == severity);
    sorted.map(|diagnostic| diagnostic.render(&source.text, &source.name_shown, Style::Plain)).collect()
}

/// Why a build script produced no code.
#[derive(Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum BuildError {
    /// A variable that cargo sets for build scripts is missing.
    Environment {
        /// Its name.
        name: &'static str,
    },
    /// The table cannot be found or read.
    Find(FindError),
    /// The table has errors.
    Table {
        /// All of them, drawn.
        drawn: String,
    },
    /// The code cannot be written.
    Write {
        /// Where to.
        file: PathBuf,
        /// What the system says.
        reason: String,
    },
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BuildError::Environment { name } => {
                write!(f, "{name} is not set: dh_build::Build runs in a build script")
            }
            BuildError::Find(error) => error.fmt(f),
            BuildError::Table { drawn } => f.write_str(drawn),
            BuildError::Write { file, reason } => {
                write!(f, "cannot write {}: {reason}", file.display())
            }
        }
    }
}

/// As displayed: build scripts return or unwrap this, and both print the `Debug` form.
impl fmt::Debug for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

impl std::error::Error for BuildError {}
