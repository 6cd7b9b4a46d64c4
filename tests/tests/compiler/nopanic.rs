//! Generated code cannot panic: that of all shipped arms is linked, optimised, into a library without the standard one
//! whose panic handler calls what does not exist. Whatever could panic would keep the handler, and the link would fail.

#![allow(clippy::expect_used, reason = "a test")]

use dh_codegen::emit::rust::{Options, print};
use dh_tests::engine;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

const HEAD: &str = "#![no_std]

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern \"C\" {
        safe fn this_code_can_panic() -> !;
    }
    this_code_can_panic()
}
";

/// Panics: shows that the link fails where it should.
const CONTROL: &str = "
#[unsafe(no_mangle)]
pub extern \"C\" fn control(index: usize) -> u8 {
    [1, 2, 3][index]
}
";

/// A library may leave symbols to others; this one may not. Copying memory is the C library's.
const LINK: &str = "fn main() {
    println!(\"cargo::rustc-link-arg-cdylib=-Wl,--no-undefined\");
    println!(\"cargo::rustc-link-arg-cdylib=-lc\");
}
";

/// The crates, with which arms: two halves, for the optimiser has one thread a crate, and the one that panics.
const CRATES: [(&str, usize, usize); 3] = [("first", 0, 2), ("second", 1, 2), ("control", 0, usize::MAX)];

fn workspace() -> String {
    let names = CRATES.map(|(name, ..)| format!("{name:?}")).join(", ");
    format!(
        "[workspace]
resolver = \"3\"
members = [{names}]

[profile.release]
panic = \"abort\"
lto = \"fat\"
codegen-units = 1
"
    )
}

fn manifest(name: &str, root: &Path) -> String {
    let runtime = root.join("runtime").display().to_string();
    format!(
        "[package]
name = {name:?}
version = \"0.0.0\"
edition = \"2024\"

[lib]
crate-type = [\"cdylib\"]

[dependencies]
dh-runtime = {{ path = {runtime:?}, default-features = false, features = [\"nalgebra\"] }}
"
    )
}

/// A method, from its name on, as a pointer; one that takes free values in any form, with an array of them.
fn pointer(method: &str) -> String {
    let (name, rest) = method.split_once('(').expect("a parameter list");
    let (parameters, _) = rest.split_once("->").unwrap_or((rest, ""));
    let Some((before, count)) = parameters.split_once("impl FreeValues<") else {
        return format!("{name} as *const ()");
    };
    let count = count.split('>').next().unwrap_or("1");
    let others = "_, ".repeat(before.matches(',').count());
    format!("{name} as fn({others}[f64; {count}]) -> _ as *const ()")
}

/// The code of an arm, and a function that hands out everything in it.
fn arm(name: &str) -> (String, String) {
    let compilation = engine::compiled(name).expect("a shipped table");
    let output = compilation.output.as_ref().expect("shipped tables have no mistakes");
    let code =
        print(&output.model, &output.plan, &Options { name: Some("Arm".to_owned()), ..Options::default() });
    let methods = code.split("\n    pub fn ").skip(1).map(pointer);
    let mut keep = format!(
        "mod {name};
#[unsafe(no_mangle)]
pub extern \"C\" fn trait_{name}(keep: &mut &'static dyn dh_runtime::Kinematics) {{
    *keep = &{name}::Arm;
}}
#[unsafe(no_mangle)]
pub extern \"C\" fn methods_{name}(which: usize) -> *const () {{
    match which {{
"
    );
    for (i, method) in methods.enumerate() {
        writeln!(keep, "        {i} => {name}::Arm::{method},").expect("a string takes it");
    }
    keep += "        _ => core::ptr::null(),\n    }\n}\n";
    (code, keep)
}

/// A crate with the code of some arms.
fn write(folder: &Path, root: &Path, (name, first, step): (&str, usize, usize)) {
    let folder = folder.join(name);
    std::fs::create_dir_all(folder.join("src")).expect("a folder of our own");
    let write =
        |file: &str, text: &str| std::fs::write(folder.join(file), text).expect("a folder of our own");
    write("Cargo.toml", &manifest(name, root));
    write("build.rs", LINK);
    let mut library = HEAD.to_owned();
    if name == "control" {
        library += CONTROL;
    }
    for name in dh_robots::names().skip(first).step_by(step) {
        let (code, keep) = arm(name);
        write(&format!("src/{name}.rs"), &code);
        library += &keep;
    }
    write("src/lib.rs", &library);
}

fn build(folder: &Path, crates: &[&str]) -> std::process::Output {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(folder).args(["build", "--release", "--offline", "--quiet"]);
    for name in crates {
        cargo.args(["--package", name]);
    }
    cargo
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS");
    cargo.output().expect("cargo runs")
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "the linker is told in the words of GNU's")]
fn generated_code_cannot_panic() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a folder of the workspace");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("nopanic");
    for which in CRATES {
        write(&folder, root, which);
    }
    let write =
        |file: &str, text: &str| std::fs::write(folder.join(file), text).expect("a folder of our own");
    write("Cargo.toml", &workspace());
    // The versions of the workspace, which are there already.
    write(
        "Cargo.lock",
        &std::fs::read_to_string(root.join("Cargo.lock")).expect("the workspace's lock file"),
    );
    let halves = build(&folder, &["first", "second"]);
    assert!(halves.status.success(), "{}", String::from_utf8_lossy(&halves.stderr));
    let control = build(&folder, &["control"]);
    let message = String::from_utf8_lossy(&control.stderr);
    assert!(!control.status.success() && message.contains("this_code_can_panic"), "{message}");
}
