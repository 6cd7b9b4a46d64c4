//! The two joints of the circuit that are eliminated first.

use super::circuit::{Circuit, ONE_ROW, thirds};
use super::line::{Line, PRODUCTS, Products, TURNED, UNTURNED};
use super::resultant::LEFT;

/// A determinant this small beside the lengths of its columns costs too many digits: a search for pivots may do better.
const WEAK: f64 = 1e-6;

/// The products of the first joint's axis as joint 2 will turn them, over joint 1; both are revolute.
pub(super) struct Pair {
    /// Constant part, and those with cosine and sine of joint 1.
    pub(super) parts: [Products; 3],
    /// Normal equations of the products that joint 2 leaves alone, for cosine and sine of joint 1: the squares of either
    /// and the mixed one between them.
    pub(super) normal: [f64; 3],
}

/// Sums of products in which two joints do not occur: a row a product, a column a sum.
pub(super) type Sums = [[f64; LEFT]; PRODUCTS];

impl Pair {
    /// `None` where the products that joint 2 leaves alone are but one equation for joint 1, and where one of the two
    /// joints slides.
    pub(super) fn new(circuit: &Circuit) -> Option<Self> {
        if circuit.slides(0) || circuit.slides(1) || circuit.slides(2) {
            return None;
        }
        let [first, between, ..] = circuit.links;
        let axis = Line::AXIS.moved(&first.inverse());
        let between = between.inverse();
        let [f0, f1, f2] = thirds(false).map(|one| axis.by(&one.reversed()).moved(&between).products());
        let mut parts = [[0.0; PRODUCTS]; 3];
        let [mean, cosines, sines] = &mut parts;
        for k in 0..PRODUCTS {
            mean[k] = (f0[k] + f1[k] + f2[k]) * (1.0 / 3.0);
            cosines[k] = f0[k] - mean[k];
            sines[k] = (f1[k] - f2[k]) * (1.0 / 1.732_050_807_568_877_2);
        }
        let (mut aa, mut ab, mut bb) = (0.0, 0.0, 0.0);
        for k in UNTURNED {
            aa += cosines[k] * cosines[k];
            ab += cosines[k] * sines[k];
            bb += sines[k] * sines[k];
        }
        (aa * bb - ab * ab > ONE_ROW * (aa + bb) * (aa + bb)).then_some(Self { parts, normal: [aa, ab, bb] })
    }

    /// The sums of the products, less their constant parts where joint 2 leaves them alone, in which the two joints do not
    /// occur. `None` where they are nearly dependent.
    ///
    /// Of the six products that joint 2 leaves alone, two eliminate joint 1. It turns the other eight as four complex
    /// numbers, all by the same angle: of these, three complex equations eliminate joint 1 and leave one.
    pub(super) fn sums(&self) -> Option<Sums> {
        let mut sums = [[0.0; LEFT]; PRODUCTS];
        let [_, cosines, sines] = &self.parts;
        // Complete pivoting on two columns.
        let mut pivot = (0, false);
        let mut greatest = 0.0;
        for (at, k) in UNTURNED.into_iter().enumerate() {
            for (size, swapped) in [(cosines[k].abs(), false), (sines[k].abs(), true)] {
                if size > greatest {
                    (pivot, greatest) = ((at, swapped), size);
                }
            }
        }
        let (first, swapped) = pivot;
        let column = |k: usize| if swapped { [sines[k], cosines[k]] } else { [cosines[k], sines[k]] };
        let [a, b] = column(UNTURNED[first]);
        let rests = UNTURNED.map(|k| {
            let [c, d] = column(k);
            let factor = c / a;
            [factor, d - factor * b]
        });
        let mut second = first;
        let mut next = 0.0;
        for (at, [_, rest]) in rests.iter().enumerate() {
            if at != first && rest.abs() > next {
                (second, next) = (at, rest.abs());
            }
        }
        let [of_second, pivot] = rests[second];
        let mut sum = 0;
        for (at, [of_first, rest]) in rests.into_iter().enumerate() {
            if at == first || at == second || sum >= LEFT {
                continue;
            }
            let factor = rest / pivot;
            sums[UNTURNED[at]][sum] = 1.0;
            sums[UNTURNED[second]][sum] = -factor;
            sums[UNTURNED[first]][sum] = factor * of_second - of_first;
            sum += 1;
        }
        let (weights, strength) = self.complex_sum();
        for ([x, y], [a, b]) in TURNED.into_iter().zip(weights) {
            let [.., real, imaginary] = &mut sums[x];
            (*real, *imaginary) = (a, b);
            let [.., real, imaginary] = &mut sums[y];
            (*real, *imaginary) = (-b, a);
        }
        (next > WEAK * greatest && strength > WEAK).then_some(sums)
    }

    /// Weights of the four complex numbers with which their sum is 0 whatever joint 1 does: the minors of three columns.
    /// Also says how great they are beside the lengths of these columns.
    fn complex_sum(&self) -> ([[f64; 2]; 4], f64) {
        let columns = self.parts.each_ref().map(|part| TURNED.map(|[x, y]| [part[x], part[y]]));
        let [u, v, w] = columns;
        let mul = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
        let sub = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a - c, b - d];
        let add = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a + c, b + d];
        let minor = |i: usize, j: usize| sub(mul(v[i], w[j]), mul(v[j], w[i]));
        let [m01, m02, m03] = [minor(0, 1), minor(0, 2), minor(0, 3)];
        let [m12, m13, m23] = [minor(1, 2), minor(1, 3), minor(2, 3)];
        let three = |[x, a]: [[f64; 2]; 2], [y, b]: [[f64; 2]; 2], [z, c]: [[f64; 2]; 2]| {
            add(sub(mul(x, a), mul(y, b)), mul(z, c))
        };
        let weights = [
            three([u[1], m23], [u[2], m13], [u[3], m12]),
            three([u[0], m23], [u[2], m03], [u[3], m02]).map(|x| -x),
            three([u[0], m13], [u[1], m03], [u[3], m01]),
            three([u[0], m12], [u[1], m02], [u[2], m01]).map(|x| -x),
        ];
        let square = |list: &[[f64; 2]; 4]| list.iter().flatten().fold(0.0, |sum, x| sum + x * x);
        let sizes = columns.iter().fold(1.0, |product, column| product * square(column));
        let scale = 1.0 / libm::sqrt(square(&weights));
        (weights.map(|pair| pair.map(|x| x * scale)), libm::sqrt(square(&weights) / sizes))
    }
}
