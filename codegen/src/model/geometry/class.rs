//! The class of a chain in the field's words.

use super::super::JointKind;
use super::{Geometry, Relation, RelationKind};
use std::ops::Range;

impl Geometry {
    /// What kind of arm it is: "6R, spherical wrist, axes 2 and 3 parallel". Axes are numbered by their rows, from 1.
    pub fn class(&self) -> String {
        let parts = self.parts();
        let (head, separator) = self.head();
        if parts.is_empty() { head } else { format!("{head}{separator}{}", parts.join(", ")) }
    }

    /// What is nearly so, and by how much: "axes 2 and 3 are 1.0e-4 rad off parallel (alpha2)".
    pub fn near_misses(&self) -> Vec<String> {
        let of_spherical = |relation: &Relation| {
            self.relations.iter().any(|other| {
                other.kind == RelationKind::Spherical
                    && relation.kind == RelationKind::Meet
                    && relation.axes.iter().all(|axis| other.axes.contains(axis))
            })
        };
        self.near()
            .filter(|relation| !of_spherical(relation))
            .map(|relation| self.near_miss(relation))
            .collect()
    }

    fn near_miss(&self, relation: &Relation) -> String {
        let axes = self.named(&relation.axes);
        let off = relation.off;
        let what = match relation.kind {
            RelationKind::Parallel => format!("axes {axes} are {off:.1e} rad off parallel"),
            RelationKind::Coincident => format!("axes {axes} are {off:.1e} m apart, and nearly on one line"),
            RelationKind::Meet => format!("axes {axes} pass each other at {off:.1e} m"),
            RelationKind::Spherical => format!("axes {axes} are {off:.1e} m off meeting in one point"),
        };
        let numbers: Vec<&str> = relation.numbers.iter().map(|number| number.name.as_str()).collect();
        if numbers.is_empty() { what } else { format!("{what} ({})", numbers.join(", ")) }
    }

    /// How many joints of which kind, with the name that such arms have, and what stands before the rest.
    fn head(&self) -> (String, &'static str) {
        let count = self.axes.len();
        let letters: String = self.axes.iter().map(|axis| letter(axis.kind)).collect();
        let revolute = !letters.contains('P');
        let all_parallel = count > 1 && self.parallel_runs().first().is_some_and(|run| run.len() == count);
        let spherical: Vec<&[usize]> = self.spherical_joints().collect();
        let special = !spherical.is_empty() || self.parallel_runs().iter().any(|run| run.len() > 2);
        let head = match count {
            _ if revolute && all_parallel => format!("planar {count}R"),
            4 if all_parallel && self.is_scara(0..count, true) => format!("SCARA ({letters})"),
            4 if self.is_scara(0..count, false) => format!("nearly SCARA ({letters})"),
            5.. if self.is_scara(0..4, false) => format!("SCARA-like ({letters})"),
            7 if revolute && self.is_spherical_roll_spherical() => "7R".to_owned(),
            6 if revolute && !special => return ("general 6R".to_owned(), ": "),
            _ if revolute => format!("{count}R"),
            _ if letters.starts_with("PPP") => format!("gantry ({letters})"),
            _ if letters.starts_with("RPP") => format!("cylindrical ({letters})"),
            _ if letters.starts_with("RRP") && self.is_polar() => format!("polar ({letters})"),
            _ => letters,
        };
        (head, ", ")
    }

    /// Whether these axes are parallel, as far as is asked, and one of them slides.
    fn is_scara(&self, axes: Range<usize>, exactly: bool) -> bool {
        let own = self.axes.get(axes.clone()).unwrap_or_default();
        let slides = own.iter().filter(|axis| axis.kind == JointKind::Prismatic).count();
        slides == 1 && axes.skip(1).all(|next| self.are_parallel(next - 1, exactly))
    }

    /// Whether the first two axes point an arm in two ways, and the second turns the slide that follows.
    fn is_polar(&self) -> bool {
        !self.are_parallel(0, false) && !self.are_parallel(1, false)
    }

    /// Whether an axis and the next one are parallel, exactly or nearly.
    fn are_parallel(&self, first: usize, exactly: bool) -> bool {
        self.relations.iter().any(|relation| {
            matches!(relation.kind, RelationKind::Parallel | RelationKind::Coincident)
                && relation.axes == [first, first + 1]
                && (relation.exact || !exactly)
        })
    }

    /// Shoulder and wrist of a seven-axis arm, with one axis between them.
    pub(super) fn is_spherical_roll_spherical(&self) -> bool {
        let turn = self.axes.iter().all(|axis| axis.kind == JointKind::Revolute);
        turn && self.axes.len() == 7 && self.at_base().is_some() && self.at_tip().is_some()
    }

    fn at_base(&self) -> Option<&[usize]> {
        self.spherical_joints().find(|axes| axes.first() == Some(&0))
    }

    fn at_tip(&self) -> Option<&[usize]> {
        self.spherical_joints().find(|axes| axes.last().is_some_and(|last| last + 1 == self.axes.len()))
    }

    fn parts(&self) -> Vec<String> {
        let mut parts = Vec::new();
        let count = self.axes.len();
        if self.is_spherical_roll_spherical() {
            parts.push("spherical-roll-spherical".to_owned());
        }
        for axes in self.spherical_joints() {
            if self.is_spherical_roll_spherical() {
                continue;
            }
            parts.push(if Some(axes) == self.at_tip() {
                "spherical wrist".to_owned()
            } else if Some(axes) == self.at_base() {
                "spherical shoulder".to_owned()
            } else {
                format!("axes {} meet in one point", self.named(axes))
            });
        }
        for run in self.parallel_runs().iter().filter(|run| run.len() < count || count < 2) {
            parts.push(format!("axes {} parallel", self.named(run)));
        }
        let pairs = |kind: RelationKind| -> Vec<String> {
            let of_spherical = |axes: &[usize]| {
                self.spherical_joints().any(|three| axes.iter().all(|axis| three.contains(axis)))
            };
            let alone =
                self.exact().filter(|relation| relation.kind == kind && !of_spherical(&relation.axes));
            alone.map(|relation| self.named(&relation.axes)).collect()
        };
        for (kind, verb) in [(RelationKind::Coincident, "on one line"), (RelationKind::Meet, "meet")] {
            let pairs = pairs(kind);
            if !pairs.is_empty() {
                parts.push(format!("axes {} {verb}", pairs.join(", ")));
            }
        }
        if parts.is_empty() && count > 1 && self.exact().next().is_none() {
            parts.push("no neighbouring axes parallel or meeting".to_owned());
        }
        let following: Vec<usize> =
            (0..count).filter(|axis| self.axes.get(*axis).is_some_and(|axis| axis.follows)).collect();
        match following.len() {
            0 => {}
            1 => parts.push(format!("axis {} follows other joints", self.named(&following))),
            _ => parts.push(format!("axes {} follow other joints", self.named(&following))),
        }
        parts
    }

    /// "2 and 3", "2, 3 and 4": the rows of these axes, numbered from 1.
    pub fn named(&self, axes: &[usize]) -> String {
        let number = |axis: &usize| self.axes.get(*axis).map_or(0, |axis| axis.row + 1).to_string();
        let numbers: Vec<String> = axes.iter().map(number).collect();
        match numbers.split_last() {
            Some((last, before)) if !before.is_empty() => format!("{} and {last}", before.join(", ")),
            _ => numbers.concat(),
        }
    }
}

fn letter(kind: JointKind) -> char {
    match kind {
        JointKind::Revolute => 'R',
        JointKind::Prismatic => 'P',
    }
}
