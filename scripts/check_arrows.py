#!/usr/bin/env python3
"""Checks that every crate depends only on what its place in the architecture allows.

Reads `cargo metadata` and compares each package's normal and build dependencies with the table below;
development dependencies are free. Exit code 1 and one line per forbidden arrow when it does not hold.
"""

import json
import subprocess
import sys

ALLOWED = {
    "subrope-geometry": {"nalgebra", "thiserror"},
    "subrope-material": {"nalgebra", "thiserror"},
    "subrope-fem": {
        "subrope-geometry", "subrope-material",
        "faer", "metis", "nalgebra", "pulp", "rayon", "thiserror",
    },
    "subrope-contact": {
        "subrope-geometry", "subrope-fem",
        "nalgebra", "parry3d-f64", "thiserror",
    },
    "subrope-io": {
        "subrope-geometry",
        "crc32fast", "hdf5-metno", "nalgebra", "rustix", "serde", "serde_json", "thiserror",
    },
}  # fmt: skip
# The top crate and the packages that only test and measure may use anything.
FREE = {"subrope", "subrope-benches", "subrope-tests"}


def packages():
    command = ["cargo", "metadata", "--format-version", "1", "--no-deps"]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["packages"]


def faults(package):
    name = package["name"]
    if name in FREE:
        return []
    if name not in ALLOWED:
        return [f"{name}: unknown package; give it a line in scripts/check_arrows.py"]
    used = {d["name"] for d in package["dependencies"] if d["kind"] != "dev"}
    return [f"{name} -> {other}: this arrow is not allowed" for other in sorted(used - ALLOWED[name])]


def main():
    found = [fault for package in packages() for fault in faults(package)]
    for fault in found:
        print(f"arrows: {fault}", file=sys.stderr)
    if found:
        sys.exit(1)
    print("arrows: every crate depends only on what it may")


if __name__ == "__main__":
    main()
