//! Redundant arms as motion and the command line see them: sets of solutions, as many as have room.

use super::{Arm, Redundancy};
use crate::kinematics::padded;
use crate::solutions::travel;
use crate::{
    Float, Frame, IkError, Kinematics, LengthError, MAX_JOINTS, Seed, SolutionSet, Solutions, Target,
};

impl<S: Float> Redundancy<'_, S> {
    /// [`Kinematics::ik_into`] of a problem that leaves one joint to the caller: of the sweep's solutions, limits
    /// ignored, those nearest to the middle of the limits.
    ///
    /// # Errors
    /// What is said at the last sample, where there is no solution at any.
    pub fn sweep_into<K: Kinematics<S> + ?Sized>(
        &self,
        arm: &K,
        problem: &str,
        target: &Target<S>,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        out.clear();
        let solutions = self.swept(arm, problem, target, &self.rules.middle(), Ok)?;
        out.fill_padded(arm.dof(), solutions);
        Ok(())
    }

    /// [`Kinematics::ik_within`] of such a problem: what limits and rules allow of it, the nearest to the seed first, if
    /// there is one.
    pub(crate) fn within_into<K: Kinematics<S> + ?Sized>(
        &self,
        arm: &K,
        problem: &str,
        target: &Target<S>,
        seed: Option<&[S]>,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        out.clear();
        let dof = arm.dof();
        let point = |q: &[S; MAX_JOINTS]| arm.rules_point(q.get(..dof).unwrap_or(q)).unwrap_or([S::NAN; 3]);
        let Some(seed) = seed else {
            let allowed = |solutions: Solutions<MAX_JOINTS, S>| solutions.within(&self.rules, point, None);
            let solutions = self.swept(arm, problem, target, &self.rules.middle(), allowed)?;
            out.fill_padded(dof, solutions);
            return Ok(());
        };
        LengthError::check(dof, seed.len())?;
        let padded = padded(seed);
        let target = target.validate()?;
        let at = |free| at(arm, problem, &target, free, &padded);
        let state = |q: &[S; MAX_JOINTS]| state(arm, q);
        let allowed =
            |solutions: Solutions<MAX_JOINTS, S>| solutions.within(&self.rules, point, Some(&padded));
        let swept = self.swept(arm, problem, &target, &padded, allowed);
        if !self.whole_pose {
            out.fill_padded(dof, swept?);
            return Ok(());
        }
        let nearest = self.nearest(Arm::new(at, state), point, &target, &padded);
        // Either may find what lies between the samples of the other.
        let solutions = match (swept, nearest) {
            (Ok(solutions), Err(_)) => solutions,
            (Err(_), Ok(nearest)) => Solutions::one(nearest),
            (Ok(mut solutions), Ok(nearest)) => {
                if solutions.iter().all(|other| travel(&other.q, &nearest.q) > S::EPSILON) {
                    solutions.insert_by_distance(nearest, &padded);
                }
                solutions
            }
            (Err(_), Err(error)) => return Err(error),
        };
        out.fill_padded(dof, solutions);
        Ok(())
    }

    /// [`Kinematics::arm_angle`].
    pub(crate) fn arm_angle_of<K: Kinematics<S> + ?Sized>(&self, arm: &K, q: &[S]) -> Option<S> {
        self.arm_angle(|q: &[S; MAX_JOINTS]| state(arm, q), &padded(q))
    }

    /// [`Kinematics::ik_by_arm_angle_into`].
    pub(crate) fn by_arm_angle_into<K: Kinematics<S> + ?Sized>(
        &self,
        arm: &K,
        problem: &str,
        target: &Target<S>,
        arm_angle: S,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        out.clear();
        let middle = self.rules.middle();
        let at = |free| at(arm, problem, target, free, &middle);
        let state = |q: &[S; MAX_JOINTS]| state(arm, q);
        out.fill_padded(arm.dof(), self.by_arm_angle(Arm::new(at, state), target, arm_angle)?);
        Ok(())
    }

    /// What is kept of the solutions at every sample, those nearest to `reference`.
    fn swept<K: Kinematics<S> + ?Sized>(
        &self,
        arm: &K,
        problem: &str,
        target: &Target<S>,
        reference: &[S; MAX_JOINTS],
        kept: impl Fn(Solutions<MAX_JOINTS, S>) -> Result<Solutions<MAX_JOINTS, S>, IkError<S>>,
    ) -> Result<Solutions<MAX_JOINTS, S>, IkError<S>> {
        let mut all = Solutions::EMPTY;
        let mut refusal = IkError::NotFinite;
        for value in self.samples() {
            match at(arm, problem, target, value, reference).and_then(&kept) {
                Ok(solutions) => {
                    solutions.iter().for_each(|solution| all.insert_by_distance(*solution, reference));
                }
                Err(error) => refusal = error,
            }
        }
        if all.is_empty() { Err(refusal) } else { Ok(all) }
    }
}

/// The tool frame and the columns of the Jacobian.
fn state<K: Kinematics<S> + ?Sized, S: Float>(
    arm: &K,
    q: &[S; MAX_JOINTS],
) -> (Frame<S>, [[S; 6]; MAX_JOINTS]) {
    let (q, mut columns) = (q.get(..arm.dof()).unwrap_or(q), [[S::ZERO; 6]; MAX_JOINTS]);
    let nowhere = Frame { translation: [S::NAN; 3], ..Frame::IDENTITY };
    let tool = arm.jacobian_into(q, &mut columns).and_then(|()| arm.fk(q)).unwrap_or(nowhere);
    (tool, columns)
}

/// The solutions with the free joint at a value; what the target leaves free besides is as in the reference.
fn at<K: Kinematics<S> + ?Sized, S: Float>(
    arm: &K,
    problem: &str,
    target: &Target<S>,
    free: S,
    reference: &[S; MAX_JOINTS],
) -> Result<Solutions<MAX_JOINTS, S>, IkError<S>> {
    let mut set = SolutionSet::new();
    let seed = reference.get(..arm.dof()).map(Seed::new);
    arm.ik_seeded_into(problem, target, &[free], seed, &mut set)?;
    Ok(set.into_padded())
}
