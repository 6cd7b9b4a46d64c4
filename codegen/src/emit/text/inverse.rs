//! Inverse problems: what is given and held, then one unknown after the other.

mod solve;

use super::algebra::{Factor, Sum};
use super::layout::Text;
use super::scope::{Scope, Writer};
use super::variables;
use crate::model::{JointKind, Model, Problem, Target};
use crate::plan::{Equation, Function, Scalar, Stage, Step, ValueId, target_inputs};
use dh_core::FULL_POSE;
use solve::Solution;
use std::collections::BTreeSet;

/// Derivations that were printed: the problem's name and the text.
pub(super) type Printed = Vec<(String, String)>;

/// One inverse function.
pub(super) fn print<'a>(
    writer: &mut Writer<'a>,
    function: &'a Function,
    problem: Option<usize>,
    printed: &mut Printed,
    text: &mut Text,
) {
    let problem = problem.and_then(|index| writer.model.problems.get(index));
    let name = problem.map_or(FULL_POSE, |problem| problem.name.as_str());
    introduction(name, problem, text);
    let in_steps = matches!(function.steps.as_slice(), [.., Step::Solve { .. }]);
    if in_steps && problem.is_some_and(|problem| problem.target.is_any_turn()) {
        text.line(1, OPEN_TURN);
    }
    for joint in function.free.iter().filter_map(|joint| writer.model.joints.get(*joint)) {
        text.line(1, &format!("given q{}: left to the caller", joint + 1));
    }
    // Abbreviations that the derivation names stay; those that only save the program work are put in.
    let named = function.stages.iter().flat_map(|stage| &stage.definitions).map(|(name, _)| name.as_str());
    let model = writer.model;
    let scope = Scope::new(writer, function, named.collect::<BTreeSet<_>>());
    let mut body = Text::default();
    let mut derivation = Derivation { model, function, scope, slides: Vec::new(), text: &mut body };
    derivation.steps(&function.steps);
    let body = body.into_string();
    text.gap();
    match printed.iter().find(|(_, known)| *known == body) {
        // Problems that differ in what they keep are solved alike.
        Some((other, _)) => text.line(1, &format!("Solved as {other}.")),
        None => text.append(&body),
    }
    printed.push((name.to_owned(), body));
}

/// What the steps of a target speak of that says nothing of a turn about the tool's z axis.
const OPEN_TURN: &str = "left open: how the tool is turned about its z axis; the foot on that axis is where its common normal with the last joint's axis meets it";

/// What is given and held.
fn introduction(name: &str, problem: Option<&Problem>, text: &mut Text) {
    let target = problem.map_or(Target::Pose, |problem| problem.target);
    text.line(0, &format!("Inverse kinematics: {name}"));
    text.line(1, &format!("given {}: {}", target_inputs(target).join(", "), meaning(target)));
    let Some(problem) = problem else {
        return;
    };
    for constraint in &problem.constraints {
        text.line(1, &format!("held: {}", constraint.text));
    }
    for filter in &problem.filters {
        text.line(1, &format!("kept where {}", filter.form.text));
    }
}

fn meaning(target: Target) -> &'static str {
    match target {
        Target::Pose => "the tool frame in the base frame",
        Target::Position | Target::Xy => "the tool point",
        Target::PositionDirection => "the tool point, and the direction of the tool's z axis",
        Target::PositionYaw | Target::XyYaw => {
            "the tool point, and the cosine and sine of the turn of the tool's x axis about base z"
        }
        Target::Rotation => "the axes of the tool frame",
        Target::Direction => "the direction of the tool's z axis",
        Target::Ray => "a point of the line that the tool's z axis lies on, and its direction",
        Target::Lookat => "a point that the tool's z axis passes through",
    }
}

struct Derivation<'a, 'w, 't> {
    model: &'a Model,
    function: &'a Function,
    scope: Scope<'a, 'w>,
    /// Roots that are lengths.
    slides: Vec<ValueId>,
    text: &'t mut Text,
}

impl Derivation<'_, '_, '_> {
    fn steps(&mut self, steps: &[Step]) {
        let mut definitions = Vec::new();
        for step in steps {
            match step {
                Step::Let { name, value } => {
                    let sum = self.scope.define(*name, value);
                    let name = self.scope.name(*name);
                    definitions.extend(sum.map(|sum| format!("{name} = {sum}")));
                }
                Step::SinCos { sin, cos, angle } => {
                    let names = self.scope.sin_cos(*sin, *cos);
                    // s1 and c1 of an unknown theta1 need no explanation.
                    if !matches!(angle, Scalar::Value(_)) || names.quarters != 0.0 {
                        let angle = self.angle(angle, names.quarters);
                        definitions.push(format!("{} = sin({angle})", names.sin));
                        definitions.push(format!("{} = cos({angle})", names.cos));
                    }
                }
                Step::Solve { stage, root, equation, body, .. } => {
                    self.stage(*stage, *root, equation, &definitions);
                    self.steps(body);
                }
                Step::General { stage: index, chain, roots, body, .. } => {
                    self.note_slides(roots);
                    if let Some(stage) = self.function.stages.get(*index) {
                        self.text.gap();
                        self.text.line(1, &format!("Step {}: all joints, by {}", index + 1, stage.unknown));
                        self.text.line(2, &stage.equation);
                        self.text.line(2, &format!("({})", stage.origin));
                        let most = chain.most_solutions();
                        self.text.line(
                            2,
                            &format!(
                                "up to {most} solutions; each is brought to the pose by Newton's method"
                            ),
                        );
                        self.text.lines(2, self.function.sign(*index).as_slice());
                    }
                    self.steps(body);
                }
                Step::Descents { stage: index, roots, body, .. } => {
                    self.note_slides(roots);
                    if let Some(stage) = self.function.stages.get(*index) {
                        self.text.gap();
                        self.text.line(1, &format!("Step {}: {} at once", index + 1, stage.unknown));
                        self.text.line(2, &stage.equation);
                        self.text.line(2, &format!("({})", stage.origin));
                        self.text.line(
                            2,
                            "up to 16 solutions; from those that are nearly singular it also starts beside them",
                        );
                        self.text.line(2, "nothing proves that none is missing");
                        self.text.lines(2, self.function.sign(*index).as_slice());
                    }
                    self.steps(body);
                }
                Step::Near { meant, body, otherwise, .. } => {
                    self.text.gap();
                    self.text.line(1, &format!("The arm that was meant ({meant}):"));
                    self.steps(body);
                    self.text.gap();
                    self.text.line(
                        1,
                        "Each solution is brought to the target by Newton's method on the table as written.",
                    );
                    self.text.line(
                        1,
                        "Near singular poses along the curve of what is missing; where that may not be all:",
                    );
                    self.steps(otherwise);
                }
                Step::Accept { q, .. } => self.joints(q),
            }
        }
    }

    fn angle(&self, angle: &Scalar, quarters: f64) -> String {
        let form = self.scope.form(angle).map(|mut form| {
            form.constant += quarters;
            form
        });
        form.map_or_else(String::new, |form| self.scope.written(&form, JointKind::Revolute, &self.slides))
    }

    /// Of joints that are found at once, those that are lengths.
    fn note_slides(&mut self, roots: &[ValueId]) {
        let angle = |root: &ValueId| self.scope.name(*root).starts_with("theta");
        let slides: Vec<_> = roots.iter().filter(|root| !angle(root)).copied().collect();
        self.slides.extend(slides);
    }

    fn stage(&mut self, index: usize, root: ValueId, equation: &Equation, definitions: &[String]) {
        let Some(stage) = self.function.stages.get(index) else {
            return;
        };
        if slides(self.model, stage) {
            self.slides.push(root);
        }
        let name = self.scope.name(root);
        let unknown = Unknown { name };
        let sum = unknown.suffix().and_then(|suffix| variables::sum_of_rows(suffix, stage.rows));
        let meaning = sum.filter(|sum| sum != name).map_or_else(String::new, |sum| format!(" = {sum}"));
        self.text.gap();
        self.text.line(1, &format!("Step {}: {name}{meaning}", index + 1));
        self.text.lines(2, definitions);
        let solution = Solution::of(&unknown, equation, self.model.units, &mut |x| self.scope.sum(x));
        self.text.lines(2, &solution.equations);
        self.text.line(2, &format!("({})", stage.origin));
        self.text.lines(2, &solution.roots);
        self.text.lines(2, &solution.remarks);
        let bit = self.function.branch.iter().find(|bit| usize::from(bit.step) == index);
        if let (Some(bit), Some(plus)) = (bit, solution.plus) {
            self.text.line(2, &format!("{bit} + where {plus}, else -"));
        }
    }

    fn joints(&mut self, q: &[Scalar]) {
        self.text.gap();
        self.text.line(1, "Joint variables");
        for (scalar, row) in q.iter().zip(&self.model.joints) {
            let kind = self.model.rows.get(*row).map_or(JointKind::Revolute, |row| row.kind);
            let value = match self.scope.form(scalar) {
                Some(form) => self.scope.written(&form, kind, &self.slides),
                None => self.scope.sum(scalar).to_string(),
            };
            self.text.line(2, &format!("q{} = {value}", row + 1));
        }
    }
}

/// Whether a stage's unknown is a length.
fn slides(model: &Model, stage: &Stage) -> bool {
    let first = model.rows.get(stage.rows.trailing_zeros() as usize);
    first.is_some_and(|row| row.kind == JointKind::Prismatic)
}

/// The unknown of a stage.
struct Unknown<'a> {
    name: &'a str,
}

impl<'a> Unknown<'a> {
    /// `23` of theta23; `None` of a length.
    fn suffix(&self) -> Option<&'a str> {
        self.name.strip_prefix("theta")
    }

    fn value(&self) -> Sum {
        Sum::factor(Factor::Unknown(0, self.name.to_owned()))
    }

    /// Its cosine and its sine.
    fn cos_sin(&self) -> [Sum; 2] {
        let name = |letter: &str| match self.suffix() {
            Some(suffix) => format!("{letter}{suffix}"),
            None => format!("{letter}({})", self.name),
        };
        [Sum::factor(Factor::Unknown(0, name("c"))), Sum::factor(Factor::Unknown(1, name("s")))]
    }
}
