//! Every engine against the oracle: shipped tables, random tables, tables as calibration leaves them.

use dh_core::Frame;
use dh_tests::engine;
use dh_tests::engine::forwards::{compare, difference, tolerance};
use dh_tests::oracle::Oracle;
use dh_tests::random::{any_arm, calibrated_arm};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

#[test]
fn shipped_tables() {
    for name in dh_robots::names() {
        let oracle = Oracle::shipped(name).unwrap();
        let engine = engine::shipped(name).unwrap();
        assert_eq!(engine.dof(), oracle.dof(), "{name}");
        assert_eq!(engine.rows(), oracle.chain().rows.len(), "{name}");
        let mut runner = TestRunner::new(ProptestConfig::with_cases(60));
        let values = prop::collection::vec(-3.2..3.2, oracle.dof());
        runner
            .run(&values, |q| {
                compare(&*engine, &oracle, &q, tolerance(&oracle))
                    .map_err(|error| TestCaseError::fail(format!("{name}: {error}")))
            })
            .unwrap();
    }
}

#[test]
fn limits_and_names_of_shipped_tables() {
    for name in dh_robots::names() {
        let oracle = Oracle::shipped(name).unwrap();
        let engine = engine::shipped(name).unwrap();
        let chain = oracle.chain();
        for (joint, &row) in engine.joints().iter().zip(&chain.joints) {
            let row = &chain.rows[row];
            assert_eq!(joint.name, row.name, "{name}");
            let found = joint.limits.map(|limits| (limits.min, limits.max));
            let close = match (found, row.limits) {
                (Some(a), Some(b)) => {
                    (a.0 - b.0).abs().max((a.1 - b.1).abs()) < 1e-15 * (1.0 + b.1.abs() + b.0.abs())
                }
                (None, None) => true,
                _ => false,
            };
            assert!(close, "{name}, {}: {found:?} for {:?}", row.name, row.limits);
        }
        for (pose, q) in &chain.poses {
            assert!(engine.check(q).is_ok(), "{name}: {pose}: {}", engine.check(q).unwrap_err());
        }
    }
}

#[test]
fn random_tables() {
    // A table goes through the whole compiler: PROPTEST_CASES=2000 where there is time.
    let more = std::env::var_os("PROPTEST_CASES").is_some();
    let config = if more { ProptestConfig::default() } else { ProptestConfig::with_cases(40) };
    let mut runner = TestRunner::new(config);
    runner
        .run(&any_arm(), |arm| {
            let oracle = Oracle::read(&arm.text).map_err(TestCaseError::fail)?;
            let engine = engine::interpreter(&arm.text).map_err(TestCaseError::fail)?;
            compare(&*engine, &oracle, &arm.q, tolerance(&oracle)).map_err(TestCaseError::fail)
        })
        .unwrap();
}

/// Two constant turns between sliding joints, one of them no multiple of 15 degrees: their sines have names of their
/// own.
#[test]
fn turned_slides() {
    let text = "[robot]\nname = \"Slides\"\nconvention = \"modified\"\n\
        [[joint]]\ntype = \"prismatic\"\ntheta = -0.00001666\n\
        [[joint]]\ntype = \"prismatic\"\ntheta = \"6 * pi / 12\"\n\
        [[joint]]\na = 0.3\ntype = \"prismatic\"\n";
    let oracle = Oracle::read(text).unwrap();
    let engine = engine::interpreter(text).unwrap();
    compare(&*engine, &oracle, &[0.1, -0.2, 0.3], tolerance(&oracle)).unwrap();
}

/// Offsets of ten kilometres, whose own last place is 2e-12 m, must not cost the digits that they have.
#[test]
fn calibrated_tables() {
    let mut runner = TestRunner::new(ProptestConfig::with_cases(40));
    runner
        .run(&calibrated_arm(), |arm| {
            let oracle = Oracle::read(&arm.text).map_err(TestCaseError::fail)?;
            let engine = engine::interpreter(&arm.text).map_err(TestCaseError::fail)?;
            let off = difference(
                &engine.fk(&arm.q).map_err(|e| TestCaseError::fail(e.to_string()))?,
                &oracle.fk(&arm.q),
            );
            prop_assert!(off < 1e-12, "off by {:e}", off);
            Ok(())
        })
        .unwrap();
}

/// A right angle in the table is one in the result: what is exactly 0, 1 or a sum of lengths comes out as that.
#[test]
fn right_angles_leave_no_rounding_behind() {
    let engine = engine::shipped("crane_x7").unwrap();
    let frame = engine.fk(&[0.0; 7]).unwrap();
    assert_eq!(frame.rotation, Frame::<f64>::IDENTITY.rotation);
    assert_eq!(frame.translation[..2], [0.0, 0.0]);
    let engine = engine::shipped("scara").unwrap();
    let frame = engine.fk(&[0.4, -1.1, 0.1, 0.7]).unwrap();
    assert_eq!([frame.rotation[0][2], frame.rotation[1][2], frame.rotation[2][2]], [0.0, 0.0, -1.0]);
}

#[test]
fn wrong_lengths_are_errors() {
    let engine = engine::shipped("ur5").unwrap();
    assert!(engine.fk(&[0.0; 5]).is_err());
    assert!(engine.fk_flange(&[0.0; 7]).is_err());
    assert!(engine.jacobian_into(&[0.0; 6], &mut [[0.0; 6]; 5]).is_err());
    assert!(engine.frames_into(&[0.0; 6], &mut [Frame::IDENTITY; 6]).is_err());
    assert!(engine.check(&[]).is_err());
}
