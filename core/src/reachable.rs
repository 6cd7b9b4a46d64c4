//! The target nearest to one that cannot be reached.

use crate::evenly::evenly;
use crate::frame::{dot, norm, sub};
use crate::kinematics::padded;
use crate::selection::nearest_winding;
use crate::{
    Axis, Bound, Float, Frame, IkError, JointKind, KeepOut, Kinematics, LengthError, Limits, MAX_JOINTS,
    Side, Target,
};

/// One term of a linear equation between joint values that an inverse problem prescribes. The terms of an equation add up
/// to 0, or to whole turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstraintTerm {
    /// Which of the problem's equations.
    pub equation: usize,
    /// Index of q; `None` for the constant.
    pub joint: Option<usize>,
    /// Factor of the joint value, or the constant itself (rad or m).
    pub coefficient: f64,
}

/// Joint values inside their limits that bring the tool as near to a target as they can.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reachable<S = f64> {
    q: [S; MAX_JOINTS],
    dof: usize,
    /// The tool frame there (m): any target that is read from it can be reached.
    pub tool: Frame<S>,
    /// m, of what the target prescribes
    pub position_error: S,
    /// rad, of what the target prescribes
    pub rotation_error: S,
}

impl<S> Reachable<S> {
    /// Joint values (rad or m).
    pub fn q(&self) -> &[S] {
        self.q.get(..self.dof).unwrap_or(&self.q)
    }
}

/// How many places the descent is started from.
const STARTS: u32 = 16;

/// How many steps each descent makes, and the one that goes on from the best: where much is missing, each step takes a part
/// of what is left only.
const STEPS: [usize; 2] = [200, 2000];

/// What the damping is multiplied by after a step that led uphill, and divided by after one that did not.
const DAMPING: f64 = 4.0;

/// Rows of what a target prescribes.
const ROWS: usize = 6;

/// More equations than this between joints are not looked at, nor more limits on sums of joints, nor rules of the workspace.
const EQUATIONS: usize = 8;

/// All that is to become 0.
const ALL: usize = ROWS + 3 * EQUATIONS;

/// The target nearest to `target` that a problem of an arm reaches inside the limits of its joints: see
/// [`Kinematics::nearest_reachable`].
pub(crate) fn nearest<K: Kinematics<S> + ?Sized, S: Float>(
    arm: &K,
    problem: &str,
    target: &Target<S>,
    seed: Option<&[S]>,
) -> Result<Reachable<S>, IkError<S>> {
    let info = arm.problems().iter().find(|info| info.name == problem).ok_or(IkError::UnknownProblem)?;
    let target = target.validate_as(info.target)?;
    let dof = arm.dof();
    if let Some(seed) = seed {
        LengthError::check(dof, seed.len())?;
    }
    let first = seed.map_or_else(|| arm.rules().middle(), padded);
    let per_reach = S::ONE / size(arm)?;
    let descent = Descent { arm, target: &target, terms: info.constraints, dof, per_reach };
    let mut best: Option<([S; MAX_JOINTS], S)> = None;
    for number in 0..STARTS {
        let (q, cost) = descent.run(if number == 0 { first } else { descent.start(number) }, STEPS[0]);
        // Of equal ones the first, which is nearest to the seed.
        let better = |least: S| cost < least - S::SQRT_EPSILON * least;
        if cost.is_finite() && best.is_none_or(|(_, least)| better(least)) {
            best = Some((q, cost));
        }
    }
    let (q, _) = best.ok_or(IkError::NotFinite)?;
    let (q, _) = descent.run(q, STEPS[1]);
    let q = nearest_winding(&arm.rules(), &q, &first);
    let tool = arm.fk(q.get(..dof).unwrap_or(&q))?;
    let (position_error, rotation_error) = target.errors(&tool);
    Ok(Reachable { q, dof, tool, position_error, rotation_error })
}

/// A range without its edges: a limit that is approached from outside holds in the end.
fn inside<S: Float>(range: &Limits<S>, spare: S) -> Limits<S> {
    let edge = spare.min((range.max - range.min) / S::TWO);
    Limits { min: range.min + edge, max: range.max - edge }
}

/// Roughly the size of the arm (m): as far as the origins of its frames are apart in one pose.
pub(crate) fn size<K: Kinematics<S> + ?Sized, S: Float>(arm: &K) -> Result<S, LengthError> {
    let mut frames = [Frame::IDENTITY; 2 * MAX_JOINTS];
    let joints = arm.rules().middle::<MAX_JOINTS>();
    let q = joints.get(..arm.dof()).unwrap_or(&joints);
    let count = arm.frames_into(q, &mut frames)?;
    let mut last = arm.fk(q)?.translation;
    let mut sum = S::ZERO;
    for frame in frames.iter().take(count).rev() {
        sum += norm(sub(last, frame.translation));
        last = frame.translation;
    }
    Ok(if sum > S::ZERO && sum.is_finite() { sum } else { S::ONE })
}

/// How far (m) a point is beyond a bound, with an edge to spare, and the direction that leads back.
fn beyond<S: Float>(bound: &Bound<S>, edge: S, point: [S; 3]) -> (S, [S; 3]) {
    let value = bound.axis.of(point);
    match bound.side {
        Side::Min => (bound.value + edge - value, along(bound.axis, S::ONE)),
        Side::Max => (value - bound.value + edge, along(bound.axis, -S::ONE)),
    }
}

/// How far (m) a point is inside a box, with an edge to spare, and the direction that leads out of it where it is nearest.
fn within<S: Float>(keep: &KeepOut<S>, edge: S, point: [S; 3]) -> (S, [S; 3]) {
    let mut least = (S::INFINITY, [S::ZERO; 3]);
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        let value = axis.of(point);
        let sides = [(value - axis.of(keep.min), -S::ONE), (axis.of(keep.max) - value, S::ONE)];
        for (depth, side) in sides {
            if depth + edge < least.0 {
                least = (depth + edge, along(axis, side));
            }
        }
    }
    least
}

/// The unit vector along an axis, or against it.
fn along<S: Float>(axis: Axis, side: S) -> [S; 3] {
    [Axis::X, Axis::Y, Axis::Z].map(|other| if other == axis { side } else { S::ZERO })
}

/// A descent by damped Gauss-Newton steps \[Levenberg 1944, Marquardt 1963\] inside the limits.
struct Descent<'a, K: ?Sized, S> {
    arm: &'a K,
    target: &'a Target<S>,
    terms: &'a [ConstraintTerm],
    dof: usize,
    /// 1/m
    per_reach: S,
}

/// What is to become 0, and how it changes with each joint.
struct Local<S> {
    rows: [S; ALL],
    columns: [[S; ALL]; MAX_JOINTS],
    cost: S,
}

impl<K: Kinematics<S> + ?Sized, S: Float> Descent<'_, K, S> {
    /// Joint values that fill the space inside the limits evenly.
    fn start(&self, number: u32) -> [S; MAX_JOINTS] {
        let mut q = [S::ZERO; MAX_JOINTS];
        let parts = evenly::<S, MAX_JOINTS>(number, self.dof);
        for ((value, joint), part) in q.iter_mut().zip(self.arm.joints()).zip(parts) {
            let half = if joint.kind == JointKind::Revolute { S::PI } else { S::ONE / self.per_reach };
            let (min, max) = joint.limits.map_or((-half, half), |limits| (limits.min, limits.max));
            *value = (min + max) / S::TWO + part * (max - min);
        }
        q
    }

    fn run(&self, start: [S; MAX_JOINTS], steps: usize) -> ([S; MAX_JOINTS], S) {
        let mut q = self.clamped(start);
        let mut local = self.local(&q);
        let mut damping = S::from_f64(1e-2);
        for _ in 0..steps {
            let step = self.step(&q, &local, damping);
            let mut next = q;
            next.iter_mut().zip(step).for_each(|(value, change)| *value += change);
            let next = self.clamped(next);
            let moved = next.iter().zip(&q).fold(S::ZERO, |most, (a, b)| most.max((*a - *b).abs()));
            let there = self.local(&next);
            if there.cost < local.cost {
                (q, local) = (next, there);
                damping = (damping / S::from_f64(DAMPING)).max(S::EPSILON);
            } else {
                damping *= S::from_f64(DAMPING);
            }
            if moved <= S::EPSILON.max(S::SQRT_EPSILON * S::from_f64(1e-3)) {
                break;
            }
        }
        (q, local.cost)
    }

    fn clamped(&self, mut q: [S; MAX_JOINTS]) -> [S; MAX_JOINTS] {
        for (value, joint) in q.iter_mut().zip(self.arm.joints()) {
            *value = joint.limits.map_or(*value, |limits| limits.clamp(*value));
        }
        q
    }

    fn local(&self, q: &[S; MAX_JOINTS]) -> Local<S> {
        let joints = q.get(..self.dof).unwrap_or(q);
        let mut twists = [[S::ZERO; 6]; MAX_JOINTS];
        let nowhere = Frame { translation: [S::NAN; 3], ..Frame::IDENTITY };
        let jacobian = self.arm.jacobian_into(joints, &mut twists);
        let tool = jacobian.and_then(|()| self.arm.fk(joints)).unwrap_or(nowhere);
        let mut local = Local { rows: [S::ZERO; ALL], columns: [[S::ZERO; ALL]; MAX_JOINTS], cost: S::ZERO };
        let own = self.target.missing(&tool, self.per_reach);
        local.rows.iter_mut().zip(own).for_each(|(row, own)| *row = own);
        for (column, twist) in local.columns.iter_mut().zip(&twists).take(self.dof) {
            let gained = self.target.gained(&tool, twist, self.per_reach);
            column.iter_mut().zip(gained).for_each(|(entry, gained)| *entry = -gained);
        }
        // So heavy that what is left of them is some 1e-8 of what is missing; limits and rules have that to spare.
        let weight = S::ONE / S::SQRT_EPSILON.sqrt();
        let missing = local.rows.iter().fold(S::ZERO, |sum, row| sum + *row * *row).sqrt();
        let spare = S::SQRT_EPSILON * (S::ONE + S::TWO * missing);
        for (equation, row) in local.rows.iter_mut().skip(ROWS).take(EQUATIONS).enumerate() {
            let terms = self.terms.iter().filter(|term| term.equation == equation);
            let mut turns = false;
            for term in terms {
                let factor = S::from_f64(term.coefficient);
                let Some(joint) = term.joint else {
                    *row += factor;
                    continue;
                };
                *row += factor * q.get(joint).copied().unwrap_or(S::ZERO);
                turns |= self.arm.joints().get(joint).is_some_and(|joint| joint.kind == JointKind::Revolute);
                let entry = local.columns.get_mut(joint).and_then(|column| column.get_mut(ROWS + equation));
                if let Some(entry) = entry {
                    *entry += factor * weight;
                }
            }
            *row = weight * if turns { row.wrap_angle() } else { *row };
        }
        let sums = self.arm.rules().sums.iter().take(EQUATIONS);
        for (place, sum) in (ROWS + EQUATIONS..).zip(sums) {
            let value = sum.value(joints);
            let excess = value - inside(&sum.range, spare).clamp(value);
            if excess == S::ZERO {
                continue;
            }
            if let Some(row) = local.rows.get_mut(place) {
                *row = weight * excess;
            }
            for (joint, factor) in sum.terms {
                let entry = local.columns.get_mut(*joint).and_then(|column| column.get_mut(place));
                if let Some(entry) = entry {
                    *entry += *factor * weight;
                }
            }
        }
        self.keep_workspace(tool.translation, &twists, [weight, spare], &mut local);
        local.cost = local.rows.iter().fold(S::ZERO, |sum, row| sum + *row * *row);
        local
    }

    /// What the rules of the workspace make of the tool point (m), as far as they are broken: with a weight, and a distance to
    /// spare (both in reaches).
    fn keep_workspace(
        &self,
        point: [S; 3],
        twists: &[[S; 6]; MAX_JOINTS],
        [weight, spare]: [S; 2],
        local: &mut Local<S>,
    ) {
        let rules = self.arm.rules();
        let (weight, edge) = (weight * self.per_reach, spare / self.per_reach);
        let bounds = rules.bounds.iter().map(|bound| beyond(bound, edge, point));
        let boxes = rules.keep_out.iter().map(|keep| within(keep, edge, point));
        let broken = bounds.chain(boxes).take(EQUATIONS).enumerate();
        for (number, (depth, out)) in broken.filter(|(_, (depth, _))| *depth > S::ZERO) {
            let place = ROWS + 2 * EQUATIONS + number;
            if let Some(row) = local.rows.get_mut(place) {
                *row = weight * depth;
            }
            for (column, [x, y, z, ..]) in local.columns.iter_mut().zip(twists).take(self.dof) {
                if let Some(entry) = column.get_mut(place) {
                    *entry = -weight * dot(out, [*x, *y, *z]);
                }
            }
        }
    }

    /// The step from the normal equations of the joints that may move, by Cholesky's factorisation.
    fn step(&self, q: &[S; MAX_JOINTS], local: &Local<S>, damping: S) -> [S; MAX_JOINTS] {
        let dot = |a: &[S; ALL], b: &[S; ALL]| a.iter().zip(b).fold(S::ZERO, |sum, (a, b)| sum + *a * *b);
        let mut columns = local.columns;
        // A joint at its limit that would go on outwards stays.
        for ((column, joint), value) in columns.iter_mut().zip(self.arm.joints()).zip(q) {
            let downhill = -dot(column, &local.rows);
            let stuck = joint.limits.is_some_and(|limits| {
                (*value <= limits.min && downhill < S::ZERO) || (*value >= limits.max && downhill > S::ZERO)
            });
            if stuck {
                *column = [S::ZERO; ALL];
            }
        }
        // Columns over the damping, made orthogonal one after the other: the same as a factorisation of the normal equations.
        let mut step = [S::ZERO; MAX_JOINTS];
        let mut factor = [[S::ZERO; MAX_JOINTS]; MAX_JOINTS];
        let dof = self.dof.min(MAX_JOINTS);
        for i in 0..dof {
            let Some((done, [row, ..])) = factor.split_at_mut_checked(i) else { break };
            let Some(own) = columns.get(i) else { break };
            for (j, (above, other)) in done.iter().zip(&columns).enumerate() {
                let part = row.iter().zip(above).take(j).fold(S::ZERO, |sum, (a, b)| sum + *a * *b);
                let diagonal = above.get(j).copied().unwrap_or(S::ONE);
                if let Some(slot) = row.get_mut(j) {
                    *slot = (dot(own, other) - part) / diagonal;
                }
            }
            let part = row.iter().take(i).fold(S::ZERO, |sum, a| sum + *a * *a);
            let rest = (dot(own, own) + damping - part).max(S::EPSILON * damping);
            if let Some(slot) = row.get_mut(i) {
                *slot = rest.sqrt();
            }
        }
        for i in 0..dof {
            let Some(row) = factor.get(i) else { break };
            let part = row.iter().zip(&step).take(i).fold(S::ZERO, |sum, (a, b)| sum + *a * *b);
            let right = columns.get(i).map_or(S::ZERO, |column| -dot(column, &local.rows));
            let diagonal = row.get(i).copied().unwrap_or(S::ONE);
            if let Some(slot) = step.get_mut(i) {
                *slot = (right - part) / diagonal;
            }
        }
        for i in (0..dof).rev() {
            let below = factor.iter().zip(&step).take(dof).skip(i + 1);
            let part = below
                .fold(S::ZERO, |sum, (row, value)| sum + row.get(i).copied().unwrap_or(S::ZERO) * *value);
            let diagonal = factor.get(i).and_then(|row| row.get(i)).copied().unwrap_or(S::ONE);
            if let Some(slot) = step.get_mut(i) {
                *slot = (*slot - part) / diagonal;
            }
        }
        step
    }
}
