//! Steps with polynomial coefficients -> steps with expressions, names and text.

use super::atoms::{AngleData, Source};
use super::expansion::{Factor, Term, expanded, factors};
use super::polynomial::{Atom, Polynomial};
use super::roots::{by_roots, linear};
use super::search::{Found, Solved, State, Unknown};
use super::unknowns::{Given, Unknowns};
use super::{Begins, Derivation, Linear, Stage, StageEquation, tool};
use crate::model::{JointKind, Model, Problem};
use crate::symbolic::angle::{AngleForm, Turn};
use crate::symbolic::expression::{Arena, Expr, Leaf};
use crate::symbolic::{chain, text};
use std::collections::BTreeMap;

/// Writes a solved problem.
pub(super) fn write(
    arena: Arena,
    model: &Model,
    problem: &Problem,
    unknowns: &Unknowns,
    end: &State,
) -> Derivation {
    let arena = arena.by_variable();
    let mut writer =
        Writer { arena, unknowns, end, exprs: BTreeMap::new(), defined: std::collections::BTreeSet::new() };
    let inputs =
        problem.target.input_names().iter().map(|name| writer.arena.leaf(name, Leaf::Known)).collect();
    let stages: Vec<Stage> =
        end.found.iter().enumerate().map(|(index, found)| writer.stage(index, found)).collect();
    let free = by_roots(unknowns, end);
    let mut joints: Vec<Linear> = unknowns.joints.iter().map(|form| linear(form, &free)).collect();
    let mut given = vec![String::new(); writer.given()];
    for (free, Given { place, joint, .. }) in unknowns.given() {
        // As it was given, to the bit.
        if let (Some(own), Some(name)) = (joints.get_mut(joint), given.get_mut(place)) {
            *own = Linear { terms: vec![(place, 1.0)], constant: 0.0 };
            *name = format!("q{}", free.row + 1);
        }
    }
    let by_rows = |variable: usize| match variable.checked_sub(given.len()) {
        Some(stage) => stages.get(stage).map(|stage| stage.rows.clone()),
        None => unknowns.given().find(|(_, given)| given.place == variable).map(|(free, _)| vec![free.row]),
    };
    for joint in &mut joints {
        joint.terms.sort_by_key(|(variable, _)| by_rows(*variable));
    }
    let rows: Vec<Linear> = unknowns.rows.iter().map(|form| linear(form, &free)).collect();
    let mut arena = writer.arena;
    let tool = tool::entries(&mut arena, model, unknowns, &rows, &stages);
    Derivation { arena, inputs, given, stages, joints, tool, begins: Begins::Base }
}

struct Writer<'a> {
    arena: Arena,
    unknowns: &'a Unknowns,
    end: &'a State,
    exprs: BTreeMap<Atom, Expr>,
    /// Names of abbreviations that earlier steps defined.
    defined: std::collections::BTreeSet<String>,
}

impl Writer<'_> {
    fn stage(&mut self, index: usize, found: &Found) -> Stage {
        let (name, rows, kind, slide) = match &found.unknown {
            Unknown::Slide(atom) => {
                let data = self.end.atoms.list.get(usize::from(*atom));
                let name = data.map_or_else(String::new, |data| data.name.clone());
                let free = self.end.atoms.slide(*atom).and_then(|index| self.unknowns.free.get(index));
                let slide = self.arena.leaf(&name, Leaf::Known);
                (name, free.map(|free| free.row).into_iter().collect(), JointKind::Prismatic, Some(slide))
            }
            Unknown::Angle { frequency, .. } => {
                let rows = self.signed_rows(frequency);
                let name = format!("theta{}", suffix(&rows));
                (name, rows.iter().map(|(row, _)| *row).collect(), JointKind::Revolute, None)
            }
        };
        let equation = self.equation(&found.equation);
        if kind == JointKind::Revolute {
            // Later steps, and the tool frame, speak of its sine and cosine.
            let root = AngleForm { terms: vec![(self.given() + index, 1.0)], turn: Turn::ZERO };
            self.arena.sin_cos(name.strip_prefix("theta").unwrap_or(&name), &root);
        }
        let plus = self.plus(&equation, &name);
        let (text, mut definitions) = self.text(&equation, &name);
        definitions.retain(|(name, _)| self.defined.insert(name.clone()));
        Stage {
            unknown: name,
            rows,
            kind,
            slide,
            equation,
            dimension: self.dimension(&found.equation),
            text,
            definitions,
            origin: found.origin.to_string(),
            plus,
        }
    }

    fn equation(&mut self, solved: &Solved) -> StageEquation {
        match solved {
            Solved::Trig(list) => StageEquation::Trig(self.trig(list)),
            Solved::Unit(list, others) => {
                let list = self.trig(list);
                StageEquation::TrigUnit(list, others.each_ref().map(|p| self.expr(p)))
            }
            Solved::Pair(first, second) => StageEquation::TrigPair(self.trig(first), self.trig(second)),
            Solved::Either(first, second) => StageEquation::TrigEither(self.trig(first), self.trig(second)),
            Solved::Linear([b, c]) => {
                let (b, c) = (self.expr(b), self.expr(c));
                StageEquation::Linear([b, self.arena.neg(c)])
            }
            Solved::Quadratic(list) => StageEquation::Quadratic(list.each_ref().map(|p| self.expr(p))),
            Solved::Quartic(forms, right, None) => {
                let forms = forms.each_ref().map(|form| self.trig(form));
                let right = self.expr(right);
                StageEquation::Quartic(forms, self.arena.split_sign(right).1, None)
            }
            Solved::Quartic(forms, right, Some(vector)) => {
                let forms = forms.each_ref().map(|form| form.each_ref().map(|p| self.expr(p)));
                let right = self.expr(right);
                let vector = vector.map(|p| self.expr(p));
                StageEquation::Quartic(forms, self.arena.split_sign(right).1, Some(vector))
            }
        }
    }

    /// Coefficients, with the sign that makes the first one positive.
    fn trig(&mut self, list: &[Polynomial; 3]) -> [Expr; 3] {
        let list = list.each_ref().map(|polynomial| self.expr(polynomial));
        let first = list.iter().find(|x| !self.arena.is_zero(**x));
        if first.is_some_and(|x| !self.arena.split_sign(*x).0) {
            return list.map(|x| self.arena.neg(x));
        }
        list
    }

    /// Power of the metre in the coefficients of sines and cosines, or in the constant of a slide's equation.
    fn dimension(&self, solved: &Solved) -> u8 {
        let keys = solved.coefficients().into_iter().flat_map(Polynomial::terms);
        keys.map(|(key, _)| self.end.atoms.dimension(&key.monomial)).max().unwrap_or(0)
    }

    fn text(&self, equation: &StageEquation, unknown: &str) -> (String, Vec<(String, String)>) {
        let arena = &self.arena;
        let angle = unknown.strip_prefix("theta").unwrap_or(unknown);
        let (sin, cos) = (format!("s{angle}"), format!("c{angle}"));
        let trig = |[a, b, c]: &[Expr; 3]| {
            format!(
                "{} = {}",
                text::combination(arena, &[(*a, &cos), (*b, &sin)]),
                text::abbreviated(arena, *c)
            )
        };
        let square = format!("{unknown}^2");
        let written = match equation {
            StageEquation::Trig(list) | StageEquation::TrigUnit(list, _) => trig(list),
            StageEquation::TrigPair(first, second) => format!("{}; {}", trig(first), trig(second)),
            StageEquation::TrigEither(first, second) => format!("{}, or {}", trig(first), trig(second)),
            StageEquation::Linear([a, c]) => {
                format!("{} = {}", text::combination(arena, &[(*a, unknown)]), text::abbreviated(arena, *c))
            }
            StageEquation::Quadratic([a, b, c]) => {
                format!("{} = 0", text::combination(arena, &[(*a, &square), (*b, unknown), (*c, "")]))
            }
            StageEquation::Quartic(forms, right, _) => {
                let [first, second] = forms.each_ref().map(|[k, l, m]| {
                    let form = text::combination(arena, &[(*k, ""), (*l, &cos), (*m, &sin)]);
                    if form.contains(' ') { format!("({form})^2") } else { format!("{form}^2") }
                });
                let right = text::abbreviated(arena, *right);
                let right = if right.contains(' ') { format!("({right})^2") } else { format!("{right}^2") };
                format!("{first} + {second} = {right}")
            }
        };
        (written, text::definitions(arena, &equation.coefficients()))
    }

    /// Which of two roots has the positive square root.
    fn plus(&self, equation: &StageEquation, unknown: &str) -> Option<String> {
        let arena = &self.arena;
        let term = |factor: Expr, symbol: &str| text::combination(arena, &[(factor, symbol)]);
        match equation {
            StageEquation::Trig([a, b, _]) | StageEquation::TrigUnit([a, b, _], _) => {
                let angle = unknown.strip_prefix("theta").unwrap_or(unknown);
                let (sin, cos) = (format!("s{angle}"), format!("c{angle}"));
                Some(match (arena.is_zero(*a), arena.is_zero(*b)) {
                    (_, true) => format!("{} > 0", term(*a, &sin)),
                    (true, _) => format!("{} < 0", term(*b, &cos)),
                    _ => format!("{} > {}", term(*a, &sin), term(*b, &cos)),
                })
            }
            StageEquation::Quadratic([a, b, _]) => {
                let twice = format!("2 {unknown}");
                Some(format!("{} > 0", text::combination(arena, &[(*a, &twice), (*b, "")])))
            }
            StageEquation::Quartic(..) => Some("the left side rises".to_owned()),
            StageEquation::TrigPair(..) | StageEquation::TrigEither(..) | StageEquation::Linear(_) => None,
        }
    }

    /// Which rows, with which sign, an angle is the sum of.
    fn signed_rows(&self, frequency: &[i16]) -> Vec<(usize, i16)> {
        let angles = self.end.atoms.angles.iter().zip(frequency).filter(|(_, k)| **k != 0);
        let row = |(angle, k): (&AngleData, &i16)| match angle {
            AngleData::Free(index) => self.unknowns.free.get(*index).map(|free| (free.row, *k)),
            AngleData::Constant { .. } => None,
        };
        angles.filter_map(row).collect()
    }

    /// What stands in a place of the frequencies, in terms of the free angles.
    fn original(&self, frequency: &[i16]) -> Vec<i16> {
        let mut sum = vec![0; frequency.len()];
        for (at, k) in frequency.iter().enumerate().filter(|(_, k)| **k != 0) {
            let root = self.end.found.iter().find_map(|found| match &found.unknown {
                Unknown::Angle { frequency, at: place } if *place == at => Some(frequency),
                _ => None,
            });
            for (index, entry) in sum.iter_mut().enumerate() {
                let own = root.map_or(i16::from(index == at), |root| root.get(index).copied().unwrap_or(0));
                *entry += k * own;
            }
        }
        sum
    }

    /// How many joints are given: their variables come before the roots.
    fn given(&self) -> usize {
        self.unknowns.given().count()
    }

    fn atom(&mut self, atom: Atom) -> Expr {
        if let Some(&known) = self.exprs.get(&atom) {
            return known;
        }
        let Some(data) = self.end.atoms.list.get(usize::from(atom)).cloned() else {
            return self.arena.zero();
        };
        let expr = match &data.source {
            Source::Table(expr) | Source::Target(expr) => *expr,
            Source::Slide(index) => {
                let given = self.unknowns.free.get(*index).and_then(|free| free.given);
                let leaf = given.map_or(Leaf::Known, |given| Leaf::Slide {
                    terms: vec![(given.place, given.factor)],
                    constant: given.at_zero.value(),
                });
                self.arena.leaf(&data.name, leaf)
            }
            Source::Abbreviation(definition) => {
                let expr = self.expr(definition);
                self.arena.label(expr, &data.name);
                expr
            }
        };
        self.exprs.insert(atom, expr);
        expr
    }

    /// With merged angles, or with products of the sines and cosines of the roots, whichever is less work. Angles of
    /// the table have no merged form.
    fn expr(&mut self, polynomial: &Polynomial) -> Expr {
        let terms: Vec<Term> = polynomial.terms().map(|(key, number)| (number, factors(key))).collect();
        let several = |factor: &Factor| match factor {
            Factor::Trig(frequency, _) => frequency.iter().filter(|k| **k != 0).count() > 1,
            Factor::Atom(_) => false,
        };
        if !terms.iter().flat_map(|(_, factors)| factors).any(several) {
            return self.sum(terms);
        }
        let products = match expanded(polynomial) {
            Some(terms) => self.sum(terms),
            None => return self.sum(terms),
        };
        if self.has_constant_angle(polynomial) {
            return products;
        }
        let merged = self.sum(terms);
        let cost = |x: Expr| self.arena.operation_count(&[x]);
        if cost(products) < cost(merged) { products } else { merged }
    }

    fn has_constant_angle(&self, polynomial: &Polynomial) -> bool {
        let constant = |at: usize| matches!(self.end.atoms.angles.get(at), Some(AngleData::Constant { .. }));
        polynomial
            .terms()
            .any(|(key, _)| key.frequency.iter().enumerate().any(|(at, k)| *k != 0 && constant(at)))
    }

    /// A sum, the factor that most terms share taken out first.
    fn sum(&mut self, mut terms: Vec<Term>) -> Expr {
        terms.sort_by_key(|(number, _)| number.is_negative());
        let mut counts: BTreeMap<&Factor, usize> = BTreeMap::new();
        for (_, factors) in &terms {
            let mut distinct: Vec<&Factor> = factors.iter().collect();
            distinct.dedup();
            for factor in distinct {
                *counts.entry(factor).or_insert(0) += 1;
            }
        }
        let shared = counts.into_iter().filter(|(_, count)| *count > 1).max_by_key(|(_, count)| *count);
        if let Some(factor) = shared.map(|(factor, _)| factor.clone()) {
            let (with, without): (Vec<_>, Vec<_>) =
                terms.into_iter().partition(|(_, factors)| factors.contains(&factor));
            let rest = with.into_iter().map(|(number, mut factors)| {
                if let Some(at) = factors.iter().position(|own| *own == factor) {
                    factors.remove(at);
                }
                (number, factors)
            });
            let inner = self.sum(rest.collect());
            let outer = self.factor(&factor);
            let product = self.arena.mul(outer, inner);
            let rest = self.sum(without);
            return self.arena.add(product, rest);
        }
        let mut sum = self.arena.zero();
        for (number, factors) in terms {
            let mut product = self.arena.number(number);
            for factor in &factors {
                let factor = self.factor(factor);
                product = self.arena.mul(product, factor);
            }
            sum = self.arena.add(sum, product);
        }
        sum
    }

    fn factor(&mut self, factor: &Factor) -> Expr {
        match factor {
            Factor::Atom(atom) => self.atom(*atom),
            Factor::Trig(frequency, sine) => {
                let (sin, cos) = self.sin_cos(frequency);
                if *sine { sin } else { cos }
            }
        }
    }

    fn sin_cos(&mut self, frequency: &[i16]) -> (Expr, Expr) {
        let mut form = AngleForm::ZERO;
        let mut constants = String::new();
        for (at, k) in frequency.iter().enumerate().filter(|(_, k)| **k != 0) {
            let stage =
                self.end.found.iter().position(
                    |found| matches!(&found.unknown, Unknown::Angle { at: place, .. } if *place == at),
                );
            match (stage, self.end.atoms.angles.get(at)) {
                (Some(stage), _) => {
                    let terms = vec![(self.given() + stage, f64::from(*k))];
                    form = form.plus(&AngleForm { terms, turn: Turn::ZERO }, 1.0);
                }
                (None, Some(AngleData::Free(index))) => {
                    let Some(given) = self.unknowns.free.get(*index).and_then(|free| free.given) else {
                        continue;
                    };
                    let (fifteenths, rest) = given.at_zero.split();
                    let turn = Turn {
                        fifteenths: (fifteenths * i32::from(*k)).rem_euclid(24),
                        rest: rest * f64::from(*k),
                    };
                    form = form.plus(
                        &AngleForm { terms: vec![(given.place, f64::from(*k) * given.factor)], turn },
                        1.0,
                    );
                }
                (None, Some(AngleData::Constant { name, value })) => {
                    form.turn.rest += f64::from(*k) * value;
                    constants = format!("{constants}_{name}");
                }
                _ => {}
            }
        }
        let rows = self.signed_rows(&self.original(frequency));
        let name = format!("{}{constants}", suffix(&rows));
        self.arena.sin_cos(name.trim_start_matches('_'), &form)
    }
}

/// `23`, `2m3`; a multiple is written before its row: `2x3`.
fn suffix(rows: &[(usize, i16)]) -> String {
    if rows.iter().all(|(_, k)| k.abs() == 1) {
        let signed: Vec<(usize, bool)> = rows.iter().map(|(row, k)| (*row, *k > 0)).collect();
        return chain::suffix(&signed);
    }
    let parts: Vec<String> = rows
        .iter()
        .map(|(row, k)| format!("{}{}x{}", if *k < 0 { "m" } else { "" }, k.abs(), row + 1))
        .collect();
    parts.join("_")
}
