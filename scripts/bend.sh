#!/bin/sh
# Builds and runs the main job: a twisted strand bent by turning its ends.
# Options go to `subrope run`.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh
exec cargo run --release -p subrope -- run scenes/bent_strand.toml --out out/bent_strand "$@"
