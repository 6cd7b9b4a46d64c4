//! The interpreter: runs a plan as it stands, with the kernels and in the order of operations of generated code, so
//! that both give the same bits.
//!
//! A `Program` is a plan that was checked and lowered to instructions once; an `Interpreter` on it is an arm like
//! any generated one, a `dh_core::Kinematics`, in any scalar type.

mod error;
mod filter;
mod interpreter;
mod lowering;
mod robot;
mod routine;
mod run;
mod trace;

#[cfg(test)]
mod tests;

pub use error::PlanError;
pub use interpreter::Interpreter;
pub use trace::Event;

use super::{Form, Function, FunctionKind, Plan};
use crate::model::Model;
use dh_core::{
    Condition, Float, IkError, MAX_JOINTS, Rule, Search, Seed, Solutions, Target, Wanted, Winding,
};
use filter::Filter;
use routine::Routine;
use run::{Inverse, Registers, Searching};

/// A plan, checked and lowered to instructions on scalars of type `S`.
#[derive(Debug, Clone)]
pub struct Program<'m, S: Float = f64> {
    model: &'m Model,
    plan: &'m Plan,
    /// One a function of the plan.
    routines: Vec<Routine<S>>,
    /// The `where` of every problem of the model.
    filters: Vec<Vec<Filter<S>>>,
    /// Terms of `Model::sums`, in the scalar type.
    sum_terms: Vec<Vec<(usize, S)>>,
    /// What `Model::windings` carry, in the scalar type.
    carried: Vec<Vec<(usize, S)>>,
}

/// What an inverse problem is asked with besides its target.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Given<'a, S = f64> {
    /// Values of the problem's free joints (rad or m).
    pub(crate) free: &'a [S],
    /// What joints are set near to that the target leaves free.
    pub(crate) seed: Option<Seed<'a, S>>,
}

/// The unknowns of a function at a seed.
fn wanted<'s, S: Float>(function: &Function, seed: Option<Seed<'s, S>>) -> Wanted<'s, MAX_JOINTS, S> {
    let at = |form: &Option<Form>, q: &[S]| {
        let Some(form) = form else { return S::NAN };
        form.terms.iter().fold(S::from_f64(form.constant), |sum, (joint, factor)| {
            sum + S::from_f64(*factor) * q.get(*joint).copied().unwrap_or(S::ZERO)
        })
    };
    let mut unknowns = [S::NAN; MAX_JOINTS];
    if let Some(seed) = seed {
        unknowns.iter_mut().zip(&function.unknowns).for_each(|(to, form)| *to = at(form, seed.q));
    }
    Wanted::new(unknowns, seed)
}

impl<'m, S: Float> Program<'m, S> {
    /// Checks and lowers every function of a plan.
    ///
    /// # Errors
    /// The first thing in the plan that cannot be run.
    pub fn new(model: &'m Model, plan: &'m Plan) -> Result<Self, PlanError> {
        if model.joints.len() > MAX_JOINTS {
            return Err(PlanError::Joints { joints: model.joints.len() });
        }
        let routines = plan.functions.iter().map(|function| Routine::lower(model, plan, function));
        let scalars =
            |terms: &[(usize, f64)]| terms.iter().map(|(joint, c)| (*joint, S::from_f64(*c))).collect();
        Ok(Program {
            model,
            plan,
            routines: routines.collect::<Result<_, _>>()?,
            filters: model.problems.iter().map(|problem| Filter::all_of(model, problem)).collect(),
            sum_terms: model.sums.iter().map(|sum| scalars(&sum.terms)).collect(),
            carried: model.windings.iter().map(|winding| scalars(&winding.carries)).collect(),
        })
    }

    /// Checks one function of a plan as [`Program::new`] does.
    pub(crate) fn check(model: &Model, plan: &Plan, function: &Function) -> Result<(), PlanError> {
        Routine::<S>::lower(model, plan, function).map(|_| ())
    }

    /// The arm that this program describes.
    ///
    /// # Errors
    /// [`PlanError::Missing`] where the plan lacks `fk`, `fk_flange`, `jacobian` or `frames`.
    pub fn interpreter(&self) -> Result<Interpreter<'_, S>, PlanError> {
        Interpreter::new(self)
    }

    /// The function of a kind with its lowered form.
    fn find(&self, kind: &FunctionKind) -> Option<(&Function, &Routine<S>)> {
        self.plan.functions.iter().zip(&self.routines).find(|(function, _)| function.kind == *kind)
    }

    /// The outputs of a forward function; `None` where the plan lacks it.
    pub(crate) fn forward(&self, kind: &FunctionKind, q: &[S]) -> Option<Vec<S>> {
        let (function, routine) = self.find(kind)?;
        let mut registers = Registers::of(routine, q.iter().copied());
        run::forward(routine, function, &mut registers, |_| ());
        Some(routine.outputs.iter().map(|output| registers.get(*output)).collect())
    }

    /// Every geometric solution of an inverse problem (an index into `Model::problems`, or the full pose). `given`
    /// has the values of the problem's free joints, `windings` the model's in the scalar type. `None` where the plan
    /// lacks the problem's function or `fk`.
    pub(crate) fn inverse(
        &self,
        problem: Option<usize>,
        target: &Target<S>,
        given: Given<'_, S>,
        windings: &[Winding<'_, S>],
        observer: impl FnMut(Event<'_, S>),
    ) -> Option<Result<Solutions<MAX_JOINTS, S>, IkError<S>>> {
        let (names, routine) = self.find(&FunctionKind::Inverse(problem))?;
        let (_, fk) = self.find(&FunctionKind::Fk)?;
        let reach = S::from_f64(self.model.reach());
        let mut registers = Registers::of(routine, target.numbers().iter().chain(given.free).copied());
        let wanted = wanted(names, given.seed);
        let mut run = Inverse {
            routine,
            names,
            fk,
            both: self.find(&FunctionKind::FkJacobian).map(|(_, both)| both),
            target,
            dof: self.model.joints.len(),
            reach,
            filters: problem.and_then(|problem| self.filters.get(problem)).map_or(&[], Vec::as_slice),
            observer,
            windings,
            wanted: &wanted,
            search: Searching::Exact(Search::about(reach, windings, &wanted).with_given(&names.free)),
        };
        run.run(&mut registers);
        Some(run.finish())
    }

    /// The first condition of a problem of the model that joint values (rad or m) break.
    pub(crate) fn broken_condition(&self, problem: usize, q: &[S]) -> Option<Rule<S>> {
        let conditions: Vec<_> = self.filters.get(problem)?.iter().map(|filter| filter.at(q)).collect();
        Condition::broken(&conditions)
    }

    /// The model's windings in the scalar type.
    pub(crate) fn windings(&self) -> Vec<Winding<'_, S>> {
        robot::windings(self)
    }
}
