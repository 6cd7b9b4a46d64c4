//! The joints that are to meet a target, and those that constraints make follow them.

use crate::model::{Model, Problem};
use crate::symbolic::inverse_kinematics::Linear;
use crate::symbolic::inverse_kinematics::rows::{self, Rows};

/// Factors below this are what rounding leaves of 0.
const NOTHING: f64 = 1e-9;

/// Joint values in terms of as many of them as the target has rows.
pub(super) struct Moves {
    /// Which these are (indices of q).
    pub(super) unknowns: Vec<usize>,
    /// Which unknown (an index into `unknowns`) moves which other joint, and by what factor.
    pub(super) follow: Vec<(usize, usize, f64)>,
    /// The joints that are neither found nor given.
    others: Vec<Other>,
    /// Which joints the caller gives (indices of q).
    given: Vec<usize>,
    /// Whether determinants by these unknowns have the other sign than those by the rows that joints move.
    pub(super) mirrored: bool,
}

/// A joint that others determine.
struct Other {
    joint: usize,
    /// A factor for each unknown, then one for each given joint.
    factors: Vec<f64>,
    constant: f64,
}

impl Moves {
    /// `None` where there are not as many as rows of the target.
    pub(super) fn of(model: &Model, problem: &Problem) -> Option<Self> {
        let Rows { unknowns, q, .. } = rows::chain(model, problem).ok()?;
        let (count, given) = (unknowns.len(), problem.free.len());
        if count != problem.target.rows() {
            return None;
        }
        let mut forms: Vec<Vec<f64>> = q.iter().map(|form| dense(form, count + given)).collect();
        // Each variable in turn is replaced by a joint value that it takes part in.
        let mut joints = Vec::new();
        let mut mirrored = false;
        for variable in 0..count {
            let takes_part = |joint: &usize| {
                let free = problem.free.contains(joint) || joints.contains(joint);
                let factor = forms.get(*joint).and_then(|form| form.get(variable));
                !free && factor.is_some_and(|factor| factor.abs() > NOTHING)
            };
            let joint = (0..forms.len()).find(takes_part)?;
            let own = forms.get(joint)?.clone();
            let size = *own.get(variable)?;
            mirrored ^= size < 0.0;
            for form in &mut forms {
                let share = form.get(variable)? / size;
                form.iter_mut().zip(&own).for_each(|(to, from)| *to -= share * from);
                *form.get_mut(variable)? = share;
            }
            joints.push(joint);
        }
        let is_other = |joint: &usize| !joints.contains(joint) && !problem.free.contains(joint);
        let others: Vec<Other> = forms
            .into_iter()
            .enumerate()
            .filter(|(joint, _)| is_other(joint))
            .map(|(joint, mut factors)| {
                let constant = factors.pop().unwrap_or(0.0);
                Other { joint, factors, constant }
            })
            .collect();
        let follow = others.iter().flat_map(|other| {
            let factors = other.factors.iter().take(count).enumerate();
            let factors = factors.filter(|(_, factor)| factor.abs() > NOTHING);
            factors.map(|(place, factor)| (place, other.joint, *factor))
        });
        Some(Self {
            follow: follow.collect(),
            unknowns: joints,
            others,
            given: problem.free.clone(),
            mirrored,
        })
    }

    /// The joints that others follow, in the order of their factors.
    fn leaders(&self) -> impl Iterator<Item = usize> {
        self.unknowns.iter().chain(&self.given).copied()
    }

    /// Joint values with those that follow where they belong.
    pub(super) fn kept(&self, mut q: Vec<f64>) -> Vec<f64> {
        for other in &self.others {
            let terms = self.leaders().zip(&other.factors);
            let value = terms.fold(other.constant, |sum, (joint, factor)| {
                sum + factor * q.get(joint).copied().unwrap_or(0.0)
            });
            if let Some(slot) = q.get_mut(other.joint) {
                *slot = value;
            }
        }
        q
    }

    /// The joints of a nominal arm keep its constraints, which speak of its own numbers: those that follow are made to do so
    /// by the table's.
    pub(super) fn keep_constraints(&self, joints: &mut [Linear]) {
        for other in &self.others {
            let mut sum = Linear { terms: Vec::new(), constant: other.constant };
            for (leader, factor) in self.leaders().zip(&other.factors).filter(|(_, x)| x.abs() > NOTHING) {
                let Some(form) = joints.get(leader) else { continue };
                sum.constant += factor * form.constant;
                for (variable, own) in &form.terms {
                    match sum.terms.iter_mut().find(|(known, _)| known == variable) {
                        Some((_, known)) => *known += factor * own,
                        None => sum.terms.push((*variable, factor * own)),
                    }
                }
            }
            sum.terms.retain(|(_, factor)| factor.abs() > NOTHING);
            if let Some(slot) = joints.get_mut(other.joint) {
                *slot = sum;
            }
        }
    }
}

/// One factor a variable, then the constant.
fn dense(form: &Linear, variables: usize) -> Vec<f64> {
    let mut dense = vec![0.0; variables + 1];
    for &(place, factor) in &form.terms {
        if let Some(slot) = dense.get_mut(place) {
            *slot += factor;
        }
    }
    if let Some(last) = dense.last_mut() {
        *last = form.constant;
    }
    dense
}
