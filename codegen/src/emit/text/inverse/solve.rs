//! An equation in one unknown, its roots, and where it has none.

use super::super::algebra::Sum;
use super::super::number;
use super::Unknown;
use crate::model::Units;
use crate::plan::{Equation, Scalar};
use std::f64::consts::PI;

/// What is written of a step.
pub(super) struct Solution {
    /// As they follow from the rows.
    pub(super) equations: Vec<String>,
    /// The unknown, and what abbreviates it.
    pub(super) roots: Vec<String>,
    /// Number of roots; where there are none, or too many.
    pub(super) remarks: Vec<String>,
    /// Of two roots, which is the `+` root.
    pub(super) plus: Option<String>,
}

impl Solution {
    /// `sum` gives the known coefficients.
    pub(super) fn of(
        unknown: &Unknown<'_>,
        equation: &Equation,
        units: Units,
        sum: &mut dyn FnMut(&Scalar) -> Sum,
    ) -> Solution {
        match equation {
            Equation::Trig { a, b, c } => trig(unknown, [sum(a), sum(b), sum(c)], units),
            Equation::TrigUnit { row: [a, b, c], others } => {
                let mut solution = trig(unknown, [sum(a), sum(b), sum(c)], units);
                let [cos, sin] = unknown.cos_sin();
                let across = sum(a).mul(sin).sub(sum(b).mul(cos));
                let [d, e] = others.each_ref().map(&mut *sum);
                solution.equations.push(format!("{} = {}", across.squared(), d.squared().add(e.squared())));
                solution
            }
            Equation::TrigPair { first, second } => {
                let mut sums = |[a, b, c]: &[Scalar; 3]| [sum(a), sum(b), sum(c)];
                trig_pair(unknown, &sums(first), &sums(second))
            }
            Equation::TrigEither { first, second } => {
                let mut sums = |[a, b, c]: &[Scalar; 3]| [sum(a), sum(b), sum(c)];
                either(unknown, sums(first), sums(second), units)
            }
            Equation::Linear { a, c } => linear(unknown, &sum(a), &sum(c)),
            Equation::Quadratic { a, b, c } => quadratic(unknown, &sum(a), &sum(b), &sum(c)),
            Equation::Quartic { forms, right, vector } => {
                let forms = forms.each_ref().map(|form| form.each_ref().map(&mut *sum));
                let others = vector
                    .as_ref()
                    .map(|vector| vector.others.each_ref().map(|form| form.each_ref().map(&mut *sum)));
                quartic(unknown, forms, &sum(right), others)
            }
        }
    }
}

/// `a c1 + b s1 = c`
fn left(unknown: &Unknown<'_>, a: &Sum, b: &Sum) -> Sum {
    let [cos, sin] = unknown.cos_sin();
    a.clone().mul(cos).add(b.clone().mul(sin))
}

fn trig(unknown: &Unknown<'_>, [a, b, c]: [Sum; 3], units: Units) -> Solution {
    let name = unknown.name;
    let half_turn = number::angle(PI, units);
    let roots = if c.is_zero() {
        let (sine, cosine) = (a.clone().neg(), b.clone());
        // Either root will do for the first.
        let (sine, cosine) = if b == b.unsigned() { (sine, cosine) } else { (a.clone(), cosine.neg()) };
        format!("{name} = atan2({sine}, {cosine}), or that + {half_turn}")
    } else if b.is_zero() {
        format!("{name} = +- acos({})", c.over(&a))
    } else if a.is_zero() {
        let sine = c.over(&b);
        format!("{name} = asin({sine}), or {half_turn} - asin({sine})")
    } else {
        let square = a.squared().add(b.squared());
        let above = c.to_string();
        let above = if above.contains(' ') { format!("({above})") } else { above };
        format!("{name} = atan2({b}, {a}) +- acos({above} / sqrt({square}))")
    };
    let mut remarks = vec!["two roots".to_owned()];
    if !c.is_zero() {
        remarks.push(format!("out of reach where {}", out_of_reach(&a, &b, &c)));
    }
    remarks.extend(vanishing(&[&a, &b]));
    let equations = vec![format!("{} = {c}", left(unknown, &a, &b))];
    let [cos, sin] = unknown.cos_sin();
    let plus = Some(format!("{} > 0", a.mul(sin).sub(b.mul(cos))));
    Solution { equations, roots: vec![roots], remarks, plus }
}

/// Two equations with the same roots, of which either may say nothing.
fn either(unknown: &Unknown<'_>, first: [Sum; 3], second: [Sum; 3], units: Units) -> Solution {
    let ([a1, b1, c1], [a2, b2, _]) = (&first, &second);
    let mut remarks = vec!["two roots".to_owned()];
    if !c1.is_zero() {
        remarks.push(format!("out of reach where {}", out_of_reach(a1, b1, c1)));
    }
    remarks.extend(vanishing(&[a1, b1, a2, b2]));
    let [first, second] = [first, second].map(|row| trig(unknown, row, units));
    let choice = "each follows from the other; by the one with the larger coefficients:".to_owned();
    Solution {
        equations: [first.equations, second.equations].concat(),
        roots: [vec![choice], first.roots, second.roots].concat(),
        remarks,
        plus: None,
    }
}

/// Where a cos x + b sin x = c has no root.
fn out_of_reach(a: &Sum, b: &Sum, c: &Sum) -> String {
    match (a.is_zero(), b.is_zero()) {
        (false, true) => format!("|{}| > |{}|", c.unsigned(), a.unsigned()),
        (true, false) => format!("|{}| > |{}|", c.unsigned(), b.unsigned()),
        _ => format!("{} > {}", c.squared(), a.squared().add(b.squared())),
    }
}

/// Where all coefficients of an unknown vanish, if they can.
fn vanishing(coefficients: &[&Sum]) -> Option<String> {
    if coefficients.iter().any(|sum| sum.is_constant() && !sum.is_zero()) {
        return None;
    }
    let zeros: Vec<String> = coefficients
        .iter()
        .filter(|sum| !sum.is_zero())
        .map(|sum| format!("{} = 0", sum.unsigned()))
        .collect();
    Some(format!("singular where {}", zeros.join(" and ")))
}

fn trig_pair(unknown: &Unknown<'_>, first: &[Sum; 3], second: &[Sum; 3]) -> Solution {
    let name = unknown.name;
    let ([a1, b1, c1], [a2, b2, c2]) = (first, second);
    let equations =
        vec![format!("{} = {c1}", left(unknown, a1, b1)), format!("{} = {c2}", left(unknown, a2, b2))];
    let product = |x: &Sum, y: &Sum| x.clone().mul(y.clone());
    let determinant = product(a1, b2).sub(product(a2, b1));
    let sine = product(a1, c2).sub(product(a2, c1));
    let cosine = product(c1, b2).sub(product(c2, b1));
    let mut remarks = vec!["one root".to_owned()];
    let (roots, singular) = if b1.is_zero() && a2.is_zero() {
        (vec![format!("{name} = atan2({}, {})", c2.over(b2), c1.over(a1))], vanishing(&[&determinant]))
    } else if a1.is_zero() && b2.is_zero() {
        (vec![format!("{name} = atan2({}, {})", c1.over(b1), c2.over(a2))], vanishing(&[&determinant]))
    } else if a1 == b2 && *a2 == b1.clone().neg() {
        // The determinant is a sum of squares, and atan2 does without positive factors.
        (vec![format!("{name} = atan2({sine}, {cosine})")], vanishing(&[a1, b1]))
    } else if *a1 == b2.clone().neg() && a2 == b1 {
        (vec![format!("{name} = atan2({}, {})", sine.neg(), cosine.neg())], vanishing(&[a1, b1]))
    } else {
        let abbreviation = format!("D = {determinant}");
        let root = format!("{name} = atan2(({sine}) / D, ({cosine}) / D)");
        (vec![abbreviation, root], vanishing(&[&determinant]))
    };
    remarks.extend(singular);
    Solution { equations, roots, remarks, plus: None }
}

fn linear(unknown: &Unknown<'_>, a: &Sum, c: &Sum) -> Solution {
    let equation = format!("{} = {c}", a.clone().mul(unknown.value()));
    let root = format!("{} = {}", unknown.name, c.over(a));
    let roots = if root == equation { Vec::new() } else { vec![root] };
    let mut remarks = vec!["one root".to_owned()];
    remarks.extend(vanishing(&[a]));
    Solution { equations: vec![equation], roots, remarks, plus: None }
}

fn quadratic(unknown: &Unknown<'_>, a: &Sum, b: &Sum, c: &Sum) -> Solution {
    let x = unknown.value();
    let left = a.clone().mul(x.squared()).add(b.clone().mul(x)).add(c.clone());
    let under = b.squared().sub(Sum::number(4.0).mul(a.clone()).mul(c.clone()));
    let double = Sum::number(2.0).mul(a.clone());
    let middle = b.clone().neg();
    let above =
        if middle.is_zero() { format!("+- sqrt({under})") } else { format!("({middle} +- sqrt({under}))") };
    let below = double.to_string();
    let below = if below.contains(' ') { format!("({below})") } else { below };
    let mut remarks = vec!["two roots".to_owned(), format!("out of reach where {under} < 0")];
    remarks.extend(vanishing(&[a, b]));
    Solution {
        equations: vec![format!("{left} = 0")],
        roots: vec![format!("{} = {above} / {below}", unknown.name)],
        remarks,
        plus: Some(format!("{} > 0", double.mul(unknown.value()).add(b.clone()))),
    }
}

fn quartic(
    unknown: &Unknown<'_>,
    forms: [[Sum; 3]; 2],
    right: &Sum,
    others: Option<[[Sum; 3]; 2]>,
) -> Solution {
    let name = unknown.name;
    let form = |[k, l, m]: [Sum; 3]| left(unknown, &l, &m).add(k);
    let [first, second] = forms.map(|sums| form(sums).squared());
    let mut remarks = vec!["up to four roots".to_owned(), format!("a quartic in tan({name} / 2)")];
    if let Some(others) = others {
        let [one, other] = others.map(form);
        remarks.push(format!(
            "next to double roots by the other coordinates of the first square's vector, {one} and {other}"
        ));
    }
    Solution {
        equations: vec![format!("{} = {}", first.add(second), right.squared())],
        roots: Vec::new(),
        remarks,
        plus: Some("the left side rises".to_owned()),
    }
}
