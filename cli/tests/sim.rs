//! `dhc sim`: what it prints, how it ends, what it refuses.

#![cfg(unix)]

mod common;

use common::{command, dhc};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Command;

#[test]
fn runs_until_it_is_told_to_stop() {
    let link = std::env::temp_dir().join(format!("dhc-sim-{}", std::process::id()));
    for signal in ["-INT", "-TERM"] {
        let mut child = command(&format!("sim crane_x7 --link {}", link.display())).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        assert_eq!(line, format!("{{\"port\":\"{}\"}}\n", link.display()));
        assert!(Path::new(&link).exists());
        Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{signal}");
        assert!(link.symlink_metadata().is_err(), "the link is gone");
    }
}

#[test]
fn refuses_what_it_cannot_simulate() {
    let run = dhc("sim scara");
    assert_eq!((run.status, run.stdout.as_str()), (1, ""));
    assert!(
        run.stderr.contains("has no [device]") && run.stderr.contains("help: write [device]"),
        "{}",
        run.stderr
    );
    for scale in ["0", "-1", "nan", "inf"] {
        let run = dhc(&format!("sim planar2r --time-scale={scale}"));
        assert_eq!((run.status, run.stdout.as_str()), (2, ""), "{}", run.stderr);
    }
    let run = dhc("sim planar2r --link /no/such/folder/port");
    assert_eq!(run.status, 1);
    assert!(run.stderr.contains("/no/such/folder/port"), "{}", run.stderr);
}

/// Over TCP, at an M5's rate, on a bad line: the arm is read, and who comes second is sent away.
#[test]
fn listens_where_it_is_told_to() {
    let flags = "--listen 127.0.0.1:0 --baud 115200 --faults 1";
    let mut child = command(&format!("sim mycobot {flags}")).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let port = line.split('"').nth(3).unwrap().to_owned();
    assert!(port.starts_with("tcp:127.0.0.1:"), "{line}");
    let mut watching =
        command(&format!("read mycobot --baud 115200 --port {port} --watch 2")).spawn().unwrap();
    let mut told = BufReader::new(watching.stdout.take().unwrap()).lines();
    assert!(told.any(|line| line.unwrap().starts_with("hand at 43.60")));
    let second = dhc(&format!("read mycobot --port {port}")).failed(1);
    assert!(second.contains("or somebody else has the line"), "{second}");
    for child in [&mut watching, &mut child] {
        child.kill().unwrap();
        child.wait().unwrap();
    }
    for (flags, says) in [
        ("--faults 101", "--faults 101 is not from 0 to 100 percent"),
        ("--baud 9600", "a Pi's, 115200 an M5's"),
        ("--listen nowhere", "write HOST:PORT"),
    ] {
        let run = dhc(&format!("sim mycobot {flags}"));
        assert!(run.status != 0 && run.stderr.contains(says), "{flags}: {}", run.stderr);
    }
}
