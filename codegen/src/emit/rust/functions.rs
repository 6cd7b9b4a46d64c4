//! Forward functions: private ones on arrays, and the methods that call them.

use super::body::{Body, Locals};
use super::documentation::{joint_units, operations};
use super::expression::Leaves;
use super::layout::{Expression, statement};
use super::liveness::Live;
use super::text::Text;
use super::{Printer, ScalarType, Types};
use crate::plan::{Function, FunctionKind, ValueId};

/// More lines than this and clippy asks for a reason.
const MANY_LINES: usize = 90;

/// The name of a forward function among the private ones.
pub(super) fn private_name(kind: &FunctionKind) -> &'static str {
    match kind {
        FunctionKind::Fk => "forward_kinematics",
        FunctionKind::FkFlange => "flange_pose",
        FunctionKind::Jacobian => "geometric_jacobian",
        FunctionKind::FkJacobian => "pose_and_jacobian",
        FunctionKind::Frames => "row_frames",
        FunctionKind::Inverse(_) => "",
    }
}

impl<'a> Printer<'a> {
    /// The straight-line functions, in the order of the plan.
    pub(super) fn forward_functions(&self, text: &mut Text) {
        for function in &self.plan.functions {
            if !matches!(function.kind, FunctionKind::Inverse(_)) {
                text.gap();
                self.forward_function(text, function);
            }
        }
    }

    /// What rules ask for.
    pub(super) fn tool_point(&self, text: &mut Text) {
        text.gap();
        text.line("/// Where the tool point is (m).");
        self.small_arguments(text, self.dof());
        text.open(format!("fn tool_point(q: &{}) -> [{}; 3] {{", self.joints_type(), self.scalar()));
        text.line("forward_kinematics(q).translation");
        text.close("}");
    }

    fn forward_function(&self, text: &mut Text, function: &'a Function) {
        if self.private_name(&function.kind) != private_name(&function.kind) {
            return;
        }
        let (lines, reads) = self.forward_lines(function);
        let frame = || self.runtime_type("Frame");
        let (what, ty) = match function.kind {
            FunctionKind::Fk => ("The tool frame in the base frame.", frame()),
            FunctionKind::FkFlange => ("The flange in the base frame.", frame()),
            FunctionKind::Jacobian => ("Columns of the geometric Jacobian.", self.columns_type()),
            FunctionKind::FkJacobian => (
                "The tool frame, and the columns of the Jacobian.",
                format!("({}, {})", frame(), self.columns_type()),
            ),
            _ => ("The frame of every row, base first.", self.frames_type(&frame())),
        };
        text.line(format!("/// {what}"));
        Self::allowances(text, &lines);
        self.small_arguments(text, self.dof());
        text.line("#[inline]");
        let q = if reads { "q" } else { "_q" };
        text.open(format!("fn {}({q}: &{}) -> {ty} {{", private_name(&function.kind), self.joints_type()));
        text.append(&lines);
        text.close("}");
    }

    /// The lines of a function, and whether they read `q`.
    fn forward_lines(&self, function: &Function) -> (String, bool) {
        let locals = Locals::of(function, &self.scope());
        let body = self.body(function, &locals);
        let mut lines = Text::indented(1);
        body.steps(&mut lines, &function.steps, &|_, _| {});
        lines.laid_out(&statement(4, "", &self.result(function, &body), ""));
        (lines.into_string(), (0..function.inputs).any(|i| body.live.value(ValueId(i))))
    }

    /// The name of the function that computes a kind: an arm without a tool has its flange at the tool frame.
    pub(super) fn private_name(&self, kind: &FunctionKind) -> &'static str {
        if let FunctionKind::FkFlange = kind
            && let (Some(tool), Some(flange)) = (self.find(&FunctionKind::Fk), self.find(kind))
            && self.forward_lines(tool) == self.forward_lines(flange)
        {
            return private_name(&FunctionKind::Fk);
        }
        private_name(kind)
    }

    /// Lints that a function's text cannot help.
    pub(super) fn allowances(text: &mut Text, body: &str) {
        let mut lints = vec!["clippy::similar_names"];
        if body.lines().count() > MANY_LINES {
            lints.push("clippy::too_many_lines");
        }
        text.allow(&lints, "the names are those of the equations");
    }

    /// So many joint values are passed by reference, however few they are.
    pub(super) fn small_arguments(&self, text: &mut Text, count: usize) {
        let bytes = match self.options.scalar {
            ScalarType::F64 => 8,
            ScalarType::F32 => 4,
        };
        if bytes * count <= 8 {
            text.allow(&["clippy::trivially_copy_pass_by_ref"], "as for every arm");
        }
    }

    /// A function with the names of its values.
    pub(super) fn body<'b>(&'b self, function: &'b Function, locals: &'b Locals) -> Body<'b> {
        Body {
            function,
            leaves: Leaves {
                values: &locals.values,
                constants: &self.constants,
                scalar: self.options.scalar,
                paths: &self.paths,
            },
            live: Live::of(function, self.plan.constants.len()),
            stages: &locals.stages,
            chain: &locals.chain,
            nearly: &locals.nearly,
            search: [self.private("REACH"), self.private("WINDINGS")],
            finish: if self.asks_at_the_end(function) {
                "search.finish_where(broken)"
            } else {
                "search.finish()"
            },
        }
    }

    /// The last expression of a forward function.
    fn result(&self, function: &Function, body: &Body<'_>) -> Expression {
        let outputs: Vec<_> = function.outputs.iter().map(|output| body.leaves.expression(output)).collect();
        match function.kind {
            FunctionKind::Jacobian => columns(&outputs),
            FunctionKind::FkJacobian => {
                let (frame, jacobian) = outputs.split_at(outputs.len().min(12));
                Expression::Tuple(vec![self.frame(frame), columns(jacobian)])
            }
            FunctionKind::Frames => {
                Expression::Array(outputs.chunks(12).map(|frame| self.frame(frame)).collect())
            }
            _ => self.frame(&outputs),
        }
    }

    /// A frame from the rows of `[R | p]`.
    pub(super) fn frame(&self, rows: &[Expression]) -> Expression {
        let identity = ["1.0", "0.0", "0.0", "0.0", "0.0", "1.0", "0.0", "0.0", "0.0", "0.0", "1.0", "0.0"];
        if rows.iter().map(Expression::flat).eq(identity) {
            return Expression::Atom(format!("{}::IDENTITY", self.paths.runtime("Frame")));
        }
        let column = |range: std::ops::Range<usize>| {
            rows.chunks(4).map(|row| row.get(range.clone()).unwrap_or_default().to_vec()).collect::<Vec<_>>()
        };
        let rotation = column(0..3).into_iter().map(Expression::Array).collect();
        let translation = column(3..4).into_iter().flatten().collect();
        Expression::Struct(
            self.paths.runtime("Frame"),
            vec![("rotation", Expression::Array(rotation)), ("translation", Expression::Array(translation))],
        )
    }

    fn columns_type(&self) -> String {
        format!("[[{}; 6]; {}]", self.scalar(), self.dof())
    }

    fn frames_type(&self, frame: &str) -> String {
        format!("[{frame}; {}]", self.model.rows.len() + 1)
    }

    /// The methods that call them, in the order of the plan.
    pub(super) fn forward_methods(&self, text: &mut Text) {
        for function in &self.plan.functions {
            self.forward_method(text, function);
        }
        text.gap();
        let q = self.joints_type();
        let units = joint_units(self.model);
        let listed = format!("{}, which lists them with their numbers.", self.paths.link("Violations"));
        text.documentation([
            &format!("Every limit and workspace rule that joint values ({units}) break, not only the first."),
            "# Errors",
            &listed,
        ]);
        text.allow(&["clippy::result_large_err"], "no heap to put it on");
        let violations =
            format!("{}<'static{}>", self.paths.runtime("Violations"), self.scalar_argument(", "));
        let result = self.paths.prelude("Result");
        text.open(format!("pub fn check(&self, q: &{q}) -> {result}<(), {violations}> {{"));
        text.line("Self::RULES.check(q, tool_point(q))");
        text.close("}");
    }

    fn forward_method(&self, text: &mut Text, function: &Function) {
        let (name, what) = match function.kind {
            FunctionKind::Fk => {
                ("fk", "Forward kinematics: the pose of the tool frame in the base frame (m)")
            }
            FunctionKind::FkFlange => {
                ("fk_flange", "The pose of the flange, without the table's tool, in the base frame (m)")
            }
            FunctionKind::Jacobian => ("jacobian", "The geometric Jacobian"),
            FunctionKind::FkJacobian => (
                "fk_jacobian",
                "The pose of the tool frame in the base frame (m), and the geometric Jacobian,",
            ),
            FunctionKind::Frames => (
                "frames",
                "The poses of the frames of the table's rows in the base frame (m), after that of the base frame itself,",
            ),
            FunctionKind::Inverse(_) => return,
        };
        let mut paragraphs = vec![format!("{what} at joint values `q` ({}).", joint_units(self.model))];
        if matches!(function.kind, FunctionKind::Jacobian | FunctionKind::FkJacobian) {
            paragraphs.push(self.jacobian_shape());
        }
        paragraphs.push(operations(function.counts));
        text.gap();
        text.documentation(paragraphs);
        text.line("#[inline]");
        text.line("#[must_use]");
        let call = format!("{}(q)", self.private_name(&function.kind));
        let (ty, body) = match self.options.types {
            Types::Nalgebra => self.converted(function, &call),
            Types::Plain => (self.plain_type(function), call),
        };
        text.open(format!("pub fn {name}(&self, q: &{}) -> {ty} {{", self.joints_type()));
        body.lines().for_each(|line| text.line(line));
        text.close("}");
    }

    /// Type and body of a method, from the call of the private function, in nalgebra's types.
    fn converted(&self, function: &Function, call: &str) -> (String, String) {
        let pose = self.pose_type();
        let jacobian = || (self.sized_type("Jacobian"), self.paths.runtime("jacobian_from_columns"));
        match function.kind {
            FunctionKind::Jacobian => {
                let (ty, from_columns) = jacobian();
                (ty, format!("{from_columns}({call})"))
            }
            FunctionKind::FkJacobian => {
                let (ty, from_columns) = jacobian();
                let body = format!("let (tool, columns) = {call};\n(tool.into(), {from_columns}(columns))");
                (format!("({pose}, {ty})"), body)
            }
            FunctionKind::Frames => (self.frames_type(&pose), format!("{call}.map(Into::into)")),
            _ => (pose, format!("{call}.into()")),
        }
    }

    /// The type of a method in plain types, which is that of the private function.
    fn plain_type(&self, function: &Function) -> String {
        let frame = self.pose_type();
        match function.kind {
            FunctionKind::Jacobian => self.columns_type(),
            FunctionKind::FkJacobian => format!("({frame}, {})", self.columns_type()),
            FunctionKind::Frames => self.frames_type(&frame),
            _ => frame,
        }
    }

    fn jacobian_shape(&self) -> String {
        let rows = "vx vy vz (m) wx wy wz (rad) per unit of the joint, in base axes, at the tool point";
        match self.options.types {
            Types::Nalgebra => format!("Jacobian: 6 x {}, rows {rows}.", self.dof()),
            Types::Plain => format!("Jacobian: {} columns of {rows}.", self.dof()),
        }
    }
}

/// Columns of six.
fn columns(entries: &[Expression]) -> Expression {
    Expression::Array(entries.chunks(6).map(|column| Expression::Array(column.to_vec())).collect())
}
