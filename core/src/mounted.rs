//! A robot with a tool or a base frame that is known only at run time.

mod draw;
mod held;
mod search;

use crate::frame::{add, cross, sub};
use crate::{
    Branch, Float, Frame, IkError, Joint, Kinematics, LengthError, ProblemInfo, Redundancy, Rule, Rules,
    Seed, SolutionSet, Target, TargetKind,
};

/// A robot that stands on `base` and carries `tool`: frames known only at run time, besides those of its table.
///
/// The tool is mounted at the table's tool frame, and the table's base frame stands at `base`. Workspace rules stay
/// with the table's base frame, and are checked for the point of the mounted tool.
///
/// An inverse problem is handed to the robot with both frames taken out of the target wherever that can be done exactly:
/// for poses and rotations; for all other targets without a tool (those that speak of the base's z axis: on a base that is
/// turned about z alone); for directions with a tool along z; and where the problem holds the hand's rotation, or all but
/// its yaw, so that it is known beforehand. All else is searched, in the joints that the problem's constraints leave open,
/// by damped Gauss-Newton steps on the target of the mounted tool itself. They start from the seed, from what the robot's own
/// problem answers for frames that meet the target with what it leaves open drawn evenly, and from joint values that are
/// spread evenly; the search ends after [`Mounted::QUIET`] such rounds in a row without a new solution. Each solution meets
/// its target; that none is missed is not proven. Where there is none, [`IkError::Failed`] says by how much the best start
/// misses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounted<K, S = f64> {
    arm: K,
    base: Frame<S>,
    tool: Frame<S>,
}

/// A base counts as turned about z alone if what should be 0 of its rotation is, to this many machine epsilons.
const ABOUT_Z: f64 = 8.0;

impl<K, S: Float> Mounted<K, S> {
    /// A search for solutions ends when so many rounds of starts one after the other have led to none that is new.
    pub const QUIET: u32 = search::QUIET;

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

    /// What to ask of the robot for this target, where that is the same whatever the joint values are.
    fn target_of_arm(&self, target: &Target<S>) -> Option<Target<S>> {
        let kind = target.kind();
        if matches!(kind, TargetKind::Pose | TargetKind::Rotation) || self.tool == Frame::IDENTITY {
            return self.on_base(target, &self.tool);
        }
        // Of a tool along z, its z axis is that of the hand.
        let [x, y, z] = self.tool.translation;
        let [zx, zy, zz] = self.tool.z_axis();
        let straight = zx == S::ZERO && zy == S::ZERO && zz > S::ZERO;
        let along = straight && x == S::ZERO && y == S::ZERO;
        let target = match *target {
            Target::Direction(_) if straight => *target,
            Target::Ray { .. } | Target::Lookat(_) if along => *target,
            Target::PositionDirection { position, direction } if along => Target::PositionDirection {
                position: sub(position, direction.map(|part| part * z)),
                direction,
            },
            _ => return None,
        };
        self.on_base(&target, &Frame::IDENTITY)
    }

    /// The same for a hand, which matters for poses and rotations alone.
    fn on_base(&self, target: &Target<S>, tool: &Frame<S>) -> Option<Target<S>> {
        let world = self.base.inverse();
        let [[_, _, r13], [r21, r22, r23], [r31, r32, r33]] = world.rotation;
        let rounding = S::from_f64(ABOUT_Z) * S::EPSILON;
        let about_z = r33 > S::ZERO && [r13, r23, r31, r32].iter().all(|r| r.abs() <= rounding);
        let planar = matches!(target.kind(), TargetKind::PositionYaw | TargetKind::Xy | TargetKind::XyYaw);
        if planar && !about_z {
            return None;
        }
        let turn = r21.atan2(r22);
        let plane = |[x, y]: [S; 2]| {
            let [x, y, _] = world.transform_point([x, y, S::ZERO]);
            [x, y]
        };
        let point = |position| world.transform_point(position);
        let vector = |direction| world.transform_vector(direction);
        Some(match *target {
            Target::Pose(pose) => Target::Pose(world * pose * tool.inverse()),
            Target::Rotation(rotation) => {
                let wanted = Frame { rotation, ..Frame::IDENTITY };
                Target::Rotation((world * wanted * tool.inverse()).rotation)
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
        out.clear();
        let info = self.problems().iter().find(|info| info.name == problem).ok_or(IkError::UnknownProblem)?;
        let target = target.validate_as(info.target)?;
        LengthError::check(info.free.len(), free.len())?;
        if let Some(seed) = seed {
            LengthError::check(self.dof(), seed.q.len())?;
        }
        let asked = self.target_of_arm(&target).or_else(|| {
            let target = self.on_base(&target, &Frame::IDENTITY)?;
            held::without_tool(&self.arm, info, free, &target, &self.tool)
        });
        if let Some(asked) = asked {
            self.arm.ik_seeded_into(problem, &asked, free, seed, out)?;
            self.measure(&target, out);
            return Ok(());
        }
        let (world, hand) = (self.base.inverse(), self.tool.inverse());
        let of_arm = |frame: &Frame<S>, found: &mut SolutionSet<S>| {
            let bare = Target::of_frame(info.target, &(world * *frame * hand));
            // What it says where it has none is about another target.
            self.arm.ik_seeded_into(problem, &bare, free, seed, found).is_ok()
        };
        search::Search::new(self, info, &target, free)?.run(&of_arm, self.base.translation, seed, out)
    }

    fn broken_condition(&self, problem: &str, q: &[S]) -> Option<Rule<S>> {
        self.arm.broken_condition(problem, q)
    }

    fn redundancy(&self, problem: &str) -> Option<Redundancy<'_, S>> {
        self.arm.redundancy(problem)
    }

    /// That of the robot with its own tool.
    fn branch_of(&self, problem: &str, q: &[S]) -> Result<Branch, IkError<S>> {
        self.arm.branch_of(problem, q)
    }

    fn rules_point(&self, q: &[S]) -> Result<[S; 3], LengthError> {
        self.arm.fk(q).map(|tool| tool.transform_point(self.tool.translation))
    }
}
