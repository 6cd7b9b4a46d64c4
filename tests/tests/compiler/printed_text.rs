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

/// In degrees an angle of a closed form is 0.0174... times one in radians; a length is a length.
#[test]
fn slides_that_are_found_along_with_angles_are_written_as_lengths() {
    let table = "[robot]\nname = \"Slides\"\nconvention = \"standard\"\nunits = { length = \"mm\", angle = \"deg\" }\n\
        [[joint]]\na = 120\nalpha = 90\nd = 300\n[[joint]]\ntype = \"prismatic\"\na = 200\nalpha = 70\n\
        [[joint]]\na = 150\nalpha = -40\nd = 90\n[[joint]]\na = 90\nalpha = 60\nd = 40\n\
        [[joint]]\ntype = \"prismatic\"\na = 60\nalpha = 80\n[[joint]]\nd = 100\noffset = 30\n";
    let output = dh_codegen::compile(table, dh_codegen::verify::Level::Quick).output.unwrap();
    let options = dh_codegen::emit::text::Options {
        part: dh_codegen::emit::text::Part::InverseKinematics,
        numeric: false,
    };
    let text = dh_codegen::emit::text::print(&output.model, &output.plan, &options);
    for line in ["Step 1: all joints", "q1 = theta1", "q2 = d2", "q5 = d5", "q6 = theta6 - 30"] {
        assert!(text.contains(&format!("{line}\n")) || text.contains(&format!("{line}, ")), "{line}\n{text}");
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
