//! Powers of the metre of a function's values, so that they can be shown in a table's units.

use super::{Constant, Function, FunctionKind, Scalar, Stage, Step, ValueId};
use crate::model::{JointKind, Model};

impl Function {
    /// For each of [`Function::values`], the power of the metre in it: 1 for lengths, 2 for their products, 0 for
    /// ratios and angles. `constants` are those of the plan.
    pub fn dimensions(&self, model: &Model, constants: &[Constant]) -> Vec<u8> {
        let mut dimensions = vec![0; self.values.len()];
        for (place, name) in self.values.iter().enumerate().take(self.inputs) {
            let length = match self.kind {
                FunctionKind::Inverse(_) => name.starts_with('p'),
                _ => model.joints.get(place).is_some_and(|row| slides(model, *row)),
            };
            set(&mut dimensions, ValueId(place), u8::from(length));
        }
        self.walk(&self.steps, model, constants, &mut dimensions);
        dimensions
    }

    fn walk(&self, steps: &[Step], model: &Model, constants: &[Constant], dimensions: &mut [u8]) {
        for step in steps {
            match step {
                Step::Let { name, value } => {
                    let power = dimension(value, constants, dimensions);
                    // A slide that only follows joints that turn has metres in its coefficients.
                    let slide = self.values.get(name.0).and_then(|name| name.strip_prefix('d'));
                    let row = slide.and_then(|row| row.parse::<usize>().ok()?.checked_sub(1));
                    let slide = row.is_some_and(|row| slides(model, row));
                    set(dimensions, *name, if slide { 1 } else { power });
                }
                Step::Solve { stage, root, body, .. } => {
                    let row = |stage: &Stage| slides(model, stage.rows.trailing_zeros() as usize);
                    let length = self.stages.get(*stage).is_some_and(row);
                    set(dimensions, *root, u8::from(length));
                    self.walk(body, model, constants, dimensions);
                }
                Step::General { chain, roots, body, .. } => {
                    let joints = chain.prismatic.iter().enumerate();
                    let slides =
                        joints.filter(|(place, _)| !chain.given.contains(place)).map(|(_, slides)| *slides);
                    for (root, slides) in roots.iter().zip(slides) {
                        set(dimensions, *root, u8::from(slides));
                    }
                    self.walk(body, model, constants, dimensions);
                }
                Step::Descents { chain, roots, body, .. } => {
                    for (root, turns) in roots.iter().zip(&chain.turns) {
                        set(dimensions, *root, u8::from(*turns == 0));
                    }
                    self.walk(body, model, constants, dimensions);
                }
                Step::Near { body, otherwise, .. } => {
                    self.walk(body, model, constants, dimensions);
                    self.walk(otherwise, model, constants, dimensions);
                }
                Step::SinCos { .. } | Step::Accept { .. } => {}
            }
        }
    }
}

fn slides(model: &Model, row: usize) -> bool {
    model.rows.get(row).is_some_and(|row| row.kind == JointKind::Prismatic)
}

fn set(dimensions: &mut [u8], id: ValueId, dimension: u8) {
    if let Some(entry) = dimensions.get_mut(id.0) {
        *entry = dimension;
    }
}

fn dimension(scalar: &Scalar, constants: &[Constant], dimensions: &[u8]) -> u8 {
    let of = |x: &Scalar| dimension(x, constants, dimensions);
    match scalar {
        Scalar::Value(id) => dimensions.get(id.0).copied().unwrap_or(0),
        Scalar::Constant(id) => constants.get(id.0).map_or(0, |constant| constant.dimension),
        Scalar::Number(_) => 0,
        Scalar::Neg(x) => of(x),
        Scalar::Add(x, y) | Scalar::Sub(x, y) => of(x).max(of(y)),
        Scalar::Mul(x, y) => of(x).saturating_add(of(y)),
        Scalar::Div(x, y) => of(x).saturating_sub(of(y)),
    }
}
