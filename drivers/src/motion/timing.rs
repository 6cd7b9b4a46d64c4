//! When the arm is where on a path: the way made, over time, so that every joint keeps its limits.

use super::dynamics::Dynamics;
use super::follow::joint_name;
use super::narrowed::Narrowed;
use super::profile::{Profile, ProfileError};
use super::refusal::{Reason, Refusal, Sample};
use super::slowing;
use super::spline::{Derivatives, Spline};

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

/// The way made along a path, over time, from rest to rest.
#[derive(Debug)]
pub(super) struct Timing {
    /// Of the way itself, or of one that is stretched where the arm is slow.
    profile: Profile,
    /// The way by the stretched one.
    slowed: Option<Spline>,
}

impl Timing {
    /// How long it takes (s).
    pub(super) fn duration(&self) -> f64 {
        self.profile.duration()
    }

    /// The way made (m) and the speed (m/s) at a time (s) after the start.
    pub(super) fn at(&self, time: f64) -> (f64, f64) {
        let (way, [speed, ..]) = self.derivatives(time);
        (way, speed)
    }

    /// The way made, and its first three derivatives.
    fn derivatives(&self, time: f64) -> (f64, [f64; 3]) {
        let way = self.profile.at(time).0.first().copied().unwrap_or(0.0);
        let rates = self.profile.derivatives(time);
        let Some(slowed) = &self.slowed else { return (way, rates) };
        let at = slowed.at(way);
        (at.value.first().copied().unwrap_or(0.0), chained(&at, rates).next().unwrap_or_default())
    }
}

/// The straight way (in joint space) from 0 to 1, for joints that leave and arrive together, each at the same part of its
/// way: how devices go that make their own profiles.
pub(super) fn straight(start: &[f64], goal: &[f64], dynamics: &[Dynamics]) -> Result<Timing, ProfileError> {
    let infinite = f64::INFINITY;
    let mut least = Dynamics { velocity: infinite, acceleration: infinite, jerk: infinite };
    for ((from, to), limits) in start.iter().zip(goal).zip(dynamics).filter(|((from, to), _)| from != to) {
        let way = (to - from).abs();
        least.velocity = least.velocity.min(limits.velocity / way);
        least.acceleration = least.acceleration.min(limits.acceleration / way);
        least.jerk = least.jerk.min(limits.jerk / way);
    }
    Ok(Timing { profile: Profile::new(&[0.0], &[1.0], &[least])?, slowed: None })
}

/// The derivatives by time of a curve x(s), s having the derivatives v, a and j by time: x' v, x' a + x'' v², x' j +
/// 3 x'' v a + x''' v³; one coordinate after the other.
fn chained(at: &Derivatives, [v, a, j]: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    let slopes = at.first.iter().zip(&at.second).zip(&at.third);
    slopes.map(move |((first, second), third)| {
        [first * v, first * a + second * v * v, first * j + 3.0 * second * v * a + third * v.powi(3)]
    })
}

/// The way along a path over time: at the speed that was asked for, slower only where the joints can't follow.
///
/// It is made along a way that is stretched there ([`slowing`]), with a profile whose velocity, acceleration and jerk
/// are each small enough for the first derivatives of the joints alone. That is slowed down as a whole by what the
/// others still add: k times slower divides velocities by k, accelerations by k², jerks by k³.
pub(super) fn along(
    arm: &Narrowed<'_>,
    dynamics: &[Dynamics],
    joints: &Spline,
    speed: Option<f64>,
    part: f64,
    step: usize,
) -> Result<Timing, Refusal> {
    let wanted = speed.unwrap_or(PATH_SPEED * part);
    let steepest = Steepest::of(joints, dynamics);
    let needed = if speed.is_some() { wanted } else { LEAST_PATH_SPEED.min(wanted) };
    if steepest.possible < needed {
        return Err(steepest.too_fast(arm, dynamics, needed, step));
    }
    let refused = |error| Reason::Profile(error).of_step(step);
    let plain = timed(joints, dynamics, None, wanted).map_err(refused)?;
    let Some(slowed) = slowing::stretched(joints, &places(joints), dynamics, wanted) else {
        return Ok(plain);
    };
    let slowed = timed(joints, dynamics, Some(slowed), wanted).map_err(refused)?;
    // A short path may be over before it pays to have two speeds.
    Ok(if slowed.duration() < plain.duration() { slowed } else { plain })
}

/// The profile along the way, or along the one that is stretched.
fn timed(
    joints: &Spline,
    dynamics: &[Dynamics],
    slowed: Option<Spline>,
    wanted: f64,
) -> Result<Timing, ProfileError> {
    let along = slowed.as_ref().unwrap_or(joints);
    let mut first = Dynamics { velocity: wanted, acceleration: PATH_ACCELERATION, jerk: PATH_JERK };
    for place in places(along) {
        let slope = |at: &Derivatives| at.first.first().copied().unwrap_or(0.0).abs();
        let (way, narrower) = match &slowed {
            Some(slowed) => {
                let at = slowed.at(place);
                (at.value.first().copied().unwrap_or(0.0), slope(&at))
            }
            None => (place, 1.0),
        };
        for (slope, limits) in joints.at(way).first.iter().zip(dynamics) {
            let slope = slope.abs() * narrower;
            first.velocity = first.velocity.min(limits.velocity / slope);
            first.acceleration = first.acceleration.min(limits.acceleration / slope);
            first.jerk = first.jerk.min(limits.jerk / slope);
        }
    }
    let profile = Profile::new(&[0.0], &[along.end()], &[first])?;
    let timing = Timing { profile, slowed };
    let slower = first.slowed(1.0 / (stretch(&timing, joints, dynamics) * MARGIN));
    let end = timing.slowed.as_ref().unwrap_or(joints).end();
    Ok(Timing { profile: Profile::new(&[0.0], &[end], &[slower])?, ..timing })
}

/// The place of a path where the joints allow the least speed.
struct Steepest {
    /// That speed (m/s).
    possible: f64,
    sample: Sample,
    joint: usize,
    /// |dq/ds| of that joint.
    slope: f64,
}

impl Steepest {
    fn of(joints: &Spline, dynamics: &[Dynamics]) -> Self {
        let (places, length) = (places(joints), joints.end());
        let count = places.len();
        let start = Sample { index: 0, count, part: 0.0 };
        let mut steepest = Self { possible: f64::INFINITY, sample: start, joint: 0, slope: 0.0 };
        for (index, way) in places.iter().enumerate() {
            for (joint, (slope, limits)) in joints.at(*way).first.iter().zip(dynamics).enumerate() {
                let (slope, part) = (slope.abs(), if length > 0.0 { way / length } else { 1.0 });
                if limits.velocity / slope < steepest.possible {
                    let possible = limits.velocity / slope;
                    steepest = Self { possible, sample: Sample { index, count, part }, joint, slope };
                }
            }
        }
        steepest
    }

    fn too_fast(&self, arm: &Narrowed<'_>, dynamics: &[Dynamics], speed: f64, step: usize) -> Refusal {
        let allowed = dynamics.get(self.joint).map_or(f64::NAN, |limits| limits.velocity);
        let (joint, needed) = (joint_name(arm, self.joint), self.slope * speed);
        Reason::TooFast { joint, needed, allowed, speed, possible: self.possible }.at(step, self.sample)
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

/// By how much a timing must be slowed down, at least 1.
fn stretch(timing: &Timing, joints: &Spline, dynamics: &[Dynamics]) -> f64 {
    let looks = places(joints).len() * LOOKS as usize;
    let mut stretch: f64 = 1.0;
    let phases = timing.profile.phases();
    // Between two changes of jerk each, both of whose sides count.
    let times = phases.windows(2).flat_map(|phase| {
        let (from, to) = (phase.first().copied().unwrap_or(0.0), phase.last().copied().unwrap_or(0.0));
        (0..=looks).map(move |look| from + (to - from) * (look as f64 / looks as f64).clamp(1e-9, 1.0 - 1e-9))
    });
    for time in times {
        let (way, rates) = timing.derivatives(time);
        for ([velocity, acceleration, jerk], limits) in chained(&joints.at(way), rates).zip(dynamics) {
            let velocity = velocity.abs() / limits.velocity;
            let acceleration = acceleration.abs() / limits.acceleration;
            let jerk = jerk.abs() / limits.jerk;
            stretch = stretch.max(velocity).max(acceleration.sqrt()).max(jerk.cbrt());
        }
    }
    stretch
}
