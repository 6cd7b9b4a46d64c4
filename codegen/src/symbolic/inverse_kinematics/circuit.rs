//! The closed circuit of arm and target, cut anywhere.
//!
//! J1 L1 ... Jn Ln = L0^-1 T says that J1 L1 ... Jn M is the identity, with M = Ln T^-1 L0: the target is a link like any
//! other, between the last joint and the first. The circuit may be read from any of its links. Where the axes of the last
//! three joints before the cut meet, these leave the point in place in which they meet, and the joints before them must
//! bring it to where the link of the cut has it; what is then left is a rotation. So a spherical joint anywhere in the arm
//! is a spherical wrist, of an arm whose links are in another order.

use super::atoms::Atoms;
use super::closure::{Equation, LONGEST_ROW, Origin, Trouble};
use super::polynomial::{Overflow, Polynomial};
use super::reading::{Open, short};
use super::search::Found;
use super::unknowns::Unknowns;
use super::walk::{Step, Vector, Walker};
use crate::model::chain::Element;
use crate::model::{Chain, Model, Target};
use crate::symbolic::expression::{Arena, Expr, Leaf};
use crate::symbolic::number::Number;
use crate::symbolic::{chain, transform};

/// How many joints make a rotation.
const ROTATION: usize = 3;

/// A joint of the circuit and what is behind it.
struct Station<'a> {
    row: usize,
    joint: Step<'a>,
    link: Vec<Step<'a>>,
}

/// A vector, and of a point the square of its distance from the origin, as far as they stay short.
#[derive(Clone)]
struct Carried {
    point: bool,
    vector: Option<Vector>,
    square: Option<Polynomial>,
}

impl Carried {
    fn origin() -> Self {
        let vector = Some([Polynomial::zero(), Polynomial::zero(), Polynomial::zero()]);
        Self { point: true, vector, square: Some(Polynomial::zero()) }
    }

    fn direction(vector: Vector) -> Self {
        Self { point: false, vector: Some(vector), square: None }
    }
}

/// The circuit, from behind the cut to before it.
pub(super) struct Circuit<'a, 'w> {
    walker: Walker<'w>,
    /// What of the first joint's link is along its axis, and does as well before it.
    before: Vec<Step<'a>>,
    stations: Vec<Station<'a>>,
    /// The second of the joints to be found.
    second: usize,
    /// The first of the joints that make the rotation.
    tail: usize,
}

impl<'a, 'w> Circuit<'a, 'w> {
    /// Cut behind a joint (from 1), with these joints to be found; `None` where fewer than three of them are in it.
    pub(super) fn cut(
        arena: &'w mut Arena,
        model: &'w Model,
        plain: &'a Chain,
        unknowns: &'w Unknowns,
        behind: usize,
    ) -> Result<Option<Self>, Trouble> {
        let mut walker = Walker { arena, model, unknowns, atoms: Atoms::default(), roots: Vec::new() };
        walker.angles(plain);
        let target = walker.target_as_link(plain)?;
        let mut stations = Vec::new();
        for (joint, link) in plain.joints.iter().zip(plain.links.iter().skip(1)) {
            let link = link.elements.iter().map(Step::Fixed).collect();
            stations.push(Station { row: joint.row, joint: walker.joint(joint.row, joint.kind)?, link });
        }
        if let Some(last) = stations.last_mut() {
            last.link = target;
        }
        let joints = stations.len().max(1);
        stations.rotate_left(behind % joints);
        let open = |station: &Station<'_>| {
            let form = unknowns.rows.get(station.row);
            let parts = form.into_iter().flat_map(|form| form.coefficients.iter().zip(&unknowns.free));
            parts.into_iter().any(|(k, free)| *k != 0.0 && free.given.is_none())
        };
        let places =
            || stations.iter().enumerate().filter(|(_, station)| open(station)).map(|(place, _)| place);
        let (Some(second), Some(tail)) = (places().nth(1), places().nth_back(ROTATION - 1)) else {
            return Ok(None);
        };
        // A joint does not notice an offset along its axis: before it, the frames have their origins on common normals.
        let mut before = Vec::new();
        for place in 0..tail {
            let Some(station) = stations.get_mut(place) else { break };
            let along = station.link.iter().take_while(|step| is_along_axis(step)).count();
            let offsets: Vec<Step<'a>> = station.link.drain(..along).collect();
            match place.checked_sub(1).and_then(|place| stations.get_mut(place)) {
                Some(station) => station.link.extend(offsets),
                None => before = offsets,
            }
        }
        Ok(Some(Self { walker, before, stations, second, tail }))
    }

    /// The point in which the last three axes meet, before the first of them; `None` where they don't.
    fn meeting_point(&mut self) -> Option<Carried> {
        let open = self.open();
        let mut point = Carried::origin();
        for (place, station) in self.stations.iter().enumerate().skip(self.tail).rev() {
            if place + 1 < self.stations.len() {
                point = self.walker.along(&station.link, point);
            }
            point = self.walker.along([&station.joint], point);
        }
        let vector = point.vector.as_ref()?;
        vector.iter().all(|entry| open.knows(entry)).then_some(point)
    }

    /// Whether the last three axes meet.
    pub(super) fn meets(&mut self) -> bool {
        self.meeting_point().is_some()
    }

    /// Whether the axes from the second joint to the first of the last three are parallel.
    pub(super) fn is_parallel(&mut self) -> bool {
        let one = Polynomial::number(self.walker.size(), Number::ONE);
        let mut axis = Carried::direction([Polynomial::zero(), Polynomial::zero(), one]);
        for station in self.stations.get(self.second..self.tail).unwrap_or_default().iter().rev() {
            axis = self.walker.along(&station.link, axis);
            if !matches!(&axis.vector, Some([x, y, _]) if x.is_zero() && y.is_zero()) {
                return false;
            }
        }
        self.second < self.tail
    }

    /// The equations of the point in which the last three axes meet; `None` where they don't.
    pub(super) fn point(&mut self) -> Result<Option<(Atoms, Vec<Equation>)>, Trouble> {
        let Some(inner) = self.meeting_point() else { return Ok(None) };
        let walker = &mut self.walker;
        let Some(end) = self.stations.last() else { return Ok(None) };
        let mut outer = walker.back(&end.link, Carried::origin());
        outer = walker.back(&self.before, outer);
        // Seen from behind the cut, the joints undo what the link there did; in every frame one side of the equation.
        let mut inside = vec![inner];
        for station in self.stations.iter().take(self.tail).rev() {
            let Some(inner) = inside.last().cloned() else { break };
            let inner = walker.along(&station.link, inner);
            inside.push(walker.along([&station.joint], inner));
        }
        let what = meeting(self.stations.get(self.tail..).unwrap_or_default());
        let mut equations = Vec::new();
        let mut group = 0;
        for station in self.stations.iter().take(self.tail + 1) {
            let Some(inner) = inside.pop() else { break };
            let frame = station.row;
            let of = format!("the {what} in frame {frame}");
            let names = ["x", "y", "z"].map(|axis| format!("{axis}{frame}"));
            if let (Some(outer), Some(inner)) = (&outer.vector, &inner.vector) {
                rows(outer, inner, &of, names, group, &mut equations)?;
            }
            if let (Some(outer), Some(inner)) = (&outer.square, &inner.square) {
                equations.push(Equation {
                    polynomial: outer.sub(inner)?,
                    group: group + 1,
                    origin: Origin::whole(format!(
                        "squared distance of the {what} from the origin of frame {frame}"
                    )),
                    name: format!("n{frame}"),
                });
            }
            group += 2;
            outer = walker.back([&station.joint], outer);
            outer = walker.back(&station.link, outer);
        }
        Ok(Some((walker.atoms.clone(), equations)))
    }

    /// The equations of the frame behind the last joint, seen from both sides.
    pub(super) fn pose(&mut self) -> Result<(Atoms, Vec<Equation>), Trouble> {
        let walker = &mut self.walker;
        let one = Polynomial::number(walker.size(), Number::ONE);
        let Some(end) = self.stations.last() else { return Ok((walker.atoms.clone(), Vec::new())) };
        let behind = end.row + 1;
        let mut equations = Vec::new();
        let mut group = 0;
        for (index, letter) in ["x", "y", "z", ""].into_iter().enumerate() {
            let mut tip = Carried::origin();
            if let Some(entry) = tip.vector.as_mut().and_then(|vector| vector.get_mut(index)) {
                *entry = one.clone();
                tip = Carried { point: false, square: None, ..tip };
            }
            let what = if tip.point { "origin".to_owned() } else { format!("{letter} axis") };
            let mut outer = walker.back(&end.link, tip.clone());
            outer = walker.back(&self.before, outer);
            let mut inside = Vec::new();
            let mut inner = tip;
            for (place, station) in self.stations.iter().enumerate().rev() {
                if place + 1 < self.stations.len() {
                    inner = walker.along(&station.link, inner);
                }
                inner = walker.along([&station.joint], inner);
                inside.push(inner.clone());
            }
            for station in &self.stations {
                let Some(inner) = inside.pop() else { break };
                let frame = station.row;
                let of = format!("the {what} behind joint {behind} in frame {frame}");
                let names = ["x", "y", "z"].map(|axis| format!("{letter}{axis}{frame}"));
                if let (Some(outer), Some(inner)) = (&outer.vector, &inner.vector) {
                    rows(outer, inner, &of, names, group, &mut equations)?;
                }
                group += 1;
                outer = walker.back([&station.joint], outer);
                outer = walker.back(&station.link, outer);
            }
        }
        Ok((walker.atoms.clone(), equations))
    }

    /// The equations of the rotation, once the joints before it are known.
    pub(super) fn rotation(
        &mut self,
        atoms: Atoms,
        found: &[Found],
        open: &Open,
    ) -> Result<(Atoms, Vec<Equation>), Trouble> {
        let walker = &mut self.walker;
        walker.atoms = atoms;
        walker.roots = found.iter().filter_map(|found| found.unknown.replaced()).collect();
        for station in &mut self.stations {
            if let (Step::Turn(..), Some(form)) = (&station.joint, walker.unknowns.rows.get(station.row)) {
                let (sin, cos) = walker.form_sin_cos(form)?;
                station.joint = Step::Turn(sin, cos);
            }
        }
        let (zero, one) = (Polynomial::zero(), Polynomial::number(walker.size(), Number::ONE));
        let mut equations = Vec::new();
        let mut group = 0;
        for (index, letter) in ["x", "y", "z"].into_iter().enumerate() {
            let mut tip = [zero.clone(), zero.clone(), zero.clone()];
            if let Some(entry) = tip.get_mut(index) {
                *entry = one.clone();
            }
            let tip = Carried::direction(tip);
            let (Some(end), Some(first)) = (self.stations.last(), self.stations.first()) else { break };
            let names = |frame: usize| ["x", "y", "z"].map(|axis| format!("{letter}{axis}{frame}"));
            let mut outer = walker.back(&end.link, tip.clone());
            walker.shorten(&mut outer, open, &names(first.row))?;
            let mut inside = Vec::new();
            let mut inner = tip;
            for (place, station) in self.stations.iter().enumerate().skip(self.tail).rev() {
                if place + 1 < self.stations.len() {
                    inner = walker.along(&station.link, inner);
                }
                inner = walker.along([&station.joint], inner);
                inside.push(inner.clone());
            }
            let row = end.row;
            for (place, station) in self.stations.iter().enumerate() {
                let frame = station.row;
                if place >= self.tail {
                    let Some(inner) = inside.pop() else { break };
                    let of = format!("the {letter} axis behind joint {} in frame {frame}", row + 1);
                    if let (Some(outer), Some(inner)) = (&outer.vector, &inner.vector) {
                        rows(outer, inner, &of, names(frame), group, &mut equations)?;
                    }
                    group += 1;
                }
                outer = walker.back([&station.joint], outer);
                walker.shorten(&mut outer, open, &names(frame))?;
                outer = walker.back(&station.link, outer);
                let next = self.stations.get(place + 1).map_or(frame, |next| next.row);
                walker.shorten(&mut outer, open, &names(next))?;
            }
        }
        Ok((walker.atoms.clone(), equations))
    }

    /// What the expressions are in.
    pub(super) fn arena(&self) -> &Arena {
        self.walker.arena
    }

    /// Everything that has to be found.
    pub(super) fn open(&self) -> Open {
        super::closure::open(&self.walker.atoms, self.walker.unknowns)
    }
}

/// What of this is in equations.
pub(super) fn open_in(open: &Open, equations: &[Equation]) -> Open {
    let mut before = Open::default();
    for (key, _) in equations.iter().flat_map(|equation| equation.polynomial.terms()) {
        let within = |angle: &&usize| key.frequency.get(**angle).is_some_and(|k| *k != 0);
        before.angles.extend(open.angles.iter().filter(within));
        let slides = key.monomial.iter().map(|(atom, _)| *atom);
        before.slides.extend(slides.filter(|atom| open.slides.contains(atom)));
    }
    before.angles.sort_unstable();
    before.angles.dedup();
    before.slides.sort_unstable();
    before.slides.dedup();
    before
}

fn is_along_axis(step: &Step<'_>) -> bool {
    matches!(step, Step::Fixed(Element::Translate { axis: 2, .. }))
}

/// `point where axes 3, 4 and 5 meet`
fn meeting(stations: &[Station<'_>]) -> String {
    let mut rows: Vec<usize> = stations.iter().map(|station| station.row + 1).collect();
    rows.sort_unstable();
    let (last, others) = rows.split_last().map_or((0, &[][..]), |(last, others)| (*last, others));
    let others: Vec<String> = others.iter().map(ToString::to_string).collect();
    format!("point where axes {} and {last} meet", others.join(", "))
}

/// One equation a row.
fn rows(
    outer: &Vector,
    inner: &Vector,
    of: &str,
    names: [String; 3],
    group: usize,
    equations: &mut Vec<Equation>,
) -> Result<(), Overflow> {
    for ((row, name), (left, right)) in (1..).zip(names).zip(outer.iter().zip(inner)) {
        if left.len().max(right.len()) > LONGEST_ROW {
            continue;
        }
        equations.push(Equation {
            polynomial: left.sub(right)?,
            group,
            origin: Origin { rows: vec![row], ..Origin::whole(of.to_owned()) },
            name,
        });
    }
    Ok(())
}

impl Walker<'_> {
    /// The target as the link from behind the last joint to the first, M v = R^T (v - p).
    fn target_as_link<'s>(&mut self, plain: &Chain) -> Result<Vec<Step<'s>>, Trouble> {
        let names = Target::Pose.input_names();
        let inputs: Vec<Expr> = names.iter().map(|name| self.arena.leaf(name, Leaf::Known)).collect();
        let [a, b, c, x, d, e, f, y, g, h, i, z] = inputs[..] else { return Err(Trouble::Target) };
        let rotation = [[a, b, c], [d, e, f], [g, h, i]];
        let base = chain::rigid(self.arena, plain.links.first().map_or(&[][..], |link| &link.elements));
        let tool = self.behind_last_joint(plain);
        let turned = transform::product(self.arena, &rotation, &transform::transpose(&tool.rotation));
        let back = transform::transpose(&base.rotation);
        let whole = transform::product(self.arena, &back, &turned);
        let moved = self.last_origin(&base, &tool, &rotation, [x, y, z]);
        let [x, y, z] = transform::apply(self.arena, &back, moved);
        let minus = Number::integer(-1);
        let shift = [
            self.known("px0", x, 1)?.scaled(minus)?,
            self.known("py0", y, 1)?.scaled(minus)?,
            self.known("pz0", z, 1)?.scaled(minus)?,
        ];
        let mut columns = <[Vector; 3]>::default();
        for (i, row) in whole.into_iter().enumerate() {
            for (j, entry) in row.into_iter().enumerate() {
                let entry = self.known(&format!("r{}{}0", i + 1, j + 1), entry, 0)?;
                if let Some(place) = columns.get_mut(j).and_then(|column| column.get_mut(i)) {
                    *place = entry;
                }
            }
        }
        Ok(vec![Step::Rotation(Box::new(columns)), Step::Shift(Box::new(shift))])
    }

    /// From the inside of steps to their outside.
    fn along<'s, 'p: 's>(
        &mut self,
        steps: impl IntoIterator<Item = &'s Step<'p>, IntoIter: DoubleEndedIterator>,
        v: Carried,
    ) -> Carried {
        steps.into_iter().rev().fold(v, |v, step| self.step(step, v, false))
    }

    /// From the outside of steps to their inside.
    fn back<'s, 'p: 's>(&mut self, steps: impl IntoIterator<Item = &'s Step<'p>>, v: Carried) -> Carried {
        steps.into_iter().fold(v, |v, step| self.step(step, v, true))
    }

    /// The square of the length is carried too: of a rotation that is not known in numbers it would not be seen to leave it
    /// as it is. What has grown so long that no equation of it can have one unknown is dropped.
    fn step(&mut self, step: &Step<'_>, v: Carried, inward: bool) -> Carried {
        let Carried { point, vector, square } = v;
        let Some(vector) = vector else { return Carried { point, vector, square: None } };
        let square = square.and_then(|square| self.moved_square(step, &vector, square, inward).ok());
        let square = square.filter(|square| square.len() <= LONGEST_ROW);
        let vector = self.carry(step, vector, point, inward).ok();
        let vector = vector.filter(|vector| vector.iter().any(|entry| entry.len() <= LONGEST_ROW));
        Carried { point, vector, square }
    }

    /// |v ± t|^2 = |v|^2 ± 2 t v + |t|^2
    fn moved_square(
        &mut self,
        step: &Step<'_>,
        v: &Vector,
        square: Polynomial,
        inward: bool,
    ) -> Result<Polynomial, Overflow> {
        let twice = Number::integer(if inward { -2 } else { 2 });
        let plus = |square: Polynomial, along: &Polynomial, by: &Polynomial| {
            square.add_scaled(&along.mul(by)?, twice)?.add(&by.mul(by)?)
        };
        match (step, v) {
            (Step::Slide(by), [_, _, z]) => plus(square, z, by),
            (Step::Fixed(Element::Translate { axis, value, name, note }), v) => {
                let by = self.parameter(name, *value, note, 1);
                v.get(*axis).map_or(Ok(square.clone()), |along| plus(square, along, &by))
            }
            (Step::Shift(by), v) => {
                v.iter().zip(by.iter()).try_fold(square, |square, (along, by)| plus(square, along, by))
            }
            _ => Ok(square),
        }
    }

    /// Entries of which everything is known become atoms.
    fn shorten(&mut self, v: &mut Carried, open: &Open, names: &[String; 3]) -> Result<(), Overflow> {
        for (entry, name) in v.vector.iter_mut().flatten().zip(names) {
            if open.knows(entry) {
                *entry = short(entry, &mut self.atoms, name)?;
            }
        }
        Ok(())
    }
}
