//! The geometric Jacobian: velocity of the tool point and angular velocity, in base axes, a column a joint variable.
//!
//! For a revolute joint with axis z and the tool at r from it: (z x r, z); for a prismatic one: (z, 0)
//! [Craig 2005, 5.7-5.8]. In the axes of the joint's group z is (0, 0, 1), so z x r costs nothing; what costs is the
//! way into base axes, and the least of three is taken for every column.

use super::chain::{Chain, Joint};
use super::expression::{Arena, Expr};
use super::forward_kinematics as forward;
use super::transform::{self, Rigid, Vec3};
use crate::model::{JointKind, Model};

/// Velocity and angular velocity of a row's joint.
type Twist = (Vec3, Vec3);

/// The columns, one a joint variable: vx vy vz wx wy wz. `tool` is the tool frame built before.
pub fn columns(arena: &mut Arena, chain: &Chain, model: &Model, tool: &Rigid) -> Vec<[Expr; 6]> {
    let twists = twists(arena, chain, tool);
    (0..model.joints.len()).map(|variable| column(arena, model, &twists, variable)).collect()
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
    match super::number::Number::from_f64(coefficient) {
        Some(number) => arena.number(number),
        None => {
            let name = format!("k{}_{}", row + 1, variable + 1);
            arena.parameter(&name, coefficient, &format!("coupling of joint {} to q{}", row + 1, variable + 1))
        }
    }
}

fn twists(arena: &mut Arena, chain: &Chain, tool: &Rigid) -> Vec<(usize, Twist)> {
    let suffixes = forward::suffixes(arena, chain, 0);
    let mut found = Vec::new();
    for (index, group) in chain.groups.iter().enumerate() {
        let Some(suffix) = suffixes.get(index) else { continue };
        for (count, (joint, arm)) in group.joints.iter().zip(&suffix.arms).enumerate() {
            let way = Way { chain, group: index, count, tool };
            let twist = cheapest(arena, &way, joint, *arm);
            found.push((joint.row, twist));
        }
    }
    found
}

/// Where a joint stands: behind `count` joints of its group.
struct Way<'a> {
    chain: &'a Chain,
    group: usize,
    count: usize,
    tool: &'a Rigid,
}

/// The ways into base axes.
#[derive(Clone, Copy)]
enum Route {
    /// Turned outward, joint by joint.
    Outward,
    /// By the product of all rotations before.
    Matrix,
    /// z x (p - o) in base axes.
    Cross,
}

fn cheapest(arena: &mut Arena, way: &Way<'_>, joint: &Joint, arm: Vec3) -> Twist {
    let cost = |route: Route| {
        let mut trial = arena.clone();
        let before = trial.len();
        let _ = twist(&mut trial, way, joint, arm, route);
        trial.operations_since(before)
    };
    let routes = [Route::Outward, Route::Matrix, Route::Cross];
    let costs = routes.map(cost);
    let least = costs.iter().copied().min();
    let route = routes.into_iter().zip(costs).find(|(_, cost)| Some(*cost) == least);
    twist(arena, way, joint, arm, route.map_or(Route::Outward, |(route, _)| route))
}

fn twist(arena: &mut Arena, way: &Way<'_>, joint: &Joint, arm: Vec3, route: Route) -> Twist {
    let (zero, one) = (arena.zero(), arena.one());
    let along = if way.axis_flipped() { arena.neg(one) } else { one };
    let axis = [zero, zero, along];
    let [x, y, _] = arm;
    let around = [arena.neg(y), x, zero].map(|entry| arena.mul(along, entry));
    let mut outward = |arena: &mut Arena, v: Vec3| match route {
        Route::Outward | Route::Cross => way.outward(arena, v),
        Route::Matrix => {
            let frame = forward::prefix(arena, way.chain, way.group);
            transform::apply(arena, &frame.rotation, v)
        }
    };
    let axis = outward(arena, axis);
    match (joint.kind, route) {
        (JointKind::Prismatic, _) => (axis, [zero; 3]),
        (JointKind::Revolute, Route::Cross) => {
            let origin = way.origin(arena);
            let arm = transform::sub(arena, way.tool.translation, origin);
            (transform::cross(arena, axis, arm), axis)
        }
        (JointKind::Revolute, _) => (outward(arena, around), axis),
    }
}

impl Way<'_> {
    /// Whether the joint's own axis points against its group's: so does the frame behind the joint before it.
    fn axis_flipped(&self) -> bool {
        let joints = self.chain.groups.get(self.group).map_or(&[][..], |group| &group.joints);
        joints.get(self.count).is_some_and(|joint| joint.flipped)
    }

    /// From the axes of the frame before the group into base axes.
    fn outward(&self, arena: &mut Arena, mut v: Vec3) -> Vec3 {
        for (index, group) in self.chain.groups.iter().enumerate().take(self.group + 1).rev() {
            v = transform::apply(arena, &group.before.rotation, v);
            let previous = index.checked_sub(1).and_then(|index| self.chain.groups.get(index));
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
        let before = forward::prefix(arena, self.chain, self.group);
        match self.chain.groups.get(self.group) {
            Some(group) => forward::behind(arena, &before, group, self.count).translation,
            None => before.translation,
        }
    }
}
