"""What `#[dh_robot]` adds to a clean build of a crate with one arm, in the dev and in the release profile.

Makes three crates in a temporary folder, outside of this workspace and with default profiles: one that only names the
runtime, one with the attribute, and one with the code that the attribute stands for, pasted. Their dependencies are
built first; then each crate alone is built anew, several times in turn. Prints the medians; asserts nothing.

    python3 bench/macro_cost.py [TABLE [ROUNDS]]

TABLE is a table file or the name of a shipped table (mycobot).
"""

import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

WORKSPACE = pathlib.Path(__file__).resolve().parent.parent


def sources(generated: str) -> dict[str, str]:
    """Of each crate's library."""
    name = re.search(r"^pub struct (\w+)", generated, re.MULTILINE)[1]
    return {
        "without": f"pub use dh_runtime::Pose;\npub struct {name};\n",
        "attribute": f'use dh_runtime::dh_robot;\n#[dh_robot("arm.toml")]\npub struct {name};\n',
        "pasted": f"mod arm;\npub use arm::{name};\n",
    }


def make(folder: pathlib.Path, name: str, source: str, table: str, generated: str) -> pathlib.Path:
    """A crate of its own."""
    crate = folder / name
    (crate / "src").mkdir(parents=True)
    runtime = (WORKSPACE / "runtime").as_posix()
    (crate / "Cargo.toml").write_text(
        f'[package]\nname = "{name}"\nedition = "2024"\n\n'
        f'[dependencies]\ndh-runtime = {{ path = "{runtime}" }}\n\n[workspace]\n'
    )
    (crate / "src/lib.rs").write_text(source)
    (crate / "src/arm.rs").write_text(generated)
    (crate / "arm.toml").write_text(table)
    shutil.copy(WORKSPACE / "Cargo.lock", crate / "Cargo.lock")
    return crate


def cargo(crate: pathlib.Path, *arguments: str) -> float:
    """Runs cargo in the crate; the time that it took (s)."""
    target = crate.parent / "target"
    begin = time.perf_counter()
    subprocess.run(["cargo", *arguments, "--quiet", "--target-dir", str(target)], cwd=crate, check=True)
    return time.perf_counter() - begin


def dhc(*arguments: str) -> str:
    """What the command line prints."""
    command = ["cargo", "run", "--quiet", "--release", "-p", "dh-cli", "--", *arguments]
    return subprocess.run(command, cwd=WORKSPACE, check=True, capture_output=True, text=True).stdout


def measure(crates: dict[str, pathlib.Path], rounds: int, *profile: str) -> None:
    """Prints how long the crates take."""
    for crate in crates.values():
        cargo(crate, "build", *profile)
    times = {name: [] for name in crates}
    for _ in range(rounds):
        for name, crate in crates.items():
            cargo(crate, "clean", "--package", name, *profile)
            times[name].append(cargo(crate, "build", *profile))
    medians = {name: statistics.median(seconds) for name, seconds in times.items()}
    for name, seconds in times.items():
        print(f"  {name:10} {medians[name]:6.3f} ({min(seconds):.3f} to {max(seconds):.3f})")
    print(f"the attribute adds {medians['attribute'] - medians['without']:.3f} s,")
    print(f"of which {medians['pasted'] - medians['without']:.3f} s are the compiler's, for the generated code")


def main() -> None:
    name = sys.argv[1] if len(sys.argv) > 1 else "mycobot"
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    file = pathlib.Path(name) if pathlib.Path(name).exists() else WORKSPACE / f"robots/{name}.toml"
    generated = dhc("generate", str(file.resolve()))
    with tempfile.TemporaryDirectory() as folder:
        crates = {
            crate: make(pathlib.Path(folder), crate, source, file.read_text(), generated)
            for crate, source in sources(generated).items()
        }
        for profile in (), ("--release",):
            label = "release" if profile else "dev"
            print(f"clean {label} build of one crate, its dependencies built; median of {rounds}, s:", flush=True)
            measure(crates, rounds, *profile)


if __name__ == "__main__":
    main()
