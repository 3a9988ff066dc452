"""The spheres of a pack as an image, drawn by VTK on an X screen."""
import os
import shutil
import sys
from typing import Any, Sequence, Union

import numpy as np
import vtk
from matplotlib import colors
from numpy.typing import NDArray
from vtk.util import numpy_support as convert

from .problem import Problem
from .pack import Floats, Pack
from . import vessel
from .style import BACKGROUND, INK, LID, TARGET

Point = Union[tuple[float, float, float], Floats]
Segment = tuple[Point, Point]
Image = NDArray[np.uint8]   # (height, width, 3), row 0 above


def use_virtual_screen() -> None:
    """VTK 9.1 draws on an X screen only. If there is none, this process begins again under a virtual one: call it first."""
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("xvfb-run") or not shutil.which("xauth"):
        raise Problem("there is no X screen, and no xvfb-run and xauth to make one; on Debian: apt-get install xvfb xauth")
    sys.stdout.flush()
    os.execvp("xvfb-run", ["xvfb-run", "-a", "-s", "-screen 0 640x480x24", sys.executable] + sys.argv)


def highest(pack: Pack) -> float:
    """What the picture has to show [m]: of a vessel of triangles all of it."""
    return float(max(pack.top(), vessel.mesh(pack)[0][:, 2].max())) if pack.shape == "mesh" else pack.top()


def extent(pack: Pack) -> float:
    """The longest edge [m]. What VTK sees is divided by it: its depths are made for lengths of about 1, not for micrometres."""
    return float(max(pack.size[0], pack.size[1], highest(pack)))


def spheres_actor(pack: Pack, rgba: Floats) -> Any:
    """The spheres as impostors: a shaded square each, no mesh."""
    points = vtk.vtkPoints()
    points.SetData(convert.numpy_to_vtk((pack.position / extent(pack)).astype(np.float32), deep=True))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    vertices = vtk.vtkCellArray()  # the mapper draws vertices, not bare points
    every = convert.numpy_to_vtkIdTypeArray(np.arange(pack.count + 1, dtype=np.int64), deep=True)
    vertices.SetData(every, convert.numpy_to_vtkIdTypeArray(np.arange(pack.count, dtype=np.int64), deep=True))
    data.SetVerts(vertices)
    radius = convert.numpy_to_vtk((pack.radius / extent(pack)).astype(np.float32), deep=True)  # the mapper misreads float64
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


def lines_actor(segments: Sequence[Segment], colour: str, thickness: float) -> Any:
    """Lines as tubes of a radius [m]."""
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


def frame(lx: float, ly: float, z: float) -> list[Segment]:
    """A rectangle at a height."""
    return [((0, 0, z), (lx, 0, z)), ((lx, 0, z), (lx, ly, z)), ((lx, ly, z), (0, ly, z)), ((0, ly, z), (0, 0, z))]


def plate_actor(lx: float, ly: float, z: float) -> Any:
    """A horizontal plate that one looks through."""
    plane = vtk.vtkPlaneSource()
    plane.SetOrigin(0, 0, z)
    plane.SetPoint1(lx, 0, z)
    plane.SetPoint2(0, ly, z)
    return lid_actor(plane)


def disc_actor(centre: float, radii: list[float], z: float) -> Any:
    """The same, round about x = y = centre; of two radii the ring between them."""
    disc = vtk.vtkDiskSource()
    disc.SetOuterRadius(max(radii))
    disc.SetInnerRadius(min(radii) if len(radii) > 1 else 0.0)
    disc.SetCircumferentialResolution(120)
    actor = lid_actor(disc)
    actor.SetPosition(centre, centre, z)
    return actor


def lid_actor(source: Any) -> Any:
    """A lid that one looks through."""
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(colors.to_rgb(LID))
    actor.GetProperty().SetOpacity(0.35)
    actor.GetProperty().LightingOff()
    return actor


def ring(centre: float, radius: float, z: float) -> list[Segment]:
    """A circle at a height, around x = y = centre."""
    angles = np.linspace(0.0, 2.0 * np.pi, 121)
    points = [(centre + radius * np.cos(a), centre + radius * np.sin(a), z) for a in angles]
    return list(zip(points[:-1], points[1:]))


def mantle_actor(centre: float, line: Floats) -> Any:
    """The wall that a line of (height, radius) makes by turning around x = y = centre, as clear as glass."""
    points, cells, around = vtk.vtkPoints(), vtk.vtkCellArray(), 120
    for z, radius in line:
        for a in np.linspace(0.0, 2.0 * np.pi, around, endpoint=False):
            points.InsertNextPoint(centre + radius * np.cos(a), centre + radius * np.sin(a), z)
    for level in range(len(line) - 1):
        for k in range(around):
            cells.InsertNextCell(4)
            for corner in (k, (k + 1) % around, (k + 1) % around + around, k + around):
                cells.InsertCellPoint(level * around + corner)
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    return glass_actor(data)


def glass_actor(data: Any) -> Any:
    """What one sees through."""
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(colors.to_rgb(INK))
    look.SetOpacity(0.07)
    look.LightingOff()
    return actor


def mark(pack: Pack) -> float:
    """The height that is marked on a vessel [m]: the target, or the lid's."""
    return float(pack.size[-1] if pack.lid is None else pack.lid)


def mark_actor(pack: Pack, marks: Sequence[Segment]) -> Any:
    """Lines at that height."""
    return lines_actor(marks, TARGET, 0.0025) if pack.lid is None else lines_actor(marks, LID, 0.005)


def mesh_actors(pack: Pack) -> list[Any]:
    """A vessel of triangles: its sides as clear as glass, its edges, and the target height or the lid on it."""
    corners, triangles = vessel.mesh(pack)
    corners = corners / extent(pack)
    points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
    for corner in corners:
        points.InsertNextPoint(*corner)
    for triangle in triangles:
        cells.InsertNextCell(3)
        for corner in triangle:
            cells.InsertCellPoint(int(corner))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    marks = vessel.section(corners, triangles, mark(pack) / extent(pack))
    return [lines_actor(vessel.mesh_edges(corners, triangles), INK, 0.0015), mark_actor(pack, marks), glass_actor(data)]


def vessel_actors(pack: Pack) -> list[Any]:
    """A round vessel: its walls, the circles where they begin and end, and the target height or the lid on them."""
    scale = 1.0 / extent(pack)
    centre = 0.5 * scale * pack.size[0]
    actors, edges, marks = [], [], []
    for line in vessel.outlines(pack, pack.top()):
        actors.append(mantle_actor(centre, scale * line))
        for z, radius in scale * (line if pack.shape == "frustum" else line[[0, -1]]):
            edges += ring(centre, max(radius, 1e-6), z)
    radii = [max(scale * radius, 1e-6) for radius in vessel.radii_at(pack, mark(pack))]
    for radius in radii:
        marks += ring(centre, radius, scale * mark(pack))
    if pack.lid is not None:
        actors.append(disc_actor(centre, radii, scale * pack.lid))
    return [lines_actor(edges, INK, 0.0015), mark_actor(pack, marks)] + actors


def container_actors(pack: Pack) -> list[Any]:
    """The edges of the container, and the target height; or a lid that lets what is under it be seen; of a round one its wall, too."""
    lx, ly, target = pack.size / extent(pack)
    top = (pack.top() if pack.lid is None else pack.lid) / extent(pack)
    if pack.shape == "mesh":
        return mesh_actors(pack)
    if pack.shape != "box":
        return vessel_actors(pack)
    upright: list[Segment] = [((x, y, 0), (x, y, top)) for x in (0, lx) for y in (0, ly)]
    thickness = 0.0020
    if pack.lid is not None:
        return [lines_actor(frame(lx, ly, 0) + upright, INK, thickness), lines_actor(frame(lx, ly, top), LID, 2.5 * thickness), plate_actor(lx, ly, top)]
    return [lines_actor(frame(lx, ly, 0) + upright, INK, thickness),
            lines_actor(frame(lx, ly, target), TARGET, 1.6 * thickness)]


def aim(renderer: Any, pack: Pack) -> None:
    """A camera far away, a little above, that sees two sides and the surface."""
    corner = np.array([pack.size[0], pack.size[1], highest(pack)]) / extent(pack)
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


def shade_gaps(renderer: Any, radius: float) -> None:
    """Ambient occlusion: what lies deep between spheres is darker."""
    renderer.UseSSAOOn()
    renderer.SetSSAORadius(3.0 * radius)
    renderer.SetSSAOBias(0.1 * radius)
    renderer.SetSSAOKernelSize(64)
    renderer.SSAOBlurOn()


def crop(image: Image, margin: int) -> Image:
    """Without the empty rim, but for `margin` pixels."""
    full = (image < 250).any(axis=2)
    rows, columns = np.where(full.any(axis=1))[0], np.where(full.any(axis=0))[0]
    if len(rows) == 0:
        return image
    return image[max(rows[0] - margin, 0):rows[-1] + margin, max(columns[0] - margin, 0):columns[-1] + margin]


def scene_of(pack: Pack, rgba: Floats) -> Any:
    """What VTK draws: container, spheres, camera and lights."""
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(*colors.to_rgb(BACKGROUND))
    if pack.count:
        renderer.AddActor(spheres_actor(pack, rgba))
    for actor in container_actors(pack):
        renderer.AddActor(actor)
    aim(renderer, pack)
    if pack.count:
        shade_gaps(renderer, float(pack.radius.mean()) / extent(pack))
    return renderer


def image_3d(pack: Pack, rgba: Floats, pixels: int) -> Image:
    """The container and its spheres, at most `pixels` wide and high, in the colours `rgba` (N, 4). Needs an X screen.

    Rendered at twice the size and averaged: sphere impostors have hard edges.
    """
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(2 * pixels, 2 * pixels)
    window.AddRenderer(scene_of(pack, rgba))
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    flat = convert.vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
    big = flat.reshape(2 * pixels, 2 * pixels, -1)[::-1, :, :3].astype(float)
    small = big.reshape(pixels, 2, pixels, 2, 3).mean(axis=(1, 3))
    return crop(small.round().astype(np.uint8), margin=8)
