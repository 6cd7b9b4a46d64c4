//! Which of several solutions one is, in words that stay true along a path.

use core::fmt;

use crate::{Float, IkError, Kinematics, MAX_JOINTS, ProblemInfo, Seed, SolutionSet, Step, Target};

/// Which root each step with two roots took: the configuration of the arm, of which [`ProblemInfo::branch`] has the words
/// (shoulder, elbow, wrist).
///
/// The root is told by the sign of its square root: of a cos x + b sin x = c the `+` root has a sin x - b cos x > 0, of
/// a x² + b x + c = 0 it has 2 a x + b > 0. These are the derivatives of the equations by what they are solved for, and the
/// determinant of the Jacobian (of as many joints as the problem solves for) has each of them as a factor: none changes its sign along a path that passes no
/// singularity, and where one does, two solutions meet. At a singular target the sign is that of one of them, or, where the
/// step leaves its joint free, `+`.
///
/// Without a closed form, it is the sign of that determinant: it changes at singularities only, but many solutions have the
/// same. Arms of that kind may be cuspidal, which is to change from one solution to another of the same sign without passing
/// a singularity \[Wenger, 1992\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Branch {
    /// Bit i is set where step i took its `-` root.
    minus: u16,
}

impl Branch {
    /// Of joint values that were not solved for step by step: [`Kinematics::branch_of`](crate::Kinematics::branch_of) tells.
    pub const UNKNOWN: Self = Self { minus: u16::MAX };

    /// All steps took their `+` root.
    pub(crate) const PLUS: Self = Self { minus: 0 };

    /// Of a set of steps that took their `-` root.
    pub(crate) const fn of_steps(minus: u32) -> Self {
        Self { minus: minus as u16 }
    }

    /// Whether it is not [`Branch::UNKNOWN`].
    pub const fn is_known(self) -> bool {
        self.minus != Self::UNKNOWN.minus
    }

    /// Whether this step took its `+` root; `None` of an unknown branch.
    pub fn is_plus(self, bit: &BranchBit) -> Option<bool> {
        self.is_known().then(|| self.minus & bit_of(bit.step) as u16 == 0)
    }
}

/// The bit of a step; of one that has no place, none.
pub(crate) fn bit_of(step: u8) -> u32 {
    1_u32.checked_shl(u32::from(step)).unwrap_or(0)
}

/// A step with two roots, and what its sign is called.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BranchBit {
    /// [`Step::index`].
    pub step: u8,
    /// The field's word for it.
    pub word: BranchWord,
    /// The row of the table (0-based) whose joint it is about.
    pub row: usize,
}

impl BranchBit {
    /// A step, its word and the row of its joint (0-based).
    pub const fn new(step: u8, word: BranchWord, row: usize) -> Self {
        Self { step, word, row }
    }
}

/// What a choice of two roots is called, after the part that the joint plays in the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BranchWord {
    /// The first joint of those that carry the tool (or the wrist) to its place: left or right, front or back.
    Shoulder,
    /// The later of those: up or down.
    Elbow,
    /// A joint of those that turn the tool there: flipped or not.
    Wrist,
    /// No word fits but the joint's own.
    Joint,
    /// Not a step: the sign of the determinant of the Jacobian.
    Determinant,
}

impl fmt::Display for BranchBit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.word {
            BranchWord::Shoulder => "shoulder",
            BranchWord::Elbow => "elbow",
            BranchWord::Wrist => "wrist",
            BranchWord::Joint => return write!(f, "joint {}", self.row + 1),
            BranchWord::Determinant => "determinant",
        })
    }
}

/// A branch in the words of its problem: `shoulder +, elbow -, wrist +`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedBranch<'a> {
    bits: &'a [BranchBit],
    branch: Branch,
}

impl<'a> ProblemInfo<'a> {
    /// The bit that goes by this word.
    pub fn bit(&self, word: BranchWord) -> Option<&'a BranchBit> {
        self.branch.iter().find(|bit| bit.word == word)
    }

    /// A branch of this problem in words.
    pub const fn named(&self, branch: Branch) -> NamedBranch<'a> {
        NamedBranch { bits: self.branch, branch }
    }
}

impl NamedBranch<'_> {
    /// Every bit with whether it is `+`; none of an unknown branch.
    pub fn iter(&self) -> impl Iterator<Item = (&BranchBit, bool)> {
        self.bits.iter().filter_map(|bit| Some((bit, self.branch.is_plus(bit)?)))
    }

    /// Whether there is nothing to say: the problem has no step with two roots, or the branch is not known.
    pub fn is_empty(&self) -> bool {
        self.bits.is_empty() || !self.branch.is_known()
    }
}

impl fmt::Display for NamedBranch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for (bit, plus) in self.iter() {
            write!(f, "{separator}{bit} {}", if plus { '+' } else { '-' })?;
            separator = ", ";
        }
        Ok(())
    }
}

impl Step {
    /// The bit among all steps.
    pub(crate) fn bit(self) -> u32 {
        bit_of(self.index)
    }

    /// The bit of a [`Branch`], where it has one.
    pub(crate) fn sign_bit(self) -> u32 {
        if self.signed { self.bit() } else { 0 }
    }
}

/// Joint values are a solution that differs from them by no more than this many times the square root of the machine epsilon
/// (rad or m): next to a singularity, neither is known better.
const SAME: f64 = 64.0;

/// See [`Kinematics::branch_of`].
pub(crate) fn of<K: Kinematics<S> + ?Sized, S: Float>(
    arm: &K,
    problem: &str,
    q: &[S],
) -> Result<Branch, IkError<S>> {
    let info = arm.problems().iter().find(|info| info.name == problem).ok_or(IkError::UnknownProblem)?;
    let target = Target::of_frame(info.target, &arm.fk(q)?);
    let mut given = [S::ZERO; MAX_JOINTS];
    for (value, joint) in given.iter_mut().zip(info.free) {
        *value = q.get(*joint).copied().unwrap_or(S::ZERO);
    }
    let given = given.get(..info.free.len()).unwrap_or(&given);
    let mut set = SolutionSet::new();
    arm.ik_seeded_into(problem, &target, given, Some(Seed::new(q)), &mut set)?;
    let windings = arm.rules().windings;
    let off = |solution: &[S]| {
        let mut difference = [S::ZERO; MAX_JOINTS];
        for (x, (a, b)) in difference.iter_mut().zip(solution.iter().zip(q)) {
            *x = *a - *b;
        }
        crate::rules::wrap_all(windings, &mut difference);
        difference.iter().fold(S::ZERO, |most, x| most.max(x.abs()))
    };
    let mut best = (Branch::UNKNOWN, S::from_f64(SAME) * S::SQRT_EPSILON);
    for solution in set.iter() {
        let off = off(solution.q);
        if off <= best.1 {
            best = (solution.branch, off);
        }
    }
    Ok(best.0)
}

#[cfg(test)]
mod tests {
    use super::{Branch, BranchBit, BranchWord};
    use crate::{ProblemInfo, TargetKind};
    use std::string::ToString;

    #[test]
    fn a_branch_in_words() {
        let branch = &[
            BranchBit::new(0, BranchWord::Shoulder, 0),
            BranchBit::new(2, BranchWord::Elbow, 2),
            BranchBit::new(3, BranchWord::Joint, 4),
        ];
        let info =
            ProblemInfo { name: "pose", target: TargetKind::Pose, free: &[], constraints: &[], branch };
        let taken = Branch::of_steps(0b0100);
        assert_eq!(info.named(taken).to_string(), "shoulder +, elbow -, joint 5 +");
        let elbow = info.bit(BranchWord::Elbow).unwrap();
        assert_eq!((taken.is_plus(elbow), Branch::UNKNOWN.is_plus(elbow)), (Some(false), None));
        assert!(info.bit(BranchWord::Wrist).is_none());
        assert!(info.named(Branch::UNKNOWN).is_empty() && !info.named(taken).is_empty());
    }
}
