//! Where on a path the arm has to be slower than it was asked to be: near singularities, and in curves.

use super::dynamics::Dynamics;
use super::spline::Spline;

/// The part of acceleration and jerk that is left to what a path's bends need; the rest is for changes of speed.
const SHARE: f64 = 0.5;

/// Kinks are rounded over no less than this part of the time that the path takes: areas up to a time, which a time that
/// is lost in the last digits of that of the whole would leave nothing of, are told from each other to nine digits then.
const LEAST_ROUNDING: f64 = 1e-6;

/// The way along a path by a way that is stretched where the arm is slow: made along it at constant speed, the path is
/// followed nowhere faster than the joints can. `None` where no place is any slower than the others.
///
/// With q(s) the joints by the way s, a speed v is possible where |q'| v, |q''| v² and |q'''| v³ are within the joints'
/// velocity, acceleration and jerk. From place to place v² changes by no more than the joints accelerate, and the kinks
/// that are left are rounded over the time that an acceleration needs to build up.
pub(super) fn stretched(
    joints: &Spline,
    places: &[f64],
    dynamics: &[Dynamics],
    wanted: f64,
) -> Option<Spline> {
    let limits: Vec<Limit> = places.iter().map(|way| Limit::of(joints, *way, dynamics, wanted)).collect();
    let mut squares: Vec<f64> = limits.iter().map(|limit| limit.speed * limit.speed).collect();
    if squares.iter().all(|square| *square >= wanted * wanted) {
        return None;
    }
    accelerate(&mut squares, places, &limits);
    let speeds: Vec<f64> = squares.into_iter().map(f64::sqrt).collect();
    let build_up = dynamics.iter().map(|limits| limits.acceleration / limits.jerk).fold(0.0, f64::max);
    let reached = times(places, &speeds);
    let least = LEAST_ROUNDING * reached.last().copied().unwrap_or(0.0);
    let speeds = rounded(&reached, &speeds, build_up.max(least));
    // Made at the speed that was asked for, the stretched way takes as long.
    let knots = times(places, &speeds).into_iter().map(|time| wanted * time).collect();
    Spline::through(knots, places.iter().map(|way| vec![*way]).collect())
}

/// What is possible at a place of a path.
struct Limit {
    /// m/s
    speed: f64,
    /// m/s²
    acceleration: f64,
}

impl Limit {
    fn of(joints: &Spline, way: f64, dynamics: &[Dynamics], wanted: f64) -> Self {
        let at = joints.at(way);
        let (mut speed, mut acceleration) = (wanted, f64::INFINITY);
        let slopes = at.first.iter().zip(&at.second).zip(&at.third);
        for (((first, second), third), limits) in slopes.zip(dynamics) {
            // What does not bend divides by zero, and bounds nothing.
            speed = speed.min(limits.velocity / first.abs());
            speed = speed.min((SHARE * limits.acceleration / second.abs()).sqrt());
            speed = speed.min((SHARE * limits.jerk / third.abs()).cbrt());
            acceleration = acceleration.min((1.0 - SHARE) * limits.acceleration / first.abs());
        }
        Self { speed, acceleration }
    }
}

/// Lowers squares of speeds to those that can be reached from both sides: v² grows by 2 a along each metre.
fn accelerate(squares: &mut [f64], places: &[f64], limits: &[Limit]) {
    let reachable = |before: Option<(f64, &Limit, f64)>, way: f64, limit: &Limit| {
        before.map_or(f64::INFINITY, |(then, earlier, reached)| {
            reached + 2.0 * earlier.acceleration.min(limit.acceleration) * (way - then).abs()
        })
    };
    let mut before = None;
    for ((square, way), limit) in squares.iter_mut().zip(places).zip(limits) {
        *square = square.min(reachable(before, *way, limit));
        before = Some((*way, limit, *square));
    }
    before = None;
    for ((square, way), limit) in squares.iter_mut().zip(places).zip(limits).rev() {
        *square = square.min(reachable(before, *way, limit));
        before = Some((*way, limit, *square));
    }
}

/// Speeds at these times without kinks: around each the least is taken within half of a stretch of time (s), and then
/// the mean, which is no more than there was.
fn rounded(times: &[f64], speeds: &[f64], seconds: f64) -> Vec<f64> {
    let windows: Vec<(f64, f64)> =
        times.iter().map(|time| (time - seconds / 2.0, time + seconds / 2.0)).collect();
    let line = Polyline { places: times, values: speeds };
    let least: Vec<f64> = windows.iter().map(|(from, to)| line.least(*from, *to)).collect();
    let least = Polyline { places: times, values: &least };
    let areas = least.areas();
    let area = |way: f64| least.area(&areas, way);
    windows.iter().map(|(from, to)| (area(*to) - area(*from)) / seconds).collect()
}

/// When the arm is at these places (s) at these speeds.
fn times(places: &[f64], speeds: &[f64]) -> Vec<f64> {
    let mut times = vec![0.0];
    for (ways, speeds) in places.windows(2).zip(speeds.windows(2)) {
        if let ([from, to], [before, after], Some(time)) = (ways, speeds, times.last()) {
            times.push(time + 2.0 * (to - from) / (before + after));
        }
    }
    times
}

/// Straight lines through points; before the first and after the last it is level.
struct Polyline<'p> {
    places: &'p [f64],
    values: &'p [f64],
}

impl Polyline<'_> {
    /// The point before a place, and the one after it.
    fn around(&self, way: f64) -> [(usize, f64, f64); 2] {
        let last = self.places.len().saturating_sub(1);
        let after = self.places.partition_point(|place| *place <= way);
        [after.saturating_sub(1), after.min(last)].map(|index| {
            let number = |list: &[f64]| list.get(index).copied().unwrap_or(0.0);
            (index, number(self.places), number(self.values))
        })
    }

    fn at(&self, way: f64) -> f64 {
        let [(_, from, before), (_, to, after)] = self.around(way);
        let part = if to > from { ((way - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        before + part * (after - before)
    }

    /// The least value between two places.
    fn least(&self, from: f64, to: f64) -> f64 {
        let [first, last] = [from, to].map(|way| self.places.partition_point(|place| *place <= way));
        let between = self.values.get(first..last).unwrap_or_default();
        between.iter().copied().fold(self.at(from).min(self.at(to)), f64::min)
    }

    /// The area below it from the first point to each.
    fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0];
        for (ways, values) in self.places.windows(2).zip(self.values.windows(2)) {
            if let ([from, to], [before, after], Some(area)) = (ways, values, areas.last()) {
                areas.push(area + (to - from) * f64::midpoint(*before, *after));
            }
        }
        areas
    }

    /// The area from the first point to a place.
    fn area(&self, areas: &[f64], way: f64) -> f64 {
        let [(index, from, before), _] = self.around(way);
        // Before the first point the way there counts against it.
        areas.get(index).copied().unwrap_or(0.0) + (way - from) * f64::midpoint(before, self.at(way))
    }
}
