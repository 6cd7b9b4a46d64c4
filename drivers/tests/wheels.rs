//! The joystick's published cases.

#![allow(clippy::unwrap_used, reason = "a broken case is a broken test")]

use dh_drivers::wheel_speeds;
use serde_json::Value;

const CASES: &str = include_str!("../../tests/cases/rtm2r.json");

#[test]
fn wheel_speeds_are_the_published_ones() {
    let file: Value = serde_json::from_str(CASES).unwrap();
    let cases = file["joystick"]["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 8);
    let pair = |value: &Value| [value[0].as_f64().unwrap(), value[1].as_f64().unwrap()];
    for case in cases {
        let gain = case["k"].as_f64().unwrap();
        let (stick, expected) = (pair(&case["stick"]), pair(&case["wheels"]));
        for (wheel, value) in wheel_speeds(stick, gain).into_iter().zip(expected) {
            assert!((wheel - value).abs() < 3e-16, "{stick:?}: {wheel}, not {value}");
        }
        let r = stick[0].hypot(stick[1]);
        let [left, right] = wheel_speeds(stick, 2.5);
        assert!(
            (left.hypot(right) - 2.5 * r).abs() < 1e-15,
            "turning the stick's direction keeps its length"
        );
    }
}
