"""What `#[dh_robot("mycobot")]` adds to a clean dev build of a crate with one arm.

Makes three crates in a temporary folder, outside of this workspace and with default profiles: one that only names the
runtime, one with the attribute, and one with the code that the attribute stands for, pasted. Their dependencies are
built first; then each crate alone is built anew, several times in turn. Prints the medians; asserts nothing.

    python3 bench/macro_cost.py [ROUNDS]
"""

import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

WORKSPACE = pathlib.Path(__file__).resolve().parent.parent
ARM = "mycobot"
STRUCT = "MyCobot280Pi"
USE = "fn main() { println!(\"{}\", %s.fk(&[0.1; 6])); }\n"

SOURCES = {
    "without": "use dh_runtime::Pose;\nstruct None;\n"
    "impl None { fn fk(&self, _: &[f64; 6]) -> Pose { Pose::identity() } }\n" + USE % "None",
    "attribute": f"use dh_runtime::dh_robot;\n#[dh_robot(\"{ARM}\")]\nstruct {STRUCT};\n" + USE % STRUCT,
    "pasted": f"mod {ARM};\nuse {ARM}::{STRUCT};\n" + USE % STRUCT,
}


def make(folder: pathlib.Path, name: str, source: str) -> pathlib.Path:
    """A crate of its own."""
    crate = folder / name
    (crate / "src").mkdir(parents=True)
    runtime = (WORKSPACE / "runtime").as_posix()
    (crate / "Cargo.toml").write_text(
        f'[package]\nname = "{name}"\nedition = "2024"\n\n'
        f'[dependencies]\ndh-runtime = {{ path = "{runtime}" }}\n\n[workspace]\n'
    )
    (crate / "src/main.rs").write_text(source)
    shutil.copy(WORKSPACE / "Cargo.lock", crate / "Cargo.lock")
    if name == "pasted":
        shutil.copy(WORKSPACE / f"generated-demo/src/{ARM}.rs", crate / "src")
    return crate


def cargo(crate: pathlib.Path, *arguments: str) -> float:
    """Runs cargo in the crate; the time that it took (s)."""
    target = crate.parent / "target"
    begin = time.perf_counter()
    subprocess.run(["cargo", *arguments, "--quiet", "--target-dir", str(target)], cwd=crate, check=True)
    return time.perf_counter() - begin


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    with tempfile.TemporaryDirectory() as folder:
        crates = {name: make(pathlib.Path(folder), name, source) for name, source in SOURCES.items()}
        print("building the dependencies ...", flush=True)
        for crate in crates.values():
            cargo(crate, "build")
        times = {name: [] for name in crates}
        for _ in range(rounds):
            for name, crate in crates.items():
                cargo(crate, "clean", "--package", name)
                times[name].append(cargo(crate, "build"))
    medians = {name: statistics.median(seconds) for name, seconds in times.items()}
    print(f"clean dev build of one crate, its dependencies built; median of {rounds} (least to greatest), s:")
    for name, seconds in times.items():
        print(f"  {name:10} {medians[name]:6.3f} ({min(seconds):.3f} to {max(seconds):.3f})")
    print(f"the attribute adds {medians['attribute'] - medians['without']:.3f} s,")
    print(f"of which {medians['pasted'] - medians['without']:.3f} s are the compiler's, for the generated code")


if __name__ == "__main__":
    main()
