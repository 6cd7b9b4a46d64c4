//! Everything that an arm computes, as text that two engines can be compared by.

use dh_core::{Float, Frame, Kinematics, SolutionSet, Target};

/// All that an arm computes at a pose, its problems for where a tool frame is. Debug text tells every two floats apart that differ in a bit.
pub fn computed<S: Float>(arm: &dyn Kinematics<S>, q: &[S], tool: Frame<S>) -> String {
    let mut frames = vec![Frame::IDENTITY; arm.rows() + 1];
    let mut columns = vec![[S::ZERO; 6]; arm.dof()];
    let mut lines = vec![
        format!("{:?}", (arm.fk(q), arm.fk_flange(q))),
        format!("{:?} {frames:?}", arm.frames_into(q, &mut frames)),
        format!("{:?} {columns:?}", arm.jacobian_into(q, &mut columns)),
        format!("{:?}", arm.check(q).map_err(|violations| violations.to_string())),
    ];
    for problem in arm.problems() {
        let target = Target::of_frame(problem.target, &tool);
        let mut set = SolutionSet::new();
        for result in [
            arm.ik_into(problem.name, &target, &mut set),
            arm.ik_within(problem.name, &target, None, &mut set.clone()),
            arm.ik_within(problem.name, &target, Some(q), &mut set.clone()),
        ] {
            lines.push(format!("{} {result:?}", problem.name));
        }
        lines.extend(set.iter().map(|solution| format!("{solution:?}")));
    }
    lines.join("\n")
}
