//! Which windings of which solutions are allowed, and what is said where none is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use core::f64::consts::{PI, TAU};

use dh_core::{
    Axis, Bound, IkError, Joint, JointKind, Limits, Rule, Rules, Side, Solution, SolutionSet, Solutions,
    SumLimit, Winding,
};

const fn joint(limits: Option<Limits>) -> Joint<'static> {
    let kind = JointKind::Revolute;
    Joint { name: "", kind, limits, max_velocity: None, max_acceleration: None, max_jerk: None, servo: None }
}

const fn within(min: f64, max: f64) -> Joint<'static> {
    joint(Some(Limits { min, max }))
}

const WINDINGS: [Winding<'static>; 2] =
    [Winding { joint: 0, turn: TAU, carries: &[] }, Winding { joint: 1, turn: TAU, carries: &[] }];

fn solution(q: [f64; 2]) -> Solution<2> {
    Solution { q, position_error: 0.0, rotation_error: 0.0, free: None, branch: dh_core::Branch::UNKNOWN }
}

fn only(q: [f64; 2]) -> Solutions<2> {
    Solutions::one(solution(q))
}

fn nowhere(_: &[f64; 2]) -> [f64; 3] {
    panic!("no rule asks for the tool point")
}

fn close(got: [f64; 2], wanted: [f64; 2]) {
    assert!(got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{got:?} is not {wanted:?}");
}

#[test]
fn all_windings_into_wide_limits_are_found() {
    let joints = [within(-TAU, TAU), within(-1.0, 3.0 * TAU)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    let found: Vec<_> = solution([0.5, -0.5]).windings(&rules).collect();
    let wanted = [
        [0.5 - TAU, -0.5],
        [0.5 - TAU, TAU - 0.5],
        [0.5 - TAU, 2.0 * TAU - 0.5],
        [0.5 - TAU, 3.0 * TAU - 0.5],
        [0.5, -0.5],
        [0.5, TAU - 0.5],
        [0.5, 2.0 * TAU - 0.5],
        [0.5, 3.0 * TAU - 0.5],
    ];
    assert_eq!(found.len(), wanted.len());
    for (got, wanted) in found.into_iter().zip(wanted) {
        close(got, wanted);
    }
    // A whole turn exactly: both ends count.
    let joints = [within(-PI, PI), joint(None)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    assert_eq!(solution([PI, 9.0]).windings(&rules).collect::<Vec<_>>(), [[-PI, 9.0], [PI, 9.0]]);
    let joints = [within(1.0, 2.0), joint(None)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    assert_eq!(solution([0.5, 0.0]).windings(&rules).count(), 0);
}

#[test]
fn windings_carry_coupled_joints() {
    let windings = [
        Winding { joint: 0, turn: TAU, carries: &[(1, -PI)] },
        Winding { joint: 1, turn: TAU, carries: &[] },
    ];
    let joints = [within(-7.0, 7.0), within(-3.5, 3.5)];
    let rules = Rules::of_joints(&joints, &windings);
    let found: Vec<_> = solution([0.2, 0.5]).windings(&rules).collect();
    assert_eq!(found.len(), 3);
    for (got, wanted) in
        found.into_iter().zip([[0.2 - TAU, 0.5 + PI - TAU], [0.2, 0.5], [0.2 + TAU, 0.5 - PI]])
    {
        close(got, wanted);
    }
    let seed = [6.0, -2.0];
    let near = only([0.2, 0.5]).within(&rules, nowhere, Some(&seed)).unwrap();
    close(near[0].q, [0.2 + TAU, 0.5 - PI]);
}

#[test]
fn the_representative_is_nearest_to_the_seed_or_to_the_middle() {
    let joints = [within(-TAU, TAU), within(0.0, 2.0 * TAU)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    let start = only([3.0, -1.0]);
    let middle = start.clone().within(&rules, nowhere, None).unwrap();
    close(middle[0].q, [3.0, TAU - 1.0]);
    let seeded = start.clone().within(&rules, nowhere, Some(&[-3.0, 12.0])).unwrap();
    close(seeded[0].q, [3.0 - TAU, 2.0 * TAU - 1.0]);
    // Without limits: as near to the seed as turns go.
    let joints = [joint(None), joint(None)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    let seeded = start.within(&rules, nowhere, Some(&[100.0, -100.0])).unwrap();
    close(seeded[0].q, [3.0 + 15.0 * TAU, -1.0 - 16.0 * TAU]);
}

#[test]
fn with_a_seed_the_nearest_comes_first_and_without_the_order_stays() {
    let mut both = only([1.0, 1.0]);
    both.push(solution([-1.0, -1.0]), &WINDINGS);
    let joints = [within(-3.0, 3.0), within(-3.0, 3.0)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    assert_eq!(both.clone().within(&rules, nowhere, None).unwrap()[0].q, [1.0, 1.0]);
    assert_eq!(both.within(&rules, nowhere, Some(&[-0.5, 0.0])).unwrap()[0].q, [-1.0, -1.0]);
}

#[test]
fn a_limit_on_a_sum_chooses_another_winding() {
    let joints = [within(-TAU, TAU), within(-TAU, TAU)];
    let sums = [SumLimit { terms: &[(0, 1.0), (1, 1.0)], range: Limits { min: -1.0, max: 1.0 } }];
    let rules = Rules { sums: &sums, ..Rules::of_joints(&joints, &WINDINGS) };
    let found = only([3.0, 3.0]).within(&rules, nowhere, None).unwrap();
    let [q1, q2] = found[0].q;
    assert!((q1 + q2 - (6.0 - TAU)).abs() < 1e-12, "{q1} {q2}");
    // A joint without limits is wound too, if a sum asks for it.
    let joints = [joint(None), within(-3.1, 3.1)];
    let rules = Rules { sums: &sums, ..Rules::of_joints(&joints, &WINDINGS) };
    close(only([3.0, 3.0]).within(&rules, nowhere, None).unwrap()[0].q, [3.0 - TAU, 3.0]);
    let error = only([1.0, 3.0]).within(&rules, nowhere, None).unwrap_err();
    assert_eq!(error, IkError::Forbidden { rule: Rule::Sum { index: 0, value: 4.0, min: -1.0, max: 1.0 } });
}

#[test]
fn none_inside_the_limits_names_the_nearest_to_being_allowed() {
    let joints = [within(-1.0, 1.0), within(4.0, 5.0)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    let mut all = only([2.0, -1.5]);
    all.push(solution([1.25, -1.5]), &WINDINGS);
    all.push(solution([0.0, 2.0]), &WINDINGS);
    let error = all.within(&rules, nowhere, None).unwrap_err();
    assert_eq!(error, IkError::OutsideLimits { joint: 0, value: 1.25, min: -1.0, max: 1.0 });
    // The value named is the winding nearest to the limits, from below or from above.
    let outside = |q2: f64| match only([0.0, q2]).within(&rules, nowhere, None) {
        Err(IkError::OutsideLimits { joint: 1, value, .. }) => value,
        other => panic!("{other:?}"),
    };
    assert!((outside(3.5) - 3.5).abs() < 1e-12);
    assert!((outside(-0.5) - (TAU - 0.5)).abs() < 1e-12);
}

#[test]
fn rules_come_after_the_limits() {
    let joints = [within(-1.0, 1.0), within(-1.0, 1.0)];
    let bounds = [Bound { axis: Axis::X, side: Side::Min, value: 0.0 }];
    let rules = Rules { bounds: &bounds, ..Rules::of_joints(&joints, &WINDINGS) };
    let mut all = only([-0.5, 0.0]);
    all.push(solution([1.1, 0.0]), &WINDINGS);
    let at = |q: &[f64; 2]| [q[0], 0.0, 0.0];
    let error = all.clone().within(&rules, at, None).unwrap_err();
    assert_eq!(error, IkError::Forbidden { rule: Rule::Bound { bound: bounds[0], value: -0.5 } });
    all.push(solution([0.5, 0.0]), &WINDINGS);
    let allowed = all.within(&rules, at, None).unwrap();
    assert_eq!((allowed.len(), allowed[0].q), (1, [0.5, 0.0]));
}

#[test]
fn a_value_on_its_limit_is_put_there() {
    let joints = [within(-1.0, 1.0), joint(None)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    let allowed = only([1.0 + 1e-14, 0.0]).within(&rules, nowhere, None).unwrap();
    assert_eq!(allowed[0].q[0], 1.0);
    assert!(only([1.0 + 1e-9, 0.0]).within(&rules, nowhere, None).is_err());
}

#[test]
fn single_precision_selects_too() {
    let joint: Joint<'static, f32> = Joint {
        name: "",
        kind: JointKind::Revolute,
        limits: Some(Limits { min: 0.0, max: 6.0 }),
        max_velocity: None,
        max_acceleration: None,
        max_jerk: None,
        servo: None,
    };
    let windings = [Winding { joint: 0, turn: core::f32::consts::TAU, carries: &[] }];
    let joints = [joint];
    let rules = Rules::of_joints(&joints, &windings);
    let only = Solutions::one(Solution {
        q: [-1.0_f32],
        position_error: 0.0,
        rotation_error: 0.0,
        free: None,
        branch: dh_core::Branch::UNKNOWN,
    });
    let q = only.within(&rules, |_| [0.0; 3], None).unwrap()[0].q[0];
    assert!((q - (core::f32::consts::TAU - 1.0)).abs() < 1e-6);
}

#[test]
fn sets_of_any_number_of_joints_select_alike() {
    let joints = [within(0.0, TAU), within(-3.0, 3.0)];
    let rules = Rules::of_joints(&joints, &WINDINGS);
    let mut both = only([-1.0, 0.5]);
    both.push(solution([1.0, -0.5]), &WINDINGS);
    let mut set = SolutionSet::from_solutions(&both);
    assert_eq!((set.dof(), set.len(), set.get(1).unwrap().q), (2, 2, &[1.0, -0.5][..]));
    assert_eq!(set.nearest(&[0.9, 0.0]).unwrap().q, [1.0, -0.5]);
    let seed = [1.0, 0.0];
    set.within(&rules, |_| unreachable!(), Some(&seed)).unwrap();
    let fixed = both.within(&rules, nowhere, Some(&seed)).unwrap();
    assert!(set.iter().zip(&fixed).all(|(a, b)| a.q == b.q));
    assert!(matches!(set.within(&rules, |_| [0.0; 3], Some(&[0.0])), Err(IkError::Length(_))));
    assert!(set.is_empty() && set.nearest(&seed).is_none());
}
