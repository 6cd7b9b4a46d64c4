//! What may happen between two goals of a device that makes its own profiles: its joints may not keep in step, and each
//! is anywhere between its two values.

use super::clearance;
use super::narrowed::Narrowed;
use dh_runtime::Kinematics;

/// With more moving joints than this, not all extreme combinations are looked at.
const MOST_CORNERS: usize = 7;

/// So many combinations besides are looked at.
const INSIDE: u32 = 300;

/// Near to what is forbidden, joints carry the tool point no further than this between two goals (m), each as far as it
/// does alone: over more, so many combinations would lie too far apart to see what is between them.
const MOST_TRAVEL: f64 = 0.3;

/// It is not near where it is this many times as far away.
const FAR: f64 = 2.0;

/// Where no joint can carry the tool point further than this (m), it no longer matters in which order they move.
const LEAST_TRAVEL: f64 = 5e-3;

/// Whether the tool point keeps the workspace rules in whatever order the joints go from one goal to the next: looked at
/// with each joint at either end, and in places that fill what is between them evenly.
pub(super) fn keeps_rules(arm: &Narrowed<'_>, from: &[f64], to: &[f64]) -> bool {
    let rules = arm.rules();
    if rules.bounds.is_empty() && rules.keep_out.is_empty() {
        return true;
    }
    let travel = travel(arm, from, to);
    let seen = travel <= MOST_TRAVEL || clearance::is_far(arm, from, FAR * travel);
    travel <= LEAST_TRAVEL || (seen && combinations(from, to).all(|q| clearance::no_deeper(arm, from, &q)))
}

/// Whether the tool point stays this near (m) to the straight line between the goals, likewise.
pub(super) fn stays_near(arm: &Narrowed<'_>, from: &[f64], to: &[f64], distance: f64) -> bool {
    let point = |q: &[f64]| arm.rules_point(q).unwrap_or([f64::NAN; 3]);
    let (start, end) = (point(from), point(to));
    travel(arm, from, to) <= LEAST_TRAVEL
        || combinations(from, to).all(|q| to_segment(start, end, point(&q)) <= distance)
}

/// How far the joints carry the tool point (m), with the levers that they have at first.
fn travel(arm: &Narrowed<'_>, from: &[f64], to: &[f64]) -> f64 {
    let mut columns = vec![[0.0; 6]; from.len()];
    if arm.jacobian_into(from, &mut columns).is_err() {
        return f64::INFINITY;
    }
    let travels = columns.iter().zip(from.iter().zip(to));
    let travel =
        travels.map(|([x, y, z, ..], (from, to))| (x * x + y * y + z * z).sqrt() * (to - from).abs());
    travel.sum()
}

/// Joint values, each between those of two goals: all combinations of ends, and an additive recurrence of the lowest
/// discrepancy \[Roberts 2018, the R sequence\].
fn combinations<'a>(from: &'a [f64], to: &'a [f64]) -> impl Iterator<Item = Vec<f64>> + 'a {
    let moving: Vec<usize> =
        from.iter().zip(to).enumerate().filter(|(_, (a, b))| a != b).map(|(index, _)| index).collect();
    let corners = if moving.len() <= MOST_CORNERS { 1_u32 << moving.len() } else { 0 };
    let ratio = growth(moving.len());
    let place = move |number: u32, dimension: usize| {
        if number < corners {
            f64::from((number >> dimension) & 1)
        } else {
            (0.5 + f64::from(number - corners + 1) * ratio.powi(-(dimension as i32 + 1))).fract()
        }
    };
    (0..corners + INSIDE).map(move |number| {
        let mut q = from.to_vec();
        for (dimension, joint) in moving.iter().enumerate() {
            if let (Some(value), Some(end)) = (q.get_mut(*joint), to.get(*joint)) {
                *value += place(number, dimension) * (end - *value);
            }
        }
        q
    })
}

/// The root of x^(d + 1) = x + 1 above 1: the golden ratio for one dimension.
fn growth(dimensions: usize) -> f64 {
    let mut x: f64 = 1.5;
    for _ in 0..40 {
        x = (1.0 + x).powf(1.0 / (dimensions as f64 + 1.0));
    }
    x
}

/// The distance of a point from a segment.
fn to_segment(start: [f64; 3], end: [f64; 3], point: [f64; 3]) -> f64 {
    let (mut along, mut whole) = (0.0, 0.0);
    for i in 0..3 {
        along += (point[i] - start[i]) * (end[i] - start[i]);
        whole += (end[i] - start[i]).powi(2);
    }
    let part = if whole > 0.0 { (along / whole).clamp(0.0, 1.0) } else { 0.0 };
    (0..3).map(|i| (point[i] - start[i] - part * (end[i] - start[i])).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::{combinations, growth, to_segment};

    #[test]
    fn combinations_have_all_corners_and_stay_between() {
        let (from, to) = ([0.0, 1.0, 2.0], [1.0, 1.0, -2.0]);
        let all: Vec<Vec<f64>> = combinations(&from, &to).collect();
        for corner in [[0.0, 1.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0, -2.0], [1.0, 1.0, -2.0]] {
            assert!(all.contains(&corner.to_vec()));
        }
        for q in &all {
            assert!((0.0..=1.0).contains(&q[0]) && q[1] == 1.0 && (-2.0..=2.0).contains(&q[2]), "{q:?}");
        }
        // Every sixteenth of the square has its share.
        for cell in 0..16 {
            let (x, y) = (f64::from(cell % 4) / 4.0, f64::from(cell / 4) - 2.0);
            let inside =
                all.iter().skip(4).filter(|q| (x..x + 0.25).contains(&q[0]) && (y..y + 1.0).contains(&q[2]));
            let share = super::INSIDE as usize / 16;
            assert!((share * 2 / 3..=share * 4 / 3).contains(&inside.count()));
        }
    }

    #[test]
    fn the_growth_is_the_golden_ratio_and_its_kin() {
        assert!((growth(1) - 1.618_033_988_749_895).abs() < 1e-12);
        assert!((growth(2) - 1.324_717_957_244_746).abs() < 1e-12);
    }

    #[test]
    fn distances_from_a_segment() {
        let (a, b) = ([0.0; 3], [2.0, 0.0, 0.0]);
        assert_eq!(to_segment(a, b, [1.0, 3.0, 4.0]), 5.0);
        assert_eq!(to_segment(a, b, [-3.0, 4.0, 0.0]), 5.0);
        assert_eq!(to_segment(a, a, [0.0, 0.0, 1.0]), 1.0);
    }
}
