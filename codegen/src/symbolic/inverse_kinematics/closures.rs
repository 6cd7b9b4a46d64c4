//! Equations that are written once for all choices of the joints that the caller gives.
//!
//! Before it is asked what is known, a joint that is given is a variable like any other: whichever it is, the equations are the
//! same, but for the order of the variables, of which those that are given come last.

use super::atoms::{AngleData, AtomData, Atoms, Source};
use super::closure::{self, Closure, Equation, Trouble};
use super::tracked::Seen;
use super::unknowns::Unknowns;
use crate::model::{Model, Target};
use crate::symbolic::expression::Arena;

/// The equations of one robot that were written so far.
pub struct Closures<'m> {
    pub(super) model: &'m Model,
    written: Vec<Written>,
}

struct Written {
    target: Target,
    seen: Seen,
    /// None of them given, base to tip.
    unknowns: Unknowns,
    outcome: Result<(Arena, Closure), Trouble>,
}

impl<'m> Closures<'m> {
    /// None yet.
    pub fn of(model: &'m Model) -> Self {
        Self { model, written: Vec::new() }
    }

    /// What [`closure::build`] writes, and the arena of its expressions.
    pub(super) fn get(
        &mut self,
        target: Target,
        unknowns: &Unknowns,
        seen: Seen,
    ) -> Result<(Arena, Closure), Trouble> {
        let (unknowns, order) = unknowns.base_to_tip();
        let same = |other: &Written| {
            let Unknowns { free, rows, .. } = &other.unknowns;
            other.target == target && other.seen == seen && *free == unknowns.free && *rows == unknowns.rows
        };
        if let Some(known) = self.written.iter().find(|other| same(other)) {
            return known.in_order(&order);
        }
        let mut arena = Arena::default();
        let outcome = closure::build(&mut arena, self.model, target, &unknowns, seen);
        let written = Written { target, seen, unknowns, outcome: outcome.map(|closure| (arena, closure)) };
        let found = written.in_order(&order);
        self.written.push(written);
        found
    }
}

impl Written {
    /// With the variables where they are asked for, each at its place in this list.
    fn in_order(&self, order: &[usize]) -> Result<(Arena, Closure), Trouble> {
        let (arena, closure) = self.outcome.as_ref().map_err(|trouble| *trouble)?;
        let place = |variable: usize| order.get(variable).copied().unwrap_or(variable);
        let angles = closure.atoms.angles.iter().enumerate().map(|(at, angle)| match angle {
            AngleData::Free(variable) => (at, AngleData::Free(place(*variable))),
            AngleData::Constant { .. } => (at, angle.clone()),
        });
        let mut angles: Vec<(usize, AngleData)> = angles.collect();
        angles.sort_by_key(|(_, angle)| match angle {
            AngleData::Free(variable) => *variable,
            AngleData::Constant { .. } => usize::MAX,
        });
        let (places, angles): (Vec<usize>, Vec<AngleData>) = angles.into_iter().unzip();
        let list = closure.atoms.list.iter().map(|atom| match atom.source {
            Source::Slide(variable) => AtomData { source: Source::Slide(place(variable)), ..atom.clone() },
            _ => atom.clone(),
        });
        let equations = closure.equations.iter().map(|equation| Equation {
            polynomial: equation.polynomial.in_order(&places),
            origin: equation.origin.clone(),
            name: equation.name.clone(),
            group: equation.group,
        });
        let atoms = Atoms { list: list.collect(), angles };
        Ok((arena.clone(), Closure { atoms, equations: equations.collect() }))
    }
}

#[cfg(test)]
mod tests {
    use super::{Closures, Seen, Target, closure};
    use crate::symbolic::expression::Arena;
    use crate::symbolic::fixtures::panda;
    use crate::symbolic::inverse_kinematics::unknowns;

    #[test]
    fn equations_that_are_shared_are_those_that_are_written_for_one_choice() {
        let model = panda();
        let mut closures = Closures::of(&model);
        for given in [&[4][..], &[0], &[6], &[2], &[1, 3], &[3, 1]] {
            let unknowns = unknowns::eliminate(&model, &[], given).unwrap();
            for seen in [Seen::FromBase, Seen::FromTool] {
                let (_, shared) = closures.get(Target::Pose, &unknowns, seen).unwrap();
                let mut arena = Arena::default();
                let own = closure::build(&mut arena, &model, Target::Pose, &unknowns, seen).unwrap();
                assert_eq!(format!("{:?}", shared.atoms), format!("{:?}", own.atoms));
                assert_eq!(format!("{:?}", shared.equations), format!("{:?}", own.equations));
            }
        }
        assert_eq!(closures.written.len(), 2);
    }
}
