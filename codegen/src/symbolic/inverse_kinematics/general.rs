//! A problem as a chain of six joints whose tip has one pose, for what has no closed form.
//!
//! Constraints are put into the chain. What a target leaves open becomes joints behind the tool: a target of position
//! and direction is a pose for an arm whose tool can also turn about its z axis.

use super::refusal::by_a_fraction;
use super::unknowns::{self, Form};
use super::{Linear, Refusal};
use crate::model::chain::{Element, Link};
use crate::model::{JointKind, Model, Problem, Target};
use dh_core::Frame;

/// How many joints a chain must leave to be found.
const UNKNOWNS: usize = 6;

/// The chain.
#[derive(Debug, Clone)]
pub struct General {
    /// Fixed transforms (m): before the first joint, between the joints, after the last.
    pub links: Vec<Frame>,
    /// Its joints, base to tip.
    pub joints: Vec<GeneralJoint>,
    /// Every joint variable q in terms of the chain's joints.
    pub q: Vec<Linear>,
}

/// A joint of the chain.
#[derive(Debug, Clone)]
pub struct GeneralJoint {
    /// Along z rather than about it.
    pub prismatic: bool,
    /// Its row; `None` behind the tool.
    pub row: Option<usize>,
    /// Where the caller gives it: its value in terms of the problem's free joints.
    pub given: Option<Linear>,
}

/// Puts constraints and target into the chain.
///
/// # Errors
/// Says what stands against it.
pub fn chain(model: &Model, problem: &Problem) -> Result<General, Refusal> {
    by_a_fraction(&problem.constraints)?;
    let unknowns = unknowns::eliminate(model, &problem.constraints, &problem.free)
        .map_err(|trouble| Refusal::of(trouble, model))?;
    let (behind, tip) = behind_the_tool(problem.target).ok_or(Refusal::NotByThisMethod)?;
    let table = model.chain();
    let mut links = table.links.iter().map(frame);
    let mut general = General { links: Vec::new(), joints: Vec::new(), q: Vec::new() };
    let mut link = links.next().unwrap_or(Frame::IDENTITY);
    // Which joint of the chain each free variable is.
    let mut places: Vec<Option<usize>> = vec![None; unknowns.free.len()];
    for (joint, after) in table.joints.iter().zip(links) {
        let prismatic = joint.kind == JointKind::Prismatic;
        let form = unknowns.rows.get(joint.row).ok_or(Refusal::NotByThisMethod)?;
        match single(form) {
            Value::Held => link = link.compose(&held(prismatic, form)).compose(&after),
            Value::Free(variable) => {
                let place = places.get_mut(variable).ok_or(Refusal::NotByThisMethod)?;
                if place.is_some() {
                    return Err(Refusal::NoClosedForm);
                }
                *place = Some(general.joints.len());
                let given = unknowns.free.get(variable).and_then(|free| free.given).map(|given| Linear {
                    terms: vec![(given.place, given.factor)],
                    constant: given.at_zero.value(),
                });
                general.joints.push(GeneralJoint { prismatic, row: Some(joint.row), given });
                general.links.push(link);
                link = after;
            }
            Value::Follows => return Err(Refusal::NoClosedForm),
        }
    }
    for (before, prismatic) in behind {
        general.joints.push(GeneralJoint { prismatic, row: None, given: None });
        general.links.push(link.compose(&before));
        link = Frame::IDENTITY;
    }
    link = link.compose(&tip);
    // An arm with fewer joints attains few poses: those that one with more joints attains with the added ones at 0.
    let missing =
        UNKNOWNS.saturating_sub(general.joints.iter().filter(|joint| joint.given.is_none()).count());
    for number in 0..missing {
        let aside = aside(number, model.reach());
        general.joints.push(GeneralJoint { prismatic: false, row: None, given: None });
        general.links.push(link.compose(&aside));
        link = aside.inverse();
    }
    general.links.push(link);
    if general.joints.iter().filter(|joint| joint.given.is_none()).count() != UNKNOWNS {
        return Err(Refusal::NoClosedForm);
    }
    for form in &unknowns.joints {
        let terms = form.coefficients.iter().zip(&places).filter(|(factor, _)| **factor != 0.0);
        let terms = terms.map(|(factor, place)| place.map(|place| (place, *factor)));
        let terms = terms.collect::<Option<Vec<_>>>().ok_or(Refusal::NoClosedForm)?;
        general.q.push(Linear { terms, constant: form.offset.value() });
    }
    Ok(general)
}

/// A frame whose z axis neither meets another axis nor is parallel to it, but by accident.
fn aside(number: usize, reach: f64) -> Frame {
    let k = number as f64;
    let position = [0.31 + 0.11 * k, 0.17 - 0.23 * k, 0.13 * k - 0.23].map(|x| x * reach);
    Frame::from_rpy(position, [0.7 + 0.4 * k, 0.4 - 0.5 * k, -0.9])
}

/// How a row's value depends on the free ones.
enum Value {
    Held,
    /// It is one of them.
    Free(usize),
    Follows,
}

fn single(form: &Form) -> Value {
    let mut present = form.coefficients.iter().enumerate().filter(|(_, factor)| **factor != 0.0);
    match (present.next(), present.next()) {
        (None, _) => Value::Held,
        (Some((variable, factor)), None) if *factor == 1.0 && form.offset.value() == 0.0 => {
            Value::Free(variable)
        }
        _ => Value::Follows,
    }
}

pub(super) fn held(prismatic: bool, form: &Form) -> Frame {
    if prismatic {
        return Frame::from_translation([0.0, 0.0, form.offset.value()]);
    }
    let (fifteenths, rest) = form.offset.split();
    turn(2, sin_cos(fifteenths)).compose(&turn(2, libm::sincos(rest)))
}

/// Exact where a sine is 0, 1/2 or 1.
fn sin_cos(fifteenths: i32) -> (f64, f64) {
    let value = |k: i32| match k.rem_euclid(24) {
        0 | 12 => 0.0,
        2 | 10 => 0.5,
        6 => 1.0,
        14 | 22 => -0.5,
        18 => -1.0,
        k => libm::sin(f64::from(k) * (std::f64::consts::PI / 12.0)),
    };
    (value(fifteenths), value(fifteenths + 6))
}

/// A turn about x, y or z.
fn turn(axis: usize, (s, c): (f64, f64)) -> Frame {
    let rotation = match axis {
        0 => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
        1 => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
        _ => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
    };
    Frame { rotation, translation: [0.0; 3] }
}

pub(super) fn frame(link: &Link) -> Frame {
    link.elements.iter().fold(Frame::IDENTITY, |frame, element| {
        frame.compose(&match element {
            Element::Translate { axis, value, .. } => {
                let along = |k: usize| if k == *axis { *value } else { 0.0 };
                Frame::from_translation([along(0), along(1), along(2)])
            }
            Element::Rotate { axis, angle, .. } => turn(*axis, angle.sin_cos()),
            Element::Matrix { rows, .. } => Frame { rotation: *rows, translation: [0.0; 3] },
        })
    })
}

/// The joints that a target adds behind the tool: what stands before each, and whether it slides; and what stands behind
/// the last. With all of them at 0 the tip is the tool. `None` where the target says nothing of the tool's place.
fn behind_the_tool(target: Target) -> Option<(Vec<(Frame, bool)>, Frame)> {
    let straight = Frame::IDENTITY;
    let (onto_x, onto_y) = (turn(1, (1.0, 0.0)), turn(0, (-1.0, 0.0)));
    let (off_x, off_y) = (onto_x.inverse(), onto_y.inverse());
    Some(match target {
        Target::Pose => (Vec::new(), straight),
        Target::PositionDirection => (vec![(straight, false)], straight),
        // The turn comes first, for the line through the target must be a joint's that turns.
        Target::Ray => (vec![(straight, false), (straight, true)], straight),
        // About x, then about y: what roll and pitch add to the yaw.
        Target::PositionYaw => (vec![(onto_x, false), (off_x.compose(&onto_y), false)], off_y),
        Target::Position => (vec![(straight, false), (onto_x, false), (off_x, false)], straight),
        Target::Lookat => {
            (vec![(straight, true), (straight, false), (onto_x, false), (off_x, false)], straight)
        }
        Target::Rotation | Target::Direction | Target::Xy | Target::XyYaw => return None,
    })
}
