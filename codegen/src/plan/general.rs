//! Functions for what has no closed form: one step that finds all joints at once.

mod charts;

pub(super) use charts::Random;

use super::{
    Counts, Form, Function, FunctionKind, Measure, Scalar, Stage, Step, ValueId, target_inputs, unknowns,
};
use crate::model::{Model, Problem};
use crate::symbolic::inverse_kinematics::general::{self, General, GeneralJoint};
use crate::symbolic::inverse_kinematics::{Linear, Refusal};
use dh_core::{BranchBit, BranchWord, Chart, Frame, MAX_SOLUTIONS};

/// The chain of a [`Step::General`], as `dh_core::GeneralArm` takes it.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralChain {
    /// Fixed transforms (m): before the first joint, between the joints, after the last.
    pub links: Vec<Frame>,
    /// Which joints slide.
    pub prismatic: Vec<bool>,
    /// Joints whose values the caller gives.
    pub given: Vec<usize>,
    /// Size of the arm (m).
    pub reach: f64,
    /// Choices of joints, the best first.
    pub charts: Vec<Chart>,
}

impl GeneralChain {
    /// How many solutions there are at most: a trigonometric polynomial has twice as many roots as its degree, of which some need
    /// not be the arm's.
    pub fn most_solutions(&self) -> usize {
        let roots =
            self.charts.first().map_or(MAX_SOLUTIONS, |chart| 2 * usize::from(chart.degree_of_turn()));
        roots.min(MAX_SOLUTIONS)
    }

    /// As the numeric kernel takes it.
    pub fn arm(&self) -> dh_core::GeneralArm<'_> {
        dh_core::GeneralArm {
            links: &self.links,
            prismatic: &self.prismatic,
            given: &self.given,
            reach: self.reach,
            charts: &self.charts,
            triple: &None,
        }
    }
}

/// A function, and how badly its chain does on poses of the arm: to be compared with others of the same problem.
pub(super) struct Rated {
    pub(super) function: Function,
    pub(super) badness: f64,
}

/// The function of a problem (an index into `Model::problems`, or the full pose).
///
/// # Errors
/// Why there is none.
pub(super) fn function(model: &Model, index: Option<usize>, problem: &Problem) -> Result<Rated, Refusal> {
    let general = general::chain(model, problem)?;
    let chain = chain(model, &general);
    let (charts, badness) = charts::choose(&chain);
    if charts.is_empty() && !charts::is_regular(&chain) {
        return Err(Refusal::NoClosedForm);
    }
    let stage = stage(&general, charts.first());
    let (mut values, first_given) = inputs(model, problem);
    let inputs = values.len();
    let mut behind = 0;
    let mut roots = Vec::new();
    let mut joints = Vec::new();
    let mut given = Vec::new();
    for joint in &general.joints {
        if let Some(value) = &joint.given {
            let value = sum(value, |place| Scalar::Value(ValueId(first_given + place)));
            joints.push(value.clone());
            given.push(value);
        } else {
            joints.push(Scalar::Value(ValueId(values.len())));
            roots.push(ValueId(values.len()));
            values.push(name(joint, &mut behind));
        }
    }
    let q = general
        .q
        .iter()
        .map(|form| sum(form, |place| joints.get(place).cloned().unwrap_or(Scalar::Number(0.0))));
    // Of an arm with fewer joints than the chain: what those that were added are off by is taken away again.
    let polish = problem.is_whole_pose() && general.joints.iter().any(|joint| joint.row.is_none());
    let body = vec![Step::Accept { q: q.collect(), tool: Vec::new(), polish }];
    let unknowns = unknowns(&general);
    let chain = GeneralChain { charts, ..chain };
    let found = stage.rows.count_ones() as usize;
    // Joints that only make the chain whole have their part in its determinant.
    let whole = found == problem.target.rows();
    let row = stage.rows.trailing_zeros() as usize;
    let branch = whole.then(|| BranchBit::new(0, BranchWord::Determinant, row)).into_iter().collect();
    let function = Function {
        kind: FunctionKind::Inverse(index),
        values,
        inputs,
        free: problem.free.clone(),
        steps: vec![Step::General { stage: 0, chain, given, roots, body }],
        outputs: Vec::new(),
        counts: Counts::default(),
        stages: vec![stage],
        unknowns,
        motions: Vec::new(),
        constraints: super::constraints::of(model, index),
        branch,
        agreement: None,
    };
    Ok(Rated { function, badness })
}

/// The names of what a function takes: what the target prescribes, then the joints that the caller gives, from that place on.
pub(super) fn inputs(model: &Model, problem: &Problem) -> (Vec<String>, usize) {
    let mut values: Vec<String> = target_inputs(problem.target).iter().map(|&name| name.to_owned()).collect();
    let first_given = values.len();
    values.extend(problem.free.iter().map(|joint| {
        let row = model.joints.get(*joint).copied().unwrap_or_default();
        format!("q{}", row + 1)
    }));
    (values, first_given)
}

/// The same function with its second choice of joints in the first place.
pub(super) fn rotated(function: &Function) -> Option<Function> {
    let mut function = function.clone();
    let [Step::General { chain, .. }] = function.steps.as_mut_slice() else { return None };
    if chain.charts.len() < 2 {
        return None;
    }
    chain.charts.rotate_left(1);
    let chart = *chain.charts.first()?;
    let [Step::General { roots, .. }] = function.steps.as_slice() else { return None };
    let name = |place: usize| roots.get(place).and_then(|root| function.values.get(root.0));
    let (unknown, line) = (name(chart.unknown())?, name(usize::from(chart.dropped))?);
    let equation = equation(chart.degree_of_turn(), unknown);
    function.stages.first_mut()?.equation = format!("{equation}, from the line of axis {line}");
    Some(function)
}

/// In words.
fn equation(degree: u8, unknown: &str) -> String {
    format!("a trigonometric polynomial of degree {degree} in {unknown} is 0")
}

fn chain(model: &Model, general: &General) -> GeneralChain {
    let reach = model.reach();
    let given = general.joints.iter().enumerate().filter(|(_, joint)| joint.given.is_some());
    GeneralChain {
        links: general.links.clone(),
        prismatic: general.joints.iter().map(|joint| joint.prismatic).collect(),
        given: given.map(|(place, _)| place).collect(),
        reach: if reach > 0.0 { reach } else { 1.0 },
        charts: Vec::new(),
    }
}

/// The joints to be found, in terms of joint values.
fn unknowns(general: &General) -> Vec<Option<Form>> {
    let all = unknowns::of(&general.q, 0, general.joints.len());
    let found = all.into_iter().zip(&general.joints).filter(|(_, joint)| joint.given.is_none());
    found.map(|(form, _)| form).collect()
}

/// `theta3`, `d3`; joints behind the tool are numbered by themselves.
fn name(joint: &GeneralJoint, behind: &mut usize) -> String {
    if let Some(row) = joint.row {
        return format!("{}{}", if joint.prismatic { "d" } else { "theta" }, row + 1);
    }
    *behind += 1;
    format!("tool{behind}")
}

pub(super) fn sum(form: &Linear, value: impl Fn(usize) -> Scalar) -> Scalar {
    let mut sum: Option<Scalar> = None;
    for &(place, factor) in &form.terms {
        let (size, negative) = (factor.abs(), factor < 0.0);
        let term = if size == 1.0 {
            value(place)
        } else {
            Scalar::Mul(Box::new(Scalar::Number(size)), Box::new(value(place)))
        };
        sum = Some(match (sum, negative) {
            (None, false) => term,
            (None, true) => Scalar::Neg(Box::new(term)),
            (Some(sum), false) => Scalar::Add(Box::new(sum), Box::new(term)),
            (Some(sum), true) => Scalar::Sub(Box::new(sum), Box::new(term)),
        });
    }
    match sum {
        None => Scalar::Number(form.constant),
        Some(sum) if form.constant == 0.0 => sum,
        Some(sum) if form.constant < 0.0 => {
            Scalar::Sub(Box::new(sum), Box::new(Scalar::Number(-form.constant)))
        }
        Some(sum) => Scalar::Add(Box::new(sum), Box::new(Scalar::Number(form.constant))),
    }
}

/// What is said of the step.
fn stage(general: &General, chart: Option<&Chart>) -> Stage {
    let free: Vec<&GeneralJoint> = general.joints.iter().filter(|joint| joint.given.is_none()).collect();
    let mut behind = 0;
    let names: Vec<String> = free.iter().map(|joint| name(joint, &mut behind)).collect();
    let named = |place: usize| names.get(place).cloned().unwrap_or_default();
    let rows = free.iter().filter_map(|joint| joint.row);
    let (unknown, equation, origin) = match chart {
        Some(chart) => {
            let unknown = named(chart.unknown());
            let [first, second] = chart.eliminated().map(named);
            let [third, fourth] = chart.resolved().map(named);
            let line = named(usize::from(chart.dropped));
            let origin = format!(
                "the line of axis {line} seen from both sides; {first} and {second} eliminated from its 14 power products, {third} and {fourth} by a resultant; they and {line} follow from each root"
            );
            let equation = equation(chart.degree_of_turn(), &unknown);
            (unknown, equation, origin)
        }
        None => (
            names.join(", "),
            "the tool frame is the target's".to_owned(),
            "by Newton's method from places all over the joint space: no polynomial in one joint was found"
                .to_owned(),
        ),
    };
    Stage {
        rows: rows.fold(0, |mask, row| mask | 1_u32.checked_shl(row as u32).unwrap_or(0)),
        measure: Measure::Ratio,
        equation,
        definitions: Vec::new(),
        origin,
        plus: None,
        unknown,
    }
}
