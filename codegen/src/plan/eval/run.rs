//! Running a lowered function.

use super::filter::Filter;
use super::routine::{self, AtOnce, Chain, Instruction, Kernel, Register, Routine, Solve};
use super::trace::Event;
use crate::plan::Function;
use dh_core::{
    Candidates, Condition, Float, Frame, IkError, MAX_JOINTS, Near, QuarticRoots, Roots, Rule, Search,
    Solutions, Target, Wanted, Winding, residual_tolerance,
};

/// The registers of one run. Register numbers were checked when the function was lowered.
pub(super) struct Registers<S>(Vec<S>);

impl<S: Float> Registers<S> {
    /// Those of a function at its start, inputs in place.
    pub(super) fn of(routine: &Routine<S>, inputs: impl IntoIterator<Item = S>) -> Self {
        let mut registers = routine.start.clone();
        let slots = registers.iter_mut().take(routine.inputs);
        slots.zip(inputs).for_each(|(slot, input)| *slot = input);
        Registers(registers)
    }

    pub(super) fn get(&self, register: Register) -> S {
        self.0[register]
    }

    fn set(&mut self, register: Register, value: S) {
        self.0[register] = value;
    }

    fn set_first(&mut self, values: &[S]) {
        self.0.iter_mut().zip(values).for_each(|(slot, value)| *slot = *value);
    }

    fn all<const N: usize>(&self, registers: [Register; N]) -> [S; N] {
        registers.map(|register| self.get(register))
    }

    /// One instruction that neither solves nor accepts.
    fn compute(&mut self, instruction: &Instruction) {
        match *instruction {
            Instruction::Copy { to, from } => self.set(to, self.get(from)),
            Instruction::Negate { to, from } => self.set(to, -self.get(from)),
            Instruction::Add { to, left, right } => self.set(to, self.get(left) + self.get(right)),
            Instruction::Subtract { to, left, right } => self.set(to, self.get(left) - self.get(right)),
            Instruction::Multiply { to, left, right } => self.set(to, self.get(left) * self.get(right)),
            Instruction::Divide { to, left, right } => self.set(to, self.get(left) / self.get(right)),
            Instruction::SinCos { sin, cos, angle } => {
                let (s, c) = self.get(angle).sin_cos();
                self.set(sin, s);
                self.set(cos, c);
            }
            Instruction::Named(_)
            | Instruction::Solve(_)
            | Instruction::AtOnce(_)
            | Instruction::Near(_)
            | Instruction::Accept { .. } => {}
        }
    }
}

/// Runs a forward function.
pub(super) fn forward<S: Float>(
    routine: &Routine<S>,
    names: &Function,
    registers: &mut Registers<S>,
    mut observer: impl FnMut(Event<'_, S>),
) {
    for instruction in &routine.code {
        match instruction {
            Instruction::Named(register) => named(names, *register, registers, &mut observer),
            other => registers.compute(other),
        }
    }
}

/// Tells an observer the value of a step.
fn named<S: Float>(
    names: &Function,
    register: Register,
    registers: &Registers<S>,
    observer: &mut impl FnMut(Event<'_, S>),
) {
    if let Some(name) = names.values.get(register) {
        observer(Event::Value { name, value: registers.get(register) });
    }
}

/// 12 outputs of a function, from the given one on, as a frame.
pub(super) fn frame<S: Float>(outputs: &[Register], registers: &Registers<S>) -> Frame<S> {
    let mut rows = [S::ZERO; 12];
    rows.iter_mut().zip(outputs).for_each(|(entry, output)| *entry = registers.get(*output));
    Frame::from_rows(rows)
}

/// What an inverse run needs besides its own function.
pub(super) struct Inverse<'r, S, F> {
    pub(super) routine: &'r Routine<S>,
    pub(super) names: &'r Function,
    /// Forward kinematics, which judges every candidate.
    pub(super) fk: &'r Routine<S>,
    /// Forward kinematics with the Jacobian, which brings candidates of the full pose nearer.
    pub(super) both: Option<&'r Routine<S>>,
    pub(super) target: &'r Target<S>,
    pub(super) dof: usize,
    /// m
    pub(super) reach: S,
    /// The problem's `where`.
    pub(super) filters: &'r [Filter<S>],
    pub(super) observer: F,
    pub(super) windings: &'r [Winding<'r, S>],
    /// Where the target leaves unknowns free.
    pub(super) wanted: &'r Wanted<'r, MAX_JOINTS, S>,
    pub(super) search: Searching<'r, S>,
}

/// By which kernels steps are solved, or what has come of it.
pub(super) enum Searching<'w, S> {
    Exact(Search<'w, MAX_JOINTS, S>),
    Near(Box<Near<'w, MAX_JOINTS, S>>),
    Done(Result<Solutions<MAX_JOINTS, S>, IkError<S>>),
}

impl<S: Float> Searching<'_, S> {
    fn roots(&mut self, step: dh_core::Step, equation: Kernel, registers: &Registers<S>) -> Found<S> {
        if let Kernel::Quartic(forms, right) = equation {
            let forms = forms.map(|form| registers.all(form));
            return match self {
                Self::Exact(search) => Found::Four(search.quartic(step, forms, registers.get(right))),
                Self::Near(near) => Found::Four(near.quartic(step, forms, registers.get(right))),
                Self::Done(_) => Found::Two(Roots::NONE),
            };
        }
        if let Kernel::QuarticUnit(forms, right, others, length) = equation {
            let [forms, others] = [forms, others].map(|pair| pair.map(|form| registers.all(form)));
            let (right, length) = (registers.get(right), registers.all(length));
            return match self {
                Self::Exact(search) => Found::Four(search.quartic_unit(step, forms, right, others, length)),
                Self::Near(near) => Found::Four(near.quartic_unit(step, forms, right, others, length)),
                Self::Done(_) => Found::Two(Roots::NONE),
            };
        }
        // Nearly special arms do without this one.
        if let Kernel::TrigEither(first, second) = equation {
            return Found::Two(match self {
                Self::Exact(search) => search.trig_either(step, registers.all(first), registers.all(second)),
                Self::Near(_) | Self::Done(_) => Roots::NONE,
            });
        }
        macro_rules! solved {
            ($search:expr) => {
                match equation {
                    Kernel::Trig(coefficients) => {
                        let [a, b, c] = registers.all(coefficients);
                        $search.trig(step, a, b, c)
                    }
                    Kernel::TrigUnit(row, others) => {
                        $search.trig_unit(step, registers.all(row), registers.all(others))
                    }
                    Kernel::TrigPair(first, second) => {
                        $search.trig_pair(step, registers.all(first), registers.all(second))
                    }
                    Kernel::Linear(coefficients) => {
                        let [a, c] = registers.all(coefficients);
                        $search.linear(step, a, c)
                    }
                    Kernel::Quadratic(coefficients) => {
                        let [a, b, c] = registers.all(coefficients);
                        $search.quadratic(step, a, b, c)
                    }
                    Kernel::TrigEither(..) | Kernel::Quartic(..) | Kernel::QuarticUnit(..) => Roots::NONE,
                }
            };
        }
        Found::Two(match self {
            Self::Exact(search) => solved!(search),
            Self::Near(near) => solved!(near),
            Self::Done(_) => Roots::NONE,
        })
    }

    fn next_candidate(&mut self, candidates: &mut Candidates) -> Option<[S; 6]> {
        match self {
            Self::Exact(search) => search.next_candidate(candidates),
            Self::Near(_) | Self::Done(_) => None,
        }
    }

    fn next(&mut self, roots: &mut Roots<S>) -> Option<S> {
        match self {
            Self::Exact(search) => search.next(roots),
            Self::Near(near) => near.next(roots),
            Self::Done(_) => None,
        }
    }

    fn next_of_quartic(&mut self, roots: &mut QuarticRoots<S>) -> Option<(S, S, S)> {
        match self {
            Self::Exact(search) => search.next_of_quartic(roots),
            Self::Near(near) => near.next_of_quartic(roots),
            Self::Done(_) => None,
        }
    }

    fn next_angle(&mut self, roots: &mut Roots<S>) -> Option<(S, S, S)> {
        match self {
            Self::Exact(search) => search.next_angle(roots),
            Self::Near(near) => near.next_angle(roots),
            Self::Done(_) => None,
        }
    }
}

impl<'r, S: Float, F: FnMut(Event<'_, S>)> Inverse<'r, S, F> {
    /// Runs the function: every candidate ends in the search.
    pub(super) fn run(&mut self, registers: &mut Registers<S>) {
        let routine = self.routine;
        self.block(&routine.code, registers);
    }

    /// What was found.
    pub(super) fn finish(self) -> Result<Solutions<MAX_JOINTS, S>, IkError<S>> {
        let (both, dof) = (self.both, self.dof);
        match (self.search, both) {
            (Searching::Exact(mut search), Some(both)) => {
                search.finish_marked(&self.routine.motions, self.target, |q: &[S; MAX_JOINTS]| {
                    pose_and_jacobian(both, q.get(..dof).unwrap_or_default())
                })
            }
            (Searching::Exact(mut search), None) => search.finish(),
            (Searching::Near(_), _) => Err(IkError::NotFinite),
            (Searching::Done(answer), _) => answer,
        }
    }

    fn block(&mut self, code: &'r [Instruction], registers: &mut Registers<S>) {
        for instruction in code {
            match instruction {
                Instruction::Named(register) => {
                    named(self.names, *register, registers, &mut self.observer);
                }
                Instruction::Solve(solve) => self.solve(solve, registers),
                Instruction::AtOnce(all) => self.at_once(all, registers),
                Instruction::Near(near) => self.near(near, registers),
                Instruction::Accept { q, tool, polish } => self.accept(q, tool, *polish, registers),
                other => registers.compute(other),
            }
        }
    }

    fn solve(&mut self, solve: &'r Solve, registers: &mut Registers<S>) {
        let (Some(step), Some(stage)) =
            (self.routine.stages.get(solve.stage), self.names.stages.get(solve.stage))
        else {
            return;
        };
        let mut roots = self.search.roots(*step, solve.equation, registers);
        let count = match &roots {
            Found::Two(roots) => roots.len(),
            Found::Four(roots) => roots.len(),
        };
        (self.observer)(Event::Stage { index: solve.stage, stage, roots: count });
        let mut number = 0;
        while let Some(root) = self.next(solve, &mut roots, registers) {
            let name = self.names.values.get(solve.root).map_or("", String::as_str);
            (self.observer)(Event::Root { stage: solve.stage, number, name, value: root });
            self.block(&solve.body, registers);
            number += 1;
        }
        (self.observer)(Event::Done { stage: solve.stage });
    }

    fn at_once(&mut self, all: &'r AtOnce, registers: &mut Registers<S>) {
        let (Some(step), Some(stage)) =
            (self.routine.stages.get(all.stage), self.names.stages.get(all.stage))
        else {
            return;
        };
        let given: Vec<S> = all.given.iter().map(|register| registers.get(*register)).collect();
        let Searching::Exact(search) = &mut self.search else { return };
        let target = self.target;
        let mut candidates = match &all.chain {
            Chain::General(chain) => search.general(*step, &chain.arm(), target, &given),
            Chain::Following(chain) => chain.with(|chain| search.descents(*step, chain, target, &given)),
        };
        (self.observer)(Event::Stage { index: all.stage, stage, roots: candidates.len() });
        let mut number = 0;
        while let Some(values) = self.search.next_candidate(&mut candidates) {
            for (root, value) in all.roots.iter().zip(values) {
                registers.set(*root, value);
                let name = self.names.values.get(*root).map_or("", String::as_str);
                (self.observer)(Event::Root { stage: all.stage, number, name, value });
            }
            self.block(&all.body, registers);
            number += 1;
        }
        (self.observer)(Event::Done { stage: all.stage });
    }

    fn near(&mut self, near: &'r routine::Near, registers: &mut Registers<S>) {
        let chain = near.otherwise.iter().find_map(|instruction| match instruction {
            Instruction::AtOnce(all) => match &all.chain {
                Chain::General(chain) => Some(chain),
                Chain::Following(_) => None,
            },
            _ => None,
        });
        let nearly = near.nearly.of(chain);
        self.search = Searching::Near(Box::new(Near::new(self.reach, self.windings, &nearly, self.target)));
        while let Searching::Near(search) = &mut self.search
            && let Some(asked) = search.next_target()
        {
            registers.set_first(&asked.numbers());
            self.block(&near.body, registers);
        }
        let Searching::Near(search) = &mut self.search else { return };
        let (filters, dof) = (self.filters, self.dof);
        let broken = |q: &[S; MAX_JOINTS]| broken(filters, q.get(..dof).unwrap_or_default());
        if let Some(answer) = search.finish_where(broken) {
            self.search = Searching::Done(answer);
        } else {
            let Some(both) = self.both else { return };
            let exact = |q: &[S; MAX_JOINTS]| pose_and_jacobian(both, q.get(..dof).unwrap_or_default());
            let otherwise = search.otherwise(self.wanted, exact).with_given(&self.names.free);
            self.search = Searching::Exact(otherwise);
            self.block(&near.otherwise, registers);
            if let Searching::Exact(search) = &mut self.search {
                self.search = Searching::Done(search.finish_where(broken));
            }
        }
    }

    /// The next root, in its registers.
    fn next(&mut self, solve: &Solve, roots: &mut Found<S>, registers: &mut Registers<S>) -> Option<S> {
        let (root, sin, cos) = match roots {
            Found::Two(roots) if !solve.angle => {
                let root = self.search.next(roots)?;
                registers.set(solve.root, root);
                return Some(root);
            }
            Found::Two(roots) => self.search.next_angle(roots)?,
            Found::Four(roots) => self.search.next_of_quartic(roots)?,
        };
        registers.set(solve.root, root);
        if let Some([sin_slot, cos_slot]) = solve.sin_cos {
            registers.set(sin_slot, sin);
            registers.set(cos_slot, cos);
        }
        Some(root)
    }

    fn accept(&mut self, candidate: &[Register], tool: &[Register], polish: bool, registers: &Registers<S>) {
        let mut q = [S::ZERO; MAX_JOINTS];
        q.iter_mut().zip(candidate).for_each(|(q, register)| *q = registers.get(*register));
        let joints = q.get(..self.dof).unwrap_or_default();
        let tool = if tool.is_empty() { forward_frame(self.fk, joints) } else { frame(tool, registers) };
        let (position_error, rotation_error) = self.target.errors(&tool);
        let conditions: Vec<_> = self.filters.iter().map(|filter| filter.at(joints)).collect();
        let tolerance = residual_tolerance::<S>();
        let hits = position_error <= tolerance * self.reach && rotation_error <= tolerance;
        let kept = hits && conditions.iter().all(Condition::holds);
        (self.observer)(Event::Candidate { q: joints, position_error, rotation_error, kept });
        let dof = self.dof;
        let exact = self
            .both
            .map(|both| |q: &[S; MAX_JOINTS]| pose_and_jacobian(both, q.get(..dof).unwrap_or_default()));
        match (&mut self.search, self.target, exact) {
            (Searching::Near(near), _, Some(exact)) => near.accept(q, &tool, exact),
            (Searching::Exact(search), Target::Pose(target), Some(exact)) if polish => {
                search.accept_pose(q, &tool, target, exact);
            }
            (Searching::Exact(search), ..) => {
                search.accept_where(q, position_error, rotation_error, &conditions);
            }
            (Searching::Near(_) | Searching::Done(_), ..) => {}
        }
    }
}

/// Roots of an equation.
enum Found<S> {
    /// Up to two.
    Two(Roots<S>),
    /// Up to four.
    Four(QuarticRoots<S>),
}

/// Which of a problem's conditions joint values break.
fn broken<S: Float>(filters: &[Filter<S>], joints: &[S]) -> Option<Rule<S>> {
    let conditions: Vec<_> = filters.iter().map(|filter| filter.at(joints)).collect();
    Condition::broken(&conditions)
}

/// The tool frame by a forward function.
fn forward_frame<S: Float>(fk: &Routine<S>, joints: &[S]) -> Frame<S> {
    let mut registers = Registers::of(fk, joints.iter().copied());
    fk.code.iter().for_each(|instruction| registers.compute(instruction));
    frame(&fk.outputs, &registers)
}

/// The tool frame and the columns of the Jacobian by a forward function.
fn pose_and_jacobian<S: Float>(both: &Routine<S>, joints: &[S]) -> (Frame<S>, [[S; 6]; MAX_JOINTS]) {
    let mut registers = Registers::of(both, joints.iter().copied());
    both.code.iter().for_each(|instruction| registers.compute(instruction));
    let mut columns = [[S::ZERO; 6]; MAX_JOINTS];
    let outputs = both.outputs.get(12..).unwrap_or_default();
    for (entry, output) in columns.as_flattened_mut().iter_mut().zip(outputs) {
        *entry = registers.get(*output);
    }
    (frame(&both.outputs, &registers), columns)
}
