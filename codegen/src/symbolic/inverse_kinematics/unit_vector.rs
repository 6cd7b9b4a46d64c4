//! Coordinates of unit vectors in quartics: what a difference loses, the vector's other coordinates know.
//!
//! Where an axis turns about another one, what of it is along a third is h + b cos x, h and b of the table. If it can be parallel to
//! that one, h + b or b - h is 1, and where it nearly is, b cos x is b less what can't be told from rounding: two roots nearly meet,
//! and half of their digits are lost. But 1 - z^2 of a coordinate of a unit vector is the sum of the other coordinates' squares, and
//! these are small there.

use super::OfVector;
use super::candidates::{ZERO, of_table};
use super::elimination::{LONGEST, Linear, linear};
use super::polynomial::{Overflow, Polynomial};
use super::reading::{Open, Reading};
use super::samples::Sample;
use super::search::{Solved, State};
use crate::symbolic::expression::Arena;
use crate::symbolic::number::Number;

/// b cos x = c and r b sin x = s, squared and added, if c and a number of the table are a coordinate of a unit vector that x
/// can bring to its end, whatever the angle y in which c and s are linear.
pub(super) fn quartic(
    arena: &Arena,
    state: &mut State,
    y: &[i16],
    [c, s]: [&Linear; 2],
    [b, r]: [&Polynomial; 2],
) -> Result<Option<Solved>, Overflow> {
    if !of_table(&state.atoms, b) {
        return Ok(None);
    }
    let minus = Number::integer(-1);
    let State { samples, atoms, .. } = &mut *state;
    let negative = samples.first_mut().is_some_and(|sample| sample.value(arena, atoms, b) < 0.0);
    let sign = if negative { minus } else { Number::ONE };
    let b = b.scaled(sign)?;
    let [k, l, m] = c.each_ref().map(|entry| entry.scaled(sign));
    let [k, l, m] = [k?, l?, m?];
    let one = Polynomial::number(atoms.angles.len(), Number::ONE);
    let short_of_one = one.sub(&b)?;
    for h in [short_of_one.clone(), short_of_one.scaled(minus)?] {
        let coordinate = [k.add(&h)?, l.clone(), m.clone()];
        let Some([first, second]) = beside(arena, state, y, &coordinate)? else { continue };
        let times = |[k, l, m]: [Polynomial; 3]| Ok([k.mul(r)?, l.mul(r)?, m.mul(r)?]);
        let [plus, less] = [b.add(&h)?, b.sub(&h)?];
        let length = [r.clone(), plus.sub(&one)?.mul(r)?, less.sub(&one)?.mul(r)?];
        let vector = OfVector { others: [times(first)?, times(second)?], length };
        let forms = [times([k, l, m])?, s.clone()];
        return Ok(Some(Solved::Quartic(forms, b.mul(r)?, Some(Box::new(vector)))));
    }
    Ok(None)
}

/// The other two coordinates of the vector that this form in y is one of, if that has length 1 whatever y: the sides of more
/// equations on which y is.
fn beside(
    arena: &Arena,
    state: &mut State,
    y: &[i16],
    own: &Linear,
) -> Result<Option<[Linear; 2]>, Overflow> {
    let mut sides: Vec<Linear> = Vec::new();
    for equation in state.equations.iter().filter(|equation| equation.polynomial.len() <= LONGEST) {
        for side in sides_of(&equation.polynomial, &state.open, y)? {
            if !sides.contains(&side) {
                sides.push(side);
            }
        }
    }
    let State { samples, atoms, .. } = state;
    let mut values = |form: &Linear| -> Vec<f64> {
        let at = |sample: &mut Sample| {
            let [k, l, m] = form.each_ref().map(|entry| sample.value(arena, atoms, entry));
            [0.3, 1.7, 4.0].map(|y| k + l * libm::cos(y) + m * libm::sin(y))
        };
        samples.iter_mut().flat_map(at).collect()
    };
    let own = values(own);
    let of_sides: Vec<Vec<f64>> = sides.iter().map(values).collect();
    for (place, (one, first)) in sides.iter().zip(&of_sides).enumerate() {
        for (other, second) in sides.iter().zip(&of_sides).skip(place + 1) {
            let mut lengths =
                own.iter().zip(first.iter().zip(second)).map(|(a, (b, c))| a * a + b * b + c * c);
            if lengths.all(|length| (length - 1.0).abs() < ZERO) {
                return Ok(Some([one.clone(), other.clone()]));
            }
        }
    }
    Ok(None)
}

/// The forms in y that an equation has beside other angles: its part in y alone, and where it is p cos z + q sin z with another
/// angle z, p and q, whose squares are those of the two coordinates that z turns.
fn sides_of(equation: &Polynomial, open: &Open, y: &[i16]) -> Result<Vec<Linear>, Overflow> {
    let reading = Reading::new(equation, open)?;
    let part = reading.parts.iter().find(|((frequency, slides), _)| slides.is_empty() && frequency == y);
    let [cos, sin] = part.map(|(_, part)| part.clone()).unwrap_or_default();
    let mut sides = vec![[reading.constant(), cos, sin]];
    for z in open.angles.iter().filter(|z| y.get(**z) == Some(&0)) {
        let only = Open { angles: vec![*z], slides: Vec::new() };
        let mut others = open.clone();
        others.angles.retain(|angle| angle != z);
        for ((frequency, _), coefficients) in &Reading::new(equation, &only)?.parts {
            if frequency.get(*z).is_some_and(|k| k.abs() == 1) {
                for coefficient in coefficients {
                    sides.extend(linear(coefficient, &others, &mut Some(y.to_vec()))?);
                }
            }
        }
    }
    Ok(sides)
}
