"""The walls of vessels that are bodies of revolution."""
import numpy as np

from .pack import Floats, Pack


def outlines(pack: Pack, top: float) -> list[Floats]:
    """(height, radius) along each round wall of a pack's vessel from below up to `top` [m], whose axis is at x = y = size[0] / 2."""
    radius, target = 0.5 * pack.size[0], pack.size[-1]
    if pack.shape == "sphere":
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


def radii_at(pack: Pack, height: float) -> list[float]:
    """Of each round wall at a height [m]."""
    return [float(np.interp(height, line[:, 0], line[:, 1])) for line in outlines(pack, max(height, float(pack.size[-1]), pack.top()))]


def words(pack: Pack, scale: float, unit: str) -> str:
    """What it is and how large: "a cylinder, 60 x 90 mm"."""
    width, height = scale * pack.size[0], scale * pack.size[-1]
    if pack.shape == "frustum":
        low, high = scale * pack.summary["bottom_diameter"], scale * pack.summary["top_diameter"]
        return f"a frustum, {low:g} to {high:g} x {height:g} {unit}"
    if pack.shape == "sphere":
        return f"a sphere of {width:g} {unit}, up to {height:g} {unit}"
    if pack.shape == "annulus":
        return f"an annulus, {scale * pack.summary['inner_diameter']:g} to {width:g} x {height:g} {unit}"
    return f"a cylinder, {width:g} x {height:g} {unit}"
