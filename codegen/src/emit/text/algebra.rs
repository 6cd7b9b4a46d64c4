//! Sums of products, built from the scalars of a plan and written as in a textbook: `c1 (a2 c2 + a3 c23) - d4 s1`.
//!
//! Nested sums and products are flattened, signs pulled outwards, and terms and factors put in the order of the
//! joints; nothing is multiplied out.

use super::number::trimmed;
use std::fmt;

/// A sum of terms; none are 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Sum(Vec<Term>);

/// A signed product: a number, and powers of factors.
#[derive(Debug, Clone, PartialEq)]
struct Term {
    negative: bool,
    /// Not negative.
    number: f64,
    factors: Vec<(Factor, i32)>,
}

/// What has no sign of its own, or wears it in parentheses.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Factor {
    /// A number of the table, by its name.
    Constant(String),
    /// A value: its place in the function and its name.
    Value(usize, String),
    /// What an equation is solved for, or its cosine or sine: their order, and the name.
    Unknown(usize, String),
    /// A sum of two terms or more.
    Sum(Sum),
}

impl Sum {
    /// Nothing.
    pub(super) const ZERO: Sum = Sum(Vec::new());

    /// A number.
    pub(super) fn number(value: f64) -> Sum {
        if value == 0.0 {
            return Sum::ZERO;
        }
        Sum(vec![Term { negative: value < 0.0, number: value.abs(), factors: Vec::new() }])
    }

    /// A name.
    pub(super) fn factor(factor: Factor) -> Sum {
        Sum(vec![Term { negative: false, number: 1.0, factors: vec![(factor, 1)] }])
    }

    /// Whether there is nothing.
    pub(super) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether there are no names of values in it.
    pub(super) fn is_constant(&self) -> bool {
        self.0.iter().flat_map(|term| &term.factors).all(|(factor, _)| match factor {
            Factor::Constant(_) => true,
            Factor::Value(..) | Factor::Unknown(..) => false,
            Factor::Sum(sum) => sum.is_constant(),
        })
    }

    /// How many names and numbers are written.
    pub(super) fn size(&self) -> usize {
        let size = |(factor, _): &(Factor, i32)| match factor {
            Factor::Sum(sum) => sum.size(),
            Factor::Constant(_) | Factor::Value(..) | Factor::Unknown(..) => 1,
        };
        let terms = self.0.iter().map(|term| term.factors.iter().map(size).sum::<usize>().max(1));
        terms.fold(0, usize::saturating_add)
    }

    /// -x
    pub(super) fn neg(mut self) -> Sum {
        self.0.iter_mut().for_each(|term| term.negative = !term.negative);
        self
    }

    /// x + y; terms that are numbers or the same but for their number become one.
    pub(super) fn add(mut self, other: Sum) -> Sum {
        for term in other.0 {
            let Some(at) = self.0.iter().position(|known| known.factors == term.factors) else {
                self.0.push(term);
                continue;
            };
            let known = self.0.remove(at);
            let value = known.value() + term.value();
            if value != 0.0 {
                self.0.insert(at, Term { negative: value < 0.0, number: value.abs(), ..known });
            }
        }
        self
    }

    /// x - y
    pub(super) fn sub(self, other: Sum) -> Sum {
        self.add(other.neg())
    }

    /// x y
    pub(super) fn mul(self, other: Sum) -> Sum {
        if self.is_zero() || other.is_zero() {
            return Sum::ZERO;
        }
        match (self.unit(), other.unit()) {
            (Some(negative), _) => return if negative { other.neg() } else { other },
            (_, Some(negative)) => return if negative { self.neg() } else { self },
            _ => {}
        }
        let (mut left, right) = (self.into_term(), other.into_term());
        left.negative ^= right.negative;
        left.number *= right.number;
        for (factor, power) in right.factors {
            left.multiply(factor, power);
        }
        Sum(vec![left])
    }

    /// x / y
    pub(super) fn div(self, other: Sum) -> Sum {
        if let Some(negative) = other.unit() {
            return if negative { self.neg() } else { self };
        }
        if self.is_zero() {
            return self;
        }
        let (mut left, right) = (self.into_term(), other.into_term());
        left.negative ^= right.negative;
        left.number /= right.number;
        for (factor, power) in right.factors {
            left.multiply(factor, -power);
        }
        Sum(vec![left])
    }

    /// The same with the sign that writes it more shortly.
    pub(super) fn unsigned(&self) -> Sum {
        if self.0.iter().all(|term| term.negative) { self.clone().neg() } else { self.clone() }
    }

    /// The square.
    pub(super) fn squared(&self) -> Sum {
        self.clone().mul(self.clone())
    }

    /// `(x + y) / (2 a)`: a fraction as it is written, the number of the denominator left where it is.
    pub(super) fn over(&self, denominator: &Sum) -> String {
        match denominator.unit() {
            Some(false) => return self.to_string(),
            Some(true) => return self.clone().neg().to_string(),
            None => {}
        }
        let negative = denominator.0.iter().all(|term| term.negative);
        let (above, below) = if negative {
            (self.clone().neg(), denominator.clone().neg().to_string())
        } else {
            (self.clone(), denominator.to_string())
        };
        let above = if above.0.len() > 1 { format!("({above})") } else { above.to_string() };
        if below.contains(' ') { format!("{above} / ({below})") } else { format!("{above} / {below}") }
    }

    /// Whether this is 1 or -1, and which.
    fn unit(&self) -> Option<bool> {
        match self.0.as_slice() {
            [Term { negative, number: 1.0, factors }] if factors.is_empty() => Some(*negative),
            _ => None,
        }
    }

    /// As one term; a sum of several in parentheses, with a sign before them where most of them have it.
    fn into_term(mut self) -> Term {
        if self.0.len() == 1
            && let Some(term) = self.0.pop()
        {
            return term;
        }
        let negative = 2 * self.0.iter().filter(|term| term.negative).count() > self.0.len();
        let sum = if negative { self.neg() } else { self };
        Term { negative, number: 1.0, factors: vec![(Factor::Sum(sum), 1)] }
    }
}

impl Term {
    fn value(&self) -> f64 {
        if self.negative { -self.number } else { self.number }
    }

    fn multiply(&mut self, factor: Factor, power: i32) {
        match self.factors.iter_mut().find(|(known, _)| *known == factor) {
            Some((_, known)) => *known += power,
            None => self.factors.push((factor, power)),
        }
        self.factors.retain(|(_, power)| *power != 0);
        self.factors.sort_by(|(one, _), (other, _)| one.place().cmp(&other.place()));
    }

    /// Where it is written in a sum: with an unknown, first; what does not vary, before the rest where it is positive
    /// and behind it where it is not.
    fn place(&self) -> (u8, Place<'_>) {
        let places = || self.factors.iter().map(|(factor, _)| factor.place());
        if let Some(unknown) = places().find(|place| place.0 == UNKNOWN) {
            return (0, unknown);
        }
        match places().filter(|place| place.0 > CONSTANT).min() {
            Some(place) => (2, place),
            None => (if self.negative { 3 } else { 1 }, (CONSTANT, 0, "")),
        }
    }
}

/// Where a factor is written in a product: its class, its place in the function, its name.
type Place<'a> = (u8, usize, &'a str);
const CONSTANT: u8 = 0;
const VALUE: u8 = 1;
const SUM: u8 = 2;
const UNKNOWN: u8 = 3;

impl Factor {
    fn place(&self) -> Place<'_> {
        match self {
            Factor::Constant(name) => (CONSTANT, 0, name),
            Factor::Value(place, _) => (VALUE, *place, ""),
            Factor::Sum(sum) => {
                (SUM, sum.0.iter().map(Term::place).min().map_or(0, |(_, place)| place.1), "")
            }
            Factor::Unknown(place, _) => (UNKNOWN, *place, ""),
        }
    }
}

impl fmt::Display for Sum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("0");
        }
        let mut terms: Vec<&Term> = self.0.iter().collect();
        terms.sort_by(|one, other| one.place().cmp(&other.place()));
        // A sign at the front costs a letter more than one in between.
        if terms.first().is_some_and(|term| term.negative)
            && let Some(at) = terms.iter().position(|term| !term.negative)
        {
            let first = terms.remove(at);
            terms.insert(0, first);
        }
        for (place, term) in terms.into_iter().enumerate() {
            f.write_str(match (place, term.negative) {
                (0, false) => "",
                (0, true) => "-",
                (_, false) => " + ",
                (_, true) => " - ",
            })?;
            term.fmt(f)?;
        }
        Ok(())
    }
}

/// Without its sign.
impl fmt::Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let above: Vec<String> = self.powers(1);
        let below: Vec<String> = self.powers(-1);
        let above = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
        match below.as_slice() {
            [] => f.write_str(&above),
            [one] => write!(f, "{above} / {one}"),
            several => write!(f, "{above} / ({})", several.join(" ")),
        }
    }
}

impl Term {
    /// What is above (1) or below (-1) the line of a fraction.
    fn powers(&self, side: i32) -> Vec<String> {
        let number = (side > 0 && self.number != 1.0).then(|| trimmed(self.number));
        let factors = self.factors.iter().filter(|(_, power)| power.signum() == side);
        let written = factors.map(|(factor, power)| {
            let base = match factor {
                Factor::Constant(name) | Factor::Value(_, name) | Factor::Unknown(_, name) => name.clone(),
                Factor::Sum(sum) => format!("({sum})"),
            };
            if power.abs() == 1 { base } else { format!("{base}^{}", power.abs()) }
        });
        number.into_iter().chain(written).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Factor, Sum};

    fn value(place: usize) -> Sum {
        Sum::factor(Factor::Value(place, format!("v{place}")))
    }

    fn constant(name: &str) -> Sum {
        Sum::factor(Factor::Constant(name.to_owned()))
    }

    #[test]
    fn parentheses_only_where_they_are_needed() {
        let arm = constant("a").mul(value(2)).add(constant("b").mul(value(3)));
        assert_eq!(value(1).mul(arm.clone()).to_string(), "v1 (a v2 + b v3)");
        assert_eq!(value(1).sub(arm.clone()).to_string(), "v1 - a v2 - b v3");
        assert_eq!(value(1).mul(arm.neg()).to_string(), "-v1 (a v2 + b v3)");
        assert_eq!(value(1).mul(value(2)).mul(value(1)).to_string(), "v1^2 v2");
    }

    #[test]
    fn signs_and_numbers() {
        assert_eq!(Sum::ZERO.to_string(), "0");
        assert_eq!(Sum::number(-1.0).to_string(), "-1");
        assert_eq!(Sum::number(-1.0).mul(value(1)).to_string(), "-v1");
        assert_eq!(Sum::number(2.0).mul(Sum::number(0.0)).to_string(), "0");
        assert_eq!(value(1).sub(value(1)).to_string(), "0");
        assert_eq!(value(1).add(value(1)).to_string(), "2 v1");
        assert_eq!(value(2).neg().add(value(3)).to_string(), "v3 - v2");
        assert_eq!(value(1).mul(Sum::number(110.4)).sub(Sum::number(3.5)).to_string(), "110.4 v1 - 3.5");
        assert_eq!(value(1).add(Sum::number(3.5)).to_string(), "3.5 + v1");
    }

    #[test]
    fn fractions() {
        assert_eq!(value(1).div(value(2)).to_string(), "v1 / v2");
        assert_eq!(Sum::number(1.0).div(value(2).mul(value(3))).to_string(), "1 / (v2 v3)");
        assert_eq!(value(1).div(value(2).add(constant("a"))).to_string(), "v1 / (a + v2)");
        assert_eq!(value(1).div(Sum::number(4.0)).to_string(), "0.25 v1");
    }
}
