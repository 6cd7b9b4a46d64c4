//! By how much a step of a closed form is off where the target, or what earlier steps have found, is off.

use super::super::{Equation, Function, Measure, Scalar, Step, ValueId, descents};
use super::{Moves, SAMPLES, frame, joint_vector};
use crate::model::{JointKind, Model, Target, product};
use dh_core::{Frame, Roots, Search};
use std::f64::consts::TAU;

/// What the greatest deviation over some joint vectors is multiplied by, for those in between.
const SAFETY: f64 = 1.5;

/// Change (rad, reaches) of a target or of an unknown in the quotients of differences.
const DIFFERENCE: f64 = 1e-6;

/// The greatest gains of a closed form's steps: row k has what the deviation (rad, reaches) makes of its equation, then what
/// each of the unknowns of steps 0 ... k - 1 does that is off by 1 (rad, reaches). Equations are in the size of their terms.
/// `None` where it is never solved.
pub(super) fn of(
    nominal: &Model,
    function: &Function,
    target: Target,
    moves: &Moves,
    constants: &[f64],
    deviation: f64,
) -> Option<Vec<Vec<f64>>> {
    let mut gains = greatest(nominal, function, target, moves, constants)?;
    for row in &mut gains {
        row.iter_mut().take(1).for_each(|gain| *gain *= SAFETY * deviation);
        for gain in row {
            *gain = rounded_up(*gain);
        }
    }
    Some(gains)
}

/// To three digits, not smaller.
fn rounded_up(x: f64) -> f64 {
    format!("{:.2e}", 1.005 * x).parse().unwrap_or(x)
}

/// In -pi ... pi.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * libm::round(angle / TAU)
}

/// The greatest changes of equations with target and unknowns.
fn greatest(
    nominal: &Model,
    function: &Function,
    target: Target,
    moves: &Moves,
    constants: &[f64],
) -> Option<Vec<Vec<f64>>> {
    let stages = function.stages.len();
    let mut gains: Vec<Vec<f64>> = (0..stages).map(|stage| vec![0.0; stage + 1]).collect();
    let mut solved = 0;
    for sample in 0..SAMPLES {
        let q = moves.kept(joint_vector(nominal, sample));
        let tool = frame(&product::frames(nominal, &q).tool);
        let given: Vec<f64> = function.free.iter().filter_map(|joint| q.get(*joint).copied()).collect();
        let branch = Branch { nominal, function, target, constants, given };
        let Some(roots) = branch.roots(&tool, |stage, _| sample >> stage & 1) else { continue };
        solved += 1;
        let reach = branch.reach();
        let at = branch.left(&tool, &roots);
        let mut squares = vec![0.0; stages];
        for direction in 0..6 {
            let mut twist = [0.0; 6];
            if let Some(part) = twist.get_mut(direction) {
                *part = DIFFERENCE;
            }
            let [x, y, z, roll, pitch, yaw] = twist;
            let step = Frame::from_rpy([x, y, z].map(|x| x * reach), [roll, pitch, yaw]);
            let moved = tool.compose(&step);
            for (square, change) in squares.iter_mut().zip(changes(&at, &branch.left(&moved, &roots))) {
                *square += change * change;
            }
        }
        for (row, square) in gains.iter_mut().zip(squares) {
            greater(row.first_mut(), square.sqrt());
        }
        for unknown in 0..stages {
            let mut moved = roots.clone();
            if let Some(root) = moved.get_mut(unknown) {
                *root += DIFFERENCE * if branch.slides(unknown) { reach } else { 1.0 };
            }
            let changes = changes(&at, &branch.left(&tool, &moved));
            for (row, change) in gains.iter_mut().zip(changes).skip(unknown + 1) {
                greater(row.get_mut(unknown + 1), change);
            }
        }
    }
    (solved > 0).then_some(gains)
}

fn greater(entry: Option<&mut f64>, value: f64) {
    if let Some(entry) = entry {
        // What rounding leaves of 0 is none.
        *entry = entry.max(if value > DIFFERENCE { value } else { 0.0 });
    }
}

/// By how much the equations of all steps have changed, over the difference.
fn changes(before: &[f64], after: &[f64]) -> Vec<f64> {
    before.iter().zip(after).map(|(before, after)| (after - before).abs() / DIFFERENCE).collect()
}

/// One way through the steps.
struct Branch<'a> {
    nominal: &'a Model,
    function: &'a Function,
    target: Target,
    constants: &'a [f64],
    given: Vec<f64>,
}

impl Branch<'_> {
    fn reach(&self) -> f64 {
        let reach = self.nominal.reach();
        if reach > 0.0 { reach } else { 1.0 }
    }

    fn slides(&self, stage: usize) -> bool {
        let row = self.function.stages.get(stage).map(|stage| stage.rows.trailing_zeros() as usize);
        let row = row.and_then(|row| self.nominal.rows.get(row));
        row.is_some_and(|row| row.kind == JointKind::Prismatic)
    }

    /// Roots of all steps; which of a list, a function says.
    fn roots(&self, tool: &Frame, choice: impl Fn(usize, &[f64]) -> usize) -> Option<Vec<f64>> {
        let mut roots = Vec::new();
        let mut found = true;
        self.walk(tool, |stage, equation, value| {
            let step = self.step(stage);
            let mut search = Search::<1>::new(self.reach(), &[]);
            let number = |x: &Scalar| value(x);
            let all = match equation {
                Equation::Trig { a, b, c } => search.trig(step, number(a), number(b), number(c)),
                Equation::TrigUnit { row, others } => {
                    search.trig_unit(step, row.each_ref().map(number), others.each_ref().map(number))
                }
                Equation::TrigPair { first, second } => {
                    search.trig_pair(step, first.each_ref().map(number), second.each_ref().map(number))
                }
                Equation::Linear { a, c } => search.linear(step, number(a), number(c)),
                Equation::Quadratic { a, b, c } => search.quadratic(step, number(a), number(b), number(c)),
                // There is none of the one in these functions; the other follows.
                Equation::TrigEither { .. } | Equation::Quartic { .. } => Roots::NONE,
            };
            let mut list: Vec<f64> = all.into_iter().collect();
            if let Equation::Quartic { forms, right, .. } = equation {
                let forms = forms.each_ref().map(|form| form.each_ref().map(number));
                let mut all = search.quartic(step, forms, number(right));
                // One root of any value would go on for as long as none of them leads to a solution.
                for _ in 0..all.len() {
                    list.extend(search.next_of_quartic(&mut all).map(|(root, ..)| root));
                }
            }
            let root = list.get(choice(stage, &list) % list.len().max(1)).copied();
            found &= root.is_some();
            roots.push(root.unwrap_or(0.0));
            root.unwrap_or(0.0)
        });
        found.then_some(roots)
    }

    /// What the equation of each step is at these roots, in the size of its terms.
    fn left(&self, tool: &Frame, roots: &[f64]) -> Vec<f64> {
        let mut left = Vec::new();
        self.walk(tool, |stage, equation, value| {
            let x = roots.get(stage).copied().unwrap_or(0.0);
            let size = self.size(stage);
            let (s, c) = libm::sincos(x);
            let trig = |[a, b, right]: [&Scalar; 3]| value(a) * c + value(b) * s - value(right);
            left.push(
                size.recip()
                    * match equation {
                        Equation::Trig { a, b, c } => trig([a, b, c]),
                        Equation::TrigPair { first, second } => {
                            // What is off along the rows' own angle; rows of another size have the same root.
                            let [a, b, d, e] = [&first[0], &first[1], &second[0], &second[1]].map(value);
                            let [one, other] = [trig(first.each_ref()), trig(second.each_ref())];
                            let cos = one * e - other * b;
                            let sin = other * a - one * d;
                            (c * sin - s * cos) / a.hypot(b).max(d.hypot(e))
                        }
                        // The angle between an axis and a unit vector whose part along it is c.
                        Equation::TrigUnit { row: [a, b, c], others: [d, e] } => {
                            let [a, b, c, d, e] = [a, b, c, d, e].map(value);
                            let between = libm::atan2(d.hypot(e), c);
                            let to = libm::atan2(b, a);
                            let away = x - to;
                            wrapped(away).abs() - between
                        }
                        Equation::Linear { a, c } => value(a) * x - value(c),
                        Equation::Quadratic { a, b, c } => (value(a) * x + value(b)) * x + value(c),
                        Equation::Quartic { forms, right, .. } => {
                            let sum = |[k, l, m]: [&Scalar; 3]| value(k) + value(l) * c + value(m) * s;
                            let [first, second] = forms.each_ref().map(|form| sum(form.each_ref()));
                            (first * first + second * second - value(right).powi(2)) / size
                        }
                        // There are none in these functions.
                        Equation::TrigEither { .. } => f64::INFINITY,
                    },
            );
            x
        });
        left
    }

    /// Of the terms of a step's equation.
    fn size(&self, stage: usize) -> f64 {
        let power = match self.function.stages.get(stage).map(|stage| stage.measure) {
            Some(Measure::Length) => 1,
            Some(Measure::Area) => 2,
            Some(Measure::Power(power)) => power,
            _ => 0,
        };
        self.reach().powi(power.into())
    }

    fn step(&self, stage: usize) -> dh_core::Step {
        let measure = match self.function.stages.get(stage).map(|stage| stage.measure) {
            Some(Measure::Length) => dh_core::Measure::Length,
            Some(Measure::Area) => dh_core::Measure::Area,
            Some(Measure::Power(power)) => dh_core::Measure::Power(power),
            _ => dh_core::Measure::Ratio,
        };
        dh_core::Step::new(0, 1, self.slides(stage), measure)
    }

    /// Goes through the steps; each equation is asked for the root to go on with. Returns all values.
    fn walk(
        &self,
        tool: &Frame,
        mut root: impl FnMut(usize, &Equation, &dyn Fn(&Scalar) -> f64) -> f64,
    ) -> Vec<f64> {
        let mut values = vec![0.0; self.function.values.len()];
        let asked = descents::asked(self.target, tool, self.reach()).numbers();
        let inputs = asked.iter().chain(&self.given).copied();
        values.iter_mut().zip(inputs).for_each(|(value, input)| *value = input);
        let mut steps = self.function.steps.as_slice();
        let mut open = Vec::new();
        loop {
            let Some((step, rest)) = steps.split_first() else {
                let Some(next) = open.pop() else { return values };
                steps = next;
                continue;
            };
            steps = rest;
            match step {
                Step::Let { name, value } => {
                    let value = self.value(value, &values);
                    set(&mut values, *name, value);
                }
                Step::SinCos { sin, cos, angle } => {
                    let (s, c) = libm::sincos(self.value(angle, &values));
                    set(&mut values, *sin, s);
                    set(&mut values, *cos, c);
                }
                Step::Solve { stage, root: name, sin_cos, equation, body } => {
                    let x = root(*stage, equation, &|scalar| self.value(scalar, &values));
                    set(&mut values, *name, x);
                    if let Some([sin, cos]) = sin_cos {
                        let (s, c) = libm::sincos(x);
                        set(&mut values, *sin, s);
                        set(&mut values, *cos, c);
                    }
                    open.push(steps);
                    steps = body;
                }
                Step::Accept { .. } | Step::General { .. } | Step::Descents { .. } | Step::Near { .. } => {}
            }
        }
    }

    fn value(&self, scalar: &Scalar, values: &[f64]) -> f64 {
        let of = |x: &Scalar| self.value(x, values);
        match scalar {
            Scalar::Value(id) => values.get(id.0).copied().unwrap_or(f64::NAN),
            Scalar::Constant(id) => self.constants.get(id.0).copied().unwrap_or(f64::NAN),
            Scalar::Number(value) => *value,
            Scalar::Neg(x) => -of(x),
            Scalar::Add(x, y) => of(x) + of(y),
            Scalar::Sub(x, y) => of(x) - of(y),
            Scalar::Mul(x, y) => of(x) * of(y),
            Scalar::Div(x, y) => of(x) / of(y),
        }
    }
}

fn set(values: &mut [f64], id: ValueId, to: f64) {
    if let Some(value) = values.get_mut(id.0) {
        *value = to;
    }
}
