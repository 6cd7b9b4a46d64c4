//! Profiles against the closed form of the fastest motion from rest to rest.

use dh_drivers::motion::{Defaults, Dynamics, Profile};
use dh_runtime::Kinematics;
use proptest::prelude::*;

/// The least time (s) from rest to rest over a distance: seven stretches of constant jerk, of which those without jerk
/// vanish where the limit that they run at is not reached.
fn least_time(distance: f64, limits: Dynamics) -> f64 {
    let Dynamics { velocity: v, acceleration: a, jerk: j } = limits;
    // To velocity w and back to rest, and how far that goes.
    let ramp = |w: f64| if w * j < a * a { 2.0 * (w / j).sqrt() } else { w / a + a / j };
    let reaches = |w: f64| w * ramp(w);
    if reaches(v) <= distance {
        return 2.0 * ramp(v) + (distance - reaches(v)) / v;
    }
    // The distance grows with the velocity that is reached on the way.
    let (mut slow, mut fast) = (0.0, v);
    for _ in 0..200 {
        let middle = f64::midpoint(slow, fast);
        if reaches(middle) < distance { slow = middle } else { fast = middle }
    }
    2.0 * ramp(fast)
}

fn limits() -> impl Strategy<Value = Dynamics> {
    (-2.0..1.0, -1.0..2.0, -0.5..3.0).prop_map(|(v, a, j): (f64, f64, f64)| Dynamics {
        velocity: 10_f64.powf(v),
        acceleration: 10_f64.powf(a),
        jerk: 10_f64.powf(j),
    })
}

fn joints() -> impl Strategy<Value = Vec<(f64, f64, Dynamics)>> {
    let way = prop_oneof![1 => Just(0.0), 6 => (-6.0..0.8).prop_map(|x: f64| 10_f64.powf(x))];
    let joint = (-3.0..3.0, way, any::<bool>(), limits());
    let joint = joint
        .prop_map(|(start, way, back, limits)| (start, if back { start - way } else { start + way }, limits));
    proptest::collection::vec(joint, 1..=7)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_profile_takes_the_least_time_of_the_slowest_joint_and_keeps_all_limits(joints in joints()) {
        let (start, goal): (Vec<f64>, Vec<f64>) = joints.iter().map(|(start, goal, _)| (*start, *goal)).unzip();
        let limits: Vec<Dynamics> = joints.iter().map(|(.., limits)| *limits).collect();
        let profile = Profile::new(&start, &goal, &limits).unwrap();
        let slowest = joints.iter().map(|(start, goal, limits)| least_time((goal - start).abs(), *limits));
        let least = slowest.fold(0.0, f64::max);
        prop_assert!((profile.duration() - least).abs() <= 1e-9 * (least + 1e-9), "{} {least}", profile.duration());
        prop_assert_eq!(profile.at(0.0).0, start.clone());
        prop_assert_eq!(profile.at(profile.duration()).0, goal.clone());
        if profile.duration() == 0.0 {
            return Ok(());
        }
        let steps = 200;
        let dt = profile.duration() / f64::from(steps);
        let mut before = profile.at(0.0);
        for step in 1..=steps {
            let now = profile.at(f64::from(step) * dt);
            for (joint, (start, goal, limits)) in joints.iter().enumerate() {
                let (q, v) = (now.0[joint], now.1[joint]);
                prop_assert!(q >= start.min(*goal) - 1e-9 && q <= start.max(*goal) + 1e-9);
                prop_assert!(v.abs() <= limits.velocity * (1.0 + 1e-9));
                let (mean, change) = ((q - before.0[joint]) / dt, (v - before.1[joint]) / dt);
                prop_assert!(change.abs() <= limits.acceleration * (1.0 + 1e-6) + 1e-9 / dt);
                // The velocity is that of the positions, to half a step of acceleration.
                prop_assert!((mean - v).abs() <= limits.acceleration * dt + 1e-9 / dt);
            }
            before = now;
        }
    }
}

#[test]
fn what_cannot_move_has_no_profile() {
    let limits = Dynamics { velocity: 1.0, acceleration: 1.0, jerk: 1.0 };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for limits in [
            Dynamics { velocity: bad, ..limits },
            Dynamics { acceleration: bad, ..limits },
            Dynamics { jerk: bad, ..limits },
        ] {
            assert!(Profile::new(&[0.0], &[1.0], &[limits]).is_err(), "{limits:?}");
        }
    }
    assert!(Profile::new(&[0.0], &[f64::NAN], &[limits]).is_err());
    assert!(Profile::new(&[0.0], &[1.0, 2.0], &[limits]).is_err());
}

#[test]
fn defaults_are_those_of_the_documentation() {
    let joint = super::Planar.joints()[0];
    let limits = Dynamics::of_joint(&joint, &Defaults::default());
    assert_eq!(limits, Dynamics { velocity: 1.0, acceleration: 4.0, jerk: 40.0 });
    let joint = super::Cell.joints()[2];
    let limits = Dynamics::of_joint(&joint, &Defaults::default());
    assert_eq!(limits, Dynamics { velocity: 1.0, acceleration: 12.0, jerk: 40.0 });
}
