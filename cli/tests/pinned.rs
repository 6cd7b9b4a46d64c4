//! What the program prints, held against files; `UPDATE_EXPECT=1` writes them.

mod common;

use common::dhc;
use expect_test::expect_file;

/// Name of a file in `pinned/`, and what it is the output of.
const RUNS: &[(&str, &str)] = &[
    ("equations_fk.txt", "equations mycobot --part fk"),
    ("equations_fk_numeric.txt", "equations mycobot --part fk --numeric"),
    ("equations_jacobian.txt", "equations scara --part jacobian"),
    ("equations_ik.txt", "equations mycobot --part ik"),
    ("equations_ik_slide.txt", "equations scara --part ik"),
    ("equations_linkage.txt", "equations uarm_swift_pro --part fk"),
    ("fk.txt", "fk mycobot --joints -12.08,-51.17,-123.8,84.96,0,-12.08"),
    ("fk_trace.txt", "fk mycobot --joints -12.08,-51.17,-123.8,84.96,0,-12.08 --trace"),
    ("fk_json.txt", "fk scara --joints 10,20,0.1,30 --json"),
    ("jacobian.txt", "jacobian scara --joints 10,20,0.1,30"),
    ("jacobian_json.txt", "jacobian scara --joints 10,20,0.1,30 --json"),
    ("ik.txt", "ik mycobot --problem tool_down --position 150,-100,70"),
    ("ik_all.txt", "ik mycobot --problem tool_down --position 150,-100,70 --all"),
    ("ik_trace.txt", "ik mycobot --problem tool_down --position 150,-100,70 --trace"),
    ("ik_json.txt", "ik scara --problem place --position 0.4,0.2,0.3 --yaw 30 --json"),
    ("check_pose.txt", "check-pose mycobot --joints 0,-90,140,-50,0,0"),
    ("explain.txt", "explain rounded-angle"),
    ("check.txt", "check mycobot scara uarm_swift_pro"),
    ("check_poses.txt", "check --poses 3000 planar2r"),
    ("help.txt", "--help"),
    ("help_ik.txt", "ik --help"),
];

#[test]
fn outputs_are_as_they_were() {
    for (file, arguments) in RUNS {
        let run = dhc(arguments);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""), "{arguments}");
        let shown = format!("$ dhc {arguments}\n{}", masked(&run.stdout));
        expect_file![format!("pinned/{file}")].assert_eq(&shown);
    }
}

#[test]
fn everything_is_plain_ascii() {
    for (_, arguments) in RUNS {
        assert!(dhc(arguments).stdout.is_ascii(), "{arguments}");
    }
}

#[test]
fn shipped_tables_are_in_order() {
    let tables = "crane_x7 crane_x7_2r elbow3r mycobot panda planar2r puma560 rtm2r scara uarm_swift_pro ur5 ur5e vs068";
    let run = dhc(&format!("check {tables}"));
    assert_eq!(run.status, 0, "{}", run.stderr);
    assert!(!run.stderr.contains("error"), "{}", run.stderr);
    let reports = run.stdout.lines().filter(|line| line.contains("verified against")).count();
    assert_eq!(reports, tables.split(' ').count());
    assert!(!run.stdout.contains("LEFT OUT"), "{}", run.stdout);
}

/// Rounding errors (`1.2e-16`) differ between processors' libraries; that there is one is enough.
fn masked(text: &str) -> String {
    let is_rounding = |word: &str| {
        let number = word.trim_end_matches([',', ']', '}']);
        number.contains("e-1") && number.parse::<f64>().is_ok_and(|x| x.abs() < 1e-9)
    };
    let line = |line: &str| {
        let words = line.split(' ').map(|word| if is_rounding(word) { "(rounding)" } else { word });
        words.collect::<Vec<_>>().join(" ").trim_end().to_owned()
    };
    text.lines().map(line).map(|line| json_masked(&line) + "\n").collect()
}

/// The same inside of JSON, where errors follow their names.
fn json_masked(line: &str) -> String {
    let mut text = line.to_owned();
    for name in ["\"position_error\":", "\"rotation_error\":"] {
        let mut from = 0;
        while let Some(at) = text.get(from..).and_then(|rest| rest.find(name)) {
            let start = from + at + name.len();
            let end = text[start..].find([',', '}']).map_or(text.len(), |end| start + end);
            text.replace_range(start..end, "(rounding)");
            from = start;
        }
    }
    text
}
