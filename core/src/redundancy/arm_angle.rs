//! Spherical-roll-spherical arms by their arm angle, that of the plane through shoulder, elbow and wrist about the line
//! from shoulder to wrist (Shimizu et al., "Analytical inverse kinematic computation for 7-DOF redundant manipulators with
//! joint limits", IEEE Transactions on Robotics 24, 2008; Elias and Wen, "Redundancy parameterization and inverse kinematics
//! of 7-DOF revolute manipulators", 2023, call it the conventional SEW angle).
//!
//! The axes at q = 0 are all that is needed: each joint turns what is behind it about its axis there. The pose has the
//! wrist's place, its distance from the shoulder the fourth joint; that place and the arm angle make a frame, which tells
//! how shoulder or wrist are turned; and a turn about three axes through a point is two roots for the middle one. So there
//! are up to four values of the free joint, and the solutions there that have the arm angle are those wanted.

use super::{Arm, Redundancy};
use crate::frame::{add, cross, dot, matrix_product, matrix_vector, norm, sub, transpose};
use crate::solutions::travel;
use crate::{Float, Frame, IkError, Solution, Solutions, Target, TargetKind};

/// Joints of such an arm; the fourth is the elbow, with three before and behind it.
const JOINTS: usize = 7;
const ELBOW: usize = 3;

/// A solution has an arm angle if it differs by no more than this many times the square root of the machine epsilon (rad):
/// where the free joint turns back, the angle is known to half of the digits.
const SAME: f64 = 64.0;

/// A pose is met to this many machine epsilons (reaches, rad). Where the first and the last of three axes are nearly on one line,
/// the arm angle is open by as much over the sine between them.
const MET: f64 = 16_384.0;

/// Where the elbow is nearly straight or folded, too, the arm angle is known to a quarter of the digits, and of a straight arm to
/// none: what differs by this many times the fourth root of the machine epsilon is taken where there is nothing better.
const DOUBTFUL: f64 = 8.0;

/// What is shorter than this many machine epsilons (of the reach, or of 1) has no direction.
const NOTHING: f64 = 4096.0;

/// Axes are on one line if the sine of their angle is less than this many times the square root of the machine epsilon: where
/// they are, the joint between them is a double root.
const ON_ONE_LINE: f64 = 8.0;

type Matrix<S> = [[S; 3]; 3];

/// A spherical-roll-spherical arm at q = 0.
#[derive(Debug, Clone, Copy)]
struct Shape<S> {
    /// Unit vectors along the axes, about which the values of the joints count.
    axes: [[S; 3]; JOINTS],
    /// Where the first three axes meet (m).
    shoulder: [S; 3],
    /// Where the shoulder's foot is on the fourth axis (m).
    elbow: [S; 3],
    /// Where the last three axes meet (m).
    wrist: [S; 3],
    tool: Frame<S>,
    /// m
    reach: S,
}

/// A value of the free joint that may have the arm angle.
#[derive(Clone, Copy)]
struct Choice<S> {
    value: S,
    /// The fourth joint there (rad).
    elbow: S,
    /// Whether any other has it too: the first and the last of three axes are on one line.
    any: bool,
}

/// What an arm angle is to a solution.
#[derive(Clone, Copy)]
enum Verdict<S> {
    Has,
    /// It has it as far as can be told.
    MayHave,
    /// By how much (rad).
    Differs(S),
}

impl<S: Float> Redundancy<'_, S> {
    /// The arm angle at these joint values (rad, in (-pi, pi]): by how much the elbow is turned about the line from the
    /// shoulder, where the first three axes meet, to the wrist, where the last three do, away from the side to which the
    /// first axis points. Positive turns are right-handed about that line. `None` where the arm is not
    /// spherical-roll-spherical.
    ///
    /// The elbow is the point of the fourth axis that is nearest to the shoulder. Where it is on the line from shoulder to
    /// wrist, the plane at right angles to the fourth axis stands for it; where the wrist is on the first axis, the x or y
    /// axis of the base stands for that. There the arm angle jumps.
    pub fn arm_angle<const N: usize>(
        &self,
        state: impl Fn(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
        q: &[S; N],
    ) -> Option<S> {
        self.shape(state).map(|shape| shape.arm_angle(q))
    }

    /// Every geometric solution (limits ignored) of a pose with this arm angle (rad), see [`Redundancy::arm_angle`].
    /// Where the arm angle leaves the free joint open, since the first and the last axis of shoulder or wrist are on one line, it
    /// is 0, and marked.
    ///
    /// # Errors
    /// Those of the arm's solutions with the free joint given; [`IkError::Failed`] where there are some, but none has this arm
    /// angle, with how far the nearest one that was tried is from it: axes that aren't at right angles leave some out.
    /// [`IkError::UnknownProblem`] where the arm is not spherical-roll-spherical.
    pub fn by_arm_angle<const N: usize, A, F>(
        &self,
        arm: Arm<A, F>,
        target: &Target<S>,
        arm_angle: S,
    ) -> Result<Solutions<N, S>, IkError<S>>
    where
        A: FnMut(S) -> Result<Solutions<N, S>, IkError<S>>,
        F: Fn(&[S; N]) -> (Frame<S>, [[S; 6]; N]),
    {
        let Arm { mut at, state } = arm;
        let shape = self.shape(state).ok_or(IkError::UnknownProblem)?;
        let Target::Pose(pose) = target.validate_as(TargetKind::Pose)? else {
            return Err(IkError::WrongTarget { expected: TargetKind::Pose });
        };
        if !arm_angle.is_finite() {
            return Err(IkError::NotFinite);
        }
        let row = self.spherical_roll_spherical;
        let (mut all, mut doubtful) = (Solutions::EMPTY, Solutions::EMPTY);
        let mut refusal = None;
        let mut nearest = S::PI;
        for Choice { value, elbow, any } in shape.values(self.joint, &pose, arm_angle) {
            let solutions = match at(value) {
                Ok(solutions) => solutions,
                Err(error) => {
                    refusal = Some(error);
                    continue;
                }
            };
            // Solutions that differ in the wrist have one arm angle, and mostly follow each other.
            let mut latest: Option<([S; 4], Verdict<S>)> = None;
            for solution in &solutions {
                let Some(arm @ [.., own]) = solution.q.first_chunk::<4>() else { continue };
                // The elbow bent the other way has the arm angle at another of the values.
                if (*own - elbow).wrap_angle().abs() > doubtful_angle() {
                    continue;
                }
                let known = latest.filter(|(other, _)| travel(arm, other) <= S::EPSILON * S::EPSILON);
                let verdict =
                    known.map_or_else(|| shape.judge(self.joint, &solution.q, arm_angle), |known| known.1);
                latest = Some((*arm, verdict));
                let solution = Solution { free: solution.free.or(row.filter(|_| any)), ..*solution };
                match verdict {
                    Verdict::Has => all.push(solution, self.rules.windings),
                    Verdict::MayHave => doubtful.push(solution, self.rules.windings),
                    Verdict::Differs(apart) => nearest = nearest.min(apart),
                }
            }
        }
        let found = if all.is_empty() { doubtful } else { all };
        let missed = IkError::Failed { position_error: S::ZERO, rotation_error: nearest };
        if found.is_empty() { Err(refusal.unwrap_or(missed)) } else { Ok(found) }
    }

    fn shape<const N: usize>(&self, state: impl Fn(&[S; N]) -> (Frame<S>, [[S; 6]; N])) -> Option<Shape<S>> {
        self.spherical_roll_spherical?;
        let (tool, columns) = state(&[S::ZERO; N]);
        Shape::of(tool, columns.first_chunk()?, self.reach)
    }
}

fn nothing<S: Float>() -> S {
    S::from_f64(NOTHING) * S::EPSILON
}

fn doubtful_angle<S: Float>() -> S {
    S::from_f64(DOUBTFUL) * S::SQRT_EPSILON.sqrt()
}

fn on_one_line<S: Float>() -> S {
    S::from_f64(ON_ONE_LINE) * S::SQRT_EPSILON
}

impl<S: Float> Shape<S> {
    /// From the tool and the columns of the Jacobian at q = 0.
    fn of(tool: Frame<S>, columns: &[[S; 6]; JOINTS], reach: S) -> Option<Self> {
        let axes = columns.map(|[_, _, _, x, y, z]| [x, y, z]);
        // An axis w through o moves the tool point p by w x (p - o); its point nearest to p is what that leaves.
        let foot = |joint: usize| {
            let [x, y, z, ..] = *columns.get(joint)?;
            Some(add(tool.translation, cross(*axes.get(joint)?, [x, y, z])))
        };
        let meeting = |one: usize, other: usize| {
            let (u, v) = (*axes.get(one)?, *axes.get(other)?);
            let across = cross(u, v);
            let along = dot(cross(sub(foot(other)?, foot(one)?), v), across) / dot(across, across);
            Some(add(foot(one)?, scaled(u, along)))
        };
        let (shoulder, wrist) = (meeting(0, 1)?, meeting(5, 6)?);
        let axis = *axes.get(ELBOW)?;
        let point = foot(ELBOW)?;
        let elbow = add(point, scaled(axis, dot(sub(shoulder, point), axis)));
        Some(Self { axes, shoulder, elbow, wrist, tool, reach })
    }

    fn axis(&self, joint: usize) -> [S; 3] {
        self.axes.get(joint).copied().unwrap_or([S::ZERO; 3])
    }

    /// Where the wrist is (m) with the fourth joint alone at this.
    fn wrist_at(&self, elbow: S) -> [S; 3] {
        let turned = matrix_vector(&turn_about(self.axis(ELBOW), elbow), sub(self.wrist, self.elbow));
        add(self.elbow, turned)
    }

    /// From the shoulder to the wrist (m), and the direction to the elbow across that, before the shoulder turns.
    fn plane(&self, elbow: S) -> ([S; 3], [S; 3]) {
        let to_wrist = sub(self.wrist_at(elbow), self.shoulder);
        let directions = [sub(self.elbow, self.shoulder), cross(self.axis(ELBOW), to_wrist)];
        (to_wrist, across(to_wrist, directions, nothing::<S>() * self.reach))
    }

    /// The direction across the line to the wrist at which the arm angle is 0.
    fn reference(&self, to_wrist: [S; 3]) -> [S; 3] {
        let (zero, one) = (S::ZERO, S::ONE);
        let directions = [self.axis(0), [one, zero, zero], [zero, one, zero]];
        across(to_wrist, directions, nothing())
    }

    fn arm_angle(&self, q: &[S]) -> S {
        let value = |joint: usize| q.get(joint).copied().unwrap_or(S::ZERO);
        let shoulder = self.turned(0, [value(0), value(1), value(2)]);
        let (to_wrist, to_elbow) = self.plane(value(ELBOW));
        let (to_wrist, to_elbow) = (matrix_vector(&shoulder, to_wrist), matrix_vector(&shoulder, to_elbow));
        angle_about(unit(to_wrist), self.reference(to_wrist), to_elbow)
    }

    /// Whether these joint values have an arm angle. Of a straight arm, whose elbow is bent one way or the other by what rounding
    /// leaves, it may be the opposite one.
    fn judge(&self, joint: usize, q: &[S], arm_angle: S) -> Verdict<S> {
        let apart = (self.arm_angle(q) - arm_angle).wrap_angle().abs();
        let same = S::from_f64(SAME) * S::SQRT_EPSILON;
        if apart <= same {
            return Verdict::Has;
        }
        let is_straight = self.is_straight(q);
        let near = apart <= doubtful_angle();
        if is_straight && S::PI - apart <= same {
            Verdict::Has
        } else if !is_straight && !near {
            Verdict::Differs(apart)
        } else if apart <= same + S::from_f64(MET) * S::EPSILON / self.sine(joint, q) {
            Verdict::Has
        } else {
            Verdict::MayHave
        }
    }

    /// The sine between the first and the last of the three axes that a joint belongs to.
    fn sine(&self, joint: usize, q: &[S]) -> S {
        let first = if joint < ELBOW { 0 } else { ELBOW + 1 };
        let middle = q.get(first + 1).copied().unwrap_or(S::ZERO);
        let last = matrix_vector(&turn_about(self.axis(first + 1), middle), self.axis(first + 2));
        norm(cross(self.axis(first), last)).max(on_one_line())
    }

    /// Whether the elbow is on the line from shoulder to wrist, as far as a double root for it tells, or the wrist on the shoulder.
    /// It is bent one way or the other then by what rounding leaves.
    fn is_straight(&self, q: &[S]) -> bool {
        let (to_wrist, _) = self.plane(q.get(ELBOW).copied().unwrap_or(S::ZERO));
        let area = norm(cross(to_wrist, sub(self.elbow, self.shoulder)));
        area <= S::from_f64(SAME) * S::SQRT_EPSILON * self.reach * self.reach
    }

    /// By how much three joints turn what is behind them.
    fn turned(&self, first: usize, [one, two, three]: [S; 3]) -> Matrix<S> {
        let turn = |joint: usize, angle: S| turn_about(self.axis(first + joint), angle);
        matrix_product(&matrix_product(&turn(0, one), &turn(1, two)), &turn(2, three))
    }

    /// Values of a joint at which the arm may have this arm angle at this pose, two for each of the elbow's.
    fn values(&self, joint: usize, pose: &Frame<S>, arm_angle: S) -> [Choice<S>; 4] {
        let home = self.tool.inverse().transform_point(self.wrist);
        let to_wrist = sub(pose.transform_point(home), self.shoulder);
        let zero = self.reference(to_wrist);
        let (sine, cosine) = arm_angle.sin_cos();
        let direction = add(scaled(zero, cosine), scaled(cross(unit(to_wrist), zero), sine));
        let wanted = frame(to_wrist, direction);
        let at_elbow = |elbow: S| {
            let (to_wrist, to_elbow) = self.plane(elbow);
            let shoulder = matrix_product(&wanted, &transpose(&frame(to_wrist, to_elbow)));
            let roots = if joint < ELBOW {
                self.roots(0, joint, &shoulder)
            } else {
                let before = matrix_product(&shoulder, &turn_about(self.axis(ELBOW), elbow));
                let tool = matrix_product(&pose.rotation, &transpose(&self.tool.rotation));
                self.roots(ELBOW + 1, joint, &matrix_product(&transpose(&before), &tool))
            };
            roots.map(|(value, any)| Choice { value, elbow, any })
        };
        let [[a, b], [c, d]] = self.elbows(dot(to_wrist, to_wrist)).map(at_elbow);
        [a, b, c, d]
    }

    /// The two values of the fourth joint for the square of a distance of the wrist from the shoulder (m²). What is out of reach
    /// gets what comes nearest.
    fn elbows(&self, squared: S) -> [S; 2] {
        let (upper, lower) = (sub(self.elbow, self.shoulder), sub(self.wrist, self.elbow));
        let axis = self.axis(ELBOW);
        let (cosine, sine) =
            (dot(upper, lower) - dot(upper, axis) * dot(lower, axis), dot(upper, cross(axis, lower)));
        let rest = dot(upper, upper) + dot(lower, lower) + S::TWO * dot(upper, axis) * dot(lower, axis);
        roots(cosine, sine, (squared - rest) / S::TWO)
    }

    /// The two values of a joint of three that turn as given, and whether any other would do.
    fn roots(&self, first: usize, joint: usize, turn: &Matrix<S>) -> [(S, bool); 2] {
        let (one, two, three) = (self.axis(first), self.axis(first + 1), self.axis(first + 2));
        let along = dot(one, two) * dot(two, three);
        let wanted = dot(one, matrix_vector(turn, three));
        let middle = roots(dot(one, three) - along, dot(one, cross(two, three)), wanted - along);
        middle.map(|middle| {
            if joint == first + 1 {
                return (middle, false);
            }
            // Either end's axis, as the other end of the turn sees it, tells by how much this one turns.
            let (axis, from, to) = if joint == first {
                (one, matrix_vector(&turn_about(two, middle), three), matrix_vector(turn, three))
            } else {
                let from = matrix_vector(&turn_about(two, -middle), one);
                (three, matrix_vector(&transpose(turn), one), from)
            };
            let any = norm(cross(axis, from)) <= on_one_line();
            (if any { S::ZERO } else { angle_about(axis, from, to) }, any)
        })
    }
}

/// Both angles x with a cos x + b sin x = c; where there is none, that which comes nearest, twice.
fn roots<S: Float>(a: S, b: S, c: S) -> [S; 2] {
    let middle = b.atan2(a);
    let root = (a * a + b * b - c * c).max(S::ZERO).sqrt();
    let half = root.atan2(c);
    [(middle + half).wrap_angle(), (middle - half).wrap_angle()]
}

/// Of the first direction that has a part across a vector, the unit vector along that part.
fn across<const K: usize, S: Float>(vector: [S; 3], directions: [[S; 3]; K], least: S) -> [S; 3] {
    let along = unit(vector);
    let parts = directions.map(|direction| sub(direction, scaled(along, dot(direction, along))));
    let some = parts.iter().find(|part| norm(**part) > least).or(parts.last());
    some.map_or([S::ZERO; 3], |part| unit(*part))
}

/// The columns of a rotation: a vector's direction, a unit vector across it, and what stands on both.
fn frame<S: Float>(vector: [S; 3], direction: [S; 3]) -> Matrix<S> {
    let along = unit(vector);
    transpose(&[along, direction, cross(along, direction)])
}

/// By how much a unit vector's right-handed turn brings one direction to another, seen along it.
fn angle_about<S: Float>(axis: [S; 3], from: [S; 3], to: [S; 3]) -> S {
    let across = cross(axis, from);
    dot(across, to).atan2(dot(from, to) - dot(axis, from) * dot(axis, to))
}

/// The rotation about a unit vector (Rodrigues).
fn turn_about<S: Float>(axis: [S; 3], angle: S) -> Matrix<S> {
    let (sine, cosine) = angle.sin_cos();
    let column = |unit: [S; 3]| {
        let along = scaled(axis, dot(axis, unit) * (S::ONE - cosine));
        add(add(scaled(unit, cosine), scaled(cross(axis, unit), sine)), along)
    };
    let (zero, one) = (S::ZERO, S::ONE);
    transpose(&[column([one, zero, zero]), column([zero, one, zero]), column([zero, zero, one])])
}

fn scaled<S: Float>(vector: [S; 3], factor: S) -> [S; 3] {
    vector.map(|x| x * factor)
}

/// Its direction; what has no length stays.
fn unit<S: Float>(vector: [S; 3]) -> [S; 3] {
    let length = norm(vector);
    if length > S::ZERO { scaled(vector, S::ONE / length) } else { vector }
}
