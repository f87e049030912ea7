#!/bin/sh
# The tests that dissect graphs (or those that the arguments name) under valgrind: what they call holds the only unsafe code of
# the libraries, the two calls of METIS. (Others trip over optimised code of the standard library that valgrind misjudges.)
# Reads and writes of METIS beyond the arrays it is given, uninitialised numbers and leaks end in an error.
set -eu
cd "$(dirname "$0")/.."
command -v valgrind >/dev/null 2>&1 || { printf 'memcheck: valgrind is not installed\n' >&2 && exit 1; }
host=$(rustc -vV | sed -n 's/^host: //p' | tr 'a-z-' 'A-Z_')
leaks="--leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite"
export "CARGO_TARGET_${host}_RUNNER=valgrind --quiet --error-exitcode=9 $leaks"
export PROPTEST_CASES="${PROPTEST_CASES:-8}"
[ $# -gt 0 ] || set -- dissection cross_sections every_order
exec cargo test -p subrope-fem --lib -- "$@" --test-threads 1
