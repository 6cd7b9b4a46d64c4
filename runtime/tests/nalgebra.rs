//! Poses and Jacobians as nalgebra's types.
#![cfg(feature = "nalgebra")]

use dh_runtime::nalgebra::{Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use dh_runtime::{Frame, Jacobian, Pose, jacobian_from_columns};

fn pose() -> Pose {
    let rotation = Rotation3::from_euler_angles(0.3, -0.7, 2.1);
    Pose::from_parts(Translation3::new(0.1, -0.2, 0.3), rotation)
}

#[test]
fn poses_and_frames_convert_both_ways() {
    let frame = Frame::from(&pose());
    assert_eq!(Pose::from(frame), pose());
    let point = pose() * Point3::new(0.4, 0.5, 0.6);
    let same = frame.transform_point([0.4, 0.5, 0.6]);
    assert!((point - Point3::from(same)).norm() < 1e-15);
    let product: Pose = (frame * frame).into();
    assert!((product.to_homogeneous() - (pose() * pose()).to_homogeneous()).norm() < 1e-15);
    let single = Frame::<f32>::from(Pose::<f32>::identity());
    assert_eq!(single, Frame::IDENTITY);
}

#[test]
fn angles_and_quaternions_mean_the_same() {
    let frame = Frame::from_rpy([0.1, -0.2, 0.3], [0.3, -0.7, 2.1]);
    assert!((Pose::from(frame).to_homogeneous() - pose().to_homogeneous()).norm() < 1e-15);
    let [x, y, z, w] = frame.quaternion();
    let theirs = UnitQuaternion::from_rotation_matrix(&pose().rotation);
    let ours = nalgebra::Quaternion::new(w, x, y, z);
    assert!((ours.dot(theirs.quaternion()).abs() - 1.0).abs() < 1e-15);
}

#[test]
fn jacobians_come_from_columns() {
    let columns = [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [7.0, 8.0, 9.0, 10.0, 11.0, 12.0]];
    let jacobian: Jacobian<2> = jacobian_from_columns(columns);
    assert_eq!(jacobian.column(1).fixed_rows::<3>(3).into_owned(), Vector3::new(10.0, 11.0, 12.0));
}
