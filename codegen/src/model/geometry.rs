//! What kind of chain it is: which joint axes are parallel, which meet, and what is nearly so.
//!
//! Links are rigid, so how an axis lies to its neighbour is the same at every pose: the angle between the two, the
//! length of their common normal, and its feet on both. Three neighbours meet in one point, at every pose, where both
//! normals have no length and one foot. A slide changes no direction, so that axes with slides between them keep
//! their angle too. Nothing else holds at every pose (Pieper 1968; Craig, Introduction to Robotics, chapter 3).

mod class;
mod nominal;
mod normal;

pub use nominal::{Change, Nominal};
pub use normal::CommonNormal;

use super::chain::{self, Chain, Element};
use super::{JointKind, Model, Problem, Row};
pub(super) use normal::Transform;

/// What is parallel or meets to within this is taken to do so: rad, or a fraction of the reach. It is what rounding
/// leaves of numbers that cancel.
pub const EXACT: f64 = 1e-12;

/// Axes within this angle of being parallel are nearly so (rad). Calibrated arms are off by up to 1e-2; a twist of a
/// degree is meant.
pub const NEARLY_PARALLEL: f64 = 0.015;

/// Axes that pass each other within this fraction of the reach nearly meet.
pub const NEARLY_MEETING: f64 = 0.01;

/// How the joint axes of a chain lie to each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// The axes, base to tip: rows whose theta (or d) varies, coupled held rows included.
    pub axes: Vec<Axis>,
    /// The common normal of each axis and the next; one fewer than there are axes.
    pub normals: Vec<CommonNormal>,
    /// What is special, or nearly so, at every pose, in the order of the first axis.
    pub relations: Vec<Relation>,
}

/// A joint axis at q = 0 (held joints at their values), in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The row that it belongs to.
    pub row: usize,
    /// What the joint does along or about it.
    pub kind: JointKind,
    /// A point of it (m). A slide has a direction only.
    pub point: [f64; 3],
    /// Unit vector.
    pub direction: [f64; 3],
    /// Whether it has no variable of its own: a held row that moves with other joints.
    pub follows: bool,
}

/// A special position of axes to each other, exact or near.
#[derive(Debug, Clone, PartialEq)]
pub struct Relation {
    /// Which one.
    pub kind: RelationKind,
    /// Indices into [`Geometry::axes`].
    pub axes: Vec<usize>,
    /// By how much it is missed: rad for [`RelationKind::Parallel`], m for the others. An exact one may be off by
    /// rounding.
    pub off: f64,
    /// Whether it is missed by no more than rounding, [`EXACT`].
    pub exact: bool,
    /// The numbers of the table that would have to change, with their places; none where it is exact.
    pub numbers: Vec<TableNumber>,
}

/// Kinds of special positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RelationKind {
    /// Two axes of the same direction, or the opposite one. Of revolute and sliding joints alike.
    Parallel,
    /// Two neighbouring revolute axes on one line: the arm has one freedom less than joints.
    Coincident,
    /// Two neighbouring revolute axes through one point.
    Meet,
    /// Three neighbouring revolute axes through one point: a spherical joint.
    Spherical,
}

/// A number of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableNumber {
    /// As the field writes it: `alpha2`, `a4`, `d5`.
    pub name: String,
    /// What it is and where it stands: "link twist of joint 2, table line 31".
    pub note: String,
}

impl Model {
    /// How the joint axes lie to each other.
    pub fn geometry(&self) -> Geometry {
        self.geometry_holding(&[])
    }

    /// The same with some joints held: (index of q, its value in rad or m). Their rows become part of a link, and
    /// rows coupled to them follow.
    pub fn geometry_holding(&self, held: &[(usize, f64)]) -> Geometry {
        let rows: Vec<Row> = self.rows.iter().map(|row| holding(row, held)).collect();
        Geometry::of(&chain::build(self.convention, &rows, &self.base, &self.tool), &rows, self.reach())
    }

    /// The row of the joint that the full pose of a spherical-roll-spherical arm leaves to the caller, where an arm angle can
    /// stand for it: no joint moves with others, and the joint isn't the elbow, which the pose determines.
    pub fn row_for_arm_angle(&self, problem: Option<&Problem>, free: &[usize]) -> Option<usize> {
        let [joint] = *free else { return None };
        let row = *self.joints.get(joint)?;
        let alone = |row: &Row| matches!(row.terms[..], [(_, factor)] if factor.abs() == 1.0);
        let apart = self.rows.iter().filter(|row| !row.terms.is_empty()).all(alone);
        let suits = apart && joint != ELBOW && problem.is_none_or(Problem::is_whole_pose);
        (suits && self.geometry().is_spherical_roll_spherical()).then_some(row)
    }
}

/// The joint between shoulder and wrist of a spherical-roll-spherical arm.
const ELBOW: usize = 3;

/// A row with the terms of held joints put into its value at zero.
fn holding(row: &Row, held: &[(usize, f64)]) -> Row {
    let mut row = row.clone();
    for &(joint, value) in held {
        let added: f64 =
            row.terms.iter().filter(|(term, _)| *term == joint).map(|(_, factor)| factor * value).sum();
        row.terms.retain(|(term, _)| *term != joint);
        match row.kind {
            JointKind::Revolute => row.theta = row.theta.plus(super::Angle::from_radians(added)),
            JointKind::Prismatic => row.d += added,
        }
    }
    row
}

impl Geometry {
    fn of(chain: &Chain, rows: &[Row], reach: f64) -> Self {
        let links: Vec<Transform> = chain.links.iter().map(Transform::of_link).collect();
        let mut axes = Vec::new();
        let mut frame = Transform::identity();
        for (link, joint) in links.iter().zip(&chain.joints) {
            frame = frame.times(link);
            let [direction, point] = [frame.axis(), frame.translation];
            let follows = rows.get(joint.row).is_some_and(|row| row.variable.is_none());
            axes.push(Axis { row: joint.row, kind: joint.kind, point, direction, follows });
            // Where q = 0: what of the joint's value stands in no link.
            if let Some(row) = rows.get(joint.row) {
                frame = frame.times(&match joint.kind {
                    JointKind::Revolute => Transform::turned(row.theta),
                    JointKind::Prismatic => Transform::along(2, row.d),
                });
            }
        }
        let between = links.get(1..links.len().saturating_sub(1)).unwrap_or_default();
        let normals: Vec<CommonNormal> = between.iter().map(CommonNormal::of).collect();
        let mut geometry = Self { axes, normals, relations: Vec::new() };
        geometry.relations = geometry.found(chain, reach);
        geometry
    }

    /// Relations that are exact.
    pub fn exact(&self) -> impl Iterator<Item = &Relation> {
        self.relations.iter().filter(|relation| relation.exact)
    }

    /// Relations that are nearly so.
    pub fn near(&self) -> impl Iterator<Item = &Relation> {
        self.relations.iter().filter(|relation| !relation.exact)
    }

    /// Triples of revolute axes that meet in one point, by their indices.
    pub fn spherical_joints(&self) -> impl Iterator<Item = &[usize]> {
        self.exact()
            .filter(|relation| relation.kind == RelationKind::Spherical)
            .map(|relation| relation.axes.as_slice())
    }

    /// Longest runs of axes that are parallel to each other, by their indices.
    pub fn parallel_runs(&self) -> Vec<Vec<usize>> {
        let mut runs: Vec<Vec<usize>> = Vec::new();
        for relation in self.exact().filter(|relation| relation.kind == RelationKind::Parallel) {
            let [first, second] = relation.axes[..] else { continue };
            match runs.iter_mut().find(|run| run.contains(&first)) {
                Some(run) => run.push(second),
                None => runs.push(vec![first, second]),
            }
        }
        runs
    }

    fn is_revolute(&self, index: usize) -> bool {
        self.axes.get(index).is_some_and(|axis| axis.kind == JointKind::Revolute)
    }

    /// Everything special in the chain.
    fn found(&self, chain: &Chain, reach: f64) -> Vec<Relation> {
        let mut relations = Vec::new();
        for first in 0..self.normals.len() {
            relations.extend(self.neighbours(first, chain, reach));
            relations.extend(self.spherical(first, chain, reach));
            relations.extend(self.across_slides(first, chain));
        }
        relations
    }

    /// Axis `first` and the next one.
    fn neighbours(&self, first: usize, chain: &Chain, reach: f64) -> Vec<Relation> {
        let Some(normal) = self.normals.get(first) else {
            return Vec::new();
        };
        let turning = self.is_revolute(first) && self.is_revolute(first + 1);
        let axes = vec![first, first + 1];
        let mut found = Vec::new();
        let tilt = normal.tilt();
        if tilt <= NEARLY_PARALLEL {
            let exact = tilt <= EXACT;
            let numbers = if exact { Vec::new() } else { numbers(chain, first, is_skew) };
            found.push(Relation {
                kind: RelationKind::Parallel,
                axes: axes.clone(),
                off: tilt,
                exact,
                numbers,
            });
        }
        let off = normal.distance;
        if turning && off <= NEARLY_MEETING * reach {
            let kind = if tilt <= NEARLY_PARALLEL { RelationKind::Coincident } else { RelationKind::Meet };
            let exact = off <= EXACT * reach && (kind == RelationKind::Meet || tilt <= EXACT);
            let limit = NEARLY_MEETING * reach;
            let numbers = if exact {
                Vec::new()
            } else {
                numbers(chain, first, |element| is_short(element, [0, 1], limit))
            };
            found.push(Relation { kind, axes, off, exact, numbers });
        }
        found
    }

    /// Axis `first` and the next two, as a spherical joint.
    fn spherical(&self, first: usize, chain: &Chain, reach: f64) -> Option<Relation> {
        let (before, after) = (self.normals.get(first)?, self.normals.get(first + 1)?);
        let axes: Vec<usize> = (first..first + 3).collect();
        let skew = before.tilt() > NEARLY_PARALLEL && after.tilt() > NEARLY_PARALLEL;
        if !skew || !axes.iter().all(|axis| self.is_revolute(*axis)) {
            return None;
        }
        let between_feet = (after.start - before.end).abs();
        let off = before.distance.max(after.distance).max(between_feet);
        let exact = off <= EXACT * reach;
        let limit = NEARLY_MEETING * reach;
        let numbers = if exact {
            Vec::new()
        } else {
            let short =
                |link: usize, axes| numbers(chain, link, move |element| is_short(element, axes, limit));
            [short(first, [0, 1]), short(first + 1, [0, 1]), short(first + 1, [2, 2])].concat()
        };
        (off <= limit).then_some(Relation { kind: RelationKind::Spherical, axes, off, exact, numbers })
    }

    /// Axis `first` and the first one that is parallel to it with nothing but slides in other directions between.
    fn across_slides(&self, first: usize, chain: &Chain) -> Option<Relation> {
        let of = self.axes.get(first)?;
        let normals = self.normals.get(first..)?;
        if normals.first()?.tilt() <= EXACT {
            return None;
        }
        for (step, pair) in normals.windows(2).enumerate() {
            let middle = first + step + 1;
            if self.is_revolute(middle) {
                return None;
            }
            let tilt = normal::tilt(of.direction, self.axes.get(middle + 1)?.direction);
            if tilt <= NEARLY_PARALLEL && pair.iter().all(|normal| normal.tilt() > EXACT) {
                let exact = tilt <= EXACT;
                let skew = |link| numbers(chain, link, is_skew);
                let numbers = if exact { Vec::new() } else { (first..=middle).flat_map(skew).collect() };
                let axes = vec![first, middle + 1];
                return Some(Relation { kind: RelationKind::Parallel, axes, off: tilt, exact, numbers });
            }
        }
        None
    }
}

/// Numbers of the link after axis `first` that a relation hangs on.
fn numbers(chain: &Chain, first: usize, which: impl Fn(&Element) -> bool) -> Vec<TableNumber> {
    let elements = chain.links.get(first + 1).map_or(&[][..], |link| link.elements.as_slice());
    let named = |element: &Element| match element {
        Element::Translate { name, note, .. }
        | Element::Rotate { name, note, .. }
        | Element::Matrix { name, note, .. } => TableNumber { name: name.clone(), note: note.clone() },
    };
    elements.iter().filter(|element| which(element)).map(named).collect()
}

/// Whether it is a turn by no multiple of 15 degrees.
fn is_skew(element: &Element) -> bool {
    matches!(element, Element::Rotate { angle, .. } if angle.fifteenths.is_none())
}

/// Whether it is a small step along one of these axes.
fn is_short(element: &Element, along: [usize; 2], limit: f64) -> bool {
    matches!(element, Element::Translate { axis, value, .. } if along.contains(axis) && value.abs() <= limit)
}

#[cfg(test)]
mod tests;
