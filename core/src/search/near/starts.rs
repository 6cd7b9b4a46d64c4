//! Where the closed form has nothing at poses around the target either: damped steps of the arm as it is from places all over.
//!
//! An arm that was meant to have a curve of solutions for the target has them for next to no pose beside it. They end in the
//! valley that is left of the curve, and what is nearly a solution there leads to those that are along it.

use super::curve::Arm;
use super::seek::{PATIENCE, joint_values};
use super::{Exact, Near};
use crate::evenly::evenly;
use crate::{Float, Frame};
use core::f64::consts::TAU;

/// So many places at most.
const PLACES: u32 = 48;

/// The most steps from one.
const STEPS: usize = 60;

/// What is missing (reaches, rad) in a valley, in multiples of what the arm is off by.
const VALLEY: f64 = 8.0;

impl<const N: usize, S: Float> Near<'_, N, S> {
    /// Looks for solutions from places all over, if there are none yet.
    #[cold]
    #[inline(never)]
    pub(super) fn seek_all_over(
        &mut self,
        pose_and_jacobian: impl FnMut(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    ) {
        let target = self.target;
        let asked = self.asked(&target);
        let (Some(seek), Some(Exact { arm: chain, joints })) = (&mut self.seek, &self.chain) else { return };
        if !seek.has_nothing() {
            return;
        }
        let deviation = S::from_f64(self.deviation);
        let mut arm = Arm { asked, labels: &self.labels, deviation, pose_and_jacobian };
        seek.idle = 0;
        for number in 1..=PLACES {
            let mut values = evenly::<f64, 6>(number, 6);
            for (value, slides) in values.iter_mut().zip(chain.prismatic) {
                *value *= if *slides { 2.0 * chain.reach } else { TAU };
            }
            let Some(from) =
                arm.descend(joint_values(joints, &values), STEPS, S::from_f64(VALLEY) * deviation)
            else {
                continue;
            };
            let before = seek.found.len();
            if let Some(found) = arm.bring(from) {
                arm.add(found, &mut seek.found);
            }
            arm.follow(from, S::INFINITY, &mut seek.found);
            seek.idle += 1;
            seek.sift(before, |q| arm.stiffness(q));
            if seek.idle > PATIENCE {
                return;
            }
        }
    }
}
