//! The chain seen from the tool: the base in the tool frame.

use super::Angle;
use super::chain::{Chain, Element, Link};

impl Chain {
    /// The chain from the tool to the base, the inverse of this one, with the same joint variables.
    ///
    /// With Y = Ry(pi), which turns z round, Y Rz(-theta) Y = Rz(theta) and Y Tz(-d) Y = Tz(d): so every joint stays what it
    /// is, if the links between are Y F^-1 Y. Of these, too, all steps along and about x and z keep their numbers and only
    /// change their order. Frames of the table stand in none of them.
    pub(crate) fn reversed(&self) -> Self {
        let half_turn = || Element::Rotate {
            axis: 1,
            angle: Angle { value: core::f64::consts::PI, fifteenths: Some(12) },
            name: "half_turn".to_owned(),
            note: String::new(),
        };
        let mut links: Vec<Link> = self.links.iter().rev().map(reversed).collect();
        if let Some(first) = links.first_mut() {
            first.elements.insert(0, half_turn());
        }
        if let Some(last) = links.last_mut() {
            last.elements.push(half_turn());
        }
        Chain { joints: self.joints.iter().rev().copied().collect(), links }
    }
}

/// Y F^-1 Y
fn reversed(link: &Link) -> Link {
    let elements: Vec<Element> = link.elements.iter().rev().map(turned).collect();
    Link { flange: elements.len(), elements, frames: Vec::new() }
}

fn turned(element: &Element) -> Element {
    let mut element = element.clone();
    match &mut element {
        Element::Translate { axis: 1, value, .. } => *value = -*value,
        Element::Rotate { axis: 1, angle, .. } => {
            *angle =
                Angle { value: -angle.value, fifteenths: angle.fifteenths.map(|fifteenths| -fifteenths) };
        }
        Element::Matrix { rows: [[_, b, c], [d, _, f], [g, h, _]], .. } => {
            // The transpose, with the signs of Y on both sides.
            (*b, *d) = (-*d, -*b);
            (*f, *h) = (-*h, -*f);
            std::mem::swap(c, g);
        }
        Element::Translate { .. } | Element::Rotate { .. } => {}
    }
    element
}
