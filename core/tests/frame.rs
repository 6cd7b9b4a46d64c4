//! Frames, quaternions and the measure of rotation errors.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod random;

use core::f64::consts::{FRAC_PI_2, PI};

use dh_core::{Float, Frame, rotation_error};
use random::Random;

fn random_frame<S: Float>(random: &mut Random) -> Frame<S> {
    let translation = [0; 3].map(|_| random.between(-1.0, 1.0));
    Frame::from_rpy(translation, [0; 3].map(|_| random.between(-3.1, 3.1)))
}

fn distance<S: Float>(a: &Frame<S>, b: &Frame<S>) -> S {
    a.rows().iter().zip(b.rows()).map(|(a, b)| (*a - b).abs()).fold(S::ZERO, Float::max)
}

fn round_trips<S: Float>() {
    let mut random = Random(4);
    let tolerance = S::from_f64(8.0) * S::EPSILON;
    for _ in 0..2000 {
        let (a, b): (Frame<S>, Frame<S>) = (random_frame(&mut random), random_frame(&mut random));
        assert!(a.rigidity_error() <= tolerance);
        assert!(distance(&(a * a.inverse()), &Frame::IDENTITY) <= tolerance);
        let point = [0; 3].map(|_| random.between(-1.0, 1.0));
        let there = (a * b).transform_point(point);
        let steps = a.transform_point(b.transform_point(point));
        assert!(there.iter().zip(steps).all(|(x, y)| (*x - y).abs() <= tolerance));
        assert_eq!(Frame::from_rows(a.rows()), a);
        let quaternion = a.quaternion();
        assert!(quaternion[3] >= S::ZERO);
        let again = Frame::from_quaternion(a.translation, quaternion).unwrap();
        assert!(distance(&a, &again) <= tolerance, "{a:?}");
        assert!(distance(&a, &Frame::from_rpy(a.translation, a.rpy())) <= tolerance, "{a:?}");
    }
}

#[test]
fn random_frames_round_trip() {
    round_trips::<f64>();
    round_trips::<f32>();
}

#[test]
fn every_branch_of_the_quaternion_keeps_its_digits() {
    // Turns by nearly pi about each axis, and in between, where three of the four components are near 0.
    for axis in 0..3 {
        for angle in [0.0, 1e-9, 1.0, 2.0, 2.2, PI - 1e-9, PI, -PI, -PI + 1e-9, -2.2, -1.0] {
            let mut rpy = [0.0; 3];
            rpy[axis] = angle;
            let [x, y, z, w] = Frame::from_rpy([0.0; 3], rpy).quaternion();
            assert!(w >= 0.0 && w.is_sign_positive(), "{w}");
            let sine = [x, y, z][axis];
            let (wanted_sine, wanted_cosine): (f64, f64) = (0.5 * angle).sin_cos();
            let sign = if wanted_cosine < 0.0 { -1.0 } else { 1.0 };
            // At a turn by pi either sign will do.
            let sine = if w < 1e-12 { sine * sine.signum() * wanted_sine.signum() } else { sine };
            assert!((sine - sign * wanted_sine).abs() < 1e-15, "axis {axis} angle {angle}");
            assert!((w - sign * wanted_cosine).abs() < 1e-15, "axis {axis} angle {angle}");
        }
    }
}

#[test]
fn quaternions_of_any_length_do_but_none() {
    let unit = Frame::from_quaternion([0.0; 3], [0.5, 0.5, 0.5, 0.5]).unwrap();
    for length in [1e-200, 3.0, -1e200] {
        let scaled = Frame::from_quaternion([0.0; 3], [length; 4]).unwrap();
        assert!(distance(&unit, &scaled) < 1e-15);
    }
    for bad in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0, 1.0]] {
        assert_eq!(Frame::from_quaternion([0.0; 3], bad), None);
    }
}

#[test]
fn rpy_at_a_quarter_turn_of_pitch_still_gives_the_rotation() {
    for pitch in [FRAC_PI_2, -FRAC_PI_2] {
        let frame = Frame::from_rpy([0.0; 3], [0.4, pitch, -0.7]);
        let [roll, _, _] = frame.rpy();
        assert_eq!(roll, 0.0);
        assert!(distance(&frame, &Frame::from_rpy([0.0; 3], frame.rpy())) < 1e-15);
    }
}

fn measures<S: Float>(angles: &[f64]) {
    let mut random = Random(5);
    for angle in angles {
        let a: Frame<S> = random_frame(&mut random);
        for rpy in [[*angle, 0.0, 0.0], [0.0, *angle, 0.0], [0.0, 0.0, *angle]] {
            let b = a * Frame::from_rpy([S::ZERO; 3], rpy.map(S::from_f64));
            let error = rotation_error(&a.rotation, &b.rotation) - S::from_f64(*angle);
            assert!(error.abs() <= S::from_f64(8.0) * S::EPSILON, "{angle}: off by {error}");
        }
    }
}

#[test]
fn rotation_errors_are_accurate_from_0_to_pi() {
    let angles = [0.0, 1e-15, 1e-9, 2e-4, 3e-4, 0.1, 1.0, FRAC_PI_2, 3.0, PI - 1e-4, PI - 1e-9, PI];
    measures::<f64>(&angles);
    measures::<f32>(&angles);
    // Relative to itself where the matrices differ by no more than that.
    let tiny = Frame::from_rpy([0.0; 3], [1e-13, 0.0, 0.0]);
    let error = rotation_error(&Frame::IDENTITY.rotation, &tiny.rotation);
    assert!((error / 1e-13 - 1.0).abs() < 1e-15);
}

#[test]
fn what_is_not_rigid_is_measured() {
    let mut frame: Frame = Frame::IDENTITY;
    frame.rotation[0][0] = 1.01;
    assert!((frame.rigidity_error() - 0.0201).abs() < 1e-15);
    frame.rotation[0][0] = -1.0;
    assert_eq!(frame.rigidity_error(), 2.0, "a reflection");
    for entry in 0..9 {
        let mut frame: Frame = Frame::IDENTITY;
        frame.rotation[entry / 3][entry % 3] = f64::NAN;
        assert!(frame.rigidity_error().is_nan());
    }
}

#[test]
fn angles_wrap_into_one_turn() {
    let mut random = Random(6);
    for _ in 0..2000 {
        let angle: f64 = random.between(-100.0, 100.0);
        let wrapped = Float::wrap_angle(angle);
        assert!(wrapped > -PI && wrapped <= PI);
        assert!((wrapped.sin() - angle.sin()).abs() < 1e-13 && (wrapped.cos() - angle.cos()).abs() < 1e-13);
    }
    assert_eq!(Float::wrap_angle(-PI), PI);
    assert_eq!(Float::wrap_angle(3.0 * PI), PI);
    assert_eq!(Float::wrap_angle(-core::f32::consts::PI), core::f32::consts::PI);
    assert!(Float::wrap_angle(f64::INFINITY).is_nan());
    assert_eq!((Float::min(f64::NAN, 1.0), Float::max(1.0, f64::NAN)), (1.0, 1.0));
}
