//! The commands that move an arm, on what `dhc sim` simulates.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "an arm that does not answer is a failure")]

mod common;

use common::{command, dhc, dhc_reading};
use dh_drivers::clock::RealClock;
use dh_drivers::dynamixel::{Bus, Timing};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A simulated device; it ends with its test.
struct Sim {
    child: Child,
    port: String,
    _alone: MutexGuard<'static, ()>,
}

/// Devices run in real time, and so do those who wait for them: one at a time has the processor.
static ALONE: Mutex<()> = Mutex::new(());

impl Sim {
    fn of(table: &str) -> Self {
        // A test that failed leaves nothing behind that the next one could be harmed by.
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut child = command(&format!("sim {table}")).stderr(Stdio::inherit()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let port = serde_json::from_str::<Value>(&line).unwrap()["port"].as_str().unwrap().to_owned();
        Self { child, port, _alone: alone }
    }

    /// What `dhc read --json` says of the joints.
    fn joints(&self, table: &str) -> Vec<f64> {
        numbers(&dhc(&format!("read {table} --port {} --json", self.port)).json()["q"])
    }
}

impl Drop for Sim {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn assert_near(q: &[f64], wanted: &[f64], tolerance: f64) {
    let near = q.len() == wanted.len() && q.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(near, "{q:?} is not {wanted:?}");
}

const TWO_TICKS: f64 = 2.0 * std::f64::consts::TAU / 4096.0;

fn file(name: &str, text: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn servos_are_moved_and_read() {
    let sim = Sim::of("planar2r");
    assert_near(&sim.joints("planar2r"), &[0.0, 0.0], 1e-9);
    let run = dhc(&format!("move planar2r --port {} --joints 0.6,-0.9 --json", sim.port));
    assert_eq!(run.status, 0, "{}", run.stderr);
    assert_near(&numbers(&run.json()["q"]), &[0.6, -0.9], TWO_TICKS);
    let line = format!("move planar2r --port {} --problem xy --position 0.2,0.1 --line --json", sim.port);
    let hand = numbers(&dhc(&line).json()["hand"]["position"]);
    assert_near(&hand, &[0.2, 0.1, 0.0], 2.0 * TWO_TICKS * 0.28);
    let shown = dhc(&format!("read planar2r --port {}", sim.port)).good();
    assert!(shown.contains("J1") && shown.contains("hand at 0.2"), "{shown}");
}

#[test]
fn refusals_say_why_and_move_nothing() {
    let sim = Sim::of("planar2r");
    let before = sim.joints("planar2r");
    for (arguments, status, says) in [
        ("--joints 4,0", 1, "joint 1 (J1) at 4.000000000 rad is 0.859941327 rad outside its limits"),
        ("--joints 0", 1, "the joints are J1, J2"),
        ("--pose up", 1, "there are zero, test"),
        ("--problem up --position 0,0", 1, "--problem takes pose, xy, xy_elbow_up, xy_elbow_down"),
        ("--problem xy --position 0.2,0.2,0.2", 2, "--position has 3 numbers where 2 are needed"),
        ("--problem xy --position 0.1,0.1 --line", 1, "singular: the smallest singular value is"),
        ("--problem xy --position 0.3,0.1", 1, "out of reach"),
        ("--joints 0.5,0.5 --percent 0", 2, "`0` is no percentage: write a number above 0, and at most 100"),
        ("--joints 0.5,0.5 --percent 101", 2, "`101` is no percentage"),
        ("--joints 0.5,0.5 --speed -3", 2, "`-3` is no number above 0"),
        ("--joints 4,-5", 1, "; joint 2 (J2) at -5.000000000 rad is 1.858407346 rad outside"),
        ("--joints 0.5,0.5 --line", 2, "go with --problem"),
        ("", 2, "where to?"),
    ] {
        let stderr = dhc(&format!("move planar2r --port {} {arguments}", sim.port)).failed(status);
        assert!(stderr.contains(says), "{arguments}: {stderr}");
    }
    let json = dhc(&format!("move planar2r --port {} --joints 4,-5 --json", sim.port)).json();
    assert_eq!((&json["error"]["kind"], &json["error"]["joint"]), (&"outside_limits".into(), &1.into()));
    assert_eq!(json["error"]["also"][0]["joint"], 2);
    let dry = dhc(&format!("move planar2r --port {} --joints 1,1 --dry-run", sim.port)).good();
    assert!(dry.contains("allowed"), "{dry}");
    assert_eq!(sim.joints("planar2r"), before);
}

#[test]
fn a_device_that_is_not_there_is_said_so() {
    let stderr = dhc("read planar2r --port /dev/no-such-port").failed(1);
    assert!(stderr.contains("/dev/no-such-port"), "{stderr}");
    let stderr = dhc("read scara --port /dev/null").failed(1);
    assert!(stderr.contains("[device]"), "{stderr}");
    let stderr = dhc("read planar2r --port /dev/null").failed(1);
    assert!(stderr.contains("/dev/null: it can't be used as a serial port"), "{stderr}");
    let stderr = dhc("read planar2r --port tcp:localhost").failed(1);
    assert!(stderr.contains("write tcp:HOST:PORT"), "{stderr}");
    // Another device than the table's answers nothing that it understands.
    let sim = Sim::of("mycobot");
    let stderr = dhc(&format!("read planar2r --port {}", sim.port)).failed(1);
    assert!(
        stderr.contains("J1, ping: no answer in ") && stderr.contains("--baud gives another"),
        "{stderr}"
    );
    let stderr = dhc("read planar2r --port /dev/no-such-port --unit no/such.toml").failed(1);
    assert!(stderr.contains("no/such.toml"), "{stderr}");
}

#[test]
fn a_figure_is_drawn_and_its_points_are_told() {
    let sim = Sim::of("planar2r");
    let figure = "# a house\n0.2 0.05\n0.2,0.12\n0.15 0.16\n\n0.1 0.12 # wall\n0.1 0.05\n";
    let path = file("house.txt", figure);
    let run = dhc(&format!(
        "draw planar2r {} --port {} --problem xy_elbow_up --close --json",
        path.display(),
        sim.port
    ));
    assert_eq!(run.status, 0, "{}", run.stderr);
    let points: Vec<Value> = run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(points.len(), 6);
    assert_eq!(points[0]["target"], points[5]["target"]);
    for point in points {
        assert_near(&numbers(&point["hand"]), &numbers(&point["target"]), 2.0 * TWO_TICKS * 0.28);
    }
    // A point that can't be reached: nothing is drawn at all.
    let before = sim.joints("planar2r");
    let run = dhc_reading(&format!("draw planar2r - --port {}", sim.port), b"0.1 0.1\n0.3 0.1\n");
    let stderr = run.failed(1);
    assert!(stderr.contains("move 2"), "{stderr}");
    let stderr = dhc_reading(&format!("draw planar2r - --port {}", sim.port), b"0.1 0.1\n0.3\n").failed(1);
    assert!(stderr.contains("-:2: a point of `xy` has 2 numbers"), "{stderr}");
    assert_eq!(sim.joints("planar2r"), before);
}

#[test]
fn a_console_takes_commands() {
    let sim = Sim::of("planar2r");
    let script = "percent 100\njoints 0.5 -0.8\ncheck joints 9 9\nto xy 0.15,0.1\nline xy 0.15 0.05\nfly\nread\nquit\n";
    let run = dhc_reading(&format!("console planar2r --port {}", sim.port), script.as_bytes());
    // A script in which something was refused is told so at its end.
    assert_eq!(run.status, 1);
    assert_eq!(run.stdout.matches("hand at").count(), 4, "{}", run.stdout);
    assert!(
        run.stderr.contains("line 3: error: refused") && run.stderr.contains("line 6: error: `fly` is no")
    );
    let run =
        dhc_reading(&format!("console planar2r --port {}", sim.port), b"joints 0 0\nrelease anywhere\n");
    assert_eq!(run.status, 0, "{}", run.stderr);
    assert_near(&sim.joints("planar2r"), &[0.0, 0.0], TWO_TICKS);
}

#[test]
fn ctrl_c_stops_the_arm_and_it_holds() {
    let sim = Sim::of("planar2r");
    let mut child = command(&format!("move planar2r --port {} --joints 2.5,-2.5 --percent 40", sim.port))
        .spawn()
        .unwrap();
    // It tells of its progress every two seconds; the move takes six.
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut told = String::new();
    stderr.read_line(&mut told).unwrap();
    assert!(told.starts_with("move 1 of 1, "), "{told}");
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    stderr.read_to_string(&mut told).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert!(told.contains("stopped; the arm holds"), "{told}");
    let q = sim.joints("planar2r");
    assert!(q[0] > 0.02 && q[0] < 2.0, "{q:?}");
    assert_near(&sim.joints("planar2r"), &q, 1e-9);
}

#[test]
fn one_arm_is_calibrated() {
    let sim = Sim::of("planar2r");
    let unit = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("left.toml");
    // The simulated arm is in pose zero; say that it is in another one, and it is off by that from then on.
    let run = dhc(&format!("calibrate planar2r --port {} --pose test --now -o {}", sim.port, unit.display()));
    assert_eq!(run.status, 0, "{}", run.stderr);
    assert!(run.stderr.contains("J1: zero at 1096.0, by the table 2048.0"), "{}", run.stderr);
    let read = dhc(&format!("read planar2r --port {} --unit {} --json", sim.port, unit.display())).json();
    let test = [3000.0, 1500.0].map(|tick| (tick - 2048.0) / 2048.0 * std::f64::consts::PI);
    assert_near(&numbers(&read["q"]), &test, 1e-9);
    let stderr = dhc(&format!("read crane_x7 --port {} --unit {}", sim.port, unit.display())).failed(1);
    assert!(stderr.contains("calibrate anew"), "{stderr}");
}

#[test]
fn a_tool_and_a_base_of_the_day() {
    let sim = Sim::of("planar2r");
    let read = |flags: &str| {
        let json = dhc(&format!("read planar2r --port {} --json {flags}", sim.port)).json();
        numbers(&json["hand"]["position"])
    };
    assert_near(&read("--tool 0.02,0,0"), &[0.3, 0.0, 0.0], 1e-6);
    assert_near(&read("--base 0.1,-0.1,0.3,0,0,1.5707963267948966"), &[0.1, 0.18, 0.3], 1e-6);
    let to = "--base 0.1,-0.1,0.3 --problem xy --position 0.25,0 --json";
    let hand = dhc(&format!("move planar2r --port {} {to}", sim.port)).json();
    assert_near(&numbers(&hand["hand"]["position"]), &[0.25, 0.0, 0.3], 2.0 * TWO_TICKS * 0.28);
    // The table's problem holds the hand, the tool's point is where it is sent.
    let to = "--tool 0.03,0,0 --problem xy_elbow_up --position 0.15,0.12 --json";
    let hand = dhc(&format!("move planar2r --port {} {to}", sim.port)).json();
    assert_near(&numbers(&hand["hand"]["position"]), &[0.15, 0.12, 0.0], 2.0 * TWO_TICKS * 0.31);
    let stderr = dhc(&format!("read planar2r --port {} --tool 1,2", sim.port)).failed(2);
    assert!(stderr.contains("--tool has 2 numbers where 3 or 6 are needed"), "{stderr}");
}

#[test]
fn a_mycobot_goes_tool_down_and_is_laid_to_rest() {
    let sim = Sim::of("mycobot");
    let run =
        dhc(&format!("move mycobot --port {} --problem tool_down --position 150,-100,150 --json", sim.port));
    assert_eq!(run.status, 0, "{} {}", run.stderr, run.stdout);
    assert_near(&numbers(&run.json()["hand"]["position"]), &[150.0, -100.0, 150.0], 0.5);
    let line = "--problem tool_down --position 150,-100,70 --line --speed 80 --json";
    let run = dhc(&format!("move mycobot --port {} {line}", sim.port));
    assert_eq!(run.status, 0, "{} {}", run.stderr, run.stdout);
    assert_near(&numbers(&run.json()["hand"]["position"]), &[150.0, -100.0, 70.0], 0.5);
    let known = [-12.08, -51.17, -123.8, 84.96, 0.0, -12.08];
    assert_near(&numbers(&run.json()["q"]), &known, 0.1);
    let low = dhc(&format!("move mycobot --port {} --problem tool_down --position 150,-100,10", sim.port));
    let stderr = low.failed(1);
    assert!(stderr.contains("below z_min = 15"), "{stderr}");
    // Torque goes in a safe pose only, or when asked for.
    let run = dhc_reading(&format!("console mycobot --port {}", sim.port), b"release\npose rest\nrelease\n");
    assert!(run.stderr.contains("the nearest safe pose is rest"), "{}", run.stderr);
    assert_eq!(run.stdout.matches("hand at").count(), 1, "{} {}", run.stdout, run.stderr);
}

/// The CRANE-X7's hand is a servo of its table, the myCobot's gripper one of its own.
#[test]
fn what_an_arm_has_besides_joints_is_moved_in_the_console() {
    for (table, name, value, beyond) in
        [("crane_x7", "hand", "0.3", "4"), ("mycobot", "gripper", "40", "101")]
    {
        let sim = Sim::of(table);
        let script = format!("{name} {value}\n{name} {beyond}\n{name} x\n");
        let run = dhc_reading(&format!("console {table} --port {}", sim.port), script.as_bytes());
        assert!(run.stderr.contains(&format!("line 2: error: {name} takes")), "{}", run.stderr);
        assert!(run.stderr.contains("line 3: error: `x` is no number"), "{}", run.stderr);
        // It takes its time; what has not arrived after some twenty readings never will.
        let wanted = format!("{name} at {value}");
        let arrived = (0..20).any(|_| {
            let run = dhc_reading(&format!("console {table} --port {}", sim.port), name.as_bytes());
            run.stdout.starts_with(&wanted)
        });
        assert!(arrived, "{wanted}");
    }
}

/// `release` must release, whatever the table calls its servos.
#[test]
fn no_servo_has_the_name_of_a_command() {
    let table = std::fs::read_to_string("../robots/crane_x7.toml").unwrap();
    for name in ["release", "to", "q"] {
        let named = table.replace("name = \"hand\"", &format!("name = \"{name}\""));
        let path = file("named_as_a_command.toml", &named);
        let sim = Sim::of(path.to_str().unwrap());
        let run = dhc_reading(&format!("console {} --port {}", path.display(), sim.port), b"read\n");
        assert_eq!(run.status, 1, "{name}: {}", run.stderr);
        let says = format!("error: the servo `{name}` has the name of a command\nhelp: give");
        assert!(run.stderr.contains(&says), "{}", run.stderr);
    }
}

/// A servo in velocity mode takes no goals: the help says what sets it right.
#[test]
fn servos_are_set_to_position_mode_on_request() {
    let sim = Sim::of("planar2r");
    {
        let line = dh_drivers::port::open(&sim.port, 57_600, Arc::new(RealClock::new())).unwrap();
        Bus::new(line, Timing::default()).set_operating_mode(&[2], 1).unwrap();
    }
    let stderr = dhc(&format!("read planar2r --port {}", sim.port)).failed(1);
    assert!(stderr.contains("J2, connect: operating mode is set to 1") && stderr.contains("--position-mode"));
    dhc(&format!("read planar2r --port {} --position-mode", sim.port)).good();
    dhc(&format!("read planar2r --port {}", sim.port)).good();
}
