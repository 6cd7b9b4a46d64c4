//! The arrows of the architecture: which module may name which, and what may not occur at all.
//!
//! It reads sources, as a reader would: a path like `crate::plan` in a file of `symbolic` is an arrow.

#![expect(clippy::unwrap_used, reason = "a file that cannot be read is a broken test")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn workspace() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Path and code (without comments and test modules) of every Rust file under `folder` but `tests.rs`.
fn sources(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs")
                && !path.ends_with("tests.rs")
            {
                let shown = path.strip_prefix(folder).unwrap().to_str().unwrap().replace('\\', "/");
                found.push((shown, code(&fs::read_to_string(&path).unwrap())));
            }
        }
    }
    found.sort();
    found
}

/// Without line comments, and without what follows the first `#[cfg(test)]` (test modules stand last).
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]").next().unwrap();
    text.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

fn crate_sources(name: &str) -> Vec<(String, String)> {
    sources(&workspace().join(name).join("src"))
}

/// The first segments of all paths that start with `crate::`, also inside of `use crate::{a, b::c}`.
fn named_modules(code: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (place, start) in code.match_indices("crate::") {
        let rest = &code[place + start.len()..];
        let identifier = |text: &str| -> String {
            text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
        };
        if let Some(group) = rest.strip_prefix('{') {
            let mut depth = 0_usize;
            let mut fresh = true;
            for (i, c) in group.char_indices() {
                match c {
                    '{' => depth += 1,
                    '}' if depth == 0 => break,
                    '}' => depth -= 1,
                    ',' if depth == 0 => fresh = true,
                    c if fresh && (c.is_alphabetic() || c == '_') => {
                        names.insert(identifier(&group[i..]));
                        fresh = false;
                    }
                    _ => {}
                }
            }
        } else {
            names.insert(identifier(rest));
        }
    }
    names.remove("");
    names
}

/// What each stage of the compiler may name, besides itself and what every stage may name.
const ARROWS: &[(&str, &[&str])] = &[
    ("diagnostic", &[]),
    ("table", &[]),
    ("model", &["table"]),
    ("symbolic", &[]),
    ("plan", &["symbolic"]),
    ("verify", &["plan"]),
    ("emit", &["plan"]),
];

#[test]
fn stages_of_the_compiler_name_only_the_stage_before() {
    for (path, code) in crate_sources("codegen") {
        let stage = path.split(['/', '.']).next().unwrap();
        let Some((_, allowed)) = ARROWS.iter().find(|(name, _)| *name == stage) else {
            assert_eq!(path, "lib.rs", "a module without an arrow");
            continue;
        };
        for named in named_modules(&code) {
            // The model is the robot, whose types every stage may read.
            let everywhere = named == "diagnostic" || (named == "model" && stage != "diagnostic");
            let is_module = ARROWS.iter().any(|(name, _)| *name == named);
            let allowed = named == stage || everywhere || allowed.contains(&named.as_str());
            assert!(allowed || !is_module, "{path} names {named}");
        }
    }
}

/// What each module of the drivers may name.
const DRIVER_ARROWS: &[(&str, &[&str])] = &[
    ("clock", &[]),
    ("port", &["clock"]),
    ("driver", &["clock", "port", "motion"]),
    ("simulate", &["clock", "port"]),
    ("motion", &["clock", "driver"]),
    ("dynamixel", &["clock", "port", "driver", "simulate", "motion"]),
    ("mycobot", &["clock", "port", "driver", "simulate", "motion"]),
    ("unit", &["driver"]),
    ("connect", &["clock", "port", "driver", "simulate", "dynamixel", "mycobot"]),
    ("wheels", &[]),
    ("workspace_edge", &[]),
];

#[test]
fn modules_of_the_drivers_name_only_those_below() {
    for (path, code) in crate_sources("drivers") {
        if path.contains("/tests/") {
            continue;
        }
        let module = path.split(['/', '.']).next().unwrap();
        let Some((_, allowed)) = DRIVER_ARROWS.iter().find(|(name, _)| *name == module) else {
            assert_eq!(path, "lib.rs", "a module without an arrow");
            continue;
        };
        for named in named_modules(&code) {
            assert!(named == module || allowed.contains(&named.as_str()), "{path} names {named}");
        }
        // Of motion, devices know what moves an arm and nothing else.
        if module != "motion" {
            let others =
                code.matches("crate::motion").count() - code.matches("crate::motion::Command").count();
            assert_eq!(others, 0, "{path} names more of motion than its commands");
        }
        for word in ["dh_codegen", "dh_build", "dh_robots", "println!", "process::exit"] {
            assert!(!code.contains(word), "{path}: {word}");
        }
    }
}

#[test]
fn the_compiler_does_no_input_or_output() {
    for (path, code) in crate_sources("codegen") {
        for word in
            ["std::fs", "std::io", "std::env", "std::net", "std::process", "proc_macro", "clap", "println!"]
        {
            assert!(!code.contains(word), "{path}: {word}");
        }
    }
}

#[test]
fn the_table_stage_knows_no_geometry() {
    for (path, code) in crate_sources("codegen") {
        if !path.starts_with("table") {
            continue;
        }
        for word in ["dh_core", "Frame", "Rotation", "matrix", "compose", "transform"] {
            assert!(!code.contains(word), "{path}: {word}");
        }
    }
}

#[test]
fn a_plan_holds_no_language() {
    for (path, code) in crate_sources("codegen") {
        if !path.starts_with("plan") {
            continue;
        }
        for word in ["TokenStream", "quote!", "proc_macro2", "\"let ", "fn main"] {
            assert!(!code.contains(word), "{path}: {word}");
        }
    }
}

#[test]
fn the_runtime_has_no_heap_and_no_standard_library() {
    for name in ["core", "runtime"] {
        let files = crate_sources(name);
        let (_, root) = files.iter().find(|(path, _)| path == "lib.rs").unwrap();
        assert!(root.contains("#![no_std]"), "{name} is no_std");
        for (path, code) in &files {
            for word in ["std::", "alloc::", "extern crate", "Vec<", "Box<", "String"] {
                // `core::` paths end in no `std::`; nalgebra's own names do not occur here.
                let found = code
                    .match_indices(word)
                    .any(|(at, _)| !code[..at].ends_with(|c: char| c.is_alphanumeric()));
                assert!(!found, "{name}/{path}: {word}");
            }
        }
    }
}

#[test]
fn the_macro_only_calls() {
    let files = crate_sources("dh-macro");
    let lines: usize = files.iter().map(|(_, code)| code.lines().count()).sum();
    assert!(lines < 400, "dh-macro has {lines} lines: what it does belongs to dh-build or dh-codegen");
    for (path, code) in files {
        for word in ["dh_codegen::symbolic", "dh_codegen::plan", "std::fs"] {
            assert!(!code.contains(word), "{path}: {word}");
        }
    }
}

#[test]
fn generated_code_names_only_the_runtime_and_core() {
    for (path, code) in crate_sources("generated-demo") {
        // The arms are modules of their own; the crate's root and the demo programs are written by hand.
        if path == "lib.rs" || path.starts_with("bin/") {
            continue;
        }
        for (at, _) in code.match_indices("::") {
            let before: String =
                code[..at].chars().rev().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let root: String = before.chars().rev().collect();
            for foreign in ["std", "alloc", "nalgebra", "dh_core", "dh_codegen", "libm"] {
                let nested = code[..at - root.len()].ends_with("::");
                assert!(root != foreign || nested, "{path} names {foreign}");
            }
        }
    }
}

#[test]
fn the_oracle_shares_nothing_with_the_compiler() {
    for (path, code) in crate_sources("tests") {
        for word in ["dh_codegen", "dh_core", "dh_runtime", "dh_build"] {
            assert!(path.starts_with("engine") || !code.contains(word), "{path}: {word}");
        }
    }
}

/// A file holds one thing. What the compiler printed (`printed/`, `generated-demo`) is as long as the arm makes it.
#[test]
fn files_are_short() {
    let mut long = Vec::new();
    for name in
        ["core", "runtime", "robots", "codegen", "dh-build", "dh-macro", "cli", "tests", "bench", "drivers"]
    {
        for part in ["src", "tests", "benches"] {
            let folder = workspace().join(name).join(part);
            for (path, _) in if folder.is_dir() { sources(&folder) } else { Vec::new() } {
                let lines = fs::read_to_string(folder.join(&path)).unwrap().lines().count();
                if lines > 450 && !path.starts_with("printed/") {
                    long.push(format!("{name}/{part}/{path}: {lines}"));
                }
            }
        }
    }
    assert!(long.is_empty(), "more than one thing in {long:?}");
}

#[test]
fn arrows_are_found_in_all_spellings() {
    let names = |code| named_modules(code).into_iter().collect::<Vec<_>>();
    assert_eq!(names("use crate::plan::Step;"), ["plan"]);
    assert_eq!(
        names("use crate::{model::{Model, Row}, plan, symbolic::expr::Expr};"),
        ["model", "plan", "symbolic"]
    );
    assert_eq!(names("fn f(x: crate::table::Table) {}"), ["table"]);
    assert_eq!(code("use a; // crate::plan\n#[cfg(test)]\nmod tests { use crate::emit; }"), "use a; ");
}
