#!/usr/bin/python3
"""Is a pack that was taken further by five layers as dense and as even as one made at once? Table in doc/going_on.md.

usage: scripts/study/going_on.py [--seeds N] [--layers N] [--program build/packmpi] [--set KEY=VALUE ...] [--document FILE]

Of each seed: a pack of so many layers, the same taken further by as many ([start]), and one of all layers made at once, of the same spheres, as sizes and
places of insertion go by seed and number. Solid fractions of the bulk, three diameters from the floor and from the lower of the two surfaces, and of slabs in it, two
diameters thick, with exact caps; the seam is the slab in which the surface of the first pack lies. Fifteen minutes of one core.
"""
import argparse
import statistics

import numpy as np

import measuring
from packmpi import Pack
from settling import run

DIAMETER = 0.010   # [m]
SIDE = 0.3
SCENE = f"""fidelity = "balanced"
[container]
size = [{SIDE}, {SIDE}, 1.0]
boundary = ["periodic", "periodic"]
[particles]
density = 2500
youngs_modulus = "20 MPa"
poisson_ratio = 0.25
radius = {{ distribution = "equal", value = {DIAMETER / 2} }}
[layers]
thickness = 0.06
fraction = 0.25
[jamming]
gravity = 9.81
[contact]
friction = 0.4
"""


def made(options, name, seed, layers, start=None):
    """The pack, which misses its height, as layers are counted."""
    folder = options.results / f"{seed}_{options.layers}"
    if not (folder / f"{name}.hdf").exists():
        folder.mkdir(parents=True, exist_ok=True)
        scene = folder / f"{name}.toml"
        scene.write_text(SCENE + (f'[start]\npack = "{start}.hdf"\n' if start else ""))
        changes = measuring.options_of({"seed": seed, "layers.maximum": layers, "checkpoint.every": '"off"'})
        run([options.program, scene, "-q", "--force", "-o", folder, *changes, *options.set], folder, folder / f"{name}.said")
    return Pack(folder / f"{name}.hdf")


def fraction(pack, low, high):
    """Of the slab between two heights [m], spheres cut by them."""
    z = pack.position[:, 2]
    return (measuring.solid_below(high, z, pack.radius) - measuring.solid_below(low, z, pack.radius)) / ((high - low) * SIDE * SIDE)


def surface(pack):
    """[m] where solid of the bulk's density would end: mean height of what is there, twice."""
    weights = pack.radius ** 3
    return 2.0 * float(np.average(pack.position[:, 2], weights=weights))


def compare(options, seed):
    first = made(options, "first", seed, options.layers)
    further = made(options, "further", seed, 2 * options.layers, "first")
    once = made(options, "once", seed, 2 * options.layers)
    if not (np.array_equal(further.radius, once.radius) and np.array_equal(further.radius[:first.count], first.radius)):
        raise SystemExit(f"going_on: seed {seed}: not the same spheres")
    low, high = 3.0 * DIAMETER, min(surface(further), surface(once)) - 3.0 * DIAMETER
    edges = np.linspace(low, high, max(3, round((high - low) / (2.0 * DIAMETER)) + 1))
    row = {"seed": seed, "spheres": once.count, "height": surface(once)}
    for name, pack in (("further", further), ("once", once)):
        slabs = [fraction(pack, a, b) for a, b in zip(edges, edges[1:])]
        row[name] = fraction(pack, low, high)
        row[f"{name}_spread"] = statistics.stdev(slabs)
        row[f"{name}_seam"] = fraction(pack, surface(first) - DIAMETER, surface(first) + DIAMETER)
    return row


def table(rows):
    out = ["| seed | spheres | solid fraction: taken further | made at once | difference | sd of slabs: further | at once | seam: further | at once |",
           "|---|---|---|---|---|---|---|---|---|"]
    keys = ["further", "once", "further_spread", "once_spread", "further_seam", "once_seam"]
    mean = {key: statistics.mean(row[key] for row in rows) for key in keys}
    for row in [*rows, {"seed": "mean", "spheres": "", **mean}]:
        out.append(f"| {row['seed']} | {row['spheres']} | {row['further']:.5f} | {row['once']:.5f} | {row['further'] - row['once']:+.5f} | {row['further_spread']:.5f} | "
                   f"{row['once_spread']:.5f} | {row['further_seam']:.5f} | {row['once_seam']:.5f} |")
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--layers", type=int, default=5, help="before and after")
    options = measuring.study_options(parser, "going_on", "going_on.md")
    rows = []
    for seed in range(1, options.seeds + 1):
        rows.append(compare(options, seed))
        print(table(rows)[-2], flush=True)
    text = "\n".join([f"{measuring.made_by('scripts/study/going_on.py')}. {options.layers} layers and {options.layers} more.", "", *table(rows)])
    print(text)
    if options.document.exists():
        measuring.write_block(options.document, "going_on", text)


if __name__ == "__main__":
    main()
