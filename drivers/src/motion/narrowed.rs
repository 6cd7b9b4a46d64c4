//! An arm with the limits that motion may use.

use crate::driver::DeviceJoint;
use dh_runtime::{
    Frame, IkError, Joint, Kinematics, LengthError, ProblemInfo, Redundancy, Rule, Rules, Seed, SolutionSet,
    Target,
};

/// The same arm with other limits of its joints: those of the table and what its device leaves of them. Inverse
/// problems and checks then keep to both.
#[derive(Clone)]
pub(super) struct Narrowed<'k> {
    arm: &'k dyn Kinematics,
    joints: Vec<Joint<'k>>,
}

impl<'k> Narrowed<'k> {
    /// With the limits of these joints, one a joint of the arm.
    pub(super) fn new(arm: &'k dyn Kinematics, device: &[DeviceJoint]) -> Self {
        let joints = arm.joints().iter().zip(device);
        let narrowed =
            |(joint, device): (&Joint<'k>, &DeviceJoint)| Joint { limits: device.limits(), ..*joint };
        Self { arm, joints: joints.map(narrowed).collect() }
    }
}

impl std::fmt::Debug for Narrowed<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Narrowed").field("arm", &self.arm.name()).field("joints", &self.joints).finish()
    }
}

impl Kinematics for Narrowed<'_> {
    fn name(&self) -> &str {
        self.arm.name()
    }
    fn fingerprint(&self) -> u64 {
        self.arm.fingerprint()
    }
    fn rows(&self) -> usize {
        self.arm.rows()
    }
    fn rules(&self) -> Rules<'_> {
        Rules { joints: &self.joints, ..self.arm.rules() }
    }
    fn problems(&self) -> &[ProblemInfo<'_>] {
        self.arm.problems()
    }
    fn fk(&self, q: &[f64]) -> Result<Frame, LengthError> {
        self.arm.fk(q)
    }
    fn fk_flange(&self, q: &[f64]) -> Result<Frame, LengthError> {
        self.arm.fk_flange(q)
    }
    fn frames_into(&self, q: &[f64], out: &mut [Frame]) -> Result<usize, LengthError> {
        self.arm.frames_into(q, out)
    }
    fn jacobian_into(&self, q: &[f64], out: &mut [[f64; 6]]) -> Result<(), LengthError> {
        self.arm.jacobian_into(q, out)
    }
    fn ik_seeded_into(
        &self,
        problem: &str,
        target: &Target,
        free: &[f64],
        seed: Option<Seed<'_>>,
        out: &mut SolutionSet,
    ) -> Result<(), IkError> {
        self.arm.ik_seeded_into(problem, target, free, seed, out)
    }
    fn broken_condition(&self, problem: &str, q: &[f64]) -> Option<Rule> {
        self.arm.broken_condition(problem, q)
    }
    fn redundancy(&self, problem: &str) -> Option<Redundancy<'_>> {
        self.arm.redundancy(problem).map(|redundancy| Redundancy { rules: self.rules(), ..redundancy })
    }
    fn rules_point(&self, q: &[f64]) -> Result<[f64; 3], LengthError> {
        self.arm.rules_point(q)
    }
}
