//! Closed forms and the general chain find the same solutions, and a solution that one of them lacks shows.

use dh_codegen::plan::{Agreement, FunctionKind, Step};
use dh_codegen::verify::{Level, confirm};
use dh_codegen::{compile, plan};

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

#[test]
fn solutions_that_one_method_lacks_are_counted() {
    let output = compile(dh_robots::table("puma560").unwrap(), Level::Quick).output.unwrap();
    let mut plan = output.plan.clone();
    confirm(&output.model, &mut plan, |function| {
        let mut second = plan::second(&output.model, function)?;
        for step in &mut second.steps {
            if let Step::General { chain, .. } = step {
                // Of too low a degree, they find nothing: what is left is Newton's method from many places, which misses some.
                chain.charts.iter_mut().for_each(|chart| chart.degree = 1);
            }
        }
        Some(second)
    });
    let full = plan.functions.iter().find(|function| function.kind == FunctionKind::Inverse(None)).unwrap();
    let agreement = full.agreement.as_ref().unwrap();
    assert!(agreement.agreed < agreement.poses, "{agreement:?}");
}
