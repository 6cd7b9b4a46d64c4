//! Closed forms and the general chain find the same solutions, and a solution that one of them lacks shows.

use dh_codegen::plan::{Agreement, Function, FunctionKind, Plan, Step};
use dh_codegen::verify::{Level, confirm};
use dh_codegen::{Output, compile, plan};

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

/// All joints of the full pose at once, by polynomials of too low a degree: what is left is Newton's method from some places,
/// which misses some.
fn lacking(output: &Output) -> Function {
    let mut function = plan::general(&output.model, None).unwrap();
    for step in &mut function.steps {
        if let Step::General { chain, .. } = step {
            chain.charts.iter_mut().for_each(|chart| chart.degree = 1);
        }
    }
    function
}

/// What is said of the full pose.
fn agreement(plan: &Plan) -> &Agreement {
    let full = plan.functions.iter().find(|function| function.kind == FunctionKind::Inverse(None)).unwrap();
    full.agreement.as_ref().unwrap()
}

#[test]
fn solutions_that_one_method_lacks_are_counted() {
    let output = compile(dh_robots::table("puma560").unwrap(), Level::Quick).output.unwrap();
    let mut plan = output.plan.clone();
    confirm(&output.model, &mut plan, Level::Full, |_| Some(lacking(&output)));
    let Agreement { poses, agreed, .. } = agreement(&plan);
    assert!(agreed < poses, "{agreed} of {poses}");
}

#[test]
fn solutions_that_the_product_of_matrices_has_are_missed() {
    let output = compile(dh_robots::table("puma560").unwrap(), Level::Quick).output.unwrap();
    let mut plan = output.plan.clone();
    confirm(&output.model, &mut plan, Level::Full, |_| None);
    let Agreement { poses, agreed, .. } = agreement(&plan);
    assert_eq!((*poses, *agreed), (8, 8));
    let whole = |function: &&mut Function| function.kind == FunctionKind::Inverse(None);
    *plan.functions.iter_mut().find(whole).unwrap() = lacking(&output);
    confirm(&output.model, &mut plan, Level::Full, |_| None);
    let Agreement { agreed, .. } = agreement(&plan);
    assert!(*agreed < 8, "{agreed}");
}
