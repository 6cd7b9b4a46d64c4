//! One robot as motion, drivers and the command line see it.

use crate::{
    Branch, BranchBit, ConstraintTerm, Float, Frame, IkError, Joint, LengthError, MAX_JOINTS, Reachable,
    Redundancy, Rule, Rules, Seed, SolutionSet, Target, TargetKind, Violations,
};

/// The name of the inverse problem of the full pose.
pub const FULL_POSE: &str = "pose";

/// An inverse problem that a robot can solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProblemInfo<'a> {
    /// Its name in the table; [`FULL_POSE`] for the full pose.
    pub name: &'a str,
    /// What it prescribes.
    pub target: TargetKind,
    /// Joints left to the caller (indices of q).
    pub free: &'a [usize],
    /// Equations between the joint values that it prescribes besides.
    pub constraints: &'a [ConstraintTerm],
    /// What the signs of its solutions' [`Branch`] are called.
    pub branch: &'a [BranchBit],
}

/// The kinematics of one robot, over slices, so that it can be used as `&dyn Kinematics`. Every generated arm and the
/// interpreter of a table implement it.
///
/// Joint values are radians (metres for prismatic joints), lengths metres, frames those of the tool in the base.
pub trait Kinematics<S: Float = f64> {
    /// The robot's name.
    fn name(&self) -> &str;

    /// A hash of its table, for logs and drivers to compare.
    fn fingerprint(&self) -> u64;

    /// How many rows its table has, held ones included: one less than there are frames.
    fn rows(&self) -> usize;

    /// The joints, and where joints and tool point may be.
    fn rules(&self) -> Rules<'_, S>;

    /// The inverse problems that it can solve.
    fn problems(&self) -> &[ProblemInfo<'_>];

    /// Pose of the tool frame in the base frame.
    ///
    /// # Errors
    /// Where `q` has the wrong length.
    fn fk(&self, q: &[S]) -> Result<Frame<S>, LengthError>;

    /// The same without the tool.
    ///
    /// # Errors
    /// Where `q` has the wrong length.
    fn fk_flange(&self, q: &[S]) -> Result<Frame<S>, LengthError>;

    /// The frame of every row, base first, and how many there are.
    ///
    /// # Errors
    /// Where `q` has the wrong length, or `out` is shorter than `rows() + 1`.
    fn frames_into(&self, q: &[S], out: &mut [Frame<S>]) -> Result<usize, LengthError>;

    /// The columns of the geometric Jacobian at the tool point, in base axes: vx vy vz (m) wx wy wz (rad), per radian
    /// or metre of the joint.
    ///
    /// # Errors
    /// Where `q` has the wrong length, or `out` is shorter than `dof()`.
    fn jacobian_into(&self, q: &[S], out: &mut [[S; 6]]) -> Result<(), LengthError>;

    /// Every geometric solution of an inverse problem ([`FULL_POSE`] or a name of the table), limits ignored. Of a
    /// problem that leaves one joint to the caller ([`Kinematics::redundancy`]), those of a sweep over its values that
    /// are nearest to the middle of the limits; the set counts what found no room.
    ///
    /// # Errors
    /// Why there is none; `out` is empty then. [`IkError::Length`] where a problem leaves several joints to the caller.
    fn ik_into(&self, problem: &str, target: &Target<S>, out: &mut SolutionSet<S>) -> Result<(), IkError<S>> {
        match self.redundancy(problem) {
            Some(redundancy) => redundancy.sweep_into(self, problem, target, out),
            None => self.ik_seeded_into(problem, target, &[], None, out),
        }
    }

    /// The same with the joints that the problem leaves to the caller at `free` (rad or m, in the order of
    /// [`ProblemInfo::free`]).
    ///
    /// # Errors
    /// Why there is none; `out` is empty then. [`IkError::Length`] where `free` has the wrong length.
    fn ik_at_into(
        &self,
        problem: &str,
        target: &Target<S>,
        free: &[S],
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        self.ik_seeded_into(problem, target, free, None, out)
    }

    /// The same; a joint that the target leaves free is set as near to the seed as the others can follow.
    ///
    /// # Errors
    /// Those of [`Kinematics::ik_at_into`]; [`IkError::Length`] where the seed has not a value a joint.
    fn ik_seeded_into(
        &self,
        problem: &str,
        target: &Target<S>,
        free: &[S],
        seed: Option<Seed<'_, S>>,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>>;

    /// Which condition (`where` in the table) of a problem joint values break, every angle taken in (-pi, pi];
    /// a [`Rule::Where`].
    fn broken_condition(&self, problem: &str, q: &[S]) -> Option<Rule<S>> {
        let _ = (problem, q);
        None
    }

    /// How the solutions of a problem hang on the one joint that it leaves to the caller; `None` where it leaves none,
    /// or several.
    fn redundancy(&self, problem: &str) -> Option<Redundancy<'_, S>> {
        let _ = problem;
        None
    }

    /// The arm angle of a spherical-roll-spherical arm at these joint values (rad), see [`Redundancy::arm_angle`]; `None` for a
    /// problem that has none.
    ///
    /// # Errors
    /// Where `q` has the wrong length.
    fn arm_angle(&self, problem: &str, q: &[S]) -> Result<Option<S>, LengthError> {
        LengthError::check(self.dof(), q.len())?;
        Ok(self.redundancy(problem).and_then(|redundancy| redundancy.arm_angle_of(self, q)))
    }

    /// Every geometric solution of a problem with this arm angle (rad), limits ignored, see [`Redundancy::by_arm_angle`].
    ///
    /// # Errors
    /// Why there is none; `out` is empty then. [`IkError::UnknownProblem`] where the problem has no arm angle.
    fn ik_by_arm_angle_into(
        &self,
        problem: &str,
        target: &Target<S>,
        arm_angle: S,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        out.clear();
        let redundancy = self.redundancy(problem).ok_or(IkError::UnknownProblem)?;
        redundancy.by_arm_angle_into(self, problem, target, arm_angle, out)
    }

    /// The branch of a problem that joint values (rad or m) are on: that of the solution which they are of the target that they
    /// meet. [`Branch::UNKNOWN`] where they are none, since they don't keep the problem's constraints.
    ///
    /// # Errors
    /// [`IkError::UnknownProblem`]; [`IkError::Length`] where `q` has the wrong length; those of
    /// [`Kinematics::ik_at_into`].
    fn branch_of(&self, problem: &str, q: &[S]) -> Result<Branch, IkError<S>> {
        crate::branch::of(self, problem, q)
    }

    /// How many joints it has.
    fn dof(&self) -> usize {
        self.joints().len()
    }

    /// Its joints, in the order of q.
    fn joints(&self) -> &[Joint<'_, S>] {
        self.rules().joints
    }

    /// The tool point (m) in the frame that the workspace rules are written in: the base frame of the table.
    ///
    /// # Errors
    /// Where `q` has the wrong length.
    fn rules_point(&self, q: &[S]) -> Result<[S; 3], LengthError> {
        self.fk(q).map(|tool| tool.translation)
    }

    /// The solutions that limits and rules allow: see [`Rules::allowed`]. Where one joint
    /// is left to the caller: those of a sweep over its values that are nearest to the seed (without one, to the middle
    /// of the limits); of the full pose with a seed the first is the nearest that there is, see
    /// [`Redundancy::nearest`].
    ///
    /// # Errors
    /// Why there is none; `out` is empty then.
    fn ik_within(
        &self,
        problem: &str,
        target: &Target<S>,
        seed: Option<&[S]>,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        if let Some(redundancy) = self.redundancy(problem) {
            return redundancy.within_into(self, problem, target, seed, out);
        }
        out.clear();
        let dof = self.dof();
        if let Some(seed) = seed {
            LengthError::check(dof, seed.len())?;
        }
        let seed = seed.map(padded);
        let solve = |seed: Seed<'_, S>| {
            let mut set = SolutionSet::new();
            self.ik_seeded_into(problem, target, &[], Some(seed), &mut set)?;
            Ok(set.into_padded())
        };
        // The solutions have the right length: the point is always there.
        let point = |q: &[S; MAX_JOINTS]| self.rules_point(q.get(..dof).unwrap_or(q)).unwrap_or([S::NAN; 3]);
        out.fill_padded(dof, self.rules().allowed(solve, point, seed.as_ref())?);
        Ok(())
    }

    /// The joint values inside their limits, and the tool frame there, that come nearest to a target, for one that cannot be
    /// reached: the sum of the squares of [`Target::errors`] is least, rad beside lengths in the size of the arm (the
    /// distances of its frames' origins, one to the next, in the middle of the limits). A problem's constraints on joints are
    /// kept (to about 1e-8 of what the target is missed by, in f64), limits on sums and the rules of the workspace likewise; its
    /// `where` is not looked at.
    ///
    /// Damped Gauss-Newton steps lead downhill from the seed (rad or m; without one, from the middle of the
    /// limits) and from 15 places more. What they find is a least distance near there; nothing proves that there is no
    /// nearer target. It takes about as long as some thousand poses; no other function pays for it.
    ///
    /// # Errors
    /// Those of [`Target::validate_as`]; [`IkError::UnknownProblem`]; [`IkError::Length`] where the seed has not a value a
    /// joint.
    fn nearest_reachable(
        &self,
        problem: &str,
        target: &Target<S>,
        seed: Option<&[S]>,
    ) -> Result<Reachable<S>, IkError<S>> {
        crate::reachable::nearest(self, problem, target, seed)
    }

    /// Whether limits and rules allow these joint values.
    ///
    /// # Errors
    /// Everything that they break, a wrong number of values included.
    #[allow(clippy::result_large_err, reason = "no heap: the error holds the joint values that it speaks of")]
    fn check(&self, q: &[S]) -> Result<(), Violations<'_, S>> {
        match self.rules_point(q) {
            Ok(position) => self.rules().check(q, position),
            Err(_) => Err(Violations::of_length(self.rules(), q)),
        }
    }
}

/// Joint values with 0 behind them.
pub(crate) fn padded<S: Float>(q: &[S]) -> [S; MAX_JOINTS] {
    let mut padded = [S::ZERO; MAX_JOINTS];
    padded.iter_mut().zip(q).for_each(|(to, from)| *to = *from);
    padded
}

/// A borrowed robot is one, `&dyn Kinematics` too: what takes a robot by value, like [`Mounted`](crate::Mounted), can
/// be given a reference.
impl<K: Kinematics<S> + ?Sized, S: Float> Kinematics<S> for &K {
    fn name(&self) -> &str {
        (**self).name()
    }
    fn fingerprint(&self) -> u64 {
        (**self).fingerprint()
    }
    fn rows(&self) -> usize {
        (**self).rows()
    }
    fn rules(&self) -> Rules<'_, S> {
        (**self).rules()
    }
    fn problems(&self) -> &[ProblemInfo<'_>] {
        (**self).problems()
    }
    fn fk(&self, q: &[S]) -> Result<Frame<S>, LengthError> {
        (**self).fk(q)
    }
    fn fk_flange(&self, q: &[S]) -> Result<Frame<S>, LengthError> {
        (**self).fk_flange(q)
    }
    fn frames_into(&self, q: &[S], out: &mut [Frame<S>]) -> Result<usize, LengthError> {
        (**self).frames_into(q, out)
    }
    fn jacobian_into(&self, q: &[S], out: &mut [[S; 6]]) -> Result<(), LengthError> {
        (**self).jacobian_into(q, out)
    }
    fn ik_into(&self, problem: &str, target: &Target<S>, out: &mut SolutionSet<S>) -> Result<(), IkError<S>> {
        (**self).ik_into(problem, target, out)
    }
    fn ik_seeded_into(
        &self,
        problem: &str,
        target: &Target<S>,
        free: &[S],
        seed: Option<Seed<'_, S>>,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        (**self).ik_seeded_into(problem, target, free, seed, out)
    }
    fn broken_condition(&self, problem: &str, q: &[S]) -> Option<Rule<S>> {
        (**self).broken_condition(problem, q)
    }
    fn redundancy(&self, problem: &str) -> Option<Redundancy<'_, S>> {
        (**self).redundancy(problem)
    }
    fn branch_of(&self, problem: &str, q: &[S]) -> Result<Branch, IkError<S>> {
        (**self).branch_of(problem, q)
    }
    fn rules_point(&self, q: &[S]) -> Result<[S; 3], LengthError> {
        (**self).rules_point(q)
    }
}
