//! Hash-consed expressions with constructors that simplify.
//!
//! Equal expressions have equal ids, so that sharing costs nothing and counting operations is counting nodes.
//! Constructors fold zeros, ones, exact constants and double signs; they never expand a product, since the builders
//! of `forward_kinematics` and `jacobian` already write the factored form. A sign is kept outside products and
//! outside sums whose first operand is negative, so that x - y and y - x share a node.

use super::angle::AngleForm;
use super::number::Number;
use std::collections::HashMap;

/// An expression of an [`Arena`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Expr(u32);

/// A leaf that has a name and no structure.
#[derive(Debug, Clone, PartialEq)]
pub enum Leaf {
    /// A number of the table (SI) that isn't folded: a length, or the sine of a measured twist.
    Parameter {
        /// SI.
        value: f64,
        /// Power of the metre.
        dimension: u8,
        /// What it is and where it stands.
        note: String,
    },
    /// A prismatic row's d: constant + sum of coefficient * q.
    Slide {
        /// (index of q, coefficient).
        terms: Vec<(usize, f64)>,
        /// d where all q are 0 (m).
        constant: f64,
    },
    /// A number that is known when the function runs: of the target, or found by an earlier step.
    Known,
}

/// Structure of an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Node {
    Number(Number),
    Leaf(usize),
    Sin(usize),
    Cos(usize),
    Neg(Expr),
    Add(Expr, Expr),
    Mul(Expr, Expr),
}

/// All expressions of a robot.
#[derive(Debug, Clone)]
pub struct Arena {
    nodes: Vec<Node>,
    facts: Vec<Facts>,
    pub(super) ids: HashMap<Node, Expr>,
    leaves: Vec<(String, Leaf)>,
    leaf_ids: HashMap<String, Expr>,
    pub(super) angles: Vec<(String, AngleForm)>,
    names: HashMap<Expr, String>,
    /// See `Arena::by_variable`.
    pub(super) by_variable: bool,
}

/// What is known of an expression when it is made. An expression is a graph and may be large written out, so nothing
/// of this is found by walking it.
#[derive(Debug, Clone, Copy)]
struct Facts {
    /// Whether only numbers of the table are in it; then, its value (SI) and power of the metre.
    constant: bool,
    value: f64,
    dimension: u8,
    /// How many symbols it has, written out.
    length: u32,
}

/// 0 and 1, in every arena.
const ZERO: Expr = Expr(0);
const ONE: Expr = Expr(1);

impl Default for Arena {
    fn default() -> Self {
        let mut arena = Self {
            nodes: Vec::new(),
            facts: Vec::new(),
            ids: HashMap::new(),
            leaves: Vec::new(),
            leaf_ids: HashMap::new(),
            angles: Vec::new(),
            names: HashMap::new(),
            by_variable: false,
        };
        arena.intern(Node::Number(Number::ZERO));
        arena.intern(Node::Number(Number::ONE));
        arena
    }
}

impl Arena {
    /// An exact constant.
    pub fn number(&mut self, number: Number) -> Expr {
        if number.is_negative() {
            let positive = self.intern(Node::Number(-number));
            return self.intern(Node::Neg(positive));
        }
        self.intern(Node::Number(number))
    }

    /// 0
    pub fn zero(&self) -> Expr {
        ZERO
    }

    /// 1
    pub fn one(&self) -> Expr {
        ONE
    }

    /// A named leaf; the same name gives the same leaf.
    pub fn leaf(&mut self, name: &str, leaf: Leaf) -> Expr {
        if let Some(&known) = self.leaf_ids.get(name) {
            return known;
        }
        self.leaves.push((name.to_string(), leaf));
        let expr = self.intern(Node::Leaf(self.leaves.len() - 1));
        self.leaf_ids.insert(name.to_string(), expr);
        expr
    }

    /// A number of the table; zero is folded. Another value under the same name gets a name of its own.
    pub fn parameter(&mut self, name: &str, value: f64, dimension: u8, note: &str) -> Expr {
        if value == 0.0 {
            return self.zero();
        }
        let same = |leaf: &Leaf| matches!(leaf, Leaf::Parameter { value: known, .. } if known.to_bits() == value.to_bits());
        let mut unique = name.to_string();
        let mut tries = 1;
        while let Some((_, leaf)) = self.leaves.iter().find(|(known, _)| *known == unique) {
            if same(leaf) {
                break;
            }
            tries += 1;
            unique = format!("{name}_{tries}");
        }
        self.leaf(&unique, Leaf::Parameter { value, dimension, note: note.to_string() })
    }

    /// Sine and cosine of an angle. `suffix` names it (s234, c234) when it is met for the first time.
    pub fn sin_cos(&mut self, suffix: &str, form: &AngleForm) -> (Expr, Expr) {
        if form.terms.is_empty() {
            return self.constant_sin_cos(suffix, form);
        }
        if self.by_variable
            && let Some(sum) = self.sin_cos_by_variable(suffix, form)
        {
            return sum;
        }
        let negated = form.negated();
        let found = self.angles.iter().position(|(_, known)| known == form || *known == negated);
        let at = found.unwrap_or_else(|| {
            self.angles.push((suffix.to_string(), form.clone()));
            self.angles.len() - 1
        });
        let flipped = self.angles.get(at).is_some_and(|(_, known)| known != form);
        let (sin, cos) = (self.intern(Node::Sin(at)), self.intern(Node::Cos(at)));
        if flipped { (self.neg(sin), cos) } else { (sin, cos) }
    }

    /// -x
    pub fn neg(&mut self, x: Expr) -> Expr {
        match self.node(x) {
            Node::Neg(inner) => inner,
            _ if x == ZERO => x,
            _ => self.intern(Node::Neg(x)),
        }
    }

    /// x + y
    pub fn add(&mut self, x: Expr, y: Expr) -> Expr {
        if x == ZERO {
            return y;
        }
        if y == ZERO {
            return x;
        }
        if let (Some(a), Some(b)) = (self.as_number(x), self.as_number(y))
            && let Some(sum) = a.checked_add(b)
        {
            return self.number(sum);
        }
        let ((x_sign, x), (y_sign, y)) = (self.split_sign(x), self.split_sign(y));
        if x == y {
            if x_sign != y_sign {
                return self.zero();
            }
            let two = self.number(Number::TWO);
            let double = self.mul(two, x);
            return self.signed(x_sign, double);
        }
        let ((first_sign, first), (second_sign, second)) = if self.order(x) < self.order(y) {
            ((x_sign, x), (y_sign, y))
        } else {
            ((y_sign, y), (x_sign, x))
        };
        let second = if first_sign == second_sign { second } else { self.neg(second) };
        let sum = self.intern(Node::Add(first, second));
        self.signed(first_sign, sum)
    }

    /// x - y
    pub fn sub(&mut self, x: Expr, y: Expr) -> Expr {
        let negated = self.neg(y);
        self.add(x, negated)
    }

    /// x y
    pub fn mul(&mut self, x: Expr, y: Expr) -> Expr {
        if x == ZERO || y == ZERO {
            return ZERO;
        }
        if x == ONE {
            return y;
        }
        if y == ONE {
            return x;
        }
        if let (Some(a), Some(b)) = (self.as_number(x), self.as_number(y))
            && let Some(product) = a.checked_mul(b)
        {
            return self.number(product);
        }
        let ((x_sign, x), (y_sign, y)) = (self.split_sign(x), self.split_sign(y));
        let positive = x_sign == y_sign;
        let (first, second) = if self.rank(x) <= self.rank(y) { (x, y) } else { (y, x) };
        if first == ONE {
            return self.signed(positive, second);
        }
        // Constants are gathered in front, so that a2 (sa3 x) costs one product.
        if self.is_constant(first)
            && let Node::Mul(inner, rest) = self.node(second)
            && self.is_constant(inner)
            && !self.is_constant(rest)
        {
            let constant = self.mul(first, inner);
            let product = self.mul(constant, rest);
            return self.signed(positive, product);
        }
        let product = self.intern(Node::Mul(first, second));
        self.signed(positive, product)
    }

    /// Gives a quantity the name that the field has for it, unless it has one or is a leaf (or a signed one). What is
    /// computed is the quantity without its sign: of a negative one the name says so, `nr12` = -r12.
    pub fn name(&mut self, x: Expr, name: &str) {
        match self.split_sign(x) {
            (true, x) => self.label(x, name),
            (false, x) => self.label(x, &format!("n{name}")),
        }
    }

    /// Gives an abbreviation a name, if it is one: more than a leaf.
    pub fn label(&mut self, x: Expr, name: &str) {
        let (_, x) = self.split_sign(x);
        if matches!(self.node(x), Node::Add(..) | Node::Mul(..)) && !self.is_constant(x) {
            self.names.entry(x).or_insert_with(|| name.to_string());
        }
    }

    /// The name given to an expression.
    pub fn name_of(&self, x: Expr) -> Option<&str> {
        self.names.get(&x).map(String::as_str)
    }

    /// Its structure.
    pub fn node(&self, x: Expr) -> Node {
        self.nodes.get(x.0 as usize).copied().unwrap_or(Node::Number(Number::ZERO))
    }

    /// Whether only numbers of the table are in it.
    pub fn is_constant(&self, x: Expr) -> bool {
        self.facts_of(x).constant
    }

    /// Name and kind of a leaf.
    pub fn leaf_at(&self, index: usize) -> Option<(&str, &Leaf)> {
        self.leaves.get(index).map(|(name, leaf)| (name.as_str(), leaf))
    }

    /// Suffix and form of an angle.
    pub fn angle_at(&self, index: usize) -> Option<(&str, &AngleForm)> {
        self.angles.get(index).map(|(suffix, form)| (suffix.as_str(), form))
    }

    /// Whether it is 0.
    pub fn is_zero(&self, x: Expr) -> bool {
        x == ZERO
    }

    /// Value of a constant expression (SI); NaN of others.
    pub fn constant_value(&self, x: Expr) -> f64 {
        self.facts_of(x).value
    }

    /// Power of the metre in a constant expression.
    pub fn constant_dimension(&self, x: Expr) -> u8 {
        self.facts_of(x).dimension
    }

    /// How many symbols an expression has, written out.
    pub fn length(&self, x: Expr) -> u32 {
        self.facts_of(x).length
    }

    fn facts_of(&self, x: Expr) -> Facts {
        let none = Facts { constant: true, value: 0.0, dimension: 0, length: 0 };
        self.facts.get(x.0 as usize).copied().unwrap_or(none)
    }

    fn facts(&self, node: Node) -> Facts {
        let varying = Facts { constant: false, value: f64::NAN, dimension: 0, length: 1 };
        let both = |a: Expr, b: Expr| {
            let (a, b) = (self.facts_of(a), self.facts_of(b));
            let length = a.length.saturating_add(b.length);
            (a, b, Facts { constant: a.constant && b.constant, length, ..varying })
        };
        match node {
            Node::Number(number) => Facts { constant: true, value: number.value(), dimension: 0, length: 1 },
            Node::Leaf(index) => match self.leaf_at(index) {
                Some((_, Leaf::Parameter { value, dimension, .. })) => {
                    Facts { constant: true, value: *value, dimension: *dimension, length: 1 }
                }
                _ => varying,
            },
            Node::Sin(_) | Node::Cos(_) => varying,
            Node::Neg(a) => {
                let a = self.facts_of(a);
                Facts { value: -a.value, ..a }
            }
            Node::Add(a, b) => {
                let (a, b, sum) = both(a, b);
                Facts { value: a.value + b.value, dimension: a.dimension.max(b.dimension), ..sum }
            }
            Node::Mul(a, b) => {
                let (a, b, product) = both(a, b);
                let dimension = a.dimension.saturating_add(b.dimension);
                Facts { value: a.value * b.value, dimension, ..product }
            }
        }
    }

    /// (whether positive, the expression without its sign)
    pub fn split_sign(&self, x: Expr) -> (bool, Expr) {
        match self.node(x) {
            Node::Neg(inner) => (false, inner),
            _ => (true, x),
        }
    }

    /// The distinct products and sums that the expressions are made of, constants excepted: (multiplications,
    /// additions).
    pub fn operations(&self, roots: &[Expr]) -> (usize, usize) {
        let (mut products, mut sums) = (0, 0);
        let mut seen = vec![false; self.nodes.len()];
        let mut open = roots.to_vec();
        while let Some(x) = open.pop() {
            match seen.get_mut(x.0 as usize) {
                Some(mark) if !*mark => *mark = true,
                _ => continue,
            }
            if self.is_constant(x) {
                continue;
            }
            match self.node(x) {
                Node::Neg(inner) => open.push(inner),
                Node::Add(a, b) => {
                    sums += 1;
                    open.extend([a, b]);
                }
                Node::Mul(a, b) => {
                    products += 1;
                    open.extend([a, b]);
                }
                Node::Number(_) | Node::Leaf(_) | Node::Sin(_) | Node::Cos(_) => {}
            }
        }
        (products, sums)
    }

    /// The sum of [`Arena::operations`].
    pub fn operation_count(&self, roots: &[Expr]) -> usize {
        let (products, sums) = self.operations(roots);
        products + sums
    }

    fn as_number(&self, x: Expr) -> Option<Number> {
        match self.node(x) {
            Node::Number(number) => Some(number),
            Node::Neg(inner) => match self.node(inner) {
                Node::Number(number) => Some(-number),
                _ => None,
            },
            _ => None,
        }
    }

    fn signed(&mut self, positive: bool, x: Expr) -> Expr {
        if positive { x } else { self.neg(x) }
    }

    /// Order of summands: as they came up, constants last.
    fn order(&self, x: Expr) -> (bool, Expr) {
        (self.is_constant(x), x)
    }

    /// Order of factors: numbers, then other constants, then the rest as they came up.
    fn rank(&self, x: Expr) -> (u8, Expr) {
        let class = match self.node(x) {
            Node::Number(_) => 0,
            _ if self.is_constant(x) => 1,
            _ => 2,
        };
        (class, x)
    }

    fn intern(&mut self, node: Node) -> Expr {
        if let Some(&known) = self.ids.get(&node) {
            return known;
        }
        let facts = self.facts(node);
        let expr = Expr(self.nodes.len() as u32);
        self.nodes.push(node);
        self.facts.push(facts);
        self.ids.insert(node, expr);
        expr
    }
}
