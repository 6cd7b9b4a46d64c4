//! Closed forms, the general chain and Newton's method find the same solutions.

use dh_codegen::compile;
use dh_codegen::plan::Agreement;
use dh_codegen::verify::Level;

#[test]
fn two_methods_agree_on_arms_of_every_class() {
    for name in [
        "puma560",
        "stanford",
        "ur5e",
        "irb120",
        "elbow3r",
        "planar2r",
        "crx10ia_l",
        "jaco2",
        "panda",
        "wx250",
        // By Newton's method.
        "iiwa14",
        "gantry",
        "crane_x7",
    ] {
        let output = compile(dh_robots::table(name).unwrap(), Level::Full).output.unwrap();
        let kept = output.plan.functions.iter().filter_map(|function| function.agreement.as_ref());
        let mut count = 0;
        for Agreement { method, poses, agreed } in kept {
            assert_eq!(poses, agreed, "{name}: {method}");
            count += 1;
        }
        assert!(count > 0, "{name}");
    }
}
