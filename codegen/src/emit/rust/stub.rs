//! What is printed for a table with mistakes: the functions that it would have had, so that each mistake is reported
//! once, where it was made, and not again wherever a function is used.

use super::paths::{Paths, Style};
use super::text::Text;
use super::{Attached, Generics, Options, Types, attach};
use crate::model::{Model, Target};
use crate::plan::{Counts, Function, FunctionKind, Plan, Scalar};

/// Functions of the right signatures that compute nothing, to go with an error. Without a model, those that any arm
/// has, for any number of joints.
pub fn stub(model: Option<&Model>, options: &Options) -> Attached {
    let attached = match model {
        Some(model) => attach(model, &hollow_plan(model), options),
        None => Attached { documentation: String::new(), items: of_any_arm(options) },
    };
    Attached { documentation: String::new(), ..attached }
}

/// Methods of an arm of which nothing is known.
fn of_any_arm(options: &Options) -> String {
    let name = options.name.clone().unwrap_or_default();
    let paths = Paths::new(Style::Attribute, &name);
    let ty = |name: &str| paths.runtime(name);
    let scalar = options.scalar.name();
    let frame = ty(if options.types == Types::Nalgebra { "Pose" } else { "Frame" });
    let jacobian = match options.types {
        Types::Nalgebra => format!("{}<N, {scalar}>", ty("Jacobian")),
        Types::Plain => format!("[[{scalar}; 6]; N]"),
    };
    let result = paths.prelude("Result");
    let (error, violations) = (ty("IkError"), ty("Violations"));
    let solutions = format!("{result}<{}<N, {scalar}>, {error}<{scalar}>>", ty("Solutions"));
    let q = format!("q: &[{scalar}; N]");
    let target = format!("target: &{frame}<{scalar}>");
    let methods = [
        ("fk", q.clone(), format!("{frame}<{scalar}>")),
        ("fk_flange", q.clone(), format!("{frame}<{scalar}>")),
        ("jacobian", q.clone(), jacobian.clone()),
        ("fk_jacobian", q.clone(), format!("({frame}<{scalar}>, {jacobian})")),
        ("check", q, format!("{result}<(), {violations}<'static, {scalar}>>")),
        ("ik", target.clone(), solutions.clone()),
        ("ik_all", target.clone(), solutions.clone()),
        ("ik_near", format!("{target}, seed: &[{scalar}; N]"), solutions),
    ];
    let Generics { parameters, arguments, clause } = &options.generics;
    let mut text = Text::default();
    text.line("#[allow(missing_docs, unused_variables)]");
    text.open(format!("impl{parameters} {name}{arguments} {clause} {{"));
    for (method, parameters, result) in methods {
        text.line(format!("pub fn {method}<const N: usize>(&self, {parameters}) -> {result} {{ loop {{}} }}"));
    }
    text.close("}");
    text.into_string()
}

fn hollow_plan(model: &Model) -> Plan {
    let joints = model.joints.len();
    let function = |kind: FunctionKind, inputs: Vec<String>, outputs: usize| Function {
        kind,
        inputs: inputs.len(),
        values: inputs,
        steps: Vec::new(),
        outputs: vec![Scalar::Number(0.0); outputs],
        counts: Counts::default(),
        stages: Vec::new(),
    };
    let forward = [
        (FunctionKind::Fk, 12),
        (FunctionKind::FkFlange, 12),
        (FunctionKind::Jacobian, 6 * joints),
        (FunctionKind::FkJacobian, 12 + 6 * joints),
        (FunctionKind::Frames, 12 * (model.rows.len() + 1)),
    ];
    let q: Vec<_> = (1..=joints).map(|i| format!("q{i}")).collect();
    let mut functions: Vec<_> =
        forward.into_iter().map(|(kind, outputs)| function(kind, q.clone(), outputs)).collect();
    let inverse = |problem, target: Target| {
        let inputs = target.input_names().iter().map(ToString::to_string).collect();
        function(FunctionKind::Inverse(problem), inputs, 0)
    };
    functions.push(inverse(None, Target::Pose));
    functions.extend(model.problems.iter().enumerate().map(|(i, problem)| inverse(Some(i), problem.target)));
    Plan { constants: Vec::new(), functions }
}
