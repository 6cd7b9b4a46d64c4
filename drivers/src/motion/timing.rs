//! When the arm is where on a path: the way made, over time, so that every joint keeps its limits.

use super::dynamics::Dynamics;
use super::follow::joint_name;
use super::narrowed::Narrowed;
use super::profile::Profile;
use super::refusal::{Reason, Refusal, Sample};
use super::spline::Spline;

/// Speed along a path where none is asked for (m/s), if the joints can follow.
pub const PATH_SPEED: f64 = 0.1;

/// A path on which the joints allow less than this (m/s) is refused: it runs through a singularity.
pub const LEAST_PATH_SPEED: f64 = 1e-3;

/// Greatest acceleration (m/s²) and jerk (m/s³) along a path; the joints mostly allow less.
const PATH_ACCELERATION: f64 = 10.0;
const PATH_JERK: f64 = 1000.0;

/// The path is looked at in so many places between two knots, and in time in so many a place.
const LOOKS: u32 = 4;

/// What is left between the greatest values found at those places and the limits.
const MARGIN: f64 = 1.002;

/// The way along a path over time, from rest to rest.
///
/// With q(s) the joints by the way s: q' = dq/ds, and over time v = q' s., a = q' s.. + q'' s.², j = q' s... + 3 q'' s.
/// s.. + q''' s.³. A profile of s whose velocity, acceleration and jerk are each small enough for the q' part alone is
/// slowed down as a whole by what the other parts add: that divides v by k, a by k², j by k³.
pub(super) fn along(
    arm: &Narrowed<'_>,
    dynamics: &[Dynamics],
    joints: &Spline,
    speed: Option<f64>,
    part: f64,
    step: usize,
) -> Result<Profile, Refusal> {
    let length = joints.end();
    let slope = Slopes::of(joints, dynamics);
    let wanted = speed.unwrap_or(PATH_SPEED * part);
    let possible = slope.velocity;
    let needed = if speed.is_some() { wanted } else { LEAST_PATH_SPEED.min(wanted) };
    if possible < needed {
        return Err(too_fast(arm, dynamics, &slope, needed, step));
    }
    let first = Dynamics {
        velocity: wanted.min(possible),
        acceleration: slope.acceleration.min(PATH_ACCELERATION),
        jerk: slope.jerk.min(PATH_JERK),
    };
    let profile = |dynamics: Dynamics| {
        Profile::new(&[0.0], &[length], &[dynamics]).map_err(|error| Reason::Profile(error).of_step(step))
    };
    let stretch = stretch(&profile(first)?, joints, dynamics);
    profile(first.slowed(1.0 / (stretch * MARGIN)))
}

/// The least of limit / |q'| over path and joints, for velocity, acceleration and jerk.
struct Slopes {
    velocity: f64,
    acceleration: f64,
    jerk: f64,
    /// Where and for which joint the velocity is least: (index, of how many, way, joint, |q'|).
    steepest: (usize, usize, f64, usize, f64),
    length: f64,
}

impl Slopes {
    fn of(joints: &Spline, dynamics: &[Dynamics]) -> Self {
        let places = places(joints);
        let infinite = f64::INFINITY;
        let mut slopes = Self {
            velocity: infinite,
            acceleration: infinite,
            jerk: infinite,
            steepest: (0, places.len(), 0.0, 0, 0.0),
            length: joints.end(),
        };
        for (index, way) in places.iter().enumerate() {
            let first = joints.at(*way).first;
            for (joint, (slope, limits)) in first.iter().zip(dynamics).enumerate() {
                let slope = slope.abs();
                if limits.velocity / slope < slopes.velocity {
                    slopes.velocity = limits.velocity / slope;
                    slopes.steepest = (index, places.len(), *way, joint, slope);
                }
                slopes.acceleration = slopes.acceleration.min(limits.acceleration / slope);
                slopes.jerk = slopes.jerk.min(limits.jerk / slope);
            }
        }
        slopes
    }
}

/// The knots and places between them.
fn places(joints: &Spline) -> Vec<f64> {
    let between = joints.knots().windows(2).flat_map(|pair| {
        let (left, right) = (pair.first().copied().unwrap_or(0.0), pair.last().copied().unwrap_or(0.0));
        (0..LOOKS).map(move |look| left + (right - left) * f64::from(look) / f64::from(LOOKS))
    });
    between.chain([joints.end()]).collect()
}

/// By how much a profile must be slowed down, at least 1.
fn stretch(profile: &Profile, joints: &Spline, dynamics: &[Dynamics]) -> f64 {
    let looks = places(joints).len() * LOOKS as usize;
    let mut stretch: f64 = 1.0;
    let phases = profile.phases();
    // Between two changes of jerk each, both of whose sides count.
    let times = phases.windows(2).flat_map(|phase| {
        let (from, to) = (phase.first().copied().unwrap_or(0.0), phase.last().copied().unwrap_or(0.0));
        (0..=looks).map(move |look| from + (to - from) * (look as f64 / looks as f64).clamp(1e-9, 1.0 - 1e-9))
    });
    for time in times {
        let way = profile.at(time).0.first().copied().unwrap_or(0.0);
        let [v, a, j] = profile.derivatives(time);
        let at = joints.at(way);
        let terms = at.first.iter().zip(&at.second).zip(&at.third).zip(dynamics);
        for (((first, second), third), limits) in terms {
            let velocity = (first * v).abs() / limits.velocity;
            let acceleration = (first * a + second * v * v).abs() / limits.acceleration;
            let jerk = (first * j + 3.0 * second * v * a + third * v.powi(3)).abs() / limits.jerk;
            stretch = stretch.max(velocity).max(acceleration.sqrt()).max(jerk.cbrt());
        }
    }
    stretch
}

fn too_fast(arm: &Narrowed<'_>, dynamics: &[Dynamics], slopes: &Slopes, speed: f64, step: usize) -> Refusal {
    let (index, count, way, joint, slope) = slopes.steepest;
    let sample = Sample { index, count, part: if slopes.length > 0.0 { way / slopes.length } else { 1.0 } };
    let allowed = dynamics.get(joint).map_or(f64::NAN, |limits| limits.velocity);
    let joint = joint_name(arm, joint);
    Reason::TooFast { joint, needed: slope * speed, allowed, speed, possible: slopes.velocity }
        .at(step, sample)
}
