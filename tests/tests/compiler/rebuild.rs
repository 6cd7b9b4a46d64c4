//! The macro tracks its table: an edit rebuilds the crate, and so does the one that mends a mistake.

#![allow(clippy::expect_used, reason = "a test")]

use std::path::{Path, PathBuf};
use std::process::Command;

const MAIN: &str = "use dh_runtime::dh_robot;

#[dh_robot(\"arm.toml\")]
struct Arm;

fn main() {
    println!(\"{}\", Arm.fk(&[0.0]).translation.x);
}
";

fn table(length: &str) -> String {
    format!("[robot]\nname = \"Arm\"\nconvention = \"standard\"\n[[joint]]\na = {length}\n")
}

/// What the program prints, or what the compiler says.
fn run(folder: &Path) -> Result<String, String> {
    let output = Command::new(env!("CARGO"))
        .current_dir(folder)
        .args(["run", "--offline", "--quiet"])
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .output()
        .expect("cargo runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
}

#[test]
fn an_edit_of_the_table_rebuilds() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a folder of the workspace");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("rebuild");
    std::fs::create_dir_all(folder.join("src")).expect("a folder of our own");
    let write =
        |file: &str, text: &str| std::fs::write(folder.join(file), text).expect("a folder of our own");
    let runtime = root.join("runtime").display().to_string();
    write(
        "Cargo.toml",
        &format!(
            "[package]\nname = \"rebuild\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n\
             [dependencies]\ndh-runtime = {{ path = {runtime:?} }}\n\n[workspace]\n"
        ),
    );
    // The versions of the workspace, which are there already.
    let lock = std::fs::read_to_string(root.join("Cargo.lock")).expect("the workspace's lock file");
    write("Cargo.lock", &lock);
    write("src/main.rs", MAIN);

    write("arm.toml", &table("0.5"));
    assert_eq!(run(&folder), Ok("0.5".to_owned()));
    write("arm.toml", &table("0.75"));
    assert_eq!(run(&folder), Ok("0.75".to_owned()));

    write("arm.toml", &table("\"0.75 kg\""));
    let refusal = run(&folder).expect_err("a kilogram is no length");
    assert!(refusal.contains("arm.toml:5:"), "{refusal}");
    assert_eq!(
        refusal.matches("\nerror").count() + usize::from(refusal.starts_with("error")),
        2,
        "{refusal}"
    );

    write("arm.toml", &table("0.25"));
    assert_eq!(run(&folder), Ok("0.25".to_owned()));
}
