//! Every shipped table, from its text to verified functions.

use dh_codegen::compile;
use dh_codegen::diagnostic::Style;
use dh_codegen::plan::FunctionKind;
use dh_codegen::verify::Level;

#[test]
fn shipped_tables_are_solved_and_verified() {
    for name in dh_robots::names() {
        let text = dh_robots::table(name).unwrap();
        let compilation = compile(text, Level::Full);
        let words = compilation.diagnostics.render(text, name, Style::Plain);
        assert!(compilation.diagnostics.is_empty(), "{words}");
        let output = compilation.output.unwrap_or_else(|| panic!("{words}"));
        assert_eq!(output.unsolved, [], "{name}");
        assert!(
            output.plan.functions.iter().any(|function| matches!(function.kind, FunctionKind::Inverse(_)))
        );
        for function in &output.plan.functions {
            // Of several ways to solve a problem the first that stands verification is in the plan.
            let mut reports = output.report.functions.iter().filter(|report| report.kind == function.kind);
            let report = reports.find(|report| report.failure.is_none());
            let report = report.unwrap_or_else(|| panic!("{name}: {:?} is not verified", function.kind));
            assert!(report.poses >= 200, "{name}: {} poses", report.poses);
            if let Some(inverse) = &report.inverse {
                assert!(inverse.originals >= 100, "{name}: {}: {inverse:?}", report.name);
                assert_eq!(inverse.originals_found, inverse.originals, "{name}: {}", report.name);
            }
        }
    }
}
