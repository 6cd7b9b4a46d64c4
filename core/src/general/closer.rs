//! Places where the polynomial's coefficients are too coarse to say where its roots are, seen closer.
//!
//! What is uncertain of a value is uncertain of the greatest coefficient. Where many roots are near to each other, the whole
//! polynomial is smaller than that. Its values are not: each is a determinant. So it is sampled again, at places that
//! crowd there.

use super::NOISE;
use super::resultant::Resultant;
use super::roots::{List, Roots};
use super::waves::Waves;

/// How many places are seen closer, at most.
const MOST: usize = 12;

/// How far beyond its ends a place is looked at, in parts of its half.
const MARGIN: f64 = 0.25;

/// How far (rad) the ends of a place, with its margin, are from its middle when it is seen closer; more where it is wide.
const SEEN: f64 = 2.0;

/// Places that are wider (rad) are not seen better than from afar.
const WIDEST: f64 = 2.0;

/// Narrower ones (rad) are one root.
const NARROWEST: f64 = 1e-7;

/// Relative noise of the coefficients from which on other samples may do better.
const NOISY: f64 = 1e-10;

/// An angle y in place of x, with tan((x - centre) / 2) = scale tan(y / 2): of the polynomial in x, times a power of
/// cos² (y / 2) + scale² sin² (y / 2), it makes another one of the same degree, as a projective map does of a binary form.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    centre: f64,
    scale: f64,
}

impl View {
    /// As it is.
    pub(super) const WHOLE: Self = Self { centre: 0.0, scale: 1.0 };

    /// The same from elsewhere (rad): not a whole number of steps between samples.
    const ASIDE: Self = Self { centre: 0.1, scale: 1.0 };

    /// Whether it is as wide as it is.
    pub(super) fn is_whole(&self) -> bool {
        self.scale == 1.0
    }

    /// With this place (rad) as wide as half a turn.
    fn of([low, high]: [f64; 2]) -> Self {
        Self { centre: f64::midpoint(low, high), scale: libm::tan((high - low) / 4.0) }
    }

    /// x (rad), and what the square of the polynomial's degree is to be a power of.
    #[inline]
    pub(super) fn at(&self, y: f64) -> (f64, f64) {
        if self.scale == 1.0 {
            return (self.centre + y, 1.0);
        }
        let (sin, cos) = libm::sincos(y / 2.0);
        let sin = self.scale * sin;
        (self.centre + 2.0 * libm::atan2(sin, cos), sin * sin + cos * cos)
    }

    /// x (rad) for y in a turn that begins at most half a turn before 0.
    fn x(&self, y: f64) -> f64 {
        let turn = core::f64::consts::TAU;
        self.at(if y > turn / 2.0 { y - turn } else { y }).0
    }
}

/// Candidates for roots.
pub(super) struct Candidates {
    /// Roots, certain or possible.
    pub(super) likely: List,
    /// Places where there should be none, but nearly are.
    pub(super) unlikely: List,
    /// Whether some are only possible, or the coefficients are inaccurate.
    pub(super) doubtful: bool,
    /// How far the polynomial stays away from 0, relative to its size; 0 where it has roots.
    pub(super) miss: f64,
}

/// All roots; also says how noisy the coefficients are.
pub(super) fn roots(resultant: &Resultant) -> (Candidates, f64) {
    let (waves, noise) = resultant.waves(View::WHOLE);
    if noise <= NOISY {
        return (settled(resultant, &waves, View::WHOLE, noise), noise);
    }
    // A sample may have been next to a place where its equations are dependent.
    let (other, less) = resultant.waves(View::ASIDE);
    if less < noise || noise.is_nan() {
        return (settled(resultant, &other, View::ASIDE, less), less);
    }
    (settled(resultant, &waves, View::WHOLE, noise), noise)
}

/// The roots of a polynomial that is seen wholly.
fn settled(resultant: &Resultant, waves: &Waves, view: View, noise: f64) -> Candidates {
    let roots = waves.roots();
    let mut all = Candidates {
        likely: List::EMPTY,
        unlikely: List::EMPTY,
        doubtful: roots.overflown || noise > NOISE,
        miss: 0.0,
    };
    let mut possible = List::EMPTY;
    let mut places = Places::EMPTY;
    add(&roots, view, |_| true, &mut all, &mut possible, &mut places, f64::INFINITY);
    while let Some(place @ [low, high]) = places.next() {
        let view = View::of(place);
        let (waves, noise) = resultant.waves(view);
        if noise > NOISE || noise.is_nan() {
            all.doubtful = true;
            continue;
        }
        let margin = MARGIN * (high - low) / 2.0;
        let middle = f64::midpoint(low, high);
        let half = (high - low) / 2.0 + margin;
        let inside = |x: f64| {
            let apart = crate::Float::wrap_angle(x - middle);
            crate::Float::abs(apart) <= half
        };
        for list in [&mut all.likely, &mut all.unlikely, &mut possible] {
            list.retain(|x| !inside(x));
        }
        let closer = waves.roots_within(SEEN);
        all.doubtful |= closer.overflown;
        add(&closer, view, inside, &mut all, &mut possible, &mut places, half);
    }
    all.doubtful |= places.left || !possible.as_slice().is_empty();
    for root in possible.as_slice() {
        all.doubtful |= !all.likely.push(*root);
    }
    if all.likely.as_slice().is_empty() {
        all.miss = waves.miss(&roots);
    }
    all
}

/// Adds what was found in a view, where it is inside, and notes places that are less than `wide` (rad) to be seen closer.
fn add(
    roots: &Roots,
    view: View,
    inside: impl Fn(f64) -> bool,
    all: &mut Candidates,
    possible: &mut List,
    places: &mut Places,
    wide: f64,
) {
    for (from, to) in
        [(&roots.certain, &mut all.likely), (&roots.unlikely, &mut all.unlikely), (&roots.possible, possible)]
    {
        for x in from.as_slice().iter().map(|y| view.x(*y)).filter(|x| inside(*x)) {
            all.doubtful |= !to.push(x);
        }
    }
    for [low, high] in roots.clusters() {
        let place = [*low, *high].map(|y| view.x(y));
        let [low, high] = place;
        // A turn may end in between.
        let high = if high < low && view.is_whole() { high + core::f64::consts::TAU } else { high };
        let size = high - low;
        if (inside(low) || inside(high)) && size > NARROWEST && size < WIDEST && size < wide {
            places.push([low, high]);
        }
    }
}

/// Places to be seen closer.
struct Places {
    list: [[f64; 2]; MOST],
    len: usize,
    next: usize,
    /// Whether there were too many.
    left: bool,
}

impl Places {
    const EMPTY: Self = Self { list: [[0.0; 2]; MOST], len: 0, next: 0, left: false };

    fn push(&mut self, place: [f64; 2]) {
        match self.list.get_mut(self.len) {
            Some(to) => {
                *to = place;
                self.len += 1;
            }
            None => self.left = true,
        }
    }

    fn next(&mut self) -> Option<[f64; 2]> {
        let place = self.list.get(self.next).filter(|_| self.next < self.len)?;
        self.next += 1;
        Some(*place)
    }
}
