#!/bin/sh
# Runs the studies in studies/ and copies their tables and charts to docs/studies.
# Arguments choose studies by name: sh scripts/studies.sh hertz bent_strand_20. Without any, all of them.
# SUBROPE is a program built already, OPTIONS go to `subrope study` (--resume keeps what has run).
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh
program=${SUBROPE:-target/release/subrope}
if [ -z "${SUBROPE:-}" ]; then
    cargo build --release -p subrope
fi
[ $# -gt 0 ] || set -- $(basename -s .toml studies/*.toml)
mkdir -p docs/studies
for name in "$@"; do
    "$program" study "studies/$name.toml" --out "out/studies/$name" ${OPTIONS:-}
    for file in study.md study.csv; do
        cp "out/studies/$name/$file" "docs/studies/$name.${file##*.}"
    done
    for chart in "out/studies/$name"/*_time.svg "out/studies/$name"/*_memory.svg; do
        [ ! -e "$chart" ] || cp "$chart" "docs/studies/${name}_$(basename "$chart")"
    done
done
