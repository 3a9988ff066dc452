#!/usr/bin/python3
"""Makes the packs of README's gallery and draws them: doc/images/quickstart.png and doc/images/gallery_*.png.

usage: scripts/study/gallery.py [--only quickstart soil ...] [--program build/packmpi] [--images FOLDER] [--set KEY=VALUE ...]

Scenes are those of input/, one of them changed as CHANGES says. A minute of one core; 3D needs a virtual screen: scripts/setup.sh --render.
"""
import argparse
import subprocess
from pathlib import Path

import common
from packmpi.render import pictures_of

# picture -> scene of input/, what is changed in it, width in pixels, colour
GALLERY = {
    "quickstart": ("quickstart", [], 720, "layer"),
    "gallery_soil": ("grading", ['container.size=["90 mm","90 mm","70 mm"]'], 560, "radius"),
    "gallery_specimen": ("confined", [], 560, "contacts"),
    "gallery_vessel": ("pebbles", ['container.height="600 mm"'], 560, "layer"),
    "gallery_concrete": ("concrete", [], 560, "radius"),
    "gallery_chains": ("periodic_2d", ["output.contacts=true", "dynamics.time_step=5e-5", 'particles.radius={distribution="uniform",weighting="number",min=0.006,max=0.012}'], 560, "contacts"),
}


def make(options, name):
    scene, changes, pixels, colour = GALLERY[name]
    folder = options.results / name
    folder.mkdir(parents=True, exist_ok=True)
    words = [word for change in [*changes, *options.set] for word in ("--set", change)]
    done = subprocess.run([options.program, common.ROOT / f"input/{scene}.toml", "-q", "--force", "-o", folder, *words], env=common.ENVIRONMENT, check=False,
                          stdout=subprocess.DEVNULL)
    if done.returncode != 0:
        common.fail(f"{scene} ended with code {done.returncode}")
    picture = options.images / f"{name}.png"
    wrong = pictures_of(folder / f"{scene}.hdf", [picture], "-o", picture, "--size", pixels, "--color", colour)
    if wrong:
        common.fail(f"{name} could not be drawn: {wrong}")
    print(f"{picture}: {picture.stat().st_size // 1000} kB")


def main():
    parser = argparse.ArgumentParser(description="Draw README's gallery.")
    parser.add_argument("--only", nargs="+", choices=GALLERY, default=GALLERY, metavar="PICTURE", help="default: all")
    parser.add_argument("--program", type=lambda text: Path(text).resolve(), default=common.ROOT / "build/packmpi")
    parser.add_argument("--results", type=lambda text: Path(text).resolve(), default=common.ROOT / "results/gallery")
    parser.add_argument("--images", type=lambda text: Path(text).resolve(), default=common.ROOT / "doc/images")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenes (tests)")
    options = parser.parse_args()
    options.images.mkdir(parents=True, exist_ok=True)
    for name in options.only:
        make(options, name)


if __name__ == "__main__":
    main()
