#!/usr/bin/python3
"""Makes one pack for each of the paper's figures 4 to 11 and draws it: doc/images/figure_4.png .. figure_11.png.

usage: scripts/study/figures.py [--only 4 5 ...] [--program build/packmpi] [--images FOLDER] [--size pixels] [--set KEY=VALUE ...]

The figures show packs of the four examples, with rotation and without. Two minutes of two cores; runs that are done
are not repeated. 3D needs a virtual screen: scripts/setup.sh --render.
"""
import argparse
import os
from pathlib import Path

import common
import reproduce
from packmpi.render import pictures_of

SEED = 1
# The paper's figure for each example, with rotation and without.
FIGURES = {("5.1", "on"): 4, ("5.1", "off"): 5, ("5.2", "on"): 6, ("5.2", "off"): 7,
           ("5.3", "on"): 8, ("5.3", "off"): 9, ("5.4", "on"): 10, ("5.4", "off"): 11}


def draw(run, number, images, size):
    """Coloured by the layer a particle came with, equal radii; by radius, graded ones; discs with their force chains."""
    path = images / f"figure_{number}.png"
    wrong = pictures_of(run.folder / f"{run.name}.hdf", [path], "-o", path, "--size", size)
    if wrong:
        common.fail(f"figure {number} could not be drawn: {wrong}")


def main():
    parser = argparse.ArgumentParser(description="Redraw the paper's figures 4 to 11.")
    parser.add_argument("--program", type=Path, default=common.ROOT / "build" / "packmpi")
    parser.add_argument("--results", type=Path, default=common.ROOT / "results" / "figures")
    parser.add_argument("--images", type=Path, default=common.ROOT / "doc" / "images")
    parser.add_argument("--size", type=int, default=700, help="width in pixels, about (default 700)")
    parser.add_argument("--only", type=int, nargs="+", choices=range(4, 12), default=range(4, 12), help="default: all")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenes (tests)")
    options = parser.parse_args()
    options.program, options.results = options.program.resolve(), options.results.resolve()
    options.set.append("output.contacts=true")
    runs = {reproduce.Run(options, example, rotation, SEED): number
            for (example, rotation), number in FIGURES.items() if number in options.only}
    sameness = reproduce.Sameness(options.program)
    reproduce.make([run for run in runs if not sameness.same(run)], options.program, os.cpu_count() or 1)
    options.images.mkdir(parents=True, exist_ok=True)
    for run, number in runs.items():
        draw(run, number, options.images, options.size)


if __name__ == "__main__":
    main()
