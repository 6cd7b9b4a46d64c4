//! What is printed for the shipped tables that `generated-demo/src/lib.rs` declares, committed: code to be read and
//! compiled, `generated-demo/src/<name>.rs`, and equations to be read, `tests/snapshots/<name>.txt`. They stand for the
//! classes of arms; what is printed for the other tables is compiled and run by `generated` and `nopanic`.
//!
//! `UPDATE_EXPECT=1 cargo test -p dh-tests --test compiler snapshots` rewrites what is stale.

#![expect(clippy::unwrap_used, reason = "a file that cannot be read or written is a broken test")]

use dh_codegen::Output;
use dh_codegen::emit::text::Part;
use dh_codegen::emit::{rust, text};
use dh_tests::engine;
use std::fs;
use std::path::{Path, PathBuf};

const REFRESH: &str = "UPDATE_EXPECT=1 cargo test -p dh-tests --test compiler snapshots";

/// The tables whose code is committed, in alphabetical order.
fn committed() -> Vec<String> {
    let library = fs::read_to_string(workspace().join("generated-demo/src/lib.rs")).unwrap();
    let modules = library.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    modules.map(str::to_owned).collect()
}

/// They, with what the compiler makes of them.
fn compiled() -> impl Iterator<Item = (String, &'static Output)> {
    committed().into_iter().map(|name| {
        let output = engine::compiled(&name).unwrap().output.as_ref().unwrap();
        (name, output)
    })
}

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn is_refreshing() -> bool {
    std::env::var_os("UPDATE_EXPECT").is_some()
}

/// Holds a committed file against what is printed now, or rewrites it where that is asked for.
fn is_stale(path: &Path, printed: &str) -> bool {
    // A checkout may have turned the ends of lines into those of its system.
    let committed = fs::read_to_string(path).unwrap_or_default().replace("\r\n", "\n");
    let stale = committed != printed;
    if stale && is_refreshing() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, printed).unwrap();
        return false;
    }
    stale
}

/// Files with this ending in a folder, by stem, in alphabetical order.
fn stems(folder: &Path, ending: &str) -> Vec<String> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = files.filter(|path| path.extension().is_some_and(|extension| extension == ending));
    let mut stems: Vec<_> =
        files.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    stems.sort();
    stems
}

fn are_fresh(folder: &str, ending: &str, print: impl Fn(&str, &Output) -> String) {
    let stale: Vec<_> = compiled()
        .filter(|(name, output)| {
            let path = workspace().join(folder).join(name).with_extension(ending);
            is_stale(&path, &print(name, output))
        })
        .map(|(name, _)| name)
        .collect();
    assert!(stale.is_empty(), "{folder} is stale for {stale:?}: {REFRESH}");
}

#[test]
fn generated_code_is_what_is_printed() {
    are_fresh("generated-demo/src", "rs", |name, output| {
        let options = rust::Options { table: name.to_owned(), ..rust::Options::default() };
        rust::print(&output.model, &output.plan, &options)
    });
}

#[test]
fn equations_are_what_is_printed() {
    are_fresh("tests/snapshots", "txt", |_, output| {
        text::print(&output.model, &output.plan, &text::Options { part: Part::All, numeric: false })
    });
}

/// What is not declared would not be compiled, nor held against what is printed.
#[test]
fn every_committed_file_is_declared() {
    // The other tests may be writing what is looked for.
    if is_refreshing() {
        return;
    }
    let mut names = committed();
    assert_eq!(stems(&workspace().join("tests/snapshots"), "txt"), names);
    names.push("lib".to_owned());
    names.sort();
    assert_eq!(stems(&workspace().join("generated-demo/src"), "rs"), names);
}
