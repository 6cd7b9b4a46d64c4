//! The programs, run to their end against simulated devices: within the program, and on a terminal, where the device
//! is asked afterwards.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::io::Write;
use std::process::{Command, Output, Stdio};

use dh_drivers::wheel_speeds;

/// What a program prints, without a device or with the simulated one within it.
fn run(program: &str, arguments: &[&str], keyboard: &str) -> Output {
    let mut child = Command::new(program)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(keyboard.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

fn stdout(output: &Output) -> String {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
    text
}

/// The numbers of a text after a word, until something that is none.
fn after(text: &str, word: &str) -> Vec<f64> {
    let (_, rest) = text.split_once(word).unwrap_or_else(|| panic!("no {word:?} in {text}"));
    rest.split_whitespace().map_while(|word| word.trim_end_matches(',').parse().ok()).collect()
}

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}: {found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance, "{what}: {found}, not {expected}");
    }
}

const MYCOBOT: &str = env!("CARGO_BIN_EXE_mycobot_arm");
const PLANAR: &str = env!("CARGO_BIN_EXE_planar_arm");
const CRANE: &str = env!("CARGO_BIN_EXE_crane_x7_square");
const VS068: &str = env!("CARGO_BIN_EXE_vs068_random");
const WHEELS: &str = env!("CARGO_BIN_EXE_wheels");

/// A published pose, one below the floor, one beyond the limits, and two lines that are no joint angles.
const KEYBOARD: &str = "-12.08 -51.17 -123.8 84.96 0 -12.08\n63.24, -85.92, -83.17, 79.09, 0, 63.24\n\
    145.3 -63.36 -119.18 92.54 0 145.3\n1 2 3\n0 0 0 0 0 x\n";

#[test]
fn mycobot_checks_joint_angles_without_a_device() {
    let text = stdout(&run(MYCOBOT, &["check"], KEYBOARD));
    let lines: Vec<&str> = text.lines().collect();
    assert_near(&after(lines[0], "at"), &[149.987_075_21, -99.993_093_32, 69.979_032_52], 0.006, "published");
    assert_eq!(lines[1], "allowed");
    assert!(lines[3].contains("refused") && lines[3].contains("0.009990 m"), "{text}");
    assert!(lines[5].contains("J1") && lines[5].contains("J6"), "both, not only the first: {text}");
    assert_eq!(lines.len(), 6);
}

#[test]
fn mycobot_moves_to_joint_angles_and_refuses_the_others() {
    let text = stdout(&run(MYCOBOT, &["joints", "--simulated", "--speed", "60"], KEYBOARD));
    let lines: Vec<&str> = text.lines().collect();
    assert_near(&after(lines[0], "joints"), &[-12.08, -51.17, -123.8, 84.96, 0.0, -12.08], 0.1, "joints");
    assert_eq!(lines[1], "refused: the hand's z would be 9.99 mm, below 15");
    assert_eq!(
        lines[2],
        "refused: J1 would be at 145.30 degrees, not in -78 to 90; J6 would be at 145.30 degrees, not in -90 to 90"
    );
    assert!(lines[3].contains("3 numbers where 6 are needed"), "{text}");
    assert!(lines[4].contains("`x` is no number"), "{text}");
    assert_eq!(lines.len(), 5);
}

#[test]
fn mycobot_moves_the_hand_tool_down() {
    for model in [&[][..], &["--m5"]] {
        let text =
            stdout(&run(MYCOBOT, &[&["hand", "150", "-100", "70", "--simulated"], model].concat(), ""));
        assert_near(&after(&text, "at"), &[150.0, -100.0, 70.0], 0.2, "hand");
        let down = [-12.0814, -51.1653, -123.7964, 84.9618, 0.0, -12.0814];
        assert_near(&after(&text, "joints"), &down, 0.1, "joints");
    }
    for (position, why) in [
        (["0", "0", "100"], "singular"),
        (["1000", "1000", "100"], "out of reach"),
        (["150", "150", "10"], "z would be 10.00 mm, below 15"),
    ] {
        let refused = run(MYCOBOT, &[&["hand", "--simulated"], &position[..]].concat(), "");
        let reason = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(!refused.status.success() && refused.stdout.is_empty() && reason.contains(why), "{reason}");
    }
}

#[test]
fn mycobot_carries_the_plate() {
    let text = stdout(&run(MYCOBOT, &["plate", "--simulated"], ""));
    let waypoints: Vec<&str> = text.lines().filter(|line| line.starts_with("waypoint")).collect();
    let expected =
        ["150 -100 50 mm, LED 255 0 0", "150 -100 150 mm, LED 0 255 0", "100 -150 150 mm, LED 0 0 255"];
    for (waypoint, expected) in waypoints.iter().zip(expected) {
        assert_eq!(*waypoint, format!("waypoint {expected}"));
    }
    assert_eq!(waypoints.last(), Some(&"waypoint 100 -150 50 mm, LED 255 255 255"));
    let arrivals: Vec<&str> = text.lines().filter(|line| line.starts_with("arrived")).collect();
    let joints = [
        [-12.0814, -63.3575, -119.18, 92.5374, 0.0, -12.0814],
        [-12.0814, -8.4243, -116.9741, 35.3984, 0.0, -12.0814],
        [-34.7012, -8.4243, -116.9741, 35.3984, 0.0, -34.7012],
        [-34.7012, -63.3575, -119.18, 92.5374, 0.0, -34.7012],
    ];
    assert_eq!(arrivals.len(), 4);
    for (arrival, expected) in arrivals.iter().zip(joints) {
        assert_near(&after(arrival, "joints"), &expected, 0.1, "waypoint");
    }
    // That pose is not safe: the torque stays.
    let refused = run(MYCOBOT, &["plate", "--simulated", "--release"], "");
    assert!(!refused.status.success());
    assert!(String::from_utf8_lossy(&refused.stderr).contains("no safe pose"));
    // The table's rest pose is.
    stdout(&run(MYCOBOT, &["joints", "--simulated", "--release"], "0 -90 140 -50 0 0\n"));
}

#[test]
fn planar_arm_does_what_its_console_is_told() {
    let text = stdout(&run(PLANAR, &["--simulated"], "t\nw\nd\nz\nx\nq\n"));
    for (line, ticks) in text.lines().zip([3000.0, 1500.0, 2731.0, 1365.0]) {
        let (target, actual) = line.split_once("actual").unwrap();
        assert_near(&after(target, "="), &[ticks], 0.0, line);
        assert_near(&after(actual, "="), &[ticks], 2.0, line);
    }
    let edge = text.lines().find(|line| line.starts_with("edge done")).unwrap();
    assert_near(&after(edge, "joints"), &[0.0, 0.0], 2.0 * std::f64::consts::TAU / 4096.0, "ends at zero");
    let corners: Vec<&str> = text.lines().filter(|line| line.starts_with("target")).collect();
    assert_eq!(corners.len(), 6);
    for corner in corners {
        let target = after(corner, "target");
        let (_, actual) = corner.split_once("actual").unwrap();
        // Two ticks of the shoulder at full reach.
        assert_near(&after(actual, ""), &target, 2.0 * 0.28 * std::f64::consts::TAU / 4096.0, corner);
        assert!(after(corner, "joints")[1] < 0.0, "elbow up: {corner}");
    }
    assert!(text.contains("`x` is no command") && text.ends_with("torque off\n"), "{text}");
    let down = stdout(&run(PLANAR, &["--simulated", "--elbow", "down"], "d\nq\n"));
    assert!(
        down.lines().filter(|line| line.starts_with("target")).all(|line| after(line, "joints")[1] > 0.0)
    );
}

/// The corners' joint values are those of the course's sheet.
#[test]
fn crane_x7_goes_round_its_square() {
    const CASES: &str = include_str!("../../tests/cases/crane_x7_2r.json");
    let cases: serde_json::Value = serde_json::from_str(CASES).unwrap();
    let tick = std::f64::consts::TAU / 4096.0;
    for wrist_down in [false, true] {
        let flags: &[&str] = if wrist_down { &["--simulated", "--wrist-down"] } else { &["--simulated"] };
        let text = stdout(&run(CRANE, flags, ""));
        let targets: Vec<&str> = text.lines().filter(|line| line.starts_with("target")).collect();
        assert_eq!(targets.len(), 9);
        for (index, line) in targets.iter().enumerate() {
            let corner = &cases["square"][index % 4];
            let value = |key: &str, at: usize| corner[key][at].as_f64().unwrap();
            assert_near(
                &after(line, "target"),
                &[value("position_m", 0), value("position_m", 1)],
                1e-9,
                line,
            );
            let wrist = match corner["wrist_down_theta6_rad"].as_f64().unwrap() {
                _ if !wrist_down => 0.0,
                // Joint 6 ends there, which the program says.
                down => down.max(-std::f64::consts::FRAC_PI_2),
            };
            let joints = [value("theta_rad", 0) - std::f64::consts::FRAC_PI_2, value("theta_rad", 1), wrist];
            assert_near(&after(line, "6 at"), &joints, 2.0 * tick, line);
        }
        assert_eq!(
            text.matches("4.88 degrees short of straight down").count(),
            if wrist_down { 2 } else { 0 }
        );
        assert!(
            text.starts_with("position mode\ntorque on\n") && text.ends_with("at rest, holding\n"),
            "{text}"
        );
    }
}

#[test]
fn vs068_goes_to_random_poses() {
    let text = stdout(&run(VS068, &["--simulated", "--poses", "25", "--seed", "7"], ""));
    let poses: Vec<&str> = text.lines().filter(|line| line.contains("solutions")).collect();
    assert_eq!(poses.len(), 25);
    for line in text.lines().filter(|line| line.contains("ticks")) {
        assert!(after(line, "off by")[0] <= 2.0, "{line}");
    }
    for line in poses {
        // Two ticks of every joint, at the arm's reach.
        assert!(after(line, "off by")[0] < 6.0 * 2.0 * 1180.0 * std::f64::consts::TAU / 2048.0, "{line}");
        assert!(after(line, "and")[0] < 6.0 * 2.0 * 360.0 / 2048.0, "{line}");
    }
}

#[test]
fn wheels_turn_as_the_stick_says() {
    let text = stdout(&run(WHEELS, &["--gain", "2"], "0 1\n0.3,-0.8\nx\n"));
    let mut lines = text.lines();
    for stick in [[0.0, 1.0], [0.3, -0.8]] {
        assert_near(&after(lines.next().unwrap(), ""), &wheel_speeds(stick, 2.0), 0.0, "wheels");
    }
    assert_eq!(lines.next(), Some("`x` is no number"));
}
