#!/bin/sh
# Fuzzes the parsers of scenes, decks, tables and checkpoints, one after the other, on one core.
# Arguments: seconds for each (60), then which (scene deck table checkpoint). Needs a nightly compiler (rustup toolchain
# install nightly) and cargo-fuzz (cargo install cargo-fuzz). Inputs that break something are kept in fuzz/artifacts; what
# is new is merged into fuzz/corpus, which the tests run through.
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-60}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- scene deck table checkpoint
root=$PWD
# Work and corpus are apart: only what adds something is kept.
work=${SUBROPE_FUZZ_WORK:-$root/target/fuzz-work}
export CARGO_TARGET_DIR="$root/target/fuzz"

cd fuzz
cargo +nightly fuzz build -s none --release

# Seeds are read, not changed: those that were made, and files of the project.
seeds() {
    [ ! -d "seeds/$1" ] || printf '%s\n' "seeds/$1"
    case $1 in
    scene) printf '%s\n' "$root/scenes" ;;
    deck) printf '%s\n' "$root/crates/io/tests/data/two_bricks" ;;
    *) ;;
    esac
}

# Lengths: a scene of 4 kB says everything that a scene can say; a checkpoint of the small model has 10 kB.
length() {
    case $1 in checkpoint) echo 12000 ;; *) echo 4096 ;; esac
}

for target in "$@"; do
    mkdir -p "$work/$target" "artifacts/$target" "corpus/$target"
    program="$CARGO_TARGET_DIR/x86_64-unknown-linux-gnu/release/$target"
    [ -x "$program" ] || program=$(find "$CARGO_TARGET_DIR" -path "*/release/$target" -type f | head -n 1)
    dictionary=
    [ ! -f "dictionaries/$target" ] || dictionary="-dict=dictionaries/$target"
    # shellcheck disable=SC2086,SC2046
    nice -n 10 "$program" "$work/$target" "corpus/$target" $(seeds "$target") $dictionary \
        -max_total_time="$seconds" -timeout=5 -rss_limit_mb=2048 -malloc_limit_mb=1024 -max_len="$(length "$target")" \
        -artifact_prefix="artifacts/$target/" -print_final_stats=1 -verbosity=1
    # The smallest inputs that reach everything.
    rm -rf "$work/$target.least"
    mkdir -p "$work/$target.least"
    nice -n 10 "$program" -merge=1 -max_len="$(length "$target")" "$work/$target.least" "corpus/$target" "$work/$target" \
        >"$work/$target.log" 2>&1
    find "$work/$target.least" -type f -size -4096c -exec cp {} "corpus/$target/" \;
done
