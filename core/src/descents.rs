//! Every solution that descents from many places find, for inverse problems of which nothing better is known: rows that
//! follow others by couplings, and targets that are no pose of a chain.
//!
//! Nothing proves that all are found. Places are spread evenly, and the search ends where so many in a row have led to
//! nothing new; how many is measured by the compiler, for each problem. Where no unknown is a length there is a check: the
//! signs of the determinants of all solutions add up to 0. Joint values form a torus; of its map to what is prescribed that
//! sum is the degree, which is the same at all regular targets and for all arms that can be deformed into each other
//! \[Milnor, Topology from the Differentiable Viewpoint, §5\]. An arm whose axes all coincide meets almost no target, so the
//! degree is 0.
//!
//! A tool whose x axis is upright has no yaw, and near it the yaw changes fast. So what is made to vanish is the part of that
//! axis across the wanted heading, which is smooth everywhere; solutions that head the other way are dropped.

use crate::evenly::evenly;
use crate::frame::cross;
use crate::general::{Equations, Known, MORE, OnCurve, beside, moved, on_curve, rank, solve};
use crate::polish::descend;
use crate::unknowns::UNKNOWNS;
use crate::{Float, Frame, MAX_JOINTS, Target, TargetKind};

/// A chain of rows along and about z, each a linear form in a few unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowChain<'a> {
    /// Fixed transforms (m): before the first row, between the rows, after the last.
    pub links: &'a [Frame],
    /// Which rows slide.
    pub prismatic: &'a [bool],
    /// The value of each row (rad, m): a factor for each unknown, one for each joint that the caller gives, a constant.
    pub forms: &'a [&'a [f64]],
    /// One an unknown: after how many whole turns of it all is as it was; 0 where it is a length.
    pub turns: &'a [u8],
    /// Size of the arm (m): lengths are measured in it.
    pub reach: f64,
    /// So many starts in a row without a new solution end the search.
    pub patience: u32,
}

/// The most rows that a chain can have.
const ROWS: usize = 2 * MAX_JOINTS;

/// The most steps from one start. Ten are usual; where two solutions nearly meet, the way along the valley is long.
const STEPS: usize = 60;

/// A step that takes away less than this part of the square of what is missing goes to where something stays missing.
const STALLED: f64 = 0.01;

/// What is missing (reaches, rad) of a target that is met.
const FOUND: f64 = 1e-10;

/// Solutions that are nearer than this (rad, reaches) are one: double roots are not known any better.
const ONE: f64 = 1e-6;

/// Points of curves of solutions that are nearer than this (rad, reaches) are not followed twice; nor more than so many.
const SAME_STRETCH: f64 = 0.3;
const MOST_POINTS: usize = 32;

/// A solution that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Found {
    /// Values of the unknowns (rad, m), then zeros.
    pub(crate) x: [f64; UNKNOWNS],
    /// The unknown that can be moved with the target kept.
    pub(crate) free: Option<usize>,
    /// Of what the target prescribes, by the unknowns (reaches, rad); 0 where these are fewer.
    pub(crate) determinant: f64,
}

/// What is wanted of unknowns that a target leaves free (rad, m; NaN where nothing is), and how far from there: in halves of
/// the unknown's period, which is a turn or several (reaches, where it slides).
pub(crate) type WantedOfFree<'w> = (&'w [f64; UNKNOWNS], f64);

/// An unknown that moves what is prescribed by no more than this (reaches, rad) for 1 does so by rounding.
const IDLE: f64 = 1e-9;

/// A method of the problem with as many unknowns as the chain has, or what there is for none.
macro_rules! asked {
    ($chain:expr, $target:expr, $given:expr, |$problem:ident| $answer:expr, $none:expr) => {
        match $chain.turns.len() {
            1 => asked!(1, $chain, $target, $given, |$problem| $answer),
            2 => asked!(2, $chain, $target, $given, |$problem| $answer),
            3 => asked!(3, $chain, $target, $given, |$problem| $answer),
            4 => asked!(4, $chain, $target, $given, |$problem| $answer),
            5 => asked!(5, $chain, $target, $given, |$problem| $answer),
            6 => asked!(6, $chain, $target, $given, |$problem| $answer),
            _ => $none,
        }
    };
    ($count:literal, $chain:expr, $target:expr, $given:expr, |$problem:ident| $answer:expr) => {{
        let $problem = Problem::<$count>::new($chain, $target, $given);
        $answer
    }};
}

impl RowChain<'_> {
    /// Hands every solution that is found to `found`. Returns by how much the best start missed the target (reaches, rad).
    pub(crate) fn solve(
        &self,
        target: &Target,
        given: &[f64],
        wanted: WantedOfFree<'_>,
        found: &mut dyn FnMut(&Found),
    ) -> f64 {
        asked!(self, target, given, |problem| problem.solve(wanted, found), f64::INFINITY)
    }

    /// The solution that the start of this number leads to: values of the unknowns (rad, m), then zeros. `None` where it leads
    /// to none, or to one with the heading the wrong way round.
    pub fn descend(&self, target: &Target, given: &[f64], number: u32) -> Option<[f64; UNKNOWNS]> {
        asked!(self, target, given, |problem| problem.from(number), None)
    }

    /// Whether the signs of the determinants of all solutions of a target add up to 0.
    pub fn balances(&self, kind: TargetKind) -> bool {
        kind.rows() == self.turns.len() && !self.turns.contains(&0)
    }

    /// The tip at values of the unknowns (rad, m).
    pub fn tip(&self, given: &[f64], x: &[f64; UNKNOWNS]) -> Frame {
        let any = Target::Pose(Frame::IDENTITY);
        asked!(self, &any, given, |problem| problem.at(&problem.measured(x)).0, Frame::IDENTITY)
    }

    /// In how many ways the unknowns (rad, m) move the tip of those that a target prescribes, where it is met.
    pub fn rank(&self, target: &Target, given: &[f64], x: &[f64; UNKNOWNS]) -> usize {
        asked!(self, target, given, |problem| rank(&problem.columns(&problem.measured(x))), 0)
    }

    /// Whether an unknown by itself moves of the tip what a target prescribes, where that is met.
    pub fn moves(&self, target: &Target, given: &[f64], x: &[f64; UNKNOWNS], place: usize) -> bool {
        asked!(
            self,
            target,
            given,
            |problem| {
                let columns = problem.columns(&problem.measured(x));
                columns.get(place).is_some_and(|column| column.iter().any(|part| part.abs() > IDLE))
            },
            false
        )
    }

    /// The factor of an unknown's own measure, in which a period is a whole turn and lengths are reaches.
    fn unit(&self, place: usize) -> f64 {
        match self.turns.get(place) {
            Some(0) => self.reach,
            Some(turns) => f64::from(*turns),
            None => 1.0,
        }
    }
}

/// A target of a chain, in `K` unknowns.
struct Problem<'a, const K: usize> {
    chain: &'a RowChain<'a>,
    target: &'a Target,
    /// What each row is with every unknown at 0.
    constants: [f64; ROWS],
    units: [f64; K],
    per_reach: f64,
    /// Cosine and sine of the yaw that is prescribed.
    heading: Option<[f64; 2]>,
}

impl<'a, const K: usize> Problem<'a, K> {
    fn new(chain: &'a RowChain<'a>, target: &'a Target, given: &[f64]) -> Self {
        let mut constants = [0.0; ROWS];
        for (constant, form) in constants.iter_mut().zip(chain.forms) {
            let behind = form.iter().skip(chain.turns.len());
            *constant = behind.zip(given.iter().chain(&[1.0])).fold(0.0, |sum, (a, b)| sum + a * b);
        }
        let units = core::array::from_fn(|place| chain.unit(place));
        let heading = match target {
            Target::PositionYaw { yaw, .. } | Target::XyYaw { yaw, .. } => {
                let (sin, cos) = yaw.sin_cos();
                Some([cos, sin])
            }
            _ => None,
        };
        Problem { chain, target, constants, units, per_reach: 1.0 / chain.reach, heading }
    }

    /// The tip, what is missing, and how much less of it with each unknown.
    fn at(&self, x: &[f64; K]) -> (Frame, [f64; 6], [[f64; 6]; K]) {
        let mut values = *x;
        values.iter_mut().zip(self.units).for_each(|(value, unit)| *value *= unit);
        let (mut frame, links) = match self.chain.links {
            [first, links @ ..] => (*first, links),
            [] => (Frame::IDENTITY, self.chain.links),
        };
        // Twists: what the origin of the base does, and the turn.
        let mut twists = [[0.0; 6]; K];
        let rows = self.chain.forms.iter().zip(self.chain.prismatic).zip(links).zip(&self.constants);
        for (((form, slides), link), constant) in rows {
            let axis = frame.z_axis();
            let ([vx, vy, vz], [wx, wy, wz]) =
                if *slides { (axis, [0.0; 3]) } else { (cross(frame.translation, axis), axis) };
            let mut sum = *constant;
            for ((factor, value), twist) in form.iter().zip(values).zip(&mut twists) {
                if *factor != 0.0 {
                    sum += factor * value;
                    let own = [vx, vy, vz, wx, wy, wz];
                    twist.iter_mut().zip(own).for_each(|(sum, part)| *sum += factor * part);
                }
            }
            frame = moved(&frame, *slides, sum).compose(link);
        }
        let mut columns = [[0.0; 6]; K];
        for ((column, twist), unit) in columns.iter_mut().zip(twists).zip(self.units) {
            let [vx, vy, vz, wx, wy, wz] = twist.map(|part| part * unit);
            let [x, y, z] = cross([wx, wy, wz], frame.translation);
            let twist = [vx + x, vy + y, vz + z, wx, wy, wz];
            *column = self.target.gained(&frame, &twist, self.per_reach);
            if let (Some(heading), [_, _, _, across, ..]) = (self.heading, column) {
                *across = aside(heading, cross([wx, wy, wz], frame.x_axis()));
            }
        }
        let mut missing = self.target.missing(&frame, self.per_reach);
        if let (Some(heading), [_, _, _, across, ..]) = (self.heading, &mut missing) {
            *across = -aside(heading, frame.x_axis());
        }
        (frame, missing, columns)
    }

    /// Downhill from a place: the solution and its tip, or what stays missing (reaches, rad).
    fn downhill(&self, start: &[f64; K], least: f64) -> Result<([f64; K], Frame), f64> {
        let (x, tip) = descend(*start, STEPS, least, |x| self.at(x));
        let (position, rotation) = self.target.errors(&tip);
        let rotation = self.heading.map_or(rotation, |heading| aside(heading, tip.x_axis()).abs());
        let miss = Float::max(position * self.per_reach, rotation);
        if miss <= FOUND { Ok((x, tip)) } else { Err(miss) }
    }

    /// Whether a tip that has nothing across the heading that is prescribed has it the right way round.
    fn is_ahead(&self, tip: &Frame) -> bool {
        let [x, y, _] = tip.x_axis();
        self.heading.is_none_or(|[cos, sin]| cos * x + sin * y > 0.0)
    }

    /// The start of this number.
    fn start(&self, number: u32) -> [f64; K] {
        let parts = evenly::<f64, K>(number, K);
        let mut start = [0.0; K];
        for (place, (value, part)) in start.iter_mut().zip(parts).enumerate() {
            *value = part * if self.slides(place) { 2.0 } else { core::f64::consts::TAU };
        }
        start
    }

    fn from(&self, number: u32) -> Option<[f64; UNKNOWNS]> {
        let (x, tip) = self.downhill(&self.start(number), STALLED).ok()?;
        self.is_ahead(&tip).then(|| self.in_metres(&padded(&x)))
    }

    fn determinant(&self, tip: &Frame, columns: &[[f64; 6]; K]) -> f64 {
        if self.target.kind().rows() != K {
            return 0.0;
        }
        let mut rows = [[0.0; K]; K];
        for (row, column) in rows.iter_mut().zip(columns) {
            let own = self.target.coordinates(tip, column);
            row.iter_mut().zip(own).for_each(|(to, from)| *to = from);
        }
        solve(&mut rows)
    }

    fn solve(&self, (wanted, aside): WantedOfFree<'_>, found: &mut dyn FnMut(&Found)) -> f64 {
        let mut prismatic = [false; UNKNOWNS];
        prismatic.iter_mut().zip(self.chain.turns).for_each(|(slides, turns)| *slides = *turns == 0);
        let balanced = self.chain.balances(self.target.kind());
        let mut search = Search {
            problem: self,
            known: Known::new(prismatic, ONE),
            points: [[0.0; K]; MOST_POINTS],
            count: 0,
            wanted: self.measured(wanted),
            aside,
            found,
        };
        let (mut number, mut idle, mut least, mut place) = (0, 0, f64::INFINITY, 0);
        loop {
            let times = if balanced && search.known.is_lopsided() { MORE as u32 } else { 1 };
            if idle >= self.chain.patience.saturating_mul(times) {
                return least;
            }
            number += 1;
            idle += 1;
            match self.downhill(&self.start(number), STALLED) {
                Ok((x, tip)) => {
                    if search.add(&x, &tip) {
                        idle = 0;
                    }
                    if !self.is_ahead(&tip) {
                        least = Float::min(core::f64::consts::PI, least);
                    }
                }
                Err(miss) => least = Float::min(miss, least),
            }
            // Solutions that nearly meet one that is known have few starts of their own.
            while let Some(solution) = search.known.get(place) {
                place += 1;
                let x = shortened(&solution);
                for start in beside(&x, &self.columns(&x)) {
                    if self.downhill(&start, STALLED).is_ok_and(|(x, tip)| search.add(&x, &tip)) {
                        idle = 0;
                    }
                }
            }
        }
    }

    /// Values (rad, m) in the unknowns' own measures.
    fn measured(&self, x: &[f64; UNKNOWNS]) -> [f64; K] {
        let mut own: [f64; K] = shortened(x);
        own.iter_mut().zip(self.units).for_each(|(value, unit)| *value /= unit);
        own
    }

    fn in_metres(&self, x: &[f64; UNKNOWNS]) -> [f64; UNKNOWNS] {
        let mut x = *x;
        for ((place, value), unit) in x.iter_mut().enumerate().zip(self.units) {
            let period = if self.slides(place) { *value } else { value.wrap_angle() };
            *value = period * unit;
        }
        x
    }
}

impl<const K: usize> Equations<K> for Problem<'_, K> {
    fn columns(&self, x: &[f64; K]) -> [[f64; 6]; K] {
        self.at(x).2
    }

    fn onto(&self, x: &[f64; K]) -> Option<[f64; K]> {
        self.downhill(x, 0.0).ok().map(|(x, _)| x)
    }

    fn slides(&self, place: usize) -> bool {
        self.chain.turns.get(place) == Some(&0)
    }
}

/// What has been found of a problem.
struct Search<'s, const K: usize> {
    problem: &'s Problem<'s, K>,
    known: Known,
    /// Points of curves of solutions.
    points: [[f64; K]; MOST_POINTS],
    count: usize,
    wanted: [f64; K],
    aside: f64,
    found: &'s mut dyn FnMut(&Found),
}

impl<const K: usize> Search<'_, K> {
    /// Whether a solution, which has this tip, is new.
    fn add(&mut self, x: &[f64; K], tip: &Frame) -> bool {
        if self.known.contains(&padded(x)) {
            return false;
        }
        let columns = self.problem.columns(x);
        if rank(&columns) < K {
            if self.is_on_known_stretch(x) {
                return false;
            }
            if let Some(point) = on_curve(self.problem, x, &self.wanted, self.aside, K) {
                return self.add_curve(x, tip, &point);
            }
        }
        let determinant = self.problem.determinant(tip, &columns);
        let new = self.known.insert(&padded(x), determinant);
        if new && self.problem.is_ahead(tip) {
            self.hand_on(x, None, determinant);
        }
        new
    }

    /// The same of a solution on a curve, with the point of it that is nearest to what is wanted. Curves go on where the
    /// heading turns round: of one whose nearest point has it the wrong way, it is the solution that is handed on.
    fn add_curve(&mut self, x: &[f64; K], tip: &Frame, nearest: &OnCurve<K>) -> bool {
        let Some(slot) = self.points.get_mut(self.count) else { return false };
        *slot = *x;
        self.count += 1;
        let ahead = |tip: &Frame| self.problem.is_ahead(tip);
        let (known, handed) = match (ahead(&self.problem.at(&nearest.q).0), ahead(tip)) {
            (true, _) => (nearest.q, Some(nearest.q)),
            (false, true) => (nearest.q, Some(*x)),
            // Another solution on this curve may have it right.
            (false, false) => (*x, None),
        };
        let new = self.known.insert(&padded(&known), 0.0);
        if let (true, Some(x)) = (new, handed) {
            self.hand_on(&x, nearest.joint, 0.0);
        }
        new
    }

    fn hand_on(&mut self, x: &[f64; K], free: Option<usize>, determinant: f64) {
        (self.found)(&Found { x: self.problem.in_metres(&padded(x)), free, determinant });
    }

    fn is_on_known_stretch(&self, x: &[f64; K]) -> bool {
        let near = |point: &[f64; K]| {
            point.iter().zip(x).enumerate().all(|(place, (a, b))| {
                let apart = if self.problem.slides(place) { a - b } else { (a - b).wrap_angle() };
                apart.abs() <= SAME_STRETCH
            })
        };
        self.points.iter().take(self.count).any(near)
    }
}

/// How far a vector goes to the left of a heading.
fn aside([cos, sin]: [f64; 2], [x, y, _]: [f64; 3]) -> f64 {
    cos * y - sin * x
}

/// With zeros for the unknowns that there are not.
fn padded<const K: usize>(x: &[f64; K]) -> [f64; UNKNOWNS] {
    let mut padded = [0.0; UNKNOWNS];
    padded.iter_mut().zip(x).for_each(|(to, from)| *to = *from);
    padded
}

fn shortened<const K: usize>(x: &[f64; UNKNOWNS]) -> [f64; K] {
    let mut own = [0.0; K];
    own.iter_mut().zip(x).for_each(|(to, from)| *to = *from);
    own
}

#[cfg(test)]
mod tests;
