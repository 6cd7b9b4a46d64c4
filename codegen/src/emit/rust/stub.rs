//! What is printed for a table with mistakes: the functions that it would have had, so that each mistake is reported
//! once, where it was made, and not again wherever a function is used.

use super::paths::{Paths, Style};
use super::text::Text;
use super::{Attached, Generics, Options, Types, attach};
use crate::model::{
    Angle, AngleUnit, Convention, JointKind, LengthUnit, Model, Placement, Problem, Rotation, Row, Target,
    Units, Workspace,
};
use crate::plan::{Counts, Function, FunctionKind, Plan, Scalar};
use dh_core::FULL_POSE;

/// What could be read of a table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline {
    /// One a row: whether it is a joint (it may be held).
    pub rows: Vec<bool>,
    /// Names and targets of the inverse problems, without the full pose.
    pub problems: Vec<(String, Target)>,
}

/// Functions of the right signatures that compute nothing, to go with an error. Where no row could be read, those that
/// any arm has, for any number of joints.
pub fn stub(outline: &Outline, options: &Options) -> Attached {
    let items = if outline.rows.is_empty() {
        of_any_arm(options)
    } else {
        let model = hollow_model(outline);
        attach(&model, &hollow_plan(&model), options).items
    };
    Attached { documentation: String::new(), items }
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
    text.allow(
        &["missing_docs", "unused_variables"],
        "nothing is computed for a table with mistakes, which are said beside this",
    );
    text.open(format!("impl{parameters} {name}{arguments} {clause} {{"));
    for (method, parameters, result) in methods {
        text.line(format!(
            "pub fn {method}<const N: usize>(&self, {parameters}) -> {result} {{ loop {{}} }}"
        ));
    }
    text.close("}");
    text.into_string()
}

fn hollow_model(outline: &Outline) -> Model {
    let nowhere = Placement { xyz: [0.0; 3], rotation: Rotation::Rpy([Angle::ZERO; 3]) };
    let mut joints = Vec::new();
    for (row, joint) in outline.rows.iter().enumerate() {
        if *joint {
            joints.push(row);
        }
    }
    let row = |(i, joint): (usize, &bool)| Row {
        name: format!("J{}", i + 1),
        kind: JointKind::Revolute,
        d: 0.0,
        a: 0.0,
        alpha: Angle::ZERO,
        beta: Angle::ZERO,
        theta: Angle::ZERO,
        shift: 0.0,
        terms: Vec::new(),
        variable: joint.then_some(i),
        limits: None,
        max_velocity: None,
        max_acceleration: None,
        max_jerk: None,
        servo: None,
        span: 0..0,
        line: 0,
    };
    let problem = |(name, target): &(String, Target)| Problem {
        name: name.clone(),
        target: *target,
        constraints: Vec::new(),
        filters: Vec::new(),
        free: Vec::new(),
        span: 0..0,
        line: 0,
    };
    Model {
        name: String::new(),
        manufacturer: None,
        source: None,
        convention: Convention::Standard,
        units: Units { length: LengthUnit::Metre, angle: AngleUnit::Radian },
        rows: outline.rows.iter().enumerate().map(row).collect(),
        joints,
        base: nowhere.clone(),
        tool: nowhere,
        workspace: Workspace::default(),
        sums: Vec::new(),
        poses: Vec::new(),
        problems: outline.problems.iter().map(problem).collect(),
        windings: Vec::new(),
        servos: Vec::new(),
        device: None,
        fingerprint: 0,
    }
}

fn hollow_plan(model: &Model) -> Plan {
    let joints = model.joints.len();
    let function = |kind: FunctionKind, inputs: Vec<String>, outputs: usize| Function {
        kind,
        inputs: inputs.len(),
        free: Vec::new(),
        values: inputs,
        steps: Vec::new(),
        outputs: vec![Scalar::Number(0.0); outputs],
        counts: Counts::default(),
        stages: Vec::new(),
        unknowns: Vec::new(),
        motions: Vec::new(),
        constraints: Vec::new(),
        branch: Vec::new(),
        agreement: None,
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
    if model.problems.iter().all(|problem| problem.name != FULL_POSE) {
        functions.push(inverse(None, Target::Pose));
    }
    functions.extend(model.problems.iter().enumerate().map(|(i, problem)| inverse(Some(i), problem.target)));
    Plan { constants: Vec::new(), functions }
}
