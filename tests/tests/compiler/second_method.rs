//! Closed forms, the general chain and Newton's method find the same solutions.

use super::classes::{CLASSES, Random, modified_rows, table};
use dh_codegen::compile;
use dh_codegen::plan::{Agreement, Step};
use dh_codegen::verify::Level;
use dh_tests::engine;

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
        let output = engine::compiled(name).unwrap().output.as_ref().unwrap();
        let kept = output.plan.functions.iter().filter_map(|function| function.agreement.as_ref());
        let mut count = 0;
        for Agreement { method, poses, agreed, .. } in kept {
            assert_eq!(poses, agreed, "{name}: {method}");
            count += 1;
        }
        assert!(count > 0, "{name}");
    }
}

/// Arms of each class are solved step by step, and the general chain finds nothing that those steps miss.
#[test]
fn every_class_has_a_closed_form_that_another_method_confirms() {
    let mut random = Random(20_261_122);
    for (class, rows, skew) in CLASSES {
        let text = table(rows, *skew, &mut random);
        for text in [modified_rows(&text), text] {
            let output = compile(&text, Level::Full).output.unwrap();
            let inverse = output.plan.functions.iter().filter(|function| function.outputs.is_empty());
            let mut count = 0;
            for function in inverse {
                let general = function.steps.iter().any(|step| matches!(step, Step::General { .. }));
                assert!(!general, "{class}\n{text}");
                let Some(Agreement { method, poses, agreed, .. }) = &function.agreement else { continue };
                assert_eq!(poses, agreed, "{class}: {method}\n{text}");
                count += 1;
            }
            assert!(count > 0, "{class}\n{text}");
        }
    }
}
