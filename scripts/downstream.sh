#!/bin/sh
# Builds and runs examples/two_strands on the packages of the crates, as they would be published, and on nothing else of
# this repository. In the profile of the tests, so that the dependencies are built already where the tests are.
set -eu
cd "$(dirname "$0")/.."

crates="subrope-geometry subrope-material subrope-fem subrope-contact"
target=${CARGO_TARGET_DIR:-target}
case $target in
/*) ;;
*) target=$PWD/$target ;;
esac
# Always the same place, so that the target folder does not fill up.
folder=$target/downstream
rm -rf "$folder"
mkdir -p "$folder"

packages=
for crate in $crates; do packages="$packages -p $crate"; done
# Together: each finds the others that it depends on, though none is published.
cargo package --quiet --no-verify --allow-dirty --no-metadata --target-dir "$folder/packages" $packages

set --
for crate in $crates; do
    archive=$(echo "$folder/packages/package/$crate"-[0-9]*.crate)
    # Files in a package are all of one date: with the date of today they count as changed.
    tar -xzmf "$archive" -C "$folder"
    unpacked=$folder/$(basename "$archive" .crate)
    for file in README.md LICENSE-MIT LICENSE-APACHE; do
        [ -s "$unpacked/$file" ] || { echo "downstream: $file is missing in the package of $crate" >&2; exit 1; }
    done
    set -- "$@" --config "patch.crates-io.$crate.path=\"$unpacked\""
done

# The profiles and the versions that the tests are built with; of both only what the example depends on is used.
awk '/^\[/ { keep = /^\[profile\.(dev|test)[].]/ && !/^\[profile\.test\.package\]/ } keep' Cargo.toml >"$folder/profiles.toml"
cp -R examples/two_strands "$folder/two_strands"
cp Cargo.lock "$folder/two_strands/"
cargo run --profile test --target-dir "$target" --manifest-path "$folder/two_strands/Cargo.toml" --config "$folder/profiles.toml" "$@"
