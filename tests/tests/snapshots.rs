//! Printed code of every shipped table, committed to be read and compiled: `generated-demo/src/<name>.rs`.
//!
//! `UPDATE_EXPECT=1 cargo test -p dh-tests --test snapshots` rewrites what is stale.

#![expect(clippy::unwrap_used, reason = "a file that cannot be read or written is a broken test")]

use dh_build::Source;
use dh_codegen::emit::rust::{self, Options};
use dh_codegen::verify::Level;
use dh_codegen::{Output, compile};
use std::fs;
use std::path::{Path, PathBuf};

const REFRESH: &str = "UPDATE_EXPECT=1 cargo test -p dh-tests --test snapshots";

/// Every shipped table by the name under which `dhc` knows it, with what the compiler makes of it.
fn shipped() -> impl Iterator<Item = (&'static str, Source, Output)> {
    dh_robots::names().map(|name| {
        let source = Source {
            name_shown: name.to_owned(),
            path: None,
            text: dh_robots::table(name).unwrap().to_owned(),
        };
        let output = compile(&source.text, Level::Full).output.unwrap();
        (name, source, output)
    })
}

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Holds a committed file against what is printed now, or rewrites it where that is asked for.
fn is_stale(path: &Path, printed: &str) -> bool {
    // A checkout may have turned the ends of lines into those of its system.
    let committed = fs::read_to_string(path).unwrap_or_default().replace("\r\n", "\n");
    let stale = committed != printed;
    if stale && std::env::var_os("UPDATE_EXPECT").is_some() {
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

#[test]
fn generated_code_is_what_is_printed() {
    let folder = workspace().join("generated-demo/src");
    let stale: Vec<_> = shipped()
        .filter(|(name, source, output)| {
            let options = Options { table: source.name_shown.clone(), ..Options::default() };
            let code = rust::print(&output.model, &output.plan, &options);
            is_stale(&folder.join(name).with_extension("rs"), &code)
        })
        .map(|(name, ..)| name)
        .collect();
    assert!(stale.is_empty(), "generated-demo/src is stale for {stale:?}: {REFRESH}");
}

/// A module without a table would be compiled, and tell its reader something that nobody prints any more.
#[test]
fn every_committed_module_has_its_table() {
    let folder = workspace().join("generated-demo/src");
    let mut expected: Vec<_> = dh_robots::names().map(str::to_owned).collect();
    expected.push("lib".to_owned());
    expected.sort();
    assert_eq!(stems(&folder, "rs"), expected);
    let library = fs::read_to_string(folder.join("lib.rs")).unwrap();
    for name in dh_robots::names() {
        assert!(
            library.contains(&format!("pub mod {name};")),
            "generated-demo/src/lib.rs does not declare {name}"
        );
    }
}
