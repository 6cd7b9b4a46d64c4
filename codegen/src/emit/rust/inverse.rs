//! Inverse functions: the nested search, and the methods that call it.

use super::Printer;
use super::body::{Body, Locals};
use super::documentation::{joint_units, operations, stages};
use super::layout::{Expression, statement};
use super::names::function_suffix;
use super::number::{self, number};
use super::text::{Text, clean};
use crate::model::{Filter, JointKind, Problem, Row, Target};
use crate::plan::{Function, FunctionKind, Measure, Scalar, Stage, ValueId, target_inputs};

impl<'a> Printer<'a> {
    /// The inverse functions of the plan with the problems that they solve; `None` is the full pose.
    pub(super) fn inverse_functions(&self) -> impl Iterator<Item = (&'a Function, Option<&'a Problem>)> {
        let model = self.model;
        self.plan.functions.iter().filter_map(move |function| match function.kind {
            FunctionKind::Inverse(None) => Some((function, None)),
            FunctionKind::Inverse(Some(problem)) => Some((function, Some(model.problems.get(problem)?))),
            _ => None,
        })
    }

    /// The methods.
    pub(super) fn inverse_methods(&self, text: &mut Text) {
        for (function, problem) in self.inverse_functions() {
            self.methods_of(text, function, problem);
        }
    }

    fn methods_of(&self, text: &mut Text, function: &Function, problem: Option<&Problem>) {
        let arguments = self.arguments(target_of(problem));
        let suffix = problem.map_or(String::new(), |problem| format!("_{}", function_suffix(&problem.name)));
        let result = format!(
            "{}<{}, {}>",
            self.paths.prelude("Result"),
            self.sized_type("Solutions"),
            self.runtime_type("IkError")
        );
        let names = arguments.names.join(", ");
        let parameters: Vec<_> = core::iter::once("&self".to_owned()).chain(arguments.parameters).collect();
        let seeded: Vec<_> =
            parameters.iter().cloned().chain([format!("seed: &{}", self.joints_type())]).collect();
        let solve = private_name(problem);
        let errors =
            format!("{}: the first step of the solution that fails decides.", self.paths.link("IkError"));
        let units = joint_units(self.model);

        text.gap();
        let mut paragraphs = vec![
            format!(
                "Every geometric solution {}, limits ignored; joints that turn are in (-pi, pi].",
                purpose(problem)
            ),
            format!("{}.", arguments.meaning),
        ];
        paragraphs.extend(problem.and_then(conditions));
        if let Some(stages) = stages(function) {
            paragraphs.push("Solved one after the other:".to_owned());
            paragraphs.push(stages);
        }
        paragraphs.push(format!("Besides solving, on each branch: {}", operations(function.counts)));
        paragraphs.extend(["# Errors".to_owned(), errors]);
        text.documentation(paragraphs);
        text.signature(&format!("pub fn ik_all{suffix}"), &parameters, &result);
        let call = Expression::Call(solve, vec![arguments.target]);
        text.laid_out(&statement(text.indent(), "", &call, ""));
        text.close("}");

        let solutions = format!("let solutions = self.ik_all{suffix}({names})?;");
        let within = "solutions.within(&Self::RULES, tool_point,";
        let limits = "where there are solutions, but none is allowed, which limit or rule the nearest to being allowed breaks.";
        text.gap();
        text.documentation([
            format!(
                "The solutions {} that whole turns bring inside the limits and no rule forbids, each in the \
                 representative nearest to the middle of the limits. Never empty.",
                purpose(problem)
            ),
            format!("{}.", arguments.meaning),
            "# Errors".to_owned(),
            format!("As [`Self::ik_all{suffix}`]; {limits}"),
        ]);
        text.signature(&format!("pub fn ik{suffix}"), &parameters, &result);
        text.line(&solutions);
        text.line(format!("{within} {})", self.paths.prelude("None")));
        text.close("}");

        text.gap();
        text.documentation([
            format!("[`Self::ik{suffix}`], each in the representative nearest to `seed` ({units}), the nearest first."),
            "# Errors".to_owned(),
            format!("As [`Self::ik{suffix}`]."),
        ]);
        text.signature(&format!("pub fn ik{suffix}_near"), &seeded, &result);
        text.line(&solutions);
        text.line(format!("{within} {}(seed))", self.paths.prelude("Some")));
        text.close("}");
    }

    /// The private functions that search.
    pub(super) fn inverse_functions_text(&self, text: &mut Text) {
        for (function, problem) in self.inverse_functions() {
            text.gap();
            self.inverse_function(text, function, problem);
        }
    }

    fn inverse_function(&self, text: &mut Text, function: &Function, problem: Option<&Problem>) {
        let locals = Locals::of(function, &self.scope());
        let body = self.body(function, &locals);
        let mut lines = Text::indented(1);
        for (index, (stage, name)) in function.stages.iter().zip(&locals.stages).enumerate() {
            lines.line(self.stage(index, stage, name));
        }
        lines.gap();
        let kind = format!("{}::{:?}", self.paths.runtime("TargetKind"), target_of(problem));
        lines.line(format!("let target = target.validate_as({kind})?;"));
        if let Some(numbers) = numbers_pattern(function, problem, &body) {
            lines.line(format!("let {numbers} = target.numbers().array();"));
        }
        lines.line(format!(
            "let mut search = {}::new({}, &{});",
            self.paths.runtime("Search"),
            self.private("REACH"),
            self.private("WINDINGS")
        ));
        body.steps(&mut lines, &function.steps, &|text, q| self.accept(text, q, problem, &body));
        lines.line("search.finish()");
        let lines = lines.into_string();

        let name =
            problem.map_or("the full pose".to_owned(), |problem| format!("`{}`", clean(&problem.name)));
        text.line(format!("/// Every solution of {name}."));
        self.allowances(text, &lines);
        let result = format!(
            "{}<{}, {}>",
            self.paths.prelude("Result"),
            self.sized_type("Solutions"),
            self.runtime_type("IkError")
        );
        text.signature(
            &format!("fn {}", private_name(problem)),
            &[format!("target: &{}", self.runtime_type("Target"))],
            &result,
        );
        text.append(&lines);
        text.close("}");
    }

    /// The description of a stage, for errors.
    fn stage(&self, index: usize, stage: &Stage, name: &str) -> String {
        let step = self.paths.runtime("Step");
        let measure = match stage.measure {
            Measure::Ratio => "Ratio",
            Measure::Length => "Length",
            Measure::Area => "Area",
        };
        let slides =
            |row: usize| self.model.rows.get(row).is_some_and(|row| row.kind == JointKind::Prismatic);
        let prismatic = (0..32).any(|row| stage.rows & (1 << row) != 0 && slides(row));
        let measure = format!("{}::{measure}", self.paths.runtime("Measure"));
        let rows = number::grouped(&format!("{:b}", stage.rows), 4);
        format!("const {name}: {step} = {step}::new({index}, 0b{rows}, {prismatic}, {measure});")
    }

    /// What is done with a candidate.
    fn accept(&self, text: &mut Text, q: &[Scalar], problem: Option<&Problem>, body: &Body<'_>) {
        let q = Expression::Array(q.iter().map(|value| body.leaves.expression(value)).collect());
        text.gap();
        text.laid_out(&statement(text.indent(), "let q =", &q, ";"));
        text.line("let (position_error, rotation_error) = target.errors(&forward_kinematics(&q));");
        let filters = problem.map_or(&[][..], |problem| &problem.filters);
        if filters.is_empty() {
            text.line("search.accept(q, position_error, rotation_error);");
            return;
        }
        for filter in filters {
            text.paragraph("//", &format!("where {}", filter.form.text));
        }
        let filters = Expression::Array(filters.iter().map(|filter| self.condition(filter)).collect());
        text.laid_out(&statement(text.indent(), "let conditions =", &filters, ";"));
        text.line("search.accept_where(q, position_error, rotation_error, &conditions);");
    }

    /// The left-hand side of an inequality at `q`, every angle in (-pi, pi].
    fn condition(&self, filter: &Filter) -> Expression {
        let function = if filter.strict { "below_zero" } else { "at_most_zero" };
        let mut form = Sum::from(self, filter.form.constant.value);
        for &(row, factor) in &filter.form.terms {
            if let Some(row) = self.model.rows.get(row) {
                form.add(factor, self.row_variable(row));
            }
        }
        Expression::Call(format!("{}::{function}", self.paths.runtime("Condition")), vec![form.expression()])
    }

    /// theta of a row, in (-pi, pi], or its d, from `q`.
    fn row_variable(&self, row: &Row) -> Expression {
        let angle = row.kind == JointKind::Revolute;
        let mut sum = Sum::from(self, if angle { row.theta.value } else { row.d });
        for &(joint, factor) in &row.terms {
            sum.add(factor, Expression::Atom(format!("q[{joint}]")));
        }
        if angle {
            Expression::Call(format!("{}::wrap_angle", self.paths.runtime("Float")), vec![sum.expression()])
        } else {
            sum.expression()
        }
    }
}

/// A sum under way, from left to right; what adds nothing is left out.
struct Sum<'a, 'p> {
    printer: &'a Printer<'p>,
    constant: f64,
    terms: Option<Expression>,
}

impl<'a, 'p> Sum<'a, 'p> {
    fn from(printer: &'a Printer<'p>, constant: f64) -> Self {
        let terms = (constant != 0.0).then(|| printer.literal(constant));
        Self { printer, constant, terms }
    }

    fn add(&mut self, factor: f64, term: Expression) {
        use super::layout::Operator::{Add, Mul, Sub};
        let size = factor.abs();
        let term = if size == 1.0 {
            term
        } else {
            Expression::Binary(Mul, Box::new(self.printer.literal(size)), Box::new(term))
        };
        self.terms = Some(match (self.terms.take(), factor < 0.0) {
            (None, false) => term,
            (None, true) => Expression::Neg(Box::new(term)),
            (Some(sum), false) => Expression::Binary(Add, Box::new(sum), Box::new(term)),
            (Some(sum), true) => Expression::Binary(Sub, Box::new(sum), Box::new(term)),
        });
    }

    fn expression(self) -> Expression {
        self.terms.unwrap_or_else(|| self.printer.literal(self.constant))
    }
}

impl Printer<'_> {
    fn literal(&self, value: f64) -> Expression {
        let text = number(value.abs(), self.options.scalar, &self.paths);
        if value < 0.0 { Expression::Neg(Box::new(Expression::Atom(text))) } else { Expression::Atom(text) }
    }
}

/// The name of the private function that solves a problem.
pub(super) fn private_name(problem: Option<&Problem>) -> String {
    problem.map_or("solve_pose".to_owned(), |problem| format!("solve_{}", function_suffix(&problem.name)))
}

fn target_of(problem: Option<&Problem>) -> Target {
    problem.map_or(Target::Pose, |problem| problem.target)
}

/// What the solutions are for.
fn purpose(problem: Option<&Problem>) -> String {
    match problem {
        None => "that brings the tool frame to a pose".to_owned(),
        Some(problem) => format!("of the table's problem `{}`", clean(&problem.name)),
    }
}

/// The constraints and inequalities of a problem, as they were written.
fn conditions(problem: &Problem) -> Option<String> {
    let quoted = |text: &str| format!("`{}`", clean(text).replace('`', "'"));
    let mut parts = Vec::new();
    if !problem.constraints.is_empty() {
        let constraints: Vec<_> =
            problem.constraints.iter().map(|constraint| quoted(&constraint.text)).collect();
        parts.push(format!("With {}", constraints.join(", ")));
    }
    if !problem.filters.is_empty() {
        let filters: Vec<_> = problem.filters.iter().map(|filter| quoted(&filter.form.text)).collect();
        parts.push(format!("{} {}", if parts.is_empty() { "Where" } else { "where" }, filters.join(", ")));
    }
    (!parts.is_empty()).then(|| format!("{}.", parts.join(", ")))
}

/// `[r11, _, r13, ..]`: the numbers of the target that are read.
fn numbers_pattern(function: &Function, problem: Option<&Problem>, body: &Body<'_>) -> Option<String> {
    let count = target_inputs(target_of(problem)).len().min(function.inputs);
    let names: Vec<_> = (0..count).map(|i| body.name(ValueId(i))).collect();
    names.iter().any(|name| *name != "_").then(|| format!("[{}]", names.join(", ")))
}
