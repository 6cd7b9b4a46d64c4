//! Methods of problems that leave one joint to the caller: over all of its values, and the nearest to a seed.

use super::Printer;
use super::documentation::joint_units;
use super::inverse::{allow_case, free_count, private_name, suffix};
use super::inverse_methods::Methods;
use super::layout::{Expression, statement};
use super::text::Text;
use crate::model::Problem;
use crate::plan::FunctionKind;
use dh_core::SWEEP_SAMPLES;

impl Printer<'_> {
    /// The constant that says which joint is free, and the methods that look over its values.
    pub(super) fn redundant(&self, text: &mut Text, methods: &Methods<'_>, joint: usize) {
        let free = self.joint_with_unit(joint);
        self.redundancy_constant(text, methods, joint, &free);
        self.sweep(text, methods, &free);
        self.intervals(text, methods, &free);
        if methods.problem.is_none_or(Problem::is_whole_pose)
            && self.find(&FunctionKind::FkJacobian).is_some()
        {
            self.nearest_of_all(text, methods, &free);
            if self.row_for_arm_angle(methods).is_some() {
                self.arm_angle(text, methods);
                self.by_arm_angle(text, methods);
            }
        }
    }

    fn row_for_arm_angle(&self, methods: &Methods<'_>) -> Option<usize> {
        self.model.row_for_arm_angle(methods.problem, &methods.function.free)
    }

    fn redundancy_constant(&self, text: &mut Text, methods: &Methods<'_>, joint: usize, free: &str) {
        let ty = self.paths.runtime("Redundancy");
        let name = constant_name(methods.problem);
        text.gap();
        text.documentation([format!(
            "The joint that `ik_at{}` leaves to the caller: {free}.",
            methods.suffix
        )]);
        let kind = if methods.problem.is_none_or(Problem::is_whole_pose) { "of_pose" } else { "of_problem" };
        let parts = [joint.to_string(), "Self::RULES".to_owned(), self.private("REACH").to_owned()];
        let mut value = Expression::Call(format!("{ty}::{kind}"), parts.map(Expression::Atom).to_vec());
        if let Some(row) = self.row_for_arm_angle(methods) {
            value = Expression::Atom(format!("{}.spherical_roll_spherical({row})", value.flat()));
        }
        if methods.function.is_searched() {
            value = Expression::Atom(format!("{}.searched()", value.flat()));
        }
        let head = format!("pub const {name}: {ty}<'static{}> =", self.scalar_argument(", "));
        text.laid_out(&statement(text.indent(), &head, &value, ";"));
    }

    fn sweep(&self, text: &mut Text, methods: &Methods<'_>, free: &str) {
        let suffix = &methods.suffix;
        text.gap();
        text.documentation([
            format!(
                "[`Self::ik_at{suffix}`] at {SWEEP_SAMPLES} values of {free}, spread evenly over its limits (over the \
                 whole turn where these leave it): every geometric solution {}, limits of the other joints ignored.",
                methods.purpose()
            ),
            format!("{}.", methods.arguments.meaning),
            "As many as there is room for are put into `out`; how many there are is returned.".to_owned(),
        ]);
        allow_case(text, suffix);
        let out = format!("out: &mut [{}]", self.sized_type("Solution"));
        text.signature(&format!("pub fn ik_sweep{suffix}"), &methods.parameters(Some(out)), "usize");
        target_and_at(text, methods, &self.paths.prelude("None"));
        text.line(format!("Self::{}.sweep(at, out)", constant_name(methods.problem)));
        text.close("}");
    }

    fn intervals(&self, text: &mut Text, methods: &Methods<'_>, free: &str) {
        let suffix = &methods.suffix;
        let limits = self.runtime_type("Limits");
        text.gap();
        text.documentation([
            format!(
                "The intervals of {free} at which a solution of [`Self::ik_at{suffix}`] keeps all limits and rules, in \
                 increasing order; see {}.",
                self.paths.link("Redundancy")
            ),
            format!("{}.", methods.arguments.meaning),
            "As many as there is room for are put into `out`; how many there are is returned.".to_owned(),
        ]);
        allow_case(text, suffix);
        let out = format!("out: &mut [{limits}]");
        text.signature(&format!("pub fn ik_intervals{suffix}"), &methods.parameters(Some(out)), "usize");
        target_and_at(text, methods, &self.paths.prelude("None"));
        text.line(format!("Self::{}.intervals(at, tool_point, out)", constant_name(methods.problem)));
        text.close("}");
    }

    fn nearest_of_all(&self, text: &mut Text, methods: &Methods<'_>, free: &str) {
        let suffix = &methods.suffix;
        text.gap();
        text.documentation([
            format!(
                "The solution {} that is nearest to `seed` ({}) of all that limits and rules allow, whatever {free}: \
                 the least root of the sum of squared joint travels. A seed that is a solution itself is returned.",
                methods.purpose(),
                joint_units(self.model)
            ),
            format!("{}.", methods.arguments.meaning),
            "# Errors".to_owned(),
            format!(
                "As [`Self::ik_at{suffix}`]; where there are solutions, but none is allowed, which limit or rule one of \
                 them breaks."
            ),
        ]);
        allow_case(text, suffix);
        let seed = format!("seed: &{}", self.joints_type());
        let result = format!(
            "{}<{}, {}>",
            self.paths.prelude("Result"),
            self.sized_type("Solution"),
            self.runtime_type("IkError")
        );
        text.signature(&format!("pub fn ik_nearest{suffix}"), &methods.parameters(Some(seed)), &result);
        target_and_at(text, methods, &self.paths.prelude("None"));
        let state = self.private_name(&FunctionKind::FkJacobian);
        text.line(format!("let arm = {}::new(at, {state});", self.paths.runtime("Arm")));
        text.line(format!("Self::{}.nearest(arm, tool_point, target, seed)", constant_name(methods.problem)));
        text.close("}");
    }

    fn arm_angle(&self, text: &mut Text, methods: &Methods<'_>) {
        let suffix = &methods.suffix;
        text.gap();
        text.documentation([
            format!(
                "The arm angle at `q` ({}), rad in (-pi, pi]: by how much the elbow is turned about the line from shoulder \
                 to wrist, see {}.",
                joint_units(self.model),
                self.paths.link("Redundancy")
            ),
        ]);
        allow_case(text, suffix);
        let q = format!("q: &{}", self.joints_type());
        text.signature(&format!("pub fn arm_angle{suffix}"), &["&self".to_owned(), q], self.scalar());
        let state = self.private_name(&FunctionKind::FkJacobian);
        let call = format!("Self::{}.arm_angle({state}, q)", constant_name(methods.problem));
        text.line(format!("{call}.unwrap_or({}::NAN)", self.scalar()));
        text.close("}");
    }

    fn by_arm_angle(&self, text: &mut Text, methods: &Methods<'_>) {
        let suffix = &methods.suffix;
        text.gap();
        text.documentation([
            format!(
                "Every geometric solution {} with an arm angle (rad), see [`Self::arm_angle{suffix}`]: limits ignored; \
                 joints that turn are in (-pi, pi].",
                methods.purpose()
            ),
            format!("{}.", methods.arguments.meaning),
            "# Errors".to_owned(),
            format!("As [`Self::ik_at{suffix}`]."),
        ]);
        allow_case(text, suffix);
        let angle = format!("arm_angle: {}", self.scalar());
        text.signature(
            &format!("pub fn ik_by_arm_angle{suffix}"),
            &methods.parameters(Some(angle)),
            &self.inverse_result(),
        );
        target_and_at(text, methods, &self.paths.prelude("None"));
        let state = self.private_name(&FunctionKind::FkJacobian);
        text.line(format!("let arm = {}::new(at, {state});", self.paths.runtime("Arm")));
        text.line(format!("Self::{}.by_arm_angle(arm, target, arm_angle)", constant_name(methods.problem)));
        text.close("}");
    }

    /// `redundancy` of the trait, and what it does with the values of free joints.
    pub(super) fn redundant_kinematics(&self, text: &mut Text) {
        if self.inverse_functions().all(|(function, _)| free_count(function).is_none()) {
            return;
        }
        let lifetime = format!("'_{}", self.scalar_argument(", "));
        let option = self.paths.prelude("Option");
        let (some, none) = (self.paths.prelude("Some"), self.paths.prelude("None"));
        text.gap();
        let known = self.inverse_functions().any(|(function, _)| function.free.len() == 1);
        text.open(format!(
            "fn redundancy(&self, {}: &str) -> {option}<{}<{lifetime}>> {{",
            if known { "problem" } else { "_problem" },
            self.paths.runtime("Redundancy")
        ));
        if known {
            text.open("match problem {");
            for (function, problem) in self.inverse_functions() {
                if function.free.len() == 1 {
                    let name = self.problem_name(problem);
                    text.line(format!("{name} => {some}(Self::{}),", constant_name(problem)));
                }
            }
            text.line(format!("_ => {none},"));
            text.close("}");
        } else {
            text.line(none);
        }
        text.close("}");
    }
}

/// The target, and the solutions by the free joint.
fn target_and_at(text: &mut Text, methods: &Methods<'_>, none: &str) {
    text.laid_out(&statement(text.indent(), "let target =", &methods.arguments.target, ";"));
    text.line(format!("let at = |free| {}(target, &[free], {none});", private_name(methods.problem)));
}

/// `REDUNDANCY`, `REDUNDANCY_TOOL_DOWN`
fn constant_name(problem: Option<&Problem>) -> String {
    format!("REDUNDANCY{}", suffix(problem).to_uppercase())
}
