"""No dependency may need a newer compiler than the workspace promises (`rust-version`)."""

import json
import subprocess
import sys

command = ["cargo", "metadata", "--format-version", "1", "--locked", "--all-features"]
metadata = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
members = set(metadata["workspace_members"])


def version(text):
    """(1, 89, 0) of "1.89"; nothing is promised where nothing is said."""
    numbers = [int(part) for part in (text or "0").split(".")]
    return tuple(numbers + [0] * (3 - len(numbers)))


packages = metadata["packages"]
ours = {package["name"]: package["rust_version"] for package in packages if package["id"] in members}
promised = set(ours.values())
if len(promised) != 1 or None in promised:
    sys.exit(f"the crates of the workspace promise different compilers: {ours}")
promise = promised.pop()
newer = [package for package in packages if version(package["rust_version"]) > version(promise)]
for package in newer:
    print(f"{package['name']} {package['version']} needs Rust {package['rust_version']}", file=sys.stderr)
if newer:
    sys.exit(f"the workspace promises Rust {promise}")
print(f"Rust {promise} is enough for all {len(packages)} packages")
