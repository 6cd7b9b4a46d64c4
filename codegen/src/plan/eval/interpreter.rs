//! A program as an arm like any generated one.

use super::routine::Routine;
use super::run::{self, Registers};
use super::trace::Event;
use super::{Given, PlanError, Program, robot};
use crate::model::Problem;
use crate::plan::{Function, FunctionKind};
use dh_core::{
    Bound, FULL_POSE, Float, Frame, IkError, Joint, KeepOut, Kinematics, LengthError, ProblemInfo,
    Redundancy, Rule, Rules, Seed, SolutionSet, SumLimit, Target, TargetKind, Winding,
};

/// An arm of a table read at run time: [`Kinematics`] by running a [`Program`], and traces of such runs.
#[derive(Debug, Clone)]
pub struct Interpreter<'p, S: Float = f64> {
    program: &'p Program<'p, S>,
    fk: Forward<'p, S>,
    fk_flange: Forward<'p, S>,
    jacobian: Forward<'p, S>,
    frames: Forward<'p, S>,
    joints: Vec<Joint<'p, S>>,
    sums: Vec<SumLimit<'p, S>>,
    bounds: Vec<Bound<S>>,
    keep_out: Vec<KeepOut<S>>,
    windings: Vec<Winding<'p, S>>,
    problems: Vec<ProblemInfo<'p>>,
    /// For each of `problems`, its index in the model, or `None` for the full pose.
    indices: Vec<Option<usize>>,
    /// For each of `problems`, [`Model::row_for_arm_angle`](crate::model::Model::row_for_arm_angle).
    rows_for_arm_angles: Vec<Option<usize>>,
}

/// A forward function with its lowered form.
#[derive(Debug, Clone, Copy)]
struct Forward<'p, S> {
    function: &'p Function,
    routine: &'p Routine<S>,
}

impl<'p, S: Float> Interpreter<'p, S> {
    /// The arm that a program describes.
    ///
    /// # Errors
    /// [`PlanError::Missing`] where the plan lacks `fk`, `fk_flange`, `jacobian` or `frames`.
    pub fn new(program: &'p Program<'p, S>) -> Result<Self, PlanError> {
        let forward = |kind: FunctionKind| match program.find(&kind) {
            Some((function, routine)) => Ok(Forward { function, routine }),
            None => Err(PlanError::Missing { kind }),
        };
        let model = program.model;
        let mut problems = Vec::new();
        let mut indices = Vec::new();
        let mut rows_for_arm_angles = Vec::new();
        for function in &program.plan.functions {
            let FunctionKind::Inverse(index) = function.kind else {
                continue;
            };
            let problem = index.and_then(|index| model.problems.get(index));
            rows_for_arm_angles.push(model.row_for_arm_angle(problem, &function.free));
            problems.push(match problem {
                Some(problem) => ProblemInfo {
                    name: &problem.name,
                    target: crate::plan::target_kind(problem.target),
                    free: &function.free,
                    constraints: &function.constraints,
                    branch: &function.branch,
                },
                None => ProblemInfo {
                    name: FULL_POSE,
                    target: TargetKind::Pose,
                    free: &function.free,
                    constraints: &function.constraints,
                    branch: &function.branch,
                },
            });
            indices.push(index);
        }
        Ok(Interpreter {
            program,
            fk: forward(FunctionKind::Fk)?,
            fk_flange: forward(FunctionKind::FkFlange)?,
            jacobian: forward(FunctionKind::Jacobian)?,
            frames: forward(FunctionKind::Frames)?,
            joints: robot::joints(model),
            sums: robot::sums(program),
            bounds: robot::bounds(model),
            keep_out: robot::keep_out(model),
            windings: robot::windings(program),
            problems,
            indices,
            rows_for_arm_angles,
        })
    }

    /// [`Kinematics::fk`], telling an observer every named step.
    ///
    /// # Errors
    /// Where `q` has the wrong length.
    pub fn trace_fk(&self, q: &[S], observer: impl FnMut(Event<'_, S>)) -> Result<Frame<S>, LengthError> {
        let registers = self.run(self.fk, q, observer)?;
        Ok(run::frame(&self.fk.routine.outputs, &registers))
    }

    /// [`Kinematics::ik_seeded_into`], telling an observer every named step, which roots every stage has and what becomes of
    /// every candidate. `free` are the values (rad or m) of the problem's free joints.
    ///
    /// # Errors
    /// Why there is no solution; `out` is empty then.
    pub fn trace_ik(
        &self,
        problem: &str,
        target: &Target<S>,
        free: &[S],
        seed: Option<Seed<'_, S>>,
        out: &mut SolutionSet<S>,
        observer: impl FnMut(Event<'_, S>),
    ) -> Result<(), IkError<S>> {
        out.clear();
        let place =
            self.problems.iter().position(|info| info.name == problem).ok_or(IkError::UnknownProblem)?;
        let (Some(info), Some(index)) = (self.problems.get(place), self.indices.get(place)) else {
            return Err(IkError::UnknownProblem);
        };
        if target.kind() != info.target {
            return Err(IkError::WrongTarget { expected: info.target });
        }
        LengthError::check(info.free.len(), free.len())?;
        if let Some(seed) = seed {
            LengthError::check(self.joints.len(), seed.q.len())?;
        }
        let target = target.validate()?;
        let solutions = self
            .program
            .inverse(*index, &target, Given { free, seed }, &self.windings, observer)
            .ok_or(IkError::UnknownProblem)??;
        out.fill(self.joints.len(), &solutions);
        Ok(())
    }

    /// Runs a forward function; its outputs are in the registers.
    fn run(
        &self,
        forward: Forward<'p, S>,
        q: &[S],
        observer: impl FnMut(Event<'_, S>),
    ) -> Result<Registers<S>, LengthError> {
        LengthError::check(self.joints.len(), q.len())?;
        let mut registers = Registers::of(forward.routine, q.iter().copied());
        run::forward(forward.routine, forward.function, &mut registers, observer);
        Ok(registers)
    }
}

impl<S: Float> Kinematics<S> for Interpreter<'_, S> {
    fn name(&self) -> &str {
        &self.program.model.name
    }

    fn fingerprint(&self) -> u64 {
        self.program.model.fingerprint
    }

    fn rows(&self) -> usize {
        self.program.model.rows.len()
    }

    fn rules(&self) -> Rules<'_, S> {
        Rules {
            joints: &self.joints,
            sums: &self.sums,
            bounds: &self.bounds,
            keep_out: &self.keep_out,
            windings: &self.windings,
        }
    }

    fn problems(&self) -> &[ProblemInfo<'_>] {
        &self.problems
    }

    fn fk(&self, q: &[S]) -> Result<Frame<S>, LengthError> {
        self.trace_fk(q, |_| ())
    }

    fn fk_flange(&self, q: &[S]) -> Result<Frame<S>, LengthError> {
        let registers = self.run(self.fk_flange, q, |_| ())?;
        Ok(run::frame(&self.fk_flange.routine.outputs, &registers))
    }

    fn frames_into(&self, q: &[S], out: &mut [Frame<S>]) -> Result<usize, LengthError> {
        let count = self.rows() + 1;
        if out.len() < count {
            return Err(LengthError { expected: count, got: out.len() });
        }
        let registers = self.run(self.frames, q, |_| ())?;
        for (frame, outputs) in out.iter_mut().zip(self.frames.routine.outputs.chunks_exact(12)) {
            *frame = run::frame(outputs, &registers);
        }
        Ok(count)
    }

    fn jacobian_into(&self, q: &[S], out: &mut [[S; 6]]) -> Result<(), LengthError> {
        if out.len() < self.joints.len() {
            return Err(LengthError { expected: self.joints.len(), got: out.len() });
        }
        let registers = self.run(self.jacobian, q, |_| ())?;
        let outputs = self.jacobian.routine.outputs.iter().map(|output| registers.get(*output));
        out.as_flattened_mut().iter_mut().zip(outputs).for_each(|(entry, output)| *entry = output);
        Ok(())
    }

    fn ik_seeded_into(
        &self,
        problem: &str,
        target: &Target<S>,
        free: &[S],
        seed: Option<Seed<'_, S>>,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        self.trace_ik(problem, target, free, seed, out, |_| ())
    }

    fn broken_condition(&self, problem: &str, q: &[S]) -> Option<Rule<S>> {
        let place = self.problems.iter().position(|info| info.name == problem)?;
        self.program.broken_condition((*self.indices.get(place)?)?, q)
    }

    fn redundancy(&self, problem: &str) -> Option<Redundancy<'_, S>> {
        let place = self.problems.iter().position(|info| info.name == problem)?;
        let [joint] = self.problems.get(place)?.free else { return None };
        let reach = S::from_f64(self.program.model.reach());
        let index = *self.indices.get(place)?;
        let problem = index.and_then(|index| self.program.model.problems.get(index));
        let redundancy = if problem.is_none_or(Problem::is_whole_pose) {
            Redundancy::of_pose(*joint, self.rules(), reach)
        } else {
            Redundancy::of_problem(*joint, self.rules(), reach)
        };
        let redundancy = match *self.rows_for_arm_angles.get(place)? {
            Some(row) => redundancy.spherical_roll_spherical(row),
            None => redundancy,
        };
        let searched =
            self.program.find(&FunctionKind::Inverse(index)).is_some_and(|(names, _)| names.is_searched());
        Some(if searched { redundancy.searched() } else { redundancy })
    }
}
