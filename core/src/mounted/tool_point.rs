//! Targets that prescribe where the point of a mounted tool is, but not how the tool is turned.
//!
//! Where the point of the table's own tool has to be then depends on how the hand is turned there, which depends on where
//! it is: a fixed point, found branch by branch by Broyden's method (1965), in which every step solves the table's
//! problem. Where the problem holds the hand's rotation it takes one step.

use super::MountingFrame;
use crate::frame::{add, dot, sub};
use crate::solutions::{Solution, Solutions};
use crate::{Float, Frame, IkError, JointKind, Kinematics, MAX_JOINTS, SolutionSet, Target};

/// More steps than this find nothing.
const STEPS: u32 = 40;

/// So many places all over the workspace are begun at.
const ELSEWHERE: u32 = 8;

/// The root of x⁷ + x⁶ = 1: the ratio of the sequence of the lowest discrepancy in six dimensions \[Roberts 2018\].
const RATIO: f64 = 0.898_653_712_628_699_3;

/// So often a step is halved that leads to where there are no solutions.
const HALVINGS: u32 = 8;

/// The point is found where it is this many machine epsilons from where it should be, as a part of the lengths involved.
const FOUND: f64 = 4e3;

/// Solves targets of one problem.
pub(super) type Solver<'s, S> = dyn Fn(&Target<S>, &mut SolutionSet<S>) -> Result<(), IkError<S>> + 's;

/// A target at another place; `None` where it has none.
fn placed<S: Float>(target: &Target<S>, place: [S; 3]) -> Option<Target<S>> {
    let [x, y, _] = place;
    Some(match *target {
        Target::Position(_) => Target::Position(place),
        Target::Xy(_) => Target::Xy([x, y]),
        Target::PositionYaw { yaw, .. } => Target::PositionYaw { position: place, yaw },
        Target::PositionDirection { direction, .. } => {
            Target::PositionDirection { position: place, direction }
        }
        Target::XyYaw { yaw, .. } => Target::XyYaw { position: [x, y], yaw },
        _ => return None,
    })
}

/// The place of a target; 0 for what it leaves open.
fn place<S: Float>(target: &Target<S>) -> [S; 3] {
    match *target {
        Target::Position(place)
        | Target::PositionYaw { position: place, .. }
        | Target::PositionDirection { position: place, .. } => place,
        Target::Xy([x, y]) | Target::XyYaw { position: [x, y], .. } => [x, y, S::ZERO],
        _ => [S::ZERO; 3],
    }
}

/// Whether it can be done so: what the target says of the rotation must not change with the tool.
pub(super) fn is_of_place<S: Float>(target: &Target<S>, tool: &Frame<S>) -> bool {
    match target {
        Target::Position(_) | Target::Xy(_) => true,
        Target::PositionYaw { .. } | Target::PositionDirection { .. } | Target::XyYaw { .. } => {
            tool.rotation == Frame::IDENTITY.rotation
        }
        _ => false,
    }
}

/// Fills the set with solutions of `target` for the mounted arm; `solve` solves targets for the same arm without the
/// tool. Those are found that a branch of the target itself leads to, or one of a place beside it, a tool's length away,
/// between it and the base, or anywhere in the workspace.
pub(super) fn solve<S: Float>(
    mounted: &dyn Kinematics<S>,
    (base, tool): (&Frame<S>, &Frame<S>),
    target: &Target<S>,
    solve: &Solver<'_, S>,
    out: &mut SolutionSet<S>,
) -> Result<(), IkError<S>> {
    let search = Search { mounted, target, solve };
    let wanted = place(target);
    let reach = length(tool.translation);
    let beside = |axis: usize, way: S| {
        let mut place = wanted;
        place.iter_mut().skip(axis).take(1).for_each(|x| *x += way);
        place
    };
    let inwards = |part: f64| {
        let way = sub(wanted, base.translation).map(|x| x * S::from_f64(part));
        add(base.translation, way)
    };
    let sides = [0, 1, 2].map(|axis| [beside(axis, reach), beside(axis, -reach)]);
    let tool_point = |number| {
        let q = sample(mounted, number);
        mounted.fk(q.get(..mounted.dof())?).ok().map(|frame| frame.translation)
    };
    let elsewhere = (1..=ELSEWHERE).filter_map(tool_point);
    let near = sides.iter().flatten().copied().chain([inwards(0.5), inwards(0.75), wanted]);
    let mut found = Solutions::EMPTY;
    let mut outcome = Ok(());
    let mut begun = SolutionSet::new();
    for start in elsewhere.chain(near) {
        outcome = placed(target, start).map_or(Ok(()), |beside| solve(&beside, &mut begun));
        if outcome.is_ok() {
            for branch in begun.iter() {
                search.follow(start, branch.q, &mut found);
            }
        }
    }
    if found.is_empty() {
        outcome?;
        // There are solutions for the table's tool, and none of them leads to one for this.
        return Err(IkError::Mounting { frame: MountingFrame::Tool, target: target.kind() });
    }
    out.fill_padded(mounted.dof(), found);
    Ok(())
}

/// Joint values within the limits (a turn where there are none), which fill them evenly: an additive recurrence.
fn sample<S: Float>(arm: &dyn Kinematics<S>, number: u32) -> [S; MAX_JOINTS] {
    let mut q = [S::ZERO; MAX_JOINTS];
    let mut factor = S::ONE;
    for (value, joint) in q.iter_mut().zip(arm.joints()) {
        factor *= S::from_f64(RATIO);
        let part = S::from_f64(0.5) + factor * S::from_f64(f64::from(number));
        let (min, max) = joint.limits.map_or((-S::PI, S::PI), |limits| (limits.min, limits.max));
        *value = min + (part - part.floor()) * (max - min);
    }
    q
}

struct Search<'s, S: Float> {
    mounted: &'s dyn Kinematics<S>,
    target: &'s Target<S>,
    solve: &'s Solver<'s, S>,
}

impl<S: Float> Search<'_, S> {
    /// From a solution for the table's tool at this place on the same branch to where the mounted one meets the target, and
    /// adds all solutions that do so there.
    fn follow(&self, from: [S; 3], q: &[S], found: &mut Solutions<MAX_JOINTS, S>) -> Option<()> {
        let mut here = from;
        let mut joints = padded(q);
        let mut off = self.off(q)?;
        let near = S::from_f64(FOUND) * S::EPSILON * (length(place(self.target)) + length(off));
        // Of the way that the tool point moves by the way that the table's does.
        let mut inverse = Frame::<S>::IDENTITY.rotation;
        let mut set = SolutionSet::new();
        for _ in 0..STEPS {
            let step = self.step(here, times(&inverse, off).map(|x| -x), &mut set)?;
            here = add(here, step);
            let far = |q: &[S]| self.travel(q, &joints);
            let nearest = set.iter().reduce(|a, b| if far(b.q) < far(a.q) { b } else { a })?;
            let next = self.off(nearest.q)?;
            // Near a singularity the solution itself is less exact.
            let near = near + S::from_f64(2.0) * nearest.position_error;
            if length(next) <= near {
                for solution in
                    set.iter().filter(|one| self.off(one.q).is_some_and(|off| length(off) <= near))
                {
                    let (q, free) = (padded(solution.q), solution.free);
                    let (position_error, rotation_error) = (S::ZERO, S::ZERO);
                    found.push(
                        Solution { q, position_error, rotation_error, free },
                        self.mounted.rules().windings,
                    );
                }
                return Some(());
            }
            joints = padded(nearest.q);
            let change = times(&inverse, sub(next, off));
            let scale = dot(step, change);
            if scale != S::ZERO {
                let row = transposed(&inverse, step);
                for (x, to) in sub(step, change).into_iter().zip(&mut inverse) {
                    to.iter_mut().zip(row).for_each(|(entry, y)| *entry += x * y / scale);
                }
            }
            off = next;
        }
        None
    }

    /// The step, or as much of it as stays where there are solutions, and those.
    fn step(&self, from: [S; 3], step: [S; 3], set: &mut SolutionSet<S>) -> Option<[S; 3]> {
        let mut step = step;
        for _ in 0..HALVINGS {
            if (self.solve)(&placed(self.target, add(from, step))?, set).is_ok() {
                return Some(step);
            }
            step = step.map(|x| x * S::from_f64(0.5));
        }
        None
    }

    /// How far the point of the mounted tool is from where it should be, in what the target prescribes.
    fn off(&self, q: &[S]) -> Option<[S; 3]> {
        let [x, y, z] = sub(self.mounted.fk(q).ok()?.translation, place(self.target));
        let flat = matches!(self.target, Target::Xy(_) | Target::XyYaw { .. });
        Some([x, y, if flat { S::ZERO } else { z }])
    }

    /// Between joint values, whole turns aside.
    fn travel(&self, q: &[S], other: &[S]) -> S {
        let joints = q.iter().zip(other).zip(self.mounted.joints());
        joints.fold(S::ZERO, |sum, ((a, b), joint)| {
            let way = *a - *b;
            let way = if joint.kind == JointKind::Revolute { way.wrap_angle() } else { way };
            sum + way * way
        })
    }
}

fn padded<S: Float>(q: &[S]) -> [S; MAX_JOINTS] {
    let mut padded = [S::ZERO; MAX_JOINTS];
    padded.iter_mut().zip(q).for_each(|(to, from)| *to = *from);
    padded
}

fn length<S: Float>(vector: [S; 3]) -> S {
    dot(vector, vector).sqrt()
}

fn times<S: Float>(matrix: &[[S; 3]; 3], vector: [S; 3]) -> [S; 3] {
    matrix.map(|row| dot(row, vector))
}

/// The transposed matrix times a vector.
fn transposed<S: Float>(matrix: &[[S; 3]; 3], vector: [S; 3]) -> [S; 3] {
    let rows = matrix.iter().zip(vector);
    rows.fold([S::ZERO; 3], |sum, (row, x)| add(sum, row.map(|entry| entry * x)))
}
