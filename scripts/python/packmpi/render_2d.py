"""A pack in a plane, drawn by matplotlib: discs with their force chains, and the section through the middle of a pack of spheres."""
import math
from pathlib import Path
from typing import NamedTuple, Union

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure

from . import vessel
from .pack import Floats, Integers, Pack
from .render import LID_WORDS, Caption, Colouring
from .style import BACKGROUND, INK, LID, TARGET

DPI = 100
STRIP, RIM = 1.15, 0.30   # inches for the colour bar and around the picture
TALLEST = 1.6             # of the picture's width
WIDEST = 5.0              # of a section's height: of a wider bed its middle is shown


class Sheet(NamedTuple):
    """A figure of a pack in a plane."""

    figure: Figure
    axes: Axes      # metres
    bar: Axes
    caption: Caption
    foot: tuple[float, float]   # where a note begins, shares of the figure
    points: float   # typographical points a metre
    whole: bool     # the pack is, from side to side


def new_sheet(pack: Pack, pixels: int, widest: float = math.inf) -> Sheet:
    """An empty one, `pixels` wide, for the height of the pack's top and its width, or the middle of it if that is over `widest` heights."""
    top = vessel.top(pack)
    width = min(float(pack.size[0]), widest * top)
    middle = 0.5 * float(pack.size[0])
    room = pixels / DPI - STRIP - RIM
    inches = min(room, TALLEST * pixels / DPI * width / top)
    high = inches * top / width
    words = Caption(pack, pixels, round(RIM * DPI))
    across, up = pixels / DPI, high + 1.1 * RIM + words.height / DPI
    left = RIM + 0.5 * (room - inches)
    figure = plt.figure(figsize=(across, up), dpi=DPI)
    axes = figure.add_axes([left / across, RIM / up, inches / across, high / up])
    axes.set_xlim(middle - 0.5 * width, middle + 0.5 * width)
    axes.set_ylim(0.0, top)
    axes.axis("off")
    bar = figure.add_axes([(left + inches + 0.22) / across, (RIM + 0.08 * high) / up, 0.16 / across, 0.84 * high / up])
    return Sheet(figure, axes, bar, words, (RIM / across, 0.08 / up), 72.0 * inches / width, width == float(pack.size[0]))


def put_circles(sheet: Sheet, places: Floats, radii: Floats, colours: Floats, line: float) -> None:
    """Circles at (N, 2) places [m], rims `line` points thick."""
    sheet.axes.add_collection(EllipseCollection(2.0 * radii, 2.0 * radii, np.zeros(len(radii)), units="xy", facecolors=colours, edgecolors=INK,
                                                linewidths=line, offsets=places, transOffset=sheet.axes.transData, zorder=2))


def put_heights(sheet: Sheet, pack: Pack) -> None:
    """The target height, or the lid."""
    width, target = float(pack.size[0]), float(pack.size[-1])
    if pack.lid is None:
        sheet.axes.plot([0, width], [target, target], color=TARGET, linewidth=1.4, linestyle=(0, (6, 3)), zorder=5)
    else:
        sheet.axes.plot(vessel.span(pack, pack.lid), [pack.lid, pack.lid], color=LID, linewidth=3.0, clip_on=not sheet.whole, zorder=5)


def put_box(sheet: Sheet, pack: Pack) -> None:
    """The sides and the floor of a box."""
    width, top = float(pack.size[0]), pack.top()
    sheet.axes.plot([0, 0, width, width], [top, 0, 0, top], color=INK, linewidth=1.6, clip_on=not sheet.whole, zorder=4)


def put_vessel(sheet: Sheet, pack: Pack) -> None:
    """The walls of a vessel, in 3D where the section through its middle cuts them."""
    middle = 0.5 * float(pack.size[0])
    if pack.shape == "mesh":
        corners, triangles = vessel.mesh(pack)
        cuts = [[(a[0], a[2]), (b[0], b[2])] for a, b in vessel.section(corners, triangles, 0.5 * float(pack.size[1]), 1)]
        sheet.axes.add_collection(LineCollection(cuts, colors=INK, linewidths=1.6, zorder=4))
        return
    if pack.shape in ("trapezium", "polygon"):
        sheet.axes.plot(*vessel.corners(pack).T, color=INK, linewidth=1.6, clip_on=False, zorder=4)
        return
    walls = vessel.outlines(pack, pack.top())
    floor = [float(line[0, 1]) for line in walls] + [0.0]   # of an annulus from the outer wall to the inner one, else to the axis
    for side in (-1.0, 1.0):
        lines = [(middle + side * line[:, 1], line[:, 0]) for line in walls]
        if pack.shape not in ("sphere", "circle"):
            lines.append((middle + side * np.array(floor[:2]), np.zeros(2)))
        for x, z in lines:
            sheet.axes.plot(x, z, color=INK, linewidth=1.6, clip_on=not sheet.whole, zorder=4)


def finish(sheet: Sheet, pack: Pack, colouring: Colouring, note: str, path: Union[str, Path]) -> None:
    """The colour bar, the caption and a note; and the file."""
    colouring.bar(sheet.figure, sheet.bar)
    sheet.caption.draw(sheet.figure)
    sheet.figure.text(*sheet.foot, ("red: target height" if pack.lid is None else LID_WORDS) + note, fontsize=9, color=TARGET if pack.lid is None else LID)
    sheet.figure.savefig(path, dpi=DPI, facecolor=BACKGROUND)
    plt.close(sheet.figure)


def chain_lines(pack: Pack, axes: Axes, points: float) -> float:
    """Lines between touching discs, as thick as the normal force: `points` for the mean one, which is returned [N]."""
    assert pack.pairs is not None and pack.forces is not None   # who calls this has looked
    first, second = pack.position[pack.pairs[:, 0], :2], pack.position[pack.pairs[:, 1], :2]
    normal = second - first
    near = np.abs(normal[:, 0]) < 0.5 * pack.size[0]  # not those across a periodic side
    length = np.linalg.norm(normal, axis=1)
    force = np.abs(np.einsum("ij,ij->i", pack.forces[:, :2], normal)) / np.maximum(length, 1e-300)
    typical = force[near].mean() if near.any() else 1.0
    width = points * np.minimum(0.9 * force[near] / max(typical, 1e-300), 5.0)
    lines = np.stack([first[near], second[near]], axis=1)
    axes.add_collection(LineCollection(lines, linewidths=width, colors="#101010", capstyle="round", zorder=3))
    return typical


def draw_2d(pack: Pack, colouring: Colouring, path: Union[str, Path], pixels: int, chains: bool) -> None:
    """A picture of discs, PNG, `pixels` wide, with force chains if they are wanted and the pack has contacts."""
    show = chains and pack.pairs is not None and len(pack.pairs) > 0
    if show:
        colouring.fade()
    sheet = new_sheet(pack, pixels)
    points = sheet.points * 2.0 * float(pack.radius.mean()) if pack.count else 1.0  # a mean diameter in points
    put_circles(sheet, pack.position[:, :2], pack.radius, colouring.rgba(), min(0.6, 0.04 * points))
    note = f";  lines: contact forces, mean {chain_lines(pack, sheet.axes, 0.1 * points):.2g} N" if show else ""
    (put_box if pack.shape == "box" else put_vessel)(sheet, pack)
    put_heights(sheet, pack)
    finish(sheet, pack, colouring, note, path)


class Circles(NamedTuple):
    """What a plane cuts of spheres."""

    which: Integers   # (M) numbers of the spheres
    places: Floats    # (M, 2): x and z of the middles [m]
    radii: Floats     # (M) [m]


def cut_middle(pack: Pack) -> Circles:
    """Of the spheres of a pack those circles in which the plane y = half the depth cuts them; images across a periodic side, too."""
    away = pack.position[:, 1] - 0.5 * pack.size[1]
    which = np.flatnonzero(np.abs(away) < pack.radius)
    places, radii = pack.position[which][:, [0, 2]], np.sqrt(pack.radius[which] ** 2 - away[which] ** 2)
    if pack.shape == "box" and pack.scene()["container"]["boundary"][0] == "periodic":
        width = float(pack.size[0])
        low, high = places[:, 0] < radii, places[:, 0] > width - radii
        places = np.concatenate([places, places[low] + [width, 0.0], places[high] - [width, 0.0]])
        which, radii = (np.concatenate([values, values[low], values[high]]) for values in (which, radii))
    return Circles(which, places, radii)


def draw_section(pack: Pack, colouring: Colouring, path: Union[str, Path], pixels: int) -> None:
    """The section through the middle of a pack of spheres, across y: circles as the plane cuts them, PNG, `pixels` wide. Of a bed wider than five
    heights its middle."""
    cut = cut_middle(pack)
    sheet = new_sheet(pack, pixels, WIDEST)
    points = sheet.points * 2.0 * float(cut.radii.mean()) if len(cut.radii) else 1.0
    put_circles(sheet, cut.places, cut.radii, colouring.rgba()[cut.which], min(0.6, 0.04 * points))
    (put_box if pack.shape == "box" else put_vessel)(sheet, pack)
    put_heights(sheet, pack)
    finish(sheet, pack, colouring, ";  section through the middle" if sheet.whole else f";  middle of the section, {WIDEST:g} heights wide", path)
