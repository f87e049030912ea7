#!/bin/sh
# Runs the examples in the documentation and all tests, these with nextest when it is installed.
# Tests that read result files with VTK take the environment of scripts/venv.sh when it has been made.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh
if [ -z "${SUBROPE_VTK_PYTHON:-}" ] && [ -x target/venv/bin/python ]; then
    export SUBROPE_VTK_PYTHON="$PWD/target/venv/bin/python"
fi
if cargo nextest --version >/dev/null 2>&1; then
    cargo test --workspace --doc
    cargo nextest run --workspace --no-fail-fast "$@"
else
    cargo test --workspace --no-fail-fast "$@"
fi
