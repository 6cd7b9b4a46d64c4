//! The attribute as the compiler of the user's crate sees it: tables beside their sources, messages pinned.
//! `TRYBUILD=overwrite` rewrites these.

use std::process::Command;

/// The drawing around our messages is the compiler's own and changes with it.
const PINNED: &str = "rustc 1.95.";

#[test]
fn attribute() {
    let cases = trybuild::TestCases::new();
    let version =
        Command::new("rustc").arg("--version").output().map(|output| output.stdout).unwrap_or_default();
    if version.starts_with(PINNED.as_bytes()) {
        cases.compile_fail("ui/fail/*.rs");
    }
}
