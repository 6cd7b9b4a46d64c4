//! How far the arm reaches: the length that tolerances and errors are relative to.

use super::chain::Element;
use super::{JointKind, Model};

/// What a robot without any length is taken to reach (m), so that nothing is divided by 0.
const NO_LENGTH: f64 = 1.0;

impl Model {
    /// An upper bound of the distance of the tool point from the base frame (after `[base]`), in m: all links
    /// stretched out in one line, sliding joints at their limits.
    pub fn reach(&self) -> f64 {
        let chain = self.chain();
        let mut reach = 0.0;
        for (index, link) in chain.links.iter().enumerate() {
            // `[base]` only says where the arm stands.
            let base = link.frames.iter().find(|frame| index == 0 && frame.row.is_none());
            let arm = link.elements.get(base.map_or(0, |base| base.after)..).unwrap_or_default();
            reach += stretched(arm);
        }
        let slides = self.rows.iter().filter(|row| row.kind == JointKind::Prismatic && !row.terms.is_empty());
        reach += slides.map(|row| self.greatest_offset(row.d, &row.terms)).sum::<f64>();
        if reach > 0.0 { reach } else { NO_LENGTH }
    }

    /// The greatest |d| (m) of a row with this offset and these terms, joints without limits at 0.
    fn greatest_offset(&self, offset: f64, terms: &[(usize, f64)]) -> f64 {
        let (mut least, mut greatest) = (offset, offset);
        for (joint, factor) in terms {
            let row = self.joints.get(*joint).and_then(|row| self.rows.get(*row));
            let Some(limits) = row.and_then(|row| row.limits) else {
                continue;
            };
            let (one, other) = (factor * limits.min, factor * limits.max);
            least += one.min(other);
            greatest += one.max(other);
        }
        least.abs().max(greatest.abs())
    }
}

/// The length of a link whose rotations are turned so that its translations line up (m).
fn stretched(elements: &[Element]) -> f64 {
    let rigid = elements.split(|element| !matches!(element, Element::Translate { .. }));
    let length = |translations: &[Element]| {
        let mut sum = [0.0; 3];
        for element in translations {
            if let Element::Translate { axis, value, .. } = element
                && let Some(slot) = sum.get_mut(*axis)
            {
                *slot += value;
            }
        }
        let [x, y, z] = sum;
        libm::hypot(libm::hypot(x, y), z)
    };
    rigid.map(length).sum()
}
