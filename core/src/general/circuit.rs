//! The closed chain of an arm and its target, read from one of its joints.

use super::line::{Line, Motion, PRODUCTS, Products, TURNED, UNTURNED};
use super::pair::Pair;
use super::posture::{Frames, Values};
use super::triple::Triple;
use super::wide::{Wide, cross, dot};
use super::{Chart, JOINTS};
use crate::Frame;

/// The closed chain J0 L0 J1 L1 ... J5 L5 = 1, cut at the joint whose value is not needed first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circuit {
    /// What stands after each joint.
    pub(super) links: [Frame; JOINTS],
    /// Which joints slide.
    pub(super) prismatic: [bool; JOINTS],
    /// Which joint of the arm each one is.
    pub(super) order: [usize; JOINTS],
    /// Whether the chain is run through from the tip: joints turn the other way then.
    backward: bool,
}

impl Circuit {
    /// From the links that stand after each joint of the arm, the last of which closes the chain.
    pub(super) fn new(links: &[Frame; JOINTS], prismatic: [bool; JOINTS], chart: Chart) -> Self {
        let mut circuit = Self {
            links: [Frame::IDENTITY; JOINTS],
            prismatic: [false; JOINTS],
            order: [0; JOINTS],
            backward: chart.backward,
        };
        let first = usize::from(chart.dropped) % JOINTS;
        let places = circuit.links.iter_mut().zip(&mut circuit.prismatic).zip(&mut circuit.order);
        for (k, ((link, slides), joint)) in places.enumerate() {
            *joint = if chart.backward { first + JOINTS - k } else { first + k } % JOINTS;
            // Backwards, what stands after a joint is the inverse of what stood before it.
            let after = if chart.backward { (*joint + JOINTS - 1) % JOINTS } else { *joint };
            *slides = prismatic.get(*joint).copied().unwrap_or(false);
            let frame = links.get(after).copied().unwrap_or(Frame::IDENTITY);
            *link = if chart.backward { frame.inverse() } else { frame };
        }
        circuit
    }

    pub(super) fn slides(&self, place: usize) -> bool {
        self.prismatic.get(place).copied().unwrap_or(false)
    }

    /// What joints 3, 4 and 5 do to the first joint's axis.
    #[inline(never)]
    pub(super) fn triple(&self, chart: Chart) -> Triple {
        let ([_, _, links @ ..], [_, _, _, slides @ ..]) = (self.links, self.prismatic);
        Triple::new(&links, slides, chart)
    }

    fn sign(&self) -> f64 {
        if self.backward { -1.0 } else { 1.0 }
    }

    /// The products of the first joint's axis as joints 1 and 2 see it, at three values of each.
    pub(super) fn pair(&self) -> [[Products; 3]; 3] {
        let [first, between, ..] = self.links;
        let axis = Line::AXIS.moved(&first.inverse());
        let between = between.inverse();
        thirds(self.slides(1)).map(|one| {
            let seen = axis.by(&one.reversed()).moved(&between);
            thirds(self.slides(2)).map(|two| seen.by(&two.reversed()).products())
        })
    }

    /// The same for several candidates at once, and where the values are of use: not where there is but one equation for
    /// joint 1. Joints 1 and 2 of the circuit must be revolute.
    pub(super) fn rest_together(&self, pair: &Pair, known: &[Values; 3]) -> [Values; JOINTS] {
        let [first, between, near, third, fourth, fifth] = &self.links;
        let mut far = Frames::all(near);
        for ((place, values), link) in (3..).zip(known).zip([third, fourth, fifth]) {
            far = far.moved(values, self.slides(place)).compose(link);
        }
        let products = products_together(far.translation, far.z_axis());
        let (mut ac, mut bc) = (Wide::ZERO, Wide::ZERO);
        let ([at, cosines, sines], [aa, ab, bb]) = (&pair.parts, pair.normal);
        for k in UNTURNED {
            let c = products[k] - Wide::all(at[k]);
            ac += c * cosines[k];
            bc += c * sines[k];
        }
        let one = Values::towards(ac * bb - bc * ab, bc * aa - ac * ab);
        let (cos, sin) = one.direction();
        let (mut x, mut y) = (Wide::ZERO, Wide::ZERO);
        let mut seen = [Wide::ZERO; PRODUCTS];
        for (k, place) in seen.iter_mut().enumerate() {
            *place = Wide::all(at[k]) + cos * cosines[k] + sin * sines[k];
        }
        let pick = |list: &[Wide; PRODUCTS], k: usize| list.get(k).copied().unwrap_or(Wide::ZERO);
        for [k, l] in TURNED {
            let (a, b, c, d) = (pick(&products, k), pick(&products, l), pick(&seen, k), pick(&seen, l));
            x += a * c + b * d;
            y += a * d - b * c;
        }
        let two = Values::towards(x, y);
        // What is left is the inverse of the joint that was dropped: the first row of the chain's rotation says it.
        let [row, ..] = Frames::all(first).moved(&one, false).compose(between).moved(&two, false).rotation;
        let [[a, b, _], [d, e, _], [g, h, _]] = far.rotation;
        let dropped = Values::towards(dot(row, [a, d, g]), dot(row, [b, e, h]));
        let mut values = [Values::ZERO; JOINTS];
        let [three, four, five] = *known;
        for (joint, value) in self.order.iter().zip([dropped, one, two, three, four, five]) {
            if let Some(place) = values.get_mut(*joint) {
                *place = if self.backward { value.reversed() } else { value };
            }
        }
        values
    }

    /// The values of the arm's joints where those of joints 3, 4 and 5 of the circuit, in its own sense, are known: two
    /// candidates at most.
    pub(super) fn rest(&self, known: [f64; 3]) -> [Option<[f64; JOINTS]>; 2] {
        let [first, between, near, third, fourth, fifth] = self.links;
        let [x, y, z] = known;
        let step = |place: usize, value: f64, link: &Frame| {
            Motion::new(self.slides(place), value).frame().compose(link)
        };
        let far =
            near.compose(&step(3, x, &third)).compose(&step(4, y, &fourth)).compose(&step(5, z, &fifth));
        let line = Line::AXIS.moved(&far);
        let wanted = line.invariants(self.slides(2));
        let axis = Line::AXIS.moved(&first.inverse());
        let back = between.inverse();
        let seen = |motion: &Motion| axis.by(&motion.reversed()).moved(&back);
        let [at0, at1, at2] = thirds(self.slides(1)).map(|motion| seen(&motion).invariants(self.slides(2)));
        fit(self.slides(1), [&at0, &at1, &at2], &wanted).map(|one| {
            let one = one?;
            let motion = Motion::new(self.slides(1), one);
            let two = line.turn_to(&seen(&motion), self.slides(2));
            let pair =
                first.compose(&step(1, one, &between)).compose(&Motion::new(self.slides(2), two).frame());
            // What is left is the inverse of the joint that was dropped.
            let left = pair.compose(&far).inverse();
            let [_, _, along] = left.translation;
            let [[c, ..], [s, ..], _] = left.rotation;
            let dropped = if self.slides(0) { along } else { libm::atan2(s, c) };
            let mut q = [0.0; JOINTS];
            for (joint, value) in self.order.iter().zip([dropped, one, two, x, y, z]) {
                if let Some(place) = q.get_mut(*joint) {
                    *place = self.sign() * value;
                }
            }
            Some(q)
        })
    }
}

/// Power products of lines through points along directions.
#[inline]
fn products_together(p: [Wide; 3], l: [Wide; 3]) -> [Wide; PRODUCTS] {
    let (pp, pl) = (dot(p, p), dot(p, l));
    let [n1, n2, n3] = cross(p, l);
    let [p1, p2, p3] = p;
    let [l1, l2, l3] = l;
    let last = |l: Wide, p: Wide| pp * l - (pl + pl) * p;
    [p1, p2, p3, l1, l2, l3, pp, pl, n1, n2, n3, last(l1, p1), last(l2, p2), last(l3, p3)]
}

/// Three values of a joint, as far apart as can be.
pub(super) fn thirds(prismatic: bool) -> [Motion; 3] {
    if prismatic {
        return [0.0, 1.0, -1.0].map(|value| Motion::new(true, value));
    }
    [Motion::turned(1.0, 0.0), Motion::turned(-0.5, SIN_THIRD), Motion::turned(-0.5, -SIN_THIRD)]
}

/// The sine of a third of a turn.
const SIN_THIRD: f64 = 0.866_025_403_784_438_6;

/// The joint value at which six quantities, given at its three values of [`thirds`], are nearest to what is wanted.
fn fit(prismatic: bool, [at0, at1, at2]: [&[f64; 6]; 3], wanted: &[f64; 6]) -> [Option<f64>; 2] {
    let (mut aa, mut ab, mut bb, mut ac, mut bc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (((f0, f1), f2), w) in at0.iter().zip(at1).zip(at2).zip(wanted) {
        let (a, b, constant) = if prismatic {
            ((f1 - f2) / 2.0, (f1 + f2) / 2.0 - f0, *f0)
        } else {
            let mean = (f0 + f1 + f2) / 3.0;
            (f0 - mean, (f1 - f2) / 1.732_050_807_568_877_2, mean)
        };
        let c = w - constant;
        aa += a * a;
        ab += a * b;
        bb += b * b;
        ac += a * c;
        bc += b * c;
    }
    let determinant = aa * bb - ab * ab;
    let trace = aa + bb;
    if determinant > ONE_ROW * trace * trace {
        let (first, second) = ((ac * bb - bc * ab) / determinant, (bc * aa - ac * ab) / determinant);
        let value = if prismatic { first } else { libm::atan2(second, first) };
        return [Some(value), None];
    }
    if trace <= 0.0 {
        return [Some(0.0), None];
    }
    // One equation only: a u + b v = c along the principal direction.
    let (a, b) =
        if aa >= bb { (libm::sqrt(aa), ab / libm::sqrt(aa)) } else { (ab / libm::sqrt(bb), libm::sqrt(bb)) };
    let c = if aa >= bb { ac / libm::sqrt(aa) } else { bc / libm::sqrt(bb) };
    if prismatic {
        return roots_of_square(b, a, -c);
    }
    let size = libm::sqrt(a * a + b * b);
    let ratio = if c > size {
        1.0
    } else if c < -size {
        -1.0
    } else {
        c / size
    };
    let (middle, half) = (libm::atan2(b, a), libm::acos(ratio));
    [Some(middle + half), Some(middle - half)]
}

/// Below this share of its size, the determinant of the normal equations says that there is but one equation.
pub(super) const ONE_ROW: f64 = 1e-14;

/// The roots of a x² + b x + c, or the place of the vertex.
fn roots_of_square(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    if libm::fabs(a) <= 1e-12 * libm::fabs(b) {
        return [Some(-c / b), None];
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant <= 0.0 {
        return [Some(-b / (2.0 * a)), None];
    }
    let root = libm::sqrt(discriminant);
    let greater = if b < 0.0 { root - b } else { -(root + b) };
    [Some(greater / (2.0 * a)), Some(2.0 * c / greater)]
}
