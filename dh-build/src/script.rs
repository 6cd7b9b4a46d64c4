//! Build scripts: a table in, a Rust file in `OUT_DIR` out.

use super::{FindError, Source};
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};

/// The whole of a `build.rs`: generates the code of one table into `OUT_DIR`, to be included with
/// `include!(concat!(env!("OUT_DIR"), "/arm.rs"))`.
#[derive(Debug, Clone, Default)]
pub struct Build {
    table: String,
    struct_name: Option<String>,
}

/// What the compiler makes of a table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Translation {
    /// The generated code, unless the table has errors.
    pub code: Option<String>,
    /// The drawn errors; empty if there are none.
    pub errors: String,
    /// The drawn warnings, one text each.
    pub warnings: Vec<String>,
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
        self.table = name.into();
        self
    }

    /// The name of the generated struct, where it is not to be made from the robot's.
    #[must_use]
    pub fn struct_name(mut self, name: impl Into<String>) -> Self {
        self.struct_name = Some(name.into());
        self
    }

    /// Finds the table, hands it to the compiler (with the struct's name, if one was given), writes the code to
    /// `$OUT_DIR/<table>.rs`, and tells cargo on stdout what to watch and what to warn of. Returns the file written.
    ///
    /// # Errors
    /// The table cannot be found, read or compiled, or the code not written; the message has the drawn diagnostics.
    pub fn compile_with(
        &self,
        compiler: impl FnOnce(&Source, Option<&str>) -> Translation,
    ) -> Result<PathBuf, BuildError> {
        let variable =
            |name| std::env::var_os(name).map(PathBuf::from).ok_or(BuildError::Environment { name });
        let (root, out) = (variable("CARGO_MANIFEST_DIR")?, variable("OUT_DIR")?);
        self.run(&root, &out, compiler, |line| println!("{line}"))
    }

    pub(crate) fn run(
        &self,
        root: &Path,
        out: &Path,
        compiler: impl FnOnce(&Source, Option<&str>) -> Translation,
        mut tell_cargo: impl FnMut(&str),
    ) -> Result<PathBuf, BuildError> {
        let source = Source::for_build_script(&self.table, root).map_err(BuildError::Find)?;
        if let Some(path) = &source.path {
            tell_cargo(&format!("cargo::rerun-if-changed={}", path.display()));
        }
        let translation = compiler(&source, self.struct_name.as_deref());
        for line in translation.warnings.iter().flat_map(|warning| warning.lines()) {
            tell_cargo(&format!("cargo::warning={line}"));
        }
        let Some(code) = translation.code.filter(|_| translation.errors.is_empty()) else {
            return Err(BuildError::Table { drawn: translation.errors });
        };
        let stem = Path::new(&self.table).file_stem().unwrap_or(OsStr::new("robot"));
        let file = out.join(stem).with_extension("rs");
        std::fs::write(&file, code)
            .map_err(|error| BuildError::Write { file: file.clone(), reason: error.to_string() })?;
        Ok(file)
    }
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
