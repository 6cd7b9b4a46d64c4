//! Limits and workspace rules: every violation is told, and what is on a limit is inside.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use core::f64::consts::{PI, TAU};

use dh_core::{
    Axis, Bound, Joint, JointKind, KeepOut, LengthError, Limits, Rule, Rules, Servo, Side, SumLimit,
    Violation, Winding,
};

const fn joint(name: &'static str, kind: JointKind, limits: Option<Limits>) -> Joint<'static> {
    Joint { name, kind, limits, max_velocity: None, max_acceleration: None, max_jerk: None, servo: None }
}

const JOINTS: [Joint<'static>; 3] = [
    joint("J1", JointKind::Revolute, Some(Limits { min: -1.0, max: 2.0 })),
    joint("J2", JointKind::Revolute, None),
    joint("lift", JointKind::Prismatic, Some(Limits { min: 0.0, max: 0.25 })),
];

const RULES: Rules<'static> = Rules {
    joints: &JOINTS,
    sums: &[SumLimit { terms: &[(0, 1.0), (1, -0.5)], range: Limits { min: -PI, max: PI } }],
    bounds: &[
        Bound { axis: Axis::Z, side: Side::Min, value: 0.015 },
        Bound { axis: Axis::X, side: Side::Max, value: 0.5 },
    ],
    keep_out: &[KeepOut { min: [-0.1, -0.1, -0.5], max: [0.6, 0.6, 0.2] }],
    windings: &[Winding { joint: 0, turn: TAU, carries: &[] }, Winding { joint: 1, turn: TAU, carries: &[] }],
};

#[test]
fn every_violation_is_listed_with_its_numbers() {
    let q = [3.0, -4.0, 0.5];
    let position = [0.55, 0.0, 0.01];
    let violations = RULES.check(&q, position).unwrap_err();
    let (z, x) = (RULES.bounds[0], RULES.bounds[1]);
    let expected = [
        Violation::OutsideLimits {
            joint: 0,
            name: "J1",
            kind: JointKind::Revolute,
            value: 3.0,
            min: -1.0,
            max: 2.0,
        },
        Violation::OutsideLimits {
            joint: 2,
            name: "lift",
            kind: JointKind::Prismatic,
            value: 0.5,
            min: 0.0,
            max: 0.25,
        },
        Violation::Forbidden(Rule::Sum { index: 0, value: 5.0, min: -PI, max: PI }),
        Violation::Forbidden(Rule::Bound { bound: z, value: 0.01 }),
        Violation::Forbidden(Rule::Bound { bound: x, value: 0.55 }),
        Violation::Forbidden(Rule::KeepOut { index: 0, position }),
    ];
    assert_eq!(violations.iter().collect::<Vec<_>>(), expected);
    assert_eq!(violations.q(), q);
    let text = violations.to_string();
    assert_eq!(text.matches(';').count(), expected.len() - 1, "{text}");
    for part in [
        "joint 1 (J1) is at 3.000000 rad",
        "joint 3 (lift) is at 0.500000 m",
        "sum 1",
        "z is 0.010000 m, below",
        "x is 0.550000 m, above",
        "box 1",
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
}

#[test]
fn what_is_allowed_breaks_nothing() {
    assert_eq!(RULES.check(&[0.0, 100.0 * 0.0, 0.1], [0.0, 0.0, 0.3]), Ok(()));
    // On the limits, and beyond them by a rounding.
    assert_eq!(RULES.check(&[2.0 + 4.0 * f64::EPSILON, 0.0, 0.0 - 1e-17], [0.5, 0.0, 0.2]), Ok(()));
    assert_eq!(RULES.check(&[2.0, 4.0 - 2.0 * PI - 1e-15, 0.25], [0.0, 0.0, 0.2 - 1e-17]), Ok(()));
    assert!(RULES.check(&[2.0 + 1e-9, 0.0, 0.1], [0.0, 0.0, 0.3]).is_err());
}

#[test]
fn values_that_are_no_numbers_are_violations() {
    for bad in [f64::NAN, f64::INFINITY] {
        let violations = RULES.check(&[0.0, bad, 0.5], [f64::NAN; 3]).unwrap_err();
        let all: Vec<_> = violations.iter().collect();
        assert_eq!(all.len(), 2, "{violations}");
        assert!(matches!(all[0], Violation::NotFinite { joint: 1, name: "J2", .. }));
        assert!(matches!(all[1], Violation::OutsideLimits { joint: 2, .. }));
    }
}

#[test]
fn a_wrong_number_of_values_is_a_violation() {
    for got in [0, 2, 4, 40] {
        let q = vec![9.0; got];
        let violations = RULES.check(&q, [0.0; 3]).unwrap_err();
        let expected = [Violation::Length(LengthError { expected: 3, got })];
        assert_eq!(violations.iter().collect::<Vec<_>>(), expected);
    }
}

#[test]
fn limits_and_servos_convert_and_intersect() {
    let limits = Limits { min: -1.0, max: 3.0 };
    assert_eq!((limits.middle(), limits.clamp(5.0), limits.clamp(-5.0)), (1.0, 3.0, -1.0));
    assert!(limits.contains(3.0) && !limits.contains(3.0 + 1e-15));
    assert_eq!(limits.intersection(&Limits { min: 4.0, max: 5.0 }), None);
    // Runs backwards: register 0 is at +2.048 rad.
    let range = Some(Limits { min: 0.0, max: 4095.0 });
    let servo = Servo { id: Some(3), scale: -1000.0, zero: 2048.0, range, model: Some("x") };
    assert_eq!((servo.to_device(2.048), servo.from_device(4048.0)), (0.0, -2.0));
    let reach = servo.limits().unwrap();
    assert_eq!((reach.min, reach.max), (-2.047, 2.048));
    let joint = Joint { limits: Some(limits), servo: Some(servo), ..JOINTS[0] };
    assert_eq!(joint.motion_limits(), Some(Limits { min: -1.0, max: 2.048 }));
    assert_eq!(JOINTS[1].motion_limits(), None);
}
