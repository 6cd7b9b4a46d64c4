//! Measures of joint travel, and following a path.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use dh_core::{IkError, LengthError, Norm, Solution, Solutions, TrackError, Travel, track};

fn solution(q: [f64; 2]) -> Solution<2> {
    Solution { q, position_error: 0.0, rotation_error: 0.0, free: None, branch: dh_core::Branch::UNKNOWN }
}

#[test]
fn norms_and_weights_decide_what_is_near() {
    let mut solutions = Solutions::one(solution([3.0, 0.0]));
    solutions.push(solution([2.0, 2.5]), &[]);
    let seed = [0.0, 0.0];
    let measured = |weights: &[f64], norm| solutions.nearest_by(&seed, &Travel { weights, norm }).q;
    assert_eq!(measured(&[], Norm::Squares), [3.0, 0.0]);
    assert_eq!(measured(&[], Norm::Greatest), [2.0, 2.5]);
    assert_eq!(measured(&[2.0, 0.1], Norm::Squares), [2.0, 2.5]);
    // Joints beyond the weights count as they are.
    assert_eq!(Travel { weights: &[0.0], norm: Norm::Squares }.between(&seed, &[7.0, -3.0]), 3.0);
    assert_eq!(Travel::<f32> { weights: &[], norm: Norm::Greatest }.between(&[1.0], &[-1.0]), 2.0);
    assert_eq!(solutions.nearest_by(&seed, &Travel::default()).q, solutions.nearest(&seed).q);
}

/// Both signs of the target are solutions; at 0 the branches meet.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "as targets are handed over")]
fn two_branches(target: &f64, seed: &[f64; 2]) -> Result<Solution<2>, IkError> {
    if target.abs() > 5.0 {
        return Err(IkError::NotFinite);
    }
    let mut solutions = Solutions::one(solution([*target, 1.0]));
    solutions.push(solution([-target, 1.0]), &[]);
    Ok(*solutions.nearest(seed))
}

#[test]
fn a_path_stays_on_its_branch_until_it_has_to_jump() {
    let mut out = [[0.0; 2]; 4];
    track(&[1.0, 1.2, 1.4, 1.6], &[-0.9, 1.0], 0.3, &mut out, two_branches).unwrap();
    assert_eq!(out.map(|[first, _]| first), [-1.0, -1.2, -1.4, -1.6]);
    let jump = track(&[1.0, 1.2, 3.0, 3.1], &[-0.9, 1.0], 0.3, &mut out, two_branches).unwrap_err();
    let TrackError::Jump { at: 2, joint: 0, by } = jump else { panic!("{jump:?}") };
    assert!((by + 1.8).abs() < 1e-12 && out[1] == [-1.2, 1.0], "{jump:?} {out:?}");
    let none = track(&[1.0, 6.0], &[1.0, 1.0], 9.0, &mut out, two_branches);
    assert_eq!(none, Err(TrackError::NoSolution { at: 1, error: IkError::NotFinite }));
    let short = track(&[1.0; 5], &[1.0, 1.0], 9.0, &mut out, two_branches);
    assert_eq!(short, Err(TrackError::Length(LengthError { expected: 5, got: 4 })));
    assert_eq!(jump.to_string(), "target 3: joint 1 would jump by -1.800000 (rad or m)");
}
