//! One message for each mistake of the table, none for what uses the arm.

use dh_runtime::{IkError, Kinematics, Point2, dh_robot};

#[dh_robot("mistakes.toml")]
struct Arm;

fn main() -> Result<(), IkError> {
    let q = [0.0; 2];
    let pose = Arm.fk(&q);
    let arm: &dyn Kinematics = &Arm;
    assert_eq!(arm.dof(), Arm::JOINTS.len());
    let solutions = Arm.ik_all_xy(&Point2::new(pose.translation.x, 0.0))?;
    println!("{:?} {:?} {:?}", Arm.jacobian(&q), Arm.frames(&q), solutions.nearest(&q));
    Arm.ik_xy_near(&Point2::new(0.1, 0.2), &q)?;
    Ok(())
}
