//! The equations of a problem: what is prescribed, written in every frame of the chain.
//!
//! A prescribed point (or direction) is carried from the base to the frame before each joint by the inverses of the
//! joints passed, and the same point is carried from the tip to that frame by the joints that follow. Both sides are
//! equal, row by row, whatever frame they are written in; which frame is simplest differs from arm to arm.

use super::atoms::{AngleData, Atoms};
use super::polynomial::{Overflow, Polynomial};
use super::tracked::{Seen, Tracked};
use super::unknowns::{Free, Unknowns};
use super::walk::{Step, Vector, Walker};
use crate::model::{JointKind, Model, Target};
use crate::symbolic::expression::{Arena, Expr, Leaf};
use crate::symbolic::number::Number;
use std::fmt;

/// polynomial = 0, and where it comes from.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    pub polynomial: Polynomial,
    /// Frame and tracked quantity; rows of one group are coordinates of one vector.
    pub group: usize,
    /// Where it comes from.
    pub origin: Origin,
    /// What its known part is called: `y1`.
    pub name: String,
}

/// Where an equation comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Origin {
    /// Whether it is a sum of squares.
    pub squares: bool,
    /// Rows of a vector (1-based); none where `of` says it all.
    pub rows: Vec<usize>,
    /// "the position in frame 1"
    pub of: String,
    /// A second equation beside it, of another vector.
    pub and: Option<Box<Origin>>,
}

impl Origin {
    pub(super) fn whole(of: String) -> Self {
        Self { squares: false, rows: Vec::new(), of, and: None }
    }

    /// Of two equations together.
    pub(super) fn with(&self, other: &Self) -> Self {
        if self.of == other.of && self.squares == other.squares && !self.rows.is_empty() {
            let rows = [self.rows.as_slice(), &other.rows].concat();
            return Self { rows, ..self.clone() };
        }
        Self { and: Some(Box::new(other.clone())), ..self.clone() }
    }
}

/// "squares of rows 1 and 2 of the position in frame 1"
impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.squares {
            f.write_str("squares of ")?;
        }
        match self.rows.as_slice() {
            [] => {}
            [row] => write!(f, "row {row} of ")?,
            [first, second] => write!(f, "rows {first} and {second} of ")?,
            _ => f.write_str("all rows of ")?,
        }
        f.write_str(&self.of)?;
        match &self.and {
            Some(other) => write!(f, "; {other}"),
            None => Ok(()),
        }
    }
}

/// Why no equations could be written.
#[derive(Debug, Clone, Copy)]
pub(super) enum Trouble {
    /// See [`Overflow`].
    Overflow,
    /// This target is not solved by this method.
    Target,
}

impl From<Overflow> for Trouble {
    fn from(_: Overflow) -> Self {
        Self::Overflow
    }
}

/// Vocabulary, prescribed numbers and equations of a problem.
pub(super) struct Closure {
    pub atoms: Atoms,
    pub equations: Vec<Equation>,
}

/// Writes the equations.
pub(super) fn build(
    arena: &mut Arena,
    model: &Model,
    target: Target,
    unknowns: &Unknowns,
    seen: Seen,
) -> Result<Closure, Trouble> {
    let plain = if target.is_any_turn() { model.chain_to_tool_axis() } else { model.chain() };
    let mut walker = Walker { arena, model, unknowns, atoms: Atoms::default(), roots: Vec::new() };
    walker.angles(&plain);
    let inputs: Vec<Expr> =
        target.input_names().iter().map(|name| walker.arena.leaf(name, Leaf::Known)).collect();
    let mut equations = Vec::new();
    let mut group = 0;
    let tracked = match seen {
        Seen::FromBase => walker.tracked(&plain, target, &inputs)?,
        Seen::FromTool => walker.tracked_base(&plain, target, &inputs)?,
    };
    for tracked in tracked {
        walker.track(&plain, &tracked, &mut group, &mut equations)?;
    }
    if let Some((cos, sin)) = yaw_inputs(target, &inputs) {
        walker.yaw(&plain, cos, sin, &mut group, &mut equations)?;
    }
    Ok(Closure { atoms: walker.atoms, equations })
}

fn yaw_inputs(target: Target, inputs: &[Expr]) -> Option<(Expr, Expr)> {
    match (target, inputs) {
        (Target::PositionYaw | Target::XyYaw, [.., cos, sin]) => Some((*cos, *sin)),
        _ => None,
    }
}

impl Walker<'_> {
    /// Equations of one tracked vector in the frame before every joint.
    fn track(
        &mut self,
        plain: &crate::model::Chain,
        tracked: &Tracked,
        group: &mut usize,
        equations: &mut Vec<Equation>,
    ) -> Result<(), Trouble> {
        let steps = self.steps(plain)?;
        let last = steps.len().saturating_sub(1);
        // From the tip: the vector in the frame before each joint, the tip first, as far as it stays short.
        let mut inner = Some(tracked.tip.clone());
        let mut from_tip = Vec::new();
        for (index, (joint, link)) in steps.iter().enumerate().rev() {
            if !(index == last && !tracked.whole && index > 0) {
                inner = self.through(link.iter().rev(), inner, tracked.point, false);
            }
            if let Some(joint) = joint {
                inner = self.through([joint].into_iter(), inner, tracked.point, false);
                from_tip.extend(inner.clone().map(|inner| (index, inner)));
            }
        }
        from_tip.reverse();
        let mut known = Some(tracked.target.clone());
        let mut norms = Vec::new();
        for (index, (joint, link)) in steps.iter().enumerate() {
            let Some(outer) = known.take() else { break };
            let mut next = Some(outer.clone());
            if let Some(joint) = joint {
                let frame = plain.joints.get(index.wrapping_sub(1)).map_or(0, |joint| joint.row);
                if let Some((_, inner)) = from_tip.iter().find(|(at, _)| *at == index) {
                    for (row, (left, right)) in outer.iter().zip(inner).enumerate() {
                        if left.len().max(right.len()) > LONGEST_ROW {
                            continue;
                        }
                        equations.push(Equation {
                            polynomial: left.sub(right)?,
                            group: *group,
                            origin: Origin {
                                rows: vec![row + 1],
                                ..Origin::whole(format!("the {} in frame {frame}", tracked.what))
                            },
                            name: tracked.row_name(row, frame),
                        });
                    }
                    if tracked.point {
                        norms.push((frame, squared(&outer).unwrap_or(None), squared(inner).unwrap_or(None)));
                    }
                }
                *group += 1;
                next = self.through([joint].into_iter(), next, tracked.point, true);
            }
            if index == last && joint.is_some() {
                break;
            }
            if index > 0 || !tracked.after_base {
                next = self.through(link.iter(), next, tracked.point, true);
            }
            known = next;
        }
        // Where axes meet, a distance knows less of the joints than the coordinates do.
        for (frame, outer, inner) in norms {
            if let (Some(outer), Some(inner)) = (outer, inner) {
                *group += 1;
                equations.push(Equation {
                    polynomial: outer.sub(&inner)?,
                    group: *group,
                    origin: Origin::whole(format!(
                        "squared distance of the {} from the origin of frame {frame}",
                        tracked.what
                    )),
                    name: format!("n{frame}"),
                });
            }
        }
        Ok(())
    }

    /// A vector through steps, unless it grows so long there that no row of it can have one unknown.
    fn through<'s, 'p: 's>(
        &mut self,
        steps: impl Iterator<Item = &'s Step<'p>>,
        v: Option<Vector>,
        point: bool,
        inward: bool,
    ) -> Option<Vector> {
        let mut v = v?;
        for step in steps {
            v = self.carry(step, v, point, inward).ok()?;
        }
        v.iter().any(|entry| entry.len() <= LONGEST_ROW).then_some(v)
    }

    /// The heading of the tool's x axis in the base frame is the yaw.
    fn yaw(
        &mut self,
        plain: &crate::model::Chain,
        cos: Expr,
        sin: Expr,
        group: &mut usize,
        equations: &mut Vec<Equation>,
    ) -> Result<(), Trouble> {
        let size = self.size();
        let one = Polynomial::number(size, Number::ONE);
        let axis = [one.clone(), Polynomial::zero(), Polynomial::zero()];
        let [x, y, _] = self.tip_in_base(plain, axis, false)?;
        let (cos, sin) = (self.known("cyaw", cos, 0)?, self.known("syaw", sin, 0)?);
        let level = x.mul(&x)?.add(&y.mul(&y)?)?.sub(&one)?.is_zero();
        let rows = if level {
            vec![(x.sub(&cos)?, "cosine of the yaw"), (y.sub(&sin)?, "sine of the yaw")]
        } else {
            vec![(x.mul(&sin)?.sub(&y.mul(&cos)?)?, "yaw")]
        };
        for (polynomial, what) in rows {
            equations.push(Equation {
                polynomial,
                group: *group,
                origin: Origin::whole(what.to_string()),
                name: "w".to_string(),
            });
        }
        *group += 1;
        Ok(())
    }
}

/// Longer rows are not made equations: they never have one unknown.
pub(super) const LONGEST_ROW: usize = 192;

/// Vectors with longer entries are not squared.
const LONGEST_SQUARED: usize = 24;

/// x^2 + y^2 + z^2, unless it would be too long.
fn squared(v: &Vector) -> Result<Option<Polynomial>, Overflow> {
    if v.iter().any(|entry| entry.len() > LONGEST_SQUARED) {
        return Ok(None);
    }
    let mut sum = Polynomial::zero();
    for entry in v {
        sum.add_product(entry, entry, Number::ONE)?;
    }
    Ok(Some(sum))
}

/// Everything that has to be found.
pub(super) fn open(atoms: &Atoms, unknowns: &Unknowns) -> super::reading::Open {
    let angles = atoms.angles.iter().enumerate();
    let unknown = |index: usize| unknowns.free.get(index).is_some_and(|free| free.given.is_none());
    let angles = angles.filter(|(_, angle)| matches!(angle, AngleData::Free(index) if unknown(*index)));
    let slides = (0..atoms.list.len()).map(|index| index as super::polynomial::Atom);
    // A slide that no equation contains stays open, and the problem unsolved.
    let slide = |free: &&Free| free.kind == JointKind::Prismatic && free.given.is_none();
    let absent = unknowns.free.iter().filter(slide).count();
    let mut slides: Vec<_> = slides.filter(|atom| atoms.slide(*atom).is_some_and(unknown)).collect();
    while slides.len() < absent {
        slides.push(super::polynomial::Atom::MAX);
    }
    super::reading::Open { angles: angles.map(|(index, _)| index).collect(), slides }
}
