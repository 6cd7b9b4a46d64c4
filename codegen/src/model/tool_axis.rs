//! The tool's z axis as the axis behind the last joint's, for targets that leave open how the tool is turned about it.
//!
//! Such a target is met by any turn about that axis, as if there were a joint that nobody asks for. What is behind the last joint
//! then only matters as the step from one axis to the next, and that is written as between joints: by the common normal.

use super::chain::{Element, Link};
use super::geometry::{EXACT, Transform};
use super::{Angle, Chain, Model};
use core::f64::consts::{FRAC_PI_2, PI};

impl Model {
    /// [`Model::chain`] with what is behind the last joint written as Rz(theta) Tz(d) Tx(a) Rx(alpha) Tz(length). The tip is on
    /// the tool's z axis at the tool point, turned about that axis in some way.
    pub(crate) fn chain_to_tool_axis(&self) -> Chain {
        let mut chain = self.chain();
        let last = if chain.joints.is_empty() { None } else { chain.links.last_mut() };
        if let Some(link) = last {
            if let Some(Element::Rotate { axis: 2, .. }) = link.elements.last() {
                link.elements.pop();
            }
            if !is_step(&link.elements) {
                *link = by_common_normal(link, self.reach());
            }
        }
        chain
    }
}

/// Whether elements stand in that order already.
fn is_step(elements: &[Element]) -> bool {
    let along = |element: &Element| matches!(element, Element::Translate { axis: 2, .. });
    let end = elements.iter().rposition(|element| !along(element)).map_or(0, |last| last + 1);
    let place = |element: &Element| match element {
        Element::Rotate { axis: 2, .. } => Some(0),
        Element::Translate { axis: 2, .. } => Some(1),
        Element::Translate { axis: 0, .. } => Some(2),
        Element::Rotate { axis: 0, .. } => Some(3),
        _ => None,
    };
    let places: Option<Vec<u8>> = elements.iter().take(end).map(place).collect();
    places.is_some_and(|places| places.is_sorted())
}

/// What is nothing beside the reach (m) is left out.
fn by_common_normal(link: &Link, reach: f64) -> Link {
    let step = Transform::of_link(link);
    let [zx, zy, zz] = step.axis();
    let [x, y, z] = step.translation;
    let sine = libm::hypot(zx, zy);
    // An angle so near to 0 or half a turn is that one.
    let parallel = Angle::from_radians(libm::atan2(sine, zz)).sin_cos().0 == 0.0;
    let turned = if !parallel {
        libm::atan2(zx, -zy)
    } else if libm::hypot(x, y) <= EXACT * reach {
        0.0
    } else {
        libm::atan2(y, x)
    };
    let twist = libm::atan2(if parallel { 0.0 } else { sine }, zz);
    // The normal may be taken either way round.
    let (theta, alpha) = match turned {
        turned if turned > FRAC_PI_2 => (turned - PI, -twist),
        turned if turned <= -FRAC_PI_2 => (turned + PI, -twist),
        turned => (turned, twist),
    };
    let [theta, alpha] = [theta, alpha].map(Angle::from_radians);
    let (s, c) = theta.sin_cos();
    let length = if parallel { 0.0 } else { (x * s - y * c) / alpha.sin_cos().0 };
    let along = |axis: usize, value: f64, name: &str, what: &str| {
        let (name, note) = (format!("tool_{name}"), format!("{what}, by [tool] and what is fixed before it"));
        (value.abs() > EXACT * reach).then_some(Element::Translate { axis, value, name, note })
    };
    let about = |axis: usize, angle: Angle, name: &str, what: &str| {
        let (name, note) = (format!("tool_{name}"), format!("{what}, by [tool] and what is fixed before it"));
        (!angle.is_zero()).then_some(Element::Rotate { axis, angle, name, note })
    };
    let elements = [
        about(2, theta, "theta", "turn to the common normal of the last joint's axis and the tool's z axis"),
        along(2, z - length * zz, "d", "its foot on the last joint's axis"),
        along(0, x * c + y * s, "a", "length of the common normal"),
        about(0, alpha, "alpha", "angle between these axes"),
        along(2, length, "length", "from the common normal to the tool point"),
    ];
    Link { elements: elements.into_iter().flatten().collect(), ..link.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element(axis: usize, turns: bool, size: f64) -> Element {
        let (name, note) = (String::new(), String::new());
        if turns {
            Element::Rotate { axis, angle: Angle::from_radians(size), name, note }
        } else {
            Element::Translate { axis, value: size, name, note }
        }
    }

    /// Square ones, parallel ones, ones that point back, and any.
    #[test]
    fn the_axis_and_the_point_are_those_of_the_link() {
        let sizes = [0.0, 0.5, -0.25, FRAC_PI_2, -FRAC_PI_2, PI, 1.1, -2.3];
        let mut state = 1_usize;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % 8
        };
        for _ in 0..2000 {
            let drawn = (0..6).map(|place| element(draw() % 3, place % 2 == 0, sizes[draw()]));
            let link = Link { elements: drawn.collect(), ..Link::default() };
            let step = by_common_normal(&link, 1.0);
            assert!(is_step(&step.elements), "{link:?}");
            let (was, is) = (Transform::of_link(&link), Transform::of_link(&step));
            let pairs = was.axis().into_iter().zip(is.axis());
            for (a, b) in pairs.chain(was.translation.into_iter().zip(is.translation)) {
                assert!((a - b).abs() < 1e-10, "{link:?}: {was:?}, {is:?}");
            }
        }
    }
}
