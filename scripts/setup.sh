#!/bin/sh
# Installs what the build needs beyond Rust and a C compiler: the HDF5 headers and pkg-config.
# Says what it does; does nothing when everything is there.
set -eu

say() { printf 'setup: %s\n' "$*"; }
fail() { printf 'setup: %s\n' "$@" >&2; exit 1; }
have() { command -v "$1" >/dev/null 2>&1; }

# True when the folder $1 holds HDF5's headers.
holds_hdf5() { [ -f "$1/H5pubconf.h" ] || [ -f "$1/H5pubconf-64.h" ]; }

# The places where the build looks for HDF5, in its order.
hdf5_is_there() {
    if [ -n "${HDF5_DIR:-}" ]; then
        holds_hdf5 "$HDF5_DIR/include"
    elif [ "$(uname -s)" = Darwin ]; then
        have brew && holds_hdf5 "$(brew --prefix hdf5 2>/dev/null)/include"
    else
        { have pkg-config && pkg-config --exists hdf5; } || holds_hdf5 /usr/include
    fi
}

# Runs a command as root, or says which command to run.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif have sudo && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
        sudo "$@"
    else
        fail "needs root for: $*" \
            "run it as root, or point HDF5_DIR at an HDF5 installation," \
            "or build the bundled HDF5 (needs CMake 3.26): cargo build --release -p subrope --features hdf5-static"
    fi
}

install_hdf5() {
    if have apt-get; then
        as_root sh -c 'apt-get update -q && DEBIAN_FRONTEND=noninteractive \
            apt-get install -q -y --no-install-recommends libhdf5-dev pkg-config'
    elif have dnf; then
        as_root dnf install -y hdf5-devel pkgconf-pkg-config
    elif have pacman; then
        as_root pacman -Sy --needed --noconfirm hdf5 pkgconf
    elif have zypper; then
        as_root zypper --non-interactive install hdf5-devel pkg-config
    elif have apk; then
        as_root apk add hdf5-dev pkgconf
    elif have brew; then
        brew install hdf5 pkgconf
    else
        fail "found none of apt-get, dnf, pacman, zypper, apk, brew: install the HDF5 library with its headers and" \
            "pkg-config by hand, or point HDF5_DIR at an HDF5 installation"
    fi
}

have cargo || fail "cargo is missing: install Rust 1.89 or newer (https://rustup.rs)"
have cc || have gcc || have clang || fail "a C compiler is missing: install gcc or clang"

if ! hdf5_is_there; then
    [ -z "${HDF5_DIR:-}" ] || fail "HDF5_DIR=$HDF5_DIR holds no include/H5pubconf.h: correct it or unset it"
    say "HDF5 headers not found: installing them with pkg-config"
    install_hdf5
    hdf5_is_there || fail "HDF5 was installed but is not found: point HDF5_DIR at it"
    say "HDF5 is installed"
fi
