//! Every solution of a full pose for any chain of six joints.
//!
//! The chain and its target are a closed circuit. It is cut at one joint, whose axis is then a line that the five others
//! must bring back to where it is. Two joints see it through the target, three through fixed links. The power products
//! of that line \[Raghavan, Roth 1993\] are linear in cosine and sine of each joint; eight of the fourteen equations
//! eliminate the first two joints, the other six hold three. One of these three stays hidden in the coefficients; of the
//! others, one is eliminated by a resultant \[Manocha, Canny 1994\], which the elimination of two thirds of the unknown
//! products brings from twelve rows to three.
//!
//! What remains is a trigonometric polynomial in one joint angle. It is sampled, not expanded: a discrete Fourier
//! transform gives its coefficients, and shows by what should be 0 how accurate they are. Its real roots are isolated, the
//! other joints follow, and Newton's method on the whole pose takes away what rounding has left.
//!
//! Where the polynomial is doubtful (roots that have met, a target at which it vanishes) another choice of joints is asked
//! as well. Which choices suit an arm best is found by the compiler.

mod chart;
mod circuit;
mod closer;
mod continuum;
mod directions;
mod isolation;
mod jacobian;
mod known;
mod line;
mod linear;
mod mirror;
mod pair;
mod posture;
mod resultant;
mod roots;
mod starts;
mod triple;
mod waves;
mod wide;

pub(crate) use waves::Waves;

use crate::Frame;
pub use chart::Chart;
use circuit::Circuit;
use closer::View;
pub(crate) use continuum::{Equations, OnCurve, beside, on_curve, rank};
pub(crate) use jacobian::moved;
pub(crate) use known::{Known, same};
pub(crate) use linear::solve;
use mirror::Mirror;
use pair::Pair;
use resultant::Resultant;
pub(crate) use starts::MORE;
use starts::{PATIENCE, STARTS, Starts, everywhere};
pub use triple::Triple;
use wide::{LANES, Wide};

/// How many joints the caller leaves to be found.
pub(crate) const JOINTS: usize = 6;

/// A chain of joints along and about z, six of which are to be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeneralArm<'a> {
    /// Fixed transforms (m): before the first joint, between the joints, after the last.
    pub links: &'a [Frame],
    /// Which joints slide.
    pub prismatic: &'a [bool],
    /// Joints whose values the caller gives.
    pub given: &'a [usize],
    /// Size of the arm (m): lengths are measured in it.
    pub reach: f64,
    /// Choices of joints, the best first.
    pub charts: &'a [Chart],
    /// [`GeneralArm::triple`], if it is known beforehand.
    pub triple: &'a Option<Triple>,
}

impl<'a> GeneralArm<'a> {
    /// The chain that is left where some joints are given (rad or m). `None` where those left are not six.
    pub fn six(&self, given: &[f64]) -> Option<SixJoints<'a>> {
        let mut six = SixJoints {
            links: [Frame::IDENTITY; JOINTS + 1],
            prismatic: [false; JOINTS],
            reach: self.reach,
            charts: self.charts,
            triple: if self.given.is_empty() { self.triple.as_ref() } else { None },
        };
        let (first, links) = self.links.split_first()?;
        let mut link = *first;
        let mut count = 0;
        for (joint, (slides, after)) in self.prismatic.iter().zip(links).enumerate() {
            let value = self.given.iter().position(|other| *other == joint);
            if let Some(place) = value {
                let motion = line::Motion::new(*slides, *given.get(place)?);
                link = link.compose(&motion.frame()).compose(after);
            } else {
                *six.links.get_mut(count)? = link;
                *six.prismatic.get_mut(count)? = *slides;
                count += 1;
                link = *after;
            }
        }
        *six.links.last_mut()? = link;
        (count == JOINTS).then_some(six)
    }
}

/// A chain of six joints, revolute or prismatic, along and about z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SixJoints<'a> {
    /// Fixed transforms (m): before the first joint, between the joints, after the last.
    pub links: [Frame; JOINTS + 1],
    /// Which joints slide.
    pub prismatic: [bool; JOINTS],
    /// Size of the arm (m): lengths are measured in it.
    pub reach: f64,
    /// Choices of joints, the best first.
    pub charts: &'a [Chart],
    /// [`GeneralArm::triple`] of the first of them, if it is known beforehand.
    pub triple: Option<&'a Triple>,
}

/// What a search of one chart came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Whether solutions may be missing: roots have met, or the polynomial is inaccurate.
    pub doubtful: bool,
    /// How far the polynomial stays away from 0, relative to its size; 0 where it has roots.
    pub miss: f64,
    /// How far (rad, reaches) Newton's method had to go from the worst of the roots.
    pub moved: f64,
    /// Whether a choice of joints before was doubtful, or this one.
    pub doubted: bool,
}

impl SixJoints<'_> {
    /// Hands every solution for a pose of the tip to `found`, some of them more than once.
    ///
    /// Solutions are joint values (rad, m), with the determinant of the Jacobian (reaches, rad).
    pub fn solve(&self, pose: &Frame, mut found: impl FnMut(&[f64; JOINTS], f64)) -> Outcome {
        let mut known = Known::new(self.prismatic, ONE);
        let (mut outcome, sure) = self.solve_plainly(pose, |solution, determinant| {
            known.insert(solution, determinant);
            found(solution, determinant);
        });
        if sure {
            return outcome;
        }
        // Where the equations degenerate at this very pose, those of poses on both sides of it don't.
        for chart in self.charts {
            for (size, side) in NEIGHBOURS {
                let [x, y, z, roll, pitch, yaw] = side.map(|part| part * size);
                let step = Frame::from_rpy([x, y, z].map(|length| length * self.reach), [roll, pitch, yaw]);
                let from =
                    self.solve_from(*chart, &pose.compose(&step), pose, &mut |solution, determinant| {
                        known.insert(solution, determinant);
                        found(solution, determinant);
                    });
                outcome = Outcome { doubtful: true, ..outcome.and(from) };
            }
        }
        let (scaled, target) = (self.scaled(), self.in_reaches(pose));
        // Solutions that nearly meet may have been taken for one.
        let mut place = 0;
        while let Some(mut solution) = known.get(place).filter(|_| place < crate::MAX_SOLUTIONS) {
            place += 1;
            self.each_slide(&mut solution, |value| value / self.reach);
            let mut beside = scaled.beside(&solution);
            while let Some(starts) = Starts::next(&mut beside) {
                scaled.landings(&target, &starts, |solution, _, determinant| {
                    let solution = self.in_metres(*solution);
                    known.insert(&solution, determinant);
                    found(&solution, determinant);
                });
            }
        }
        // At the edge of the workspace no neighbour may be attainable, and on some arms roots are double at every pose; there,
        // Newton's method needs no polynomial.
        let mut everywhere = everywhere();
        let mut idle = 0;
        loop {
            let missing = self.turns_only() && known.is_lopsided();
            let times = if self.charts.is_empty() || missing { MORE } else { 1 };
            if idle > times * (STARTS + PATIENCE * known.len()) {
                break;
            }
            let Some(starts) = Starts::next(&mut everywhere) else { break };
            idle += starts.as_slice().len();
            scaled.landings(&target, &starts, |solution, _, determinant| {
                let solution = self.in_metres(*solution);
                if known.insert(&solution, determinant) {
                    idle = 0;
                }
                found(&solution, determinant);
            });
        }
        outcome
    }

    /// Whether no joint slides: then every target goes out of reach when it is moved far enough.
    fn turns_only(&self) -> bool {
        !self.prismatic.iter().any(|slides| *slides)
    }

    /// The same by one choice of joints after the other, until one has no doubt. Says whether one had none, or all found
    /// nothing.
    pub(crate) fn solve_plainly(
        &self,
        pose: &Frame,
        mut found: impl FnMut(&[f64; JOINTS], f64),
    ) -> (Outcome, bool) {
        let mut outcome = Outcome::UNKNOWN;
        let (mut any, mut doubtful) = (false, self.charts.is_empty());
        for chart in self.charts {
            let this = self.solve_in(*chart, pose, &mut |solution, determinant| {
                any = true;
                found(solution, determinant);
            });
            doubtful |= this.doubtful;
            outcome = outcome.and(this);
            // That there is no solution is believed where all charts say so.
            if !this.doubtful && any {
                return (outcome, true);
            }
        }
        (outcome, !doubtful)
    }

    /// The same by one choice of joints.
    pub fn solve_in(
        &self,
        chart: Chart,
        pose: &Frame,
        found: &mut impl FnMut(&[f64; JOINTS], f64),
    ) -> Outcome {
        self.solve_from(chart, pose, pose, found)
    }

    /// Solutions for a pose, by Newton's method from those for a pose next to it.
    fn solve_from(
        &self,
        chart: Chart,
        from: &Frame,
        pose: &Frame,
        found: &mut impl FnMut(&[f64; JOINTS], f64),
    ) -> Outcome {
        let scaled = self.scaled();
        let circuit = scaled.circuit(chart, &self.in_reaches(from));
        let pair = Pair::new(&circuit);
        let computed;
        let triple = if let Some(triple) = self.triple.filter(|_| self.charts.first() == Some(&chart)) {
            triple
        } else {
            computed = circuit.triple(chart);
            &computed
        };
        let Some(resultant) = Resultant::new(&circuit, pair.as_ref(), triple, chart) else {
            return Outcome::UNKNOWN;
        };
        let (roots, noise) = closer::roots(&resultant);
        if noise > USELESS || noise.is_nan() {
            return Outcome::UNKNOWN;
        }
        let target = self.in_reaches(pose);
        let doubtful = roots.doubtful || resultant.pivot < PIVOT;
        let mut outcome = Outcome { doubtful, miss: roots.miss, moved: 0.0, doubted: false };
        let mut known = Known::new(self.prismatic, SAME);
        let periods = chart.periods.max(1);
        // Where the polynomial repeats itself because the solutions do, one of each two will do.
        let mirror = (periods == 2).then(|| Mirror::of(&scaled, chart.unknown())).flatten();
        let turns = if mirror.is_some() { 1 } else { periods };
        let likely = roots.likely.as_slice().iter().map(|root| (*root, true));
        let places = likely.chain(roots.unlikely.as_slice().iter().map(|root| (*root, false)));
        let places = places.flat_map(|place| (0..turns).map(move |turn| (place, turn)));
        let mut places = places.map(|((root, likely), turn)| {
            ((root + f64::from(turn) * core::f64::consts::TAU) / f64::from(periods), likely)
        });
        loop {
            let mut together = [None; LANES];
            for (to, place) in together.iter_mut().zip(&mut places) {
                *to = Some(place);
            }
            let [Some((root, _)), ..] = together else { break };
            let roots = Wide(together.map(|place| place.map_or(root, |(root, _)| root)));
            let others = resultant.others(roots);
            let postures = pair
                .as_ref()
                .map(|pair| posture::land(&scaled, &target, &circuit.rest_together(pair, &others)));
            for (lane, place) in together.into_iter().enumerate() {
                let Some((_, likely)) = place else { break };
                let mut hit = !likely;
                let mut add = |q: &[f64; JOINTS], travel: &[f64; JOINTS], determinant: f64| {
                    let travel = travel.map(libm::fabs);
                    let moved = travel.into_iter().fold(0.0, |most, x| if x > most { x } else { most });
                    outcome.moved = if moved > outcome.moved { moved } else { outcome.moved };
                    hit |= travel.get(chart.unknown()).is_some_and(|moved| *moved <= FAR);
                    // Two roots have gone to one solution: another may have none. Where one is that should not be, the
                    // polynomial is not to be trusted.
                    let mut add = |q: &[f64; JOINTS], determinant: f64| {
                        let new = known.insert(q, determinant);
                        outcome.doubtful |= new != likely;
                        if new {
                            found(&self.in_metres(*q), determinant);
                        }
                    };
                    add(q, determinant);
                    if let Some(mirror) = &mirror {
                        let (q, turned_over) = mirror.apply(q);
                        add(&q, if turned_over { -determinant } else { determinant });
                    }
                };
                if let Some(postures) = &postures {
                    if let Some((q, travel, determinant)) = postures.solution(&scaled, lane) {
                        add(&q, &travel, determinant);
                    }
                } else {
                    let known = [0, 1, 2].map(|k| others[k].value(circuit.slides(k + 3), lane));
                    let mut candidates = circuit.rest(known).into_iter().flatten();
                    if let Some(starts) = Starts::next(&mut candidates) {
                        scaled.landings(&target, &starts, add);
                    }
                }
                outcome.doubtful |= !hit;
            }
        }
        // Real solutions come and go in pairs, of determinants of either sign.
        outcome.doubtful |= known.len() % 2 == 1 || (self.turns_only() && known.is_lopsided());
        outcome
    }

    /// Hands the solutions that Newton's method finds from some places on, how far they are from there, and the
    /// determinant of the Jacobian; all in reaches.
    fn landings(
        &self,
        target: &Frame,
        starts: &Starts,
        mut each: impl FnMut(&[f64; JOINTS], &[f64; JOINTS], f64),
    ) {
        let postures = posture::land(self, target, &posture::gathered(self, starts.as_slice()));
        for lane in 0..starts.as_slice().len() {
            if let Some((q, travel, determinant)) = postures.solution(self, lane) {
                each(&q, &travel, determinant);
            }
        }
    }

    fn in_metres(&self, mut q: [f64; JOINTS]) -> [f64; JOINTS] {
        self.each_slide(&mut q, |value| value * self.reach);
        q
    }

    /// The tip at joint values (rad, m).
    pub fn tip(&self, q: &[f64; JOINTS]) -> Frame {
        let [base, links @ ..] = &self.links;
        let joints = q.iter().zip(self.prismatic);
        joints.zip(links).fold(*base, |frame, ((value, slides), link)| {
            frame.compose(&line::Motion::new(slides, *value).frame()).compose(link)
        })
    }

    /// How inaccurate the coefficients of a chart's polynomial are at a pose, relative to the greatest: large where the
    /// chart's degree is too low.
    pub fn noise(&self, chart: Chart, pose: &Frame) -> f64 {
        let circuit = self.scaled().circuit(chart, &self.in_reaches(pose));
        Resultant::new(&circuit, Pair::new(&circuit).as_ref(), &circuit.triple(chart), chart)
            .map_or(f64::INFINITY, |resultant| resultant.waves(View::WHOLE).1)
    }

    fn circuit(&self, chart: Chart, pose: &Frame) -> Circuit {
        let [before, first, second, third, fourth, fifth, after] = self.links;
        let closing = after.compose(&pose.inverse()).compose(&before);
        Circuit::new(&[first, second, third, fourth, fifth, closing], self.prismatic, chart)
    }

    fn in_reaches(&self, pose: &Frame) -> Frame {
        Frame { translation: pose.translation.map(|x| x / self.reach), ..*pose }
    }

    /// With lengths in reaches.
    fn scaled(&self) -> Self {
        let links =
            self.links.map(|link| Frame { translation: link.translation.map(|x| x / self.reach), ..link });
        Self { links, ..*self }
    }
}

impl Outcome {
    const UNKNOWN: Self = Self { doubtful: true, miss: f64::INFINITY, moved: f64::INFINITY, doubted: false };

    /// After one more search.
    fn and(self, other: Self) -> Self {
        let miss = if other.miss < self.miss { other.miss } else { self.miss };
        Self { miss, doubted: self.doubted || other.doubtful, ..other }
    }
}

/// Two solutions that are nearer than this (rad, reaches) are one.
const SAME: f64 = 1e-9;

/// The same where double roots are not known any better (rad, m).
const ONE: f64 = 1e-6;

/// Relative noise of the coefficients from which on nothing can be said of the roots.
const USELESS: f64 = 1e-3;

/// A root from which Newton's method goes this far (rad, reaches) was inaccurate: so may be those that were lost.
const FAR: f64 = 1e-5;

/// Neighbouring poses that help where the equations degenerate: how far off they are (rad, reaches), and where. They come
/// in opposite pairs, for of two solutions that meet at a pose there are two on one side of it and none on the other. The
/// near ones keep solutions that are about to vanish, the far ones tell many roots apart that meet at the pose.
const NEIGHBOURS: [(f64, [f64; 6]); 10] = [
    (1e-6, ASIDE),
    (-1e-6, ASIDE),
    (1e-4, ASKEW),
    (-1e-4, ASKEW),
    (1e-3, ASIDE),
    (-1e-3, ASIDE),
    (1e-2, ASKEW),
    (-1e-2, ASKEW),
    (4e-2, ASIDE),
    (-4e-2, ASIDE),
];

/// No direction of symmetry.
const ASIDE: [f64; 6] = [0.61, -0.45, 0.37, 0.53, 0.71, -0.42];
/// Another one.
const ASKEW: [f64; 6] = [-0.33, 0.58, 0.71, -0.67, 0.24, 0.49];

/// A pivot this small beside the greatest says that the target makes equations dependent on each other, as those of a
/// lattice do.
const PIVOT: f64 = 1e-10;

/// Relative noise of the coefficients from which on roots may have been lost.
const NOISE: f64 = 1e-8;

/// A candidate whose error (reaches, rad) Newton's method doesn't bring below this is none.
const FOUND: f64 = 1e-10;

#[cfg(test)]
mod tests;
