//! Solutions of an inverse problem by Newton's method from many places: slow, and no proof that none is missing, but it
//! shares nothing with equations and plans, and there is no problem that it cannot be asked.

use super::constraints::Constraints;
use super::inverse::travel;
use super::prescribed::prescribed;
use super::random::Random;
use super::reference;
use super::where_clause::Wheres;
use crate::model::{JointKind, Model};
use dh_core::Target;
use std::f64::consts::PI;

/// The places are the same on every host.
const SEED: u64 = 0x6e65_7774_6f6e;

/// Steps from one place; where it converges, ten are enough.
const STEPS: usize = 30;

/// Step of the finite differences (rad, reaches).
const DIFFERENCE: f64 = 1e-6;

/// Longest step (rad, reaches).
const LONGEST: f64 = 0.5;

/// What is left of a target that is met (rad, reaches).
const FOUND: f64 = 1e-9;

/// The search is over when so many places in a row have led to no new solution, for each that is known.
const PATIENCE: usize = 12;

/// Places that are begun at, at least and at most.
const PLACES: (usize, usize) = (40, 1200);

/// A problem, as Newton's method sees it.
pub(super) struct Newton<'v> {
    pub(super) model: &'v Model,
    pub(super) constraints: &'v Constraints,
    pub(super) wheres: &'v Wheres<'v>,
    /// Joints that the caller gives.
    pub(super) free: &'v [usize],
    /// m
    pub(super) reach: f64,
    /// Solutions that are nearer than this (rad or m) are one.
    pub(super) same: f64,
}

impl Newton<'_> {
    /// Joint values of every solution that was found; `given` has the values of the free joints in their places.
    pub(super) fn solutions(&self, target: &Target<f64>, given: &[f64]) -> Vec<Vec<f64>> {
        let mut random = Random::new(SEED);
        let mut found: Vec<Vec<f64>> = Vec::new();
        let (mut places, mut idle) = (0, 0);
        while places < PLACES.0 || (places < PLACES.1 && idle < PATIENCE * (found.len() + 1)) {
            places += 1;
            idle += 1;
            let Some(q) = self.descend(target, self.start(&mut random, given)) else { continue };
            if found.iter().all(|other| travel(self.model, &q, other) > self.same) {
                found.push(q);
                idle = 0;
            }
        }
        found.retain(|q| !self.wheres.clearly_refuse(q));
        found
    }

    fn unknowns(&self) -> impl Iterator<Item = usize> {
        self.constraints.independent.iter().copied().filter(|joint| !self.free.contains(joint))
    }

    fn start(&self, random: &mut Random, given: &[f64]) -> Vec<f64> {
        let mut q = given.to_vec();
        for joint in self.unknowns() {
            let most = if self.turns(joint) { PI } else { self.reach };
            if let Some(slot) = q.get_mut(joint) {
                *slot = random.between(-most, most);
            }
        }
        self.constraints.complete(&mut q);
        q
    }

    fn turns(&self, joint: usize) -> bool {
        let row = self.model.joints.get(joint).and_then(|row| self.model.rows.get(*row));
        row.is_none_or(|row| row.kind == JointKind::Revolute)
    }

    /// Gauss-Newton steps, damped where the equations contradict each other.
    fn descend(&self, target: &Target<f64>, mut q: Vec<f64>) -> Option<Vec<f64>> {
        let scale = |joint: usize| if self.turns(joint) { 1.0 } else { self.reach };
        for _ in 0..STEPS {
            let off = self.off(target, &q)?;
            let left = off.iter().map(|x| x * x).sum::<f64>().sqrt();
            if left < FOUND {
                let (position, rotation) = target.errors(&reference::tool(self.model, &q));
                return (position <= FOUND * self.reach.max(1.0) * 10.0 && rotation <= FOUND * 10.0)
                    .then_some(q);
            }
            let columns: Vec<(Vec<f64>, Vec<f64>)> = self
                .unknowns()
                .map(|joint| {
                    let direction: Vec<f64> =
                        self.constraints.direction(joint, q.len()).iter().map(|x| x * scale(joint)).collect();
                    let at = |step: f64| {
                        let moved: Vec<f64> =
                            q.iter().zip(&direction).map(|(q, way)| q + step * way).collect();
                        self.off(target, &moved).unwrap_or_default()
                    };
                    let pairs = at(DIFFERENCE).into_iter().zip(at(-DIFFERENCE));
                    (pairs.map(|(after, before)| (after - before) / (2.0 * DIFFERENCE)).collect(), direction)
                })
                .collect();
            let steps = least_squares(&columns, &off, 1e-12 + 1e-3 * left * left)?;
            let longest = steps.iter().fold(0.0, |most, step| f64::max(most, step.abs()));
            let part = if longest > LONGEST { LONGEST / longest } else { 1.0 };
            for (step, (_, direction)) in steps.iter().zip(&columns) {
                q.iter_mut().zip(direction).for_each(|(q, way)| *q -= part * step * way);
            }
        }
        None
    }

    /// How far the prescribed numbers are from the target's, lengths in reaches.
    fn off(&self, target: &Target<f64>, q: &[f64]) -> Option<Vec<f64>> {
        let tool = reference::tool(self.model, q);
        let wanted = wanted(target);
        let lengths = lengths(target);
        let off = prescribed(target, &tool).into_iter().zip(wanted).enumerate();
        let off: Vec<f64> =
            off.map(|(k, (is, wanted))| (is - wanted) / if k < lengths { self.reach } else { 1.0 }).collect();
        off.iter().all(|x| x.is_finite()).then_some(off)
    }
}

/// What [`prescribed`] is where the target is met.
fn wanted(target: &Target<f64>) -> Vec<f64> {
    use std::f64::consts::FRAC_1_SQRT_2;
    let rotation =
        |rotation: [[f64; 3]; 3]| rotation.into_iter().flatten().map(|entry| entry * FRAC_1_SQRT_2);
    let yaw = |yaw: f64| [yaw.cos(), yaw.sin()];
    match *target {
        Target::Pose(pose) => pose.translation.into_iter().chain(rotation(pose.rotation)).collect(),
        Target::Position(position) => position.to_vec(),
        Target::PositionDirection { position, direction } => [position, direction].concat(),
        Target::PositionYaw { position, yaw: angle } => position.into_iter().chain(yaw(angle)).collect(),
        Target::Rotation(wanted) => rotation(wanted).collect(),
        Target::Direction(direction) => direction.to_vec(),
        Target::Ray { direction, .. } => [[0.0; 3], direction].concat(),
        Target::Lookat(_) => vec![0.0; 3],
        Target::Xy(position) => position.to_vec(),
        Target::XyYaw { position, yaw: angle } => position.into_iter().chain(yaw(angle)).collect(),
    }
}

/// How many of the prescribed numbers are lengths: they come first.
fn lengths(target: &Target<f64>) -> usize {
    match target {
        Target::Rotation(_) | Target::Direction(_) => 0,
        Target::Xy(_) | Target::XyYaw { .. } => 2,
        _ => 3,
    }
}

/// The steps x with sum of columns times x nearest to `off`, drawn towards 0 by `damping`: normal equations, by Gaussian
/// elimination.
fn least_squares(columns: &[(Vec<f64>, Vec<f64>)], off: &[f64], damping: f64) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for (k, (column, _)) in columns.iter().enumerate() {
        let mut row: Vec<f64> = columns.iter().map(|(other, _)| dot(column, other)).collect();
        *row.get_mut(k)? += damping;
        row.push(dot(column, off));
        rows.push(row);
    }
    // The matrix is positive definite: no pivoting.
    let count = rows.len();
    for k in 0..count {
        let (head, tail) = rows.split_at_mut(k + 1);
        let top = head.last()?;
        let pivot = *top.get(k)?;
        for row in tail {
            let factor = row.get(k)? / pivot;
            row.iter_mut().zip(top).for_each(|(value, from)| *value -= factor * from);
        }
    }
    let mut steps = vec![0.0; count];
    for (k, row) in rows.iter().enumerate().rev() {
        let known: f64 = row.iter().zip(&steps).skip(k + 1).map(|(a, x)| a * x).sum();
        *steps.get_mut(k)? = (row.last()? - known) / row.get(k)?;
    }
    steps.iter().all(|step| step.is_finite()).then_some(steps)
}
