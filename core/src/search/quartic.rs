//! Equations of the second degree in the cosine and sine of one angle: quartics in the tangent of its half.

use super::trigonometric::VAGUE;
use super::{Roots, Search, VANISHING};
use crate::general::Waves;
use crate::{Float, IkError, Step};

/// Four roots, and what two that nearly meet add.
const MAX_ROOTS: usize = 16;

/// A place that was found may be as far from its root as this (rad), where that is alone.
const APART: f64 = 1e-5;

/// Roots that have met are within this (rad) of where they were found: three are told apart down to the cube root of rounding.
const MET: f64 = 1e-3;

/// Places where a derivative is 0 that are as near as this (rad) are one.
const SAME: f64 = 1e-12;

/// Values of squares of which the greatest coefficient is 1 may be 0 up to this.
const NOTHING: f64 = 1e-14;

/// The most steps of Newton's method.
const STEPS: usize = 6;

/// A step this short (rad) is the last one: the next would be its square.
const LAST_STEP: f64 = 1e-9;

/// Roots that are as near as this (rad) are one that was found twice.
const ONE: f64 = 1e-15;

/// Roots of an equation of the fourth degree, or any value where its coefficients vanish. The loop over them is
/// [`Search::next_of_quartic`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuarticRoots<S = f64> {
    list: [S; MAX_ROOTS],
    len: usize,
    next: usize,
    /// Bit i is set where root i is a `-` root.
    minus: u32,
    /// The bit that tells them apart in a [`Branch`](crate::Branch).
    bit: u32,
    /// Where the coefficients vanish.
    any: Roots<S>,
}

impl<S: Float> QuarticRoots<S> {
    pub(super) const fn of(any: Roots<S>) -> Self {
        Self { list: [S::ZERO; MAX_ROOTS], len: 0, next: 0, minus: 0, bit: 0, any }
    }

    fn push(&mut self, root: f64, minus: bool) {
        let root = libm::remainder(root, core::f64::consts::TAU);
        let known = self.list.get(..self.len).unwrap_or(&self.list);
        if known.iter().any(|known| libm::fabs(known.to_f64() - root) <= ONE) {
            return;
        }
        if let Some(place) = self.list.get_mut(self.len) {
            *place = S::from_f64(root);
            self.minus |= u32::from(minus) << self.len;
            self.len += 1;
        }
    }

    /// How many roots there are; any value counts as one.
    pub fn len(&self) -> usize {
        if self.len == 0 { self.any.len() } else { self.len }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<const N: usize, S: Float> Search<'_, N, S> {
    /// The angles x (rad) with (k1 + l1 cos x + m1 sin x)² + (k2 + l2 cos x + m2 sin x)² = n²: four, two or none, and where some have
    /// nearly met that place too. Where the left side rises with x is the `+` root.
    ///
    /// Computed in f64, by bounds on Taylor's expansion and Newton's method.
    pub fn quartic(&mut self, step: Step, forms: [[S; 3]; 2], right: S) -> QuarticRoots<S> {
        self.squares(step, forms, right, None)
    }

    /// The same where the first sum is a coordinate of a vector that keeps its length, less a number h: with the vector's other two
    /// coordinates, its length r, n + h - r and n - h - r.
    ///
    /// Where two roots nearly meet, n² less the square of the first sum loses all digits. Where one of the last two numbers is 0, the
    /// squares of the other coordinates know them.
    pub fn quartic_unit(
        &mut self,
        step: Step,
        forms: [[S; 3]; 2],
        right: S,
        others: [[S; 3]; 2],
        length: [S; 3],
    ) -> QuarticRoots<S> {
        self.squares(step, forms, right, Some((others, length)))
    }

    pub(super) fn squares(
        &mut self,
        step: Step,
        forms: [[S; 3]; 2],
        right: S,
        unit: Option<([[S; 3]; 2], [S; 3])>,
    ) -> QuarticRoots<S> {
        let scale = self.begin(step);
        let all = || forms.as_flattened().iter().chain([&right]);
        if !all().all(|x| x.is_finite()) {
            return QuarticRoots::of(self.not_finite(step));
        }
        let size = all().fold(S::ZERO, |size, x| size.max(x.abs()));
        if size <= scale.vanishing {
            return QuarticRoots::of(self.degenerate(step, size, &scale));
        }
        let squares = Squares::of(forms, right, unit, size);
        let harmonics = squares.harmonics();
        let [[c, _], varying @ ..] = harmonics;
        let varying = varying.as_flattened().iter().fold(0.0, |most, x| libm::fabs(*x).max(most));
        if varying <= VANISHING * f64::EPSILON {
            return QuarticRoots::of(self.degenerate(step, S::from_f64(libm::fabs(c)) * size, &scale));
        }
        let largest = varying.max(libm::fabs(c));
        let waves = Waves::quadratic(harmonics.map(|pair| pair.map(|x| x / largest)));
        let found = waves.roots();
        let mut roots = QuarticRoots { bit: step.sign_bit(), ..QuarticRoots::of(Roots::NONE) };
        let mut still = Still::default();
        for place in found.candidates().chain(found.unlikely().iter().copied()) {
            squares.about(place, &mut still, |root, slope| roots.push(root, slope < 0.0));
        }
        let near = still.len > 0;
        self.doubtful |= near || found.is_doubtful() || !found.unlikely().is_empty();
        if near || varying <= VAGUE * f64::SQRT_EPSILON {
            self.vague_steps |= step.bit();
        }
        if roots.is_empty() {
            let excess = S::from_f64(waves.miss(&found));
            let _ = self.fail_step(step, excess, IkError::Unreachable { step, excess });
        }
        roots
    }

    /// The same of a nearly special arm, for which left and right side may differ by so much more or less, with what the roots may be
    /// off by (rad). `None` where two of them may be one, or none two.
    pub(super) fn quartic_off_by(
        &mut self,
        step: Step,
        forms: [[S; 3]; 2],
        right: S,
        unit: Option<([[S; 3]; 2], [S; 3])>,
        off: S,
    ) -> Option<(QuarticRoots<S>, S)> {
        let all = forms.as_flattened().iter().chain([&right]);
        let size = all.fold(S::ZERO, |size, x| size.max(x.abs()));
        let squares = Squares::of(forms, right, unit, size);
        let harmonics = squares.harmonics();
        let largest = harmonics.as_flattened().iter().fold(0.0, |most, x| libm::fabs(*x).max(most));
        let off = (off / size / size).to_f64();
        // Not where one is no number, either.
        if !(off < largest && largest < f64::INFINITY) {
            return None;
        }
        let waves = Waves::quadratic_off_by(harmonics.map(|pair| pair.map(|x| x / largest)), off / largest);
        let found = waves.roots();
        if found.is_doubtful() || !found.unlikely().is_empty() {
            return None;
        }
        let mut roots = QuarticRoots { bit: step.sign_bit(), ..QuarticRoots::of(Roots::NONE) };
        let mut most = 0.0;
        for place in found.candidates() {
            let root = squares.refined(place, APART);
            let [_, slope, ..] = squares.at(root);
            most = f64::max(most, off / libm::fabs(slope));
            roots.push(root, slope < 0.0);
        }
        if roots.is_empty() {
            let excess = S::from_f64(waves.miss(&found));
            let _ = self.fail_step(step, excess, IkError::Unreachable { step, excess });
        }
        Some((roots, S::from_f64(most)))
    }

    /// The next root (rad) to go on with, with its sine and cosine.
    pub fn next_of_quartic(&mut self, roots: &mut QuarticRoots<S>) -> Option<(S, S, S)> {
        if roots.len == 0 {
            return self.next_angle(&mut roots.any);
        }
        let angle = *roots.list.get(..roots.len)?.get(roots.next)?;
        let minus = roots.minus >> roots.next & 1 == 1;
        self.branch = if minus { self.branch | roots.bit } else { self.branch & !roots.bit };
        roots.next += 1;
        let (sin, cos) = angle.sin_cos();
        Some((angle, sin, cos))
    }
}

/// f(x) = (k1 + l1 cos x + m1 sin x)² + (k2 + l2 cos x + m2 sin x)² - n²
#[derive(Debug, Clone, Copy)]
struct Squares {
    forms: [[f64; 3]; 2],
    right: f64,
    /// See [`Search::quartic_unit`].
    unit: Option<([[f64; 3]; 2], [f64; 3])>,
}

impl Squares {
    /// With all numbers divided by the size of the greatest.
    fn of<S: Float>(forms: [[S; 3]; 2], right: S, unit: Option<([[S; 3]; 2], [S; 3])>, size: S) -> Self {
        let of_size = |form: [S; 3]| form.map(|x| (x / size).to_f64());
        Self {
            forms: forms.map(of_size),
            right: (right / size).to_f64(),
            unit: unit.map(|(others, length)| (others.map(of_size), of_size(length))),
        }
    }

    /// f(x) = Re sum of (a + i b)_j exp(i j x)
    fn harmonics(&self) -> [[f64; 2]; 3] {
        let mut harmonics = [[-self.right * self.right, 0.0], [0.0; 2], [0.0; 2]];
        for [k, l, m] in self.forms {
            let squared = [
                [k * k + f64::midpoint(l * l, m * m), 0.0],
                [2.0 * k * l, -2.0 * k * m],
                [(l - m) * (l + m) / 2.0, -(l * m)],
            ];
            for (entry, part) in harmonics.as_flattened_mut().iter_mut().zip(squared.as_flattened()) {
                *entry += part;
            }
        }
        harmonics
    }

    /// Value and three derivatives.
    fn at(&self, x: f64) -> [f64; 4] {
        let (sin, cos) = Float::sin_cos(x);
        let mut sum = [-self.right * self.right, 0.0, 0.0, 0.0];
        for [k, l, m] in self.forms {
            let (turned, slope) = (l * cos + m * sin, m * cos - l * sin);
            let value = k + turned;
            sum[0] += value * value;
            sum[1] += 2.0 * value * slope;
            sum[2] += 2.0 * (slope * slope - value * turned);
            sum[3] -= 2.0 * slope * (3.0 * turned + value);
        }
        if let Some((others, [r, plus, minus])) = self.unit {
            let at = |[k, l, m]: [f64; 3]| k + l * cos + m * sin;
            let [along, across] = self.forms.map(at);
            let [one, other] = others.map(at);
            // r less the coordinate, and r plus it: the smaller one from the other.
            let along = along + (plus - minus) / 2.0;
            let beside = one * one + other * other;
            let [less, more] = if along * r > 0.0 {
                [beside / (r + along), r + along]
            } else {
                [r - along, beside / (r - along)]
            };
            sum[0] = across * across - (less + plus) * (more + minus);
        }
        sum
    }

    /// The roots about a place that is nearly one, and where two or three of them can't be told apart, one for all.
    ///
    /// Where a derivative is 0, its place knows all its digits, and so do the other derivatives there: of two roots that nearly meet,
    /// the first one's, of three, the second one's.
    fn about(&self, place: f64, known: &mut Still, mut root: impl FnMut(f64, f64)) {
        let [value, slope, bend, third] = self.at(place);
        if libm::fabs(slope) > MET * libm::fabs(bend) && libm::fabs(bend) > MET * libm::fabs(third) {
            let step = value / slope;
            let alone = if libm::fabs(step) <= LAST_STEP { place - step } else { self.refined(place, APART) };
            return root(alone, slope);
        }
        self.about_meeting(place, known, |x| root(x, self.at(x)[1]));
    }

    #[cold]
    #[inline(never)]
    fn about_meeting(&self, place: f64, known: &mut Still, mut found: impl FnMut(f64)) {
        let [vertex, bend] = [1, 2].map(|derivative| self.still(place, derivative));
        if vertex.is_none() && bend.is_none() {
            found(self.refined(place, APART));
        }
        let is_nothing = |x: &f64| libm::fabs(self.at(*x)[0]) <= NOTHING;
        if let Some(vertex) = vertex.filter(|vertex| known.is_new(*vertex)) {
            let [value, _, bend, _] = self.at(vertex);
            let away = libm::sqrt(-2.0 * value / bend);
            if away > 0.0 {
                found(self.refined(vertex - away, away / 2.0));
                found(self.refined(vertex + away, away / 2.0));
            }
            Some(vertex).filter(is_nothing).map(&mut found);
        }
        if let Some(bend) = bend.filter(|bend| known.is_new(*bend)) {
            let [value, slope, _, third] = self.at(bend);
            let (p, q) = (6.0 * slope / third, 6.0 * value / third);
            let near = |away: &f64| libm::fabs(*away) <= MET;
            for away in cubic(p, q).into_iter().flatten().filter(near) {
                found(self.refined(bend + away, libm::fabs(away) / 2.0));
            }
            let double = libm::copysign(libm::sqrt(-p / 3.0), q);
            let met = [0.0, double].into_iter().filter(near).map(|away| bend + away);
            met.filter(is_nothing).for_each(&mut found);
        }
        if vertex.is_some() || bend.is_some() {
            let end = self.end(place).filter(|end| known.is_new(*end));
            end.filter(is_nothing).map(found);
        }
    }

    /// The place next to this one where a derivative is 0.
    fn still(&self, from: f64, derivative: usize) -> Option<f64> {
        newton(from, MET, |x| {
            let at = self.at(x);
            Some(at.get(derivative)? / at.get(derivative + 1)?)
        })
    }

    /// The place next to this one where the vector's coordinate comes nearest to its end: the axis that is that vector is parallel to
    /// one that it turns about, if it can be, and not only as far as rounding tells.
    fn end(&self, from: f64) -> Option<f64> {
        let (others, _) = self.unit?;
        newton(from, MET, |x| {
            let (sin, cos) = Float::sin_cos(x);
            let (mut slope, mut square) = (0.0, 0.0);
            for [k, l, m] in others {
                let turned = m * cos - l * sin;
                slope += (k + l * cos + m * sin) * turned;
                square += turned * turned;
            }
            Some(slope / square)
        })
    }

    /// A root to its last digits, if it is no farther away than this.
    fn refined(&self, from: f64, spare: f64) -> f64 {
        let root = newton(from, spare, |x| {
            let [value, slope, ..] = self.at(x);
            Some(value / slope)
        });
        root.unwrap_or(from)
    }
}

/// Newton's method, with what a place is off by; `None` where it leads farther away than this.
fn newton(from: f64, spare: f64, off: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let mut x = from;
    for _ in 0..STEPS {
        let step = off(x)?;
        x -= step;
        let within = libm::fabs(x - from) <= spare;
        if !within {
            return None;
        }
        if libm::fabs(step) <= ONE {
            break;
        }
    }
    Some(x)
}

/// Where derivatives are 0, each once.
#[derive(Debug, Default)]
struct Still {
    list: [f64; MAX_ROOTS],
    len: usize,
}

impl Still {
    fn is_new(&mut self, x: f64) -> bool {
        let known = self.list.get(..self.len).unwrap_or(&self.list);
        if known.iter().any(|known| libm::fabs(known - x) <= SAME) {
            return false;
        }
        if let Some(place) = self.list.get_mut(self.len) {
            *place = x;
            self.len += 1;
        }
        true
    }
}

/// The real roots of x³ + p x + q (Viète's and Cardano's).
fn cubic(p: f64, q: f64) -> [Option<f64>; 3] {
    let (third, half) = (p / 3.0, q / 2.0);
    let discriminant = half * half + third * third * third;
    if discriminant > 0.0 {
        let sum = libm::cbrt(-half - libm::copysign(libm::sqrt(discriminant), half));
        return [Some(sum - third / sum), None, None];
    }
    let radius = libm::sqrt(-third);
    if radius == 0.0 {
        return [Some(0.0), None, None];
    }
    let angle = libm::acos((-half / (radius * radius * radius)).clamp(-1.0, 1.0)) / 3.0;
    let turned = |turn: f64| Some(2.0 * radius * libm::cos(angle + turn * core::f64::consts::TAU / 3.0));
    [turned(0.0), turned(1.0), turned(2.0)]
}
