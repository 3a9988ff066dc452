"""Plots of a pack: density profile, composition over the height, target and achieved sizes, pair distribution, how it settled.

usage: packmpi plot PACK.hdf [-o FOLDER] [--format png|svg] [--only density composition lateral radial segregation sizes ...] [--program packmpi]

Writes NAME.density.png and so on beside the pack, or in FOLDER. The numbers are those of `packmpi analyze`, which is run
first if NAME.analysis.json is older than the pack or not there; the history is NAME.steps.csv, and is left out if that is not
beside the pack.
"""
import argparse
from pathlib import Path
from typing import Any, Union

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402  (after the choice of the backend)
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from . import sizes as size_curves  # noqa: E402
from .problem import Problem, named  # noqa: E402
from .pack import Floats, Pack  # noqa: E402
from .style import ACHIEVED, BACKGROUND, INK, LOOK, OTHER, TARGET  # noqa: E402
from .units import length_unit  # noqa: E402

LOGARITHMIC = 1.5   # largest over smallest diameter, beyond which sizes get a logarithmic axis, as sieves do


def new_figure(rows: int = 1) -> tuple[Figure, Any]:
    """A figure with `rows` axes one above the other."""
    return plt.subplots(rows, 1, figsize=(4.7, 3.4), layout="constrained", sharex=True)


def staircase(profile: dict[str, Any]) -> tuple[Floats, Floats]:
    """Edges (n + 1) and values (n) of a profile of packmpi analyze."""
    values = np.array(profile["values"], dtype=float)
    return profile["from"] + profile["width"] * np.arange(len(values) + 1), values


def density(pack: Pack, analysis: dict[str, Any]) -> Figure:
    """Solid fraction over the height."""
    edges, values = staircase(analysis["density_profile"]["xyz"[pack.dimension - 1]])
    scale, unit = length_unit(pack.size[-1])
    edges, target = scale * edges, scale * pack.size[-1]
    figure, axes = new_figure()
    low, high = scale * np.asarray(pack.summary["bulk"])
    axes.axvspan(low, high, color=OTHER, alpha=0.16, linewidth=0)
    axes.stairs(values, edges, color=ACHIEVED, linewidth=1.5, baseline=None)
    axes.hlines(pack.phi_bulk, low, high, color=INK, linewidth=1.0, linestyle=(0, (4, 3)))
    axes.annotate(rf"$\phi_\mathrm{{bulk}}$ = {pack.phi_bulk:.3f}", (0.5 * (low + high), pack.phi_bulk), (0, -30),
                  textcoords="offset points", ha="center", fontsize=9)
    axes.axvline(target, color=TARGET, linestyle=(0, (6, 3)))
    axes.annotate("target height", (target, 0.02), (-4, 0), textcoords="offset points", rotation=90, ha="right",
                  va="bottom", color=TARGET, fontsize=8.5)
    axes.set(xlabel=f"height [{unit}]", ylabel="solid fraction", xlim=(0.0, max(edges[-1], 1.02 * target)), ylim=(0.0, None))
    return figure


def composition(pack: Pack, analysis: dict[str, Any]) -> Union[Figure, None]:
    """Share of each component in the solid volume over the height; None with one component."""
    found = analysis.get("composition")
    if not found:
        return None
    scale, unit = length_unit(pack.size[-1])
    shares = np.array(found["volume_shares"], dtype=float)
    edges = scale * found["slab_height"] * np.arange(len(shares) + 1)
    figure, axes = new_figure()
    below = np.zeros(len(shares))
    for k, one in enumerate(found["components"]):
        colour = plt.get_cmap("viridis")(0.15 + 0.75 * k / max(1, len(found["components"]) - 1))
        axes.stairs(below + shares[:, k], edges, baseline=below, fill=True, color=colour, label=one["name"])
        below += shares[:, k]
    axes.set(xlabel=f"height [{unit}]", ylabel="share of the solid volume", xlim=(0.0, edges[-1]), ylim=(0.0, 1.0))
    legend_above(axes)
    return figure


def lateral(pack: Pack, analysis: dict[str, Any]) -> Union[Figure, None]:
    """Solid fraction of the bulk across it, from one side to the other; None where the analysis has none."""
    profiles = {axis: analysis["density_profile"][axis] for axis in "xy"[:pack.dimension - 1] if axis in analysis["density_profile"]}
    if not profiles:
        return None
    figure, axes = new_figure()
    scale, unit = length_unit(pack.size[0])
    for (axis, profile), colour in zip(profiles.items(), (ACHIEVED, OTHER)):
        edges, values = staircase(profile)
        axes.stairs(values, scale * edges, color=colour, linewidth=1.5, baseline=None, label=f"along {axis}")
    axes.axhline(pack.phi_bulk, color=INK, linewidth=1.0, linestyle=(0, (4, 3)), label=r"$\phi_\mathrm{bulk}$")
    legend_above(axes)
    axes.set(xlabel=f"place between the sides [{unit}]", ylabel="solid fraction", ylim=(0.0, None))
    return figure


def radial(pack: Pack, analysis: dict[str, Any]) -> Union[Figure, None]:
    """Solid fraction by the distance from the side walls of a round vessel; None in others."""
    found = analysis.get("radial_profile")
    if not found:
        return None
    figure, axes = new_figure()
    diameter = 2.0 * float(pack.radius.mean())
    for name, words, colour in (("from_wall", "from the outer wall" if "from_inner_wall" in found else "from the wall", ACHIEVED), ("from_inner_wall", "from the inner wall", OTHER)):
        if name in found:
            edges, values = staircase(found[name])
            axes.stairs(values, edges / diameter, color=colour, linewidth=1.5, baseline=None, label=words)
    if found["core"]["solid_fraction"] > 0.0:
        axes.axhline(found["core"]["solid_fraction"], color=INK, linewidth=1.0, linestyle=(0, (4, 3)), label="of the core, away from walls")
    legend_above(axes)
    axes.set(xlabel="distance from the wall [mean diameters]", ylabel="solid fraction", xlim=(0.0, None), ylim=(0.0, None))
    return figure


def segregation(pack: Pack, analysis: dict[str, Any]) -> Union[Figure, None]:
    """Mean radius over the height, beside that of all; None if all radii are equal, or there are too few slabs."""
    if np.ptp(pack.radius) == 0.0:
        return None
    edges, values = staircase(analysis["segregation"]["mean_radius"])
    if np.count_nonzero(values > 0.0) < 2:
        return None
    figure, axes = new_figure()
    scale, unit = length_unit(pack.size[-1])
    size_scale, size_unit = length_unit(float(pack.radius.max()))
    axes.stairs(size_scale * np.where(values > 0.0, values, np.nan), scale * edges, color=ACHIEVED, linewidth=1.5, baseline=None, label="in a slab")
    axes.axhline(size_scale * float(pack.radius.mean()), color=INK, linewidth=1.0, linestyle=(0, (4, 3)),
                 label=f"of all; correlation with height {analysis['segregation']['correlation']:+.3f}")
    legend_above(axes)
    axes.set(xlabel=f"height [{unit}]", ylabel=f"mean radius [{size_unit}]", ylim=(0.0, None))
    return figure


def size_axis(axes: Axes, low: float, high: float, unit: str) -> None:
    """The axis of diameters between `low` and `high`, logarithmic unless they are nearly equal."""
    if high > LOGARITHMIC * low:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda x, _: f"{x:g}"))
        axes.xaxis.set_minor_formatter(matplotlib.ticker.LogFormatter(minor_thresholds=(2.0, 0.9)))
        axes.set_xlim(low / 1.05, high * 1.05)
    else:
        rim = 0.05 * (high - low) or 0.1 * high
        axes.set_xlim(low - rim, high + rim)
    axes.set(xlabel=f"diameter [{unit}]", ylabel="passing [%]", ylim=(-2.0, 102.0))


def component_sizes(pack: Pack) -> Figure:
    """What passes a sieve by mass, of each component."""
    scale, unit = length_unit(2.0 * pack.radius.max())
    scale *= 2.0
    figure, axes = new_figure()
    for k, name in enumerate(pack.components):
        own = pack.radius[pack.component == k]
        if len(own):
            r, _, mass = size_curves.achieved_curve(own)
            axes.step(scale * np.append(r[0], r), 100.0 * np.append(0.0, mass), where="post", label=f"{name}, by mass",
                      color=plt.get_cmap("viridis")(0.15 + 0.75 * k / max(1, len(pack.components) - 1)))
    size_axis(axes, scale * pack.radius.min(), scale * pack.radius.max(), unit)
    axes.legend()
    return figure


def sizes(pack: Pack, _: dict[str, Any]) -> Union[Figure, None]:
    """What passes a sieve, target and achieved, by mass and by number; None if all radii are equal."""
    if np.ptp(pack.radius) == 0.0:
        return None
    if pack.components:
        return component_sizes(pack)
    target_r, *target = size_curves.target_curve(pack.scene()["particles"]["radius"])
    achieved_r, *achieved = size_curves.achieved_curve(pack.radius)
    scale, unit = length_unit(2.0 * pack.radius.max())
    scale *= 2.0   # radius [m] to diameter [unit]
    figure, axes = new_figure()
    for wanted, found, colour, name in zip(target, achieved, (OTHER, ACHIEVED), ("by number", "by mass")):
        axes.step(scale * np.append(achieved_r[0], achieved_r), 100.0 * np.append(0.0, found), where="post", color=colour,
                  label=f"achieved, {name}")
        axes.plot(scale * target_r, 100.0 * wanted, color=INK if name == "by number" else TARGET, linewidth=1.2,
                  linestyle=(0, (4, 2.5)), label=f"target, {name}")
    low, high = scale * min(target_r[0], achieved_r[0]), scale * max(target_r[-1], achieved_r[-1])
    size_axis(axes, low, high, unit)
    axes.legend(loc="upper left" if np.interp(np.sqrt(low * high), scale * target_r, target[0]) < 0.5 else "lower right")
    return figure


def pairs(_: Pack, analysis: dict[str, Any]) -> Union[Figure, None]:
    """Pair distribution, 1 where places are independent of each other; None if the pack is too small for it."""
    edges, values = staircase(analysis["pair_distribution"]["g"])
    if not np.any(values):
        return None
    figure, axes = new_figure()
    axes.axhline(1.0, color=OTHER, linewidth=1.0)
    axes.stairs(values, edges, color=ACHIEVED, linewidth=1.5, baseline=None)
    axes.set(xlabel=r"distance of centres [mean diameters]", ylabel="g(r)", xlim=(0.0, edges[-1]), ylim=(0.0, None))
    return figure


def legend_above(axes: Axes) -> None:
    """The legend in one line above the axes."""
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, columnspacing=1.0, handlelength=1.4,
                borderaxespad=0.1)


def settling(pack: Pack, _: dict[str, Any]) -> Union[Figure, None]:
    """Height and energy of the moving particles over simulated time, a line where a layer comes; None without history."""
    steps = pack.steps()
    if not steps:
        return None
    figure, (above, below) = new_figure(2)
    scale, unit = length_unit(pack.size[-1])
    time = steps["time"]
    starts = time[np.flatnonzero(np.diff(steps["layer"], prepend=-1.0))]
    for axes in (above, below):
        for start in starts[1:]:
            axes.axvline(start, color=OTHER, linewidth=0.6, alpha=0.5)
        axes.grid(axis="x", visible=False)
    above.axhline(scale * pack.size[-1], color=TARGET, linewidth=1.2, linestyle=(0, (6, 3)), label="target height")
    above.plot(time, scale * steps["top"], color=ACHIEVED, label="highest top")
    above.plot(time, scale * steps["mean height"], color=OTHER, label="mean height")
    above.set(ylabel=f"[{unit}]", ylim=(0.0, None))
    legend_above(above)
    for name, colour in (("kinetic energy", ACHIEVED), ("elastic energy", OTHER)):
        below.plot(time, np.where(steps[name] > 0.0, steps[name], np.nan), color=colour, label=name)
    below.set(yscale="log", ylabel="[J]", xlabel="simulated time [s]", xlim=(0.0, time[-1]))
    legend_above(below)
    return figure


def coordination(pack: Pack, _: dict[str, Any]) -> Union[Figure, None]:
    """Shares of particles by the number of those they touch; None if nothing touches."""
    shares = np.bincount(pack.contacts) / pack.count
    if len(shares) < 2:
        return None
    figure, axes = new_figure()
    last = max(int(np.flatnonzero(shares > 1e-3)[-1]), 1)   # of a few large ones among fines the tail is long
    axes.bar(np.arange(last + 1), 100.0 * shares[:last + 1], color=ACHIEVED, width=0.8)
    mean = float(np.mean(pack.contacts))
    axes.axvline(mean, color=INK, linewidth=1.0, linestyle=(0, (4, 3)))
    axes.annotate(f"mean {mean:.2f}", (mean, 1.0), (4, -4), xycoords=("data", "axes fraction"), textcoords="offset points", va="top", fontsize=9)
    axes.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
    axes.set(xlabel="touching particles", ylabel="particles [%]")
    axes.grid(axis="x", visible=False)
    return figure


FEW = 50   # contacts, of which no distribution is drawn


def forces(_: Pack, analysis: dict[str, Any]) -> Union[Figure, None]:
    """Probability density of the normal forces over their mean; None if contacts are few."""
    told = analysis["forces"]
    if told["contacts"] < FEW:
        return None
    edges, values = staircase(told["distribution"])
    density = values / (values.sum() * told["distribution"]["width"])
    last = int(np.flatnonzero(density)[-1]) + 1
    figure, axes = new_figure()
    axes.stairs(np.where(density > 0.0, density, np.nan)[:last], edges[:last + 1], color=ACHIEVED, linewidth=1.5, baseline=None)
    axes.set(yscale="log", xlabel="normal force over its mean", ylabel="probability density", xlim=(0.0, edges[last]))
    return figure


def rose(pack: Pack, _: dict[str, Any]) -> Union[Figure, None]:
    """Density of contact directions over the angle from the vertical, both ends of each contact; None without contacts."""
    normals = pack.pair_contacts.get("normal")
    if normals is None or len(normals) < FEW:
        return None
    vertical = normals[:, pack.dimension - 1]
    petals = 24
    edges = np.linspace(-np.pi, np.pi, petals + 1)
    if pack.dimension == 2:
        angle = np.arctan2(normals[:, 0], vertical)
        counts = np.histogram(np.concatenate([angle, np.where(angle > 0.0, angle - np.pi, angle + np.pi)]), edges)[0].astype(float)
        density = counts / counts.mean()
    else:   # by |cos|: the solid angle of a ring is the difference of its cosines; drawn on all four quarters
        quarter = np.linspace(0.0, 0.5 * np.pi, petals // 4 + 1)
        counts = np.histogram(np.arccos(np.clip(np.abs(vertical), 0.0, 1.0)), quarter)[0] / len(vertical)
        ring = counts / -np.diff(np.cos(quarter))
        density = np.concatenate([ring, ring[::-1], ring, ring[::-1]])
    figure, axes = plt.subplots(figsize=(4.7, 3.4), layout="constrained", subplot_kw={"projection": "polar"})
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    axes.bar(0.5 * (edges[1:] + edges[:-1]), density, width=2.0 * np.pi / petals, color=ACHIEVED, edgecolor=BACKGROUND, linewidth=0.5)
    axes.plot(np.linspace(0.0, 2.0 * np.pi, 181), np.ones(181), color=TARGET, linewidth=1.2, linestyle=(0, (4, 3)))
    axes.set_xticks(np.radians([0, 90, 180, 270]), ["up", "", "down", ""])
    axes.set_yticks([1.0], [""])
    axes.spines["polar"].set_visible(False)
    return figure


PLOTS = {"density": density, "composition": composition, "lateral": lateral, "radial": radial, "segregation": segregation, "sizes": sizes, "coordination": coordination, "forces": forces, "rose": rose, "pairs": pairs,
         "settling": settling}


def draw(name: str, pack: Pack, analysis: dict[str, Any], path: Union[str, Path]) -> bool:
    """One plot of PLOTS into a file, PNG or SVG by its ending. False if there is nothing to show."""
    with plt.rc_context(LOOK):
        figure = PLOTS[name](pack, analysis)
        if figure is None:
            return False
        extra: dict[str, Any] = {"metadata": {"Date": None}} if Path(path).suffix == ".svg" else {"dpi": 160}
        try:
            figure.savefig(path, **extra)
        except OSError as error:
            raise Problem(f"cannot write {path}: {error}") from error
        plt.close(figure)
    return True


def main(words: list[str]) -> None:
    """packmpi plot WORDS."""
    parser = argparse.ArgumentParser(prog="packmpi plot", description="Plot what a pack (NAME.hdf) is like.")
    parser.add_argument("pack", help="pack file, NAME.hdf")
    parser.add_argument("-o", "--output", type=named, help="folder for the plots (default: that of the pack)")
    parser.add_argument("--format", choices=["png", "svg"], default="png")
    parser.add_argument("--only", nargs="+", choices=list(PLOTS), default=list(PLOTS), help="default: all")
    parser.add_argument("--program", help="packmpi, to analyze the pack (default: this one)")
    options = parser.parse_args(words)
    pack = Pack(options.pack)
    if pack.count == 0:
        raise Problem(f"{options.pack} has no particles")
    folder: Path = options.output or Path(options.pack).parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Problem(f"cannot make {folder}: {error}") from error
    analysis = pack.analysis(options.program)
    for name in options.only:
        path = folder / f"{pack.name}.{name}.{options.format}"
        print(f"{path}" if draw(name, pack, analysis, path) else f"nothing to show for {name}")
