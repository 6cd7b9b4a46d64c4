//! From a graph of expressions to named steps in order.
//!
//! What is used twice gets a name, what the field has a name for keeps it, and everything else is written where it is
//! used. Sines and cosines come first, then lengths that vary, then the rest in the order of need.

use super::{Constant, ConstantId, Counts, Scalar, Step, ValueId};
use crate::model::Model;
use crate::model::chain::Element;
use crate::symbolic::angle::AngleForm;
use crate::symbolic::expression::{Arena, Expr, Leaf, Node};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Folded constants with more symbols than this are not written out in their notes.
const LONGEST_NOTE: u32 = 60;

/// Constants of a robot, shared by all its functions.
#[derive(Debug, Default)]
pub(super) struct Constants {
    list: Vec<Constant>,
    ids: HashMap<String, ConstantId>,
    folded: usize,
}

impl Constants {
    /// The lengths of a robot, in the order of its rows.
    pub(super) fn of(model: &Model) -> Self {
        let mut constants = Self::default();
        for element in model.chain().links.iter().flat_map(|link| &link.elements) {
            if let Element::Translate { value, name, note, .. } = element {
                constants.named(name, *value, 1, note);
            }
        }
        constants
    }

    /// What they are.
    pub(super) fn values(&self) -> Vec<f64> {
        self.list.iter().map(|constant| constant.value).collect()
    }

    /// All of them, in the order in which they were met.
    pub(super) fn into_list(self) -> Vec<Constant> {
        self.list
    }

    /// The table's number of this name. Another number under the same name (of another function) gets one of its own.
    fn named(&mut self, name: &str, value: f64, dimension: u8, note: &str) -> ConstantId {
        let same = |constant: &Constant| constant.value.to_bits() == value.to_bits();
        let mut unique = name.to_string();
        let mut tries = 1;
        while let Some(&known) = self.ids.get(&unique) {
            if self.list.get(known.0).is_some_and(same) {
                return known;
            }
            tries += 1;
            unique = format!("{name}_{tries}");
        }
        let id = ConstantId(self.list.len());
        self.list.push(Constant { name: unique.clone(), value, dimension, note: note.to_string() });
        self.ids.insert(unique, id);
        id
    }

    /// A constant folded from others; the same text is the same constant.
    fn folded(&mut self, text: &str, value: f64, dimension: u8) -> ConstantId {
        let key = format!("{text} = {value:?}");
        if let Some(&known) = self.ids.get(&key) {
            return known;
        }
        self.folded += 1;
        let id = ConstantId(self.list.len());
        let name = format!("k{}", self.folded);
        self.list.push(Constant { name, value, dimension, note: format!("= {text}") });
        self.ids.insert(key, id);
        id
    }
}

/// Writes the steps of one function.
pub(super) struct Scheduler<'a> {
    arena: &'a Arena,
    constants: &'a mut Constants,
    /// Names of all values so far.
    pub(super) values: Vec<String>,
    /// What the variables of angles and slides stand for.
    pub(super) variables: Vec<ValueId>,
    names: HashSet<String>,
    defined: HashMap<Expr, ValueId>,
    shared: BTreeSet<Expr>,
    temporaries: usize,
    /// Steps of the innermost scope.
    pub(super) steps: Vec<Step>,
    /// What was counted so far.
    pub(super) counts: Counts,
}

impl<'a> Scheduler<'a> {
    /// For a function that computes these expressions; inputs are defined first.
    pub(super) fn new(
        arena: &'a Arena,
        constants: &'a mut Constants,
        inputs: &[String],
        roots: &[Expr],
    ) -> Self {
        let (mul, add) = arena.operations(roots);
        let mut scheduler = Self {
            arena,
            constants,
            values: Vec::new(),
            variables: Vec::new(),
            names: HashSet::new(),
            defined: HashMap::new(),
            shared: shared(arena, roots),
            temporaries: 0,
            steps: Vec::new(),
            counts: Counts { mul, add, ..Counts::default() },
        };
        for input in inputs {
            scheduler.value(input);
        }
        scheduler
    }

    /// A new value of this name, or of one like it where the name is taken.
    pub(super) fn value(&mut self, name: &str) -> ValueId {
        let mut unique = name.to_string();
        let mut tries = 1;
        while !self.names.insert(unique.clone()) {
            tries += 1;
            unique = format!("{name}_v{tries}");
        }
        self.values.push(unique);
        ValueId(self.values.len() - 1)
    }

    /// Says that an expression (a leaf) is this value.
    pub(super) fn bind(&mut self, expr: Expr, value: ValueId) {
        self.defined.insert(expr, value);
    }

    /// Writes steps for all that the expressions need, and returns them in terms of those.
    pub(super) fn scalars(&mut self, roots: &[Expr]) -> Vec<Scalar> {
        self.leaves(roots);
        roots.iter().map(|root| self.scalar(*root)).collect()
    }

    /// Sines, cosines and slides that the expressions need and that aren't there yet, in the order of the joints.
    fn leaves(&mut self, roots: &[Expr]) {
        self.leaves_of(usize::MAX, roots);
    }

    /// Those of them in which only the first so many variables are.
    pub(super) fn leaves_of(&mut self, variables: usize, roots: &[Expr]) {
        let known = |terms: &[(usize, f64)]| terms.iter().all(|(variable, _)| *variable < variables);
        let mut angles: BTreeSet<(Vec<usize>, usize)> = BTreeSet::new();
        let mut slides = BTreeMap::new();
        let mut seen = HashSet::new();
        let mut open = roots.to_vec();
        while let Some(x) = open.pop() {
            if !seen.insert(x) || self.defined.contains_key(&x) {
                continue;
            }
            match self.arena.node(x) {
                Node::Number(_) => {}
                Node::Leaf(index) => {
                    if let Some((_, Leaf::Slide { terms, .. })) = self.arena.leaf_at(index)
                        && known(terms)
                    {
                        slides.insert(index, x);
                    }
                }
                Node::Sin(index) | Node::Cos(index) => {
                    let Some((_, form)) = self.arena.angle_at(index).filter(|(_, form)| known(&form.terms))
                    else {
                        continue;
                    };
                    angles.insert((form.terms.iter().map(|term| term.0).collect(), index));
                }
                Node::Neg(a) => open.push(a),
                Node::Add(a, b) | Node::Mul(a, b) => open.extend([a, b]),
            }
        }
        for (_, index) in angles {
            self.sin_cos(index);
        }
        for (index, x) in slides {
            self.slide(index, x);
        }
    }

    /// `(s, c) = sincos(angle)`. Whole quarter turns are taken out of the angle and put into the names, where they are
    /// exact and cost nothing.
    fn sin_cos(&mut self, index: usize) {
        let Some((suffix, form)) = self.arena.angle_at(index) else { return };
        let quarters = if form.turn.rest == 0.0 && form.turn.fifteenths % 6 == 0 {
            form.turn.fifteenths.div_euclid(6).rem_euclid(4)
        } else {
            0
        };
        let angle = self.angle(form, quarters);
        self.counts.sincos += 1;
        let name =
            |letter: &str, negative: bool| format!("{}{letter}{suffix}", if negative { "n" } else { "" });
        // What the library's sine and cosine of the reduced angle are of the whole angle.
        let (first, second) = match quarters {
            1 => (("c", true), ("s", false)),
            2 => (("s", true), ("c", true)),
            3 => (("c", false), ("s", true)),
            _ => (("s", false), ("c", false)),
        };
        let ids = [first, second].map(|(letter, negative)| self.value(&name(letter, negative)));
        let [sin_id, cos_id] = ids;
        self.steps.push(Step::SinCos { sin: sin_id, cos: cos_id, angle });
        for ((letter, negative), id) in [first, second].into_iter().zip(ids) {
            // What a later step needs is computed here already.
            let node = if letter == "s" { Node::Sin(index) } else { Node::Cos(index) };
            let Some(expr) = self.arena.find(node) else { continue };
            let id = if negative {
                let whole = self.value(&name(letter, false));
                self.steps.push(Step::Let { name: whole, value: Scalar::Neg(Box::new(Scalar::Value(id))) });
                whole
            } else {
                id
            };
            self.defined.insert(expr, id);
        }
    }

    /// Names the sine and cosine of a variable that a step finds with its angle, where anything speaks of them.
    pub(super) fn sin_cos_of_variable(&mut self, variable: usize) -> Option<[ValueId; 2]> {
        let (suffix, sin, cos) = self.arena.sin_cos_of_variable(variable)?;
        let ids = [format!("s{suffix}"), format!("c{suffix}")].map(|name| self.value(&name));
        let [sin_id, cos_id] = ids;
        self.defined.insert(sin, sin_id);
        self.defined.insert(cos, cos_id);
        Some(ids)
    }

    /// The argument, less the quarter turns taken out of it.
    fn angle(&mut self, form: &AngleForm, quarters: i32) -> Scalar {
        let constant = if quarters == 0 { form.turn.value() } else { 0.0 };
        let scalar = self.linear(&form.terms, constant);
        self.counts.angle_add += (form.terms.len() + usize::from(constant != 0.0)).saturating_sub(1);
        scalar
    }

    /// Sum of coefficient * variable, and a constant.
    pub(super) fn linear(&self, terms: &[(usize, f64)], constant: f64) -> Scalar {
        let mut sum: Option<Scalar> = None;
        for &(variable, coefficient) in terms {
            let Some(&value) = self.variables.get(variable) else { continue };
            let value = Scalar::Value(value);
            let size = coefficient.abs();
            let term = if size == 1.0 {
                value
            } else {
                Scalar::Mul(Box::new(Scalar::Number(size)), Box::new(value))
            };
            sum = Some(signed_sum(sum, term, coefficient < 0.0));
        }
        if constant != 0.0 {
            sum = Some(signed_sum(sum, Scalar::Number(constant.abs()), constant < 0.0));
        }
        sum.unwrap_or(Scalar::Number(0.0))
    }

    fn slide(&mut self, index: usize, x: Expr) {
        let Some((name, Leaf::Slide { terms, constant })) = self.arena.leaf_at(index) else { return };
        let value = self.linear(terms, *constant);
        let id = self.value(name);
        self.steps.push(Step::Let { name: id, value });
        self.defined.insert(x, id);
    }

    fn scalar(&mut self, x: Expr) -> Scalar {
        if let Some(&id) = self.defined.get(&x) {
            return Scalar::Value(id);
        }
        if self.arena.is_constant(x) {
            return self.constant(x);
        }
        let value = self.written(x);
        let name = self.arena.name_of(x).map(str::to_string);
        let needed = self.shared.contains(&x);
        if name.is_none() && !needed {
            return value;
        }
        let name = name.unwrap_or_else(|| {
            self.temporaries += 1;
            format!("t{}", self.temporaries)
        });
        let id = self.value(&name);
        self.steps.push(Step::Let { name: id, value });
        self.defined.insert(x, id);
        Scalar::Value(id)
    }

    /// The expression itself, its parts by name where they have one.
    fn written(&mut self, x: Expr) -> Scalar {
        match self.arena.node(x) {
            Node::Neg(a) => negated(self.scalar(a)),
            Node::Add(a, b) => {
                let first = self.scalar(a);
                match self.arena.node(b) {
                    Node::Neg(inner) if !self.arena.is_constant(b) => {
                        Scalar::Sub(Box::new(first), Box::new(self.scalar(inner)))
                    }
                    _ => added(first, self.scalar(b)),
                }
            }
            Node::Mul(a, b) => Scalar::Mul(Box::new(self.scalar(a)), Box::new(self.scalar(b))),
            Node::Number(number) => Scalar::Number(number.value()),
            // Leaves and angles were defined before; one that was not would be a leaf of another function.
            Node::Leaf(_) | Node::Sin(_) | Node::Cos(_) => Scalar::Number(f64::NAN),
        }
    }

    fn constant(&mut self, x: Expr) -> Scalar {
        match self.arena.node(x) {
            Node::Number(number) => Scalar::Number(number.value()),
            Node::Neg(inner) => negated(self.constant(inner)),
            Node::Leaf(index) => match self.arena.leaf_at(index) {
                Some((name, Leaf::Parameter { value, dimension, note })) => {
                    Scalar::Constant(self.constants.named(name, *value, *dimension, note))
                }
                _ => Scalar::Number(f64::NAN),
            },
            _ => {
                let text = match self.arena.length(x) {
                    0..=LONGEST_NOTE => crate::symbolic::text::expression(self.arena, x),
                    _ => "a long product of the table's rotations".to_string(),
                };
                Scalar::Constant(self.constants.folded(
                    &text,
                    self.arena.constant_value(x),
                    self.arena.constant_dimension(x),
                ))
            }
        }
    }
}

fn signed_sum(sum: Option<Scalar>, term: Scalar, negative: bool) -> Scalar {
    match (sum, negative) {
        (None, false) => term,
        (None, true) => Scalar::Neg(Box::new(term)),
        (Some(sum), false) => Scalar::Add(Box::new(sum), Box::new(term)),
        (Some(sum), true) => Scalar::Sub(Box::new(sum), Box::new(term)),
    }
}

fn negated(x: Scalar) -> Scalar {
    match x {
        Scalar::Neg(inner) => *inner,
        Scalar::Sub(a, b) => Scalar::Sub(b, a),
        other => Scalar::Neg(Box::new(other)),
    }
}

fn added(a: Scalar, b: Scalar) -> Scalar {
    match b {
        Scalar::Neg(inner) => Scalar::Sub(Box::new(a), inner),
        other => Scalar::Add(Box::new(a), Box::new(other)),
    }
}

/// Products and sums that are used more than once.
fn shared(arena: &Arena, roots: &[Expr]) -> BTreeSet<Expr> {
    let mut uses: HashMap<Expr, usize> = HashMap::new();
    let mut open: Vec<Expr> = roots.to_vec();
    while let Some(x) = open.pop() {
        let (_, x) = arena.split_sign(x);
        if arena.is_constant(x) {
            continue;
        }
        let count = uses.entry(x).or_insert(0);
        *count += 1;
        if *count > 1 {
            continue;
        }
        if let Node::Add(a, b) | Node::Mul(a, b) = arena.node(x) {
            open.extend([a, b]);
        }
    }
    uses.into_iter()
        .filter(|(x, count)| *count > 1 && matches!(arena.node(*x), Node::Add(..) | Node::Mul(..)))
        .map(|(x, _)| x)
        .collect()
}
