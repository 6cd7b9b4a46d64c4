//! The program `published` against the worked example that it shows, number by number as printed.

#![expect(clippy::unwrap_used, reason = "a line that cannot be read is a broken test")]

use serde_json::Value;
use std::process::Command;

/// Differences allowed of positions (mm) and of angles (deg).
const POSITION: f64 = 1e-6;
const ANGLE: f64 = 1e-9;

/// What the program prints, one section a heading, each the lines with a bar as (left, right) of it.
fn sections() -> Vec<Vec<(String, String)>> {
    let output = Command::new(env!("CARGO_BIN_EXE_published")).output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let mut sections = Vec::new();
    for line in text.lines() {
        if line.starts_with(|c: char| c.is_ascii_digit()) {
            sections.push(Vec::new());
        } else if let Some((left, right)) = line.split_once('|') {
            let both = (left.trim().to_owned(), right.trim().to_owned());
            sections.last_mut().unwrap().push(both);
        }
    }
    sections
}

fn case() -> Value {
    serde_json::from_str(include_str!("../../tests/cases/mycobot280.json")).unwrap()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

fn elements<'a>(case: &'a Value, path: &str) -> &'a [Value] {
    case.pointer(path).unwrap().as_array().unwrap()
}

fn given(entry: &Value, key: &str) -> Vec<f64> {
    entry[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn assert_near(left: &[f64], right: &[f64], tolerance: f64) {
    assert_eq!(left.len(), right.len());
    assert!(left.iter().zip(right).all(|(a, b)| (a - b).abs() <= tolerance), "{left:?} {right:?}");
}

/// A table of examples: a line with what is asked and what was computed, a line with what was known and how far off
/// that is.
fn compare(lines: &[(String, String)], entries: &[Value], keys: [&str; 3], tolerance: f64) {
    let [asked, exact, shown] = keys;
    assert_eq!(lines.len(), 1 + 2 * entries.len(), "a heading, and two lines an example");
    for (pair, entry) in lines[1..].chunks(2).zip(entries) {
        assert_near(&numbers(&pair[0].0), &given(entry, asked), 0.0);
        assert_near(&numbers(&pair[0].1), &given(entry, exact), tolerance);
        assert_near(&numbers(&pair[1].1), &given(entry, shown), tolerance / 10.0);
        let off: f64 = pair[1].0.rsplit(' ').next().unwrap().parse().unwrap();
        assert!(off <= tolerance, "{pair:?}");
    }
}

#[test]
fn positions_and_solutions_are_those_of_the_case() {
    let (sections, case) = (sections(), case());
    assert_eq!(sections.len(), 4);
    compare(&sections[0], elements(&case, "/fk"), ["joints_deg", "position_mm", "published_mm"], POSITION);
    compare(
        &sections[1],
        elements(&case, "/tool_down/ik"),
        ["position_mm", "joints_deg", "joints_deg"],
        ANGLE,
    );
}

#[test]
fn every_refusal_and_error_is_shown() {
    let (sections, case) = (sections(), case());
    let rejected = elements(&case, "/rejected");
    let asked: Vec<_> = sections[2].iter().filter(|(left, _)| !left.is_empty()).collect();
    assert_eq!(asked.len(), rejected.len());
    for (line, entry) in asked.iter().zip(rejected) {
        assert_near(&numbers(&line.0), &given(entry, "joints_deg"), 0.0);
    }
    let reasons: Vec<_> = sections[2].iter().map(|(_, reason)| reason.as_str()).collect();
    let low = rejected[0]["position_mm"][2].as_f64().unwrap();
    assert_eq!(
        reasons,
        [
            &format!("z is {low:.6}, below 15"),
            "J1 is at 145.30, not in -90 to 90",
            "J6 is at 145.30, not in -90 to 90",
            "J3 is at -155.24, not in -150 to 150",
            "J4 is at 183.28, not in -120 to 120",
        ]
    );

    let errors = elements(&case, "/tool_down/errors");
    assert_eq!(sections[3].len(), 2 * errors.len());
    for (pair, entry) in sections[3].chunks(2).zip(errors) {
        assert_near(&numbers(&pair[0].0), &given(entry, "position_mm"), 0.0);
    }
    // On the first axis the shoulder's offset d4 = 66.39 mm cannot be made up for by turning joint 1.
    assert_eq!(sections[3][1].1, "Singular { joint: 0, gap: 0.06639 }");
    assert!(sections[3][3].1.starts_with("Unreachable { step: Step { index: 1, "), "{:?}", sections[3][3]);
}
