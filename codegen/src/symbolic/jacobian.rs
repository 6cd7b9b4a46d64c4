//! The geometric Jacobian: velocity of the tool point and angular velocity, in base axes, a column a joint variable.
//!
//! For a revolute joint with axis z and the tool at r from it: (z x r, z); for a prismatic one: (z, 0)
//! [Craig 2005, 5.7-5.8]. In the axes of the joint's group z is (0, 0, 1), so z x r costs nothing; what costs is the
//! way into base axes, and the least of three is taken for every column.

use super::chain::{Chain, Group, Joint};
use super::expression::{Arena, Expr};
use super::forward_kinematics as forward;
use super::transform::{self, Rigid, Vec3};
use crate::model::{JointKind, Model};

/// Velocity and angular velocity of a row's joint.
type Twist = (Vec3, Vec3);

/// The columns, one a joint variable: vx vy vz wx wy wz. `tool` is the tool frame built before, and `wanted` what of
/// it is among the results, and so costs nothing more.
pub fn columns(
    arena: &mut Arena,
    chain: &Chain,
    model: &Model,
    tool: &Rigid,
    wanted: &[Expr],
) -> Vec<[Expr; 6]> {
    let prefixes: Vec<Rigid> =
        (0..chain.groups.len()).map(|group| forward::prefix(arena, chain, group)).collect();
    let suffixes = forward::suffixes(arena, chain, 0);
    let walks = Walks { chain, tool, prefixes: &prefixes, suffixes: &suffixes };
    let uniform = ROUTES.map(Some);
    let all = if chain.groups.len() > forward::MANY_GROUPS { 1 } else { usize::MAX };
    let plans = uniform.into_iter().rev().chain([None]).take(all);
    let mut best: Option<(usize, Vec<[Expr; 6]>)> = None;
    for plan in plans {
        let twists = twists(arena, &walks, wanted, plan);
        let columns: Vec<_> =
            (0..model.joints.len()).map(|variable| column(arena, model, &twists, variable)).collect();
        let cost = arena.operation_count(&[wanted, &columns.concat()].concat());
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, columns));
        }
    }
    best.map(|(_, columns)| columns).unwrap_or_default()
}

/// A variable moves every row that it is coupled to.
fn column(arena: &mut Arena, model: &Model, twists: &[(usize, Twist)], variable: usize) -> [Expr; 6] {
    let mut sum = (transform::zero_vector(arena), transform::zero_vector(arena));
    for &(row, (linear, angular)) in twists {
        let terms = model.rows.get(row).map_or(&[][..], |row| &row.terms);
        for &(_, coefficient) in terms.iter().filter(|term| term.0 == variable) {
            let factor = factor(arena, row, variable, coefficient);
            let linear = linear.map(|x| arena.mul(factor, x));
            let angular = angular.map(|x| arena.mul(factor, x));
            sum = (transform::add(arena, sum.0, linear), transform::add(arena, sum.1, angular));
        }
    }
    let ([vx, vy, vz], [wx, wy, wz]) = sum;
    [vx, vy, vz, wx, wy, wz]
}

fn factor(arena: &mut Arena, row: usize, variable: usize, coefficient: f64) -> Expr {
    if let Some(number) = super::number::Number::from_f64(coefficient) {
        return arena.number(number);
    }
    let (joint, number) = (row + 1, variable + 1);
    let note = format!("coupling of joint {joint} to q{number}");
    arena.parameter(&format!("k{joint}_{number}"), coefficient, 0, &note)
}

/// What is known before any column is written.
struct Walks<'a> {
    chain: &'a Chain,
    tool: &'a Rigid,
    /// The frame before each group.
    prefixes: &'a [Rigid],
    /// The tool seen from each group.
    suffixes: &'a [forward::Suffix],
}

/// By one pair of routes for all joints, or by the cheapest one for each in turn.
fn twists(
    arena: &mut Arena,
    walks: &Walks<'_>,
    wanted: &[Expr],
    routes: Option<(Route, Route)>,
) -> Vec<(usize, Twist)> {
    let mut found = Vec::new();
    let mut wanted = wanted.to_vec();
    let groups = walks.chain.groups.iter().zip(walks.prefixes).zip(walks.suffixes);
    for (index, ((group, before), suffix)) in groups.enumerate() {
        for (count, (joint, arm)) in group.joints.iter().zip(&suffix.arms).enumerate() {
            let way = Way { walks, before, group, index, count };
            let twist = match routes {
                Some(routes) => twist(arena, &way, joint, *arm, routes),
                None => cheapest(arena, &way, joint, *arm, &wanted),
            };
            wanted.extend([twist.0, twist.1].concat());
            found.push((joint.row, twist));
        }
    }
    found
}

/// Where a joint stands: behind `count` joints of its group.
struct Way<'a> {
    walks: &'a Walks<'a>,
    before: &'a Rigid,
    group: &'a Group,
    index: usize,
    count: usize,
}

/// The ways into base axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Route {
    /// Turned outward, joint by joint.
    Outward,
    /// By the product of all rotations before.
    Matrix,
    /// z x (p - o) in base axes; only for the velocity.
    Cross,
}

/// Routes of the axis and of the velocity.
const ROUTES: [(Route, Route); 6] = [
    (Route::Outward, Route::Outward),
    (Route::Outward, Route::Matrix),
    (Route::Outward, Route::Cross),
    (Route::Matrix, Route::Outward),
    (Route::Matrix, Route::Matrix),
    (Route::Matrix, Route::Cross),
];

fn cheapest(arena: &mut Arena, way: &Way<'_>, joint: &Joint, arm: Vec3, wanted: &[Expr]) -> Twist {
    let trials = ROUTES.map(|routes| {
        let twist = twist(arena, way, joint, arm, routes);
        (arena.operation_count(&[wanted, &twist.0, &twist.1].concat()), twist)
    });
    let [first, ..] = trials;
    let least = trials.into_iter().reduce(|best, trial| if trial.0 < best.0 { trial } else { best });
    least.unwrap_or(first).1
}

fn twist(
    arena: &mut Arena,
    way: &Way<'_>,
    joint: &Joint,
    arm: Vec3,
    (angular, linear): (Route, Route),
) -> Twist {
    let (zero, one) = (arena.zero(), arena.one());
    let along = if joint.flipped { arena.neg(one) } else { one };
    let axis = way.route(arena, angular, [zero, zero, along]);
    if joint.kind == JointKind::Prismatic {
        return (axis, [zero; 3]);
    }
    if linear == Route::Cross {
        let origin = way.origin(arena);
        let arm = transform::sub(arena, way.walks.tool.translation, origin);
        return (transform::cross(arena, axis, arm), axis);
    }
    let [x, y, _] = arm;
    let around = [arena.neg(y), x, zero].map(|entry| arena.mul(along, entry));
    (way.route(arena, linear, around), axis)
}

impl Way<'_> {
    fn route(&self, arena: &mut Arena, route: Route, v: Vec3) -> Vec3 {
        if route == Route::Outward {
            return self.outward(arena, v);
        }
        transform::apply(arena, &self.before.rotation, v)
    }

    /// From the axes of the frame before the group into base axes.
    fn outward(&self, arena: &mut Arena, mut v: Vec3) -> Vec3 {
        let groups = &self.walks.chain.groups;
        for (index, group) in groups.iter().enumerate().take(self.index + 1).rev() {
            v = transform::apply(arena, &group.before.rotation, v);
            let previous = index.checked_sub(1).and_then(|index| groups.get(index));
            if let Some(last) = previous.and_then(|group| group.joints.last()) {
                if last.flipped {
                    v = transform::flip(arena, v);
                }
                let angle = arena.sin_cos(&last.suffix, &last.turn);
                v = transform::turn(arena, angle, v);
            }
        }
        v
    }

    /// The joint's origin in the base frame.
    fn origin(&self, arena: &mut Arena) -> Vec3 {
        forward::behind(arena, self.before, self.group, self.count).translation
    }
}
