//! A problem of any kind as a chain whose rows follow a few unknowns, for what has neither a closed form nor a chain of six
//! joints.

use super::general::{frame, held};
use super::refusal::by_a_fraction;
use super::unknowns::{self, Form, Free};
use super::{Linear, Refusal};
use crate::model::{JointKind, Model, Problem};
use dh_core::Frame;

/// After at most so many whole turns of an unknown all rows that follow it are as they were. The places that a search starts
/// from are spread over all these turns: of the 256 that it is measured with (`plan::descents`), ten a turn are left.
pub(super) const MOST_TURNS: u8 = 24;

/// What ought to be a whole number is one, to within this.
const WHOLE: f64 = 1e-9;

/// The chain.
#[derive(Debug, Clone)]
pub struct Rows {
    /// Fixed transforms (m): before the first row, between the rows, after the last.
    pub links: Vec<Frame>,
    /// The rows that move: which of the table, and the value.
    pub rows: Vec<(usize, Linear)>,
    /// What is to be found.
    pub unknowns: Vec<Unknown>,
    /// Every joint variable q.
    pub q: Vec<Linear>,
}

/// An unknown. Variables of linear forms are the unknowns, then the joints that the caller gives.
#[derive(Debug, Clone, Copy)]
pub struct Unknown {
    /// The row whose theta or d it is.
    pub row: usize,
    /// After how many whole turns of it all is as it was; 0 of a length.
    pub turns: u8,
}

/// Puts constraints and couplings into the chain.
///
/// # Errors
/// Says what stands against it.
pub fn chain(model: &Model, problem: &Problem) -> Result<Rows, Refusal> {
    by_a_fraction(&problem.constraints)?;
    let unknowns = unknowns::eliminate_any(model, &problem.constraints, &problem.free)
        .map_err(|trouble| Refusal::of(trouble, model))?;
    let table = model.chain();
    let mut links = table.links.iter().map(frame);
    let mut link = links.next().unwrap_or(Frame::IDENTITY);
    let mut chain = Rows { links: Vec::new(), rows: Vec::new(), unknowns: Vec::new(), q: Vec::new() };
    for (joint, after) in table.joints.iter().zip(links) {
        let form = unknowns.rows.get(joint.row).ok_or(Refusal::NotByThisMethod)?;
        if form.coefficients.iter().all(|factor| *factor == 0.0) {
            let prismatic = joint.kind == JointKind::Prismatic;
            link = link.compose(&held(prismatic, form)).compose(&after);
            continue;
        }
        chain.rows.push((joint.row, linear(form, &unknowns.free)));
        chain.links.push(std::mem::replace(&mut link, after));
    }
    chain.links.push(link);
    chain.q = unknowns.joints.iter().map(|form| linear(form, &unknowns.free)).collect();
    for (place, free) in unknowns.free.iter().enumerate().filter(|(_, free)| free.given.is_none()) {
        let turns = match free.kind {
            JointKind::Prismatic => 0,
            JointKind::Revolute => turns(&unknowns.rows, place)
                .map_err(|(row, factor)| Refusal::turns(model, row, free.row, factor))?,
        };
        chain.unknowns.push(Unknown { row: free.row, turns });
    }
    Ok(chain)
}

/// After how many whole turns of this variable all rows are as they were; else the first row that isn't, with its factor.
fn turns(rows: &[Form], place: usize) -> Result<u8, (usize, f64)> {
    let mut turns = 1;
    for (row, form) in rows.iter().enumerate() {
        let factor = form.coefficients.get(place).copied().unwrap_or(0.0);
        let whole = |turns: &u8| {
            let turned = factor * f64::from(*turns);
            (turned - turned.round()).abs() < WHOLE
        };
        // A multiple of what the rows before it need.
        let mut multiples = (1..=MOST_TURNS).filter(|multiple| multiple.is_multiple_of(turns));
        turns = multiples.find(whole).ok_or((row, factor))?;
    }
    Ok(turns)
}

/// By unknowns, which come first, and what the caller gives.
fn linear(form: &Form, free: &[Free]) -> Linear {
    let mut sum = Linear { terms: Vec::new(), constant: form.offset.value() };
    let unknowns = free.iter().filter(|free| free.given.is_none()).count();
    for (place, (free, factor)) in free.iter().zip(&form.coefficients).enumerate() {
        if *factor == 0.0 {
            continue;
        }
        match free.given {
            None => sum.terms.push((place, *factor)),
            Some(given) => {
                sum.terms.push((unknowns + given.place, factor * given.factor));
                sum.constant += factor * given.at_zero.value();
            }
        }
    }
    sum
}
