//! The constants of the struct: joints, rules, poses, servos, and what the table says about itself.

use super::Printer;
use super::layout::{Expression, statement};
use super::number::{APPROXIMATE, grouped, looks_approximate, number};
use super::text::Text;
use crate::model::{Bound, JointKind, Limits, Model, Row, Servo, Target};
use std::cell::Cell;

/// Numbers of one table, and whether one of them is near a constant of mathematics.
struct Numbers<'a, 'p> {
    printer: &'a Printer<'p>,
    approximate: Cell<bool>,
}

impl Printer<'_> {
    /// All constants, inside the struct's `impl`.
    pub(super) fn tables(&self, text: &mut Text) {
        let model = self.model;
        text.line("/// Name of the robot.");
        text.line(format!("pub const NAME: &'static str = {:?};", model.name));
        let texts = [
            ("MANUFACTURER", "Who makes it.", &model.manufacturer),
            ("SOURCE", "Where the numbers of the table come from.", &model.source),
        ];
        for (name, documentation, value) in texts {
            let Some(value) = value else { continue };
            text.line(format!("/// {documentation}"));
            let head = format!("pub const {name}: &'static str =");
            text.laid_out(&statement(4, &head, &Expression::Atom(format!("{value:?}")), ";"));
        }
        text.line("/// Number of joint variables.");
        text.line(format!("pub const DOF: usize = {};", model.joints.len()));
        text.line("/// The tool point is within this distance of the first joint's axis (m).");
        text.line(format!("pub const REACH: {} = {};", self.scalar(), self.private("REACH")));
        let fingerprint = grouped(&format!("{:016x}", model.fingerprint), 4);
        text.line("/// A hash of everything in the table that changes what is computed or sent.");
        text.line(format!("pub const FINGERPRINT: u64 = 0x{fingerprint};"));
        self.joints(text);
        self.rules(text);
        self.poses(text);
        self.servos(text);
        self.problems(text);
    }

    fn joints(&self, text: &mut Text) {
        let ty = format!("[{}; {}]", self.tabular("Joint"), self.model.joints.len());
        let documentation =
            format!("The joints, in the order of `q` ({}).", super::documentation::joint_units(self.model));
        self.table(text, "JOINTS", &ty, &documentation, |numbers| {
            let rows = self.model.joints.iter().filter_map(|row| self.model.rows.get(*row));
            list(rows.map(|row| numbers.joint(row)), "[", "]")
        });
    }

    fn rules(&self, text: &mut Text) {
        let ty = self.tabular("Rules");
        self.table(text, "RULES", &ty, "What restricts joints and tool point (rad, m).", |numbers| {
            let model = self.model;
            let rules = self.paths.runtime("Rules");
            let sums = model.sums.iter().map(|sum| {
                let terms = numbers.terms(&sum.terms);
                format!("{}::new({terms}, {})", self.paths.runtime("SumLimit"), numbers.range(sum.range))
            });
            let bounds = model.bounds_text(numbers);
            let boxes = model.workspace.keep_out.iter().map(|keep| {
                let (min, max) = (numbers.array(&keep.min), numbers.array(&keep.max));
                format!("{}::new({min}, {max})", self.paths.runtime("KeepOut"))
            });
            let fields = [
                "joints: &Self::JOINTS".to_owned(),
                format!("sums: {}", nested(sums)),
                format!("bounds: {}", nested(bounds.into_iter())),
                format!("keep_out: {}", nested(boxes)),
                format!("windings: &{}", self.private("WINDINGS")),
            ];
            list(fields, &format!("{rules} {{"), "}")
        });
    }

    /// The windings, outside the `impl`: searches read them too.
    pub(super) fn windings(&self, text: &mut Text) {
        let winding = self.paths.runtime("Winding");
        let numbers = Numbers { printer: self, approximate: Cell::new(false) };
        let windings = self.model.windings.iter().map(|one| {
            let (turn, carries) = (numbers.number(one.turn), numbers.terms(&one.carries));
            Expression::Atom(format!("{winding}::new({}, {turn}, {carries})", one.joint))
        });
        text.line("/// Whole turns of joints that leave every frame where it is (rad).");
        let ty = format!("[{}; {}]", self.tabular("Winding"), self.model.windings.len());
        let head = format!("const {}: {ty} =", self.private("WINDINGS"));
        text.laid_out(&statement(0, &head, &Expression::Array(windings.collect()), ";"));
    }

    fn poses(&self, text: &mut Text) {
        let named = self.paths.runtime("NamedPose");
        let ty = format!("[{}; {}]", self.tabular("NamedPose"), self.model.poses.len());
        self.table(text, "POSES", &ty, "Named joint poses of the table (rad, m).", |numbers| {
            let poses = self.model.poses.iter().map(|pose| {
                let safe = if pose.safe { ".marked_safe()" } else { "" };
                format!("{named}::new({:?}, &{}){safe}", pose.name, numbers.array(&pose.q))
            });
            list(poses, "[", "]")
        });
    }

    fn servos(&self, text: &mut Text) {
        let ty = format!("[(&'static str, {}); {}]", self.tabular("Servo"), self.model.servos.len());
        self.table(text, "SERVOS", &ty, "Servos outside the chain, by name.", |numbers| {
            let servos = self
                .model
                .servos
                .iter()
                .map(|servo| format!("({:?}, {})", servo.name, numbers.servo(&servo.servo)));
            list(servos, "[", "]")
        });
    }

    fn problems(&self, text: &mut Text) {
        let info = self.paths.runtime("ProblemInfo");
        let inverse: Vec<_> = self.inverse_functions().collect();
        let ty = format!("[{info}<'static>; {}]", inverse.len());
        self.table(text, "PROBLEMS", &ty, "The inverse problems that are solved.", |numbers| {
            let problems = inverse.iter().map(|(function, problem)| {
                let kind = self.paths.runtime("TargetKind");
                let (name, target) = match problem {
                    Some(problem) => (format!("{:?}", problem.name), problem.target),
                    None => (self.paths.runtime("FULL_POSE"), Target::Pose),
                };
                let free: Vec<_> = function.free.iter().map(ToString::to_string).collect();
                let constraints = function.constraints.iter().map(|term| {
                    let ty = self.paths.runtime("ConstraintTerm");
                    let joint = match term.joint {
                        Some(joint) => format!("{}({joint})", self.paths.prelude("Some")),
                        None => self.paths.prelude("None"),
                    };
                    // Of type f64, whatever the scalar is.
                    let coefficient = number(term.coefficient, super::ScalarType::F64, &self.paths);
                    let approximate = coefficient.contains('.') && looks_approximate(term.coefficient);
                    numbers.approximate.set(numbers.approximate.get() || approximate);
                    let equation = term.equation;
                    format!("{ty} {{ equation: {equation}, joint: {joint}, coefficient: {coefficient} }}")
                });
                let constraints: Vec<_> = constraints.collect();
                let branch = function.branch.iter().map(|bit| {
                    let (ty, word) = (self.paths.runtime("BranchBit"), self.paths.runtime("BranchWord"));
                    format!("{ty}::new({}, {word}::{:?}, {})", bit.step, bit.word, bit.row)
                });
                let branch: Vec<_> = branch.collect();
                format!(
                    "{info} {{ name: {name}, target: {kind}::{target:?}, free: &[{}], constraints: &[{}], \
                     branch: &[{}] }}",
                    free.join(", "),
                    constraints.join(", "),
                    branch.join(", ")
                )
            });
            list(problems, "[", "]")
        });
    }

    /// One constant; `value` prints its right-hand side.
    fn table(
        &self,
        text: &mut Text,
        name: &str,
        ty: &str,
        documentation: &str,
        value: impl FnOnce(&Numbers<'_, '_>) -> String,
    ) {
        let numbers = Numbers { printer: self, approximate: Cell::new(false) };
        let value = value(&numbers);
        text.line(format!("/// {documentation}"));
        if numbers.approximate.get() {
            text.allow(&[APPROXIMATE], "numbers of the table, as they were written");
        }
        let tabular = value.contains('\n');
        if tabular {
            text.line("#[rustfmt::skip]");
        }
        let mut lines = value.lines();
        text.line(format!(
            "pub const {name}: {ty} = {}{}",
            lines.next().unwrap_or_default(),
            if tabular { "" } else { ";" }
        ));
        let mut rest = lines.peekable();
        while let Some(line) = rest.next() {
            text.line(format!("{line}{}", if rest.peek().is_none() { ";" } else { "" }));
        }
    }

    /// A type of the constants, in the scalar type.
    fn tabular(&self, name: &str) -> String {
        format!("{}<'static{}>", self.paths.runtime(name), self.scalar_argument(", "))
    }
}

impl Model {
    fn bounds_text(&self, numbers: &Numbers<'_, '_>) -> Vec<String> {
        self.workspace.bounds.iter().map(|bound| numbers.bound(bound)).collect()
    }
}

impl Numbers<'_, '_> {
    fn number(&self, value: f64) -> String {
        let text = number(value, self.printer.options.scalar, &self.printer.paths);
        if looks_approximate(value) && text.contains('.') {
            self.approximate.set(true);
        }
        text
    }

    fn joint(&self, row: &Row) -> String {
        let kind = match row.kind {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
        };
        let mut calls = vec![format!("{}::{kind}({:?})", self.printer.paths.runtime("Joint"), row.name)];
        if let Some(limits) = row.limits {
            calls.push(format!(".with_limits({})", self.range(limits)));
        }
        let rates =
            [("velocity", row.max_velocity), ("acceleration", row.max_acceleration), ("jerk", row.max_jerk)];
        for (name, rate) in rates {
            if let Some(rate) = rate {
                calls.push(format!(".with_max_{name}({})", self.number(rate)));
            }
        }
        if let Some(servo) = &row.servo {
            calls.push(format!(".with_servo({})", self.servo(servo)));
        }
        chain(&calls)
    }

    fn servo(&self, servo: &Servo) -> String {
        let (scale, zero) = (self.number(servo.scale), self.number(servo.zero));
        let calls = [
            Some(format!("{}::new({scale}, {zero})", self.printer.paths.runtime("Servo"))),
            servo.id.map(|id| format!(".with_id({id})")),
            servo.range.map(|range| format!(".with_range({})", self.range(range))),
            servo.model.as_ref().map(|model| format!(".with_model({model:?})")),
        ];
        calls.into_iter().flatten().collect()
    }

    fn bound(&self, bound: &Bound) -> String {
        let axis = match bound.axis {
            0 => "X",
            1 => "Y",
            _ => "Z",
        };
        let side = if bound.is_min { "min" } else { "max" };
        let paths = &self.printer.paths;
        format!(
            "{}::{side}({}::{axis}, {})",
            paths.runtime("Bound"),
            paths.runtime("Axis"),
            self.number(bound.value)
        )
    }

    fn range(&self, limits: Limits) -> String {
        format!("{}, {}", self.number(limits.min), self.number(limits.max))
    }

    fn array(&self, values: &[f64]) -> String {
        let values: Vec<_> = values.iter().map(|value| self.number(*value)).collect();
        format!("[{}]", values.join(", "))
    }

    fn terms(&self, terms: &[(usize, f64)]) -> String {
        let terms: Vec<_> =
            terms.iter().map(|(joint, factor)| format!("({joint}, {})", self.number(*factor))).collect();
        format!("&[{}]", terms.join(", "))
    }
}

/// Calls on one line, or a call a line.
fn chain(calls: &[String]) -> String {
    let line = calls.concat();
    if line.len() <= 88 { line } else { calls.join("\n    ") }
}

/// Items, one a line, between brackets.
fn list(items: impl IntoIterator<Item = String>, open: &str, close: &str) -> String {
    let items: String = items.into_iter().map(|item| indented(&item) + ",\n").collect();
    let line = if items.is_empty() { "" } else { "\n" };
    format!("{open}{line}{items}{close}")
}

/// A slice inside a table: on one line where it is empty or short.
fn nested(items: impl Iterator<Item = String>) -> String {
    let items: Vec<_> = items.collect();
    let line = format!("&[{}]", items.join(", "));
    if line.len() <= 80 { line } else { list(items, "&[", "]") }
}

fn indented(item: &str) -> String {
    item.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n")
}
