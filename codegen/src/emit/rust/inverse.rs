//! Inverse functions: the nested search.

use super::Printer;
use super::body::{Body, Candidate, Locals};
use super::layout::{Expression, statement};
use super::names::function_suffix;
use super::number::{self, number};
use super::text::{Text, clean};
use crate::model::{Filter, JointKind, Problem, Row, Target};
use crate::plan::{Form, Function, FunctionKind, Measure, Scalar, Stage, Step, ValueId};
use dh_core::FULL_POSE;

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
            let searches = function.searches(index);
            let at_once = if searches { ".at_once()" } else { "" };
            let unsigned = if function.is_unsigned(index) { ".unsigned()" } else { "" };
            lines.line(self.stage(index, stage, name, !searches, &format!("{at_once}{unsigned}")));
        }
        self.motions(&mut lines, function, &locals);
        self.arms(&mut lines, &function.steps, &locals);
        lines.gap();
        let (numbers, free) = input_patterns(function, problem, &body);
        let near = matches!(function.steps[..], [Step::Near { .. }]);
        let source = if polishes(&function.steps) && !near {
            lines.line("let pose = target.validate_pose()?;");
            "pose.rows()"
        } else {
            let kind = format!("{}::{:?}", self.paths.runtime("TargetKind"), target_of(problem));
            lines.line(format!("let target = target.validate_as({kind})?;"));
            "target.numbers().array()"
        };
        if let (Some(numbers), false) = (numbers, near) {
            lines.line(format!("let {numbers} = {source};"));
        }
        if let Some(free) = &free {
            lines.line(format!("let {free} = *free;"));
        }
        self.wanted(&mut lines, function);
        if self.asks_at_the_end(function) {
            self.broken(&mut lines, problem);
        }
        if !near {
            lines.line(body.search(["Search", "about"], "wanted", &function.free));
        }
        body.steps(&mut lines, &function.steps, &|text, candidate| {
            self.accept(text, candidate, problem, &body);
        });
        lines.line(if function.motions.is_empty() {
            body.finish.to_owned()
        } else {
            let target = if polishes(&function.steps) {
                format!("&{}::Pose(pose)", self.paths.runtime("Target"))
            } else {
                "&target".to_owned()
            };
            format!("search.finish_marked(&{}, {target}, pose_and_jacobian)", locals.motions)
        });
        let lines = lines.into_string();

        let name =
            problem.map_or("the full pose".to_owned(), |problem| format!("`{}`", clean(&problem.name)));
        text.line(format!("/// Every solution of {name}."));
        Self::allowances(text, &lines);
        allow_case(text, &private_name(problem));
        let mut parameters = vec![format!("target: &{}", self.runtime_type("Target"))];
        if let Some(count) = free_count(function) {
            self.small_arguments(text, count);
            parameters.push(format!(
                "{}: &[{}; {count}]",
                if free.is_some() { "free" } else { "_free" },
                self.scalar()
            ));
        }
        let lifetime = format!("'_{}", self.scalar_argument(", "));
        let seed = self.paths.runtime("Seed");
        parameters.push(format!("seed: {}<{seed}<{lifetime}>>", self.paths.prelude("Option")));
        text.signature(&format!("fn {}", private_name(problem)), &parameters, &self.inverse_result());
        text.append(&lines);
        text.close("}");
    }

    /// What the unknown of each step moves.
    fn motions(&self, text: &mut Text, function: &Function, locals: &Locals) {
        if function.motions.is_empty() {
            return;
        }
        let motions = function.motions.iter().zip(&locals.stages).map(|(motion, stage)| {
            let motion = Expression::Array(motion.iter().map(|share| self.literal(*share)).collect());
            Expression::Tuple(vec![Expression::Atom(stage.clone()), motion])
        });
        let (step, count) = (self.paths.runtime("Step"), function.motions.len());
        text.line("// What one unit of the unknown of each step adds to the joint values.");
        let head = format!("const {}: [({step}, {}); {count}] =", locals.motions, self.joints_type());
        text.laid_out(&statement(text.indent(), &head, &Expression::Array(motions.collect()), ";"));
    }

    /// What is wanted of the unknowns where the target leaves some free.
    fn wanted(&self, text: &mut Text, function: &Function) {
        let form = |form: &Option<Form>| {
            let Some(form) = form else {
                return Expression::Atom(format!("{}::NAN", self.scalar()));
            };
            let mut sum = Sum::from(self, form.constant);
            for &(joint, factor) in &form.terms {
                sum.add(factor, Expression::Atom(format!("q[{joint}]")));
            }
            sum.expression()
        };
        let known = function.unknowns.iter().flatten().any(|form| !form.terms.is_empty());
        let head = format!("let unknowns = |{}: &{}|", if known { "q" } else { "_" }, self.joints_type());
        let forms = Expression::Array(function.unknowns.iter().map(form).collect());
        text.laid_out(&statement(text.indent(), &head, &forms, ";"));
        text.line(format!("let wanted = {}::of(seed, unknowns)?;", self.paths.runtime("Wanted")));
    }

    /// The description of a stage, for errors.
    fn stage(&self, index: usize, stage: &Stage, name: &str, slides: bool, more: &str) -> String {
        let step = self.paths.runtime("Step");
        let measure = match stage.measure {
            Measure::Ratio => "Ratio".to_owned(),
            Measure::Length => "Length".to_owned(),
            Measure::Area => "Area".to_owned(),
            Measure::Power(power) => format!("Power({power})"),
        };
        let is_slide =
            |row: usize| self.model.rows.get(row).is_some_and(|row| row.kind == JointKind::Prismatic);
        let prismatic = (0..32).any(|row| slides && stage.rows & (1 << row) != 0 && is_slide(row));
        let measure = format!("{}::{measure}", self.paths.runtime("Measure"));
        let rows = number::grouped(&format!("{:b}", stage.rows), 4);
        format!("const {name}: {step} = {step}::new({index}, 0b{rows}, {prismatic}, {measure}){more};")
    }

    /// What is done with a candidate.
    fn accept(&self, text: &mut Text, candidate: &Candidate<'_>, problem: Option<&Problem>, body: &Body<'_>) {
        let written = |scalars: &[Scalar]| -> Vec<Expression> {
            scalars.iter().map(|value| body.leaves.expression(value)).collect()
        };
        let q = Expression::Array(written(candidate.q));
        text.gap();
        text.laid_out(&statement(text.indent(), "let q =", &q, ";"));
        let tool = if candidate.tool.is_empty() {
            "&forward_kinematics(&q)"
        } else {
            let tool = self.frame(&written(candidate.tool));
            text.laid_out(&statement(text.indent(), "let tool =", &tool, ";"));
            "&tool"
        };
        if candidate.polish {
            let near = matches!(body.function.steps[..], [Step::Near { .. }]);
            let (accept, target) = if near { ("accept", "") } else { ("accept_pose", "&pose, ") };
            text.line(format!("search.{accept}(q, {tool}, {target}pose_and_jacobian);"));
            return;
        }
        let tool = Expression::Atom(tool.to_owned());
        let errors = Expression::Call("target.errors".to_owned(), vec![tool]);
        let head = "let (position_error, rotation_error) =";
        text.laid_out(&statement(text.indent(), head, &errors, ";"));
        let filters = problem.map_or(&[][..], |problem| &problem.filters);
        if filters.is_empty() {
            text.line("search.accept(q, position_error, rotation_error);");
            return;
        }
        self.conditions(text, filters);
        text.line("search.accept_where(q, position_error, rotation_error, &conditions);");
    }

    /// Whether a function asks the conditions of its problem when all solutions are found: those of a nearly special arm are
    /// moved before they are any.
    pub(super) fn asks_at_the_end(&self, function: &Function) -> bool {
        let problem = match function.kind {
            FunctionKind::Inverse(Some(index)) => self.model.problems.get(index),
            _ => None,
        };
        let near = matches!(function.steps[..], [Step::Near { .. }]);
        near && problem.is_some_and(|problem| !problem.filters.is_empty())
    }

    /// `let broken = ...`: which condition joint values break.
    fn broken(&self, text: &mut Text, problem: Option<&Problem>) {
        text.open(format!("let broken = |q: &{}| {{", self.joints_type()));
        self.conditions(text, problem.map_or(&[][..], |problem| &problem.filters));
        text.line(format!("{}::broken(&conditions)", self.paths.runtime("Condition")));
        text.close("};");
    }

    /// `let conditions = ...`, of joint values `q`.
    fn conditions(&self, text: &mut Text, filters: &[Filter]) {
        for filter in filters {
            text.paragraph("//", &format!("where {}", filter.form.text));
        }
        let filters = Expression::Array(filters.iter().map(|filter| self.condition(filter)).collect());
        text.laid_out(&statement(text.indent(), "let conditions =", &filters, ";"));
    }

    /// `broken_condition`, where a problem has conditions.
    pub(super) fn broken_condition(&self, text: &mut Text) {
        let problems = self.inverse_functions().filter_map(|(_, problem)| problem);
        let mut problems = problems.filter(|problem| !problem.filters.is_empty()).peekable();
        if problems.peek().is_none() {
            return;
        }
        let (option, none) = (self.paths.prelude("Option"), self.paths.prelude("None"));
        let parameters = ["&self".to_owned(), "problem: &str".to_owned(), format!("q: &[{}]", self.scalar())];
        text.gap();
        text.signature(
            "fn broken_condition",
            &parameters,
            &format!("{option}<{}>", self.runtime_type("Rule")),
        );
        let joint_array = self.paths.runtime("joint_array");
        text.line(format!(
            "let q: &[{}; {}] = {joint_array}(q).ok()?;",
            self.scalar(),
            self.model.joints.len()
        ));
        text.open("match problem {");
        for problem in problems {
            text.open(format!("{:?} => {{", problem.name));
            self.conditions(text, &problem.filters);
            text.line(format!("{}::broken(&conditions)", self.paths.runtime("Condition")));
            text.close("}");
        }
        text.line(format!("_ => {none},"));
        text.close("}");
        text.close("}");
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
        for &(joint, factor) in &filter.q {
            let row = self.model.joints.get(joint).and_then(|row| self.model.rows.get(*row));
            let value = Expression::Atom(format!("q[{joint}]"));
            let turns = row.is_some_and(|row| row.kind == JointKind::Revolute);
            form.add(factor, if turns { self.wrapped(value) } else { value });
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
        if angle { self.wrapped(sum.expression()) } else { sum.expression() }
    }

    /// An angle in (-pi, pi].
    fn wrapped(&self, angle: Expression) -> Expression {
        Expression::Call(format!("{}::wrap_angle", self.paths.runtime("Float")), vec![angle])
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

/// Whether candidates are brought nearer to the pose.
fn polishes(steps: &[Step]) -> bool {
    steps.iter().any(|step| match step {
        Step::Solve { body, .. } | Step::General { body, .. } | Step::Descents { body, .. } => polishes(body),
        Step::Accept { polish, .. } => *polish,
        Step::Near { .. } => true,
        Step::Let { .. } | Step::SinCos { .. } => false,
    })
}

/// The name of the private function that solves a problem.
pub(super) fn private_name(problem: Option<&Problem>) -> String {
    match suffix(problem).as_str() {
        "" => "solve_pose".to_owned(),
        suffix => format!("solve{suffix}"),
    }
}

/// What follows `ik` in the names of a problem's methods: nothing for the full pose, in whichever way it is solved.
pub(super) fn suffix(problem: Option<&Problem>) -> String {
    match problem {
        Some(problem) if problem.name != FULL_POSE => format!("_{}", function_suffix(&problem.name)),
        _ => String::new(),
    }
}

/// Names that are not in snake case are the table's.
pub(super) fn allow_case(text: &mut Text, name: &str) {
    if name.chars().any(|c| c.is_ascii_uppercase()) {
        text.allow(&["non_snake_case"], "the name is that of the table");
    }
}

pub(super) fn target_of(problem: Option<&Problem>) -> Target {
    problem.map_or(Target::Pose, |problem| problem.target)
}

/// How many joints a function leaves to the caller, where it does.
pub(super) fn free_count(function: &Function) -> Option<usize> {
    Some(function.free.len()).filter(|count| *count > 0)
}

/// `[r11, _, r13, ..]`: the numbers of the target that are read, and the values of free joints that are.
fn input_patterns(
    function: &Function,
    problem: Option<&Problem>,
    body: &Body<'_>,
) -> (Option<String>, Option<String>) {
    let pattern = |range: core::ops::Range<usize>| {
        let names: Vec<_> = range.map(|i| body.name(ValueId(i))).collect();
        names.iter().any(|name| *name != "_").then(|| format!("[{}]", names.join(", ")))
    };
    let numbers = target_of(problem).input_names().len().min(function.inputs);
    (pattern(0..numbers), pattern(numbers..function.inputs))
}
