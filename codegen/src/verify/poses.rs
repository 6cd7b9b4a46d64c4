//! Joint vectors at which functions are verified.

use super::Level;
use super::constraints::Constraints;
use super::random::Random;
use crate::model::{JointKind, Limits, Model, Row};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Every function sees the same sequence on every host.
const SEED: u64 = 0x6b69_6e65_6d61_7469;

/// How far off a singular joint angle the poses at the boundary are (rad, or parts of a stroke).
const NEAR: [f64; 4] = [1e-9, 1e-7, 1e-5, 1e-3];

/// Branches of inverse problems go by the signs of a few joint angles: elbow up or down, wrist flipped or not. The sign
/// of joint i's angle in random pose n is the parity of n & SIDES\[i\]. No three of these masks add up to 0 bit by bit,
/// so that among 16 poses in a row any three angles have every combination of signs, twice.
const SIDES: [u32; 8] = [0b0001, 0b0010, 0b0100, 0b1000, 0b0111, 0b1011, 0b1101, 0b1110];

/// How many random poses are made for one that satisfies the problem's `where`.
const TRIES: u32 = 32;

/// Joint limits are tried no farther out than this (rad).
const FEW_TURNS: f64 = 4.0 * TAU;

/// rad
const TURN: Limits = Limits { min: -PI, max: PI };

/// How many poses of each sort.
struct Numbers {
    random: u32,
    lattice: u32,
    limits: u32,
    boundary: u32,
}

impl Numbers {
    fn of(level: Level) -> Self {
        match level {
            Level::Quick => Numbers { random: 16, lattice: 1, limits: 1, boundary: 0 },
            Level::Full => Numbers { random: 200, lattice: 60, limits: 20, boundary: 10 },
            Level::Poses(random) => Numbers {
                random,
                lattice: u32::max(60, random / 20),
                limits: u32::max(20, random / 50),
                boundary: u32::max(10, random / 100),
            },
        }
    }
}

/// Joint vectors (rad or m) that satisfy the constraints: random ones; joint angles at multiples of a quarter turn,
/// where most arms are singular; joints at their limits; and one angle at, or near, such a multiple, the others
/// random. The independent joints are set so, the others follow. Random ones are `wanted`, if such are found.
pub(super) fn poses(
    model: &Model,
    constraints: &Constraints,
    level: Level,
    reach: f64,
    wanted: impl Fn(&[f64]) -> bool,
) -> Vec<Vec<f64>> {
    let numbers = Numbers::of(level);
    let mut sampler = Sampler { model, constraints, reach, random: Random::new(SEED) };
    let mut poses = vec![];
    for number in 0..numbers.random {
        let tries = (0..TRIES).map(|further| sampler.random(number + further));
        poses.extend(first_wanted(tries, &wanted));
    }
    for _ in 0..numbers.lattice {
        poses.push(sampler.each(Sampler::lattice));
    }
    for _ in 0..numbers.limits {
        poses.push(sampler.each(Sampler::limit));
    }
    for index in 0..numbers.boundary {
        for joint in &constraints.independent {
            let mut q = sampler.random(index);
            // The first ones are at the multiple itself.
            let off = index
                .checked_sub(2)
                .and_then(|index| NEAR.get(index as usize % NEAR.len()))
                .copied()
                .unwrap_or(0.0);
            let value = sampler.lattice(*joint) + off * sampler.stroke(*joint);
            if let Some(slot) = q.get_mut(*joint) {
                *slot = value;
            }
            constraints.complete(&mut q);
            poses.push(q);
        }
    }
    poses
}

/// The first of some joint vectors that is wanted, else the last.
fn first_wanted(tries: impl Iterator<Item = Vec<f64>>, wanted: impl Fn(&[f64]) -> bool) -> Option<Vec<f64>> {
    let mut latest = None;
    for q in tries {
        if wanted(&q) {
            return Some(q);
        }
        latest = Some(q);
    }
    latest
}

struct Sampler<'m> {
    model: &'m Model,
    constraints: &'m Constraints,
    /// m
    reach: f64,
    random: Random,
}

impl Sampler<'_> {
    /// Revolute joints make a whole turn whatever their limits, which geometric solutions don't know. `number` says on
    /// which side of 0 each theta is, see [`SIDES`].
    fn random(&mut self, number: u32) -> Vec<f64> {
        self.each(|sampler, joint| {
            let range = sampler.range(joint);
            if !sampler.revolute(joint) {
                return sampler.random.between(range.min, range.max);
            }
            let theta = sampler.random.between(0.0, PI);
            let mask = SIDES.get(joint % SIDES.len()).copied().unwrap_or_default();
            let negative = (number & mask).count_ones() % 2 == 1;
            sampler.of_theta(joint, if negative { -theta } else { theta })
        })
    }

    /// Every independent joint by a rule, the others by the constraints.
    fn each(&mut self, mut rule: impl FnMut(&mut Self, usize) -> f64) -> Vec<f64> {
        let mut q = vec![0.0; self.model.joints.len()];
        for joint in &self.constraints.independent {
            let value = rule(self, *joint);
            if let Some(slot) = q.get_mut(*joint) {
                *slot = value;
            }
        }
        self.constraints.complete(&mut q);
        q
    }

    /// theta at a multiple of a quarter turn; d at an end or in the middle.
    fn lattice(&mut self, joint: usize) -> f64 {
        let choice = self.random.below(4) as f64;
        if self.revolute(joint) {
            return self.of_theta(joint, choice * FRAC_PI_2 - FRAC_PI_2);
        }
        let range = self.range(joint);
        range.min + (range.max - range.min) * (choice / 2.0).floor() / 2.0
    }

    /// The value of a revolute joint that brings its row to this theta (rad), couplings aside.
    fn of_theta(&self, joint: usize, theta: f64) -> f64 {
        let Some(row) = self.row(joint) else { return theta };
        let own = row.terms.iter().find(|(index, _)| *index == joint).map_or(1.0, |(_, factor)| *factor);
        (theta - row.theta.value) / own
    }

    fn limit(&mut self, joint: usize) -> f64 {
        let range = self.range(joint);
        if self.random.below(2) == 0 { range.min } else { range.max }
    }

    /// Limits of q, or what stands for them.
    fn range(&self, joint: usize) -> Limits {
        let row = self.row(joint);
        match (row.map(|row| row.kind), row.and_then(|row| row.limits)) {
            // Beyond a few turns a joint angle has fewer digits than the tolerances ask for.
            (Some(JointKind::Revolute), Some(limits)) => Limits {
                min: limits.min.clamp(-FEW_TURNS, FEW_TURNS),
                max: limits.max.clamp(-FEW_TURNS, FEW_TURNS),
            },
            (_, Some(limits)) => limits,
            (Some(JointKind::Revolute), None) => TURN,
            _ => Limits { min: -self.reach, max: self.reach },
        }
    }

    /// What counts as 1 for a joint: a radian, or its stroke (m).
    fn stroke(&self, joint: usize) -> f64 {
        let range = self.range(joint);
        if self.revolute(joint) { 1.0 } else { range.max - range.min }
    }

    fn revolute(&self, joint: usize) -> bool {
        self.row(joint).is_some_and(|row| row.kind == JointKind::Revolute)
    }

    fn row(&self, joint: usize) -> Option<&Row> {
        self.model.joints.get(joint).and_then(|row| self.model.rows.get(*row))
    }
}
