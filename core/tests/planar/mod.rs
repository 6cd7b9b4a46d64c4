//! A planar arm of three joints, written by hand the way that generated code is.

use core::f64::consts::TAU;

use dh_core::{
    FULL_POSE, Frame, IkError, Joint, JointKind, Kinematics, LengthError, Limits, Measure, ProblemInfo,
    Rules, Search, Seed, SolutionSet, Step, Target, TargetKind, Wanted, Winding,
};

const A1: f64 = 0.5;
const A2: f64 = 0.4;
const A3: f64 = 0.1;
const REACH: f64 = A1 + A2 + A3;

const fn joint(name: &'static str, max: f64) -> Joint<'static> {
    Joint {
        name,
        kind: JointKind::Revolute,
        limits: Some(Limits { min: -max, max }),
        max_velocity: None,
        max_acceleration: None,
        max_jerk: None,
        servo: None,
    }
}

const fn winding(joint: usize) -> Winding<'static> {
    Winding { joint, turn: TAU, carries: &[] }
}

const JOINTS: [Joint<'static>; 3] = [joint("shoulder", 6.0), joint("elbow", 2.5), joint("wrist", 4.0)];
const WINDINGS: [Winding<'static>; 3] = [winding(0), winding(1), winding(2)];

/// Its rules may be set; its kinematics are fixed.
pub(crate) struct Planar {
    pub(crate) rules: Rules<'static>,
}

impl Planar {
    pub(crate) fn new() -> Self {
        Self { rules: Rules::of_joints(&JOINTS, &WINDINGS) }
    }

    fn chain(q: &[f64]) -> Result<[Frame; 4], LengthError> {
        let &[q1, q2, q3] = q else {
            return Err(LengthError { expected: 3, got: q.len() });
        };
        let link = |angle, length| {
            Frame::from_rpy([0.0; 3], [0.0, 0.0, angle]) * Frame::from_translation([length, 0.0, 0.0])
        };
        let first = link(q1, A1);
        let second = first * link(q2, A2);
        Ok([Frame::IDENTITY, first, second, second * link(q3, A3)])
    }
}

impl Kinematics for Planar {
    fn name(&self) -> &'static str {
        "planar"
    }
    fn fingerprint(&self) -> u64 {
        3
    }
    fn rows(&self) -> usize {
        3
    }
    fn rules(&self) -> Rules<'_> {
        self.rules
    }
    fn problems(&self) -> &[ProblemInfo<'_>] {
        &[
            ProblemInfo {
                name: FULL_POSE,
                target: TargetKind::Pose,
                free: &[],
                constraints: &[],
                branch: &[],
            },
            ProblemInfo {
                name: "plane",
                target: TargetKind::XyYaw,
                free: &[],
                constraints: &[],
                branch: &[],
            },
        ]
    }
    fn fk(&self, q: &[f64]) -> Result<Frame, LengthError> {
        Self::chain(q).map(|[_, _, _, tool]| tool)
    }
    fn fk_flange(&self, q: &[f64]) -> Result<Frame, LengthError> {
        self.fk(q)
    }
    fn frames_into(&self, q: &[f64], out: &mut [Frame]) -> Result<usize, LengthError> {
        let chain = Self::chain(q)?;
        let got = out.len();
        let short = LengthError { expected: chain.len(), got };
        out.get_mut(..chain.len()).ok_or(short)?.copy_from_slice(&chain);
        Ok(chain.len())
    }
    fn jacobian_into(&self, q: &[f64], out: &mut [[f64; 6]]) -> Result<(), LengthError> {
        let chain = Self::chain(q)?;
        let [x, y, _] = chain[3].translation;
        for (column, frame) in out.iter_mut().zip(&chain) {
            let [ox, oy, _] = frame.translation;
            *column = [oy - y, x - ox, 0.0, 0.0, 0.0, 1.0];
        }
        Ok(())
    }
    fn ik_seeded_into(
        &self,
        problem: &str,
        target: &Target,
        free: &[f64],
        seed: Option<Seed<'_>>,
        out: &mut SolutionSet,
    ) -> Result<(), IkError> {
        const STEP_1: Step = Step::new(0, 0b010, false, Measure::Area);
        const STEP_2: Step = Step::new(1, 0b001, false, Measure::Length);
        const STEP_3: Step = Step::new(2, 0b100, false, Measure::Ratio);
        out.clear();
        LengthError::check(0, free.len())?;
        let info = self.problems().iter().find(|info| info.name == problem).ok_or(IkError::UnknownProblem)?;
        let target = target.validate()?;
        let (px, py, cyaw, syaw) = match target {
            Target::Pose(pose) => {
                (pose.translation[0], pose.translation[1], pose.rotation[0][0], pose.rotation[1][0])
            }
            Target::XyYaw { position: [px, py], yaw } => (px, py, yaw.cos(), yaw.sin()),
            _ => {
                return Err(IkError::WrongTarget { expected: info.target });
            }
        };
        let (wx, wy) = (px - A3 * cyaw, py - A3 * syaw);
        let wanted = Wanted::of(seed, |&[q1, q2, q3]: &[f64; 3]| [q2, q1, q3])?;
        let mut search = Search::<3>::about(REACH, &WINDINGS, &wanted);
        for theta2 in search.trig(STEP_1, 2.0 * A1 * A2, 0.0, wx * wx + wy * wy - A1 * A1 - A2 * A2) {
            let (s2, c2) = theta2.sin_cos();
            let (x2, y2) = (A1 + A2 * c2, A2 * s2);
            for theta1 in search.trig_pair(STEP_2, [x2, -y2, wx], [y2, x2, wy]) {
                let (s12, c12) = (theta1 + theta2).sin_cos();
                for theta3 in search.trig_pair(STEP_3, [c12, -s12, cyaw], [s12, c12, syaw]) {
                    let q = [theta1, theta2, theta3];
                    let (position_error, rotation_error) = target.errors(&self.fk(&q)?);
                    search.accept(q, position_error, rotation_error);
                }
            }
        }
        out.fill(3, &search.finish()?);
        Ok(())
    }
}
