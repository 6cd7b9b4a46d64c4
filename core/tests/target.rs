//! Targets: what is valid, how far a tool frame is from each kind, and the order of the numbers.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use core::f64::consts::{FRAC_PI_2, PI};

use dh_core::{Frame, IkError, Target, TargetKind};

/// A tool frame turned by 0.3 rad about base z, then 0.2 rad about its own x.
fn tool() -> Frame {
    let turned = Frame::from_rpy([0.1, 0.2, 0.3], [0.0, 0.0, 0.3]);
    turned * Frame::from_rpy([0.0; 3], [0.2, 0.0, 0.0])
}

fn close((position, rotation): (f64, f64), wanted: (f64, f64)) {
    assert!((position - wanted.0).abs() < 1e-15, "{position} m is not {} m", wanted.0);
    assert!((rotation - wanted.1).abs() < 1e-15, "{rotation} rad is not {} rad", wanted.1);
}

#[test]
fn a_target_that_is_met_has_no_error_and_every_other_has_its_own() {
    let tool = tool();
    let (point, z) = (tool.translation, tool.z_axis());
    let [x, y, height] = point;
    let aside = [x + 0.03, y + 0.04, height];
    let along = tool.transform_point([0.0, 0.0, 0.7]);
    let beside = tool.transform_point([0.03, 0.04, -0.7]);
    let turn = |angle: f64| tool * Frame::from_rpy([0.0; 3], [0.0, angle, 0.0]);
    let tilted = turn(0.5).z_axis();
    let opposite = z.map(|x| -x);

    close(Target::Pose(tool).errors(&tool), (0.0, 0.0));
    close(Target::Pose(Frame { translation: aside, ..turn(0.5) }).errors(&tool), (0.05, 0.5));
    close(Target::Rotation(tool.rotation).errors(&tool), (0.0, 0.0));
    close(Target::Rotation(turn(-2.5).rotation).errors(&tool), (0.0, 2.5));
    close(Target::Position(point).errors(&tool), (0.0, 0.0));
    close(Target::Position(aside).errors(&tool), (0.05, 0.0));
    close(Target::PositionDirection { position: aside, direction: tilted }.errors(&tool), (0.05, 0.5));
    close(Target::PositionYaw { position: point, yaw: 0.3 }.errors(&tool), (0.0, 0.0));
    close(Target::PositionYaw { position: aside, yaw: 0.3 + 2.0 * PI - 0.1 }.errors(&tool), (0.05, 0.1));
    close(Target::Direction(z).errors(&tool), (0.0, 0.0));
    close(Target::Direction(opposite).errors(&tool), (0.0, PI));
    // The line may be given by any of its points, but not backwards.
    close(Target::Ray { position: along, direction: z }.errors(&tool), (0.0, 0.0));
    close(Target::Ray { position: along, direction: opposite }.errors(&tool), (0.0, PI));
    close(Target::Ray { position: beside, direction: z }.errors(&tool), (0.05, 0.0));
    close(Target::Lookat(along).errors(&tool), (0.0, 0.0));
    close(Target::Lookat(beside).errors(&tool), (0.05, 0.0));
    close(Target::Xy([x, y]).errors(&tool), (0.0, 0.0));
    close(Target::Xy([x + 0.03, y + 0.04]).errors(&tool), (0.05, 0.0));
    close(Target::XyYaw { position: [x, y], yaw: 0.3 - FRAC_PI_2 }.errors(&tool), (0.0, FRAC_PI_2));
}

#[test]
fn numbers_come_in_the_order_of_the_solutions_inputs() {
    let (p, z) = ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]);
    let frame = Frame::from_rows([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0]);
    let expect = |target: Target, kind: TargetKind, name: &str, numbers: &[f64]| {
        assert_eq!((target.kind(), &*target.numbers()), (kind, numbers));
        assert_eq!(kind.to_string(), name);
    };
    let (cos, sin) = (0.5_f64.cos(), 0.5_f64.sin());
    expect(Target::Pose(frame), TargetKind::Pose, "pose", &frame.rows());
    expect(
        Target::Rotation(frame.rotation),
        TargetKind::Rotation,
        "rotation",
        &[1.0, 2.0, 3.0, 5.0, 6.0, 7.0, 9.0, 10.0, 11.0],
    );
    expect(Target::Position(p), TargetKind::Position, "position", &p);
    expect(Target::Lookat(p), TargetKind::Lookat, "lookat", &p);
    expect(Target::Direction(z), TargetKind::Direction, "direction", &z);
    let both = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let target = Target::PositionDirection { position: p, direction: z };
    expect(target, TargetKind::PositionDirection, "position_direction", &both);
    expect(Target::Ray { position: p, direction: z }, TargetKind::Ray, "ray", &both);
    let target = Target::PositionYaw { position: p, yaw: 0.5 };
    expect(target, TargetKind::PositionYaw, "position_yaw", &[1.0, 2.0, 3.0, cos, sin]);
    expect(Target::Xy([1.0, 2.0]), TargetKind::Xy, "xy", &[1.0, 2.0]);
    expect(
        Target::XyYaw { position: [1.0, 2.0], yaw: 0.5 },
        TargetKind::XyYaw,
        "xy_yaw",
        &[1.0, 2.0, cos, sin],
    );
}

#[test]
fn numbers_that_are_none_are_refused() {
    for bad in [f64::NAN, f64::INFINITY] {
        let frame = Frame { translation: [0.0, bad, 0.0], ..Frame::IDENTITY };
        let mut rotation = Frame::<f64>::IDENTITY.rotation;
        rotation[2][1] = bad;
        let direction = [0.0, bad, 1.0];
        for target in [
            Target::Pose(frame),
            Target::Pose(Frame { rotation, ..Frame::IDENTITY }),
            Target::Rotation(rotation),
            Target::Position([bad, 0.0, 0.0]),
            Target::PositionDirection { position: [0.0; 3], direction },
            Target::PositionYaw { position: [0.0; 3], yaw: bad },
            Target::Direction(direction),
            Target::Ray { position: [0.0; 3], direction },
            Target::Lookat([0.0, 0.0, bad]),
            Target::Xy([bad, 0.0]),
            Target::XyYaw { position: [0.0; 2], yaw: bad },
        ] {
            assert_eq!(target.validate(), Err(IkError::NotFinite), "{target:?}");
        }
    }
}

#[test]
fn rotations_are_put_right_or_refused_with_a_number() {
    let exact = tool();
    assert_eq!(Target::Pose(exact).validate(), Ok(Target::Pose(exact)), "left as it is, to the bit");

    // As written with seven decimals.
    let rounded = exact.rotation.map(|row| row.map(|x| (x * 1e7).round() / 1e7));
    let Ok(Target::Rotation(rotation)) = Target::Rotation(rounded).validate() else { panic!() };
    let frame = Frame { rotation, ..exact };
    assert!(frame.rigidity_error() < 1e-15);
    assert!(Target::Pose(exact).errors(&frame).1 < 1e-7);

    let coarse = exact.rotation.map(|row| row.map(|x| (x * 1e4).round() / 1e4));
    let measured = Frame { rotation: coarse, ..exact }.rigidity_error();
    assert!(measured > 1e-6);
    let refused = Err(IkError::NotRigid { error: measured });
    assert_eq!(Target::Pose(Frame { rotation: coarse, ..exact }).validate(), refused);
    assert_eq!(Target::Rotation(coarse).validate(), refused);
    let mirrored = exact.rotation.map(|row| row.map(|x| -x));
    assert!(matches!(Target::Rotation(mirrored).validate(), Err(IkError::NotRigid { error }) if error > 1.0));
}

#[test]
fn single_precision_rotations_are_taken() {
    for step in 0..1000 {
        let angle = step as f32 * 0.37;
        let frame = Frame::<f32>::from_rpy([0.0; 3], [angle, 0.5 * angle, 1.5 * angle]);
        let Ok(Target::Pose(kept)) = Target::Pose(frame).validate() else { panic!("{angle} is refused") };
        assert!(kept.rigidity_error() < 1e-6, "{angle}: {}", kept.rigidity_error());
        assert!(dh_core::rotation_error(&kept.rotation, &frame.rotation) < 1e-6, "{angle}");
    }
}

#[test]
fn directions_are_given_length_one() {
    for length in [1e-200, 1.0, 5.0, 1e200] {
        let direction: [f64; 3] = [0.0, 0.6 * length, -0.8 * length];
        let Ok(Target::Direction([x, y, z])) = Target::Direction(direction).validate() else { panic!() };
        assert!(x == 0.0 && (y - 0.6).abs() < 1e-15 && (z + 0.8).abs() < 1e-15);
    }
    assert_eq!(Target::Direction([0.0; 3]).validate(), Err(IkError::NotRigid { error: 1.0 }));
}
