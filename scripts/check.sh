#!/bin/sh
# Formatting, arrows between the crates, lints over every set of features, documentation.
# Arguments choose: format arrows lint doc; without any, all four.
set -eu
cd "$(dirname "$0")/.."
sh scripts/setup.sh

run() {
    printf '+ %s\n' "$*"
    "$@"
}

clippy() {
    run cargo clippy --quiet "$@" -- -D warnings
}

component() {
    cargo "$1" --version >/dev/null 2>&1 || rustup component add "$2"
}

format() {
    component fmt rustfmt
    run cargo fmt --all --check
    run cargo fmt --manifest-path examples/two_strands/Cargo.toml --check
}

arrows() {
    run python3 scripts/check_arrows.py
}

lint() {
    component clippy clippy
    clippy --workspace --all-targets
    # With fewer features what is shipped is checked, not its tests.
    clippy -p subrope-fem -p subrope-io -p subrope --no-default-features
    for features in contact hdf5 parallel cli "hdf5 parallel cli" "contact hdf5"; do
        clippy -p subrope --no-default-features --features "$features"
    done
    # What stands in the place of contact has tests of its own.
    clippy -p subrope --no-default-features --test without_contact
}

doc() {
    run env RUSTDOCFLAGS="-D warnings" cargo doc --quiet --workspace --no-deps
}

[ $# -gt 0 ] || set -- format arrows lint doc
for part in "$@"; do
    case $part in
    format | arrows | lint | doc) "$part" ;;
    *) printf 'check: unknown part %s; there are format, arrows, lint, doc\n' "$part" >&2 && exit 2 ;;
    esac
done
