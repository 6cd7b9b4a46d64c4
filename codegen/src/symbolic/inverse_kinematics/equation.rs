//! An equation of a problem, and where it comes from.

use super::polynomial::Polynomial;
use std::fmt;

/// polynomial = 0, and where it comes from.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    pub polynomial: Polynomial,
    /// Frame and tracked quantity; rows of one group are coordinates of one vector.
    pub group: usize,
    /// Where it comes from.
    pub origin: Origin,
    /// What its known part is called: `y1`.
    pub name: String,
}

/// Where an equation comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Origin {
    /// Whether it is a sum of squares.
    pub squares: bool,
    /// Rows of a vector (1-based); none where `of` says it all.
    pub rows: Vec<usize>,
    /// "the position in frame 1"
    pub of: String,
    /// A second equation beside it, of another vector.
    pub and: Option<Box<Origin>>,
}

impl Origin {
    pub(super) fn whole(of: String) -> Self {
        Self { squares: false, rows: Vec::new(), of, and: None }
    }

    /// Of two equations together.
    pub(super) fn with(&self, other: &Self) -> Self {
        if self.of == other.of && self.squares == other.squares && !self.rows.is_empty() {
            let rows = [self.rows.as_slice(), &other.rows].concat();
            return Self { rows, ..self.clone() };
        }
        Self { and: Some(Box::new(other.clone())), ..self.clone() }
    }
}

/// "squares of rows 1 and 2 of the position in frame 1"
impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.squares {
            f.write_str("squares of ")?;
        }
        match self.rows.as_slice() {
            [] => {}
            [row] => write!(f, "row {row} of ")?,
            [first, second] => write!(f, "rows {first} and {second} of ")?,
            _ => f.write_str("all rows of ")?,
        }
        f.write_str(&self.of)?;
        match &self.and {
            Some(other) => write!(f, "; {other}"),
            None => Ok(()),
        }
    }
}
