//! Whether the tool point keeps the workspace rules on the way, between samples too.

use super::narrowed::Narrowed;
use dh_runtime::{Axis, Bound, KeepOut, Kinematics, Rule, Rules, Side};

/// How far the tool point may be beyond a bound, or inside a box, on its way between the ends of a move (m). At the
/// ends there is no such slack. A servo goes from one setpoint to the next by a curve of its own anyway.
pub const WAY_TOLERANCE: f64 = 1e-4;

/// Joints move this much in all (rad) at most between the places where the arm's speed is looked at.
const SHORTEST_LOOK: f64 = 0.05;

/// Checks the tool point on the straight line (in joint space) between two sets of joint values. Where it is inside of
/// something forbidden already, it may come out of it, but get no deeper.
///
/// From where it has some distance to everything forbidden, the tool point must travel at least so far to get there.
/// What is not excluded by that is halved, and looked at again \[as conservative advancement does, Mirtich 1996\]. How
/// far it travels is bounded by the sum over the joints of lever times turn, with what the levers can grow by.
pub(super) fn check(arm: &Narrowed<'_>, from: &[f64], to: &[f64]) -> Result<(), Rule> {
    let rules = arm.rules();
    if rules.bounds.is_empty() && rules.keep_out.is_empty() {
        return Ok(());
    }
    let (Some(start), Some(end)) = (Look::at(arm, from), Look::at(arm, to)) else {
        return Ok(());
    };
    let slack: Vec<f64> = start.depths.iter().map(|depth| depth.max(WAY_TOLERANCE)).collect();
    end.keeps(&rules, &slack)?;
    between(arm, &start, &end, &slack)
}

/// Whether the tool point is so far (m) from everything forbidden.
pub(super) fn is_far(arm: &Narrowed<'_>, q: &[f64], way: f64) -> bool {
    Look::at(arm, q).is_some_and(|look| look.depths.iter().all(|depth| *depth <= -way))
}

/// Whether the tool point is nowhere deeper in what is forbidden than it may be: at all, or where the way begins.
pub(super) fn no_deeper(arm: &Narrowed<'_>, from: &[f64], q: &[f64]) -> bool {
    let (Some(start), Some(here)) = (Look::at(arm, from), Look::at(arm, q)) else {
        return false;
    };
    let mut depths = start.depths.iter().zip(&here.depths);
    depths.all(|(before, depth)| *depth <= before.max(WAY_TOLERANCE))
}

fn between(arm: &Narrowed<'_>, start: &Look, end: &Look, slack: &[f64]) -> Result<(), Rule> {
    let turn: f64 = start.q.iter().zip(&end.q).map(|(a, b)| (b - a).abs()).sum();
    let travel = start.travel(end).max(end.travel(start));
    // Levers change by their own joints' turns: at most by the longest of them times the turn.
    let bound = travel + start.longest().max(end.longest()) * turn * turn;
    let depths = start.depths.iter().zip(&end.depths).zip(slack);
    let clear = depths.into_iter().all(|((before, after), slack)| 2.0 * slack - before - after >= bound);
    if turn <= SHORTEST_LOOK && (clear || bound <= WAY_TOLERANCE) {
        return Ok(());
    }
    let middle: Vec<f64> = start.q.iter().zip(&end.q).map(|(a, b)| (a + b) / 2.0).collect();
    if middle == start.q || middle == end.q {
        return Ok(());
    }
    let Some(middle) = Look::at(arm, &middle) else {
        return Ok(());
    };
    middle.keeps(&arm.rules(), slack)?;
    between(arm, start, &middle, slack)?;
    between(arm, &middle, end, slack)
}

/// The arm in one pose.
struct Look {
    q: Vec<f64>,
    /// The tool point in the frame of the rules (m).
    point: [f64; 3],
    /// How far the tool point moves per unit of each joint.
    levers: Vec<f64>,
    /// How deep the tool point is in what each rule forbids, bounds first, then boxes (m); negative by its distance.
    depths: Vec<f64>,
}

impl Look {
    fn at(arm: &Narrowed<'_>, q: &[f64]) -> Option<Self> {
        let mut columns = vec![[0.0; 6]; q.len()];
        arm.jacobian_into(q, &mut columns).ok()?;
        let levers = columns.iter().map(|[x, y, z, ..]| (x * x + y * y + z * z).sqrt()).collect();
        let (point, rules) = (arm.rules_point(q).ok()?, arm.rules());
        let bounds = rules.bounds.iter().map(|bound| -of_bound(bound, point));
        let boxes = rules.keep_out.iter().map(|keep_out| -of_box(keep_out, point));
        Some(Self { q: q.to_vec(), point, levers, depths: bounds.chain(boxes).collect() })
    }

    /// How far the tool point would travel to another pose with the levers of this one.
    fn travel(&self, other: &Self) -> f64 {
        let turns = self.q.iter().zip(&other.q).map(|(a, b)| (b - a).abs());
        self.levers.iter().zip(turns).map(|(lever, turn)| lever * turn).sum()
    }

    fn longest(&self) -> f64 {
        self.levers.iter().copied().fold(0.0, f64::max)
    }

    /// Whether the tool point is no deeper than it may be anywhere.
    fn keeps(&self, rules: &Rules<'_>, slack: &[f64]) -> Result<(), Rule> {
        let deep = self.depths.iter().zip(slack).position(|(depth, slack)| depth > slack);
        let Some(index) = deep else { return Ok(()) };
        Err(match rules.bounds.get(index) {
            Some(bound) => Rule::Bound { bound: *bound, value: along(bound.axis, self.point) },
            None => Rule::KeepOut { index: index - rules.bounds.len(), position: self.point },
        })
    }
}

fn along(axis: Axis, [x, y, z]: [f64; 3]) -> f64 {
    match axis {
        Axis::X => x,
        Axis::Y => y,
        Axis::Z => z,
    }
}

fn of_bound(bound: &Bound, point: [f64; 3]) -> f64 {
    let value = along(bound.axis, point);
    match bound.side {
        Side::Min => value - bound.value,
        Side::Max => bound.value - value,
    }
}

/// The distance from a box; inside, the depth under the nearest face, negative.
fn of_box(keep_out: &KeepOut, point: [f64; 3]) -> f64 {
    let outside = [0, 1, 2].map(|i| (keep_out.min[i] - point[i]).max(point[i] - keep_out.max[i]));
    let nearest = outside.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if nearest <= 0.0 {
        return nearest;
    }
    outside.iter().map(|x| x.max(0.0).powi(2)).sum::<f64>().sqrt()
}
