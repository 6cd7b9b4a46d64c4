//! Several sets of joint values at once, brought to one pose: by Newton's method where it converges as it should, else by
//! damped steps.

use super::wide::{LANES, Wide, cross, dot, dot_all, solve};
use super::{FOUND, JOINTS, SixJoints};
use crate::Frame;

/// The most steps.
const STEPS: usize = 5;
/// A longer step (rad, reaches) is not one of the quadratic convergence that is hoped for.
const LONGEST: f64 = 0.1;
/// After a step this short (rad, reaches) the pose is met to the last digit: what is left of the error is its square.
const SHORT: f64 = 1e-8;

/// Values of one joint: cosines and sines of turns, or slides (reaches).
#[derive(Debug, Clone, Copy)]
pub(super) struct Values {
    cos: Wide,
    sin: Wide,
    slide: Wide,
}

impl Values {
    pub(super) const ZERO: Self = Self { cos: Wide::ONE, sin: Wide::ZERO, slide: Wide::ZERO };

    /// Turns, by their cosines and sines.
    #[inline]
    pub(super) const fn turned(cos: Wide, sin: Wide) -> Self {
        Self { cos, sin, slide: Wide::ZERO }
    }

    /// Turns in the direction of points.
    #[inline]
    pub(super) fn towards(x: Wide, y: Wide) -> Self {
        let scale = Wide::ONE / (x * x + y * y).sqrt();
        Self::turned(x * scale, y * scale)
    }

    /// Slides.
    #[inline]
    pub(super) const fn slid(slide: Wide) -> Self {
        Self { slide, ..Self::ZERO }
    }

    /// Cosines and sines.
    #[inline]
    pub(super) const fn direction(&self) -> (Wide, Wide) {
        (self.cos, self.sin)
    }

    /// From a number a lane (rad, reaches).
    pub(super) fn new(slides: bool, values: Wide) -> Self {
        if slides {
            return Self::slid(values);
        }
        let mut turned = Self::ZERO;
        for ((cos, sin), value) in turned.cos.0.iter_mut().zip(&mut turned.sin.0).zip(values.0) {
            (*sin, *cos) = crate::Float::sin_cos(value);
        }
        turned
    }

    /// The other way round.
    #[inline]
    pub(super) fn reversed(&self) -> Self {
        Self { cos: self.cos, sin: -self.sin, slide: -self.slide }
    }

    /// Turned further.
    #[inline]
    pub(super) fn turned_by(&self, other: &Self) -> Self {
        Self::turned(self.cos * other.cos - self.sin * other.sin, self.sin * other.cos + self.cos * other.sin)
    }

    /// A small step (rad, reaches) further: to the third order of it, which is as good as exact for steps that become shorter.
    #[inline]
    fn step(&self, slides: bool, by: Wide) -> Self {
        if slides {
            return Self::slid(self.slide + by);
        }
        let half = by * 0.5;
        let scale = Wide::ONE / (Wide::ONE + half * half);
        self.turned_by(&Self::turned((Wide::ONE - half * half) * scale, (half + half) * scale))
    }

    /// As a number (rad, reaches).
    #[inline]
    pub(super) fn value(&self, slides: bool, lane: usize) -> f64 {
        if slides {
            self.slide.lane(lane)
        } else {
            crate::Float::atan2(self.sin.lane(lane), self.cos.lane(lane))
        }
    }
}

/// A frame a lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frames {
    pub(super) rotation: [[Wide; 3]; 3],
    pub(super) translation: [Wide; 3],
}

impl Frames {
    /// The same in all lanes.
    #[inline]
    pub(super) fn all(frame: &Frame) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = frame.rotation;
        let [x, y, z] = frame.translation;
        let row = |a, b, c| [Wide::all(a), Wide::all(b), Wide::all(c)];
        Self { rotation: [row(a, b, c), row(d, e, f), row(g, h, i)], translation: row(x, y, z) }
    }

    /// Moved along or about their z axes.
    #[inline]
    pub(super) fn moved(&self, by: &Values, slides: bool) -> Self {
        let Self { rotation: [[a, b, c], [d, e, f], [g, h, i]], translation: [x, y, z] } = *self;
        if slides {
            let step = by.slide;
            return Self { translation: [x + c * step, y + f * step, z + i * step], ..*self };
        }
        let (t, s) = (by.cos, by.sin);
        Self {
            rotation: [
                [t * a + s * b, t * b - s * a, c],
                [t * d + s * e, t * e - s * d, f],
                [t * g + s * h, t * h - s * g, i],
            ],
            translation: [x, y, z],
        }
    }

    /// With a fixed frame behind each.
    #[inline]
    pub(super) fn compose(&self, frame: &Frame) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = frame.rotation;
        let mut product = *self;
        for (to, row) in product.rotation.iter_mut().zip(self.rotation) {
            *to = [dot_all(row, [a, d, g]), dot_all(row, [b, e, h]), dot_all(row, [c, f, i])];
        }
        for (to, row) in product.translation.iter_mut().zip(self.rotation) {
            *to += dot_all(row, frame.translation);
        }
        product
    }

    /// Directions of their z axes.
    #[inline]
    pub(super) const fn z_axis(&self) -> [Wide; 3] {
        let [[.., x], [.., y], [.., z]] = self.rotation;
        [x, y, z]
    }
}

/// Sets of joint values, and what became of each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Postures {
    values: [Values; JOINTS],
    /// How far every joint has gone (rad, reaches).
    travel: [Wide; JOINTS],
    /// Whether the pose is met.
    met: [bool; LANES],
    /// The determinant of the Jacobian (reaches, rad).
    determinant: Wide,
}

impl Postures {
    const fn new(values: &[Values; JOINTS]) -> Self {
        Self { values: *values, travel: [Wide::ZERO; JOINTS], met: [false; LANES], determinant: Wide::ZERO }
    }

    /// Joint values (rad, reaches), how far they have gone, and the determinant, where the pose is met.
    pub(super) fn solution(
        &self,
        arm: &SixJoints<'_>,
        lane: usize,
    ) -> Option<([f64; JOINTS], [f64; JOINTS], f64)> {
        if !self.met.get(lane).copied().unwrap_or(false) {
            return None;
        }
        let mut q = [0.0; JOINTS];
        for ((q, values), slides) in q.iter_mut().zip(&self.values).zip(arm.prismatic) {
            *q = values.value(slides, lane);
        }
        Some((q, self.travel.map(|travel| travel.lane(lane)), self.determinant.lane(lane)))
    }

    fn step(&mut self, arm: &SixJoints<'_>, steps: &[Wide; JOINTS]) {
        let places = self.values.iter_mut().zip(&mut self.travel);
        for (((values, travel), step), slides) in places.zip(steps).zip(arm.prismatic) {
            *values = values.step(slides, *step);
            *travel += *step;
        }
    }
}

/// The solutions that are found from joint values.
pub(super) fn land(arm: &SixJoints<'_>, target: &Frame, from: &[Values; JOINTS]) -> Postures {
    let postures = newton(arm, target, from);
    if postures.met == [true; LANES] { postures } else { descend(arm, target, from, &postures) }
}

/// Joint values of several places, the last ones again where there are fewer than lanes.
pub(super) fn gathered(arm: &SixJoints<'_>, places: &[[f64; JOINTS]]) -> [Values; JOINTS] {
    let mut lanes = [Wide::ZERO; JOINTS];
    for k in 0..LANES {
        let Some(q) = places.get(k).or(places.last()) else { break };
        lanes.iter_mut().zip(q).for_each(|(lanes, value)| lanes.0[k] = *value);
    }
    let mut values = [Values::ZERO; JOINTS];
    for ((values, lanes), slides) in values.iter_mut().zip(lanes).zip(arm.prismatic) {
        *values = Values::new(slides, lanes);
    }
    values
}

/// The joint values near others at which the tip is at its target, lengths in reaches. Those from which the way is far
/// or leads through singular places do not meet it: there, damped steps may help.
fn newton(arm: &SixJoints<'_>, target: &Frame, from: &[Values; JOINTS]) -> Postures {
    let mut postures = Postures::new(from);
    let mut ended = [false; LANES];
    for _ in 0..STEPS {
        let (mut columns, trace) = system(arm, target, &postures.values);
        let determinant = solve::<JOINTS, JOINTS, { JOINTS + 1 }>(&mut columns);
        let [.., steps] = columns;
        let mut longest = Wide::ZERO;
        for step in &steps {
            // Not a number is longest.
            longest = longest.if_greater(step.abs(), longest, step.abs());
        }
        let mut going = [false; LANES];
        for (lane, going) in going.iter_mut().enumerate() {
            if !ended[lane] {
                // A turn of more than a quarter, which the error doesn't say, or a step that leads away, ends it as well.
                *going = trace.lane(lane) > 1.0 && longest.lane(lane) <= LONGEST;
                postures.met[lane] = *going && longest.lane(lane) <= SHORT;
                ended[lane] = postures.met[lane] || !*going;
            }
        }
        postures.determinant = postures.determinant.with_lanes(determinant, going);
        postures.step(arm, &steps.map(|step| Wide::ZERO.with_lanes(step, going)));
        if ended == [true; LANES] {
            break;
        }
    }
    postures
}

/// Damped steps at most: two or three where the pose is regular.
const DAMPED_STEPS: usize = 40;
/// The square of an error (reaches, rad) that is but rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON * f64::EPSILON;
/// The same where a step didn't make it smaller.
const SMALL: f64 = 4096.0 * f64::EPSILON * f64::EPSILON;
/// What the damping is multiplied by after a step that made the error greater, and divided by after one that didn't.
const DAMPING: f64 = 16.0;
/// A step that made the square of the error greater, by up to this factor, may be one along a valley that bends.
const CLIMB: f64 = 4.0;

/// Where Newton's method didn't meet the target: by damped steps, as `crate::polish` does them.
#[cold]
#[inline(never)]
fn descend(arm: &SixJoints<'_>, target: &Frame, from: &[Values; JOINTS], newton: &Postures) -> Postures {
    let mut here = Postures::new(from);
    let mut at = Errors::new(arm, target, &here.values);
    let (mut best, mut least) = (here, at);
    let mut damping = Wide::ONE;
    let mut done = newton.met;
    let mut climbed = [false; LANES];
    for _ in 0..DAMPED_STEPS {
        let diagonal = (damping * at.cost).sqrt();
        let mut columns = [[Wide::ZERO; 2 * JOINTS]; JOINTS + 1];
        for (k, (column, from)) in columns.iter_mut().zip(&at.columns).enumerate() {
            column.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
            if let Some(place) = column.get_mut(JOINTS + k).filter(|_| k < JOINTS) {
                *place = diagonal;
            }
        }
        solve::<{ 2 * JOINTS }, JOINTS, { JOINTS + 1 }>(&mut columns);
        let [.., [a, b, c, d, e, f, ..]] = columns;
        here.step(arm, &[a, b, c, d, e, f]);
        at = Errors::new(arm, target, &here.values);
        let (mut better, mut back) = ([false; LANES], [false; LANES]);
        for lane in 0..LANES {
            let (old, new) = (least.cost.lane(lane), at.cost.lane(lane));
            better[lane] = !done[lane] && new < old;
            // Of two steps it is the second that counts, where the first climbs by little.
            let climbs = !better[lane] && !climbed[lane] && new < CLIMB * old;
            back[lane] = !better[lane] && !climbs;
            damping.0[lane] *= match (better[lane], climbed[lane]) {
                (true, false) => 1.0 / DAMPING,
                (false, _) if back[lane] => DAMPING,
                _ => 1.0,
            };
            climbed[lane] = climbs;
            done[lane] |= new <= ROUNDING || (!better[lane] && old <= SMALL);
        }
        best.take(&here, better);
        least.take(&at, better);
        here.take(&best, back);
        at.take(&least, back);
        if done == [true; LANES] {
            break;
        }
    }
    let (mut here, mut at) = (best, least);
    let [columns @ .., _] = &mut at.columns;
    here.determinant = solve::<JOINTS, JOINTS, JOINTS>(columns);
    here.met = at.met();
    here.take(newton, newton.met);
    here
}

impl Postures {
    /// Those of another in some lanes.
    fn take(&mut self, other: &Self, lanes: [bool; LANES]) {
        for (own, from) in self.values.iter_mut().zip(&other.values) {
            own.cos = own.cos.with_lanes(from.cos, lanes);
            own.sin = own.sin.with_lanes(from.sin, lanes);
            own.slide = own.slide.with_lanes(from.slide, lanes);
        }
        for (own, from) in self.travel.iter_mut().zip(&other.travel) {
            *own = own.with_lanes(*from, lanes);
        }
        self.determinant = self.determinant.with_lanes(other.determinant, lanes);
        for ((own, from), taken) in self.met.iter_mut().zip(other.met).zip(lanes) {
            *own = if taken { from } else { *own };
        }
    }
}

/// What is missing at joint values, and how it changes.
#[derive(Clone, Copy)]
struct Errors {
    /// The Jacobian, and what is missing; half a turn is not taken for none.
    columns: [[Wide; JOINTS]; JOINTS + 1],
    /// The square of the latter.
    cost: Wide,
}

impl Errors {
    fn new(arm: &SixJoints<'_>, target: &Frame, values: &[Values; JOINTS]) -> Self {
        let (mut columns, trace) = system(arm, target, values);
        let [.., [px, py, pz, wx, wy, wz]] = &mut columns;
        // For more than a quarter turn as long as 2 minus the sine of its angle.
        let sine = dot([*wx, *wy, *wz], [*wx, *wy, *wz]).sqrt() + Wide::all(f64::MIN_POSITIVE);
        let longer = Wide::ONE.if_greater(trace, (Wide::all(2.0) - sine) / sine, Wide::ONE);
        for part in [&mut *wx, &mut *wy, &mut *wz] {
            *part = *part * longer;
        }
        let cost = dot([*px, *py, *pz], [*px, *py, *pz]) + dot([*wx, *wy, *wz], [*wx, *wy, *wz]);
        Self { columns, cost }
    }

    /// Where little enough is missing.
    fn met(&self) -> [bool; LANES] {
        let mut met = [false; LANES];
        for (lane, met) in met.iter_mut().enumerate() {
            *met = self.cost.lane(lane) <= FOUND * FOUND;
        }
        met
    }

    /// Those of another in some lanes.
    fn take(&mut self, other: &Self, lanes: [bool; LANES]) {
        for (own, from) in self.columns.iter_mut().flatten().zip(other.columns.iter().flatten()) {
            *own = own.with_lanes(*from, lanes);
        }
        self.cost = self.cost.with_lanes(other.cost, lanes);
    }
}

/// The columns of the Jacobian and what is left of the way to the target (position in reaches, then the turn in rad, for
/// small ones), and the trace of that turn.
#[inline]
fn system(
    arm: &SixJoints<'_>,
    target: &Frame,
    values: &[Values; JOINTS],
) -> ([[Wide; JOINTS]; JOINTS + 1], Wide) {
    let [base, links @ ..] = &arm.links;
    let mut frame = Frames::all(base);
    let mut axes = [([Wide::ZERO; 3], [Wide::ZERO; 3]); JOINTS];
    for (((values, link), slides), axis) in values.iter().zip(links).zip(arm.prismatic).zip(&mut axes) {
        *axis = (frame.z_axis(), frame.translation);
        frame = frame.moved(values, slides).compose(link);
    }
    let tip = frame.translation;
    let sub = |[a, b, c]: [Wide; 3], [d, e, f]: [Wide; 3]| [a - d, b - e, c - f];
    let mut columns = [[Wide::ZERO; JOINTS]; JOINTS + 1];
    for ((column, (axis, origin)), slides) in columns.iter_mut().zip(axes).zip(arm.prismatic) {
        let [wx, wy, wz] = if slides { [Wide::ZERO; 3] } else { axis };
        let [vx, vy, vz] = if slides { axis } else { cross(axis, sub(tip, origin)) };
        *column = [vx, vy, vz, wx, wy, wz];
    }
    let target = Frames::all(target);
    let [px, py, pz] = sub(target.translation, tip);
    let [[ax, bx, cx], [ay, by, cy], [az, bz, cz]] = frame.rotation;
    let [[dx, ex, fx], [dy, ey, fy], [dz, ez, fz]] = target.rotation;
    let pairs = [([ax, ay, az], [dx, dy, dz]), ([bx, by, bz], [ex, ey, ez]), ([cx, cy, cz], [fx, fy, fz])];
    let [[a1, a2, a3], [b1, b2, b3], [c1, c2, c3]] = pairs.map(|(own, wanted)| cross(own, wanted));
    let [x, y, z] = [a1 + b1 + c1, a2 + b2 + c2, a3 + b3 + c3].map(|sum| sum * 0.5);
    let [a, b, c] = pairs.map(|(own, wanted)| dot(own, wanted));
    columns[JOINTS] = [px, py, pz, x, y, z];
    (columns, a + b + c)
}
