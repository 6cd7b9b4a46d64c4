//! Units: files of one arm's zeros and signs.

#![expect(clippy::unwrap_used, reason = "tests")]

use dh_drivers::driver::JointMap;
use dh_drivers::unit::{CalibrationError, Unit};
use dh_runtime::dh_robot;
use proptest::prelude::*;

#[dh_robot("planar2r")]
struct Planar;

#[dh_robot("mycobot")]
struct MyCobot;

fn map() -> JointMap {
    JointMap::of_table(&Planar).unwrap()
}

/// The planar arm put together wrongly: servo 1 turned by 100 ticks, servo 2 by -7 and the other way round.
fn says(q: [f64; 2]) -> Vec<f64> {
    let ticks = 4096.0 / std::f64::consts::TAU;
    vec![2148.0 + ticks * q[0], 2041.0 - ticks * q[1]]
}

#[test]
fn two_poses_give_zeros_and_signs() {
    let (first, second) = ([0.3, -0.4], [1.0, 0.9]);
    let unit =
        Unit::measured("Planar 2R", &map(), (&first, &says(first)), Some((&second, &says(second)))).unwrap();
    let mut calibrated = map();
    unit.apply(&mut calibrated).unwrap();
    for q in [[0.0, 0.0], [-1.2, 2.0]] {
        let device: Vec<f64> = calibrated.joints.iter().zip(q).map(|(joint, q)| joint.to_device(q)).collect();
        assert!(device.iter().zip(says(q)).all(|(a, b)| (a - b).abs() < 1e-9), "{device:?}");
    }
    // What the register takes bounds the motion of this arm by its own zero: (4095 - 2148) ticks upwards.
    let limits = calibrated.joints[0].limits().unwrap();
    assert!((limits.max - 1947.0 * std::f64::consts::TAU / 4096.0).abs() < 1e-12);
    assert_eq!(Unit::parse(&unit.to_toml()).unwrap(), unit);
}

#[test]
fn one_pose_gives_zeros_and_leaves_signs() {
    let unit = Unit::measured("Planar 2R", &map(), (&[0.0, 0.0], &[2148.0, 2041.0]), None).unwrap();
    assert_eq!(
        unit.joints.iter().map(|joint| (joint.zero, joint.reversed)).collect::<Vec<_>>(),
        [(2148.0, false), (2041.0, false)]
    );
}

#[test]
fn a_servo_that_counts_otherwise_is_found() {
    let error = Unit::measured("", &map(), (&[0.0, 0.0], &[0.0, 0.0]), Some((&[1.0, 1.0], &[652.0, 300.0])));
    assert!(matches!(error, Err(CalibrationError::Scale { joint, .. }) if joint == "J2"));
    let error = Unit::measured("", &map(), (&[0.0, 0.0], &[0.0]), None);
    assert_eq!(error, Err(CalibrationError::Length { expected: 2, got: 1 }));
}

#[test]
fn a_unit_is_for_one_table() {
    let unit = Unit::measured("Planar 2R", &map(), (&[0.0, 0.0], &[2148.0, 2041.0]), None).unwrap();
    let mut other = JointMap::of_table(&MyCobot).unwrap();
    let before = other.clone();
    let message = unit.apply(&mut other).unwrap_err().to_string();
    assert!(message.contains("calibrate anew") && message.contains("Planar 2R"), "{message}");
    assert_eq!(other, before);
    let mut renamed = map();
    renamed.joints[1].name = "elbow".to_owned();
    assert!(unit.apply(&mut renamed).unwrap_err().to_string().contains("J1, J2"));
}

#[test]
fn mistakes_are_told_with_their_place() {
    let good = "robot = \"a\"\nfingerprint = \"1f\"\n[[joint]]\nname = \"J1\"\nzero = 1.5\nsign = -1\n";
    assert!(Unit::parse(good).unwrap().joints[0].reversed);
    for (from, to, place) in [
        ("1f", "xyz", Some((2, 15))),
        ("sign = -1", "sign = 2", Some((6, 8))),
        ("zero = 1.5", "zero = \"a\"", Some((5, 8))),
        ("zero = 1.5", "zero = inf", Some((5, 8))),
        ("zero = 1.5\n", "", Some((3, 1))),
        ("name", "nome", Some((4, 1))),
        ("robot = \"a\"\n", "", Some((1, 1))),
        ("robot = \"a\"", "format = 2\nrobot = \"a\"", Some((1, 10))),
        ("robot = \"a\"", "robot = ", Some((1, 9))),
    ] {
        assert!(good.contains(from));
        let error = Unit::parse(&good.replace(from, to)).unwrap_err();
        assert_eq!(error.place, place, "{to}: {error}");
    }
}

proptest! {
    #[test]
    fn nothing_that_is_written_makes_it_panic(text in "\\PC*|(\\[\\[joint\\]\\]|name|zero|sign|=|1|\"a\"|\n| )*") {
        let _ = Unit::parse(&text);
    }

    #[test]
    fn what_is_written_is_read(name in "\\PC{0,8}", zero in -1e5..1e5, reversed: bool, fingerprint: u64) {
        let joints = vec![dh_drivers::unit::UnitJoint { name: name.clone(), zero, reversed }];
        let unit = Unit { robot: name, fingerprint, joints };
        prop_assert_eq!(Unit::parse(&unit.to_toml()).unwrap(), unit);
    }
}
