//! Printed Rust compiles with every warning an error, and gives the bits of the interpreter. The texts are those that
//! `printed_text` keeps fresh.

#![deny(warnings, missing_docs, clippy::pedantic)]
#![allow(clippy::expect_used, reason = "a test")]

mod plans;

#[path = "printed/every_target.rs"]
#[rustfmt::skip]
mod every_target;
#[path = "printed/every_target_plain_f32.rs"]
#[rustfmt::skip]
mod every_target_plain_f32;
#[path = "printed/planar.rs"]
#[rustfmt::skip]
mod planar;
#[path = "printed/planar_plain_f32.rs"]
#[rustfmt::skip]
mod planar_plain_f32;
#[path = "printed/polar.rs"]
#[rustfmt::skip]
mod polar;

use dh_codegen::model::Model;
use dh_codegen::plan::Plan;
use dh_codegen::plan::eval::Program;
use dh_runtime::nalgebra::{Point2, Point3, Rotation3, Vector3};
use dh_runtime::{Float, Frame, IkError, Kinematics, LengthError, Rule, SolutionSet, Target};
use dh_tests::engine::everything::computed;
use planar::Planar2R;

#[test]
fn generated_code_gives_the_bits_of_the_interpreter() {
    let (model, plan) = plans::planar();
    same_bits(&Planar2R, &model, &plan, &[[0.3, -1.1], [2.9, 0.0], [-0.4, 3.0]]);
    let single = [[0.3_f32, -1.1], [2.9, 0.0], [-0.4, 3.0]];
    same_bits(&planar_plain_f32::Planar2R, &model, &plan, &single);
    let (model, plan) = plans::polar();
    same_bits(&polar::Polar, &model, &plan, &[[0.3, 0.2], [-3.0, 0.8]]);
}

/// Compares all that [`Kinematics`] computes.
fn same_bits<S: Float>(arm: &dyn Kinematics<S>, model: &Model, plan: &Plan, poses: &[[S; 2]]) {
    let program = Program::<S>::new(model, plan).expect("a sound plan");
    let interpreter = program.interpreter().expect("a complete plan");
    for q in poses {
        let tool = arm.fk(q).expect("two joints");
        assert_eq!(computed(arm, q, tool), computed(&interpreter, q, tool));
    }
    assert_eq!(arm.rules(), interpreter.rules());
    assert_eq!(arm.fingerprint(), interpreter.fingerprint());
    assert_eq!(arm.problems(), interpreter.problems());
}

#[test]
fn methods_are_as_a_user_calls_them() -> Result<(), IkError> {
    let arm = Planar2R;
    let q = [0.3, -1.1];
    let tool = arm.fk(&q).translation.vector;
    let target = Point2::new(tool.x, tool.y);
    assert_eq!(arm.ik_all_xy(&target)?.len(), 2);
    let near = arm.ik_xy_near(&target, &q)?;
    assert!((near[0].q[0] - q[0]).abs() < 1e-12 && (near[0].q[1] - q[1]).abs() < 1e-12);
    assert!(arm.ik_elbow_up(&target)?.iter().all(|solution| solution.q[1] <= 0.0));
    assert!(arm.check(&q).is_ok() && arm.check(&[4.0, 0.0]).is_err());
    assert!(matches!(arm.ik_all_xy(&Point2::new(2.0, 0.0)), Err(IkError::Unreachable { .. })));

    // Straight ahead there is one solution, and it is not below zero.
    let (model, plan) = plans::planar();
    let program = Program::<f64>::new(&model, &plan).expect("a sound plan");
    let interpreter = program.interpreter().expect("a complete plan");
    let straight = Target::Xy([0.9, 0.0]);
    let mut set = SolutionSet::new();
    for arm in [&arm as &dyn Kinematics, &interpreter] {
        arm.ik_into("elbow_up", &straight, &mut set)?;
        assert_eq!(set.len(), 1);
        let unknown = arm.ik_into("elbow_down", &straight, &mut set);
        assert_eq!((unknown, set.len()), (Err(IkError::UnknownProblem), 0));
    }
    assert!(!matches!(arm.ik_all_xy(&target), Err(IkError::Forbidden { rule: Rule::Where { .. } })));
    Ok(())
}

#[test]
fn tool_and_base_are_added_at_run_time() {
    let arm = Planar2R;
    let tool = dh_runtime::Pose::translation(0.1, 0.0, 0.0);
    let base = dh_runtime::Pose::translation(0.0, 0.0, 1.0);
    let mounted = arm.with_base(&base).with_tool(tool);
    let tip = Kinematics::fk(&mounted, &[0.0, 0.0]).expect("two joints").translation;
    assert!((tip[0] - 1.0).abs() < 1e-12 && (tip[2] - 1.0).abs() < 1e-12);
}

#[test]
fn every_target_is_taken_in_its_own_types() -> Result<(), IkError> {
    let (model, plan) = plans::every_target();
    let program = Program::<f64>::new(&model, &plan).expect("a sound plan");
    let interpreter = program.interpreter().expect("a complete plan");
    let arm = every_target::EveryTarget;
    assert_eq!(Kinematics::problems(&arm), interpreter.problems());
    assert_eq!(Kinematics::problems(&arm).len(), 11);

    // The candidates: (0, 0) is stretched out along x, and the z axis stays upright whatever the joints.
    let (origin, up) = (Point3::origin(), Vector3::z_axis());
    assert_eq!(arm.ik_all_direction(&up)?.first().map(|solution| solution.q), Some([0.0, 1.0]));
    let missed =
        |result| matches!(result, Err(IkError::Failed { position_error, .. }) if position_error > 0.7);
    assert!(missed(arm.ik_all_position(&origin)) && missed(arm.ik_lookat(&origin)));
    assert!(missed(arm.ik_ray_near(&origin, &up, &[0.0; 2])));
    let turned = arm.ik_all_rotation(&Rotation3::identity()).err();
    assert_eq!(turned, interpreted(&interpreter, "rotation"));
    assert!(matches!(turned, Some(IkError::Failed { rotation_error, .. }) if rotation_error > 1.9));
    let at = arm.ik_at_given(&Point2::new(0.0, 0.0), [core::f64::consts::PI]).map(|all| all.len());
    assert!(matches!(at, Err(IkError::Failed { position_error, .. }) if (position_error - 0.1).abs() < 1e-9));
    for arm in [&arm as &dyn Kinematics, &interpreter] {
        let length = arm.ik_into("given", &Target::Xy([0.0; 2]), &mut SolutionSet::new());
        // Without a value for the given joint it is swept, not refused.
        assert_ne!(length, Err(IkError::Length(LengthError { expected: 1, got: 0 })));
    }
    let single = every_target_plain_f32::EveryTarget;
    assert!(single.ik_all_xy_yaw(&[0.9, 0.0], 0.0).is_err());
    assert!(single.ik_rotation(&Frame::<f32>::IDENTITY.rotation).is_err());
    Ok(())
}

fn interpreted(arm: &dyn Kinematics, problem: &str) -> Option<IkError> {
    arm.ik_into(problem, &Target::Rotation(Frame::IDENTITY.rotation), &mut SolutionSet::new()).err()
}
