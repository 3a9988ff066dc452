#!/usr/bin/python3
"""Plots of a pack: density profile, sizes target and achieved, pair distribution, how it settled.

usage: scripts/plot.py PACK.hdf [-o FOLDER] [--format png|svg] [--only density sizes pairs settling] [--program packmpi]

Writes NAME.density.png and so on beside the pack, or in FOLDER. Needs what scripts/setup.sh --plots installs. The
numbers are those of `packmpi analyze`, which is run first if NAME.analysis.json is older than the pack or not there;
the history is NAME.steps.csv, and is left out if that is not beside the pack.
"""
import argparse
from pathlib import Path

from common import ACCENT, BACKGROUND, GOT, GRID, INK, OTHER, fail, missing

try:
    import matplotlib
    import numpy as np
except ImportError as error:
    missing(error.name, "plots")
matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402  (after the choice of the backend)

import packs  # noqa: E402

plt.rcParams.update({
    "font.size": 9.5, "axes.edgecolor": INK, "axes.labelcolor": INK, "text.color": INK, "xtick.color": INK,
    "ytick.color": INK, "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.7, "axes.axisbelow": True,
    "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "legend.fontsize": 8.5,
    "lines.linewidth": 1.6, "figure.facecolor": BACKGROUND, "axes.facecolor": "none", "svg.hashsalt": "packmpi"})


def new_figure(rows=1):
    figure, axes = plt.subplots(rows, 1, figsize=(4.7, 3.4), layout="constrained", sharex=True)
    return figure, axes


def staircase(profile):
    """Edges and values of a profile of packmpi analyze."""
    values = np.array(profile["values"], dtype=float)
    return profile["from"] + profile["width"] * np.arange(len(values) + 1), values


def density(pack, analysis):
    """Solid fraction over the height."""
    edges, values = staircase(analysis["density_profile"]["xyz"[pack.dimension - 1]])
    asked = pack.size[-1]
    figure, axes = new_figure()
    axes.axvspan(0.2 * asked, 0.8 * asked, color=OTHER, alpha=0.16, linewidth=0)
    axes.stairs(values, edges, color=GOT, linewidth=1.5, baseline=None)
    axes.hlines(pack.phi_bulk, 0.2 * asked, 0.8 * asked, color=INK, linewidth=1.0, linestyle=(0, (4, 3)))
    axes.annotate(rf"$\phi_\mathrm{{bulk}}$ = {pack.phi_bulk:.3f}", (0.5 * asked, pack.phi_bulk), (0, -30),
                  textcoords="offset points", ha="center", fontsize=9)
    axes.axvline(asked, color=ACCENT, linestyle=(0, (6, 3)))
    axes.annotate("target height", (asked, 0.02), (-4, 0), textcoords="offset points", rotation=90, ha="right",
                  va="bottom", color=ACCENT, fontsize=8.5)
    axes.set(xlabel="height [m]", ylabel="solid fraction", xlim=(0.0, max(edges[-1], 1.02 * asked)), ylim=(0.0, None))
    return figure


def sizes(pack, _):
    """What passes a sieve, target and achieved, by mass and by number; nothing if all radii are equal."""
    if np.ptp(pack.radius) == 0.0:
        return None
    r, *asked = packs.target_curve(pack.scene()["particles"]["radius"])
    got_r, *got = packs.achieved_curve(pack.radius)
    figure, axes = new_figure()
    for shares, found, colour, name in zip(asked, got, (OTHER, GOT), ("by number", "by mass")):
        axes.step(2000.0 * np.append(got_r[0], got_r), 100.0 * np.append(0.0, found), where="post", color=colour,
                  label=f"got, {name}")
        axes.plot(2000.0 * r, 100.0 * shares, color=INK if name == "by number" else ACCENT, linewidth=1.2,
                  linestyle=(0, (4, 2.5)), label=f"asked, {name}")
    low, high = 2000.0 * min(r[0], got_r[0]), 2000.0 * max(r[-1], got_r[-1])
    if high > 3.0 * low:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda x, _: f"{x:g}"))
        axes.xaxis.set_minor_formatter(matplotlib.ticker.LogFormatter(minor_thresholds=(2.0, 0.9)))
        axes.set_xlim(low / 1.05, high * 1.05)
    else:
        rim = 0.05 * (high - low) or 0.1 * high
        axes.set_xlim(low - rim, high + rim)
    axes.set(xlabel="diameter [mm]", ylabel="passing [%]", ylim=(-2.0, 102.0))
    axes.legend(loc="upper left" if np.interp(np.sqrt(low * high), 2000.0 * r, asked[0]) < 0.5 else "lower right")
    return figure


def pairs(pack, analysis):
    """Pair distribution, 1 where places are independent of each other."""
    edges, values = staircase(analysis["pair_distribution"]["g"])
    if not np.any(values):
        return None
    figure, axes = new_figure()
    axes.axhline(1.0, color=OTHER, linewidth=1.0)
    axes.stairs(values, edges, color=GOT, linewidth=1.5, baseline=None)
    axes.set(xlabel=r"distance of centres [mean diameters]", ylabel="g(r)", xlim=(0.0, edges[-1]), ylim=(0.0, None))
    return figure


def legend_above(axes):
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, columnspacing=1.0, handlelength=1.4,
                borderaxespad=0.1)


def settling(pack, _):
    """Height and energy of the moving particles over simulated time; a line where a layer comes."""
    steps = pack.steps()
    if not steps:
        return None
    figure, (above, below) = new_figure(2)
    time = steps["time"]
    starts = time[np.flatnonzero(np.diff(steps["layer"], prepend=-1.0))]
    for axes in (above, below):
        for start in starts[1:]:
            axes.axvline(start, color=OTHER, linewidth=0.6, alpha=0.5)
        axes.grid(axis="x", visible=False)
    above.axhline(pack.size[-1], color=ACCENT, linewidth=1.2, linestyle=(0, (6, 3)), label="target height")
    above.plot(time, steps["top"], color=GOT, label="highest top")
    above.plot(time, steps["mean height"], color=OTHER, label="mean height")
    above.set(ylabel="[m]", ylim=(0.0, None))
    legend_above(above)
    for name, colour in (("kinetic energy", GOT), ("elastic energy", OTHER)):
        below.plot(time, np.where(steps[name] > 0.0, steps[name], np.nan), color=colour, label=name)
    below.set(yscale="log", ylabel="[J]", xlabel="simulated time [s]", xlim=(0.0, time[-1]))
    legend_above(below)
    return figure


PLOTS = {"density": density, "sizes": sizes, "pairs": pairs, "settling": settling}


def draw(name, pack, analysis, path):
    """One plot into a file, PNG or SVG by its ending. False if there is nothing to show."""
    figure = PLOTS[name](pack, analysis)
    if figure is None:
        return False
    extra = {"metadata": {"Date": None}} if Path(path).suffix == ".svg" else {"dpi": 160}
    try:
        figure.savefig(path, **extra)
    except OSError as error:
        fail(f"cannot write {path}: {error}")
    plt.close(figure)
    return True


def main():
    parser = argparse.ArgumentParser(description="Plot what a pack (NAME.hdf) is like.")
    parser.add_argument("pack", help="pack file, NAME.hdf")
    parser.add_argument("-o", "--output", type=Path, help="folder for the plots (default: that of the pack)")
    parser.add_argument("--format", choices=["png", "svg"], default="png")
    parser.add_argument("--only", nargs="+", choices=list(PLOTS), default=list(PLOTS), help="default: all")
    parser.add_argument("--program", help="packmpi (default: build/packmpi, or the one in PATH)")
    options = parser.parse_args()
    pack = packs.Pack(options.pack)
    if pack.count == 0:
        fail(f"{options.pack} has no particles")
    folder = options.output or pack.path.parent
    folder.mkdir(parents=True, exist_ok=True)
    analysis = pack.analysis(options.program)
    for name in options.only:
        path = folder / f"{pack.name}.{name}.{options.format}"
        print(f"{path}" if draw(name, pack, analysis, path) else f"nothing to show for {name}")


if __name__ == "__main__":
    main()
