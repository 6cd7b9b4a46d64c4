//! A robot with a tool or a base frame that is known only at run time.

mod tool_point;

use core::fmt;

use crate::frame::{add, cross};
use crate::{
    Float, Frame, IkError, Joint, Kinematics, LengthError, ProblemInfo, Redundancy, Rules, Seed, SolutionSet,
    Target, TargetKind,
};

/// A robot that stands on `base` and carries `tool`: frames known only at run time, besides those of its table.
///
/// The tool is mounted at the table's tool frame, and the table's base frame stands at `base`. Workspace rules stay
/// with the table's base frame, and are checked for the point of the mounted tool.
///
/// An inverse problem is handed to the robot with both frames taken out of the target. That is exact for poses and
/// rotations. Targets that say where the tool point is and not how the tool is turned are solved step by step: each
/// solution meets its target, but that all are found is not certain. A tool that turns the hand leaves nothing to be said
/// of targets with a yaw or a direction; a yaw survives only a base that is turned about z alone. Where it cannot be done,
/// [`IkError::Mounting`] says so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounted<K, S = f64> {
    arm: K,
    base: Frame<S>,
    tool: Frame<S>,
}

/// A base counts as turned about z alone if what should be 0 of its rotation is, to this many machine epsilons.
const ABOUT_Z: f64 = 8.0;

/// A frame of [`Mounted`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MountingFrame {
    /// The base frame.
    Base,
    /// The tool frame.
    Tool,
}

impl fmt::Display for MountingFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Base => "base",
            Self::Tool => "tool",
        })
    }
}

impl<K, S: Float> Mounted<K, S> {
    /// The robot as its table has it.
    pub const fn new(arm: K) -> Self {
        Self { arm, base: Frame::IDENTITY, tool: Frame::IDENTITY }
    }

    /// With this frame as its tool: the pose of the tool point in the table's tool frame.
    pub fn with_tool(self, tool: impl Into<Frame<S>>) -> Self {
        Self { tool: tool.into(), ..self }
    }

    /// With this frame under its base: the pose of the table's base frame in the world.
    pub fn with_base(self, base: impl Into<Frame<S>>) -> Self {
        Self { base: base.into(), ..self }
    }

    /// The robot itself.
    pub const fn arm(&self) -> &K {
        &self.arm
    }

    /// What to ask of the robot for this target.
    fn target_of_arm(&self, target: &Target<S>) -> Result<Target<S>, IkError<S>> {
        let target_kind = target.kind();
        let any_tool = matches!(target_kind, TargetKind::Pose | TargetKind::Rotation);
        if !any_tool && self.tool != Frame::IDENTITY {
            return Err(IkError::Mounting { frame: MountingFrame::Tool, target: target_kind });
        }
        self.target_on_base(target)
    }

    /// The same, where the tool does not matter or is the whole target's.
    fn target_on_base(&self, target: &Target<S>) -> Result<Target<S>, IkError<S>> {
        let kind = target.kind();
        let unclear = |frame| Err(IkError::Mounting { frame, target: kind });
        let world = self.base.inverse();
        let [[_, _, r13], [r21, r22, r23], [r31, r32, r33]] = world.rotation;
        let rounding = S::from_f64(ABOUT_Z) * S::EPSILON;
        let about_z = r33 > S::ZERO && [r13, r23, r31, r32].iter().all(|r| r.abs() <= rounding);
        let planar = matches!(kind, TargetKind::PositionYaw | TargetKind::Xy | TargetKind::XyYaw);
        if planar && !about_z {
            return unclear(MountingFrame::Base);
        }
        let turn = r21.atan2(r22);
        let plane = |[x, y]: [S; 2]| {
            let [x, y, _] = world.transform_point([x, y, S::ZERO]);
            [x, y]
        };
        let point = |position| world.transform_point(position);
        let vector = |direction| world.transform_vector(direction);
        Ok(match *target {
            Target::Pose(pose) => Target::Pose(world * pose * self.tool.inverse()),
            Target::Rotation(rotation) => {
                let wanted = Frame { rotation, ..Frame::IDENTITY };
                Target::Rotation((world * wanted * self.tool.inverse()).rotation)
            }
            Target::Position(position) => Target::Position(point(position)),
            Target::Lookat(position) => Target::Lookat(point(position)),
            Target::Direction(direction) => Target::Direction(vector(direction)),
            Target::PositionDirection { position, direction } => {
                Target::PositionDirection { position: point(position), direction: vector(direction) }
            }
            Target::Ray { position, direction } => {
                Target::Ray { position: point(position), direction: vector(direction) }
            }
            Target::PositionYaw { position, yaw } => {
                Target::PositionYaw { position: point(position), yaw: yaw + turn }
            }
            Target::Xy(position) => Target::Xy(plane(position)),
            Target::XyYaw { position, yaw } => Target::XyYaw { position: plane(position), yaw: yaw + turn },
        })
    }
}

impl<K: Kinematics<S>, S: Float> Mounted<K, S> {
    /// Solves a target, `solve` being the robot's own problem.
    fn solve(
        &self,
        target: &Target<S>,
        solve: &tool_point::Solver<'_, S>,
        out: &mut SolutionSet<S>,
    ) -> Result<(), IkError<S>> {
        out.clear();
        let target = target.validate()?;
        match self.target_of_arm(&target) {
            Ok(asked) => solve(&asked, out)?,
            Err(IkError::Mounting { frame: MountingFrame::Tool, .. })
                if tool_point::is_of_place(&target, &self.tool) =>
            {
                let bare =
                    |target: &Target<S>, out: &mut SolutionSet<S>| solve(&self.target_on_base(target)?, out);
                tool_point::solve(self, (&self.base, &self.tool), &target, &bare, out)?;
            }
            Err(error) => return Err(error),
        }
        self.measure(&target, out);
        Ok(())
    }

    /// Errors of solutions against the target of the mounted tool.
    fn measure(&self, target: &Target<S>, out: &mut SolutionSet<S>) {
        let error = (S::INFINITY, S::INFINITY);
        out.measure(|q| self.fk(q).map_or(error, |tool| target.errors(&tool)));
    }
}

impl<K: Kinematics<S>, S: Float> Kinematics<S> for Mounted<K, S> {
    fn name(&self) -> &str {
        self.arm.name()
    }

    fn fingerprint(&self) -> u64 {
        self.arm.fingerprint()
    }

    fn rows(&self) -> usize {
        self.arm.rows()
    }

    fn rules(&self) -> Rules<'_, S> {
        self.arm.rules()
    }

    fn joints(&self) -> &[Joint<'_, S>] {
        self.arm.joints()
    }

    fn problems(&self) -> &[ProblemInfo<'_>] {
        self.arm.problems()
    }

    fn fk(&self, q: &[S]) -> Result<Frame<S>, LengthError> {
        Ok(self.base * self.arm.fk(q)? * self.tool)
    }

    fn fk_flange(&self, q: &[S]) -> Result<Frame<S>, LengthError> {
        Ok(self.base * self.arm.fk_flange(q)?)
    }

    fn frames_into(&self, q: &[S], out: &mut [Frame<S>]) -> Result<usize, LengthError> {
        let count = self.arm.frames_into(q, out)?;
        for frame in out.iter_mut().take(count) {
            *frame = self.base * *frame;
        }
        Ok(count)
    }

    fn jacobian_into(&self, q: &[S], out: &mut [[S; 6]]) -> Result<(), LengthError> {
        self.arm.jacobian_into(q, out)?;
        let lever = self.arm.fk(q)?.transform_vector(self.tool.translation);
        for column in out.iter_mut().take(self.arm.dof()) {
            let [vx, vy, vz, wx, wy, wz] = *column;
            let angular = [wx, wy, wz];
            // The mounted tool point moves with the rotation besides.
            let linear = add([vx, vy, vz], cross(angular, lever));
            let ([vx, vy, vz], [wx, wy, wz]) =
                (self.base.transform_vector(linear), self.base.transform_vector(angular));
            *column = [vx, vy, vz, wx, wy, wz];
        }
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
        let solve = |target: &Target<S>, out: &mut SolutionSet<S>| {
            self.arm.ik_seeded_into(problem, target, free, seed, out)
        };
        self.solve(target, &solve, out)
    }

    fn redundancy(&self, problem: &str) -> Option<Redundancy<'_, S>> {
        self.arm.redundancy(problem)
    }

    fn rules_point(&self, q: &[S]) -> Result<[S; 3], LengthError> {
        self.arm.fk(q).map(|tool| tool.transform_point(self.tool.translation))
    }
}
