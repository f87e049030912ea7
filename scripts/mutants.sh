#!/bin/sh
# Changes the laws of the material and the projection, pressure and friction of contact at one place at a time, and runs the
# tests of the crate on every such mutant. Arguments: material, contact (both); after `--` what goes to cargo mutants, e.g.
# `-- --shard 0/10 --sharding round-robin` for every tenth mutant, `-- --iterate` for those not caught last time.
# Needs cargo install cargo-mutants and cargo-nextest. Results in out/mutants/CRATE/mutants.out; the mutants are in order of
# chance, so that a run that is stopped is a sample. The exit code is that of cargo mutants: 2 when a mutant is missed.
set -eu
cd "$(dirname "$0")/.."
crates=
while [ $# -gt 0 ] && [ "$1" != -- ]; do
    crates="$crates $1"
    shift
done
[ $# -eq 0 ] || shift
status=0
for crate in ${crates:-material contact}; do
    case $crate in
    material) files="crates/material/src/**/*.rs" ;;
    contact) files="crates/contact/src/{foot,law,kernel}.rs" ;;
    *)
        echo "material or contact, not $crate" >&2
        exit 64
        ;;
    esac
    mkdir -p "out/mutants/$crate"
    cargo mutants --package "subrope-$crate" --file "$files" --shuffle --jobs 1 --output "out/mutants/$crate" "$@" ||
        status=$?
done
exit $status
