//! Every function of a plan, run in the interpreter against plain products of the table's own matrices.
//!
//! A plan is made by an engine that rewrites equations; here its results are held against something that shares
//! nothing with it. A function that fails is taken out of the plan, so that no wrong number is ever printed; the
//! others stay.
//!
//! Forward functions must agree with the product at every pose. For inverse problems, poses are made from random
//! and special joint vectors that satisfy the problem's constraints; every solution must meet its target, the
//! constraints and `where`, and the joint vector that the pose was made from must be among the solutions.

mod agreement;
mod arm_angle;
mod constraints;
mod forward;
mod inverse;
mod newton;
mod poses;
mod prescribed;
mod random;
mod reference;
mod report;
mod singular_values;
mod where_clause;

#[cfg(test)]
mod mutations;
#[cfg(test)]
mod tests;

pub use report::{FunctionReport, InverseReport, Report};
pub use singular_values::singular_values;

use crate::diagnostic::catalogue::VERIFICATION;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::model::Model;
use crate::plan::eval::Program;
use crate::plan::{Function, FunctionKind, Plan, Step};
use constraints::Constraints;
use reference::Reference;

/// Errors of forward functions: of positions in reaches, of rotations in rad.
pub const FORWARD_TOLERANCE: f64 = 1e-12;

/// Errors of inverse solutions against their target, in reaches and rad.
pub const RESIDUAL: f64 = 1e-9;

/// The same at singular poses, where a root is only known to half of the digits.
pub const RESIDUAL_SINGULAR: f64 = 1e-7;

/// Poses at which the smallest singular value of the problem's Jacobian is below this count as singular.
pub const SINGULAR: f64 = 1e-6;

/// How near (rad or m) a solution must be to the joint vector that its target was made from.
pub const COMPLETE: f64 = 1e-8;

/// Near a singular pose it may be this, divided by the smallest singular value squared, instead.
pub const COMPLETE_NEAR_SINGULAR: f64 = 1e-13;

/// How thoroughly to verify.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// For macros, cheap even in unoptimised builds: closed forms of inverse problems as in `Full`, so that the same ones
    /// are kept; all else at a few poses.
    Quick,
    /// Some hundred poses with singular ones and the neighbourhood of these, for `dhc check` and tests.
    Full,
    /// The same with so many random poses, and more of the others too.
    Poses(u32),
}

impl Level {
    /// How thoroughly an inverse function is verified. A closed form that fails at a special pose only is replaced by
    /// another way, on which all must agree who compile the table.
    fn of(self, function: &Function) -> Level {
        let closed = matches!(function.steps.as_slice(), [.., Step::Solve { .. } | Step::Accept { .. }]);
        if closed && self == Level::Quick { Level::Full } else { self }
    }
}

/// What errors may be (m, rad).
struct Tolerance {
    position: f64,
    rotation: f64,
}

impl Tolerance {
    /// False for NaN too.
    fn holds(&self, position: f64, rotation: f64) -> bool {
        position <= self.position && rotation <= self.rotation
    }
}

/// Runs every function of a plan; those that fail are reported and left out of the plan that is returned. Of several
/// that solve one inverse problem, the first that stands it is kept; those behind it are neither run nor reported.
pub fn verify(model: &Model, plan: Plan, level: Level, diagnostics: &mut Diagnostics) -> (Plan, Report) {
    verify_or_else(model, plan, level, |_| None, diagnostics)
}

/// The same; where no function of an inverse problem stands it, `next` is asked for another one than the last that
/// failed, and so on.
pub fn verify_or_else(
    model: &Model,
    mut plan: Plan,
    level: Level,
    next: impl Fn(&Function) -> Option<Function>,
    diagnostics: &mut Diagnostics,
) -> (Plan, Report) {
    let verification = Verification { model, level, reach: model.reach() };
    let passed =
        |report: &Option<FunctionReport>| report.as_ref().is_some_and(|report| report.failure.is_none());
    let mut found = verification.reports(&plan);
    for mut failed in failed(&plan, &found) {
        while let Some(function) = next(&failed) {
            let needed =
                |other: &&Function| matches!(other.kind, FunctionKind::Fk | FunctionKind::FkJacobian);
            let functions = plan.functions.iter().filter(needed);
            let functions = functions.cloned().chain([function.clone()]).collect();
            let alone = Plan { constants: plan.constants.clone(), functions };
            let report = verification.reports(&alone).pop().flatten();
            let stands = passed(&report);
            found.push(report);
            plan.functions.push(function.clone());
            if stands {
                break;
            }
            failed = function;
        }
    }
    let functions = plan.functions.into_iter().zip(&found);
    let functions = functions.filter(|(_, report)| passed(report)).map(|(function, _)| function).collect();
    let report = Report { functions: found.into_iter().flatten().collect() };
    for function in &report.functions {
        let solved =
            report.functions.iter().any(|other| other.kind == function.kind && other.failure.is_none());
        if let (Some(failure), false) = (&function.failure, solved) {
            diagnostics.push(diagnostic(model, function, failure));
        }
    }
    (Plan { constants: plan.constants, functions }, report)
}

/// Notes for every inverse function of a plan how often another method finds the same solutions: another function of the
/// same problem where `second` gives one, else Newton's method from many places. Where that finds solutions which the function
/// lacks, there is a warning; the function stays, since macros, which don't wait for another method, have the same one.
pub fn confirm(
    model: &Model,
    plan: &mut Plan,
    level: Level,
    second: impl Fn(&Function) -> Option<Function>,
    diagnostics: &mut Diagnostics,
) {
    agreement::confirm(model, plan, level, second);
    for function in &plan.functions {
        let Some(agreement) = function.agreement.as_ref().filter(|agreement| agreement.missing > 0) else {
            continue;
        };
        let name = name(model, &function.kind, &function.free);
        let plural = if agreement.missing == 1 { "" } else { "s" };
        let message = format!(
            "`{name}` lacks {} solution{plural} of {} random poses that another method ({}) finds",
            agreement.missing, agreement.poses, agreement.method
        );
        let warning = Diagnostic::warning(VERIFICATION, message).help(
            "what it returns is verified; that it returns every solution is not so for this arm. This is a mistake of the compiler, not of the table; please report it together with the table",
        );
        diagnostics.push(match function.kind {
            FunctionKind::Inverse(Some(index)) => match model.problems.get(index) {
                Some(problem) => warning.at(problem.span.clone(), "solutions of this problem are missing"),
                None => warning,
            },
            _ => warning,
        });
    }
}

/// Where the smallest singular value (m/rad, 1, ...) of a problem's Jacobian is less than this at most poses, its joints are too many for
/// its target.
const NEARLY_SINGULAR: f64 = 1e-3;

/// What is said of a function that failed.
fn diagnostic(model: &Model, function: &FunctionReport, failure: &str) -> Diagnostic {
    let message = format!("`{}` is left out, since it did not stand verification: {failure}", function.name);
    let overfull = function.inverse.as_ref().is_some_and(|inverse| inverse.overfull);
    let stiffness = function.inverse.as_ref().and_then(|inverse| inverse.stiffness);
    let nearly_singular = stiffness.filter(|stiffness| *stiffness < NEARLY_SINGULAR);
    // The functions that stood it can be used.
    let warning = Diagnostic::warning(VERIFICATION, message).help(if overfull {
        "give the problem a constraint more, or leave a joint of it to the caller with `free`, so that fewer solutions are left".to_owned()
    } else if let Some(stiffness) = nearly_singular {
        format!(
            "at most poses the joints can move so that what the target prescribes hardly changes (by {stiffness:.0e} of a rad or m for 1): next to no target can be reached; hold one of these joints, or leave it to the caller (`free`), and prescribe a target with one row less"
        )
    } else {
        "this is a mistake of the compiler, not of the table; please report it together with the table".to_owned()
    });
    match function.kind {
        FunctionKind::Inverse(Some(index)) => match model.problems.get(index) {
            Some(problem) => warning.at(problem.span.clone(), "this problem is not solved"),
            None => warning,
        },
        _ => warning,
    }
}

/// Of every inverse problem whose functions failed, the last one.
fn failed(plan: &Plan, found: &[Option<FunctionReport>]) -> Vec<Function> {
    let passed = |report: &FunctionReport| report.failure.is_none();
    let reports = || found.iter().flatten();
    if !reports().any(|report| report.kind == FunctionKind::Fk && passed(report)) {
        return Vec::new();
    }
    let mut failed: Vec<Function> = Vec::new();
    for function in &plan.functions {
        let solved = reports().any(|report| report.kind == function.kind && passed(report));
        if let (FunctionKind::Inverse(_), false) = (&function.kind, solved) {
            failed.retain(|other| other.kind != function.kind);
            failed.push(function.clone());
        }
    }
    failed
}

struct Verification<'m> {
    model: &'m Model,
    level: Level,
    /// m
    reach: f64,
}

impl Verification<'_> {
    /// One a function; `None` where the problem was solved before.
    fn reports(&self, plan: &Plan) -> Vec<Option<FunctionReport>> {
        let any = Constraints::of(self.model, None);
        let poses = poses::poses(self.model, &any, self.level, self.reach, |_| true);
        let references: Vec<_> = poses.into_iter().map(|q| Reference::at(self.model, q)).collect();
        let mut found: Vec<Option<FunctionReport>> = Vec::new();
        let (mut sound, mut solved) = (Vec::new(), Vec::new());
        for function in &plan.functions {
            if solved.contains(&function.kind) {
                found.push(None);
                continue;
            }
            let mut report = self.prepare(plan, function);
            if report.failure.is_none() {
                let functions = sound.iter().chain([function]).cloned().collect();
                let alone = Plan { constants: plan.constants.clone(), functions };
                self.run(&alone, &references, &mut report);
            }
            match function.kind {
                FunctionKind::Fk | FunctionKind::FkJacobian if report.failure.is_none() => {
                    sound.push(function.clone());
                }
                FunctionKind::Inverse(_) if report.failure.is_none() => solved.push(function.kind.clone()),
                _ => {}
            }
            found.push(Some(report));
        }
        found
    }

    /// Runs the last function of a plan, whose others are those that inverse functions rely on, as far as they are sound.
    fn run(&self, plan: &Plan, references: &[Reference<'_>], report: &mut FunctionReport) {
        let program = match Program::new(self.model, plan) {
            Ok(program) => program,
            Err(error) => {
                report.failure = Some(error.to_string());
                return;
            }
        };
        if report.inverse.is_none() {
            forward::verify(&program, references, self.reach, report);
        } else if plan.functions.iter().any(|function| function.kind == FunctionKind::Fk) {
            if let Some(function) = plan.functions.last() {
                self.inverse(&program, function, report);
            }
        } else {
            report.failure = Some("it relies on `fk`, which failed".to_owned());
        }
    }

    /// The report on a function before it is run.
    fn prepare(&self, plan: &Plan, function: &Function) -> FunctionReport {
        let mut report =
            FunctionReport::new(function.kind.clone(), name(self.model, &function.kind, &function.free));
        report.failure =
            Program::<f64>::check(self.model, plan, function).err().map(|error| error.to_string());
        report
    }

    fn inverse(&self, program: &Program<'_>, function: &Function, report: &mut FunctionReport) {
        let FunctionKind::Inverse(problem) = report.kind else {
            return;
        };
        let constraints =
            Constraints::of(self.model, problem.and_then(|index| self.model.problems.get(index)));
        let inverse = inverse::Inverse {
            model: self.model,
            program,
            problem,
            constraints: &constraints,
            free: &function.free,
            windings: &program.windings(),
            reach: self.reach,
            row_for_arm_angle: self
                .model
                .row_for_arm_angle(problem.and_then(|index| self.model.problems.get(index)), &function.free),
        };
        inverse.verify(self.level.of(function), report);
    }
}

/// The name of a function in generated code.
fn name(model: &Model, kind: &FunctionKind, free: &[usize]) -> String {
    let all = if free.is_empty() { "ik_all" } else { "ik_at" };
    match kind {
        FunctionKind::Fk => "fk".to_owned(),
        FunctionKind::FkFlange => "fk_flange".to_owned(),
        FunctionKind::Jacobian => "jacobian".to_owned(),
        FunctionKind::FkJacobian => "fk_jacobian".to_owned(),
        FunctionKind::Frames => "frames".to_owned(),
        FunctionKind::Inverse(None) => all.to_owned(),
        FunctionKind::Inverse(Some(index)) => {
            model.problems.get(*index).map_or_else(String::new, |problem| format!("{all}_{}", problem.name))
        }
    }
}
