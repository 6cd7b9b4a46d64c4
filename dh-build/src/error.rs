//! Why a table could not be found or read.

use std::fmt;

/// Why a table could not be found or read. The message is one paragraph a place or name, ready to be shown.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum FindError {
    /// There is no such file and no shipped table of that name.
    NotFound {
        /// As the user wrote it.
        name: String,
        /// Files that were looked for, as they are shown to the user.
        tried: Vec<String>,
        /// Whether a shipped table of that name was looked for.
        shipped: bool,
        /// Shipped tables with similar names, nearest first.
        nearest: Vec<String>,
    },
    /// The file is larger than [`crate::MAX_BYTES`].
    TooLarge {
        /// The file, as shown.
        name: String,
    },
    /// The file is not UTF-8.
    NotUtf8 {
        /// The file, as shown.
        name: String,
        /// 1-based line of the first byte that is not.
        line: usize,
        /// 1-based column of that byte, in characters.
        column: usize,
    },
    /// The file is there, but the system does not let it be read.
    Unreadable {
        /// The file, as shown.
        name: String,
        /// What the system says.
        reason: String,
    },
}

impl FindError {
    /// The code under which `dhc explain` explains it.
    pub const fn code(&self) -> &'static str {
        match self {
            FindError::NotFound { .. } => "table-not-found",
            FindError::TooLarge { .. } => "table-too-large",
            FindError::NotUtf8 { .. } => "table-not-utf8",
            FindError::Unreadable { .. } => "table-unreadable",
        }
    }
}

impl fmt::Display for FindError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FindError::NotFound { name, tried, shipped, nearest } => {
                write!(f, "no robot table `{name}`")?;
                for place in tried {
                    write!(f, "\n  no file {place}")?;
                }
                if *shipped {
                    write!(f, "\n  no shipped table of that name")?;
                }
                match nearest.as_slice() {
                    [] => Ok(()),
                    [only] => write!(f, "\nhelp: there is a shipped table `{only}`"),
                    several => write!(f, "\nhelp: shipped tables with similar names: {}", several.join(", ")),
                }?;
                if *shipped && tried.is_empty() {
                    write!(f, "\nhelp: a file is named with its ending, `{name}.toml`")?;
                }
                Ok(())
            }
            FindError::TooLarge { name } => {
                write!(
                    f,
                    "{name}: the file is larger than the {} KiB that a robot table may have",
                    crate::MAX_BYTES / 1024
                )
            }
            FindError::NotUtf8 { name, line, column } => {
                write!(f, "{name}:{line}:{column}: not UTF-8 from here on; save the file as UTF-8")
            }
            FindError::Unreadable { name, reason } => write!(f, "{name}: cannot be read: {reason}"),
        }
    }
}

impl std::error::Error for FindError {}
