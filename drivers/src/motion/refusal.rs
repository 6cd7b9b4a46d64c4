//! Why a motion is refused.

use super::profile::ProfileError;
use dh_runtime::{IkError, JointKind, LengthError, Rule, TargetKind, Violation, Violations};
use std::fmt;

/// A motion that is refused, before anything of it was sent.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// Which of the moves that were asked for (0-based).
    pub step: usize,
    /// Where on the way of that move, where it is somewhere.
    pub sample: Option<Sample>,
    /// What is wrong there.
    pub reason: Reason,
    /// What else is wrong at that place: of joint values, everything that they break.
    pub also: Box<[Reason]>,
}

/// What is wrong at one place, the first of it apart.
#[derive(Debug)]
pub(super) struct Reasons {
    pub(super) first: Reason,
    also: Box<[Reason]>,
}

impl Reasons {
    /// Everything that joint values break.
    pub(super) fn of_violations(violations: &Violations<'_>) -> Option<Self> {
        let mut reasons = violations.iter().map(Reason::from);
        Some(Self { first: reasons.next()?, also: reasons.collect() })
    }

    /// At a place on the way of a move.
    pub(super) fn at(self, step: usize, sample: Sample) -> Refusal {
        Refusal { also: self.also, ..self.first.at(step, sample) }
    }
}

impl From<Reason> for Reasons {
    fn from(first: Reason) -> Self {
        Self { first, also: Box::default() }
    }
}

/// A place on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Its index; 0 is the start.
    pub index: usize,
    /// How many there are; where the end of the way was not found, so many up to here.
    pub count: usize,
    /// How much of the way lies behind it: 0 to 1.
    pub part: f64,
}

/// A joint, to be named in a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JointName {
    /// Index in q.
    pub index: usize,
    /// Its name in the table.
    pub name: Box<str>,
    /// Whether its numbers are radians or metres.
    pub kind: JointKind,
}

/// What is wrong with a motion.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// There are too few or too many joint values.
    Length(LengthError),
    /// A joint value is infinite or NaN.
    NotFinite(JointName),
    /// A joint would leave its limits.
    OutsideLimits {
        /// Which.
        joint: JointName,
        /// Where it would be (rad or m).
        value: f64,
        /// Its least value (rad or m).
        min: f64,
        /// Its greatest value (rad or m).
        max: f64,
    },
    /// A sum of joints or the tool point would break a rule.
    Forbidden(Rule),
    /// The inverse problem has no solution.
    NoSolution(IkError),
    /// There is no such inverse problem.
    UnknownProblem {
        /// What was asked for.
        problem: String,
        /// What there is.
        known: Vec<String>,
    },
    /// The targets of a path are of different kinds.
    Kinds {
        /// What the problem takes.
        expected: TargetKind,
        /// What was given.
        got: TargetKind,
    },
    /// Between the start of a path and its end the hand would make half a turn, either way round.
    HalfTurn,
    /// The arm doesn't stand on the path where it begins: the solution nearest to it is elsewhere.
    NotOnPath {
        /// The joint that is furthest off.
        joint: JointName,
        /// Where it is (rad or m).
        value: f64,
        /// Where the solution has it (rad or m).
        solution: f64,
    },
    /// The arm doesn't stand on a path of the problem: for where its hand is, the problem has no solution.
    NoStart(IkError),
    /// The solutions end here and go on elsewhere: another branch.
    Jump {
        /// The joint that would jump furthest.
        joint: JointName,
        /// From there (rad or m)
        from: f64,
        /// to there.
        to: f64,
    },
    /// The arm is singular or nearly so: small motions of the hand need great ones of the joints.
    Singular {
        /// The smallest singular value of what takes joint velocities to those of the target: m (or rad of turn, a radian
        /// counted as the arm's present lever) per rad of the joints.
        value: f64,
        /// What it must be at least.
        least: f64,
    },
    /// A joint would have to be faster than it may.
    TooFast {
        /// Which.
        joint: JointName,
        /// How fast it would have to be (per s).
        needed: f64,
        /// How fast it may be (per s).
        allowed: f64,
        /// The speed along the path that was asked for (m/s).
        speed: f64,
        /// The greatest that is possible (m/s).
        possible: f64,
    },
    /// A joint would have to be faster than it may from one setpoint to the next.
    Rushed {
        /// Which.
        joint: JointName,
        /// How fast it would have to be (per s).
        needed: f64,
        /// How fast it may be (per s).
        allowed: f64,
    },
    /// The move takes longer than it may.
    TooLong {
        /// How long it takes at least (s).
        needed: f64,
        /// How long it may take (s).
        allowed: f64,
    },
    /// A number that says how to move makes no sense.
    Setting {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// No profile could be made.
    Profile(ProfileError),
}

impl From<Violation<'_>> for Reason {
    fn from(violation: Violation<'_>) -> Self {
        match violation {
            Violation::Length(error) => Self::Length(error),
            Violation::NotFinite { joint, name, .. } => {
                Self::NotFinite(JointName { index: joint, name: name.into(), kind: JointKind::Revolute })
            }
            Violation::OutsideLimits { joint, name, kind, value, min, max } => {
                let joint = JointName { index: joint, name: name.into(), kind };
                Self::OutsideLimits { joint, value, min, max }
            }
            Violation::Forbidden(rule) => Self::Forbidden(rule),
            // Nothing else exists; what may come is a bad number at the least.
            _ => Self::Setting { what: "a rule", value: f64::NAN },
        }
    }
}

impl Reason {
    /// Of a move, at no place on its way.
    pub(super) fn of_step(self, step: usize) -> Refusal {
        Refusal { step, sample: None, reason: self, also: Box::default() }
    }

    /// At a place on the way of a move.
    pub(super) fn at(self, step: usize, sample: Sample) -> Refusal {
        Refusal { step, sample: Some(sample), reason: self, also: Box::default() }
    }
}

impl fmt::Display for JointName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint {} ({})", self.index + 1, self.name)
    }
}

impl fmt::Display for Sample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "sample {} of {} ({:.1} % of the way)", self.index + 1, self.count, self.part * 100.0)
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(error) => error.fmt(f),
            Self::NotFinite(joint) => write!(f, "the value of {joint} is not finite"),
            Self::OutsideLimits { joint, value, min, max } => {
                let unit = joint.kind.unit();
                write!(f, "{joint} would be at {value:.6} {unit}, not in {min:.6} to {max:.6} {unit}")
            }
            Self::Forbidden(rule) => rule.fmt(f),
            Self::NoSolution(error) => error.fmt(f),
            Self::UnknownProblem { problem, known } => {
                write!(f, "there is no inverse problem {problem}; there are: {}", known.join(", "))
            }
            Self::Kinds { expected, got } => {
                write!(f, "the path takes targets of kind {expected}, this is of kind {got}")
            }
            Self::HalfTurn => f.write_str("the hand would make half a turn: neither way round is shorter"),
            Self::NotOnPath { joint, value, solution } => {
                let unit = joint.kind.unit();
                write!(
                    f,
                    "the arm does not stand where the path begins: {joint} is at {value:.6} {unit}, the solution \
                     there has it at {solution:.6} {unit}"
                )
            }
            Self::NoStart(error) => {
                write!(f, "the arm does not stand on a path of this problem: for where its hand is, {error}")
            }
            Self::Jump { joint, from, to } => {
                let unit = joint.kind.unit();
                write!(f, "the solutions jump: {joint} from {from:.6} {unit} to {to:.6} {unit}")
            }
            Self::Singular { value, least } => {
                write!(f, "singular: the smallest singular value is {value:.3e}, not {least:.3e} or more")
            }
            Self::TooFast { joint, needed, allowed, speed, possible } => {
                let unit = joint.kind.unit();
                write!(
                    f,
                    "{joint} would have to move at {needed:.6} {unit}/s, more than {allowed:.6} {unit}/s, for {speed:.6} \
                     m/s along the path; {possible:.6} m/s is possible"
                )
            }
            Self::Rushed { joint, needed, allowed } => {
                let unit = joint.kind.unit();
                write!(
                    f,
                    "{joint} would have to move at {needed:.6} {unit}/s, more than {allowed:.6} {unit}/s"
                )
            }
            Self::TooLong { needed, allowed } => {
                write!(f, "the move takes {needed:.3} s, longer than {allowed:.3} s")
            }
            Self::Setting { what, value } => {
                write!(f, "{what} of {value} makes no sense: it is a number above 0, and a part at most 1")
            }
            Self::Profile(error) => error.fmt(f),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "refused, move {}", self.step + 1)?;
        self.sample.iter().try_for_each(|sample| write!(f, ", {sample}"))?;
        write!(f, ": {}", self.reason)?;
        self.also.iter().try_for_each(|reason| write!(f, "; {reason}"))
    }
}

impl std::error::Error for Refusal {}
