//! Evaluates the formulas that `dhc equations` prints, which shares nothing with what prints them.

#![allow(clippy::panic, reason = "a formula that cannot be read is what the test is to find")]

use std::collections::HashMap;

/// Values of names; angles in the unit of the equations.
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    pub(crate) values: HashMap<String, f64>,
    /// Radians one unit of angle has.
    pub(crate) unit: f64,
}

impl Names {
    /// The value of a formula; `sign` is what `+-` stands for.
    pub(crate) fn value(&self, formula: &str, sign: f64) -> f64 {
        let mut reader = Reader { names: self, tokens: tokens(formula), at: 0, sign };
        let value = reader.sum();
        assert_eq!(reader.at, reader.tokens.len(), "{formula} is read to its end");
        value
    }
}

fn tokens(text: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let mut word = String::new();
    for c in text.chars() {
        if c.is_alphanumeric() || c == '_' || c == '.' {
            word.push(c);
            continue;
        }
        tokens.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
        match (c, tokens.last_mut()) {
            (' ', _) => {}
            ('-', Some(plus)) if plus == "+" => plus.push('-'),
            _ => tokens.push(c.to_string()),
        }
    }
    tokens.extend((!word.is_empty()).then_some(word));
    tokens
}

struct Reader<'n> {
    names: &'n Names,
    tokens: Vec<String>,
    at: usize,
    sign: f64,
}

impl Reader<'_> {
    fn takes(&mut self, token: &str) -> bool {
        let found = self.tokens.get(self.at).is_some_and(|next| next == token);
        self.at += usize::from(found);
        found
    }

    fn sum(&mut self) -> f64 {
        let mut sum = 0.0;
        let mut first = true;
        loop {
            if self.takes("+-") {
                sum += self.sign * self.product();
            } else if self.takes("-") {
                sum -= self.product();
            } else if self.takes("+") || first {
                sum += self.product();
            } else {
                return sum;
            }
            first = false;
        }
    }

    fn product(&mut self) -> f64 {
        let mut product = self.power();
        loop {
            if self.takes("/") {
                product /= self.power();
            } else if self
                .tokens
                .get(self.at)
                .is_some_and(|next| next == "(" || next.starts_with(|c: char| c.is_alphanumeric()))
            {
                product *= self.power();
            } else {
                return product;
            }
        }
    }

    fn power(&mut self) -> f64 {
        let base = self.atom();
        if self.takes("^") { base.powf(self.atom()) } else { base }
    }

    fn atom(&mut self) -> f64 {
        if self.takes("(") {
            let value = self.sum();
            assert!(self.takes(")"), "a parenthesis is closed: {:?}", self.tokens);
            return value;
        }
        let word = self.tokens[self.at].clone();
        self.at += 1;
        if ["sqrt", "sin", "cos", "acos", "asin", "atan2"].contains(&word.as_str()) {
            assert!(self.takes("("), "{word} of something: {:?}", self.tokens);
            let mut arguments = vec![self.sum()];
            while self.takes(",") {
                arguments.push(self.sum());
            }
            assert!(self.takes(")"), "a parenthesis is closed: {:?}", self.tokens);
            return self.function(&word, &arguments);
        }
        if word == "pi" {
            return std::f64::consts::PI;
        }
        let known = self.names.values.get(&word).copied();
        known.or_else(|| word.parse().ok()).unwrap_or_else(|| panic!("`{word}` was not explained"))
    }

    fn function(&self, name: &str, arguments: &[f64]) -> f64 {
        let unit = self.names.unit;
        match (name, arguments) {
            ("sqrt", [x]) => x.sqrt(),
            ("sin", [x]) => (x * unit).sin(),
            ("cos", [x]) => (x * unit).cos(),
            ("acos", [x]) => x.acos() / unit,
            ("asin", [x]) => x.asin() / unit,
            ("atan2", [y, x]) => y.atan2(*x) / unit,
            _ => panic!("{name} of {arguments:?}"),
        }
    }
}
