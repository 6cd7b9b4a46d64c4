//! Stage 1: text -> rows as written, every value with its span.
//!
//! Knows TOML and the expression language, and no geometry: names are not looked up, units are not applied, nothing is
//! compared. Keys, types and the length of lists are checked here.

use crate::diagnostic::{Diagnostic, Diagnostics, catalogue};
use std::ops::Range;
use toml::de::DeTable;

mod damage;
mod duplicates;
// Numbers in quotes.
pub mod expression;
mod fields;
mod lexer;
mod places;
mod sections;
mod types;

/// A table has at most so many bytes.
pub const LARGEST: usize = 256 * 1024;

/// Byte range in the table's text.
pub type Span = Range<usize>;

/// A value with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Written<T> {
    /// As written.
    pub value: T,
    /// Where.
    pub span: Span,
}

/// A string, with where its letters stand.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// Without quotes and escapes.
    pub value: String,
    /// With its quotes.
    pub span: Span,
    /// Where the first letter stands, if the letters stand in the text as they are (no escapes).
    pub base: Option<usize>,
}

impl Text {
    /// Where a part of the string stands in the table.
    pub fn place(&self, part: &Range<usize>) -> Span {
        self.base.map_or_else(|| self.span.clone(), |base| base + part.start..base + part.end)
    }
}

/// A number, or an expression for one.
#[derive(Debug, Clone, PartialEq)]
pub enum Number {
    /// A finite TOML number.
    Literal {
        /// Its value, in the table's units.
        value: f64,
        /// Its digits, without underscores.
        digits: String,
        /// Where.
        span: Span,
    },
    /// A string, not yet read.
    Expression(Text),
}

impl Number {
    /// Where it stands.
    pub fn span(&self) -> Span {
        match self {
            Number::Literal { span, .. } => span.clone(),
            Number::Expression(text) => text.span.clone(),
        }
    }
}

/// A list of numbers with its place.
pub type Numbers = Written<Vec<Number>>;

/// A table as written.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// Whether all of the text was read; where TOML is broken, what is missing is not the user's mistake.
    pub complete: bool,
    /// `[robot]`.
    pub robot: Option<Robot>,
    /// `[[joint]]`.
    pub joints: Vec<Joint>,
    /// `[base]`.
    pub base: Option<Placement>,
    /// `[tool]`.
    pub tool: Option<Placement>,
    /// `[workspace]`.
    pub workspace: Workspace,
    /// `[[limit]]`.
    pub limits: Vec<SumLimit>,
    /// `[poses]`, in the order of the text.
    pub poses: Vec<Pose>,
    /// `[[ik]]`.
    pub problems: Vec<Problem>,
    /// `[[servo]]`.
    pub servos: Vec<NamedServo>,
    /// `[device]`.
    pub device: Option<Device>,
}

/// `[robot]`.
#[derive(Debug, Clone, Default)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct Robot {
    pub span: Span,
    pub name: Option<Text>,
    pub manufacturer: Option<Text>,
    pub source: Option<Text>,
    pub convention: Option<Text>,
    pub length: Option<Text>,
    pub angle: Option<Text>,
}

/// A row.
#[derive(Debug, Clone, Default)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct Joint {
    pub span: Span,
    /// Its first line: `[[joint]]`.
    pub header: Span,
    pub line: usize,
    pub name: Option<Text>,
    pub kind: Option<Text>,
    pub d: Option<Number>,
    pub theta: Option<Number>,
    pub a: Option<Number>,
    pub alpha: Option<Number>,
    pub beta: Option<Number>,
    pub offset: Option<Number>,
    pub fixed: Option<Number>,
    /// Where the keys `d` and `theta` stand.
    pub d_key: Span,
    pub theta_key: Span,
    pub direction: Option<Number>,
    pub couple: Vec<(Text, Number)>,
    pub limits: Option<Numbers>,
    pub max_velocity: Option<Number>,
    pub max_acceleration: Option<Number>,
    pub max_jerk: Option<Number>,
    pub servo: Option<Servo>,
}

/// `servo = {...}`.
#[derive(Debug, Clone, Default)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct Servo {
    pub span: Span,
    pub id: Option<Number>,
    pub sign: Option<Number>,
    pub zero: Option<Number>,
    pub counts_per_turn: Option<Number>,
    pub counts_per_unit: Option<Number>,
    pub range: Option<Numbers>,
    pub model: Option<Text>,
}

/// `[base]` or `[tool]`.
#[derive(Debug, Clone, Default)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct Placement {
    pub span: Span,
    pub xyz: Option<Numbers>,
    pub rpy: Option<Numbers>,
    pub quaternion: Option<Numbers>,
}

/// `[workspace]`.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    /// Index into [`BOUNDS`] with its number.
    pub bounds: Vec<(usize, Number)>,
    /// Boxes: least and greatest corner.
    pub keep_out: Vec<KeepOut>,
}

/// The bounds of `[workspace]`: axis by axis, least first.
pub const BOUNDS: [&str; 6] = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"];

/// A box of `keep_out`.
#[derive(Debug, Clone)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct KeepOut {
    pub span: Span,
    pub min: Numbers,
    pub max: Numbers,
}

/// `[[limit]]`.
#[derive(Debug, Clone)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct SumLimit {
    pub span: Span,
    pub of: Vec<(Text, Number)>,
    pub range: Numbers,
}

/// An entry of `[poses]`.
#[derive(Debug, Clone)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct Pose {
    pub name: Text,
    pub q: Numbers,
    pub safe: bool,
}

/// `[[ik]]`.
#[derive(Debug, Clone, Default)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct Problem {
    pub span: Span,
    pub line: usize,
    /// Whether every value could be read.
    pub complete: bool,
    pub name: Option<Text>,
    pub target: Option<Text>,
    pub constraints: Vec<Text>,
    pub filters: Vec<Text>,
    pub free: Vec<Text>,
}

/// `[[servo]]`.
#[derive(Debug, Clone)]
#[allow(missing_docs, reason = "the names are the table's keys")]
pub struct NamedServo {
    pub name: Text,
    pub servo: Servo,
}

/// `[device]`.
#[derive(Debug, Clone)]
pub struct Device {
    /// `driver`.
    pub driver: Text,
    /// The other keys with their values as written, in the order of the text.
    pub keys: Vec<(String, String)>,
}

/// Reads a table. What cannot be read is reported and left out.
pub fn parse(text: &str, diagnostics: &mut Diagnostics) -> Table {
    if text.len() > LARGEST {
        let message =
            format!("the table has {} KiB, more than the 256 KiB that a table may have", text.len() / 1024);
        diagnostics.push(
            Diagnostic::error(catalogue::TOO_LARGE, message).help("leave out what is not part of the robot"),
        );
        return Table::default();
    }
    let damage::Mended { text: mended, complete } = damage::mend(text, diagnostics);
    let (root, errors) = DeTable::parse_recoverable(&mended);
    let repeated = duplicates::report(text, root.get_ref(), &errors, diagnostics);
    let line_feeds = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect();
    let mut reader = fields::Reader { text, diagnostics, line_feeds, repeated, complete };
    sections::read(&mut reader, root.get_ref())
}
