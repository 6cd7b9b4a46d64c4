//! The special arm that a nearly special one was meant to be.

use super::super::chain::between;
use super::super::{Angle, Convention, Model, Rotation, Row};
use super::{EXACT, Geometry, NEARLY_PARALLEL, Relation, RelationKind, Transform};
use core::f64::consts::PI;

/// How many times as far.
const AS_FAR: f64 = 8.0;

/// The neighbour of a nearly special arm in which what was near is exact.
///
/// Its rows, joints, couplings and frames are those of the arm, with other numbers; q means the same in both, up to
/// the size of what was changed.
#[derive(Debug, Clone)]
pub struct Nominal {
    /// The arm.
    pub model: Model,
    /// How its axes lie.
    pub geometry: Geometry,
    /// Numbers of rows that are not those of the table.
    pub changes: Vec<Change>,
    /// Whether the tool's z axis, which was nearly parallel to the last joint's, is.
    pub tool_turned: bool,
}

impl Nominal {
    /// What kind of arm it is, in the field's words.
    pub fn class(&self) -> String {
        let class = self.geometry.class();
        if self.tool_turned {
            format!("{class}, the tool's z axis parallel to the last joint's")
        } else {
            class
        }
    }
}

/// A number that was changed (rad or m).
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Index of the row.
    pub row: usize,
    /// `d`, `theta`, `a`, `alpha` or `beta`.
    pub key: &'static str,
    /// In the table.
    pub from: f64,
    /// In the neighbour.
    pub to: f64,
}

impl Model {
    /// The nearest arm in which more axes are parallel or meet; `None` where nothing is nearly so, or where no change
    /// of single numbers makes it so.
    pub fn nominal(&self) -> Option<Nominal> {
        let geometry = self.geometry();
        geometry.near().next()?;
        let mut model = self.clone();
        for relation in geometry.near().filter(|relation| relation.kind == RelationKind::Parallel) {
            make_parallel(&mut model, &geometry, relation);
        }
        for kind in [RelationKind::Coincident, RelationKind::Meet, RelationKind::Spherical] {
            // Every step moves the feet that the next one reads.
            let geometry = model.geometry();
            for relation in geometry.near().filter(|relation| relation.kind == kind) {
                make_meet(&mut model, &geometry, relation);
            }
        }
        straighten(&mut model, &geometry, self.reach());
        let after = model.geometry();
        let gained = after.exact().count() > geometry.exact().count();
        let changes = changes(&self.rows, &model.rows);
        gained.then_some(Nominal { model, geometry: after, changes, tool_turned: false })
    }

    /// The same for targets that leave open how the tool is turned about its z axis, which then is as an axis behind the last
    /// joint's: where it is nearly parallel to that, it becomes so, the tool point staying where it is.
    pub(crate) fn nominal_to_tool_axis(&self) -> Option<Nominal> {
        let nominal = self.nominal();
        let model = nominal.as_ref().map_or(self, |nominal| &nominal.model);
        let chain = model.chain();
        let step = Transform::of_link(chain.links.last().filter(|_| !chain.joints.is_empty())?);
        let [x, y, z] = step.axis();
        let off = libm::atan2(libm::hypot(x, y), z.abs());
        if off <= EXACT || off > NEARLY_PARALLEL {
            return nominal;
        }
        let mut model = model.clone();
        // In the frame behind the last joint: from the tool's z axis to that of the joint.
        let turn = Transform::from_rotation(onto(step.axis(), [0.0, 0.0, z.signum()]));
        let step = Transform::from_rotation(step.rotation);
        let tool = Transform::of_rotation(&model.tool.rotation);
        let turned = tool.times(&step.inverse_rotation()).times(&turn).times(&step);
        model.tool.rotation = Rotation::Matrix(turned.rotation);
        let geometry = model.geometry();
        let changes = nominal.map_or_else(Vec::new, |nominal| nominal.changes);
        Some(Nominal { model, geometry, changes, tool_turned: true })
    }
}

/// The least turn from one unit vector to another near to it.
fn onto([x, y, z]: [f64; 3], [a, b, c]: [f64; 3]) -> [[f64; 3]; 3] {
    // v = from x to: 1 + [v] + [v]^2 / (1 + from . to)
    let [i, j, k] = [y * c - z * b, z * a - x * c, x * b - y * a];
    let share = (1.0 + x * a + y * b + z * c).recip();
    [
        [1.0 - share * (j * j + k * k), share * i * j - k, share * i * k + j],
        [share * i * j + k, 1.0 - share * (i * i + k * k), share * j * k - i],
        [share * i * k - j, share * j * k + i, 1.0 - share * (i * i + j * j)],
    ]
}

/// Twists that are as near to a multiple of 15 degrees as other numbers are to what was meant, or a few times as far,
/// become one.
fn straighten(model: &mut Model, geometry: &Geometry, reach: f64) {
    let off = |relation: &Relation| match relation.kind {
        RelationKind::Parallel => relation.off,
        _ => relation.off / if reach > 0.0 { reach } else { 1.0 },
    };
    let most = geometry.near().map(off).fold(0.0, f64::max);
    for row in &mut model.rows {
        for angle in [&mut row.alpha, &mut row.beta] {
            let straight = straightened(*angle);
            if (angle.value - straight.value).abs() <= AS_FAR * most {
                *angle = straight;
            }
        }
    }
}

/// The rows of two neighbouring axes, and the row with the link between them, where no other row is part of that
/// link.
fn rows_of(model: &Model, geometry: &Geometry, relation: &Relation) -> Option<[usize; 3]> {
    let row = |index: Option<&usize>| index.and_then(|axis| geometry.axes.get(*axis)).map(|axis| axis.row);
    let (one, next) = (row(relation.axes.first())?, row(relation.axes.get(1))?);
    let link = match model.convention {
        Convention::Standard => one,
        Convention::Modified => next,
    };
    (next == one + 1).then_some([one, next, link])
}

/// Turns the link into one between parallel axes. The step between the axes stays what it is; its part along y goes
/// into the joint angles on both sides.
fn make_parallel(model: &mut Model, geometry: &Geometry, relation: &Relation) {
    let Some([one, next, link]) = rows_of(model, geometry, relation) else {
        straighten_between(model, geometry, relation);
        return;
    };
    // What the link before has moved along this axis.
    let before = match model.convention {
        Convention::Standard => one.checked_sub(1).and_then(|row| model.rows.get(row)),
        Convention::Modified => model.rows.get(one),
    }
    .map_or(0.0, |row| row.shift);
    let Some(twisted) = model.rows.get(link) else { return };
    let d = model.rows.get(one).map_or(0.0, |row| row.d);
    let [x, y, z] = between(d - before, twisted.a, twisted.alpha, twisted.beta, twisted.shift);
    let shift = twisted.shift;
    let (alpha, beta) = (half_turns(twisted.alpha), half_turns(twisted.beta));
    let sense = alpha.sin_cos().1 * beta.sin_cos().1;
    let (a, turn) = if y == 0.0 {
        (x, 0.0)
    } else if x < 0.0 {
        (-libm::hypot(x, y), libm::atan2(-y, -x))
    } else {
        (libm::hypot(x, y), libm::atan2(y, x))
    };
    let turned = |angle: Angle, by: f64| if by == 0.0 { angle } else { angle.plus(Angle::from_radians(by)) };
    if let Some(row) = model.rows.get_mut(link) {
        (row.a, row.alpha, row.beta, row.shift) = (a, alpha, beta, 0.0);
    }
    if let Some(row) = model.rows.get_mut(one) {
        row.d = z + before;
        row.theta = turned(row.theta, turn);
    }
    if let Some(row) = model.rows.get_mut(next) {
        row.d -= shift;
        row.theta = turned(row.theta, -sense * turn);
    }
}

/// Held rows between two axes: every angle that is nearly a multiple of 15 degrees becomes one.
fn straighten_between(model: &mut Model, geometry: &Geometry, relation: &Relation) {
    let row = |index: Option<&usize>| index.and_then(|axis| geometry.axes.get(*axis)).map(|axis| axis.row);
    let (Some(one), Some(next)) = (row(relation.axes.first()), row(relation.axes.last())) else { return };
    let convention = model.convention;
    for (index, row) in model.rows.iter_mut().enumerate().filter(|(index, _)| (one..=next).contains(index)) {
        let is_in_link = match convention {
            Convention::Standard => index < next,
            Convention::Modified => index > one,
        };
        if is_in_link {
            (row.alpha, row.beta) = (straightened(row.alpha), straightened(row.beta));
        }
        if row.terms.is_empty() {
            row.theta = straightened(row.theta);
        }
    }
}

/// Brings two axes, or three, together by the link lengths and the offset between the feet.
fn make_meet(model: &mut Model, geometry: &Geometry, relation: &Relation) {
    let Some([_, next, link]) = rows_of(model, geometry, relation) else { return };
    if relation.kind == RelationKind::Spherical {
        let normals = relation.axes.first().and_then(|first| geometry.normals.get(*first..first + 2));
        if let (Some([before, after]), Some(row)) = (normals, model.rows.get_mut(next)) {
            row.d = without(row.d, after.start - before.end);
        }
    } else if let Some(row) = model.rows.get_mut(link) {
        row.a = 0.0;
    }
}

/// A difference that leaves nothing where only rounding would be left.
fn without(value: f64, part: f64) -> f64 {
    let rest = value - part;
    if rest.abs() <= EXACT * value.abs() { 0.0 } else { rest }
}

/// The nearest multiple of half a turn.
fn half_turns(angle: Angle) -> Angle {
    Angle::from_fifteenths(12 * libm::round(angle.value / PI) as i32)
}

/// The multiple of 15 degrees that the angle nearly is.
fn straightened(angle: Angle) -> Angle {
    let nearest = Angle::from_fifteenths(libm::round(angle.value / PI * 12.0) as i32);
    if (angle.value - nearest.value).abs() <= NEARLY_PARALLEL { nearest } else { angle }
}

fn changes(before: &[Row], after: &[Row]) -> Vec<Change> {
    let numbers = |row: &Row| {
        [
            ("theta", row.theta.value),
            ("d", row.d),
            ("a", row.a),
            ("alpha", row.alpha.value),
            ("beta", row.beta.value),
        ]
    };
    let mut changes = Vec::new();
    for (row, (before, after)) in before.iter().zip(after).enumerate() {
        for ((key, from), (_, to)) in numbers(before).into_iter().zip(numbers(after)) {
            if from != to {
                changes.push(Change { row, key, from, to });
            }
        }
    }
    changes
}
