#!/bin/sh
# Runs the families of extreme scenes and puts the table into docs/stress.md, below its explanation.
# SUBROPE is a program built already; arguments go to `subrope stress` (--only FAMILY leaves the document alone).
# The exit code is that of `subrope stress`: 1 when a member FAILS.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh
program=${SUBROPE:-target/release/subrope}
if [ -z "${SUBROPE:-}" ]; then
    cargo build --release -p subrope
fi
status=0
"$program" stress --out out/stress "$@" || status=$?
if [ $# -eq 0 ] && [ "$status" -le 1 ]; then
    sed '/^<!-- table -->$/q' docs/stress.md >out/stress/explained.md
    { cat out/stress/explained.md; echo; cat out/stress/stress.md; } >docs/stress.md
    rm out/stress/explained.md
fi
exit "$status"
