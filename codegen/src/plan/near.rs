//! Functions of nearly special arms: the closed form of the arm that was meant, corrected; what finds all joints at once where
//! that is not sure to find everything.

mod gains;
mod moves;

use super::schedule::Constants;
use super::{Function, GeneralChain, Scalar, Step, ValueId, descents, general, inverse, ways};
use crate::model::geometry::Nominal;
use crate::model::{JointKind, Model, Problem, Target, product};
use crate::symbolic::inverse_kinematics::{self, Derivation, Refusal, StageEquation};
use crate::symbolic::redundancy;
use dh_core::{BranchBit, Form, Frame, rotation_error};
use moves::Moves;

/// At how many joint vectors the two arms are compared.
const SAMPLES: usize = 256;

/// Arms whose tool frames are farther apart (reaches, rad) are too far for bounds that are proportional to it. Of the shipped ones,
/// Gen3 (1.0e-2) and Baxter (7.9e-3) lost solutions about singular poses that the general chain finds; none that is nearer did.
const FARTHEST: f64 = 5e-3;

/// A unit vector with less than this along the ground is steep.
const LEVEL: f64 = 0.8;

/// The full pose by the nearly special arm's nominal one; `None` where there is none, or none with a closed form.
pub(super) fn full_pose(model: &Model, constants: &mut Constants) -> Option<Function> {
    let nominal = model.nominal()?;
    let excess = model.joints.len().checked_sub(Target::Pose.rows())?;
    let free: Vec<Vec<usize>> = match excess {
        0 => vec![Vec::new()],
        1 => redundancy::joints(&nominal.model).into_iter().map(|joint| vec![joint]).collect(),
        _ => return None,
    };
    let deviation = deviation(model, &nominal.model)?;
    let (problem, derivation) = inverse::least(&nominal.model, free).ok()?;
    function(model, &nominal, deviation, None, &problem, derivation, constants)
}

/// A problem of the table (an index into `Model::problems`).
pub(super) fn problem(
    model: &Model,
    index: usize,
    problem: &Problem,
    constants: &mut Constants,
) -> Option<Function> {
    let nominal = if problem.target.is_any_turn() {
        let nominal = model.nominal_to_tool_axis()?;
        descents::regular(&nominal.model, problem).ok()?;
        nominal
    } else {
        model.nominal()?
    };
    let deviation = deviation(model, &nominal.model)?;
    let derivation = inverse_kinematics::derive(&nominal.model, problem).ok()?;
    function(model, &nominal, deviation, Some(index), problem, derivation, constants)
}

fn function(
    model: &Model,
    nominal: &Nominal,
    deviation: f64,
    index: Option<usize>,
    problem: &Problem,
    mut derivation: Derivation,
    constants: &mut Constants,
) -> Option<Function> {
    if derivation.stages.iter().any(|stage| matches!(stage.equation, StageEquation::TrigEither(..))) {
        // By how much its roots are off isn't known.
        return None;
    }
    let moves = Moves::of(model, problem)?;
    if matches!(problem.target, Target::PositionYaw | Target::XyYaw) && !keeps_level(model, &moves) {
        return None;
    }
    let otherwise = otherwise(model, index, problem).ok()?;
    moves.keep_constraints(&mut derivation.joints);
    let mut function = inverse::function(model, index, problem, &derivation, true, constants);
    let gains = gains::of(&nominal.model, &function, problem.target, &moves, &constants.values(), deviation)?;
    let nearly = Box::new(Nearly {
        joints: if is_chain(&otherwise) { joints(model, problem) } else { None },
        mirrored: moves.mirrored != is_mirrored(problem.target, &otherwise),
        unknowns: moves.unknowns,
        follow: moves.follow,
        gains: gains.concat(),
        deviation,
    });
    // Where a seed matters, the table is solved as it is, and branches are the arm's own.
    function.unknowns = otherwise.unknowns;
    function.motions = otherwise.motions;
    let after = u8::try_from(function.stages.len()).ok()?;
    function.branch =
        otherwise.branch.into_iter().map(|bit| BranchBit { step: bit.step + after, ..bit }).collect();
    let behind = Behind {
        inputs: function.inputs,
        values: function.values.len() - function.inputs,
        stages: function.stages.len(),
    };
    let body = std::mem::take(&mut function.steps);
    function.values.extend(otherwise.values.into_iter().skip(function.inputs));
    function.stages.extend(otherwise.stages);
    let otherwise = behind.steps(otherwise.steps);
    let meant = nominal.class();
    function.steps = vec![Step::Near { nearly, meant, body, otherwise }];
    Some(function)
}

/// A function that solves the table as it is.
fn otherwise(model: &Model, index: Option<usize>, problem: &Problem) -> Result<Function, Refusal> {
    match (index, problem.target) {
        (None, _) | (_, Target::Pose) if problem.constraints.is_empty() => {
            Ok(general::function(model, index, problem)?.function)
        }
        // The chain of six joints has each solution of these twice, with determinants of either sign.
        (_, Target::Position | Target::Lookat) => descents::function(model, index, problem),
        _ => ways::at_once(model, index),
    }
}

/// Whether determinants of a chain of six joints have the other sign than those of what the target prescribes by the unknowns
/// alone: the joints behind the tool are last, and of a ray the turn comes before the slide.
fn is_mirrored(target: Target, otherwise: &Function) -> bool {
    target == Target::Ray && is_chain(otherwise)
}

fn is_chain(function: &Function) -> bool {
    matches!(function.steps[..], [Step::General { .. }])
}

/// What a nearly special arm is to the one that was meant, as [`dh_core::Nearly`].
#[derive(Debug, Clone, PartialEq)]
pub struct Nearly {
    /// The joints that are found (indices of q).
    pub unknowns: Vec<usize>,
    /// See [`dh_core::Nearly::follow`].
    pub follow: Vec<(usize, usize, f64)>,
    /// See [`dh_core::Nearly::gains`].
    pub gains: Vec<f64>,
    /// See [`dh_core::Nearly::deviation`].
    pub deviation: f64,
    /// See [`dh_core::Nearly::mirrored`].
    pub mirrored: bool,
    /// See [`dh_core::Exact::joints`].
    pub joints: Option<Vec<Form>>,
}

impl Nearly {
    /// As the numeric kernel takes it, with the arm as it is.
    pub fn of<'a>(&'a self, chain: Option<&'a GeneralChain>) -> dh_core::Nearly<'a> {
        let exact = self.joints.as_deref().zip(chain);
        dh_core::Nearly {
            unknowns: &self.unknowns,
            follow: &self.follow,
            gains: &self.gains,
            deviation: self.deviation,
            mirrored: self.mirrored,
            chain: exact.map(|(joints, chain)| dh_core::Exact { arm: chain.arm(), joints }),
        }
    }
}

/// All joints as forms in those of a chain of six. `None` where joints are given, and where the chain's tip meets targets that
/// the tool doesn't: it may have the yaw, and the tool the other way round.
fn joints(model: &Model, problem: &Problem) -> Option<Vec<Form>> {
    if !problem.free.is_empty() || problem.target == Target::PositionYaw {
        return None;
    }
    let chain = inverse_kinematics::general::chain(model, problem).ok()?;
    let forms = chain.q.iter().map(|q| {
        let mut form = [0.0; 7];
        for (place, factor) in &q.terms {
            *form.get_mut(*place)? += factor;
        }
        form[6] = q.constant;
        Some(form)
    });
    forms.collect()
}

/// Whether the tool's x axis is nowhere steep: a yaw magnifies what the arm is off by where it is, without bound.
fn keeps_level(model: &Model, moves: &Moves) -> bool {
    (0..SAMPLES).all(|sample| {
        let q = moves.kept(joint_vector(model, sample));
        let [[x, ..], [y, ..], _] = frame(&product::frames(model, &q).tool).rotation;
        x.hypot(y) >= LEVEL
    })
}

/// How far apart the tool frames of two arms are at the same joint values (reaches, rad), at most; `None` where that is too far.
/// Asked first, since it is less work than to derive anything.
fn deviation(model: &Model, nominal: &Model) -> Option<f64> {
    let reach = model.reach();
    let mut most = 0.0_f64;
    for sample in 0..SAMPLES {
        let q = joint_vector(model, sample);
        let [one, other] = [model, nominal].map(|model| frame(&product::frames(model, &q).tool));
        let away = one.translation.iter().zip(other.translation).map(|(a, b)| (a - b) * (a - b));
        let away = away.sum::<f64>().sqrt() / if reach > 0.0 { reach } else { 1.0 };
        most = most.max(away).max(rotation_error(&one.rotation, &other.rotation));
        if most > FARTHEST {
            return None;
        }
    }
    Some(most)
}

/// Any irrational steps will do.
fn joint_vector(model: &Model, sample: usize) -> Vec<f64> {
    let rows = model.joints.iter().filter_map(|row| model.rows.get(*row)).enumerate();
    rows.map(|(joint, row)| {
        let phase =
            (0.754_877_666 * sample as f64 + 0.618_033_989 * joint as f64 * (sample as f64 + 0.5)).fract();
        match row.kind {
            JointKind::Revolute => (phase - 0.5) * std::f64::consts::TAU,
            JointKind::Prismatic => {
                let reach = model.reach();
                let (from, to) = row.limits.map_or((-reach, reach), |limits| (limits.min, limits.max));
                from + (to - from) * phase
            }
        }
    })
    .collect()
}

fn frame(rows: &product::Matrix) -> Frame {
    Frame { rotation: rows.map(|[a, b, c, _]| [a, b, c]), translation: rows.map(|[_, _, _, p]| p) }
}

/// Where the values and stages of one function come behind those of another.
struct Behind {
    inputs: usize,
    values: usize,
    stages: usize,
}

impl Behind {
    fn steps(&self, steps: Vec<Step>) -> Vec<Step> {
        steps.into_iter().map(|step| self.step(step)).collect()
    }

    fn step(&self, step: Step) -> Step {
        match step {
            Step::General { stage, chain, given, roots, body } => Step::General {
                stage: stage + self.stages,
                chain,
                given: self.scalars(given),
                roots: roots.into_iter().map(|root| self.value(root)).collect(),
                body: self.steps(body),
            },
            Step::Descents { stage, chain, given, roots, body } => Step::Descents {
                stage: stage + self.stages,
                chain,
                given: self.scalars(given),
                roots: roots.into_iter().map(|root| self.value(root)).collect(),
                body: self.steps(body),
            },
            Step::Accept { q, tool, polish } => {
                Step::Accept { q: self.scalars(q), tool: self.scalars(tool), polish }
            }
            other => other,
        }
    }

    fn value(&self, id: ValueId) -> ValueId {
        if id.0 < self.inputs { id } else { ValueId(id.0 + self.values) }
    }

    fn scalars(&self, scalars: Vec<Scalar>) -> Vec<Scalar> {
        scalars.into_iter().map(|scalar| self.scalar(scalar)).collect()
    }

    fn scalar(&self, scalar: Scalar) -> Scalar {
        let of = |x: Box<Scalar>| Box::new(self.scalar(*x));
        match scalar {
            Scalar::Value(id) => Scalar::Value(self.value(id)),
            Scalar::Neg(x) => Scalar::Neg(of(x)),
            Scalar::Add(x, y) => Scalar::Add(of(x), of(y)),
            Scalar::Sub(x, y) => Scalar::Sub(of(x), of(y)),
            Scalar::Mul(x, y) => Scalar::Mul(of(x), of(y)),
            Scalar::Div(x, y) => Scalar::Div(of(x), of(y)),
            number => number,
        }
    }
}
