#!/bin/sh
# Makes a Python environment with the VTK wheel under target/venv, unless it is there, and prints its interpreter.
set -eu
cd "$(dirname "$0")/.."
venv=target/venv
if ! "$venv/bin/python" -c 'import numpy, vtkmodules' >/dev/null 2>&1; then
    printf 'installing the Python packages vtk and numpy into %s\n' "$venv" >&2
    mkdir -p target
    python3 -m venv --clear "$venv" >&2
    # Without the packages that VTK wants for plots: nothing here draws plots.
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps vtk numpy >&2
fi
printf '%s\n' "$venv/bin/python"
