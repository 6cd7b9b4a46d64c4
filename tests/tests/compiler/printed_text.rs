//! Printed Rust as text: that of hand-written plans is committed, to be read and to be compiled by the test `printed`.
//! `UPDATE_EXPECT=1` rewrites it.

#[path = "../plans/mod.rs"]
mod plans;

use dh_codegen::emit::rust::{Options, ScalarType, Types, print};
use dh_codegen::model::Model;
use dh_codegen::plan::Plan;
use std::path::Path;
use std::process::Command;

const PLAIN_F32: (ScalarType, Types) = (ScalarType::F32, Types::Plain);

fn printed((model, plan): &(Model, Plan), (scalar, types): (ScalarType, Types), table: &str) -> String {
    let options = Options { scalar, types, table: table.to_owned(), ..Options::default() };
    print(model, plan, &options)
}

#[test]
fn committed_texts_are_what_is_printed() {
    let defaults = <(ScalarType, Types)>::default();
    let texts = [
        ("planar", printed(&plans::planar(), defaults, "planar.toml")),
        ("planar_plain_f32", printed(&plans::planar(), PLAIN_F32, "planar.toml")),
        ("every_target", printed(&plans::every_target(), defaults, "every_target.toml")),
        ("every_target_plain_f32", printed(&plans::every_target(), PLAIN_F32, "every_target.toml")),
        ("polar", printed(&plans::polar(), defaults, "polar.toml")),
    ];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/printed");
    for (name, text) in texts {
        let path = folder.join(name).with_extension("rs");
        if std::env::var_os("UPDATE_EXPECT").is_some() {
            std::fs::write(&path, &text).expect("the folder can be written to");
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(committed == text, "tests/printed/{name}.rs is stale: run this test with UPDATE_EXPECT=1");
    }
}

#[test]
fn texts_are_laid_out_as_rustfmt_would() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/printed");
    let defaults = folder.join("rustfmt.toml");
    for name in
        ["planar.rs", "planar_plain_f32.rs", "polar.rs", "every_target.rs", "every_target_plain_f32.rs"]
    {
        let command = Command::new("rustfmt")
            .args(["--check", "--edition", "2024", "--config-path"])
            .args([&defaults, &folder.join(name)])
            .output();
        // Where there is no rustfmt there is nothing to compare with.
        let Ok(output) = command else { return };
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}
