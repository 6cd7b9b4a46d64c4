//! The random tables are tables, and reach what they should reach.

use std::cell::Cell;

use dh_tests::oracle::Oracle;
use dh_tests::random::{any_arm, calibrated_arm};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

#[test]
fn every_table_is_read_and_every_part_of_the_format_occurs() {
    let parts = [
        "\"standard\"",
        "\"modified\"",
        "prismatic",
        "fixed",
        "couple",
        "direction = -1",
        "beta",
        "[base]",
        "[tool]",
        "rpy",
        "quaternion",
        "\"mm\"",
        "\"deg\"",
        "pi / 12",
        "atan2",
        " mm\"",
        " deg\"",
        "sqrt",
    ];
    let seen = Cell::new([false; 18]);
    let mut runner = TestRunner::new(ProptestConfig::with_cases(300));
    runner
        .run(&any_arm(), |arm| {
            let oracle = Oracle::read(&arm.text).map_err(TestCaseError::fail)?;
            prop_assert_eq!(oracle.dof(), arm.q.len());
            prop_assert_eq!(oracle.jacobian(&arm.q).len(), arm.q.len());
            prop_assert!(oracle.fk(&arm.q).iter().flatten().all(|x| x.is_finite()));
            let mut now = seen.get();
            for (seen, part) in now.iter_mut().zip(parts) {
                *seen |= arm.text.contains(part);
            }
            seen.set(now);
            Ok(())
        })
        .unwrap();
    let missing: Vec<_> = parts.iter().zip(seen.get()).filter(|(_, seen)| !seen).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn calibrated_arms_have_huge_offsets_and_the_reach_of_an_arm() {
    let longest = Cell::new(0.0_f64);
    let mut runner = TestRunner::new(ProptestConfig::with_cases(300));
    runner
        .run(&calibrated_arm(), |arm| {
            let oracle = Oracle::read(&arm.text).map_err(TestCaseError::fail)?;
            let pose = oracle.fk(&arm.q);
            let distance = (0..3).map(|i| pose[i][3].powi(2)).sum::<f64>().sqrt();
            prop_assert!(distance < 1.5, "{distance}");
            longest.set(longest.get().max(oracle.reach()));
            Ok(())
        })
        .unwrap();
    assert!(longest.get() > 5e3, "{}", longest.get());
}
