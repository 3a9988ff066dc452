#!/usr/bin/python3
"""Beds in vessels that are neither box nor cylinder: tables and pictures of doc/vessels.md, in space and in the plane.

usage: scripts/study/shapes.py [--only space plane] [--steps N] [--program build/packmpi] [--set KEY=VALUE ...] [--document FILE]

LAMMPS (scripts/setup.sh --peers) runs each pack for N steps, and tells how far particles move. Some minutes of one core; 3D needs a virtual screen:
scripts/setup.sh --render. Packs stay in results/shapes.
"""
import argparse
import json
import re
import shutil
from types import SimpleNamespace

import common
import measuring
from packmpi.render import pictures_of
from settling import run
from vessels import turns

SPHERES = """fidelity = "balanced"
[container]
[particles]
density = 2500.0
youngs_modulus = 2.0e7
poisson_ratio = 0.25
diameter = { distribution = "equal", value = "8 mm" }
[layers]
thickness = "40 mm"
fraction = 0.25
[jamming]
gravity = 9.81
[contact]
damping_ratio = 0.3
friction = 0.3
[output]
contacts = true
"""
POLYGON = "[[0.12, 0], [0.28, 0], [0.4, 0.12], [0.32, 0.33], [0.06, 0.3], [0, 0.09]]"
KINDS = {   # of vessels: the scene around [container], the colour of pictures, and of each vessel its words and its keys
    "space": SimpleNamespace(scene=SPHERES, colour="layer", particles="spheres", vessels={
        "frustum, wider above, 60 to 160 mm, H_d 120 mm": 'shape = "frustum"\nbottom_diameter = 0.06\ntop_diameter = 0.16\nheight = 0.12',
        "frustum, narrower above, 160 to 60 mm, H_d 120 mm": 'shape = "frustum"\nbottom_diameter = 0.16\ntop_diameter = 0.06\nheight = 0.12',
        "sphere of 150 mm, H_d 130 mm": 'shape = "sphere"\ndiameter = 0.15\nheight = 0.13',
        "annulus, 60 and 160 mm, H_d 80 mm": 'shape = "annulus"\ndiameter = 0.16\ninner_diameter = 0.06\nheight = 0.08'}),
    "plane": SimpleNamespace(scene=(measuring.ROOT / "input/hopper_2d.toml").read_text(), colour="radius", particles="discs", vessels={
        "trapezium, wider above, 60 to 400 mm": 'dimension = 2\nshape = "trapezium"\nbottom_width = 0.06\ntop_width = 0.4\nheight = 0.3',
        "trapezium, narrower above, 400 to 160 mm": 'dimension = 2\nshape = "trapezium"\nbottom_width = 0.4\ntop_width = 0.16\nheight = 0.3',
        "circle of 360 mm": 'dimension = 2\nshape = "circle"\ndiameter = 0.36\nheight = 0.3',
        "polygon": f'dimension = 2\nshape = "polygon"\npolygon = {POLYGON}\nheight = 0.3'}),
}
HANDED = ["--set", "rest.kinetic_energy=1e-10", "--set", "rest.unbalanced_force=1e-4"]   # no loose particle rolls on (doc/rest.md)
PIXELS = 560


def pack_of(options, kind, keys, name):
    """The folder of a bed, analysed."""
    folder = options.results / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "bed.toml").write_text(re.sub(r"\[container\][^\[]*\n(?=\[)", lambda _: f"[container]\n{keys}\n", kind.scene))
    run([options.program, "bed.toml", "-q", *HANDED, *options.set], folder, folder / "packmpi.said")
    run([options.program, "analyze", "bed.hdf"], folder, folder / "packmpi.said")
    return folder


def drift_of(options, folder):
    """The farthest move in LAMMPS [mean diameters]."""
    run([options.program, "convert", "bed.hdf", "--to", "lammps"], folder, folder / "packmpi.said")
    said, _ = run(["lmp", "-in", "bed.lammps.in", "-var", "steps", options.steps], folder, folder / "lammps.said")
    return float(re.search(r"(?m)^DRIFT.*?([\d.e+-]+) mean diameters", said)[1])


def first_turns(profile, diameter):
    """The first maximum and minimum of the solid fraction from the wall: value and place [d], a cell each."""
    places = [(k + 0.5) * profile["width"] / diameter for k in range(len(profile["values"]))]
    return " | ".join(f"{value:.3f}, {place:.2f}" for place, value in turns(places, profile["values"])[:2])


def row_of(options, words, folder):
    summary, radial = (json.loads((folder / f"bed{name}.json").read_text()) for name in ("", ".analysis"))
    got, radial = summary["achieved"], radial["radial_profile"]
    core = radial.get("core", {}).get("solid_fraction")
    floor = f"{got['floor_force'] / got['weight']:.2f}" if got["floor_force"] else ""   # a sphere has none
    moved = f"{drift_of(options, folder):.1e}" if options.steps else ""
    return (f"| {words} | {got['particles']:,} | {got['phi_bulk']:.3f} | {f'{core:.3f}' if core else ''} | "
            f"{first_turns(radial['from_wall'], 2.0 * got['mean_radius'])} | {floor} | {moved} |")


def sheet(pictures, path):
    """Four pictures in two rows, each in the middle of its place."""
    from PIL import Image   # comes with matplotlib
    images = [Image.open(picture).convert("RGBA").convert("RGB") for picture in pictures]
    width, height = (max(image.size[axis] for image in images) for axis in range(2))
    whole = Image.new("RGB", (2 * width, 2 * height), "white")
    for k, image in enumerate(images):
        whole.paste(image, (k % 2 * width + (width - image.width) // 2, k // 2 * height + (height - image.height) // 2))
    whole.quantize(200).save(path, optimize=True)


def table(options, name):
    kind = KINDS[name]
    lines = [f"| vessel | {kind.particles} | solid fraction of the bulk | three diameters from the walls | first maximum, at [d] | first minimum, at [d] | "
             f"floor / weight | farthest move in LAMMPS, {options.steps:,} steps [d] |", "|---|---|---|---|---|---|---|---|"]
    pictures = []
    for k, (words, keys) in enumerate(kind.vessels.items()):
        folder = pack_of(options, kind, keys, f"{name}_{k}")
        lines.append(row_of(options, words, folder))
        print(lines[-1], flush=True)
        pictures.append(folder / "bed.png")
        wrong = pictures_of(folder / "bed.hdf", pictures[-1:], "-o", pictures[-1], "--size", PIXELS, "--color", kind.colour)
        if wrong:
            common.fail(wrong)
    if options.document.parent.name == "doc":
        sheet(pictures, options.document.parent / "images" / f"vessels_{name}.png")
    return "\n".join([*lines, "", f"{measuring.made_by('scripts/study/shapes.py')}."])


def main():
    parser = argparse.ArgumentParser(description="Beds in vessels of other shapes.")
    parser.add_argument("--only", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--steps", type=int, default=10000, help="in LAMMPS; 0: none")
    options = measuring.study_options(parser, "shapes", "vessels.md")
    for name in options.only:
        text = table(options, name)
        if options.document.exists():
            measuring.write_block(options.document, name, text)


if __name__ == "__main__":
    main()
