//! Sines and cosines of sums, where those of every variable are known.

use super::angle::{AngleForm, Turn};
use super::expression::{Arena, Expr, Node};

impl Arena {
    /// The expression of this structure, if it was made.
    pub fn find(&self, node: Node) -> Option<Expr> {
        self.ids.get(&node).copied()
    }

    /// From here on the sine and cosine of every single variable are known, and those of sums and multiples are written
    /// with them by the addition theorems.
    pub fn by_variable(mut self) -> Self {
        self.by_variable = true;
        self
    }

    /// The name, sine and cosine of a single variable, if anything speaks of them.
    pub fn sin_cos_of_variable(&self, variable: usize) -> Option<(&str, Expr, Expr)> {
        let single = AngleForm { terms: vec![(variable, 1.0)], turn: Turn::ZERO };
        let at = self.angles.iter().position(|(_, form)| *form == single)?;
        let (suffix, _) = self.angles.get(at)?;
        Some((suffix, *self.ids.get(&Node::Sin(at))?, *self.ids.get(&Node::Cos(at))?))
    }

    /// `None` for a single variable, and for factors that aren't whole numbers.
    pub(super) fn sin_cos_by_variable(&mut self, suffix: &str, form: &AngleForm) -> Option<(Expr, Expr)> {
        if form.terms.iter().any(|(_, factor)| factor.fract() != 0.0) {
            return None;
        }
        if let ([(_, 1.0)], Turn::ZERO) = (form.terms.as_slice(), form.turn) {
            return None;
        }
        let constant = AngleForm { terms: Vec::new(), turn: form.turn };
        let mut sum: Option<(Expr, Expr)> = None;
        for &(variable, factor) in &form.terms {
            let single = AngleForm { terms: vec![(variable, 1.0)], turn: Turn::ZERO };
            let (sin, cos) = self.sin_cos(suffix, &single);
            let own = if factor < 0.0 { (self.neg(sin), cos) } else { (sin, cos) };
            for _ in 0..factor.abs() as u32 {
                sum = Some(match sum {
                    Some(sum) => self.added(sum, own),
                    None => own,
                });
            }
        }
        let mut sum = sum?;
        if form.turn != Turn::ZERO {
            let turn = self.sin_cos(&format!("o{suffix}"), &constant);
            sum = self.added(sum, turn);
        }
        if form.terms.len() > 1 {
            self.name(sum.0, &format!("s{suffix}"));
            self.name(sum.1, &format!("c{suffix}"));
        }
        Some(sum)
    }

    /// Of a constant turn: exact numbers, or numbers of the table.
    pub(super) fn constant_sin_cos(&mut self, suffix: &str, form: &AngleForm) -> (Expr, Expr) {
        if let Some((sin, cos)) = form.turn.exact() {
            return (self.number(sin), self.number(cos));
        }
        let angle = form.turn.value();
        let suffix = if suffix.is_empty() { "0" } else { suffix };
        let sin = self.parameter(&format!("s{suffix}"), libm::sin(angle), 0, &format!("sine of {angle} rad"));
        let cos =
            self.parameter(&format!("c{suffix}"), libm::cos(angle), 0, &format!("cosine of {angle} rad"));
        (sin, cos)
    }

    fn added(&mut self, (s1, c1): (Expr, Expr), (s2, c2): (Expr, Expr)) -> (Expr, Expr) {
        let (first, second) = (self.mul(s1, c2), self.mul(c1, s2));
        let sin = self.add(first, second);
        let (first, second) = (self.mul(c1, c2), self.mul(s1, s2));
        (sin, self.sub(first, second))
    }
}
