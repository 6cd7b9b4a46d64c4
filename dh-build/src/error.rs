//! Why a table could not be found or read.

use dh_codegen::diagnostic::{Diagnostic, catalogue};
use std::fmt;

/// Why a table could not be found or read.
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
    /// The same as a diagnostic of the compiler, so that it is drawn and explained like those.
    pub fn diagnostic(&self) -> Diagnostic {
        let code = match self {
            FindError::NotFound { .. } | FindError::Unreadable { .. } => catalogue::MISSING_FILE,
            FindError::TooLarge { .. } => catalogue::TOO_LARGE,
            FindError::NotUtf8 { .. } => catalogue::NOT_UTF8,
        };
        let diagnostic = Diagnostic::error(code, self.message());
        self.help().into_iter().fold(diagnostic, Diagnostic::help)
    }

    /// The name under which it is shown.
    pub fn name(&self) -> &str {
        match self {
            FindError::NotFound { name, .. }
            | FindError::TooLarge { name }
            | FindError::NotUtf8 { name, .. }
            | FindError::Unreadable { name, .. } => name,
        }
    }

    fn message(&self) -> String {
        match self {
            FindError::NotFound { name, tried, shipped, .. } => {
                let mut places: Vec<String> = tried.iter().map(|place| format!("no file {place}")).collect();
                if *shipped {
                    places.push("no shipped table of that name".to_owned());
                }
                format!("there is no robot table `{name}`: {}", places.join(", "))
            }
            FindError::TooLarge { name } => {
                format!(
                    "{name} is larger than the {} KiB that a robot table may have",
                    crate::MAX_BYTES / 1024
                )
            }
            FindError::NotUtf8 { name, line, column } => {
                format!("{name}:{line}:{column}: the text is not UTF-8 from here on")
            }
            FindError::Unreadable { name, reason } => format!("{name} cannot be read: {reason}"),
        }
    }

    fn help(&self) -> Vec<String> {
        let FindError::NotFound { name, tried, nearest, .. } = self else { return Vec::new() };
        let mut help = Vec::new();
        match nearest.as_slice() {
            [] => {}
            [only] => help.push(format!("there is a shipped table `{only}`")),
            several => help.push(format!("shipped tables with similar names: {}", several.join(", "))),
        }
        if tried.is_empty() {
            help.push(format!("a file is named with its ending: `{name}.toml`"));
        }
        help
    }
}

/// The message, and a line of help each.
impl fmt::Display for FindError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message())?;
        self.help().iter().try_for_each(|help| write!(f, "\nhelp: {help}"))
    }
}

impl std::error::Error for FindError {}
