//! The shipped tables: complete, readable, and true to what they say of themselves.

use std::fs;
use std::path::PathBuf;

use dh_codegen::diagnostic::Style;
use dh_codegen::plan::FunctionKind;
use dh_tests::engine;
use dh_tests::oracle::Oracle;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../robots")
}

#[test]
fn every_file_is_embedded_in_alphabetical_order() {
    let mut files: Vec<String> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "Cargo.toml")
        .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
        .collect();
    files.sort();
    assert_eq!(files, dh_robots::names().collect::<Vec<_>>());
    assert!(dh_robots::table("none of them").is_none());
}

/// No errors, no warnings, and a verified function for every problem that a table asks for.
#[test]
fn shipped_tables_are_solved_and_verified() {
    for (name, compilation) in engine::every_shipped() {
        let text = dh_robots::table(name).unwrap();
        let words = compilation.diagnostics.render(text, name, Style::Plain);
        assert_eq!(words, "");
        let output = compilation.output.as_ref().unwrap_or_else(|| panic!("{words}"));
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

#[test]
fn the_reference_lists_every_table() {
    let readme = fs::read_to_string(folder().join("README.md")).unwrap();
    let (_, arms) = readme.split_once("## Arms").unwrap();
    let listed: Vec<&str> = arms
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once('`').map(|(name, _)| name))
        .collect();
    assert_eq!(listed, dh_robots::names().collect::<Vec<_>>());
    for name in &listed {
        let text = dh_robots::table(name).unwrap();
        let line = arms.lines().find(|line| line.starts_with(&format!("| `{name}`"))).unwrap();
        let class = engine::compiled(name).unwrap().output.as_ref().unwrap().model.geometry().class();
        assert!(line.contains(&format!("| {class}")), "{name} is of class {class}");
        let problems = text.split("[[ik]]").skip(1);
        for problem in problems.filter_map(|entry| entry.split('"').nth(1)) {
            assert!(line.contains(&format!("`{problem}`")), "{name}: {problem} is not listed");
        }
    }
}

#[test]
fn examples_of_the_reference_are_toml() {
    let readme = fs::read_to_string(folder().join("README.md")).unwrap();
    let blocks: Vec<&str> =
        readme.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert!(blocks.len() > 8);
    for block in &blocks {
        assert!(toml::de::DeTable::parse(block).is_ok(), "{block}");
    }
    // The first is a whole table.
    assert_eq!(Oracle::read(blocks[0]).unwrap().dof(), 2);
}

#[test]
fn numbers_come_from_somewhere() {
    for name in dh_robots::names() {
        let text = dh_robots::table(name).unwrap();
        assert!(text.contains("\nsource = \""), "{name}");
        assert!(text.contains("\nformat = 1\n"), "{name}");
        assert!(text.lines().all(|line| line.trim_end() == line), "{name}: spaces at the end of a line");
    }
}

/// Other readers than ours know TOML 1.0 only: an inline table ends on its line, without a comma before its end.
#[test]
fn tables_are_toml_1_0() {
    for name in dh_robots::names() {
        for line in dh_robots::table(name).unwrap().lines() {
            let code = line.split('#').next().unwrap();
            assert_eq!(code.matches('{').count(), code.matches('}').count(), "{name}: {line}");
            let dense: String = code.split_whitespace().collect();
            assert!(!dense.contains(",}"), "{name}: {line}");
        }
    }
}

#[test]
fn named_poses_keep_the_limits() {
    for name in dh_robots::names() {
        let oracle = Oracle::shipped(name).unwrap();
        let chain = oracle.chain();
        assert!(!chain.poses.is_empty(), "{name}");
        for (pose, q) in &chain.poses {
            for (&row, &value) in chain.joints.iter().zip(q) {
                let (least, greatest) = chain.rows[row].limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
                assert!((least..=greatest).contains(&value), "{name}: {pose}, {}", chain.rows[row].name);
            }
        }
    }
}

/// Poses at which each problem's constraints hold by construction; the tool must be where the entry's comment says.
#[test]
fn constraints_hold_the_tool_as_described() {
    let down = |name: &str, q: &[f64]| {
        let pose = Oracle::shipped(name).unwrap().fk(q);
        assert!((pose[2][2] + 1.0).abs() < 1e-14, "{name}: the tool points to {:?}", pose.map(|row| row[2]));
    };
    let (q1, q2, q3, q6) = (0.3, -0.7, 1.1, 0.4);
    let (pi, half) = (std::f64::consts::PI, std::f64::consts::FRAC_PI_2);
    // theta = q + (0, 90, 0, 90, -90, 0) degrees.
    down("mycobot", &[q1, q2, q3, half - (q2 + half) - q3 - half, 0.0, q1]);
    down("ur5", &[q1, q2, q3, -half - q2 - q3, -half, q6]);
    down("ur5e", &[q1, q2, q3, -half - q2 - q3, -half, q6]);
    down("vs068", &[q1, q2, q3, 0.0, pi - q2 - q3, q6]);
    down("puma560", &[q1, q2, q3, 0.0, -pi - q2 - q3, q6]);
    down("panda", &[q1, q2, 0.0, -q3, 0.0, q2 + q3, q6]);
    down("crane_x7", &[q1, q2, 0.0, -q3, 0.0, -pi - q2 + q3, 0.0]);
    down("scara", &[q1, q2, 0.1, q6]);
    down("uarm_swift_pro", &[q1, 0.9, 0.4, q6]);
}
