//! Inverse problems in closed form, derived from the table.
//!
//! The constraints are put into the chain first (`unknowns`), then the prescribed rows are written in every frame
//! (`closure`) as trigonometric polynomials in normal form (`polynomial`, `atoms`), read as equations in one unknown
//! (`reading`), and solved in the order with the fewest branches (`search`). What comes out are steps whose
//! coefficients are expressions in the target and in earlier roots (`writing`).

mod atoms;
mod candidates;
mod closure;
mod expansion;
/// Problems without a closed form as chains of six joints.
pub mod general;
mod polynomial;
mod reading;
mod roots;
mod samples;
mod search;
mod tool;
mod tracked;
mod unknowns;
mod walk;
mod writing;

use super::expression::{Arena, Expr};
use crate::model::{JointKind, Model, Problem, Target};
use tracked::Seen;

/// The solution of a problem: steps, and the joint variables in terms of their roots.
///
/// Variables of angles and of linear forms are the joints that the caller gives, then the roots of the stages.
#[derive(Debug, Clone)]
pub struct Derivation {
    /// All expressions.
    pub arena: Arena,
    /// The numbers of the target.
    pub inputs: Vec<Expr>,
    /// Names of the joints that the caller gives: `q3`.
    pub given: Vec<String>,
    /// In order.
    pub stages: Vec<Stage>,
    /// Every joint variable q.
    pub joints: Vec<Linear>,
    /// The tool frame: r11 r12 r13 px r21 ...
    pub tool: Vec<Expr>,
    /// Whether it begins at the tip: the base is what is seen.
    pub from_tip: bool,
}

impl Derivation {
    /// How many branches it has: candidates for solutions.
    pub fn branches(&self) -> usize {
        self.stages.iter().map(|stage| stage.equation.roots()).product()
    }
}

/// Sum of coefficient * variable, and a constant.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// (variable, coefficient).
    pub terms: Vec<(usize, f64)>,
    /// rad or m
    pub constant: f64,
}

/// One step.
#[derive(Debug, Clone)]
pub struct Stage {
    /// `theta23`, `d3`.
    pub unknown: String,
    /// Rows whose theta (or d) is part of the unknown.
    pub rows: Vec<usize>,
    /// Whether it is an angle.
    pub kind: JointKind,
    /// The leaf that stands for a slide's root.
    pub slide: Option<Expr>,
    /// The equation.
    pub equation: StageEquation,
    /// Power of the metre in the coefficients.
    pub dimension: u8,
    /// The equation as text.
    pub text: String,
    /// Abbreviations that it uses: (name, definition).
    pub definitions: Vec<(String, String)>,
    /// Which rows it comes from.
    pub origin: String,
    /// Of two roots, what tells the one with the positive square root: "a2 s3 > 0".
    pub plus: Option<String>,
}

/// Equations in one unknown x, with known coefficients.
#[derive(Debug, Clone, Copy)]
pub enum StageEquation {
    /// a cos x + b sin x = c
    Trig([Expr; 3]),
    /// The same where a^2 + b^2 = 1 and c is a coordinate of a unit vector, with the other two coordinates of it.
    TrigUnit([Expr; 3], [Expr; 2]),
    /// Two of those.
    TrigPair([Expr; 3], [Expr; 3]),
    /// a x = c
    Linear([Expr; 2]),
    /// a x^2 + b x + c = 0
    Quadratic([Expr; 3]),
}

impl StageEquation {
    /// How many roots it has at most.
    pub fn roots(&self) -> usize {
        match self {
            Self::Trig(_) | Self::TrigUnit(..) | Self::Quadratic(_) => 2,
            Self::TrigPair(..) | Self::Linear(_) => 1,
        }
    }

    /// In the order in which they are written above.
    pub fn coefficients(&self) -> Vec<Expr> {
        match self {
            Self::Trig(list) | Self::Quadratic(list) => list.to_vec(),
            Self::TrigUnit(list, others) => list.iter().chain(others).copied().collect(),
            Self::TrigPair(first, second) => [*first, *second].concat(),
            Self::Linear(list) => list.to_vec(),
        }
    }
}

/// Why a problem has no solution of this kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// No order of steps with one unknown each was found.
    NoClosedForm,
    /// The target is not handled by this method.
    NotByThisMethod,
    /// A row follows others by a factor that isn't a whole number, or mixes angles and lengths.
    Coupling,
}

impl Refusal {
    /// In words, for a diagnostic.
    pub fn text(&self) -> &'static str {
        match self {
            Self::NoClosedForm => "no order of steps with one unknown each solves it in closed form",
            Self::NotByThisMethod => "this target isn't solved in closed form",
            Self::Coupling => {
                "a joint follows another by a factor that is no whole number, so that its whole turns cannot be told apart"
            }
        }
    }
}

/// Whether a joint follows another by a fraction of its turns: q in (-pi, pi] would break what is asked.
fn by_a_fraction(constraint: &crate::model::Linear) -> bool {
    constraint.terms.len() > 1
        && constraint.terms.iter().any(|(_, factor)| (factor - factor.round()).abs() > 1e-12)
}

/// Derives the solution of a problem.
///
/// # Errors
/// Says why there is none in closed form.
pub fn derive(model: &Model, problem: &Problem) -> Result<Derivation, Refusal> {
    if problem.constraints.iter().any(by_a_fraction) {
        return Err(Refusal::Coupling);
    }
    let unknowns =
        unknowns::eliminate(model, &problem.constraints, &problem.free).map_err(|_| Refusal::Coupling)?;
    let from_base = solve(model, problem, &unknowns, Seen::FromBase);
    match (from_base, problem.target) {
        (Err(Refusal::NoClosedForm), Target::Pose | Target::Rotation) => {
            let from_tip = solve(model, problem, &unknowns, Seen::FromTool)?;
            Ok(Derivation { from_tip: true, ..from_tip })
        }
        (outcome, _) => outcome,
    }
}

/// The same from one end of the arm.
fn solve(
    model: &Model,
    problem: &Problem,
    unknowns: &unknowns::Unknowns,
    seen: Seen,
) -> Result<Derivation, Refusal> {
    let mut arena = Arena::default();
    let closure =
        closure::build(&mut arena, model, problem.target, unknowns, seen).map_err(
            |trouble| match trouble {
                closure::Trouble::Overflow => Refusal::NoClosedForm,
                closure::Trouble::Target => Refusal::NotByThisMethod,
            },
        )?;
    let samples = samples::draw(model, problem.target, unknowns, &closure.atoms);
    let open = closure.open(unknowns);
    let start = search::State {
        atoms: closure.atoms,
        equations: closure.equations,
        open,
        samples,
        found: Vec::new(),
    };
    match search::run(&arena, start) {
        Ok(Some(end)) => Ok(writing::write(arena, model, problem, unknowns, &end)),
        _ => Err(Refusal::NoClosedForm),
    }
}

#[cfg(test)]
mod tests;
