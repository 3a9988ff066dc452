"""Size distributions to be drawn: that of a scene, as scene::SizeCurve computes it, and that of a pack."""
from math import erf
from typing import Any, Callable

import numpy as np

from .pack import Floats

POINTS = 2001   # of a smooth curve


def target_curve(radius: dict[str, Any]) -> tuple[Floats, Floats, Floats]:
    """Of a scene's table [particles.radius] in SI units: radii [m], ascending, and the shares of the number and of the mass up
    to each. A jump is two points at one radius."""
    by_mass = radius.get("weighting") == "mass"
    if radius["distribution"] in CLASSES:
        radii, share = CLASSES[radius["distribution"]](radius)
        r, passing = np.repeat(radii, 2), np.repeat(np.cumsum([0.0, *share]), 2)[1:-1]
    elif radius["distribution"] == "grading":
        r, passing = kept_grading(radius)
    else:
        r = np.geomspace(radius["min"], radius["max"], POINTS)
        passing = SMOOTH[radius["distribution"]](r, radius)
    passing = (passing - passing[0]) / (passing[-1] - passing[0])
    other = weighted_otherwise(r, np.diff(passing), by_mass)
    return (r, other, passing) if by_mass else (r, passing, other)


# Radii and shares of distributions of few radii.
CLASSES: dict[str, Callable[[dict[str, Any]], tuple[Any, Any]]] = {
    "equal": lambda radius: ([radius["value"]], [1.0]),
    "bidisperse": lambda radius: ([radius["small"], radius["large"]], [1.0 - radius["large_share"], radius["large_share"]]),
    "discrete": lambda radius: (radius["radii"], radius["shares"])}

# The share up to r of the others, but for a constant and a factor: these follow from the limits.
SMOOTH: dict[str, Callable[[Floats, dict[str, Any]], Floats]] = {
    "uniform": lambda r, radius: r,
    "gaussian": lambda r, radius: normal((r - radius["mean"]) / radius["sd"]),
    "lognormal": lambda r, radius: normal(np.log(r / radius["median"]) / radius["log_sd"]),
    "weibull": lambda r, radius: -np.exp(-(r / radius["scale"]) ** radius["shape"])}


def weighted_otherwise(r: Floats, share: Floats, by_mass: bool) -> Floats:
    """The cumulative share of the number if `share`, between the radii, is of the mass; of the mass if it is of the number."""
    low, high = r[:-1], r[1:]
    cube = (low + high) * (low ** 2 + high ** 2) / 4.0   # the mean of r^3 between two radii
    other = np.append(0.0, np.cumsum(share / cube if by_mass else share * cube))
    return other / other[-1]


def normal(x: Floats) -> Floats:
    """The normal distribution's cumulative share at x."""
    return np.array([0.5 * (1.0 + erf(value / 2.0 ** 0.5)) for value in x])


def kept_grading(radius: dict[str, Any]) -> tuple[Floats, Floats]:
    """Radii [m] and percent passing of the part of a grading curve that is kept, with points between the sieves."""
    curve = np.array(radius["diameter_curve"], dtype=float)
    logarithmic = radius.get("interpolation", "log") == "log"
    place = np.log(curve[:, 0]) if logarithmic else curve[:, 0]
    low, high = radius.get("keep_percent", [0.0, 100.0])
    percent = np.unique(np.concatenate([np.linspace(low, high, POINTS), curve[:, 1].clip(low, high)]))
    x = np.interp(percent, curve[:, 1], place)
    return 0.5 * (np.exp(x) if logarithmic else x), percent


def achieved_curve(radii: Floats) -> tuple[Floats, Floats, Floats]:
    """Of a pack's radii [m]: the same, ascending, and the shares of the number and of the mass up to each."""
    r = np.sort(radii)
    mass = np.cumsum(r ** 3)
    return r, np.arange(1, len(r) + 1) / len(r), mass / mass[-1]
