//! Steps of a function as statements.

use super::expression::Leaves;
use super::layout::{Expression, WIDTH, statement};
use super::liveness::{Live, coefficients};
use super::names::Names;
use super::text::{Text, clean};
use crate::plan::{Equation, Function, FunctionKind, Scalar, Stage, Step, ValueId};

/// A kernel that finds all unknowns at once gives so many numbers.
const AT_ONCE: usize = 6;

/// A function under print.
pub(super) struct Body<'a> {
    pub(super) function: &'a Function,
    pub(super) leaves: Leaves<'a>,
    pub(super) live: Live,
    /// Name of the constant that describes each stage.
    pub(super) stages: &'a [String],
    /// Name of the constant that holds the chain of a function without a closed form.
    pub(super) chain: &'a str,
    /// Name of the constant that says how nearly special the arm is.
    pub(super) nearly: &'a str,
    /// Names of the constants that every search needs.
    pub(super) search: [&'a str; 2],
    /// What a nearly special arm's search ends with: its conditions are asked when all is found.
    pub(super) finish: &'static str,
}

/// What an inverse function comes to.
pub(super) struct Candidate<'a> {
    pub(super) q: &'a [Scalar],
    /// The tool frame there, if it is computed.
    pub(super) tool: &'a [Scalar],
    pub(super) polish: bool,
}

/// Identifiers of a function: its values and its stages.
pub(super) struct Locals {
    pub(super) values: Vec<String>,
    pub(super) stages: Vec<String>,
    pub(super) chain: String,
    pub(super) nearly: String,
    pub(super) motions: String,
}

impl Locals {
    /// Names that hide neither each other nor anything in `scope`. Inputs of forward functions are entries of `q`.
    pub(super) fn of(function: &Function, scope: &Names) -> Self {
        let mut names = scope.clone();
        let forward = !matches!(function.kind, FunctionKind::Inverse(_));
        let name = |(i, name): (usize, &String)| {
            if forward && i < function.inputs { format!("q[{i}]") } else { names.local(name) }
        };
        let values = function.values.iter().enumerate().map(name).collect();
        let mut names = scope.clone();
        let stages = function.stages.iter().map(|stage| names.constant(&stage.unknown)).collect();
        let chain = names.constant("chain");
        let nearly = names.constant("nearly");
        let motions = names.constant("motions");
        Self { values, stages, chain, nearly, motions }
    }
}

impl Body<'_> {
    /// Statements for `steps`; `accept` prints what is done with a candidate.
    pub(super) fn steps(&self, text: &mut Text, steps: &[Step], accept: &dyn Fn(&mut Text, &Candidate<'_>)) {
        let mut rest = steps;
        while let [step, others @ ..] = rest {
            if let Step::SinCos { .. } = step {
                rest = self.sines(text, rest);
                continue;
            }
            rest = others;
            match step {
                Step::Let { name, value } if self.live.value(*name) => {
                    let head = format!("let {} =", self.name(*name));
                    text.laid_out(&statement(text.indent(), &head, &self.leaves.expression(value), ";"));
                }
                Step::Let { .. } | Step::SinCos { .. } => {}
                Step::Solve { stage, root, sin_cos, equation, body } => {
                    text.gap();
                    if let Some(stage) = self.function.stages.get(*stage) {
                        explain(text, stage);
                    }
                    let call = self.kernel(*stage, equation);
                    text.laid_out(&statement(text.indent(), "let mut roots =", &call, ";"));
                    let (found, next) = self.found(equation, *root, *sin_cos);
                    let some = self.leaves.paths.prelude("Some");
                    text.line(format!("while let {some}({found}) = search.{next}(&mut roots) {{"));
                    let mut nested = Text::indented(text.indent() / 4 + 1);
                    self.steps(&mut nested, body, accept);
                    text.append(&nested.into_string());
                    text.line("}");
                }
                Step::General { stage, given, roots, body, .. }
                | Step::Descents { stage, given, roots, body, .. } => {
                    text.gap();
                    if let Some(stage) = self.function.stages.get(*stage) {
                        explain(text, stage);
                    }
                    let roots: Vec<_> = roots.iter().map(|root| self.name(*root)).collect();
                    let given = given.iter().map(|value| self.leaves.expression(value)).collect();
                    let given = Expression::Array(given).flat();
                    let arguments = [
                        self.stages.get(*stage).map_or("", String::as_str),
                        &format!("&{}", self.chain),
                        "&target",
                        &format!("&{given}"),
                    ];
                    let arguments = arguments.map(|argument| Expression::Atom(argument.to_owned())).to_vec();
                    let descends = matches!(step, Step::Descents { .. });
                    let method = if descends { "search.descents" } else { "search.general" };
                    let call = Expression::Call(method.to_owned(), arguments);
                    text.laid_out(&statement(text.indent(), "let mut candidates =", &call, ";"));
                    let some = self.leaves.paths.prelude("Some");
                    let others = if roots.len() < AT_ONCE { ", .." } else { "" };
                    let roots = roots.join(", ") + others;
                    text.line(format!(
                        "while let {some}([{roots}]) = search.next_candidate(&mut candidates) {{"
                    ));
                    let mut nested = Text::indented(text.indent() / 4 + 1);
                    self.steps(&mut nested, body, accept);
                    text.append(&nested.into_string());
                    text.line("}");
                }
                Step::Near { meant, body, otherwise, .. } => {
                    text.gap();
                    let meant = format!(
                        "The arm that was meant: {}. Its solutions are brought to the target.",
                        clean(meant)
                    );
                    text.paragraph("//", &meant);
                    let near = self.leaves.paths.runtime("Near");
                    let ([reach, windings], nearly) = (self.search, self.nearly);
                    text.line(format!(
                        "let mut search = {near}::new({reach}, &{windings}, &{nearly}, &target);"
                    ));
                    let some = self.leaves.paths.prelude("Some");
                    text.line(format!("while let {some}(asked) = search.next_target() {{"));
                    let mut nested = Text::indented(text.indent() / 4 + 1);
                    let numbers = self.function.inputs - self.function.free.len();
                    let numbers: Vec<_> = (0..numbers).map(|i| self.name(ValueId(i))).collect();
                    nested.line(format!("let [{}] = asked.numbers().array();", numbers.join(", ")));
                    self.steps(&mut nested, body, accept);
                    text.append(&nested.into_string());
                    text.line("}");
                    text.line(format!("if let {some}(answer) = {} {{", self.finish));
                    text.line("    return answer;");
                    text.line("}");
                    text.gap();
                    text.paragraph("//", "Where those may not be all, the arm as it is.");
                    let given = given(&self.function.free);
                    text.line(format!(
                        "let mut search = search.otherwise(&wanted, pose_and_jacobian){given};"
                    ));
                    self.steps(text, otherwise, accept);
                }
                Step::Accept { q, tool, polish } => accept(text, &Candidate { q, tool, polish: *polish }),
            }
        }
    }

    /// A statement for the sines and cosines that the steps begin with, of as many as one line can name. Gives the steps that
    /// are left.
    fn sines<'s>(&self, text: &mut Text, steps: &'s [Step]) -> &'s [Step] {
        let (mut pairs, mut angles) = (Vec::new(), Vec::new());
        let float = self.leaves.paths.runtime("Float");
        let all = format!("{float}::sin_cos_all");
        let mut width = text.indent() + "let [] = ([".len() + all.len();
        let mut rest = steps;
        while let Some((Step::SinCos { sin, cos, angle }, others)) = rest.split_first() {
            if self.live.value(*sin) || self.live.value(*cos) {
                let pair = format!("({}, {})", self.name(*sin), self.name(*cos));
                width += pair.len() + ", ".len();
                if width > WIDTH && !pairs.is_empty() {
                    break;
                }
                pairs.push(pair);
                angles.push(self.leaves.expression(angle));
            }
            rest = others;
        }
        let (pattern, call) = match (&pairs[..], &angles[..]) {
            ([], _) => return rest,
            ([pair], [angle]) => {
                (pair.clone(), Expression::Call(format!("{float}::sin_cos"), vec![angle.clone()]))
            }
            _ => (format!("[{}]", pairs.join(", ")), Expression::Call(all, vec![Expression::Array(angles)])),
        };
        text.laid_out(&statement(text.indent(), &format!("let {pattern} ="), &call, ";"));
        rest
    }

    /// A new search, by one of its constructors.
    pub(super) fn search(&self, [kind, constructor]: [&str; 2], more: &str, given: &[usize]) -> String {
        let [reach, windings] = self.search;
        let kind = self.leaves.paths.runtime(kind);
        let given = self::given(given);
        format!("let mut search = {kind}::{constructor}({reach}, &{windings}, &{more}){given};")
    }

    /// What a root is bound to, and which method of the search gives the next one.
    fn found(
        &self,
        equation: &Equation,
        root: ValueId,
        sin_cos: Option<[ValueId; 2]>,
    ) -> (String, &'static str) {
        let next = match equation {
            Equation::Linear { .. } | Equation::Quadratic { .. } => {
                return (self.name(root).to_owned(), "next");
            }
            Equation::Quartic { .. } => "next_of_quartic",
            _ => "next_angle",
        };
        match sin_cos {
            Some([sin, cos]) => {
                let names = [root, sin, cos].map(|id| self.name(id));
                (format!("({})", names.join(", ")), next)
            }
            None => (format!("({}, _, _)", self.name(root)), next),
        }
    }

    /// The solver's call for an equation.
    fn kernel(&self, stage: usize, equation: &Equation) -> Expression {
        let mut arguments = vec![Expression::Atom(self.stages.get(stage).cloned().unwrap_or_default())];
        let scalars = coefficients(equation).into_iter().map(|scalar| self.leaves.expression(scalar));
        let method = match equation {
            Equation::Trig { .. } => "search.trig",
            Equation::TrigUnit { .. } => "search.trig_unit",
            Equation::TrigPair { .. } => "search.trig_pair",
            Equation::TrigEither { .. } => "search.trig_either",
            Equation::Linear { .. } => "search.linear",
            Equation::Quadratic { .. } => "search.quadratic",
            Equation::Quartic { vector: None, .. } => "search.quartic",
            Equation::Quartic { vector: Some(_), .. } => "search.quartic_unit",
        };
        if let Equation::Quartic { .. } = equation {
            let scalars: Vec<_> = scalars.collect();
            let (forms, rest) = scalars.split_at(scalars.len().min(6));
            let (right, unit) = rest.split_at(rest.len().min(1));
            let (others, length) = unit.split_at(unit.len().min(6));
            let array = |forms: &[Expression]| {
                Expression::Array(forms.chunks(3).map(|form| Expression::Array(form.to_vec())).collect())
            };
            arguments.push(array(forms));
            arguments.extend(right.iter().cloned());
            if !unit.is_empty() {
                arguments.extend([array(others), Expression::Array(length.to_vec())]);
            }
        } else if let Equation::TrigUnit { .. } | Equation::TrigPair { .. } | Equation::TrigEither { .. } =
            equation
        {
            let mut first: Vec<_> = scalars.collect();
            let second = first.split_off(first.len().min(3));
            arguments.extend([Expression::Array(first), Expression::Array(second)]);
        } else {
            arguments.extend(scalars);
        }
        Expression::Call(method.to_owned(), arguments)
    }

    /// The name of a value, or `_` for one that nothing reads.
    pub(super) fn name(&self, id: ValueId) -> &str {
        if self.live.value(id) { self.leaves.values.get(id.0).map_or("_", String::as_str) } else { "_" }
    }
}

/// The equation of a stage and where it comes from, above its loop.
fn explain(text: &mut Text, stage: &Stage) {
    let (equation, origin) = (format!("{}: {}", stage.unknown, stage.equation), &stage.origin);
    if text.indent() + equation.len() + origin.len() + 6 <= 100 {
        text.paragraph("//", &format!("{equation} ({origin})"));
    } else {
        text.paragraph("//", &equation);
        text.paragraph("//", &format!("({origin})"));
    }
}

/// Tells a search which joints the caller gives.
fn given(joints: &[usize]) -> String {
    if joints.is_empty() { String::new() } else { format!(".with_given(&{joints:?})") }
}
