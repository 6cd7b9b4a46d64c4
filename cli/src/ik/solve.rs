//! One inverse problem, asked again and again.

use super::{refusal, trace};
use crate::failure::{Failure, Refusal};
use crate::robot::Robot;
use crate::units::Units;
use dh_codegen::plan::eval::Interpreter;
use dh_codegen::plan::{Function, FunctionKind};
use dh_core::{
    FULL_POSE, IkError, Kinematics, Norm, Reachable, Seed, SolutionSet, Target, TargetKind, Travel,
};

/// A solution.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Answer {
    /// rad or m
    pub(crate) q: Vec<f64>,
    /// m
    pub(crate) position_error: f64,
    /// rad
    pub(crate) rotation_error: f64,
    /// Whether q, as it stands, breaks no limit and no rule.
    pub(crate) within_limits: bool,
    /// Row of the joint that the target leaves free.
    pub(crate) free: Option<usize>,
    /// "elbow +, wrist -"; empty where there is no choice.
    pub(crate) branch: String,
    /// rad; of spherical-roll-spherical arms whose problem leaves a joint to the caller.
    pub(crate) arm_angle: Option<f64>,
}

/// An inverse problem with what does not change from target to target.
pub(crate) struct Question<'a> {
    robot: &'a Robot,
    arm: &'a Interpreter<'a>,
    name: &'a str,
    kind: TargetKind,
    function: &'a Function,
    /// What to be near to (rad or m), and whether it was given.
    near: Vec<f64>,
    seeded: bool,
    /// The same of targets that say nothing of it.
    usual: (Vec<f64>, bool),
    /// What counts as nearest, where that was said.
    travel: Option<(Vec<f64>, Norm)>,
    all: bool,
    /// Joints that the problem leaves to the caller (indices of q).
    left: &'a [usize],
    /// Their values (rad or m); none where they are to be looked for.
    free: Option<Vec<f64>>,
    /// The arm angle (rad) that is given in their place.
    arm_angle: Option<f64>,
    set: SolutionSet,
}

impl<'a> Question<'a> {
    /// A problem by its name.
    ///
    /// # Errors
    /// The robot does not have it, or it is not solved.
    pub(crate) fn new(
        robot: &'a Robot,
        arm: &'a Interpreter<'a>,
        name: &'a str,
        near: Option<Vec<f64>>,
        all: bool,
    ) -> Result<Self, Failure> {
        let index = robot.model().problems.iter().position(|problem| problem.name == name);
        let kind = FunctionKind::Inverse(index);
        let function = robot.output.plan.functions.iter().find(|function| function.kind == kind);
        let info = arm.problems().iter().find(|info| info.name == name);
        let (Some(function), Some(info)) = (function, info) else {
            return Err(unsolved(robot, arm, name).into());
        };
        let middle = || {
            let middle = |joint: &dh_core::Joint<'_>| joint.limits.map_or(0.0, |limits| limits.middle());
            arm.joints().iter().map(middle).collect()
        };
        let seeded = near.is_some();
        let near = near.unwrap_or_else(middle);
        Ok(Question {
            robot,
            arm,
            name,
            kind: info.target,
            function,
            usual: (near.clone(), seeded),
            near,
            seeded,
            travel: None,
            all,
            left: info.free,
            free: info.free.is_empty().then(Vec::new),
            arm_angle: None,
            set: SolutionSet::new(),
        })
    }

    /// Takes the values of free joints, in the table's units.
    ///
    /// # Errors
    /// Where they are not as many as the problem leaves to the caller. One may be left out.
    pub(crate) fn give(&mut self, values: Option<&[f64]>) -> Result<(), Refusal> {
        self.free = match (values, self.left) {
            (None, [_]) => None,
            (values, left) => Some(self.units().some_joints_in_si(left, values.unwrap_or_default())?),
        };
        Ok(())
    }

    /// Takes the arm angle, in the table's units, that stands for the free joint's value.
    ///
    /// # Errors
    /// Where the problem has none, or it is not finite.
    pub(crate) fn turn(&mut self, arm_angle: Option<f64>) -> Result<(), Failure> {
        let redundancy = self.arm.redundancy(self.name);
        let known = redundancy.is_some_and(|redundancy| redundancy.spherical_roll_spherical.is_some());
        match arm_angle {
            Some(_) if !known => {
                let message = format!("the problem `{}` has no arm angle", self.name);
                let help = "the full pose of a spherical-roll-spherical arm has one, where a joint of shoulder or wrist is left to the caller";
                return Err(Refusal::new("arm_angle", message).help(help).into());
            }
            Some(angle) if !angle.is_finite() => {
                return Err(Failure::Usage(format!("--arm-angle has {angle}, which is not finite")));
            }
            given => self.arm_angle = given.map(|angle| self.units().radians(angle)),
        }
        Ok(())
    }

    /// Takes what counts as nearest: a weight a joint, and how the joints' ways make one.
    ///
    /// # Errors
    /// Where the weights are not one a joint, or one is negative or not finite.
    pub(crate) fn weigh(&mut self, weights: Option<&[f64]>, norm: Norm) -> Result<(), Failure> {
        let weights = weights.unwrap_or_default();
        let dof = self.dof();
        if !weights.is_empty() && weights.len() != dof {
            let count = weights.len();
            return Err(Failure::Usage(format!(
                "--weights has {count} numbers where {dof} are needed, one a joint"
            )));
        }
        if let Some(wrong) = weights.iter().find(|weight| !(weight.is_finite() && **weight >= 0.0)) {
            return Err(Failure::Usage(format!(
                "--weights has {wrong}; a weight is finite and not negative"
            )));
        }
        self.travel = (!weights.is_empty() || norm != Norm::default()).then(|| (weights.to_vec(), norm));
        Ok(())
    }

    /// Takes joint values to be near to, in the table's units; left out, those that the question began with.
    ///
    /// # Errors
    /// Where they are not one a joint, or not finite.
    pub(crate) fn seek(&mut self, near: Option<&[f64]>) -> Result<(), Refusal> {
        (self.near, self.seeded) = match near {
            Some(near) => (self.units().joints_in_si(near)?, true),
            None => self.usual.clone(),
        };
        Ok(())
    }

    /// Whether all free joints are given.
    ///
    /// # Errors
    /// They are needed for what is asked.
    pub(crate) fn is_given(&self, what: &str) -> Result<(), Refusal> {
        let Some(name) = self.swept() else { return Ok(()) };
        let message = format!("{what} needs the value of {name}, which the problem leaves to the caller");
        Err(Refusal::new("free", message).help("give it with --free"))
    }

    /// The free joint that many values are tried of.
    pub(crate) fn swept(&self) -> Option<&'a str> {
        let [joint] = self.left else { return None };
        (self.free.is_none() && self.arm_angle.is_none()).then(|| self.units().joint(*joint).1)
    }

    /// The name of a row.
    pub(crate) fn row(&self, row: usize) -> &'a str {
        self.robot.model().rows.get(row).map_or("a row", |row| row.name.as_str())
    }

    /// Its name.
    pub(crate) fn name(&self) -> &str {
        self.name
    }

    /// What it takes.
    pub(crate) fn kind(&self) -> TargetKind {
        self.kind
    }

    /// Whether limits are passed over.
    pub(crate) fn all(&self) -> bool {
        self.all
    }

    /// Number of joints.
    pub(crate) fn dof(&self) -> usize {
        self.arm.dof()
    }

    /// The units of the table.
    pub(crate) fn units(&self) -> Units<'a> {
        self.robot.units()
    }

    /// An error in the table's units.
    pub(crate) fn refusal(&self, error: &IkError) -> Refusal {
        let problem = self.robot.model().problems.iter().find(|problem| problem.name == self.name);
        refusal::of(error, self.robot.model(), problem, self.function)
    }

    /// The same, with the nearest target that can be reached, where it is the target's place or the limits that are at fault.
    pub(crate) fn refusal_near(&self, error: &IkError, target: &Target) -> Refusal {
        if matches!(error, IkError::NotFinite) && target.numbers().iter().all(|number| number.is_finite()) {
            return refusal::too_far();
        }
        let refusal = self.refusal(error);
        let at_fault = matches!(
            error,
            IkError::Singular { .. }
                | IkError::Unreachable { .. }
                | IkError::OutsideLimits { .. }
                | IkError::Forbidden { .. }
                | IkError::Failed { .. }
        );
        let nearest = || self.arm.nearest_reachable(self.name, target, Some(&self.near));
        match at_fault.then(nearest) {
            Some(Ok(nearest)) if self.allows(&nearest) => {
                refusal::with_nearest(refusal, self.units(), &nearest)
            }
            _ => refusal,
        }
    }

    /// Where limits and rules can't all be kept, what is nearest breaks some.
    fn allows(&self, nearest: &Reachable) -> bool {
        self.arm.rules().check(nearest.q(), nearest.tool.translation).is_ok()
    }

    /// The solutions.
    pub(crate) fn solve(&mut self, target: &Target) -> Result<Vec<Answer>, IkError> {
        if let Some(arm_angle) = self.arm_angle {
            self.arm.ik_by_arm_angle_into(self.name, target, arm_angle, &mut self.set)?;
            if !self.all {
                self.keep_allowed()?;
            }
            return Ok(self.answers());
        }
        match (&self.free, self.all) {
            (Some(free), true) => {
                let seed = seed(&self.near, self.seeded);
                self.arm.ik_seeded_into(self.name, target, free, seed, &mut self.set)?;
                Ok(self.answers())
            }
            (Some(free), false) if !free.is_empty() => {
                let seed = seed(&self.near, true);
                self.arm.ik_seeded_into(self.name, target, free, seed, &mut self.set)?;
                self.keep_allowed()?;
                Ok(self.answers())
            }
            (_, false) => {
                self.arm.ik_within(self.name, target, Some(&self.near), &mut self.set)?;
                Ok(self.answers())
            }
            (None, true) => self.sweep(target),
        }
    }

    /// Every solution at every sample of the free joint.
    fn sweep(&mut self, target: &Target) -> Result<Vec<Answer>, IkError> {
        let samples = self.arm.redundancy(self.name).into_iter().flat_map(|free| free.samples());
        let (mut answers, mut refusal) = (Vec::new(), IkError::UnknownProblem);
        for value in samples.collect::<Vec<f64>>() {
            match self.arm.ik_at_into(self.name, target, &[value], &mut self.set) {
                Ok(()) => answers.extend(self.answers()),
                Err(error) => refusal = error,
            }
        }
        self.sort(&mut answers);
        if answers.is_empty() { Err(refusal) } else { Ok(answers) }
    }

    /// Leaves what limits and rules allow.
    fn keep_allowed(&mut self) -> Result<(), IkError> {
        let point = |q: &[f64]| self.arm.rules_point(q).unwrap_or([f64::NAN; 3]);
        self.set.within(&self.arm.rules(), point, Some(&self.near))
    }

    /// The same, with every step as text.
    pub(crate) fn trace(&mut self, target: &Target) -> (String, Result<Vec<Answer>, IkError>) {
        let (arm, free) = (self.arm, self.free.clone().unwrap_or_default());
        let mut trace = trace::Trace::new(self.robot, self.function);
        let seed = seed(&self.near, self.seeded || !self.all);
        let outcome = arm.trace_ik(self.name, target, &free, seed, &mut self.set, |event| trace.event(event));
        // The steps are those of one call; what is allowed may take several.
        let answers = if self.all { outcome.map(|()| self.answers()) } else { self.solve(target) };
        (trace.into_text(), answers)
    }

    fn answers(&self) -> Vec<Answer> {
        let answer = |solution: dh_core::SolutionView<'_>| Answer {
            q: solution.q.to_vec(),
            position_error: solution.position_error,
            rotation_error: solution.rotation_error,
            within_limits: self.arm.check(solution.q).is_ok(),
            free: solution.free,
            branch: self.branch(&solution),
            arm_angle: self.arm.arm_angle(self.name, solution.q).ok().flatten(),
        };
        let mut answers: Vec<Answer> = self.set.iter().map(answer).collect();
        self.sort(&mut answers);
        answers
    }

    /// The branch of a solution in words; one that was walked to is solved for once more.
    fn branch(&self, solution: &dh_core::SolutionView<'_>) -> String {
        let Some(info) = self.arm.problems().iter().find(|info| info.name == self.name) else {
            return String::new();
        };
        let own = Some(solution.branch).filter(|branch| branch.is_known());
        let branch = own.or_else(|| self.arm.branch_of(self.name, solution.q).ok());
        branch.map_or_else(String::new, |branch| info.named(branch).to_string())
    }

    /// The nearest to the seed first, where there is one. Allowed solutions already come nearest first by the usual measure;
    /// they are sorted again only where another measure was asked for.
    fn sort(&self, answers: &mut [Answer]) {
        let travel = match &self.travel {
            Some((weights, norm)) => Travel { weights, norm: *norm },
            None if self.all && self.seeded => Travel::default(),
            None => return,
        };
        let way = |answer: &Answer| travel.between(&self.near, &answer.q);
        answers.sort_by(|one, other| way(one).total_cmp(&way(other)));
    }
}

/// What joints are set near to that the target leaves free, if it is wanted.
fn seed(near: &[f64], wanted: bool) -> Option<Seed<'_>> {
    wanted.then(|| Seed::new(near))
}

/// Why a problem cannot be asked.
fn unsolved(robot: &Robot, arm: &Interpreter<'_>, name: &str) -> Refusal {
    let solved: Vec<&str> = arm.problems().iter().map(|info| info.name).collect();
    let help = if solved.is_empty() {
        format!(
            "no inverse problem of this table is solved; `dhc check {}` says why",
            robot.source.name_shown
        )
    } else {
        format!("--problem takes {}", solved.join(", "))
    };
    let known = name == FULL_POSE || robot.model().problems.iter().any(|problem| problem.name == name);
    let shown = dh_codegen::diagnostic::shortened(name);
    let message = if known {
        format!("the problem `{shown}` of this table is not solved")
    } else {
        format!("the table has no inverse problem `{shown}`")
    };
    Refusal::new("unknown_problem", message).help(help)
}
