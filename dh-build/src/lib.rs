//! Finds and reads robot tables for the macro, for build scripts and for the command line.
//!
//! The three differ only in where a name may lead ([`Source::for_macro`], [`Source::for_build_script`],
//! [`Source::for_command_line`]); reading, its limits and its errors are the same. [`Build`] is the whole of a
//! `build.rs`.

mod error;
mod find;
mod read;
mod script;
#[cfg(test)]
mod tests;

pub use dh_codegen::emit::rust::{ScalarType, Types};
pub use error::FindError;
pub use read::MAX_BYTES;
pub use script::{Build, BuildError};

use std::path::PathBuf;

/// The text of a table and where it came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// What messages and generated code call it: a path as the user would write it, never an absolute one unless the
    /// user wrote that; or the name of a shipped table.
    pub name_shown: String,
    /// The file, as an absolute path, for tracking changes; `None` for a shipped table.
    pub path: Option<PathBuf>,
    /// The table.
    pub text: String,
}
