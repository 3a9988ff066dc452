"""Shows a pack in ParaView (5.11 or newer) as spheres of the right radius, coloured by a property.

usage: in ParaView: open NAME.hdf, Apply, then Tools > Python Shell > Run Script, this file; or, without a window,
       pvpython show_in_paraview.py NAME.hdf [PROPERTY] [picture.png]
PROPERTY: radius, layer, contacts, id (default: layer). With a picture's name it is drawn.
"""
import os
import sys
from typing import Any

from paraview.simple import (ColorBy, GetActiveSource, GetActiveViewOrCreate, OpenDataFile, Render, ResetCamera,
                             SaveScreenshot, Show)


def pack_at(path: str) -> Any:
    pack = OpenDataFile(os.path.abspath(path))
    if pack is None:
        raise SystemExit(f"ParaView cannot open {path}: is it a pack, and does its name end in .hdf?")
    return pack


def show_spheres(pack: Any, color: str) -> Any:
    """Drawn as shaded points, no mesh a particle: a million of them turn smoothly."""
    view = GetActiveViewOrCreate("RenderView")
    display = Show(pack, view)
    display.SetRepresentationType("Point Gaussian")
    display.ShaderPreset = "Sphere"
    display.GaussianRadius = 1.0
    display.ScaleByArray = 1
    display.SetScaleArray = ["POINTS", "radius"]
    display.UseScaleFunction = 0
    ColorBy(display, ("POINTS", color))
    display.RescaleTransferFunctionToDataRange(True)
    display.SetScalarBarVisibility(view, True)
    view.OrientationAxesVisibility = 1
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [2.0, -3.0, 1.5], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]
    ResetCamera(view)
    Render(view)
    return view


def main(words: list[str]) -> None:
    pack = pack_at(words[0]) if words else GetActiveSource()
    if pack is None:
        raise SystemExit("open a pack first, or name it: pvpython show_in_paraview.py NAME.hdf")
    view = show_spheres(pack, words[1] if len(words) > 1 else "layer")
    if len(words) > 2:
        SaveScreenshot(words[2], view, ImageResolution=[1200, 900])


main(sys.argv[1:])
