//! The conditions that a table's inverse problem puts on its solutions (`where`).

use super::{Movable, Search};
use crate::{Float, IkError, Rule, Solutions, residual_tolerance};

/// How far (rad or m) a condition that includes its bound may be passed: roots at the bound are rounded to either side.
const AT_THE_BOUND: f64 = 1e-9;

/// The left-hand side of an inequality at a candidate: form <= 0, or form < 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition<S = f64> {
    form: S,
    strict: bool,
}

impl<S: Float> Condition<S> {
    /// form <= 0 (rad or m), to within 1e-9.
    pub const fn at_most_zero(form: S) -> Self {
        Self { form, strict: false }
    }

    /// form < 0 (rad or m).
    pub const fn below_zero(form: S) -> Self {
        Self { form, strict: true }
    }

    /// The first of a problem's conditions that does not hold.
    pub fn broken(conditions: &[Self]) -> Option<Rule<S>> {
        let broken = conditions.iter().enumerate().find(|(_, condition)| !condition.holds());
        broken.map(|(index, condition)| Rule::Where { index, excess: condition.form })
    }

    /// Whether it holds.
    pub fn holds(&self) -> bool {
        if self.strict { self.form < S::ZERO } else { self.form <= S::from_f64(AT_THE_BOUND) }
    }
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// [`Search::accept`], for a candidate that conditions may refuse.
    pub fn accept_where(
        &mut self,
        q: [S; N],
        position_error: S,
        rotation_error: S,
        conditions: &[Condition<S>],
    ) {
        self.movable = Movable::No;
        let broken = Condition::broken(conditions);
        let tolerance: S = residual_tolerance();
        let hits = position_error <= tolerance * self.reach && rotation_error <= tolerance;
        match broken {
            Some(rule) if hits => self.refuse(rule),
            // One that misses its target is dropped whatever the conditions say of it.
            _ => self.accept(q, position_error, rotation_error),
        }
    }

    /// [`Search::finish`], for solutions that were found without regard to conditions.
    ///
    /// # Errors
    /// As there; [`IkError::Forbidden`] where conditions refuse all of them, by the least.
    pub fn finish_where(
        &mut self,
        broken: impl Fn(&[S; N]) -> Option<Rule<S>>,
    ) -> Result<Solutions<N, S>, IkError<S>> {
        held(&self.finish()?, broken)
    }
}

/// The solutions of which a problem's conditions hold.
pub(super) fn held<const N: usize, S: Float>(
    solutions: &Solutions<N, S>,
    broken: impl Fn(&[S; N]) -> Option<Rule<S>>,
) -> Result<Solutions<N, S>, IkError<S>> {
    let mut held = solutions.copied();
    let mut refused: Option<Rule<S>> = None;
    for solution in &held.take() {
        let excess = |rule: &Rule<S>| if let Rule::Where { excess, .. } = rule { *excess } else { S::ZERO };
        match broken(&solution.q) {
            None => held.append(*solution),
            Some(rule) if refused.is_none_or(|old| excess(&rule) < excess(&old)) => refused = Some(rule),
            Some(_) => {}
        }
    }
    match refused {
        Some(rule) if held.is_empty() => Err(IkError::Forbidden { rule }),
        _ => Ok(held),
    }
}

#[cfg(test)]
mod tests {
    use super::Condition;
    use crate::{IkError, Rule, Search};

    #[test]
    fn conditions_refuse_solutions_and_say_which() {
        let mut search = Search::<1>::new(1.0, &[]);
        let conditions = [Condition::at_most_zero(1e-12), Condition::below_zero(0.25)];
        search.accept_where([0.5], 0.0, 0.0, &conditions);
        let rule = Rule::Where { index: 1, excess: 0.25 };
        assert_eq!(search.clone().finish().err(), Some(IkError::Forbidden { rule }));
        search.accept_where([0.5], 0.0, 0.0, &conditions[..1]);
        assert_eq!(search.finish().map(|solutions| solutions.len()), Ok(1));
    }

    #[test]
    fn solutions_that_were_found_before_are_refused_too() {
        let mut search = Search::<1>::new(1.0, &[]);
        search.accept([0.5], 0.0, 0.0);
        search.accept([-0.25], 0.0, 0.0);
        let broken =
            |bound: f64| move |q: &[f64; 1]| Condition::broken(&[Condition::at_most_zero(q[0] - bound)]);
        let found = search.finish_where(broken(0.0)).unwrap();
        assert!(found.len() == 1 && found[0].q == [-0.25]);
        let rule = Rule::Where { index: 0, excess: 0.75 };
        assert_eq!(search.finish_where(broken(-1.0)).err(), Some(IkError::Forbidden { rule }));
    }

    #[test]
    fn a_candidate_that_misses_was_no_solution() {
        let mut search = Search::<1>::new(1.0, &[]);
        search.accept_where([0.5], 1.0, 0.0, &[Condition::below_zero(0.0)]);
        assert!(matches!(search.finish(), Err(IkError::Failed { .. })));
    }
}
