//! Why a problem is not solved, and what to write instead.

use super::rows::MOST_TURNS;
use super::unknowns::Trouble;
use crate::model::{JointKind, Linear, Model, Target};

/// Why a problem has no solution of some kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// No order of steps with one unknown each was found.
    NoClosedForm,
    /// The target is not handled by this method.
    NotByThisMethod,
    /// An angle follows others by a factor that is no whole number, or a large one: only a search takes that.
    Fraction,
    /// A constraint has a factor that is no whole number.
    ByFraction {
        /// As written.
        constraint: String,
        /// What to multiply it by, so that all its factors are whole numbers.
        times: Option<u8>,
    },
    /// An angle follows a length, or a length an angle.
    MixedKinds {
        /// Name of the row that follows.
        row: String,
        /// The row that it follows.
        leader: String,
        /// Whether that one is the length.
        slides: bool,
    },
    /// So many turns after which all is as it was are more than a search takes.
    Turns {
        /// Name of the row that follows.
        row: String,
        /// The row that it follows.
        leader: String,
        /// By what factor.
        factor: String,
    },
    /// The unknowns are none, or more than can be determined.
    Unknowns {
        /// How many.
        unknowns: usize,
        /// What is prescribed.
        target: Target,
    },
    /// At every pose the joints leave some of what the target prescribes unmoved.
    Singular {
        /// The joints that are left to move.
        joints: Vec<String>,
        /// One of them that by itself moves nothing of what is prescribed.
        idle: Option<Box<Idle>>,
        /// Of them, so many by themselves: constraints and couplings tie the others to these.
        unknowns: usize,
        /// In so many ways they move what is prescribed.
        ways: usize,
        /// What is prescribed.
        target: Target,
        /// Targets that they could meet.
        suiting: Vec<Target>,
        /// Whether a pose that they can meet determines them.
        whole: bool,
    },
    /// A search doesn't find the arm's own poses.
    NotFound {
        /// How many of them were tried.
        poses: usize,
        /// From how many places each.
        starts: u32,
    },
}

/// A joint that moves nothing of what is prescribed: to hold another one would not help.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Idle {
    /// Its name.
    pub joint: String,
    /// The constraint that holds it at 0, if the others could meet a target then.
    pub held: Option<String>,
    /// Targets that they could meet without it.
    pub suiting: Vec<Target>,
}

impl Refusal {
    pub(super) fn of(trouble: Trouble, model: &Model) -> Self {
        match trouble {
            Trouble::Fraction => Self::Fraction,
            Trouble::MixedKinds { row, leader } => Self::MixedKinds {
                row: name(model, row),
                leader: name(model, leader),
                slides: model.rows.get(leader).is_some_and(|row| row.kind == JointKind::Prismatic),
            },
        }
    }

    /// A row that follows another by a factor of too many turns.
    pub(super) fn turns(model: &Model, row: usize, leader: usize, factor: f64) -> Self {
        // More digits than a table would have say nothing.
        let factor = (factor * 1e6).round() / 1e6;
        Self::Turns { row: name(model, row), leader: name(model, leader), factor: factor.to_string() }
    }

    /// In words, for a diagnostic.
    pub fn text(&self) -> String {
        match self {
            Self::NoClosedForm => "no order of steps with one unknown each solves it in closed form".to_owned(),
            Self::NotByThisMethod => "this target isn't solved in closed form".to_owned(),
            Self::Fraction => {
                "an angle follows another by a factor that is no small whole number, which no closed form takes"
                    .to_owned()
            }
            Self::ByFraction { constraint, .. } => format!(
                "the constraint `{constraint}` has a factor that is no whole number: whether it is kept would depend on the whole turns that joints have made"
            ),
            Self::MixedKinds { row, leader, slides } => {
                let (own, other) = if *slides { ("an angle", "a length") } else { ("a length", "an angle") };
                format!(
                    "`{row}`, {own}, follows `{leader}`, {other}: that is not solved, since an unknown is either an angle, alike after whole turns, or a length"
                )
            }
            Self::Turns { row, leader, factor } => format!(
                "`{row}` follows `{leader}` by a factor of {factor}: not even {MOST_TURNS} whole turns of `{leader}` bring all back to where it was"
            ),
            Self::Unknowns { unknowns, target } => {
                format!("{} left for the {} rows of `{}`", count(*unknowns, "unknown"), target.rows(), target.name())
            }
            Self::Singular { joints, ways, target, .. } => {
                let (name, rows) = (target.name(), target.rows());
                let moves = match joints.as_slice() {
                    [one] => format!("{one} moves"),
                    [others @ .., last] => format!("{} and {last} move", others.join(", ")),
                    [] => "no joint moves".to_owned(),
                };
                format!(
                    "at every pose {moves} the tool in {ways} of the {rows} ways that `{name}` prescribes, so that a target has a curve of solutions or none"
                )
            }
            Self::NotFound { poses, starts } => {
                format!("a search from {starts} places found no solution of any of {poses} poses of the arm itself")
            }
        }
    }

    /// What to write instead.
    pub fn help(&self) -> String {
        match self {
            Self::ByFraction { times: Some(times), .. } => {
                format!("multiply it by {times}: then all its factors are whole numbers")
            }
            Self::ByFraction { times: None, .. } => "multiply it so that all its factors are whole numbers".to_owned(),
            Self::MixedKinds { leader, .. } => format!(
                "hold `{leader}` by a constraint, or let angles follow angles only, and lengths follow lengths"
            ),
            Self::Turns { leader, .. } => format!(
                "if the factor was meant to be a fraction with a denominator of up to {MOST_TURNS}, write it as one, as in \"3/8\"; or hold `{leader}` by a constraint, or leave it to the caller (`free`)"
            ),
            Self::Singular { suiting, .. } if !suiting.is_empty() => {
                format!("these joints can meet another target: {}", names(suiting))
            }
            Self::Singular { idle, unknowns, ways, whole, .. } => {
                let more = unknowns.saturating_sub(*ways);
                let hold = match idle.as_deref() {
                    Some(Idle { joint, held, suiting }) => {
                        let (others, them) = match more {
                            0 | 1 => (String::new(), "it"),
                            _ => (format!(" and {} more of them", more - 1), "these"),
                        };
                        let held = match held {
                            Some(held) => format!(" (`{held}`)"),
                            None if suiting.is_empty() => String::new(),
                            None => " (not at 0)".to_owned(),
                        };
                        format!(
                            "{joint} by itself moves nothing of it: hold it by a constraint{held}{others}, or leave {them} to the caller (`free`)"
                        )
                    }
                    None => format!("hold {more} of them, or leave {more} to the caller (`free`)"),
                };
                let plural = if *ways == 1 { "" } else { "s" };
                let which = match idle.as_deref() {
                    Some(Idle { suiting, .. }) if !suiting.is_empty() => format!(": {}", names(suiting)),
                    _ => String::new(),
                };
                let whole = if *whole {
                    "; or prescribe the whole `pose`: of those that the arm can take, every solution is found"
                } else {
                    ""
                };
                format!("{hold}, and prescribe a target with {ways} row{plural}{which}{whole}")
            }
            Self::NoClosedForm | Self::NotByThisMethod | Self::Fraction | Self::Unknowns { .. } | Self::NotFound { .. } => "hold further joints by constraints, or prescribe a target that the joints left can reach one after the other".to_owned(),
        }
    }
}

fn names(targets: &[Target]) -> String {
    let names: Vec<String> = targets.iter().map(|target| format!("`{}`", target.name())).collect();
    names.join(", ")
}

fn name(model: &Model, row: usize) -> String {
    model.rows.get(row).map(|row| row.name.clone()).unwrap_or_default()
}

fn count(number: usize, what: &str) -> String {
    if number == 1 { format!("1 {what} is") } else { format!("{number} {what}s are") }
}

/// Refuses constraints by which a joint follows another by a fraction of its turns: q in (-pi, pi] would break what is asked.
pub(super) fn by_a_fraction(constraints: &[Linear]) -> Result<(), Refusal> {
    let whole = |constraint: &Linear, times: u8| {
        let mut factors = constraint.terms.iter().map(|(_, factor)| factor * f64::from(times));
        factors.all(|factor| (factor - factor.round()).abs() <= 1e-12 * f64::from(times))
    };
    match constraints.iter().find(|constraint| constraint.terms.len() > 1 && !whole(constraint, 1)) {
        None => Ok(()),
        Some(constraint) => Err(Refusal::ByFraction {
            constraint: constraint.text.clone(),
            times: (2..=MOST_TURNS).find(|times| whole(constraint, *times)),
        }),
    }
}
