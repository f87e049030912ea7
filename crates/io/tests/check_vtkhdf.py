#!/usr/bin/env python3
"""Reads a result file with VTK's own reader and checks what a viewer would show.

    python check_vtkhdf.py RESULT.vtkhdf [--steps N] [--points N] [--cells N]
        [--field point:NAME:COMPONENTS]... [--varying NAME]... [--all-varying] [--constant NAME]...
        [--warp NAME] [--static]

Checked: the file opens; step values increase; at every step the numbers of points and cells are the same, all cells
are hexahedra of a supported type, every array is there with the same shape and finite. Arrays named by --varying
(default: the one of --warp) differ between consecutive steps; with --all-varying every array except those named by
--constant differs between some steps. Points warped by the displacement enclose cells of positive volume at every step.
--static checks a mesh without steps. A file of one step looks to VTK like one without.
Prints a table; exit code 0 if all is well, 1 otherwise.
Needs VTK 9.3 or newer and NumPy.
"""
import argparse
import sys

import numpy as np

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkVersion
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
    from vtkmodules.vtkFiltersGeneral import vtkWarpVector
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError as error:
    sys.exit(f"VTK is not installed ({error}): pip install vtk")

HEXAHEDRA = {12, 25, 29}
LOCATIONS = (("point", lambda grid: grid.GetPointData()), ("cell", lambda grid: grid.GetCellData()))


class Failure(Exception):
    """Something a viewer would show wrongly."""


def require(condition, message):
    if not condition:
        raise Failure(message)


def arrays_of(grid):
    """All arrays of a grid by (location, name), copied: the reader reuses its memory."""
    found = {}
    for location, data_of in LOCATIONS:
        data = data_of(grid)
        for i in range(data.GetNumberOfArrays()):
            array = data.GetArray(i)
            require(array is not None, f"{location} array {i} is not numeric")
            found[location, array.GetName()] = np.array(vtk_to_numpy(array), copy=True)
    return found


def mesh_of(grid):
    types = set(np.unique(vtk_to_numpy(grid.GetCellTypes()))) if grid.GetNumberOfCells() else set()
    require(types and types <= HEXAHEDRA, f"cell types {sorted(types)}, not hexahedra")
    return np.array(vtk_to_numpy(grid.GetPoints().GetData()), copy=True)


def corner_volumes(grid):
    """Volume of the corner parallelepipeds at the first node of every cell: positive unless turned inside out."""
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    offsets = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    origin, x, y, z = (points[cells[offsets[:-1] + corner]] for corner in (0, 1, 3, 4))
    return np.einsum("ij,ij->i", np.cross(x - origin, y - origin), z - origin)


def warped(reader, name):
    warp = vtkWarpVector()
    warp.SetInputConnection(reader.GetOutputPort())
    warp.SetInputArrayToProcess(0, 0, 0, 0, name)
    warp.Update()
    return warp.GetOutput()


def check_step(reader, step, options):
    """Arrays and points of a step, checked by themselves."""
    grid = reader.GetOutput()
    where = f"step {step}: "
    points = mesh_of(grid)
    require(np.isfinite(points).all(), where + "coordinates are not finite")
    counts = ((grid.GetNumberOfPoints(), options.points, "points"), (grid.GetNumberOfCells(), options.cells, "cells"))
    for got, expected, what in counts:
        require(expected is None or got == expected, where + f"{got} {what} instead of {expected}")
    arrays = arrays_of(grid)
    for (location, name), values in arrays.items():
        require(np.isfinite(values).all(), where + f"{location} array {name} is not finite")
    for location, name, components in options.field:
        values = arrays.get((location, name))
        require(values is not None, where + f"{location} array {name} is missing")
        got = 1 if values.ndim == 1 else values.shape[1]
        require(got == components, where + f"{name} has {got} components instead of {components}")
    if options.warp:
        require(("point", options.warp) in arrays, where + f"point array {options.warp} is missing")
        moved = warped(reader, options.warp)
        got, expected = vtk_to_numpy(moved.GetPoints().GetData()), points + arrays["point", options.warp]
        scale = max(1.0, float(np.abs(expected).max()))
        require(np.abs(got - expected).max() <= 1e-5 * scale, where + "the warped points are not X + u")
        smallest = corner_volumes(moved).min()
        require(smallest > 0, where + f"a warped cell has the corner volume {smallest:g}")
    return points, arrays


def check_changes(steps, options):
    """Arrays that must differ between steps."""
    first = steps[0][1]
    for (location, name) in first:
        values = [arrays[location, name] for _, arrays in steps]
        same = [np.array_equal(a, b) for a, b in zip(values, values[1:])]
        if name in options.varying:
            at = same.index(True) if True in same else None
            require(at is None, f"{location} array {name} at step {at} is the same as at the step after")
        elif name in options.constant:
            require(all(same), f"{location} array {name} changes, but is said to be constant")
        elif options.all_varying:
            require(not all(same), f"{location} array {name} is the same at all steps")
    known = {name for _, name in first}
    for name in [*options.varying, *options.constant]:
        require(name in known, f"array {name} is missing")


def listen(reader):
    """Collects what VTK would only print."""
    errors = []

    def note(caller, event, text="unknown"):
        errors.append(text.strip())

    note.CallDataType = "string0"
    reader.AddObserver("ErrorEvent", note)
    reader.GetExecutive().AddObserver("ErrorEvent", note)
    return errors


def check(options):
    reader = vtkHDFReader()
    require(reader.CanReadFile(options.file), "VTK cannot read the file")
    errors = listen(reader)
    reader.SetFileName(options.file)
    reader.UpdateInformation()
    information = reader.GetOutputInformation(0)
    # VTK shows a file of one step as one without time.
    times = list(information.Get(Pipeline.TIME_STEPS())) if information.Has(Pipeline.TIME_STEPS()) else [None]
    count = len(times)
    require(not options.static or count == 1, f"{count} steps in a file that should have none")
    require(options.steps is None or count == options.steps, f"{count} steps instead of {options.steps}")
    require(all(a < b for a, b in zip(times, times[1:])), "step values do not increase")
    steps = []
    for step, time in enumerate(times):
        # As a viewer asks: by time, not by index.
        reader.Update() if time is None else reader.UpdateTimeStep(time)
        require(not errors, f"step {step}: VTK says: {errors[:1]}")
        steps.append(check_step(reader, step, options))
        points, arrays = steps[-1]
        require(options.static or arrays, f"step {step}: no arrays")
        require(np.array_equal(points, steps[0][0]), f"step {step}: the reference coordinates differ from step 0")
        shapes = [{key: values.shape for key, values in a.items()} for a in (arrays, steps[0][1])]
        require(shapes[0] == shapes[1], f"step {step}: other arrays or shapes than at step 0")
    if count > 1:
        check_changes(steps, options)
    return times, steps


def show(options, times, steps):
    points, arrays = steps[0]
    shown = "one step or none" if times == [None] else f"{len(times)} steps, {times[0]:g} to {times[-1]:g}"
    print(f"{options.file}: {len(points)} points, {shown} (VTK {vtkVersion.GetVTKVersion()})")
    print(f"{'array':40} {'at':6} {'comp.':>5} {'least':>13} {'greatest':>13} {'distinct steps':>14}")
    for (location, name), values in sorted(arrays.items()):
        all_values = [a[location, name] for _, a in steps]
        low, high = min(v.min() for v in all_values), max(v.max() for v in all_values)
        distinct = len({v.tobytes() for v in all_values})
        components = 1 if values.ndim == 1 else values.shape[1]
        print(f"{name:40} {location:6} {components:5} {low:13.6g} {high:13.6g} {distinct:14}")


def field(text):
    location, name, components = text.split(":")
    if location not in ("point", "cell"):
        raise ValueError(text)
    return location, name, int(components)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    for name in ("--steps", "--points", "--cells"):
        parser.add_argument(name, type=int)
    parser.add_argument("--field", action="append", default=[], type=field, metavar="LOCATION:NAME:COMPONENTS")
    parser.add_argument("--varying", action="append", metavar="NAME")
    parser.add_argument("--constant", action="append", default=[], metavar="NAME")
    parser.add_argument("--all-varying", action="store_true")
    parser.add_argument("--warp", default="displacement", metavar="NAME", help="empty: no warp")
    parser.add_argument("--static", action="store_true")
    options = parser.parse_args()
    if options.static:
        options.warp = ""
    if options.varying is None:
        options.varying = [options.warp] if options.warp else []
    try:
        times, steps = check(options)
    except Failure as failure:
        print(f"{options.file}: {failure}", file=sys.stderr)
        return 1
    show(options, times, steps)
    return 0


if __name__ == "__main__":
    sys.exit(main())
