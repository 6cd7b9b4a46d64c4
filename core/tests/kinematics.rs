//! A whole arm behind the trait, by itself and mounted on frames known only at run time.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod planar;
mod random;

use dh_core::{
    Axis, Bound, FULL_POSE, Frame, IkError, Kinematics, LengthError, Mounted, Rule, Rules, Side, SolutionSet,
    Target, TargetKind, Violation,
};
use planar::Planar;
use random::Random;

fn random_q(random: &mut Random) -> [f64; 3] {
    [random.between(-3.1, 3.1), random.between(-2.4, 2.4), random.between(-3.1, 3.1)]
}

fn base() -> Frame {
    Frame::from_rpy([0.3, -0.2, 0.7], [0.4, -1.1, 2.0])
}

fn tool() -> Frame {
    Frame::from_rpy([0.02, 0.05, 0.1], [-0.3, 0.6, 0.9])
}

fn recovered(arm: &dyn Kinematics, q: &[f64; 3]) {
    let target = Target::Pose(arm.fk(q).unwrap());
    let mut out = SolutionSet::new();
    arm.ik_into(FULL_POSE, &target, &mut out).unwrap();
    assert!((1..=2).contains(&out.len()) && out.dof() == 3);
    for solution in out.iter() {
        assert!(solution.residual() < 1e-9, "{}", solution.residual());
    }
    arm.ik_within(FULL_POSE, &target, Some(q), &mut out).unwrap();
    let nearest = out.get(0).unwrap();
    let off = nearest.q.iter().zip(q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-9, "{q:?} came back as {:?}", nearest.q);
    assert_eq!(out.nearest(q).unwrap(), nearest);
}

#[test]
fn random_poses_come_back_plain_and_mounted() {
    let mut random = Random(7);
    let arm = Planar::new();
    let mounted = Mounted::new(&arm).with_tool(tool()).with_base(base());
    for _ in 0..500 {
        let q = random_q(&mut random);
        recovered(&arm, &q);
        recovered(&mounted, &q);
    }
    assert_eq!((mounted.name(), mounted.dof(), mounted.rows(), mounted.fingerprint()), ("planar", 3, 3, 3));
    assert_eq!(mounted.problems(), arm.problems());
}

#[test]
fn stretched_out_there_is_one_solution_and_beyond_there_is_none() {
    let arm = Planar::new();
    let mut out = SolutionSet::new();
    let target = Target::XyYaw { position: [1.0, 0.0], yaw: 0.0 };
    arm.ik_into("plane", &target, &mut out).unwrap();
    assert_eq!(out.len(), 1);
    assert!(out.get(0).unwrap().residual() < 1e-9);
    let target = Target::XyYaw { position: [1.2, 0.0], yaw: 0.0 };
    let Err(IkError::Unreachable { step, excess }) = arm.ik_into("plane", &target, &mut out) else {
        panic!()
    };
    // (1.1^2 - 0.5^2 - 0.4^2) / (2 * 0.5 * 0.4) = 2: twice what a cosine can be.
    assert!(step.index == 0 && (excess - 1.0).abs() < 1e-12, "{excess}");
    assert!(out.is_empty());
    assert_eq!(arm.ik_into("tool_down", &target, &mut out), Err(IkError::UnknownProblem));
    let expected = TargetKind::Pose;
    assert_eq!(
        arm.ik_into(FULL_POSE, &Target::Xy([0.1; 2]), &mut out),
        Err(IkError::WrongTarget { expected })
    );
    // Out of the plane every candidate misses.
    let aside = Target::Pose(Frame::from_translation([0.5, 0.0, 0.25]));
    let Err(IkError::Failed { position_error, .. }) = arm.ik_into(FULL_POSE, &aside, &mut out) else {
        panic!()
    };
    assert!((position_error - 0.25).abs() < 1e-12);
}

#[test]
fn mounted_frames_multiply_from_both_sides() {
    let arm = Planar::new();
    let mounted = Mounted::new(&arm).with_tool(tool()).with_base(base());
    let q = [0.3, -0.8, 1.1];
    assert_eq!(mounted.fk(&q).unwrap(), base() * arm.fk(&q).unwrap() * tool());
    assert_eq!(mounted.fk_flange(&q).unwrap(), base() * arm.fk_flange(&q).unwrap());
    let (mut plain, mut moved) = ([Frame::IDENTITY; 4], [Frame::IDENTITY; 4]);
    assert_eq!((arm.frames_into(&q, &mut plain), mounted.frames_into(&q, &mut moved)), (Ok(4), Ok(4)));
    assert!(plain.iter().zip(moved).all(|(plain, moved)| moved == base() * *plain));
    let short = Err(LengthError { expected: 4, got: 2 });
    assert_eq!(mounted.frames_into(&q, &mut moved[..2]), short);
    assert_eq!(mounted.fk(&q[..2]), Err(LengthError { expected: 3, got: 2 }));
}

#[test]
fn the_mounted_jacobian_is_the_derivative_of_the_mounted_pose() {
    let mounted = Mounted::new(Planar::new()).with_tool(tool()).with_base(base());
    let q = [0.3, -0.8, 1.1];
    let mut columns = [[0.0; 6]; 3];
    mounted.jacobian_into(&q, &mut columns).unwrap();
    for (joint, column) in columns.iter().enumerate() {
        let step = 1e-6;
        let at = |h: f64| {
            let mut q = q;
            q[joint] += h;
            mounted.fk(&q).unwrap()
        };
        let (before, after) = (at(-step), at(step));
        for (row, velocity) in column.iter().take(3).enumerate() {
            let difference = (after.translation[row] - before.translation[row]) / (2.0 * step);
            assert!((difference - velocity).abs() < 1e-9, "joint {joint} row {row}");
        }
        // d/dq of the tool's axes is omega x axis.
        let [.., wx, wy, wz] = *column;
        let [x, y, z] = at(0.0).x_axis();
        let turned = [wy * z - wz * y, wz * x - wx * z, wx * y - wy * x];
        let (before, after) = (before.x_axis(), after.x_axis());
        for row in 0..3 {
            assert!(((after[row] - before[row]) / (2.0 * step) - turned[row]).abs() < 1e-9);
        }
    }
}

/// Of every solution of a planar target, the joint values sorted.
fn solved(arm: &dyn Kinematics, target: &Target) -> Vec<Vec<f64>> {
    let mut out = SolutionSet::new();
    arm.ik_into("plane", target, &mut out).unwrap();
    for solution in out.iter() {
        let (position, rotation) = target.errors(&arm.fk(solution.q).unwrap());
        assert!(position < 1e-11 && rotation < 1e-11, "{position:e} {rotation:e}");
        assert_eq!((solution.position_error, solution.rotation_error), (position, rotation));
    }
    let mut all: Vec<Vec<f64>> = out.iter().map(|solution| solution.q.to_vec()).collect();
    all.sort_by(|a, b| a[1].total_cmp(&b[1]));
    all
}

/// A tool that turns the hand about z makes it another planar arm; tilted, the arm is solved in the world, and on a base
/// that is not tilted that is the same.
#[test]
fn a_yaw_is_that_of_the_mounted_tool_in_the_world() {
    let mut random = Random(11);
    let tilted = Mounted::new(Planar::new()).with_tool(tool()).with_base(base());
    let flat = Frame::from_rpy([0.02, 0.05, 0.1], [0.0, 0.0, 0.9]);
    let turned = Mounted::new(Planar::new())
        .with_tool(flat)
        .with_base(Frame::from_rpy([0.1, -0.1, 0.5], [0.0, 0.0, 2.0]));
    for _ in 0..40 {
        let q = random_q(&mut random);
        for arm in [&tilted as &dyn Kinematics, &turned] {
            let target = Target::of_frame(TargetKind::XyYaw, &arm.fk(&q).unwrap());
            let all = solved(arm, &target);
            let apart = |a: &[f64]| a.iter().zip(q).map(|(a, b)| (a - b).sin().abs()).fold(0.0, f64::max);
            assert!(all.iter().any(|a| apart(a) < 1e-6), "{q:?} is not among {all:?}");
        }
        let target = Target::of_frame(TargetKind::XyYaw, &turned.fk(&q).unwrap());
        assert_eq!(solved(&turned, &target).len(), 2);
    }
}

#[test]
fn what_a_mounted_arm_cannot_reach_is_missed_by_what_is_said() {
    let mut out = SolutionSet::new();
    let arm = Mounted::new(Planar::new()).with_base(Frame::from_rpy([0.0; 3], [0.5, 0.0, 0.0]));
    let far = Target::XyYaw { position: [3.0, 0.0], yaw: 0.0 };
    let Err(IkError::Failed { position_error, .. }) = arm.ik_into("plane", &far, &mut out) else { panic!() };
    assert!((position_error - 2.0).abs() < 1e-6 && out.is_empty(), "{position_error}");
    assert_eq!(arm.ik_into("p", &far, &mut out), Err(IkError::UnknownProblem));
    let expected = TargetKind::XyYaw;
    assert_eq!(arm.ik_into("plane", &Target::Xy([0.1; 2]), &mut out), Err(IkError::WrongTarget { expected }));
}

#[test]
fn rules_are_checked_for_the_mounted_tool_point() {
    let bounds = const { &[Bound { axis: Axis::X, side: Side::Max, value: 1.05 }] };
    let plain = Planar::new();
    let arm = Planar { rules: Rules { bounds, ..plain.rules } };
    assert_eq!(arm.check(&[0.0; 3]), Ok(()));
    // The base moves the rules along; the tool does not.
    let moved = Mounted::new(&arm).with_base(base());
    assert_eq!(moved.check(&[0.0; 3]), Ok(()));
    let longer = moved.with_tool(Frame::from_translation([0.1, 0.0, 0.0]));
    let violations = longer.check(&[0.0; 3]).unwrap_err();
    let rule = Rule::Bound { bound: bounds[0], value: 1.1 };
    assert_eq!(violations.iter().collect::<Vec<_>>(), [Violation::Forbidden(rule)]);
    let target = Target::Pose(longer.fk(&[0.0; 3]).unwrap());
    let refused = longer.ik_within(FULL_POSE, &target, None, &mut SolutionSet::new());
    assert!(matches!(refused, Err(IkError::Forbidden { rule: Rule::Bound { .. } })), "{refused:?}");
    let length = longer.check(&[0.0; 2]).unwrap_err();
    assert!(matches!(length.iter().next(), Some(Violation::Length(_))));
}
