//! Inverse functions as methods: every solution, those that limits allow, those nearest to a seed.

use super::Printer;
use super::documentation::{joint_units, meant, operations, stages};
use super::inverse::{allow_case, free_count, private_name, suffix, target_of};
use super::layout::{Expression, statement};
use super::targets::Arguments;
use super::text::{Text, clean};
use crate::model::Problem;
use crate::plan::{Agreement, Function, FunctionKind};

/// What the methods of one problem have in common.
pub(super) struct Methods<'a> {
    pub(super) function: &'a Function,
    pub(super) problem: Option<&'a Problem>,
    /// `_tool_down`, or nothing for the full pose.
    pub(super) suffix: String,
    pub(super) arguments: Arguments,
}

impl Methods<'_> {
    /// The parameters, self first.
    pub(super) fn parameters(&self, last: Option<String>) -> Vec<String> {
        let own = self.arguments.parameters.iter().cloned();
        core::iter::once("&self".to_owned()).chain(own).chain(last).collect()
    }

    /// What the solutions are for.
    pub(super) fn purpose(&self) -> String {
        match self.problem {
            Some(problem) if !self.suffix.is_empty() => {
                format!("of the table's problem `{}`", clean(&problem.name))
            }
            _ => "that brings the tool frame to a pose".to_owned(),
        }
    }
}

impl Printer<'_> {
    /// The methods of all inverse functions.
    pub(super) fn inverse_methods(&self, text: &mut Text) {
        for (function, problem) in self.inverse_functions() {
            let arguments = self.arguments(target_of(problem));
            let methods = Methods { function, problem, suffix: suffix(problem), arguments };
            if let Some(count) = free_count(function) {
                self.geometric(text, &methods, "at", Some(count));
                if let [joint] = function.free.as_slice() {
                    self.redundant(text, &methods, *joint);
                    if problem.is_none_or(Problem::is_whole_pose)
                        && self.find(&FunctionKind::FkJacobian).is_some()
                    {
                        self.track(text, &methods, "self.ik_nearest", "");
                    }
                }
            } else {
                self.geometric(text, &methods, "all", None);
                self.allowed(text, &methods);
                self.nearest(text, &methods);
                self.track(text, &methods, "self.ik", "_near");
            }
        }
    }

    /// `ik_all`: every solution; `ik_at`, where joints are left to the caller.
    fn geometric(&self, text: &mut Text, methods: &Methods<'_>, name: &str, free: Option<usize>) {
        let Methods { function, problem, suffix, arguments } = methods;
        let mut paragraphs = vec![
            format!(
                "Every geometric solution {}, limits ignored; joints that turn are in (-pi, pi].",
                methods.purpose()
            ),
            format!("{}.", arguments.meaning),
        ];
        paragraphs.extend(free.map(|_| self.free_joints(function)));
        paragraphs.extend(problem.and_then(conditions));
        paragraphs.extend(meant(function));
        if let Some(stages) = stages(function) {
            paragraphs.push("Solved one after the other:".to_owned());
            paragraphs.push(stages);
        }
        paragraphs.extend(function.agreement.as_ref().map(agreement));
        paragraphs.push(format!("Besides solving, on each branch: {}", operations(function.counts)));
        paragraphs.push("# Errors".to_owned());
        paragraphs.push(format!(
            "{}: the first step of the solution that fails decides.",
            self.paths.link("IkError")
        ));
        text.gap();
        text.documentation(paragraphs);
        allow_case(text, suffix);
        let last = free.map(|count| {
            let values = self.paths.runtime("FreeValues");
            format!("free: impl {values}<{count}{}>", self.scalar_argument(", "))
        });
        text.signature(
            &format!("pub fn ik_{name}{suffix}"),
            &methods.parameters(last),
            &self.inverse_result(),
        );
        let mut passed = vec![if matches!(arguments.target, Expression::Struct(..)) {
            text.laid_out(&statement(text.indent(), "let target =", &arguments.target, ";"));
            Expression::Atom("target".to_owned())
        } else {
            arguments.target.clone()
        }];
        passed.extend(free.map(|_| Expression::Atom("&free.values()".to_owned())));
        passed.push(Expression::Atom(self.paths.prelude("None")));
        let call = Expression::Call(private_name(*problem), passed);
        text.laid_out(&statement(text.indent(), "", &call, ""));
        text.close("}");
    }

    /// `ik`: those that whole turns bring inside the limits.
    fn allowed(&self, text: &mut Text, methods: &Methods<'_>) {
        let Methods { suffix, arguments, .. } = methods;
        text.gap();
        text.documentation([
            format!(
                "The solutions {} that whole turns bring inside the limits and no rule forbids, each in the \
                 representative nearest to the middle of the limits. Never empty.",
                methods.purpose()
            ),
            format!("{}.", arguments.meaning),
            "# Errors".to_owned(),
            format!(
                "As [`Self::ik_all{suffix}`]; where there are solutions, but none is allowed, which limit or rule \
                 the nearest to being allowed breaks."
            ),
        ]);
        allow_case(text, suffix);
        text.signature(&format!("pub fn ik{suffix}"), &methods.parameters(None), &self.inverse_result());
        self.chosen(text, methods, &self.paths.prelude("None"));
    }

    /// `ik_near`: the same, by their distance from a seed.
    fn nearest(&self, text: &mut Text, methods: &Methods<'_>) {
        let suffix = &methods.suffix;
        let units = joint_units(self.model);
        text.gap();
        text.documentation([
            format!(
                "[`Self::ik{suffix}`], each in the representative nearest to `seed` ({units}), the nearest first. A joint \
                 that the target leaves free is set as near to its value there as the others can follow."
            ),
            "# Errors".to_owned(),
            format!("As [`Self::ik{suffix}`]."),
        ]);
        allow_case(text, suffix);
        let seed = format!("seed: &{}", self.joints_type());
        let parameters = methods.parameters(Some(seed));
        text.signature(&format!("pub fn ik{suffix}_near"), &parameters, &self.inverse_result());
        self.chosen(text, methods, &format!("{}(seed)", self.paths.prelude("Some")));
    }

    /// `ik_track`: a path of poses.
    fn track(&self, text: &mut Text, methods: &Methods<'_>, function: &str, ending: &str) {
        // Targets of several arguments have no type of their own.
        if methods.arguments.names != ["target"] {
            return;
        }
        let suffix = &methods.suffix;
        let units = joint_units(self.model);
        let (joints, pose) = (self.joints_type(), self.pose_type());
        text.gap();
        text.documentation([
            format!(
                "Follows a path of targets from the joint values `start` ({units}): for each the allowed solution \
                 nearest to that before. No joint may go farther than `longest` ({units}) from one to the next."
            ),
            "# Errors".to_owned(),
            "At which target a joint would have to jump, or why there is no solution; `out` holds the joint values of \
             the targets before it."
                .to_owned(),
        ]);
        allow_case(text, suffix);
        let parameters = [
            "&self".to_owned(),
            format!("targets: &[{pose}]"),
            format!("start: &{joints}"),
            format!("longest: {}", self.scalar()),
            format!("out: &mut [{joints}]"),
        ];
        let result = format!("{}<(), {}>", self.paths.prelude("Result"), self.runtime_type("TrackError"));
        text.signature(&format!("pub fn ik_track{suffix}"), &parameters, &result);
        if ending.is_empty() {
            text.line(format!(
                "let nearest = |target: &{pose}, seed: &{joints}| {function}{suffix}(target, seed);"
            ));
        } else {
            text.open(format!("let nearest = |target: &{pose}, seed: &{joints}| {{"));
            text.line(format!("let solutions = {function}{suffix}{ending}(target, seed);"));
            text.line("solutions.map(|solutions| *solutions.nearest(seed))");
            text.close("};");
        }
        text.line(format!("{}(targets, start, longest, out, nearest)", self.paths.runtime("track")));
        text.close("}");
    }

    /// All solutions, and of these the ones that are allowed.
    fn chosen(&self, text: &mut Text, methods: &Methods<'_>, seed: &str) {
        text.laid_out(&statement(text.indent(), "let target =", &methods.arguments.target, ";"));
        text.line(format!(
            "let solve = |seed: {}<'_{}>| {}(target, {}(seed));",
            self.paths.runtime("Seed"),
            self.scalar_argument(", "),
            private_name(methods.problem),
            self.paths.prelude("Some")
        ));
        text.line(format!("Self::RULES.allowed(solve, tool_point, {seed})"));
        text.close("}");
    }

    /// Which joints the caller gives.
    fn free_joints(&self, function: &Function) -> String {
        let names: Vec<_> = function.free.iter().map(|joint| self.joint_with_unit(*joint)).collect();
        format!("`free`: the value{} of {}.", if names.len() == 1 { "" } else { "s" }, names.join(", "))
    }

    /// `J3 (rad)`
    pub(super) fn joint_with_unit(&self, joint: usize) -> String {
        let row = self.model.joints.get(joint).and_then(|row| self.model.rows.get(*row));
        row.map_or_else(String::new, |row| format!("{} ({})", clean(&row.name), row_unit(row)))
    }

    /// `Result<Solutions<6>, IkError>`
    pub(super) fn inverse_result(&self) -> String {
        let (solutions, error) = (self.sized_type("Solutions"), self.runtime_type("IkError"));
        format!("{}<{solutions}, {error}>", self.paths.prelude("Result"))
    }
}

fn row_unit(row: &crate::model::Row) -> &'static str {
    match row.kind {
        crate::model::JointKind::Revolute => "rad",
        crate::model::JointKind::Prismatic => "m",
    }
}

/// What another method says.
fn agreement(agreement: &Agreement) -> String {
    let Agreement { method, poses, agreed, missing } = agreement;
    let missing =
        if *missing == 0 { String::new() } else { format!(" It finds {missing} that are missing here.") };
    format!(
        "Another method ({}) finds the same solutions at {agreed} of {poses} random poses.{missing}",
        clean(method)
    )
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
