//! Whether the tool point keeps the workspace rules on the way, between samples too.

use super::narrowed::Narrowed;
use dh_runtime::{Axis, Bound, KeepOut, Kinematics, Rule, Rules, Side};

/// How far the tool point may be beyond a bound, or inside a box, on its way between the ends of a move (m). At the
/// ends there is no such slack. A servo goes from one setpoint to the next by a curve of its own anyway.
pub const WAY_TOLERANCE: f64 = 1e-4;

/// Joints move this much in all (rad) at most between the places where the arm's speed is looked at.
const SHORTEST_LOOK: f64 = 0.05;

/// Checks the tool point on the straight line (in joint space) between two sets of joint values.
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
    if let Some(rule) = start.broken(&rules).or_else(|| end.broken(&rules)) {
        return Err(rule);
    }
    between(arm, &start, &end)
}

fn between(arm: &Narrowed<'_>, start: &Look, end: &Look) -> Result<(), Rule> {
    let rules = arm.rules();
    let turn: f64 = start.q.iter().zip(&end.q).map(|(a, b)| (b - a).abs()).sum();
    let travel = start.travel(end).max(end.travel(start));
    // Levers change by their own joints' turns: at most by the longest of them times the turn.
    let bound = travel + start.longest().max(end.longest()) * turn * turn;
    let (before, after) = (start.clearance(&rules), end.clearance(&rules));
    if turn <= SHORTEST_LOOK && (before + after + 2.0 * WAY_TOLERANCE >= bound || bound <= WAY_TOLERANCE) {
        return Ok(());
    }
    let middle: Vec<f64> = start.q.iter().zip(&end.q).map(|(a, b)| (a + b) / 2.0).collect();
    if middle == start.q || middle == end.q {
        return Ok(());
    }
    let Some(middle) = Look::at(arm, &middle) else {
        return Ok(());
    };
    if let Some(rule) = middle.broken(&rules) {
        return Err(rule);
    }
    between(arm, start, &middle)?;
    between(arm, &middle, end)
}

/// The arm in one pose.
struct Look {
    q: Vec<f64>,
    /// The tool point in the frame of the rules (m).
    point: [f64; 3],
    /// How far the tool point moves per unit of each joint.
    levers: Vec<f64>,
}

impl Look {
    fn at(arm: &Narrowed<'_>, q: &[f64]) -> Option<Self> {
        let mut columns = vec![[0.0; 6]; q.len()];
        arm.jacobian_into(q, &mut columns).ok()?;
        let levers = columns.iter().map(|[x, y, z, ..]| (x * x + y * y + z * z).sqrt()).collect();
        Some(Self { q: q.to_vec(), point: arm.rules_point(q).ok()?, levers })
    }

    /// How far the tool point would travel to another pose with the levers of this one.
    fn travel(&self, other: &Self) -> f64 {
        let turns = self.q.iter().zip(&other.q).map(|(a, b)| (b - a).abs());
        self.levers.iter().zip(turns).map(|(lever, turn)| lever * turn).sum()
    }

    fn longest(&self) -> f64 {
        self.levers.iter().copied().fold(0.0, f64::max)
    }

    /// The distance of the tool point from what is forbidden; negative by its depth inside.
    fn clearance(&self, rules: &Rules<'_>) -> f64 {
        let bounds = rules.bounds.iter().map(|bound| of_bound(bound, self.point));
        let boxes = rules.keep_out.iter().map(|keep_out| of_box(keep_out, self.point));
        bounds.chain(boxes).fold(f64::INFINITY, f64::min)
    }

    /// The first rule that the tool point breaks by more than it may on the way.
    fn broken(&self, rules: &Rules<'_>) -> Option<Rule> {
        let bound = rules.bounds.iter().find(|bound| of_bound(bound, self.point) < -WAY_TOLERANCE);
        let bound = bound.map(|bound| Rule::Bound { bound: *bound, value: along(bound.axis, self.point) });
        let boxes = || rules.keep_out.iter().position(|keep| of_box(keep, self.point) < -WAY_TOLERANCE);
        bound.or_else(|| boxes().map(|index| Rule::KeepOut { index, position: self.point }))
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
