//! Constants that were folded from others, read back from their notes: `= 2 a2 a3`.

use super::algebra::Sum;

/// The expression of a note, in terms of names that `resolve` knows; `None` where it has others.
pub(super) fn read(note: &str, resolve: &mut dyn FnMut(&str) -> Option<Sum>) -> Option<Sum> {
    let mut reader = Reader { rest: note.strip_prefix('=')?, resolve };
    let sum = reader.sum()?;
    reader.rest.trim().is_empty().then_some(sum)
}

struct Reader<'a, 'r> {
    rest: &'a str,
    resolve: &'r mut dyn FnMut(&str) -> Option<Sum>,
}

impl<'a> Reader<'a, '_> {
    fn sum(&mut self) -> Option<Sum> {
        let mut sum = if self.takes('-') { self.product()?.neg() } else { self.product()? };
        loop {
            if self.takes('+') {
                sum = sum.add(self.product()?);
            } else if self.takes('-') {
                sum = sum.sub(self.product()?);
            } else {
                return Some(sum);
            }
        }
    }

    fn product(&mut self) -> Option<Sum> {
        let mut product = self.power()?;
        loop {
            if self.takes('/') {
                product = product.div(self.power()?);
            } else if self.rest.trim_start().starts_with(|c: char| c == '(' || c.is_alphanumeric()) {
                product = product.mul(self.power()?);
            } else {
                return Some(product);
            }
        }
    }

    fn power(&mut self) -> Option<Sum> {
        let base = self.atom()?;
        if !self.takes('^') {
            return Some(base);
        }
        let exponent: u8 = self.word().parse().ok()?;
        let mut power = base.clone();
        for _ in 1..exponent {
            power = power.mul(base.clone());
        }
        Some(power)
    }

    fn atom(&mut self) -> Option<Sum> {
        if self.takes('(') {
            let sum = self.sum()?;
            return self.takes(')').then_some(sum);
        }
        let word = self.word();
        if word == "sqrt" {
            let number: f64 = if self.takes('(') { self.word().parse().ok()? } else { return None };
            return self.takes(')').then(|| Sum::number(number.sqrt()));
        }
        match word.parse::<f64>() {
            Ok(number) if word.starts_with(|c: char| c.is_ascii_digit()) => Some(Sum::number(number)),
            _ => (self.resolve)(word),
        }
    }

    fn takes(&mut self, c: char) -> bool {
        let rest = self.rest.trim_start().strip_prefix(c);
        if let Some(rest) = rest {
            self.rest = rest;
        }
        rest.is_some()
    }

    /// A number or a name; empty where there is neither.
    fn word(&mut self) -> &'a str {
        let start = self.rest.trim_start();
        let end =
            start.find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.'))).unwrap_or(start.len());
        let (word, rest) = start.split_at(end);
        self.rest = rest;
        word
    }
}

#[cfg(test)]
mod tests {
    use super::super::algebra::{Factor, Sum};

    fn read(note: &str) -> Option<String> {
        let mut resolve = |name: &str| {
            let known = ["a2", "a3", "d4"].contains(&name);
            known.then(|| Sum::factor(Factor::Constant(name.to_owned())))
        };
        super::read(note, &mut resolve).map(|sum| sum.to_string())
    }

    #[test]
    fn notes_of_folded_constants() {
        assert_eq!(read("= 2 a2 a3").as_deref(), Some("2 a2 a3"));
        assert_eq!(read("= -a3^2 - (a2 + d4) a3").as_deref(), Some("-a3 (a2 + d4) - a3^2"));
        assert_eq!(read("= 1/2 a2").as_deref(), Some("0.5 a2"));
        assert_eq!(read("= sqrt(4)/4 a2").as_deref(), Some("0.5 a2"));
    }

    #[test]
    fn others_are_not_read() {
        for note in ["link length of joint 2", "= salpha3 a2", "= (a2", "= a2 )", "=", "= a2^x", "= a2^"] {
            assert_eq!(read(note), None, "{note}");
        }
    }
}
