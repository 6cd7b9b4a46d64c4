//! Whether another method finds the same solutions.

use super::constraints::Constraints;
use super::newton::Newton;
use super::prescribed::target_of;
use super::where_clause::Wheres;
use super::{Level, RESIDUAL, inverse, poses, reference};
use crate::model::{self, Model};
use crate::plan::eval::{Given, Program};
use crate::plan::{Agreement, Function, FunctionKind, Plan};
use dh_core::{Target, Winding};

/// How many random poses are solved by both methods, at least.
const POSES: usize = 32;

/// The same where the other one is Newton's method from many places, which takes its time.
const POSES_OF_NEWTON: usize = 8;

/// What that is called.
const NEWTON: &str = "Newton's method from some hundred places, on the product of the matrices";

/// Of the random poses that verification is asked for, this part is solved by both methods.
const PART: usize = 100;

/// Solutions that are nearer than this (rad or m) are one: less accurate next to singular poses than elsewhere.
const SAME: f64 = 1e-5;

/// Where the smallest singular value of the problem's Jacobian is greater than this, solutions are as accurate as that.
const REGULAR: f64 = 1e-4;

/// Notes for every inverse function how often another method finds the same solutions at random poses: another function of
/// the same problem where `other` gives one, else Newton's method.
pub(super) fn confirm(
    model: &Model,
    plan: &mut Plan,
    level: Level,
    other: impl Fn(&Function) -> Option<Function>,
) {
    let Some(fk) = plan.functions.iter().find(|function| function.kind == FunctionKind::Fk).cloned() else {
        return;
    };
    let both = plan.functions.iter().find(|function| function.kind == FunctionKind::FkJacobian).cloned();
    let constants = plan.constants.clone();
    let alone = |function: &Function| Plan {
        constants: constants.clone(),
        functions: [Some(fk.clone()), both.clone(), Some(function.clone())].into_iter().flatten().collect(),
    };
    for function in &mut plan.functions {
        let FunctionKind::Inverse(problem) = function.kind else { continue };
        let own = alone(function);
        let Ok(own) = Program::new(model, &own) else { continue };
        let comparison = Comparison::new(model, problem, &function.free, &own, level);
        let second = other(function).filter(|second| second.free == function.free);
        let by_function = second.and_then(|second| {
            let plan = alone(&second);
            let program = Program::new(model, &plan).ok()?;
            comparison.with_function(&program, &second)
        });
        let agreement = by_function.or_else(|| comparison.with_newton());
        function.agreement = agreement.filter(|agreement| agreement.poses > 0);
    }
}

/// One inverse problem that is solved once more.
struct Comparison<'v> {
    model: &'v Model,
    problem: Option<usize>,
    kind: model::Target,
    constraints: Constraints,
    wheres: Wheres<'v>,
    free: &'v [usize],
    own: &'v Program<'v>,
    /// m
    reach: f64,
    level: Level,
}

impl<'v> Comparison<'v> {
    fn new(
        model: &'v Model,
        problem: Option<usize>,
        free: &'v [usize],
        own: &'v Program<'v>,
        level: Level,
    ) -> Self {
        let entry = problem.and_then(|index| model.problems.get(index));
        let kind = entry.map_or(model::Target::Pose, |problem| problem.target);
        let (constraints, wheres) = (Constraints::of(model, entry), Wheres::of(model, problem));
        Comparison { model, problem, kind, constraints, wheres, free, own, reach: model.reach(), level }
    }

    /// With another function of the problem. A method that finds nothing anywhere says nothing.
    fn with_function(&self, program: &Program<'_>, second: &Function) -> Option<Agreement> {
        let method = second.stages.first().map_or_else(String::new, |stage| stage.equation.clone());
        let windings = program.windings();
        let mut applies = false;
        let agreement = self.at_poses(method, POSES, |target, q| {
            let (found, _) = self.solutions(program, target, q, &windings);
            applies |= !found.is_empty();
            found
        });
        applies.then_some(agreement)
    }

    /// With Newton's method; `None` where the target leaves more open than single solutions.
    fn with_newton(&self) -> Option<Agreement> {
        let unknowns = self.constraints.independent.iter().filter(|joint| !self.free.contains(joint)).count();
        if unknowns > self.kind.rows() {
            return None;
        }
        let newton = Newton {
            model: self.model,
            constraints: &self.constraints,
            wheres: &self.wheres,
            free: self.free,
            reach: self.reach,
            same: SAME,
        };
        Some(self.at_poses(NEWTON.to_owned(), POSES_OF_NEWTON, |target, q| newton.solutions(target, q)))
    }

    /// `other` gives the other method's solutions of a target, which was made from joint values.
    fn at_poses(
        &self,
        method: String,
        least: usize,
        mut other: impl FnMut(&Target<f64>, &[f64]) -> Vec<Vec<f64>>,
    ) -> Agreement {
        let wanted = |q: &[f64]| self.wheres.clearly_keep(q);
        let poses = poses::poses(self.model, &self.constraints, self.level, self.reach, wanted);
        let windings = self.own.windings();
        let most = match self.level {
            Level::Poses(random) => least.max(random as usize / PART).min(random as usize),
            _ => least,
        };
        let mut agreement = Agreement { method, poses: 0, agreed: 0, missing: 0 };
        // The first ones are random.
        for (number, q) in poses.iter().take(most).enumerate() {
            let tool = reference::tool(self.model, q);
            let Some(target) = target_of(self.kind, &tool, number, self.reach) else { continue };
            let (own, points) = self.solutions(self.own, &target, q, &windings);
            if !points {
                continue;
            }
            let other = other(&target, q);
            let among = |q: &Vec<f64>, others: &[Vec<f64>]| {
                others.iter().any(|other| inverse::travel(self.model, q, other) <= SAME)
            };
            agreement.poses += 1;
            let same = own.len() == other.len() && own.iter().all(|q| among(q, &other));
            let further: Vec<&Vec<f64>> = other.iter().filter(|q| !among(q, &own)).collect();
            agreement.agreed += usize::from(same && further.is_empty());
            agreement.missing +=
                further.into_iter().filter(|q| self.is_regular(q, &target, &windings)).count();
        }
        agreement
    }

    /// Whether joint values meet a target, in all that the problem asks for, and stand alone.
    fn is_regular(&self, q: &[f64], target: &Target<f64>, windings: &[Winding<'_>]) -> bool {
        let (position, rotation) = target.errors(&reference::tool(self.model, q));
        let problem = inverse::Inverse {
            model: self.model,
            program: self.own,
            problem: self.problem,
            constraints: &self.constraints,
            free: self.free,
            windings,
            reach: self.reach,
            row_for_arm_angle: None,
        };
        position <= RESIDUAL * self.reach
            && rotation <= RESIDUAL
            && self.constraints.excess(q) <= RESIDUAL
            && self.wheres.clearly_keep(q)
            && problem.smallest_singular_value(q, target) > REGULAR
    }

    /// Joint values of every solution of a function, and whether none of them leaves a joint free, of which any value would
    /// do; the joints that the caller gives are as in `q`.
    fn solutions(
        &self,
        program: &Program<'_>,
        target: &Target<f64>,
        q: &[f64],
        windings: &[Winding<'_>],
    ) -> (Vec<Vec<f64>>, bool) {
        let free: Vec<f64> = self.free.iter().map(|joint| q.get(*joint).copied().unwrap_or(0.0)).collect();
        let given = Given { free: &free, seed: None };
        let answer = program.inverse(self.problem, target, given, windings, |_| ());
        let found: Vec<_> = answer.into_iter().flatten().flatten().collect();
        let joints = found.iter().map(|solution| solution.q.get(..q.len()).unwrap_or_default().to_vec());
        (joints.collect(), found.iter().all(|solution| solution.free.is_none()))
    }
}

#[cfg(test)]
mod tests {
    use super::{Comparison, Level, Program};

    const TWO: &str = "[robot]\nname = \"two\"\nconvention = \"standard\"\n[[joint]]\na = 0.5\n[[joint]]\na = 0.4\n\
        [[ik]]\nname = \"xy\"\ntarget = \"xy\"\n";

    #[test]
    fn what_a_function_lacks_is_missing_where_it_is_regular_and_meets_the_target() {
        let output = crate::compile(TWO, Level::Quick).output.unwrap();
        let one = format!("{TWO}where = [\"theta2 > 0\"]\n");
        let one = crate::compile(&one, Level::Quick).output.unwrap();
        let missing = |own: &crate::Output| {
            let own = Program::new(&own.model, &own.plan).unwrap();
            let newton =
                Comparison::new(&output.model, Some(0), &[], &own, Level::Full).with_newton().unwrap();
            (newton.agreed, newton.missing)
        };
        assert_eq!(missing(&output), (8, 0));
        assert_eq!(missing(&one), (0, 8));
    }

    #[test]
    fn what_one_method_lacks_or_has_elsewhere_is_counted() {
        let output = crate::compile(TWO, Level::Quick).output.unwrap();
        let program = Program::new(&output.model, &output.plan).unwrap();
        let comparison = Comparison::new(&output.model, Some(0), &[], &program, Level::Full);
        let newton = comparison.with_newton().unwrap();
        assert_eq!((newton.poses, newton.agreed), (8, 8));
        let windings = program.windings();
        let changed = |change: fn(&mut Vec<Vec<f64>>)| {
            let agreement = comparison.at_poses(String::new(), 8, |target, q| {
                let (mut all, _) = comparison.solutions(&program, target, q, &windings);
                change(&mut all);
                all
            });
            (agreement.poses, agreement.agreed)
        };
        assert_eq!(changed(|_| ()), (8, 8));
        assert_eq!(changed(|all| all.truncate(1)), (8, 0));
        assert_eq!(changed(|all| all.push(vec![0.1, 0.2])), (8, 0));
        assert_eq!(changed(|all| all[0][1] += 1e-3), (8, 0));
    }
}
