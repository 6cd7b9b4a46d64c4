//! The scalars of one function as sums: definitions put in where they are used, sines and cosines by their names.

use super::algebra::{Factor, Sum};
use super::folded;
use super::number::in_units;
use super::variables::{self, Form};
use crate::model::{JointKind, Model};
use crate::plan::{Constant, ConstantId, Function, Plan, Scalar, ValueId};
use std::collections::BTreeSet;

/// Expressions of more names than this keep a name of their own, or the equations of long chains would grow without
/// bound.
const LONGEST: usize = 400;

/// What all functions of a robot are written with.
pub(super) struct Writer<'a> {
    pub(super) model: &'a Model,
    pub(super) plan: &'a Plan,
    /// Whether constants are numbers in the table's units.
    pub(super) numeric: bool,
    /// Constants that were written, for the legend.
    pub(super) used: BTreeSet<usize>,
}

/// One function on its way to text.
pub(super) struct Scope<'a, 'w> {
    writer: &'w mut Writer<'a>,
    function: &'a Function,
    /// What stands for each value, where it is not its name.
    meanings: Vec<Option<Sum>>,
    /// Names that are kept though they have definitions.
    kept: BTreeSet<&'a str>,
}

/// The sines and cosines of one angle.
pub(super) struct SinCos {
    /// Name of the sine: `s234`.
    pub(super) sin: String,
    /// Name of the cosine.
    pub(super) cos: String,
    /// What follows the letter: `234`.
    pub(super) suffix: String,
    /// Quarter turns (rad) between the argument in the plan and the angle that the names speak of.
    pub(super) quarters: f64,
}

impl<'a, 'w> Scope<'a, 'w> {
    /// A function before its first step. `kept` are names that stay in the text.
    pub(super) fn new(writer: &'w mut Writer<'a>, function: &'a Function, kept: BTreeSet<&'a str>) -> Self {
        Scope { writer, function, meanings: vec![None; function.values.len()], kept }
    }

    /// The name of a value.
    pub(super) fn name(&self, id: ValueId) -> &'a str {
        self.function.values.get(id.0).map_or("?", String::as_str)
    }

    /// A definition, which is `Some` where the name is kept.
    pub(super) fn define(&mut self, id: ValueId, value: &Scalar) -> Option<Sum> {
        let sum = self.sum(value);
        if sum.size() > LONGEST || self.kept.contains(self.name(id)) {
            return Some(sum);
        }
        self.mean(id, sum);
        None
    }

    /// The names of a sine and a cosine; where the plan has their negatives (`nc2`), they stand for these.
    pub(super) fn sin_cos(&mut self, sin: ValueId, cos: ValueId) -> SinCos {
        let quarters = variables::quarters(self.name(sin), self.name(cos));
        let mut names = [sin, cos].map(|id| {
            let name = self.name(id);
            let Some(positive) = name.strip_prefix('n') else {
                return name.to_owned();
            };
            self.mean(id, Sum::factor(Factor::Value(id.0, positive.to_owned())).neg());
            positive.to_owned()
        });
        names.sort_by_key(|name| !name.starts_with('s'));
        let [sin, cos] = names;
        let suffix = sin.get(1..).unwrap_or_default().to_owned();
        SinCos { sin, cos, suffix, quarters }
    }

    fn mean(&mut self, id: ValueId, sum: Sum) {
        if let Some(meaning) = self.meanings.get_mut(id.0) {
            *meaning = Some(sum);
        }
    }

    /// A scalar with its definitions put in.
    pub(super) fn sum(&mut self, scalar: &Scalar) -> Sum {
        match scalar {
            Scalar::Value(id) => match self.meanings.get(id.0) {
                Some(Some(meaning)) => meaning.clone(),
                _ => Sum::factor(Factor::Value(id.0, self.name(*id).to_owned())),
            },
            Scalar::Constant(id) => self.writer.constant(*id),
            Scalar::Number(value) => Sum::number(*value),
            Scalar::Neg(x) => self.sum(x).neg(),
            Scalar::Add(x, y) => self.sum(x).add(self.sum(y)),
            Scalar::Sub(x, y) => self.sum(x).sub(self.sum(y)),
            Scalar::Mul(x, y) => self.sum(x).mul(self.sum(y)),
            Scalar::Div(x, y) => self.sum(x).div(self.sum(y)),
        }
    }

    /// An angle or a length as a linear form in values; `None` where it is none.
    pub(super) fn form(&self, scalar: &Scalar) -> Option<Form> {
        let mut form = Form::zero(self.function.values.len());
        collect(scalar, 1.0, &mut form)?;
        Some(form)
    }

    /// The form in words, its constant in the unit of an angle or a length; slides among the values are lengths.
    pub(super) fn written(&self, form: &Form, kind: JointKind, slides: &[ValueId]) -> String {
        let units = self.writer.model.units;
        let constant = match kind {
            JointKind::Revolute => super::number::angle(form.constant, units),
            JointKind::Prismatic => super::number::trimmed(in_units(form.constant, 1, units)),
        };
        let terms = form.coefficients.iter().enumerate().map(|(at, coefficient)| {
            let other =
                if slides.contains(&ValueId(at)) { JointKind::Prismatic } else { JointKind::Revolute };
            let factor = variables::per(kind, units) / variables::per(other, units);
            (coefficient * factor, self.name(ValueId(at)).to_owned())
        });
        variables::linear(terms, &constant)
    }
}

impl Writer<'_> {
    /// A constant: its number, its name, or what it was folded from.
    fn constant(&mut self, id: ConstantId) -> Sum {
        let Some(constant) = self.plan.constants.get(id.0) else {
            return Sum::number(f64::NAN);
        };
        if self.numeric {
            return Sum::number(in_units(constant.value, constant.dimension, self.model.units));
        }
        let mut parts = BTreeSet::new();
        let list = &self.plan.constants;
        let folded = folded::read(&constant.note, &mut |name| {
            let place = list.iter().position(|known| known.name == name && known.name != constant.name)?;
            parts.insert(place);
            list.get(place).map(named)
        });
        if let Some(sum) = folded {
            self.used.extend(parts);
            return sum;
        }
        self.used.insert(id.0);
        named(constant)
    }
}

fn named(constant: &Constant) -> Sum {
    Sum::factor(Factor::Constant(constant.name.clone()))
}

/// Adds factor * scalar to a form.
fn collect(scalar: &Scalar, factor: f64, form: &mut Form) -> Option<()> {
    match scalar {
        Scalar::Value(id) => *form.coefficients.get_mut(id.0)? += factor,
        Scalar::Number(value) => form.constant += factor * value,
        Scalar::Neg(x) => collect(x, -factor, form)?,
        Scalar::Add(x, y) => {
            collect(x, factor, form)?;
            collect(y, factor, form)?;
        }
        Scalar::Sub(x, y) => {
            collect(x, factor, form)?;
            collect(y, -factor, form)?;
        }
        Scalar::Mul(x, y) => match (&**x, &**y) {
            (Scalar::Number(number), other) | (other, Scalar::Number(number)) => {
                collect(other, factor * number, form)?;
            }
            _ => return None,
        },
        Scalar::Div(x, y) => match &**y {
            Scalar::Number(number) => collect(x, factor / number, form)?,
            _ => return None,
        },
        Scalar::Constant(_) => return None,
    }
    Some(())
}
