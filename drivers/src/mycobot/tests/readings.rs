//! Readings that cannot be, from a recording.

use std::sync::Arc;

use super::super::{Model, MyCobot, Request};
use super::{Arm, TENTH};
use crate::clock::VirtualClock;
use crate::driver::{Cause, Driver, DriverError, JointMap, State};
use crate::port::{Exchange, Recorded};

const MOVING: &[u8] = b"\xfe\xfe\x02\x2b\xfa";
const ANGLES: &[u8] = b"\xfe\xfe\x02\x20\xfa";
const ERROR: &[u8] = b"\xfe\xfe\x02\x07\xfa";

/// The state that is read from these replies to questions for the angles (deg of the device), of an arm at rest.
fn state(angles: &[[f64; 6]]) -> (Result<State, DriverError>, u64) {
    let resting = || Exchange { request: MOVING.to_vec(), reply: b"\xfe\xfe\x03\x2b\x00\xfa".to_vec() };
    let mut exchanges = vec![resting()];
    for (index, angles) in angles.iter().enumerate() {
        let mut reply = vec![0xFE, 0xFE, 0x0E, 0x20];
        reply.extend(angles.iter().flat_map(|angle| ((angle * 100.0).round() as i16).to_be_bytes()));
        reply.push(0xFA);
        exchanges.push(Exchange { request: ANGLES.to_vec(), reply });
        // A reading out of range is asked again at once.
        let out = angles.iter().any(|angle| angle.abs() > 182.0);
        if index > 0 && !out {
            exchanges.push(resting());
        }
    }
    exchanges.push(Exchange { request: ERROR.to_vec(), reply: b"\xfe\xfe\x03\x07\x00\xfa".to_vec() });
    let port = Recorded::new(Arc::new(VirtualClock::new()), exchanges);
    let mut driver = MyCobot::new(Box::new(port), JointMap::of_table(&Arm).unwrap(), Model::Pi).unwrap();
    let state = driver.read_state();
    (state, driver.line().rejected)
}

const HERE: [f64; 6] = [-90.0, 0.0, 10.0, 0.0, 0.0, 0.0];

#[test]
fn two_readings_that_agree_are_believed() {
    let (state, rejected) = state(&[HERE, HERE]);
    assert!((state.unwrap().joints[2].position - 10_f64.to_radians()).abs() < TENTH);
    assert_eq!(rejected, 0);
}

#[test]
fn one_that_is_alone_is_not() {
    let there = [-90.0, 0.0, 11.28, 0.0, 0.0, 0.0];
    let (state, rejected) = state(&[HERE, there, HERE, HERE]);
    assert!((state.unwrap().joints[2].position - 10_f64.to_radians()).abs() < TENTH);
    assert_eq!(rejected, 2);
}

#[test]
fn angles_that_no_joint_has_are_read_again() {
    let out = [-90.0, 0.0, 300.0, 0.0, 0.0, 0.0];
    let (state, rejected) = state(&[HERE, out, HERE]);
    assert!((state.unwrap().joints[2].position - 10_f64.to_radians()).abs() < TENTH);
    assert_eq!(rejected, 1);
}

#[test]
fn a_joint_that_says_it_is_out_of_range_is_named() {
    let out = [-90.0, 0.0, 300.0, 0.0, 0.0, 0.0];
    let error = state(&[out, out]).0.unwrap_err();
    assert_eq!(
        error.to_string(),
        "recording, J3, get_angles: 300 is not in -150 to 150, which the servo takes"
    );
}

#[test]
fn readings_that_never_agree_are_an_error_with_both() {
    let step = |by: f64| HERE.map(|angle| angle + by);
    let error = state(&[HERE, step(1.0), step(2.0), step(3.0), step(4.0)]).0.unwrap_err();
    let Cause::Unconfirmed { first, second } = error.cause else { panic!("{error}") };
    assert_eq!(error.joint.as_deref(), Some("J1"));
    assert!((second - first - 1_f64.to_radians()).abs() < 1e-9, "{error}");
}

/// No reply to a move by an amount: it may have been made, and is not asked for again.
#[test]
fn a_relative_move_is_never_sent_again() {
    let request = Request::jog_increment_angle(2, -5.5, 20).unwrap();
    for reply in [&b""[..], b"\xfe\xfe\x03\x33\x01", b"\xfe\xfe\x03\x33\x00\xfa"] {
        let recorded = Exchange { request: request.encode(), reply: reply.to_vec() };
        let again = Exchange { request: request.encode(), reply: b"\xfe\xfe\x03\x33\x01\xfa".to_vec() };
        let port = Recorded::new(Arc::new(VirtualClock::new()), [recorded, again]);
        let mut driver = MyCobot::new(Box::new(port), JointMap::of_table(&Arm).unwrap(), Model::Pi).unwrap();
        let error = driver.link.acknowledge(&request).unwrap_err();
        assert_eq!((error.joint.as_deref(), error.command), (Some("J2"), "jog_increment_angle"));
        assert_eq!(driver.line().requests, 1);
    }
}
