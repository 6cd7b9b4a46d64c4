//! Every shipped table, from its text to verified functions.

use dh_codegen::diagnostic::{Diagnostics, Style};
use dh_codegen::verify::{Level, verify};
use dh_codegen::{model, plan, table};

#[test]
fn shipped_tables_are_solved_and_verified() {
    for name in dh_robots::names() {
        let text = dh_robots::table(name).unwrap();
        let mut diagnostics = Diagnostics::new();
        let table = table::parse(text, &mut diagnostics);
        let model = model::check(&table, &mut diagnostics);
        let model = model.unwrap_or_else(|| panic!("{}", diagnostics.render(text, name, Style::Plain)));
        let (plan, unsolved) = plan::build(&model);
        assert!(unsolved.len() <= 1, "{name}: besides the full pose, something is not solved");
        let functions = plan.functions.len();
        let (plan, report) = verify(&model, plan, Level::Full, &mut diagnostics);
        for function in &report.functions {
            assert_eq!(function.failure, None, "{name}: {}", function.name);
            assert!(function.poses >= 200, "{name}: {} poses", function.poses);
            if let Some(inverse) = &function.inverse {
                assert!(inverse.originals >= 100, "{name}: {}: {inverse:?}", function.name);
                assert_eq!(inverse.originals_found, inverse.originals, "{name}: {}", function.name);
            }
        }
        assert_eq!(plan.functions.len(), functions);
    }
}
