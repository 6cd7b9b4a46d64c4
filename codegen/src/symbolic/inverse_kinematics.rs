//! Inverse problems in closed form, derived from the table.
//!
//! The constraints are put into the chain first (`unknowns`), then the prescribed rows are written in every frame
//! (`closure`) as trigonometric polynomials in normal form (`polynomial`, `atoms`), read as equations in one unknown
//! (`reading`), and solved in the order with the fewest branches (`search`). What comes out are steps whose
//! coefficients are expressions in the target and in earlier roots (`writing`).

mod atoms;
mod candidates;
mod circuit;
mod closure;
mod closures;
mod elimination;
mod expansion;
/// Problems without a closed form as chains of six joints.
pub mod general;
mod polynomial;
mod reading;
mod refusal;
mod roots;
/// Problems of any kind as chains whose rows follow a few unknowns.
pub mod rows;
mod samples;
mod search;
mod tool;
mod tracked;
mod unit_vector;
mod unknowns;
mod walk;
mod writing;

use super::expression::{Arena, Expr};
use crate::model::{Chain, JointKind, Model, Problem, Target};
pub use closures::Closures;
pub use refusal::{Idle, Refusal};
use search::Steps;
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
    /// Where it begins.
    pub begins: Begins,
}

/// The link from which the circuit of arm and target is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Begins {
    /// The base.
    Base,
    /// The tip: the base is what is seen.
    Tip,
    /// One between two joints.
    Between,
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
    /// Two of those, which are independent.
    TrigPair([Expr; 3], [Expr; 3]),
    /// Two of those, which say the same wherever both say something.
    TrigEither([Expr; 3], [Expr; 3]),
    /// a x = c
    Linear([Expr; 2]),
    /// a x^2 + b x + c = 0
    Quadratic([Expr; 3]),
    /// (k1 + l1 cos x + m1 sin x)^2 + (k2 + l2 cos x + m2 sin x)^2 = n^2
    Quartic([[Expr; 3]; 2], Expr, Option<OfVector<Expr>>),
}

/// The first sum of a quartic, where it is a coordinate of a vector that keeps its length, less a number h.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OfVector<T> {
    /// k, l and m of the other two coordinates.
    pub others: [[T; 3]; 2],
    /// The length r, n + h - r and n - h - r; one of the last two is 0.
    pub length: [T; 3],
}

impl<T> OfVector<T> {
    /// In the order in which they are written above.
    pub fn coefficients(&self) -> impl Iterator<Item = &T> {
        self.others.as_flattened().iter().chain(&self.length)
    }

    /// The same of something else.
    pub fn map<U>(&self, mut f: impl FnMut(&T) -> U) -> OfVector<U> {
        OfVector {
            others: self.others.each_ref().map(|form| form.each_ref().map(&mut f)),
            length: self.length.each_ref().map(&mut f),
        }
    }
}

impl StageEquation {
    /// How many roots it has at most.
    pub fn roots(&self) -> usize {
        match self {
            Self::Trig(_) | Self::TrigUnit(..) | Self::TrigEither(..) | Self::Quadratic(_) => 2,
            Self::TrigPair(..) | Self::Linear(_) => 1,
            Self::Quartic(..) => 4,
        }
    }

    /// In the order in which they are written above.
    pub fn coefficients(&self) -> Vec<Expr> {
        match self {
            Self::Trig(list) | Self::Quadratic(list) => list.to_vec(),
            Self::TrigUnit(list, others) => list.iter().chain(others).copied().collect(),
            Self::TrigPair(first, second) | Self::TrigEither(first, second) => [*first, *second].concat(),
            Self::Linear(list) => list.to_vec(),
            Self::Quartic(forms, right, vector) => {
                let vector = vector.iter().flat_map(OfVector::coefficients);
                forms.as_flattened().iter().chain([right]).chain(vector).copied().collect()
            }
        }
    }
}

/// Derives the solution of a problem.
///
/// # Errors
/// Says why there is none in closed form.
pub fn derive(model: &Model, problem: &Problem) -> Result<Derivation, Refusal> {
    derive_with(&mut Closures::of(model), problem)
}

/// The same with equations that problems may share.
///
/// # Errors
/// Says why there is none in closed form.
pub fn derive_with(closures: &mut Closures<'_>, problem: &Problem) -> Result<Derivation, Refusal> {
    let model = closures.model;
    refusal::by_a_fraction(&problem.constraints)?;
    let unknowns = unknowns::eliminate(model, &problem.constraints, &problem.free)
        .map_err(|trouble| Refusal::of(trouble, model))?;
    let mut outcome = from_ends(closures, problem, &unknowns, Steps::Quadratic);
    // What an arm is off by makes small coefficients: the form of the arm that was meant has none, and fewer roots.
    let is_nearly_special = outcome.is_err()
        && if problem.target.is_any_turn() { model.nominal_to_tool_axis() } else { model.nominal() }
            .is_some();
    let whole = problem.target == Target::Pose && unknowns.to_find() == Target::Pose.rows();
    if let (Err(Refusal::NoClosedForm), true) = (&outcome, whole) {
        outcome = around(model, problem, &unknowns);
        if outcome.is_err() && !is_nearly_special {
            outcome = beside_parallels(closures, problem, &unknowns);
        }
    } else if let (Err(Refusal::NoClosedForm), false) = (&outcome, is_nearly_special) {
        outcome = from_ends(closures, problem, &unknowns, Steps::Quartic);
    }
    outcome
}

/// The same from behind the joint in the middle of the three that are beside three parallel axes.
fn beside_parallels(
    closures: &mut Closures<'_>,
    problem: &Problem,
    unknowns: &unknowns::Unknowns,
) -> Result<Derivation, Refusal> {
    let model = closures.model;
    let plain = model.chain();
    let joints = plain.joints.len();
    let is_parallel = |behind: &usize| {
        let mut arena = Arena::default();
        let circuit = circuit::Circuit::cut(&mut arena, model, &plain, unknowns, *behind);
        circuit.ok().flatten().is_some_and(|mut circuit| circuit.is_parallel())
    };
    for behind in (1..=joints).rev().filter(is_parallel) {
        let found = match behind {
            1 => solve(closures, problem, unknowns, Seen::FromTool, Steps::Quartic)
                .map(|found| Derivation { begins: Begins::Tip, ..found }),
            _ if behind == joints => solve(closures, problem, unknowns, Seen::FromBase, Steps::Quartic),
            _ => between(model, problem, unknowns, behind),
        };
        if found.is_ok() {
            return found;
        }
    }
    Err(Refusal::NoClosedForm)
}

/// The same from behind a joint, by all equations at once.
fn between(
    model: &Model,
    problem: &Problem,
    unknowns: &unknowns::Unknowns,
    behind: usize,
) -> Result<Derivation, Refusal> {
    let (mut arena, plain) = (Arena::default(), model.chain());
    let end = circuit::Circuit::cut(&mut arena, model, &plain, unknowns, behind).and_then(|circuit| {
        let Some(mut circuit) = circuit else { return Ok(None) };
        let open = circuit.open();
        let (atoms, equations) = circuit.pose()?;
        let samples = samples::draw(model, Target::Pose, unknowns, &atoms);
        let start =
            search::State { overdetermined: false, atoms, equations, open, samples, found: Vec::new() };
        Ok(search::run(circuit.arena(), start, Steps::Quartic)?)
    });
    match end {
        Ok(Some(end)) if end.is_sound() => {
            let found = writing::write(arena, model, problem, unknowns, &end);
            Ok(Derivation { begins: Begins::Between, ..found })
        }
        _ => Err(Refusal::NoClosedForm),
    }
}

/// The same from either end of the arm, where the target says as much seen from the tool.
fn from_ends(
    closures: &mut Closures<'_>,
    problem: &Problem,
    unknowns: &unknowns::Unknowns,
    steps: Steps,
) -> Result<Derivation, Refusal> {
    let outcome = solve(closures, problem, unknowns, Seen::FromBase, steps);
    if let (Err(Refusal::NoClosedForm), Target::Pose | Target::Rotation) = (&outcome, problem.target) {
        let from_tip = solve(closures, problem, unknowns, Seen::FromTool, steps);
        return from_tip.map(|found| Derivation { begins: Begins::Tip, ..found });
    }
    outcome
}

/// The same from any link of the circuit that arm and target make, behind which the axes of three joints meet.
fn around(model: &Model, problem: &Problem, unknowns: &unknowns::Unknowns) -> Result<Derivation, Refusal> {
    let plain = model.chain();
    let joints = plain.joints.len();
    let meet = |behind: &usize| {
        let mut arena = Arena::default();
        let circuit = circuit::Circuit::cut(&mut arena, model, &plain, unknowns, *behind);
        circuit.ok().flatten().is_some_and(|mut circuit| circuit.meets())
    };
    let cuts: Vec<usize> = (1..=joints).rev().filter(meet).collect();
    for steps in [Steps::Quadratic, Steps::Quartic] {
        for &behind in &cuts {
            let mut arena = Arena::default();
            if let Ok(Some(end)) = cut(&mut arena, model, &plain, unknowns, behind, steps) {
                let found = writing::write(arena, model, problem, unknowns, &end);
                let begins = if behind == joints { Begins::Base } else { Begins::Between };
                return Ok(Derivation { begins, ..found });
            }
        }
    }
    Err(Refusal::NoClosedForm)
}

/// The same with the cut behind one joint: the point in which the last three axes meet, then the rotation.
fn cut(
    arena: &mut Arena,
    model: &Model,
    plain: &Chain,
    unknowns: &unknowns::Unknowns,
    behind: usize,
    steps: Steps,
) -> Result<Option<search::State>, closure::Trouble> {
    let Some(mut circuit) = circuit::Circuit::cut(arena, model, plain, unknowns, behind)? else {
        return Ok(None);
    };
    let open = circuit.open();
    let Some((atoms, equations)) = circuit.point()? else { return Ok(None) };
    let samples = samples::draw(model, Target::Pose, unknowns, &atoms);
    let before = circuit::open_in(&open, &equations);
    let start =
        search::State { overdetermined: false, atoms, equations, open: before, samples, found: Vec::new() };
    let Some(end) = search::run(circuit.arena(), start, steps)? else { return Ok(None) };
    let mut open = open;
    open.angles.retain(|angle| !end.found.iter().any(|found| found.unknown.place() == Some(*angle)));
    open.slides
        .retain(|slide| !end.found.iter().any(|found| found.unknown == search::Unknown::Slide(*slide)));
    let (atoms, equations) = circuit.rotation(end.atoms, &end.found, &open)?;
    let start = search::State { atoms, equations, open, ..end };
    Ok(search::run(circuit.arena(), start, steps)?)
}

/// The same from one end of the arm.
fn solve(
    closures: &mut Closures<'_>,
    problem: &Problem,
    unknowns: &unknowns::Unknowns,
    seen: Seen,
    steps: Steps,
) -> Result<Derivation, Refusal> {
    let model = closures.model;
    let (arena, closure) = closures.get(problem.target, unknowns, seen).map_err(|trouble| match trouble {
        closure::Trouble::Overflow => Refusal::NoClosedForm,
        closure::Trouble::Target => Refusal::NotByThisMethod,
    })?;
    let samples = samples::draw(model, problem.target, unknowns, &closure.atoms);
    let open = closure::open(&closure.atoms, unknowns);
    let unknown = unknowns.to_find();
    let start = search::State {
        overdetermined: unknown < problem.target.rows(),
        atoms: closure.atoms,
        equations: closure.equations,
        open,
        samples,
        found: Vec::new(),
    };
    match search::run(&arena, start, steps) {
        Ok(Some(end)) if steps == Steps::Quadratic || end.is_sound() => {
            Ok(writing::write(arena, model, problem, unknowns, &end))
        }
        _ => Err(Refusal::NoClosedForm),
    }
}

#[cfg(test)]
mod tests;
