//! Steps and scalars of a plan as instructions over registers, each reference checked.

use super::error::PlanError;
use super::routine::{AtOnce, Chain, Instruction, Kernel, Near, Register, Solve};
use crate::plan::{Equation, Function, FunctionKind, Plan, Scalar, Step, ValueId};
use dh_core::Float;

/// Stages that may be nested in one another; more than any arm has joints.
const MAX_DEPTH: usize = 64;

/// The lowering of one function.
pub(super) struct Lowering<'p, S> {
    pub(super) plan: &'p Plan,
    pub(super) function: &'p Function,
    /// How many joint variables a candidate has.
    pub(super) joints: usize,
    /// The registers at the start, see [`super::routine::Routine::start`].
    pub(super) start: Vec<S>,
    /// Which values may be read.
    pub(super) defined: Vec<bool>,
}

impl<S: Float> Lowering<'_, S> {
    pub(super) fn steps(&mut self, steps: &[Step], depth: usize) -> Result<Vec<Instruction>, PlanError> {
        let mut code = Vec::with_capacity(2 * steps.len());
        for step in steps {
            self.step(step, depth, &mut code)?;
        }
        Ok(code)
    }

    fn step(&mut self, step: &Step, depth: usize, code: &mut Vec<Instruction>) -> Result<(), PlanError> {
        match step {
            Step::Let { name, value } => {
                let to = self.slot(*name)?;
                self.scalar_to(value, to, code)?;
                self.define(*name);
                code.push(Instruction::Named(to));
            }
            Step::SinCos { sin, cos, angle } => {
                let (sin_slot, cos_slot) = (self.slot(*sin)?, self.slot(*cos)?);
                let angle = self.scalar(angle, code)?;
                code.push(Instruction::SinCos { sin: sin_slot, cos: cos_slot, angle });
                self.define(*sin);
                self.define(*cos);
                code.extend([Instruction::Named(sin_slot), Instruction::Named(cos_slot)]);
            }
            Step::Solve { stage, root, sin_cos, equation, body } => {
                self.inverse_only()?;
                if *stage >= self.function.stages.len() || depth >= MAX_DEPTH {
                    return Err(PlanError::Stage { index: *stage });
                }
                let root_slot = self.slot(*root)?;
                let angle = !matches!(equation, Equation::Linear { .. } | Equation::Quadratic { .. });
                let equation = self.equation(equation, code)?;
                let sin_cos = match sin_cos {
                    Some([sin, cos]) => Some([self.slot(*sin)?, self.slot(*cos)?]),
                    None => None,
                };
                // What a body defines is not known outside of it.
                let outside = self.defined.clone();
                self.define(*root);
                sin_cos.into_iter().flatten().for_each(|slot| self.define(ValueId(slot)));
                let body = self.steps(body, depth + 1)?;
                self.defined = outside;
                let solve = Solve { stage: *stage, root: root_slot, angle, sin_cos, equation, body };
                code.push(Instruction::Solve(Box::new(solve)));
            }
            Step::General { stage, chain, given, roots, body } => {
                let chain = Chain::General(chain.clone());
                self.at_once(*stage, chain, given, roots, (body, depth), code)?;
            }
            Step::Descents { stage, chain, given, roots, body } => {
                let chain = Chain::Following(chain.clone());
                self.at_once(*stage, chain, given, roots, (body, depth), code)?;
            }
            Step::Near { nearly, body, otherwise, .. } => {
                self.inverse_only()?;
                let [body, otherwise] = [body, otherwise].map(|steps| {
                    let outside = self.defined.clone();
                    let steps = self.steps(steps, depth + 1);
                    self.defined = outside;
                    steps
                });
                let near = Near { nearly: nearly.clone(), body: body?, otherwise: otherwise? };
                code.push(Instruction::Near(Box::new(near)));
            }
            Step::Accept { q, tool, polish } => {
                self.inverse_only()?;
                if q.len() != self.joints {
                    return Err(PlanError::Candidate { expected: self.joints, got: q.len() });
                }
                if !matches!(tool.len(), 0 | 12) {
                    return Err(PlanError::Candidate { expected: 12, got: tool.len() });
                }
                let mut registers = |scalars: &[Scalar]| {
                    scalars.iter().map(|x| self.scalar(x, code)).collect::<Result<Vec<_>, _>>()
                };
                let (q, tool) = (registers(q)?, registers(tool)?);
                code.push(Instruction::Accept { q, tool, polish: *polish });
            }
        }
        Ok(())
    }

    /// A step for all unknowns at once, with its body at a depth.
    fn at_once(
        &mut self,
        stage: usize,
        chain: Chain,
        given: &[Scalar],
        roots: &[ValueId],
        (body, depth): (&[Step], usize),
        code: &mut Vec<Instruction>,
    ) -> Result<(), PlanError> {
        self.inverse_only()?;
        if stage >= self.function.stages.len() || depth >= MAX_DEPTH {
            return Err(PlanError::Stage { index: stage });
        }
        let given = given.iter().map(|x| self.scalar(x, code)).collect::<Result<_, _>>()?;
        let slots = roots.iter().map(|root| self.slot(*root)).collect::<Result<_, _>>()?;
        let outside = self.defined.clone();
        for root in roots {
            self.define(*root);
        }
        let body = self.steps(body, depth + 1)?;
        self.defined = outside;
        code.push(Instruction::AtOnce(Box::new(AtOnce { stage, chain, given, roots: slots, body })));
        Ok(())
    }

    fn equation(&mut self, equation: &Equation, code: &mut Vec<Instruction>) -> Result<Kernel, PlanError> {
        Ok(match equation {
            Equation::Trig { a, b, c } => Kernel::Trig(self.coefficients([a, b, c], code)?),
            Equation::TrigUnit { row, others } => {
                let row = self.coefficients(row.each_ref(), code)?;
                Kernel::TrigUnit(row, self.coefficients(others.each_ref(), code)?)
            }
            Equation::TrigPair { first, second } => {
                let first = self.coefficients(first.each_ref(), code)?;
                Kernel::TrigPair(first, self.coefficients(second.each_ref(), code)?)
            }
            Equation::TrigEither { first, second } => {
                let first = self.coefficients(first.each_ref(), code)?;
                Kernel::TrigEither(first, self.coefficients(second.each_ref(), code)?)
            }
            Equation::Linear { a, c } => Kernel::Linear(self.coefficients([a, c], code)?),
            Equation::Quadratic { a, b, c } => Kernel::Quadratic(self.coefficients([a, b, c], code)?),
            Equation::Quartic { forms, right, vector } => {
                let (forms, right) = (self.pair(forms, code)?, self.scalar(right, code)?);
                let Some(vector) = vector else { return Ok(Kernel::Quartic(forms, right)) };
                let others = self.pair(&vector.others, code)?;
                Kernel::QuarticUnit(forms, right, others, self.coefficients(vector.length.each_ref(), code)?)
            }
        })
    }

    fn pair(
        &mut self,
        [first, second]: &[[Scalar; 3]; 2],
        code: &mut Vec<Instruction>,
    ) -> Result<[[Register; 3]; 2], PlanError> {
        let first = self.coefficients(first.each_ref(), code)?;
        Ok([first, self.coefficients(second.each_ref(), code)?])
    }

    fn coefficients<const N: usize>(
        &mut self,
        scalars: [&Scalar; N],
        code: &mut Vec<Instruction>,
    ) -> Result<[Register; N], PlanError> {
        let mut registers = [0; N];
        for (register, scalar) in registers.iter_mut().zip(scalars) {
            *register = self.scalar(scalar, code)?;
        }
        Ok(registers)
    }

    /// The register that holds a scalar: the value's, or a new one.
    pub(super) fn scalar(
        &mut self,
        scalar: &Scalar,
        code: &mut Vec<Instruction>,
    ) -> Result<Register, PlanError> {
        match scalar {
            Scalar::Value(id) => {
                let register = self.slot(*id)?;
                let defined = self.defined.get(id.0).copied().unwrap_or(false);
                if defined { Ok(register) } else { Err(PlanError::Undefined { value: self.name(*id) }) }
            }
            Scalar::Constant(id) => match self.plan.constants.get(id.0) {
                Some(constant) => Ok(self.register(S::from_f64(constant.value))),
                None => Err(PlanError::Constant { index: id.0 }),
            },
            Scalar::Number(value) => Ok(self.register(S::from_f64(*value))),
            compound => {
                let to = self.register(S::ZERO);
                self.scalar_to(compound, to, code)?;
                Ok(to)
            }
        }
    }

    /// Computes a scalar into a register.
    fn scalar_to(
        &mut self,
        scalar: &Scalar,
        to: Register,
        code: &mut Vec<Instruction>,
    ) -> Result<(), PlanError> {
        let operands = match scalar {
            Scalar::Value(_) | Scalar::Constant(_) | Scalar::Number(_) => {
                let from = self.scalar(scalar, code)?;
                code.push(Instruction::Copy { to, from });
                return Ok(());
            }
            Scalar::Neg(inner) => {
                let from = self.scalar(inner, code)?;
                code.push(Instruction::Negate { to, from });
                return Ok(());
            }
            Scalar::Add(left, right)
            | Scalar::Sub(left, right)
            | Scalar::Mul(left, right)
            | Scalar::Div(left, right) => [&**left, &**right],
        };
        let [left, right] = self.coefficients(operands, code)?;
        code.push(match scalar {
            Scalar::Add(..) => Instruction::Add { to, left, right },
            Scalar::Sub(..) => Instruction::Subtract { to, left, right },
            Scalar::Mul(..) => Instruction::Multiply { to, left, right },
            _ => Instruction::Divide { to, left, right },
        });
        Ok(())
    }

    /// The register of a value; its number is the value's.
    fn slot(&self, id: ValueId) -> Result<Register, PlanError> {
        if id.0 < self.function.values.len() { Ok(id.0) } else { Err(PlanError::Value { index: id.0 }) }
    }

    fn define(&mut self, id: ValueId) {
        if let Some(defined) = self.defined.get_mut(id.0) {
            *defined = true;
        }
    }

    fn name(&self, id: ValueId) -> String {
        self.function.values.get(id.0).cloned().unwrap_or_default()
    }

    /// A new register that starts out as this number. None is used for two things: an operation of a plan is done
    /// once or not at all, and a function has some hundred of them.
    fn register(&mut self, start: S) -> Register {
        self.start.push(start);
        self.start.len() - 1
    }

    fn inverse_only(&self) -> Result<(), PlanError> {
        if matches!(self.function.kind, FunctionKind::Inverse(_)) { Ok(()) } else { Err(PlanError::Solving) }
    }
}
