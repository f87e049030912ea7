#!/usr/bin/env python3
"""Renders a bent strand from a result file: the energy dissipated by transverse and by longitudinal sliding.

    render_strand.py RESULT.vtkhdf OUT.png [--step N] [--cut] [--size WIDTH HEIGHT]

Two views of the deformed strand side by side, each coloured by one cell field. The camera looks along -x, so the
strand's axis z is upright and the strand bends in the plane of the picture (y-z).

Needs the Python package `vtk` (9.3 or newer). It draws without a display through EGL or, where that is missing,
through OSMesa (Debian: `libegl1 libgl1-mesa-dri` or `libosmesa6`).
"""

import argparse
import math
import os
import sys

import vtkmodules.vtkRenderingFreeType  # noqa: F401  (registers the text renderer)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers the OpenGL classes)
from vtkmodules.vtkCommonCore import vtkLogger
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPlane
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkFiltersGeneral import vtkTableBasedClipDataSet, vtkWarpVector
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkColorTransferFunction,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkTextActor,
    vtkWindowToImageFilter,
)

DISPLACEMENT = "displacement"
FIELDS = [
    ("dissipation_transverse", "Transverse sliding"),
    ("dissipation_longitudinal", "Longitudinal sliding"),
]
# Light grey-blue to dark red: equal steps in lightness, zero close to the paper.
COLOURS = ["#d9dfe6", "#fbe3b0", "#fdb863", "#f0803c", "#d7412f", "#a3142e", "#5e0b24"]
INK = (0.1, 0.1, 0.1)


def stop(message):
    sys.exit(f"render_strand: {message}")


def read_step(path, step):
    """The grid of one step (negative: counted from the end)."""
    if not os.path.isfile(path):
        stop(f"{path} does not exist")
    reader = vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or (0.0,)
    if not -len(times) <= step < len(times):
        stop(f"{path} has {len(times)} steps, step {step} does not exist")
    reader.UpdateTimeStep(times[step])
    grid = reader.GetOutputDataObject(0)
    if grid is None or grid.GetNumberOfCells() == 0:
        stop(f"{path} holds no cells")
    return grid


def names(data):
    return [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]


def check_fields(grid):
    if not grid.GetPointData().HasArray(DISPLACEMENT):
        stop(f"no point field {DISPLACEMENT!r}; there are {names(grid.GetPointData())}")
    for field, _ in FIELDS:
        if not grid.GetCellData().HasArray(field):
            stop(f"no cell field {field!r}; there are {names(grid.GetCellData())}")


def halved(grid):
    """The half x < 0 of the reference configuration, which shows the section plane x = 0."""
    plane = vtkPlane()
    plane.SetNormal(-1.0, 0.0, 0.0)
    clip = vtkTableBasedClipDataSet()
    clip.SetInputData(grid)
    clip.SetClipFunction(plane)
    clip.Update()
    return clip.GetOutput()


def deformed_surface(grid):
    warp = vtkWarpVector()
    warp.SetInputData(grid)
    warp.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, DISPLACEMENT)
    surface = vtkDataSetSurfaceFilter()
    surface.SetInputConnection(warp.GetOutputPort())
    surface.SetNonlinearSubdivisionLevel(2)
    normals = vtkPolyDataNormals()
    normals.SetInputConnection(surface.GetOutputPort())
    normals.SetFeatureAngle(60.0)
    normals.Update()
    return normals.GetOutput()


def round_up(value):
    """The next number whose quarters are short, so that the labels of the colour bar are."""
    if value <= 0.0:
        return 1.0
    unit = 10.0 ** math.floor(math.log10(value))
    return next(m * unit for m in (1.0, 1.2, 1.6, 2.0, 2.4, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0) if m * unit >= value)


def colour_map(high):
    colours = vtkColorTransferFunction()
    for i, code in enumerate(COLOURS):
        red, green, blue = (int(code[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
        colours.AddRGBPoint(high * i / (len(COLOURS) - 1), red, green, blue)
    return colours


def strand_actor(surface, field, colours, high):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray(field)
    mapper.SetLookupTable(colours)
    mapper.SetScalarRange(0.0, high)
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    # The sum is one: a face turned to the camera has exactly the colour of the bar.
    look.SetAmbient(0.3)
    look.SetDiffuse(0.7)
    look.EdgeVisibilityOn()
    look.SetEdgeColor(0.25, 0.25, 0.28)
    look.SetEdgeOpacity(0.35)
    look.SetLineWidth(1.0)
    return actor


def set_text(style, size, bold):
    style.SetFontFamilyToArial()
    style.SetFontSize(size)
    style.SetColor(*INK)
    style.SetBold(bold)
    style.SetItalic(False)
    style.SetShadow(False)


def scalar_bar(colours, height):
    bar = vtkScalarBarActor()
    bar.SetLookupTable(colours)
    bar.SetOrientationToHorizontal()
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.3g")
    bar.SetMaximumNumberOfColors(256)
    bar.UnconstrainedFontSizeOn()
    bar.SetTextPositionToPrecedeScalarBar()
    bar.SetTextPad(height // 150)
    bar.SetPosition(0.15, 0.03)
    bar.SetWidth(0.70)
    bar.SetHeight(0.055)
    bar.DrawFrameOff()
    set_text(bar.GetLabelTextProperty(), height // 52, False)
    return bar


def caption(text, size, bold, at):
    """A line of text centred at the height `at`, a fraction of the picture's height."""
    actor = vtkTextActor()
    actor.SetInput(text)
    set_text(actor.GetTextProperty(), size, bold)
    actor.GetTextProperty().SetJustificationToCentered()
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(0.5, at)
    return actor


def aim(camera, bounds, aspect):
    """Looks along -x, z upright; the strand fills the part of the view between heading and scalar bar."""
    x, y, z = ((bounds[2 * i] + bounds[2 * i + 1]) / 2.0 for i in range(3))
    wide, tall = bounds[3] - bounds[2], bounds[5] - bounds[4]
    scale = 0.5 * max(tall / 0.72, wide / (0.86 * aspect))
    z -= 0.03 * 2.0 * scale
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(x, y, z)
    camera.SetPosition(x + 10.0 * max(wide, tall), y, z)
    camera.SetViewUp(0.0, 0.0, 1.0)
    camera.SetParallelScale(scale)


def view(surface, high, field, title, size, viewport):
    colours = colour_map(high)
    renderer = vtkRenderer()
    renderer.SetViewport(*viewport)
    renderer.SetBackground(1.0, 1.0, 1.0)
    renderer.AddActor(strand_actor(surface, field, colours, high))
    renderer.AddViewProp(scalar_bar(colours, size[1]))
    renderer.AddViewProp(caption(title, size[1] // 30, True, 0.93))
    renderer.AddViewProp(caption("Dissipated energy [mJ/mm\u00b3]", size[1] // 45, False, 0.1))
    aim(renderer.GetActiveCamera(), surface.GetBounds(), (viewport[2] - viewport[0]) * size[0] / size[1])
    renderer.ResetCameraClippingRange()
    return renderer


def write_picture(renderers, size, path):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(*size)
    for renderer in renderers:
        window.AddRenderer(renderer)
    window.Render()
    picture = vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(picture.GetOutputPort())
    writer.Write()


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("result", metavar="RESULT.vtkhdf")
    parser.add_argument("picture", metavar="OUT.png")
    parser.add_argument("--step", type=int, default=-1, help="step to show, negative from the end (default: the last)")
    parser.add_argument("--cut", action="store_true", help="cut the strand along x = 0 to show its inside")
    parser.add_argument("--size", type=int, nargs=2, default=[2000, 1500], metavar=("WIDTH", "HEIGHT"))
    return parser.parse_args()


def main():
    options = arguments()
    # Without a display VTK warns before it turns to EGL or OSMesa.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    grid = read_step(options.result, options.step)
    check_fields(grid)
    highest = {field: grid.GetCellData().GetArray(field).GetRange()[1] for field, _ in FIELDS}
    surface = deformed_surface(halved(grid) if options.cut else grid)
    renderers = [
        view(surface, round_up(highest[field]), field, title, options.size, (i / 2.0, 0.0, (i + 1) / 2.0, 1.0))
        for i, (field, title) in enumerate(FIELDS)
    ]
    write_picture(renderers, options.size, options.picture)
    print(f"{options.picture}: " + ", ".join(f"{field} up to {high:.4g} mJ/mm^3" for field, high in highest.items()))


if __name__ == "__main__":
    main()
