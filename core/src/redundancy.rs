//! Arms with one joint more than their target needs: all of its solutions hang on the value of one joint, which the
//! caller gives, or which is looked for here.

mod arm_angle;
mod curve;
mod forces;
mod intervals;
mod into_set;
mod nearest;
mod pseudo_inverse;

pub use nearest::Arm;

use crate::{Float, IkError, Joint, JointKind, Limits, Rules, Solution, Solutions};

/// How many values of the free joint a sweep tries.
pub const SWEEP_SAMPLES: usize = 16;

/// An inverse problem that leaves one joint to the caller.
///
/// Its solutions are asked for through a function `at` from a value of that joint (rad or m) to the solutions there.
/// As the value moves they move along curves, the self-motions of the arm, each of which is one branch of the problem as
/// long as no other joint turns back; where one does, two branches meet and end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Redundancy<'a, S = f64> {
    /// The free joint (index of q).
    pub joint: usize,
    /// Where joints and tool point may be.
    pub rules: Rules<'a, S>,
    /// Bound on the distance of the tool point (m).
    pub reach: S,
    /// Whether it prescribes the whole pose of the tool frame and nothing else, so that its solutions are the curves of
    /// the Jacobian's null space.
    pub whole_pose: bool,
    /// How many values of the free joint [`Redundancy::nearest`] tries over the whole range, where it has to.
    pub samples: u32,
    /// The free joint's row in the table (0-based) where the arm is spherical-roll-spherical and the problem the full pose, so
    /// that its solutions can be had by [`Redundancy::by_arm_angle`].
    pub spherical_roll_spherical: Option<usize>,
}

/// How many values of the free joint a search for the nearest solution tries.
const SAMPLES: u32 = 48;

/// The same where solutions at one of them are a search of their own, and take as long as thousands of closed forms.
const FEW_SAMPLES: u32 = 6;

/// Values of the joints that a problem leaves to the caller: a number where it is one joint, else an array.
pub trait FreeValues<const K: usize, S = f64> {
    /// rad or m, in the order of the problem's joints.
    fn values(self) -> [S; K];
}

impl FreeValues<1, f64> for f64 {
    fn values(self) -> [f64; 1] {
        [self]
    }
}

impl FreeValues<1, f32> for f32 {
    fn values(self) -> [f32; 1] {
        [self]
    }
}

impl<const K: usize, S> FreeValues<K, S> for [S; K] {
    fn values(self) -> [S; K] {
        self
    }
}

impl<const K: usize, S: Copy> FreeValues<K, S> for &[S; K] {
    fn values(self) -> [S; K] {
        *self
    }
}

/// Values of the free joint that are tried.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Range<S> {
    min: S,
    max: S,
    /// Whether both ends are the same: the joint turns all the way.
    closed: bool,
}

impl<S: Float> Range<S> {
    fn width(&self) -> S {
        self.max - self.min
    }
}

impl<'a, S: Copy> Redundancy<'a, S> {
    /// The full pose of an arm with this reach (m), with this joint (index of q) left to the caller.
    pub const fn of_pose(joint: usize, rules: Rules<'a, S>, reach: S) -> Self {
        Self { joint, rules, reach, whole_pose: true, samples: SAMPLES, spherical_roll_spherical: None }
    }

    /// Another problem that leaves this joint to the caller.
    pub const fn of_problem(joint: usize, rules: Rules<'a, S>, reach: S) -> Self {
        Self { joint, rules, reach, whole_pose: false, samples: SAMPLES, spherical_roll_spherical: None }
    }

    /// The same for a problem without a closed form: [`Redundancy::nearest`] tries few values of the free joint.
    pub const fn searched(mut self) -> Self {
        self.samples = FEW_SAMPLES;
        self
    }

    /// The same of a spherical-roll-spherical arm whose free joint has this row in the table (0-based): it has an arm angle.
    /// The first three axes must meet in one point, and the last three, exactly, and joints move with no other.
    pub const fn spherical_roll_spherical(mut self, row: usize) -> Self {
        self.spherical_roll_spherical = Some(row);
        self
    }
}

impl<S: Float> Redundancy<'_, S> {
    /// Whether there is no closed form.
    pub const fn is_searched(&self) -> bool {
        self.samples < SAMPLES
    }

    fn free_joint(&self) -> Option<&Joint<'_, S>> {
        self.rules.joints.get(self.joint)
    }

    /// Where the free joint may be: within its limits, but no more than one turn, that about `middle` where the limits
    /// leave a choice. A slide without limits stays within twice the reach.
    fn range(&self, middle: S) -> Range<S> {
        let limits = self.free_joint().and_then(|joint| joint.limits);
        let slides = self.free_joint().is_some_and(|joint| joint.kind == JointKind::Prismatic);
        let about = |middle: S, half: S| Limits { min: middle - half, max: middle + half };
        let most = if slides { about(S::ZERO, S::TWO * self.reach) } else { about(middle, S::PI) };
        match limits {
            Some(limits) if slides || limits.max - limits.min < S::TAU => {
                let inside = if slides { limits.intersection(&most).unwrap_or(limits) } else { limits };
                Range { min: inside.min, max: inside.max, closed: false }
            }
            Some(limits) => {
                let Limits { min, max } = about(limits.clamp(middle), S::PI);
                Range { min, max, closed: true }
            }
            None => Range { min: most.min, max: most.max, closed: !slides },
        }
    }

    /// The values of the free joint that a sweep tries: the middles of [`SWEEP_SAMPLES`] equal parts of its limits, or
    /// of the whole turn where these leave it.
    pub fn samples(&self) -> impl Iterator<Item = S> + use<S> {
        let range = self.range(S::ZERO);
        let step = range.width() / S::from_f64(SWEEP_SAMPLES as f64);
        (0..SWEEP_SAMPLES).map(move |index| range.min + (S::from_f64(index as f64) + S::from_f64(0.5)) * step)
    }

    /// Every geometric solution at each of the [`Redundancy::samples`], in their order. As many as there is room for
    /// are put into `out`; how many there are is returned.
    pub fn sweep<const N: usize>(
        &self,
        mut at: impl FnMut(S) -> Result<Solutions<N, S>, IkError<S>>,
        out: &mut [Solution<N, S>],
    ) -> usize {
        let mut found = 0;
        for value in self.samples() {
            let Ok(solutions) = at(value) else { continue };
            for solution in &solutions {
                if let Some(slot) = out.get_mut(found) {
                    *slot = *solution;
                }
                found += 1;
            }
        }
        found
    }
}
