//! Joint values as linear forms in the few of them that the constraints of an inverse problem leave open.

use crate::evenly::evenly;
use crate::{ConstraintTerm, Float, JointKind, Kinematics, MAX_JOINTS, ProblemInfo};

/// The most unknowns that a problem of six equations can have.
pub(crate) const UNKNOWNS: usize = 6;

/// Coefficients up to this many machine epsilons are what rounding leaves of 0.
const NOTHING: f64 = 64.0;

/// The joint values that keep the constraints of a problem.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unknowns<S> {
    /// Those (rad or m) with every unknown at 0.
    origin: [S; MAX_JOINTS],
    /// How they change with each unknown.
    directions: [[S; MAX_JOINTS]; UNKNOWNS],
    /// Which joint each unknown is (index of q).
    joints: [usize; UNKNOWNS],
    count: usize,
}

/// A linear equation: coefficients of the joint values, then the constant; they add up to 0.
type Equation<S> = ([S; MAX_JOINTS], S);

impl<S: Float> Unknowns<S> {
    /// What a problem leaves open with the joints that are left to the caller at `free` (rad or m). Angles are in rad,
    /// slides in multiples of `reach` (m). Of joints more than a target can determine, the last are left at 0.
    pub(crate) fn of<K: Kinematics<S> + ?Sized>(
        arm: &K,
        info: &ProblemInfo<'_>,
        free: &[S],
        reach: S,
    ) -> Self {
        let dof = arm.dof().min(MAX_JOINTS);
        // Each solved for one joint, which no other has any more.
        let mut solved = [([S::ZERO; MAX_JOINTS], S::ZERO); MAX_JOINTS];
        let mut pivots = [None; MAX_JOINTS];
        let count = info.constraints.iter().map(|term| term.equation + 1).max().unwrap_or(0);
        let prescribed = (0..count).map(|equation| sum(info.constraints, equation));
        let given = info.free.iter().zip(free).map(|(joint, value)| single(*joint, *value));
        for equation in prescribed.chain(given) {
            eliminate(equation, dof, &mut solved, &mut pivots);
        }
        let mut unknowns = Self {
            origin: [S::ZERO; MAX_JOINTS],
            directions: [[S::ZERO; MAX_JOINTS]; UNKNOWNS],
            joints: [0; UNKNOWNS],
            count: 0,
        };
        let solved = || solved.iter().zip(&pivots);
        for (joint, row) in arm.joints().iter().enumerate().take(dof) {
            let own = solved().find(|(_, pivot)| **pivot == Some(joint));
            if let Some(((_, constant), _)) = own {
                if let Some(value) = unknowns.origin.get_mut(joint) {
                    *value = -*constant;
                }
                continue;
            }
            let unit = if row.kind == JointKind::Prismatic { reach } else { S::ONE };
            let place =
                (unknowns.directions.get_mut(unknowns.count), unknowns.joints.get_mut(unknowns.count));
            let (Some(direction), Some(slot)) = place else { continue };
            *slot = joint;
            unknowns.count += 1;
            if let Some(own) = direction.get_mut(joint) {
                *own = unit;
            }
            for ((coefficients, _), pivot) in solved() {
                let place = pivot.and_then(|pivot| direction.get_mut(pivot));
                if let (Some(place), Some(coefficient)) = (place, coefficients.get(joint)) {
                    *place = -(*coefficient * unit);
                }
            }
        }
        unknowns
    }

    /// The same with the unknown that is this joint at a value (rad or m); it stays an unknown that changes nothing.
    pub(crate) fn holding(&self, joint: usize, value: S) -> Self {
        let mut held = *self;
        for (direction, _) in held.directions.iter_mut().zip(self.joints()).filter(|(_, own)| **own == joint)
        {
            let unit = direction.get(joint).copied().unwrap_or(S::ONE);
            let x = value / unit;
            held.origin.iter_mut().zip(&*direction).for_each(|(sum, own)| *sum += x * *own);
            *direction = [S::ZERO; MAX_JOINTS];
        }
        held
    }

    /// Which joint each unknown is (index of q).
    pub(crate) fn joints(&self) -> &[usize] {
        self.joints.get(..self.count).unwrap_or(&self.joints)
    }

    /// The values of this number of those that are spread evenly over a turn, over two reaches where a joint slides.
    pub(crate) fn sample<K: Kinematics<S> + ?Sized>(&self, arm: &K, number: u32) -> [S; UNKNOWNS] {
        let mut x = evenly(number, self.count);
        for (value, joint) in x.iter_mut().zip(self.joints()) {
            let slides = arm.joints().get(*joint).is_some_and(|joint| joint.kind == JointKind::Prismatic);
            *value *= if slides { S::TWO } else { S::TAU };
        }
        x.iter_mut().skip(self.count).for_each(|value| *value = S::ZERO);
        x
    }

    /// Joint values (rad or m) at values of the unknowns.
    pub(crate) fn q(&self, x: &[S; UNKNOWNS]) -> [S; MAX_JOINTS] {
        let mut q = self.origin;
        for (value, direction) in x.iter().zip(&self.directions).take(self.count) {
            q.iter_mut().zip(direction).for_each(|(sum, own)| *sum += *value * *own);
        }
        q
    }

    /// The unknowns at joint values (rad or m); whether these keep the constraints is not looked at.
    pub(crate) fn at(&self, q: &[S]) -> [S; UNKNOWNS] {
        let mut x = [S::ZERO; UNKNOWNS];
        for ((value, direction), joint) in x.iter_mut().zip(&self.directions).zip(self.joints()) {
            if let (Some(own), Some(unit)) = (q.get(*joint), direction.get(*joint)) {
                *value = *own / *unit;
            }
        }
        x
    }

    /// What each unknown does, from what each joint does.
    pub(crate) fn columns(&self, of_joints: &[[S; 6]; MAX_JOINTS]) -> [[S; 6]; UNKNOWNS] {
        let mut columns = [[S::ZERO; 6]; UNKNOWNS];
        for (column, direction) in columns.iter_mut().zip(&self.directions).take(self.count) {
            for (factor, own) in direction.iter().zip(of_joints).filter(|(factor, _)| **factor != S::ZERO) {
                column.iter_mut().zip(own).for_each(|(sum, own)| *sum += *factor * *own);
            }
        }
        columns
    }
}

/// The sum of the terms of one equation.
fn sum<S: Float>(terms: &[ConstraintTerm], equation: usize) -> Equation<S> {
    let (mut coefficients, mut constant) = ([S::ZERO; MAX_JOINTS], S::ZERO);
    for term in terms.iter().filter(|term| term.equation == equation) {
        let own = S::from_f64(term.coefficient);
        match term.joint {
            None => constant += own,
            Some(joint) => coefficients.iter_mut().skip(joint).take(1).for_each(|sum| *sum += own),
        }
    }
    (coefficients, constant)
}

/// That a joint has a value.
fn single<S: Float>(joint: usize, value: S) -> Equation<S> {
    let mut coefficients = [S::ZERO; MAX_JOINTS];
    coefficients.iter_mut().skip(joint).take(1).for_each(|own| *own = S::ONE);
    (coefficients, -value)
}

/// Adds an equation to those that are solved. What follows from these already says nothing.
fn eliminate<S: Float>(
    (mut coefficients, mut constant): Equation<S>,
    dof: usize,
    solved: &mut [Equation<S>; MAX_JOINTS],
    pivots: &mut [Option<usize>; MAX_JOINTS],
) {
    let subtract = |to: &mut Equation<S>, from: &Equation<S>, pivot: usize| {
        let factor = to.0.get(pivot).copied().unwrap_or(S::ZERO);
        to.0.iter_mut().zip(&from.0).for_each(|(x, y)| *x -= factor * *y);
        to.1 -= factor * from.1;
    };
    let mut own = (coefficients, constant);
    for (known, pivot) in solved.iter().zip(pivots.iter()) {
        if let Some(pivot) = pivot {
            subtract(&mut own, known, *pivot);
        }
    }
    (coefficients, constant) = own;
    let greatest = coefficients.iter().take(dof).fold(S::ZERO, |most, x| most.max(x.abs()));
    let nothing = S::from_f64(NOTHING) * S::EPSILON * greatest.max(S::ONE);
    // The least: of q1 = 2 q2, a turn of q2 is all that there is, and half a turn of q1 would be.
    let present = coefficients.iter().take(dof).enumerate().filter(|(_, x)| x.abs() > nothing);
    let least = present.reduce(|a, b| if b.1.abs() < a.1.abs() { b } else { a });
    let Some((pivot, factor)) = least.map(|(pivot, factor)| (pivot, *factor)) else { return };
    let own = (coefficients.map(|x| x / factor), constant / factor);
    for known in &mut *solved {
        subtract(known, &own, pivot);
    }
    let place = solved.iter_mut().zip(pivots).find(|(_, pivot)| pivot.is_none());
    if let Some((place, slot)) = place {
        (*place, *slot) = (own, Some(pivot));
    }
}

#[cfg(test)]
mod tests {
    use super::{Equation, eliminate};
    use crate::MAX_JOINTS;

    fn equation(terms: &[(usize, f64)], constant: f64) -> Equation<f64> {
        let mut coefficients = [0.0; MAX_JOINTS];
        for (joint, factor) in terms {
            coefficients[*joint] = *factor;
        }
        (coefficients, constant)
    }

    #[test]
    fn equations_are_solved_for_one_joint_each() {
        let (mut solved, mut pivots) = ([equation(&[], 0.0); MAX_JOINTS], [None; MAX_JOINTS]);
        // q0 = 2 q1, q1 + q2 + q3 = 1, twice the first, and q3 = 5.
        let given = [
            equation(&[(0, 1.0), (1, -2.0)], 0.0),
            equation(&[(1, 1.0), (2, 1.0), (3, 1.0)], -1.0),
            equation(&[(0, 2.0), (1, -4.0)], 0.0),
            equation(&[(3, 1.0)], -5.0),
        ];
        for equation in given {
            eliminate(equation, 4, &mut solved, &mut pivots);
        }
        let found = |joint: usize| {
            let place = pivots.iter().position(|pivot| *pivot == Some(joint)).unwrap();
            solved[place]
        };
        assert_eq!(pivots.iter().flatten().count(), 3);
        assert_eq!(found(0), equation(&[(0, 1.0), (2, 2.0)], 8.0));
        assert_eq!(found(1), equation(&[(1, 1.0), (2, 1.0)], 4.0));
        assert_eq!(found(3), equation(&[(3, 1.0)], -5.0));
    }
}
