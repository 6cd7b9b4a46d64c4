//! What a command ends with.

use crate::json::Json;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::process::ExitCode;

/// How a command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Status {
    /// All is well.
    Done,
    /// The input is wrong or has no solution; what there is to say has been said.
    Wrong,
    /// The command was not called as it must be.
    Usage,
}

impl Status {
    /// The exit status.
    pub(crate) fn code(self) -> ExitCode {
        ExitCode::from(match self {
            Status::Done => 0,
            Status::Wrong => 1,
            Status::Usage => 2,
        })
    }
}

/// Why a command did not do what it was asked for.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input could not be read, or the output not be written.
    Output(io::Error),
    /// The flags do not fit together.
    Usage(String),
    /// The table has errors, drawn over its text.
    Table {
        /// Drawings for stderr.
        drawn: String,
        /// The same in a sentence.
        refusal: Refusal,
    },
    /// The input has no answer.
    Refused(Refusal),
}

/// Why an input has no answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Refusal {
    /// A word for programs.
    pub(crate) kind: &'static str,
    /// A sentence without a full stop, numbers in the table's units.
    pub(crate) message: String,
    /// What to do instead.
    pub(crate) help: Option<String>,
    /// The numbers of the message.
    pub(crate) numbers: Vec<(&'static str, Json)>,
}

impl Refusal {
    /// Without numbers and help.
    pub(crate) fn new(kind: &'static str, message: impl Into<String>) -> Refusal {
        Refusal { kind, message: message.into(), help: None, numbers: Vec::new() }
    }

    /// With one number more.
    pub(crate) fn with(mut self, name: &'static str, value: impl Into<Json>) -> Refusal {
        self.numbers.push((name, value.into()));
        self
    }

    /// With a way out.
    pub(crate) fn help(mut self, text: impl Into<String>) -> Refusal {
        self.help = Some(text.into());
        self
    }

    /// `{"kind": .., "message": .., numbers}`
    pub(crate) fn json(&self) -> Json {
        let mut fields =
            vec![("kind", Json::from(self.kind)), ("message", Json::from(self.message.as_str()))];
        fields.extend(self.numbers.iter().cloned());
        Json::Object(fields)
    }

    /// `{"error": ..}`
    pub(crate) fn answer(&self) -> Json {
        Json::Object(vec![("error", self.json())])
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Failure::Output(error)
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        Failure::Refused(refusal)
    }
}

impl Failure {
    /// Says it on stderr, and with `json` on stdout.
    pub(crate) fn report(self, json: bool, out: &mut dyn Write) -> Status {
        let refusal = match self {
            // Who reads has seen enough.
            Failure::Output(error) if error.kind() == ErrorKind::BrokenPipe => return Status::Done,
            Failure::Output(error) => {
                complain(&format!("error: reading or writing failed: {error}"));
                return Status::Wrong;
            }
            Failure::Usage(message) => {
                complain(&format!("error: {message}\n\nFor more information, try '--help'."));
                return Status::Usage;
            }
            Failure::Table { drawn, refusal } => {
                complain(&drawn);
                refusal
            }
            Failure::Refused(refusal) if json => refusal,
            Failure::Refused(refusal) => {
                complain(&refusal.to_string());
                refusal
            }
        };
        if json {
            // The status says the same to those who do not read.
            let _ = writeln!(out, "{}", refusal.answer()).and_then(|()| out.flush());
        }
        Status::Wrong
    }
}

/// As it is told to people: `error: ...` and `help: ...`.
impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "error: {}", self.message)?;
        self.help.iter().try_for_each(|help| write!(f, "\nhelp: {help}"))
    }
}

/// Writes to stderr; where that is closed, there is nobody to tell.
pub(crate) fn complain(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Whether stderr shows colours.
pub(crate) fn coloured() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
