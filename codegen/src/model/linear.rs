//! Systems of linear equations in the joint variables, one equation at a time.

/// Coefficients smaller than this, of equations whose largest one is 1, have cancelled.
const CANCELLED: f64 = 1e-10;

/// Independent equations, each with a leading variable that the later ones do not have.
#[derive(Debug, Default)]
pub(super) struct System {
    equations: Vec<Equation>,
}

#[derive(Debug, Clone)]
struct Equation {
    coefficients: Vec<f64>,
    constant: f64,
    /// Which of the added equations it is made of.
    made_of: Vec<usize>,
    leading: usize,
}

/// What adding an equation came to.
#[derive(Debug, PartialEq)]
pub(super) enum Added {
    /// It takes an unknown away.
    Independent,
    /// The others say the left-hand side already, with a constant that differs by so much.
    Dependent {
        /// This equation's constant less the others'.
        difference: f64,
        /// The others.
        on: Vec<usize>,
    },
}

impl System {
    /// How many unknowns the equations take away.
    pub(super) fn rank(&self) -> usize {
        self.equations.len()
    }

    /// Adds an equation: sum of coefficient * variable = constant. `number` is what it is called by.
    pub(super) fn add(&mut self, number: usize, coefficients: &[f64], constant: f64) -> Added {
        let size = coefficients.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
        let mut new = Equation {
            coefficients: coefficients
                .iter()
                .map(|value| if size > 0.0 { value / size } else { 0.0 })
                .collect(),
            constant: if size > 0.0 { constant / size } else { constant },
            made_of: vec![number],
            leading: 0,
        };
        for known in &self.equations {
            let factor = new.coefficients.get(known.leading).copied().unwrap_or(0.0);
            if factor.abs() <= CANCELLED {
                continue;
            }
            for (value, other) in new.coefficients.iter_mut().zip(&known.coefficients) {
                *value -= factor * other;
            }
            new.constant -= factor * known.constant;
            new.made_of.extend(&known.made_of);
        }
        let largest = new
            .coefficients
            .iter()
            .enumerate()
            .max_by(|(_, one), (_, two)| one.abs().total_cmp(&two.abs()))
            .map_or((0, 0.0), |(index, value)| (index, *value));
        if largest.1.abs() <= CANCELLED {
            new.made_of.retain(|made| *made != number);
            new.made_of.sort_unstable();
            new.made_of.dedup();
            return Added::Dependent {
                difference: new.constant * size.max(f64::MIN_POSITIVE),
                on: new.made_of,
            };
        }
        new.leading = largest.0;
        for value in &mut new.coefficients {
            *value /= largest.1;
        }
        new.constant /= largest.1;
        self.equations.push(new);
        Added::Independent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_that_follow_from_others_are_found_with_what_they_differ_by() {
        let mut system = System::default();
        assert_eq!(system.add(0, &[1.0, 1.0, 0.0], 3.0), Added::Independent);
        assert_eq!(system.add(1, &[0.0, 1.0, -2.0], 1.0), Added::Independent);
        assert_eq!(
            system.add(2, &[2.0, 4.0, -4.0], 8.0),
            Added::Dependent { difference: 0.0, on: vec![0, 1] }
        );
        assert_eq!(system.add(3, &[2.0, 2.0, 0.0], 7.0), Added::Dependent { difference: 1.0, on: vec![0] });
        assert_eq!(system.add(4, &[0.0, 0.0, 0.5], 1.0), Added::Independent);
        assert_eq!(system.rank(), 3);
    }
}
