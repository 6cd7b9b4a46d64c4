//! Unit structs, structs with fields, generic ones; every warning an error.
#![deny(warnings, missing_docs)]
#![allow(unreachable_pub, reason = "public structs are what users have")]

use dh_runtime::{Kinematics, dh_robot};

/// An arm.
#[dh_robot("planar.toml")]
#[derive(Debug, Clone, Copy)]
pub struct Plain;

/// An arm with fields.
#[dh_robot("planar.toml", scalar = "f32")]
pub struct Fields {
    /// Where it is.
    pub room: u32,
}

/// A generic arm, whose parameter has the name of a constant of the table.
#[dh_robot("planar.toml", types = "plain", warnings = "off")]
pub struct Generic<'a, A1: Iterator<Item = Vec<u8>> = std::vec::IntoIter<Vec<u8>>, const D1: usize = 2>(
    pub &'a A1,
)
where
    A1: Clone;

type Result = std::result::Result<(), Box<dyn std::error::Error>>;

#[test]
#[allow(clippy::items_after_statements, reason = "there, too, it can stand")]
fn structs_of_all_kinds() -> Result {
    let pose = Plain.fk(&[0.1, 0.2]);
    assert!(pose.translation.vector.norm() > 0.0);
    let fields = Fields { room: 3 };
    let _: dh_runtime::Pose<f32> = fields.fk(&[0.1, 0.2]);
    let parts = vec![vec![1_u8]].into_iter();
    let generic: Generic<'_, _, 2> = Generic(&parts);
    let frame: dh_runtime::Frame = generic.fk(&[0.1, 0.2]);
    let arm: &dyn Kinematics = &generic;
    assert_eq!(arm.fk(&[0.1, 0.2])?, frame);
    assert_eq!(Plain::FINGERPRINT, generic.fingerprint());
    assert_eq!((fields.room, generic.0.len()), (3, 1));

    /// An arm in a function.
    #[dh_robot("planar.toml")]
    struct Local;
    assert_eq!(Local::DOF, 2);

    let target = dh_runtime::Point2::new(0.6, 0.3);
    assert_eq!(Plain.ik_all_xy(&target)?.len(), 2);
    assert_eq!(generic.ik_all_xy(&[0.6, 0.3])?.len(), 2);
    let near = Plain.ik_xy_near(&target, &[0.0, 1.0])?;
    assert!(near[0].q[1] > 0.0);
    Ok(())
}
