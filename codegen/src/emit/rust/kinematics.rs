//! The object-safe view: `impl Kinematics`.

use super::Printer;
use super::inverse::{free_count, private_name};
use super::text::Text;
use crate::model::Problem;
use crate::plan::FunctionKind;

impl Printer<'_> {
    /// The trait's implementation, over slices.
    pub(super) fn kinematics(&self, text: &mut Text) {
        let generics = &self.options.generics;
        let clause = if generics.clause.is_empty() { String::new() } else { format!(" {}", generics.clause) };
        let kinematics = self.runtime_type("Kinematics");
        let (scalar, argument) = (self.scalar(), self.scalar_argument(", "));
        let (frame, length_error) = (self.runtime_type("Frame"), self.paths.runtime("LengthError"));
        let (result, ok) = (self.paths.prelude("Result"), self.paths.prelude("Ok"));
        let (joint_array, copy_into) = (self.paths.runtime("joint_array"), self.paths.runtime("copy_into"));

        text.gap();
        text.open(format!(
            "impl{} {kinematics} for {}{}{clause} {{",
            generics.parameters, self.struct_name, generics.arguments
        ));
        let mut constant = |signature: String, value: &str| {
            text.gap();
            text.open(format!("fn {signature} {{"));
            text.line(value);
            text.close("}");
        };
        constant("name(&self) -> &str".to_owned(), "Self::NAME");
        constant("fingerprint(&self) -> u64".to_owned(), "Self::FINGERPRINT");
        constant("rows(&self) -> usize".to_owned(), &self.model.rows.len().to_string());
        constant(format!("rules(&self) -> {}<'_{argument}>", self.paths.runtime("Rules")), "Self::RULES");
        constant(
            format!("problems(&self) -> &[{}<'_>]", self.paths.runtime("ProblemInfo")),
            "const { &Self::PROBLEMS }",
        );
        let q = format!("q: &[{scalar}]");
        for (name, kind) in [("fk", FunctionKind::Fk), ("fk_flange", FunctionKind::FkFlange)] {
            let function = self.private_name(&kind);
            constant(
                format!("{name}(&self, {q}) -> {result}<{frame}, {length_error}>"),
                &format!("{ok}({function}({joint_array}(q)?))"),
            );
        }
        constant(
            format!("frames_into(&self, {q}, out: &mut [{frame}]) -> {result}<usize, {length_error}>"),
            &format!("{copy_into}(&row_frames({joint_array}(q)?), out)"),
        );
        constant(
            format!("jacobian_into(&self, {q}, out: &mut [[{scalar}; 6]]) -> {result}<(), {length_error}>"),
            &format!("{copy_into}(&geometric_jacobian({joint_array}(q)?), out).map(|_| ())"),
        );
        self.ik_into(text);
        self.broken_condition(text);
        self.redundant_kinematics(text);
        text.close("}");
    }

    /// Methods that add frames known only at run time.
    pub(super) fn mounting(&self, text: &mut Text) {
        let mounted = format!("{}<Self{}>", self.paths.runtime("Mounted"), self.scalar_argument(", "));
        let pose = self.pose_type();
        let frames = [
            (
                "tool",
                "This arm with another frame at its tool: the pose (m) of the tool point in the table's tool frame.",
            ),
            ("base", "This arm on another frame: the pose (m) of the table's base frame in the world."),
        ];
        for (name, documentation) in frames {
            text.gap();
            text.documentation([documentation]);
            text.line("#[must_use]");
            text.signature(
                &format!("pub fn with_{name}"),
                &["self".to_owned(), format!("{name}: &{pose}")],
                &mounted,
            );
            text.line(format!("{}::new(self).with_{name}({name})", self.paths.runtime("Mounted")));
            text.close("}");
        }
    }

    /// `ik_seeded_into`.
    fn ik_into(&self, text: &mut Text) {
        let (ok, err) = (self.paths.prelude("Ok"), self.paths.prelude("Err"));
        let unknown = format!("{}::UnknownProblem", self.paths.runtime("IkError"));
        let solved = self.inverse_functions().next().is_some();
        let (target, set) = (self.runtime_type("Target"), self.runtime_type("SolutionSet"));
        let seed = format!("{}<'_{}>", self.paths.runtime("Seed"), self.scalar_argument(", "));
        let unused = if solved { "" } else { "_" };
        let parameters = [
            "&self".to_owned(),
            format!("{unused}problem: &str"),
            format!("{unused}target: &{target}"),
            format!("{unused}free: &[{}]", self.scalar()),
            format!("{unused}seed: {}<{seed}>", self.paths.prelude("Option")),
            format!("out: &mut {set}"),
        ];
        let result = format!("{}<(), {}>", self.paths.prelude("Result"), self.runtime_type("IkError"));
        text.gap();
        text.signature("fn ik_seeded_into", &parameters, &result);
        text.line("out.clear();");
        if !solved {
            text.line(format!("{err}({unknown})"));
            text.close("}");
            return;
        }
        text.open("let solutions = match problem {");
        for (function, problem) in self.inverse_functions() {
            let (name, solve) = (self.problem_name(problem), private_name(problem));
            if free_count(function).is_some() {
                let array = self.paths.runtime("joint_array");
                text.line(format!("{name} => {solve}(target, {array}(free)?, seed)?,"));
            } else {
                text.open(format!("{name} => {{"));
                text.line(format!("{}::check(0, free.len())?;", self.paths.runtime("LengthError")));
                text.line(format!("{solve}(target, seed)?"));
                text.close("}");
            }
        }
        text.line(format!("_ => return {err}({unknown}),"));
        text.close("};");
        text.line("out.fill(Self::DOF, &solutions);");
        text.line(format!("{ok}(())"));
        text.close("}");
    }

    /// The name of a problem as a pattern.
    pub(super) fn problem_name(&self, problem: Option<&Problem>) -> String {
        problem.map_or_else(|| self.paths.runtime("FULL_POSE"), |problem| format!("{:?}", problem.name))
    }

    /// Whether the plan has what the trait needs.
    pub(super) fn is_complete(&self) -> bool {
        [FunctionKind::Fk, FunctionKind::FkFlange, FunctionKind::Jacobian, FunctionKind::Frames]
            .iter()
            .all(|kind| self.find(kind).is_some())
    }
}
