//! What `dhc equations` prints holds: every line of it is evaluated.

#![expect(clippy::unwrap_used, reason = "a text that cannot be read is a failure")]

mod common;

use common::formula::Names;
use common::{dhc, numbers};

/// Tables of all shapes, with a problem each and joint values that are a solution of it.
const TABLES: [(&str, usize); 8] = [
    ("mycobot", 6),
    ("ur5", 6),
    ("puma560", 6),
    ("scara", 4),
    ("uarm_swift_pro", 4),
    ("panda", 7),
    ("crane_x7", 7),
    ("vs068", 6),
];

/// Lines of a printed text, those that were broken joined again.
fn lines(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines() {
        let indent = line.len() - line.trim_start().len();
        // What continues a line stands deeper than any line begins.
        match lines.last_mut() {
            Some(last) if indent > 8 || (indent == 8 && last.starts_with("given")) => {
                *last += " ";
                *last += line.trim_start();
            }
            _ => lines.push(line.trim().to_owned()),
        }
    }
    lines
}

/// The unit of angles that a text says it is in.
fn unit(text: &str) -> f64 {
    if text.lines().next().unwrap().contains("angles in deg") { 1_f64.to_radians() } else { 1.0 }
}

/// Length units of the text in a metre.
fn per_metre(text: &str) -> f64 {
    if text.lines().next().unwrap().contains("lengths in mm") { 1000.0 } else { 1.0 }
}

/// Values in the middle of everything: joint k at (k + 1) * 17 + 5 degrees or so, in the table's units.
fn joint_values(table: &str, count: usize) -> Vec<f64> {
    let degrees = !matches!(table, "panda" | "crane_x7");
    (0..count)
        .map(|k| {
            let value = (k as f64 + 1.0) * 0.31 - 0.9;
            if table == "scara" && k == 2 {
                0.07
            } else if degrees {
                value.to_degrees()
            } else {
                value
            }
        })
        .collect()
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

/// Names after every definition before the equations of a part: q, theta, s and c, parameters.
fn defined(text: &str, rows: &[(usize, f64)]) -> Names {
    let mut names = Names { unit: unit(text), ..Names::default() };
    for (row, value) in rows {
        names.values.insert(format!("q{}", row + 1), *value);
    }
    let mut legend = false;
    for line in text.lines() {
        legend |= line == "Parameters";
        if let (true, Some((name, rest))) = (legend, line.trim().split_once(" = ")) {
            let value = rest.split(' ').next().unwrap().parse().unwrap();
            names.values.insert(name.to_owned(), value);
        }
    }
    for line in lines(text).iter().take_while(|line| !line.starts_with("Inverse")) {
        let definitions: Vec<&str> = if line.contains("= sin(") {
            line.split("  ").filter(|part| !part.is_empty()).collect()
        } else {
            vec![line]
        };
        for definition in definitions {
            let definition = definition.trim();
            let known = ["theta", "d", "s", "c"].iter().any(|start| definition.starts_with(start));
            if let (true, Some((name, formula))) = (known, definition.split_once(" = ")) {
                let value = names.value(formula, 1.0);
                names.values.entry(name.to_owned()).or_insert(value);
            }
        }
    }
    names
}

/// Rows of the joints: the held row of the palletiser has no q.
fn rows(table: &str, values: &[f64]) -> Vec<(usize, f64)> {
    let row = |k: usize| if table == "uarm_swift_pro" && k == 3 { 4 } else { k };
    values.iter().enumerate().map(|(k, value)| (row(k), *value)).collect()
}

/// Values of the lines of a part by their names.
fn computed(text: &str, names: &Names, heading: &str, count: usize) -> Vec<(String, f64)> {
    let lines = lines(text);
    let start = lines.iter().position(|line| line.starts_with(heading)).unwrap();
    let equations = lines[start + 1..].iter().filter(|line| !line.contains("sin(") && !line.starts_with('('));
    let mut found = Vec::new();
    for line in equations.filter_map(|line| line.split_once(" = ")).take(count) {
        found.push((line.0.to_owned(), names.value(line.1, 1.0)));
    }
    found
}

#[test]
fn poses_and_jacobians_are_those_that_are_computed() {
    for (table, count) in TABLES {
        let q = joint_values(table, count);
        let pose = dhc(&format!("fk {table} --json --joints {}", list(&q))).json();
        let jacobian = dhc(&format!("jacobian {table} --json --joints {}", list(&q))).json();
        for numeric in ["", "--numeric"] {
            let text = dhc(&format!("equations {table} {numeric}")).good();
            let names = defined(&text, &rows(table, &q));
            let entries = computed(&text, &names, "Forward", 12);
            assert_eq!(entries.len(), 12);
            for (name, value) in entries {
                let (row, column) = match name.strip_prefix('p') {
                    Some(axis) => ("xyz".find(axis).unwrap(), 3),
                    None => {
                        (name[1..2].parse::<usize>().unwrap() - 1, name[2..].parse::<usize>().unwrap() - 1)
                    }
                };
                let expected = pose["matrix"][row][column].as_f64().unwrap();
                let tolerance = 1e-8 * if column == 3 { per_metre(&text) } else { 1.0 };
                assert!((value - expected).abs() < tolerance, "{table} {name}: {value} is not {expected}");
            }
            let entries = computed(&text, &names, "Geometric", 6 * count);
            assert_eq!(entries.len(), 6 * count);
            for (name, value) in entries {
                let (row, column) =
                    (name[1..2].parse::<usize>().unwrap() - 1, name[2..].parse::<usize>().unwrap() - 1);
                // In length units a rad or a length unit, where the program says metres.
                let slides = table == "scara" && column == 2;
                let scale = if row < 3 && !slides { per_metre(&text) } else { 1.0 };
                let expected = jacobian["jacobian"][row][column].as_f64().unwrap() * scale;
                assert!((value - expected).abs() < 1e-8 * scale, "{table} {name}: {value} is not {expected}");
            }
        }
    }
}

/// The target's numbers by name, at joint values.
fn target(table: &str, q: &[f64]) -> [(&'static str, f64); 5] {
    let pose = dhc(&format!("fk {table} --json --joints {}", list(q))).json();
    let entry = |row: usize, column: usize| pose["matrix"][row][column].as_f64().unwrap();
    let turn = entry(1, 0).atan2(entry(0, 0));
    [
        ("px", entry(0, 3)),
        ("py", entry(1, 3)),
        ("pz", entry(2, 3)),
        ("cyaw", turn.cos()),
        ("syaw", turn.sin()),
    ]
}

/// A solution that keeps the constraints, found by asking for a point that the arm reaches.
const PROBLEMS: [(&str, &str, &str); 6] = [
    ("mycobot", "tool_down", "--position 150,-100,70"),
    ("ur5", "tool_down", "--position 0.4,-0.2,0.1 --yaw 30"),
    ("puma560", "tool_down", "--position 0.4,-0.2,0.5 --yaw 30"),
    ("scara", "place", "--position 0.4,0.2,0.3 --yaw 30"),
    ("uarm_swift_pro", "place", "--position 180,60,50 --yaw 30"),
    ("panda", "tool_down", "--position 0.4,-0.2,0.3 --yaw 0.5"),
];

#[test]
fn every_line_of_a_derivation_holds_at_every_solution() {
    for (table, problem, flags) in PROBLEMS {
        let answer = dhc(&format!("ik {table} --problem {problem} --all --json {flags}")).json();
        let solutions = answer["solutions"].as_array().unwrap().clone();
        assert!(!solutions.is_empty(), "{table}: {answer}");
        for numeric in ["", "--numeric"] {
            let text = dhc(&format!("equations {table} {numeric}")).good();
            let mut checked = 0;
            for solution in &solutions {
                let q = numbers(&solution["q"]);
                let known = target(table, &q);
                let mut names = defined(&text, &rows(table, &q));
                names.values.retain(|name, _| !name.starts_with(['s', 'c']));
                names.values.extend(known.into_iter().map(|(name, value)| (name.to_owned(), value)));
                checked = derivation(&text, &format!("Inverse kinematics: {problem}"), names);
            }
            assert!(checked >= 9, "{table}: {checked} lines");
        }
    }
}

/// Goes through the lines of one derivation with the values of a solution; the number of lines that were compared.
fn derivation(text: &str, heading: &str, mut names: Names) -> usize {
    let lines = lines(text);
    let start = lines.iter().position(|line| line == heading).unwrap();
    let mut checked = 0;
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * (1.0 + b.abs());
    let turn = std::f64::consts::TAU / names.unit;
    for line in
        lines[start + 1..].iter().take_while(|line| !line.starts_with("Inverse") && *line != "Parameters")
    {
        if let Some(unknown) = line.strip_prefix("Step ").and_then(|step| step.split_once(": ")) {
            let (name, formula) = unknown.1.split_once(" = ").unwrap_or((unknown.1, unknown.1));
            let value = names.value(formula, 1.0);
            names.values.insert(name.to_owned(), value);
            if let Some(suffix) = name.strip_prefix("theta") {
                names.values.insert(format!("s{suffix}"), (value * names.unit).sin());
                names.values.insert(format!("c{suffix}"), (value * names.unit).cos());
            }
            continue;
        }
        let is_remark =
            ["(", "given", "held", "kept", "out of", "singular", "one root", "two roots", "Solved"];
        let Some((left, right)) =
            line.split_once(" = ").filter(|_| !is_remark.iter().any(|s| line.starts_with(s)))
        else {
            continue;
        };
        let single = !left.contains([' ', '(']);
        if single && !names.values.contains_key(left) {
            let value = names.value(right, 1.0);
            names.values.insert(left.to_owned(), value);
            continue;
        }
        let value = names.value(left, 1.0);
        let mut roots = Vec::new();
        for alternative in right.split(", or ") {
            for sign in [1.0, -1.0] {
                if let Some(first) = roots.first().copied() {
                    names.values.insert("that".to_owned(), first);
                }
                roots.push(names.value(alternative, sign));
            }
        }
        let angle = left.starts_with("theta") || left.starts_with('q');
        let same = |root: &f64| {
            near(*root, value)
                || (angle && near((root - value).rem_euclid(turn), 0.0))
                || (angle && near((root - value).rem_euclid(turn), turn))
        };
        assert!(roots.iter().any(same), "{line}: {value} is none of {roots:?}");
        checked += 1;
    }
    checked
}
