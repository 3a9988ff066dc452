"""The walls of vessels: bodies of revolution, in 2D circles and polygons, and meshes."""
import tomllib

import numpy as np

from .pack import Floats, Integers, Pack


def outlines(pack: Pack, top: float) -> list[Floats]:
    """(height, radius) along each round wall of a pack's vessel from below up to `top` [m], whose axis is at x = y = size[0] / 2."""
    radius, target = 0.5 * pack.size[0], pack.size[-1]
    if pack.shape in ("sphere", "circle"):
        angles = np.linspace(-0.5 * np.pi, np.arcsin(min(1.0, top / radius - 1.0)), 73)
        return [np.column_stack([radius * (1.0 + np.sin(angles)), radius * np.cos(angles)])]
    if pack.shape == "frustum":
        low, high = 0.5 * pack.summary["bottom_diameter"], 0.5 * pack.summary["top_diameter"]
        line = [(0.0, low), (target, high)]
        if top > target:  # it goes on as a cylinder if it widens, else as the cone that it is
            line.append((top, high if high >= low else max(0.0, low + (high - low) / target * top)))
        return [np.array(line)]
    walls = [radius] + ([0.5 * pack.summary["inner_diameter"]] if pack.shape == "annulus" else [])
    return [np.array([(0.0, r), (top, r)]) for r in walls]


def corners(pack: Pack) -> Floats:
    """(x, y) along the walls of a pack's trapezium, which is open above, or of its polygon, which ends where it begins [m]."""
    width, target = float(pack.size[0]), float(pack.size[-1])
    if pack.shape == "polygon":
        points = np.array(tomllib.loads(pack.provenance["effective_input"])["container"]["polygon"], dtype=float)
        return np.vstack([points, points[:1]]) - points.min(axis=0)
    low, high, top = 0.5 * pack.summary["bottom_width"], 0.5 * pack.summary["top_width"], max(target, pack.top())
    side = [(low, 0.0), (high, target)]
    if high >= low and top > target:   # it goes on as wide as it is
        side.append((high, top))
    elif top > target:                 # up to its tip
        top = min(top, target * low / (low - high))
        side.append((low + (high - low) / target * top, top))
    return np.array([(0.5 * width - x, y) for x, y in side[::-1]] + [(0.5 * width + x, y) for x, y in side])


def top(pack: Pack) -> float:
    """What a picture of a pack has to show [m]: of a polygon all of it."""
    return max(pack.top(), float(corners(pack)[:, 1].max())) if pack.shape == "polygon" else pack.top()


def radii_at(pack: Pack, height: float) -> list[float]:
    """Of each round wall at a height [m]."""
    return [float(np.interp(height, line[:, 0], line[:, 1])) for line in outlines(pack, max(height, float(pack.size[-1]), pack.top()))]


def span(pack: Pack, height: float) -> tuple[float, float]:
    """From where to where a plane picture of a pack's vessel goes at a height [m]; of a mesh the whole width."""
    width = float(pack.size[0])
    if pack.shape in ("trapezium", "polygon"):
        line = corners(pack)
        cuts = [a[0] + (height - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                for a, b in zip(line[:-1], line[1:]) if a[1] != b[1] and min(a[1], b[1]) <= height <= max(a[1], b[1])]
        return (min(cuts), max(cuts)) if cuts else (0.0, width)
    if pack.shape in ("box", "mesh"):
        return 0.0, width
    radius = max(radii_at(pack, height))
    return 0.5 * width - radius, 0.5 * width + radius


def mesh(pack: Pack) -> tuple[Floats, Integers]:
    """Corners [m] and triangles, three corners each, of a pack's vessel whose shape is "mesh"; they stand in its scene."""
    text = tomllib.loads(pack.provenance["effective_input"])["container"]["surface"]
    points, triangles = [], []
    for line in text.splitlines():
        kind, *rest = line.split()
        if kind == "v":
            points.append([float(x) for x in rest])
        elif kind == "f":
            triangles.append([int(k) - 1 for k in rest])
    return np.array(points), np.array(triangles)


def mesh_edges(points: Floats, triangles: Integers, least: float = 10.0) -> list[tuple[Floats, Floats]]:
    """The edges of a mesh across which it turns by `least` degrees or more."""
    normals = np.cross(points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    across: dict[tuple[int, int], list[int]] = {}
    for number, triangle in enumerate(triangles):
        for k in range(3):
            a, b = int(triangle[k]), int(triangle[(k + 1) % 3])
            across.setdefault((min(a, b), max(a, b)), []).append(number)
    limit = np.cos(np.radians(least))
    return [(points[a], points[b]) for (a, b), both in across.items() if len(both) == 2 and normals[both[0]] @ normals[both[1]] < limit]


def section(points: Floats, triangles: Integers, place: float, axis: int = 2) -> list[tuple[Floats, Floats]]:
    """The lines in which a mesh cuts the plane across an axis at a place; as it is, a height."""
    found = []
    for triangle in triangles:
        cut = []
        for k in range(3):
            a, b = points[triangle[k]], points[triangle[(k + 1) % 3]]
            if (a[axis] < place) != (b[axis] < place):
                cut.append(a + (place - a[axis]) / (b[axis] - a[axis]) * (b - a))
        if len(cut) == 2:
            found.append((cut[0], cut[1]))
    return found


def words(pack: Pack, scale: float, unit: str) -> str:
    """What it is and how large: "a cylinder, 60 x 90 mm"; with a lid where that is, too."""
    return shape_words(pack, scale, unit) + ("" if pack.lid is None else f", lid at {scale * pack.lid:.4g} {unit}")


def shape_words(pack: Pack, scale: float, unit: str) -> str:
    """Without the lid."""
    width, height = scale * pack.size[0], scale * pack.size[-1]
    if pack.shape == "frustum":
        low, high = scale * pack.summary["bottom_diameter"], scale * pack.summary["top_diameter"]
        return f"a frustum, {low:g} to {high:g} x {height:g} {unit}"
    if pack.shape == "mesh":
        return f"a mesh, {width:g} x {scale * pack.size[1]:g} x {height:g} {unit}"
    if pack.shape == "trapezium":
        return f"a trapezium, {scale * pack.summary['bottom_width']:g} to {scale * pack.summary['top_width']:g} x {height:g} {unit}"
    if pack.shape == "polygon":
        return f"a polygon, {width:g} x {height:g} {unit}"
    if pack.shape in ("sphere", "circle"):
        return f"a {pack.shape} of {width:g} {unit}, up to {height:g} {unit}"
    if pack.shape == "annulus":
        return f"an annulus, {scale * pack.summary['inner_diameter']:g} to {width:g} x {height:g} {unit}"
    return f"a cylinder, {width:g} x {height:g} {unit}"
