"""The 3D half of scripts/render.py: the spheres of a pack as an image, drawn by VTK on a virtual screen."""
import os
import shutil
import sys

import numpy as np
from matplotlib import colors

from common import ACCENT, BACKGROUND, INK, fail, missing


def use_virtual_screen():
    """VTK 9.1 draws on an X screen only: start again under one if there is none."""
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("xvfb-run") or not shutil.which("xauth"):
        fail("there is no X screen, and no xvfb-run and xauth to make one; install them with: scripts/setup.sh --render")
    sys.stdout.flush()
    os.execvp("xvfb-run", ["xvfb-run", "-a", "-s", "-screen 0 640x480x24", sys.executable] + sys.argv)


def import_vtk():
    try:
        import vtk
        from vtk.util import numpy_support
    except ImportError as error:
        missing(f"{error.name} (VTK)", "render")
    return vtk, numpy_support


def spheres_actor(vtk, convert, pack, rgba):
    points = vtk.vtkPoints()
    points.SetData(convert.numpy_to_vtk(pack.position.astype(np.float32), deep=True))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    vertices = vtk.vtkCellArray()  # the mapper draws vertices, not bare points
    every = convert.numpy_to_vtkIdTypeArray(np.arange(pack.count + 1, dtype=np.int64), deep=True)
    vertices.SetData(every, convert.numpy_to_vtkIdTypeArray(np.arange(pack.count, dtype=np.int64), deep=True))
    data.SetVerts(vertices)
    radius = convert.numpy_to_vtk(pack.radius.astype(np.float32), deep=True)  # the mapper misreads float64
    radius.SetName("radius")
    data.GetPointData().AddArray(radius)
    paint = convert.numpy_to_vtk((255 * rgba[:, :3]).round().astype(np.uint8), deep=True)
    paint.SetName("paint")
    data.GetPointData().SetScalars(paint)
    mapper = vtk.vtkOpenGLSphereMapper()
    mapper.SetInputData(data)
    mapper.SetScaleArray("radius")
    mapper.SetRadius(1.0)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetAmbient(0.22)
    look.SetDiffuse(0.82)
    look.SetSpecular(0.25)
    look.SetSpecularPower(25.0)
    return actor


def lines_actor(vtk, segments, colour, thickness):
    points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
    for ends in segments:
        cells.InsertNextCell(2)
        for end in ends:
            cells.InsertCellPoint(points.InsertNextPoint(end))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetLines(cells)
    tubes = vtk.vtkTubeFilter()
    tubes.SetInputData(data)
    tubes.SetRadius(thickness)
    tubes.SetNumberOfSides(12)
    tubes.CappingOn()
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(tubes.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(colors.to_rgb(colour))
    actor.GetProperty().LightingOff()
    return actor


def frame(lx, ly, z):
    return [((0, 0, z), (lx, 0, z)), ((lx, 0, z), (lx, ly, z)), ((lx, ly, z), (0, ly, z)), ((0, ly, z), (0, 0, z))]


def container_actors(vtk, pack):
    lx, ly, asked = pack.size
    top = pack.top()
    upright = [((x, y, 0), (x, y, top)) for x in (0, lx) for y in (0, ly)]
    thickness = 0.0020 * max(lx, ly, top)
    return [lines_actor(vtk, frame(lx, ly, 0) + upright, INK, thickness),
            lines_actor(vtk, frame(lx, ly, asked), ACCENT, 1.6 * thickness)]


def aim(vtk, renderer, pack):
    """A camera far away, a little above, that sees two sides and the surface."""
    corner = np.array([pack.size[0], pack.size[1], pack.top()])
    direction = np.array([-0.50, -1.0, 0.50])
    angle = 14.0  # degrees, of view
    distance = 0.5 * np.linalg.norm(corner) / np.sin(0.5 * np.radians(angle))
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*(0.5 * corner))
    camera.SetPosition(*(0.5 * corner + distance * direction / np.linalg.norm(direction)))
    camera.SetViewUp(0.0, 0.0, 1.0)
    camera.SetViewAngle(angle)
    renderer.ResetCameraClippingRange(0.0, corner[0], 0.0, corner[1], 0.0, corner[2])
    lights = vtk.vtkLightKit()
    lights.SetKeyLightIntensity(1.0)
    lights.SetKeyLightAngle(48.0, -28.0)
    lights.SetKeyToFillRatio(2.6)
    lights.AddLightsToRenderer(renderer)


def shade_gaps(renderer, radius):
    """Ambient occlusion: what lies deep between spheres is darker."""
    renderer.UseSSAOOn()
    renderer.SetSSAORadius(3.0 * radius)
    renderer.SetSSAOBias(0.1 * radius)
    renderer.SetSSAOKernelSize(64)
    renderer.SSAOBlurOn()


def crop(image, margin):
    """Without the empty rim, but for `margin` pixels."""
    full = (image < 250).any(axis=2)
    rows, columns = np.where(full.any(axis=1))[0], np.where(full.any(axis=0))[0]
    if len(rows) == 0:
        return image
    return image[max(rows[0] - margin, 0):rows[-1] + margin, max(columns[0] - margin, 0):columns[-1] + margin]


def image_3d(pack, rgba, pixels):
    """RGB of the container and its spheres, at most `pixels` wide and high.

    Rendered at twice the size and averaged: sphere impostors have hard edges.
    """
    use_virtual_screen()
    vtk, convert = import_vtk()
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(*colors.to_rgb(BACKGROUND))
    if pack.count:
        renderer.AddActor(spheres_actor(vtk, convert, pack, rgba))
    for actor in container_actors(vtk, pack):
        renderer.AddActor(actor)
    aim(vtk, renderer, pack)
    if pack.count:
        shade_gaps(renderer, float(pack.radius.mean()))
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(2 * pixels, 2 * pixels)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    flat = convert.vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
    big = flat.reshape(2 * pixels, 2 * pixels, -1)[::-1, :, :3].astype(float)
    small = big.reshape(pixels, 2, pixels, 2, 3).mean(axis=(1, 3))
    return crop(small.round().astype(np.uint8), margin=8)
