//! Spherical-roll-spherical arms: whether the joints of a pose are found by their arm angle.

use super::inverse::{Inverse, travel};
use super::{COMPLETE, COMPLETE_NEAR_SINGULAR, SINGULAR, reference};
use crate::model::product;
use crate::plan::eval::Given;
use dh_core::{Arm, IkError, MAX_JOINTS, Redundancy, Rules, Target};

/// At so many poses it is tried: the same solutions are verified with the free joint given.
const POSES: usize = 16;

impl Inverse<'_> {
    /// Asks for the pose at these joint values by their arm angle, if the problem has one. Says whether it was asked.
    pub(super) fn arm_angle(
        &self,
        q: &[f64],
        target: &Target<f64>,
        asked: usize,
        smallest: impl Fn() -> f64,
    ) -> Result<bool, String> {
        let ([joint], Some(row)) = (self.free, self.row_for_arm_angle) else { return Ok(false) };
        if asked >= POSES || smallest() < SINGULAR {
            return Ok(false);
        }
        let rules = Rules::of_joints(&[], self.windings);
        let redundancy = Redundancy::of_pose(*joint, rules, self.reach).spherical_roll_spherical(row);
        let state = |values: &[f64; MAX_JOINTS]| {
            let values = values.get(..q.len()).unwrap_or_default();
            let mut columns = [[0.0; 6]; MAX_JOINTS];
            let jacobian = product::jacobian(self.model, &product::frames(self.model, values));
            columns.iter_mut().zip(jacobian).for_each(|(column, (own, _))| *column = own);
            (reference::tool(self.model, values), columns)
        };
        let at = |free: f64| {
            let given = Given { free: &[free], seed: None };
            let answer = self.program.inverse(self.problem, target, given, self.windings, |_| ());
            answer.unwrap_or(Err(IkError::UnknownProblem))
        };
        let mut padded = [0.0; MAX_JOINTS];
        padded.iter_mut().zip(q).for_each(|(to, from)| *to = *from);
        let Some(arm_angle) = redundancy.arm_angle(state, &padded) else { return Ok(false) };
        let found = redundancy.by_arm_angle(Arm::new(at, state), target, arm_angle);
        let found = found.map_err(|error| format!("no solution with its arm angle found ({error})"))?;
        let own = |q: &[f64; MAX_JOINTS]| q.get(..self.model.joints.len()).unwrap_or_default().to_vec();
        let apart = found.iter().map(|solution| travel(self.model, q, &own(&solution.q)));
        let nearest = apart.fold(f64::INFINITY, f64::min);
        if nearest > COMPLETE.max(COMPLETE_NEAR_SINGULAR / (smallest() * smallest())) {
            return Err(format!(
                "of those with its arm angle, {arm_angle:.6} rad, the nearest is {nearest:.3e} rad away"
            ));
        }
        Ok(true)
    }
}
