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
