//! A search as a whole: which failure decides, what becomes of candidates, what is free.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use core::f64::consts::{PI, TAU};

use dh_core::{IkError, Measure, Rule, Search, Solution, Solutions, Step, Winding};

const TURN: [Winding<'static>; 2] =
    [Winding { joint: 0, turn: TAU, carries: &[] }, Winding { joint: 1, turn: TAU, carries: &[] }];

const fn step(index: u8) -> Step {
    Step::new(index, 1 << index, false, Measure::Length)
}

#[test]
fn the_deepest_failure_decides_then_the_smallest() {
    let mut search = Search::<2>::new(1.0, &TURN);
    assert!(search.trig(step(0), 0.1, 0.0, 0.2).is_empty());
    assert!(search.trig(step(1), 0.1, 0.0, 0.6).is_empty());
    assert!(search.trig(step(1), 0.2, 0.0, 0.5).is_empty());
    assert!(search.trig(step(1), 0.1, 0.0, 0.7).is_empty());
    assert!(search.trig(step(0), 0.1, 0.0, 0.11).is_empty());
    search.accept([0.0; 2], 1.0, 0.0);
    let Err(IkError::Unreachable { step: at, excess }) = search.finish() else { panic!() };
    assert_eq!(at, step(1));
    assert!((excess - 0.3).abs() < 1e-15);
}

#[test]
fn false_roots_are_dropped_and_told_of_if_nothing_else_failed() {
    let mut search = Search::<2>::new(1.0, &TURN);
    search.accept([0.1, 0.2], 0.5, 0.0);
    search.accept([0.3, 0.4], 0.1, 0.2);
    assert_eq!(search.finish(), Err(IkError::Failed { position_error: 0.1, rotation_error: 0.2 }));

    let mut search = Search::<2>::new(0.5, &TURN);
    search.accept([0.1, 0.2], 1e-9, 0.0);
    search.accept([0.3, 0.4], 1e-6, 0.0);
    search.accept([0.3, f64::NAN], 0.0, 0.0);
    search.accept([0.3, 0.5], f64::NAN, 0.0);
    assert_eq!(search.finish().unwrap().len(), 1);
}

#[test]
fn a_refused_candidate_came_furthest() {
    let mut search = Search::<2>::new(1.0, &TURN);
    assert!(search.trig(step(1), 0.1, 0.0, 0.6).is_empty());
    let rule = Rule::Where { index: 0, excess: 0.25 };
    search.refuse(Rule::Where { index: 0, excess: 0.5 });
    search.refuse(rule);
    assert_eq!(search.finish(), Err(IkError::Forbidden { rule }));
    assert_eq!(Search::<2>::new(1.0, &TURN).finish(), Err(IkError::NotFinite));
}

#[test]
fn revolute_joints_are_wrapped_and_others_are_not() {
    let windings = &TURN[..1];
    for (value, wrapped) in [(-PI, PI), (PI, PI), (3.0 * PI, PI), (TAU + 0.5, 0.5), (-TAU - 0.5, -0.5)] {
        let mut search = Search::<2>::new(1.0, windings);
        search.accept([value, 7.0], 0.0, 0.0);
        let q = search.finish().unwrap()[0].q;
        assert!((q[0] - wrapped).abs() < 1e-15, "{value} -> {q:?}");
        assert_eq!(q[1], 7.0);
    }
}

#[test]
fn wrapping_carries_what_is_coupled() {
    // theta2 = q2 + q1 / 2: a turn of q1 takes half a turn of q2 along.
    let windings = [
        Winding { joint: 0, turn: TAU, carries: &[(1, -PI)] },
        Winding { joint: 1, turn: TAU, carries: &[] },
    ];
    let mut search = Search::<2>::new(1.0, &windings);
    search.accept([TAU + 0.5, 0.25], 0.0, 0.0);
    // The same solution, on its other winding.
    search.accept([0.5, 0.25 - PI + TAU], 0.0, 0.0);
    let q = search.finish().unwrap();
    // One turn of q1 back: q2 gains pi, and is brought back within half a turn.
    assert_eq!(q.len(), 1);
    let [q1, q2] = q[0].q;
    assert!((q1 - 0.5).abs() < 1e-15);
    assert!((q2 - (0.25 + PI - TAU)).abs() < 1e-15, "{q2}");
}

#[test]
fn duplicates_are_one_and_the_better_stays() {
    let mut search = Search::<2>::new(1.0, &TURN);
    search.accept([PI, 1.0], 1e-9, 0.0);
    search.accept([-PI + 1e-8, 1.0 + 1e-8], 1e-12, 0.0);
    search.accept([PI, 1.0], 1e-8, 0.0);
    search.accept([PI, 1.0 + 1e-5], 0.0, 0.0);
    let solutions = search.finish().unwrap();
    assert_eq!(solutions.len(), 2);
    assert_eq!(solutions[0].residual(), 1e-12);
}

#[test]
fn at_most_sixteen_are_kept_and_the_others_counted() {
    let mut search = Search::<1>::new(1.0, &[]);
    for count in 0..20 {
        search.accept([f64::from(count)], 0.0, 0.0);
    }
    let solutions = search.finish().unwrap();
    assert_eq!((solutions.len(), solutions.dropped()), (16, 4));
    assert_eq!(solutions.into_iter().count(), 16);
}

#[test]
fn a_free_step_marks_what_follows_until_it_is_solved_again() {
    let mut search = Search::<2>::new(1.0, &TURN);
    let mut found = [(0.0, None); 3];
    for (slot, c) in found.iter_mut().zip([0.5, 0.0, -0.5]) {
        // Free where c is 0.
        for theta2 in search.trig_pair(step(1), [c, 0.0, c], [0.0, c, 0.0]) {
            let mut inner = search.clone();
            inner.accept([c, theta2], 0.0, 0.0);
            let last = *inner.finish().unwrap().last().unwrap();
            *slot = (last.q[0], last.free);
        }
    }
    assert_eq!(found, [(0.5, None), (0.0, Some(1)), (-0.5, None)]);
}

#[test]
fn nearest_is_by_least_joint_travel() {
    let solution = |q| Solution {
        q,
        position_error: 0.0,
        rotation_error: 0.0,
        free: None,
        branch: dh_core::Branch::UNKNOWN,
    };
    let mut solutions = Solutions::one(solution([1.0, 1.0]));
    solutions.push(solution([0.0, 1.3]), &TURN);
    solutions.push(solution([-2.0, 0.0]), &TURN);
    assert_eq!(solutions.nearest(&[0.0, 0.0]).q, [0.0, 1.3]);
    assert_eq!(solutions.nearest(&[1.0, 0.9]).q, [1.0, 1.0]);
    solutions.sort_by_distance(&[-1.9, 0.0]);
    assert_eq!(solutions.iter().map(|s| s.q[0]).collect::<Vec<_>>(), [-2.0, 0.0, 1.0]);
}

#[test]
fn messages_count_from_one_and_carry_numbers() {
    let two = Step::new(1, 0b110, false, Measure::Length);
    assert_eq!(two.to_string(), "step 2 (theta2 + theta3)");
    assert_eq!(Step::new(0, 0b100, true, Measure::Area).to_string(), "step 1 (d3)");
    let text = IkError::Unreachable { step: two, excess: 0.125 }.to_string();
    assert!(text.contains("step 2 (theta2 + theta3)") && text.contains("0.125000 m"), "{text}");
    let text =
        IkError::Unreachable { step: Step { measure: Measure::Area, ..two }, excess: 0.125 }.to_string();
    assert!(text.contains("12.5") && text.contains('%'), "{text}");
    let text = IkError::OutsideLimits { joint: 2, value: 4.0, min: -1.0, max: 1.0 }.to_string();
    assert!(text.contains("joint 3") && text.contains("4.000000"), "{text}");
}

/// The second step has roots only where 2 - 2 cos(theta1 - 1) is at most `width`: in an interval, down to a point.
#[test]
fn a_free_joint_takes_a_value_that_the_rest_can_be_solved_with() {
    for width in [1.0, 1e-4, 1e-9, 0.0] {
        let mut search = Search::<2>::new(1.0, &TURN);
        let mut first = search.trig(step(0), 0.0, 0.0, 0.0);
        while let Some(theta1) = search.next(&mut first) {
            let mut second = search.trig(step(1), 1.0, 0.0, 3.0 - 2.0 * (theta1 - 1.0).cos() - width);
            while let Some(theta2) = search.next(&mut second) {
                search.accept([theta1, theta2], 0.0, 0.0);
            }
        }
        let solutions = search.finish().unwrap();
        assert!(!solutions.is_empty() && solutions.iter().all(|solution| solution.free == Some(0)));
        assert!(solutions.iter().all(|solution| (solution.q[0] - 1.0).powi(2) <= 1.1 * width + 2e-7));
    }
}

#[test]
fn where_no_value_of_a_free_joint_helps_the_best_one_says_why() {
    let mut search = Search::<2>::new(1.0, &TURN);
    let mut first = search.trig(step(0), 0.0, 0.0, 0.0);
    while let Some(theta1) = search.next(&mut first) {
        assert!(search.trig(step(1), 1.0, 0.0, 3.5 - 2.0 * (theta1 - 1.0).cos()).is_empty());
    }
    let Err(IkError::Unreachable { excess, .. }) = search.finish() else { panic!() };
    assert!((excess - 0.5).abs() < 1e-9, "{excess}");
}

/// Both steps have next to nothing to go by, and the target is missed by as much whatever they are: sixty values of one
/// are not tried for every one of the other.
#[test]
fn where_nothing_changes_what_is_missing_few_values_are_tried() {
    for miss in [1e-3, 1e-5] {
        let mut search = Search::<2>::new(1.0, &TURN);
        let (cos, sin) = (1e-9 * 0.8, 1e-9 * 0.6);
        let mut tried = 0;
        let mut first = search.trig_pair(step(0), [1e-9, 0.0, cos], [0.0, 1e-9, sin]);
        while let Some(theta1) = search.next(&mut first) {
            let mut second = search.trig_pair(step(1), [1e-9, 0.0, cos], [0.0, 1e-9, -sin]);
            while let Some(theta2) = search.next(&mut second) {
                tried += 1;
                search.accept([theta1, theta2], miss * (1.0 + 1e-3 * theta1.sin()), 0.0);
            }
        }
        assert_eq!(tried, 16, "{miss:e}");
        assert!(matches!(search.finish(), Err(IkError::Failed { .. })));
    }
}

/// A nearly free step whose first value is in the middle between two solutions: what is missing is the same on both sides of
/// it, and at some distances of the two as large as in the middle.
#[test]
fn solutions_at_both_sides_of_what_is_nearly_free_are_found() {
    for ratio in [0.5, 0.6, 0.65, 0.7, 0.5_f64.sqrt(), 0.71, 0.75, 0.8, 0.9, 1.0, 1.2, 1.5, 2.0, 3.0, 4.0] {
        let mut search = Search::<2>::new(1.0, &TURN);
        let mut values = Vec::new();
        let mut first = search.trig_pair(step(0), [1e-9, 0.0, 0.8e-9], [0.0, 1e-9, 0.6e-9]);
        while let Some(theta1) = search.next(&mut first) {
            values.push(theta1);
            let away = |theta: f64| theta - values[0];
            let width = values.get(1).map_or(f64::INFINITY, |&second| ratio * away(second));
            search.accept([theta1, 0.0], 1e-3 * (1.0 - (away(theta1) / width).powi(2)).abs(), 0.0);
        }
        assert!(search.finish().is_ok(), "{ratio}: {values:?}");
    }
}

/// Of three in a row, each next to the one before, the one between is the same as either.
#[test]
fn what_is_between_two_solutions_replaces_both() {
    let mut search = Search::<1>::new(1.0, &[]);
    search.accept([1.0], 1e-9, 0.0);
    search.accept([1.0 + 4e-7], 1e-9, 0.0);
    search.accept([1.0 + 2e-7], 1e-12, 0.0);
    search.accept([1.0 + 2e-7], 1e-12, 0.0);
    search.accept([1.0 + 4e-7], 1e-10, 0.0);
    let solutions = search.finish().unwrap();
    assert!(solutions.len() == 1 && solutions[0].q == [1.0 + 2e-7], "{solutions:?}");
}
