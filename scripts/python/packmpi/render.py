"""A picture of a pack: spheres in 3D, discs in 2D, coloured by a property, with the container and the target height.

usage: packmpi render PACK.hdf [-o picture.png] [--color radius|layer|contacts|speed|component ...] [--size pixels] [--no-chains] [--section]

3D is drawn by VTK on a (virtual) X screen, 2D by matplotlib, and so is the section through the middle of a 3D pack (--section). Several colours make several pictures, picture.radius.png and
so on. A 2D pack with /contacts (output.contacts = true) gets its force chains, lines as thick as the normal forces; of several
pictures, the first.
"""
import argparse
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, Iterable, Union

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import colors, pyplot as plt  # noqa: E402  (after the choice of the backend)
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.textpath import TextPath  # noqa: E402

from . import vessel  # noqa: E402
from .problem import Problem, named  # noqa: E402
from .pack import Floats, Pack  # noqa: E402
from .style import BACKGROUND, INK, LID, TARGET  # noqa: E402
from .units import length_unit  # noqa: E402

PROPERTIES = ("radius", "layer", "contacts", "speed", "component")


def softened(name: str) -> colors.Colormap:
    """A colour map without its ends, on which shading and highlights are hard to see."""
    return colors.LinearSegmentedColormap.from_list(name, plt.get_cmap(name)(np.linspace(0.12, 0.92, 256)))


class Colouring:
    """Colours of the particles by one of PROPERTIES, and the bar that explains them. None: radius, or layer if all are equal."""

    def __init__(self, pack: Pack, what: Union[str, None] = None) -> None:
        equal = pack.count == 0 or np.ptp(pack.radius) == 0.0
        if what == "component" and not pack.components:
            raise Problem(f"{pack.path} has one component only")
        self.what = what or ("component" if pack.components else "layer" if equal else "radius")
        scale, unit = length_unit(float(pack.radius.max()) if pack.count else 1.0)
        self.values, self.label, cmap = {
            "radius": (scale * pack.radius, f"radius [{unit}]", "viridis"),
            "layer": (pack.layer + 1, "layer of insertion", "viridis"),
            "contacts": (pack.contacts, "coordination number", "plasma"),
            "component": (pack.component, ", ".join(f"{k}: {name}" for k, name in enumerate(pack.components)), "viridis"),
            "speed": (np.maximum(pack.speed, 1e-12), "speed [m/s]", "magma"),
        }[self.what]
        self.cmap = softened(cmap)
        self.ticks: Union[list[float], None] = None
        self.norm = self.scale()

    def scale(self) -> colors.Normalize:
        """From values to places on the colour map."""
        if len(self.values) == 0:
            return colors.Normalize(0.0, 1.0)
        low, high = float(self.values.min()), float(self.values.max())
        if self.what in ("layer", "contacts", "component"):
            return self.steps(int(low), int(high))
        if self.what == "speed":  # over decades; the slowest hundredth shares one colour
            low = max(float(np.percentile(self.values, 1.0)), high * 1e-8)
            return colors.LogNorm(low, max(high, 1.001 * low))
        if high == low:
            low, high, self.ticks = 0.9 * low, 1.1 * low, [low]
        return colors.Normalize(low, high)

    def steps(self, low: int, high: int) -> colors.Normalize:
        """One colour for each whole number."""
        count = high - low + 1
        self.cmap = colors.ListedColormap(self.cmap(np.linspace(0.0, 1.0, count)))
        self.ticks = list(range(low, high + 1, max(1, count // 12)))
        return colors.BoundaryNorm(np.arange(low, high + 2) - 0.5, count)

    def fade(self) -> None:
        """Paler, so that lines drawn over the particles stand out."""
        pale = 0.45 * self.cmap(np.linspace(0.0, 1.0, self.cmap.N)) + 0.55
        self.cmap = colors.ListedColormap(pale)

    def rgba(self) -> Floats:
        """(N, 4): the particles' colours, 0 to 1."""
        return self.cmap(self.norm(self.values))

    def bar(self, figure: Figure, axes: Axes) -> None:
        """Draws the bar into `axes`."""
        bar = figure.colorbar(ScalarMappable(self.norm, self.cmap), cax=axes, ticks=self.ticks)
        if self.ticks is not None:
            bar.ax.minorticks_off()
        bar.outline.set_linewidth(0.6)
        bar.set_label(self.label)


LID_WORDS = "blue: lid"


def container_size(pack: Pack) -> str:
    """Its lengths, "0.6 x 0.6 x 0.45 m", in a unit that suits the largest; of another vessel what it is, too."""
    scale, unit = length_unit(float(pack.size.max()))
    if pack.shape != "box":
        return vessel.words(pack, scale, unit)
    lengths = [*pack.size[:-1], pack.size[-1] if pack.lid is None else pack.lid]
    return " x ".join(f"{scale * length:g}" if pack.lid is None else f"{scale * length:.4g}" for length in lengths) + f" {unit}"


def caption(pack: Pack) -> list[str]:
    """What stands above a picture, in pieces that are not broken."""
    return [f"{pack.count:,} {pack.noun} in {container_size(pack)}", rf"$\phi$ = {pack.phi:.3f}", rf"$\phi_\mathrm{{bulk}}$ = {pack.phi_bulk:.3f}",
            f"$n$ = {pack.porosity_bulk:.3f}", f"$e$ = {pack.void_ratio_bulk:.3f}"]


CAPTION_POINTS = 11.0


class Caption:
    """The caption of a picture `pixels` wide at 100 dpi, in as many lines as it takes, smaller if one piece alone is wider."""

    def __init__(self, pack: Pack, pixels: int, rim: int = 12) -> None:
        pieces, between = caption(pack), ",  "
        room = pixels - 2 * rim
        self.points = CAPTION_POINTS * min(1.0, room / max(width_of(piece + between, CAPTION_POINTS) for piece in pieces))
        self.lines = [pieces[0]]
        for piece in pieces[1:]:
            if width_of(self.lines[-1] + between + piece + between, self.points) <= room:
                self.lines[-1] += between + piece
            else:
                self.lines.append(piece)
        self.rim = rim
        self.height = round(10 + 1.75 * self.points * len(self.lines)) + 4   # pixels

    def draw(self, figure: Figure) -> None:
        """At the head of the figure."""
        across, up = figure.get_size_inches() * figure.dpi
        figure.text(self.rim / across, 1.0 - 9 / up, "\n".join(self.lines), va="top", fontsize=self.points, linespacing=1.15, color=INK)


def width_of(words: str, points: float) -> float:
    """Of a line of text, in pixels at 100 dpi."""
    return TextPath((0.0, 0.0), words, size=points).get_extents().width * 100.0 / 72.0


def draw_3d(pack: Pack, colouring: Colouring, path: Union[str, Path], pixels: int) -> None:
    """A picture of spheres, PNG, about `pixels` wide. Needs VTK and an X screen."""
    from . import render_3d  # VTK is needed for this only
    image = render_3d.image_3d(pack, colouring.rgba(), pixels)
    height, width = image.shape[:2]
    dpi, strip, foot = 100, 110, 20  # pixels for the colour bar at the right, and for the note below
    width_all = max(width + strip, 400)  # a tall pack is narrow; its caption is not
    words = Caption(pack, width_all)
    head = words.height
    figure = plt.figure(figsize=(width_all / dpi, (height + head + foot) / dpi), dpi=dpi)
    across, up = width_all, height + head + foot
    left = (width_all - width - strip) // 2
    axes = figure.add_axes([left / across, foot / up, width / across, height / up])
    axes.imshow(image, interpolation="none")
    axes.axis("off")
    colouring.bar(figure, figure.add_axes([(left + width + 22) / across, 0.14, 16 / across, 0.66]))
    words.draw(figure)
    figure.text(12 / across, 5 / up, "red: target height" if pack.lid is None else LID_WORDS, fontsize=9, color=LID if pack.lid is not None else TARGET)
    figure.savefig(path, dpi=dpi, facecolor=BACKGROUND)
    plt.close(figure)


def pictures_of(pack: Union[str, Path], pictures: Iterable[Path], *options: Any) -> str:
    """Draws a pack in a process of its own (pictures in 3D may start it again under a virtual screen), with few colours.
    `pictures` are the files that must then be there, `options` those of packmpi render. What went wrong, or
    nothing."""
    command = [sys.executable, Path(__file__).parent / "__main__.py", "render", pack, *options]
    done = subprocess.run([str(word) for word in command], text=True, capture_output=True, check=False)
    if done.returncode != 0:
        return done.stderr.strip() or f"packmpi render ended with code {done.returncode}"
    for picture in pictures:
        use_few_colours(picture)
    return ""


def use_few_colours(picture: Path) -> None:
    """A third of the bytes."""
    from PIL import Image   # comes with matplotlib
    Image.open(picture).quantize(200).save(picture, optimize=True)


def parse(words: list[str]) -> argparse.Namespace:
    """The options of packmpi render."""
    parser = argparse.ArgumentParser(prog="packmpi render", description="Draw a pack (NAME.hdf) as a PNG picture.")
    parser.add_argument("pack", help="pack file, NAME.hdf")
    parser.add_argument("-o", "--output", type=named, help="picture to write (default: NAME.png beside the pack)")
    parser.add_argument("--color", choices=PROPERTIES, nargs="+", default=[None],
                        help="what the colours show (default: radius, or layer if all radii are equal)")
    parser.add_argument("--size", type=int, default=1000, help="width in pixels, about (default 1000)")
    parser.add_argument("--no-chains", action="store_true", help="2D: leave out the force chains")
    parser.add_argument("--section", action="store_true", help="3D: the section through the middle, across y, instead of the view from outside")
    parser.add_argument("--program", help=argparse.SUPPRESS)   # of all three tools; this one needs none
    options = parser.parse_args(words)
    if not 100 <= options.size <= 8000:
        parser.error("--size must be between 100 and 8000")
    return options


def main(words: list[str]) -> None:
    """packmpi render WORDS."""
    options = parse(words)
    path = str(options.output or Path(options.pack).with_suffix(".png"))
    pack = Pack(options.pack)
    outside = pack.dimension == 3 and not options.section
    if outside:
        from . import render_3d
        render_3d.use_virtual_screen()
    from . import render_2d
    stem, ending = os.path.splitext(path)
    for color in options.color:
        colouring = Colouring(pack, color)
        if len(options.color) > 1:
            path = f"{stem}.{color}{ending}"
        try:
            if outside:
                draw_3d(pack, colouring, path, options.size)
            elif pack.dimension == 3:
                render_2d.draw_section(pack, colouring, path, options.size)
            else:
                render_2d.draw_2d(pack, colouring, path, options.size, not options.no_chains and color == options.color[0])
        except OSError as error:
            raise Problem(f"cannot write {path}: {error}") from error
        print(f"{path}: {pack.count} particles by {colouring.what}")
