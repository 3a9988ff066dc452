#!/usr/bin/python3
"""How porous are beds of equal spheres in cylinders, and how does that go with the distance from the wall? Table and figure in doc/vessels.md,
doc/data/vessels.csv.

usage: scripts/study/vessels.py [--ratios D/d ...] [--seeds N] [--friction MU] [--program build/packmpi] [--set KEY=VALUE ...] [--document FILE]

All of it: some minutes of one core. Runs are remembered in results/vessels; the table has what is there.
"""
import argparse
import json
import math
import subprocess
import time
from pathlib import Path

import numpy as np

import common
import measuring

DIAMETER = 0.01   # of the spheres [m]
RATIOS = [4.0, 5.0, 6.0, 8.0, 10.0, 12.5, 15.0, 20.0, 25.0]
PROFILE_OF = 15.0
COLUMNS = ["ratio", "seed", "friction", "spheres", "porosity", "core_porosity", "height", "floor_over_weight", "code", "seconds"]
SCENE = """fidelity = "balanced"
[container]
shape = "cylinder"
diameter = {diameter}
height = {height}
[particles]
density = 2500.0
youngs_modulus = 1.0e7
poisson_ratio = 0.25
radius = {{ distribution = "equal", value = {radius} }}
[layers]
thickness = {thickness}
fraction = 0.25
[jamming]
gravity = 9.81
[contact]
damping_ratio = 0.3
friction = {friction}
"""


def dixon(x):
    """Porosity of a bed by d/D, up to 0.5 (Dixon 1988)."""
    return 0.4 + 0.05 * x + 0.412 * x * x


def loose(x):
    """Of one that was poured loosely, up to 0.256 (Zou and Yu 1995)."""
    return 0.400 + 0.010 * (math.exp(10.686 * x) - 1.0)


def dense(x):
    """Of one that was packed densely."""
    return 0.372 + 0.002 * (math.exp(15.306 * x) - 1.0)


def de_klerk(x, bulk):
    """Porosity at a distance of x diameters from the wall (de Klerk 2003)."""
    x = np.asarray(x, float)
    near = 2.14 * x * x - 2.53 * x + 1.0
    far = bulk + 0.29 * np.exp(-0.6 * x) * np.cos(2.3 * np.pi * (x - 0.16)) + 0.15 * np.exp(-0.9 * x)
    return np.where(x <= 0.637, near, far)


def height_of(ratio):
    """[m]: narrow beds are higher, so that there are spheres enough."""
    return (40.0 if ratio < 8.0 else 20.0) * DIAMETER


def made(options, ratio, seed):
    """The folder of a run that is done, with its analysis."""
    folder = options.results / f"{ratio:g}_{options.friction:g}_{seed}"
    name = folder / "bed.analysis.json"
    if name.exists():
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "bed.toml"
    scene.write_text(SCENE.format(diameter=ratio * DIAMETER, height=height_of(ratio), radius=DIAMETER / 2, thickness=10 * DIAMETER,
                                  friction=options.friction))
    start = time.time()
    done = subprocess.run([options.program, "run", scene, "-q", "--force", "--set", f"seed={seed}", *options.set], cwd=folder, check=False,
                          env=measuring.ENVIRONMENT, capture_output=True, text=True)
    (folder / "made.json").write_text(json.dumps({"code": done.returncode, "seconds": time.time() - start}))
    if done.returncode not in (0, 3):
        common.fail(f"{scene}: {done.stdout[-300:]}{done.stderr[-300:]}")
    subprocess.run([options.program, "analyze", "bed.hdf"], cwd=folder, check=True, env=measuring.ENVIRONMENT, capture_output=True)
    return folder


def row_of(folder, ratio, seed, friction):
    """A line of the table's data."""
    summary = json.loads((folder / "bed.json").read_text())["achieved"]
    core = json.loads((folder / "bed.analysis.json").read_text())["radial_profile"]["core"]["solid_fraction"]
    run = json.loads((folder / "made.json").read_text())
    return {"ratio": ratio, "seed": seed, "friction": friction, "spheres": summary["particles"], "porosity": round(summary["porosity_bulk"], 5),
            "core_porosity": round(1.0 - core, 5) if core else "", "height": summary["height"], "floor_over_weight": round(summary["floor_force"] / summary["weight"], 4),
            "code": run["code"], "seconds": round(run["seconds"], 1)}


def janssen(ratio, height, share, friction):
    """K with which the floor of a column bears that share of the weight: (1 - exp(-x)) / x, x = 4 mu K h / D."""
    low, high = 1e-6, 1e3
    for _ in range(100):
        x = math.sqrt(low * high)
        low, high = (x, high) if (1.0 - math.exp(-x)) / x > share else (low, x)
    return low / (4.0 * friction * height / (ratio * DIAMETER))


def mean(values):
    return sum(values) / len(values)


def wide_limit(rows):
    """What the beds' porosity tends to: their mean excess over Dixon's own, above his limit of 0.4."""
    return 0.4 + mean([row["porosity"] - dixon(1.0 / row["ratio"]) for row in rows])


def table(rows, options):
    limit = wide_limit(rows)
    lines = ["| D/d | spheres | porosity | less its wide limit | Dixon | dense, loose | three d from the wall | floor / weight | Janssen's K |",
             "|---|---|---|---|---|---|---|---|---|"]
    for ratio in sorted({row["ratio"] for row in rows}):
        of = [row for row in rows if row["ratio"] == ratio]
        x = 1.0 / ratio
        got = mean([row["porosity"] for row in of])
        core = [row["core_porosity"] for row in of if row["core_porosity"] != ""]
        curves = f"{dense(x):.3f}, {loose(x):.3f}" if x <= 0.256 else ""
        lines.append(f"| {ratio:g} | {len(of)} x {of[0]['spheres']:,} | {got:.4f} | {got - limit:.4f} | {dixon(x) - 0.4:.4f} | {curves} | "
                     f"{f'{mean(core):.4f}' if core else ''} | {mean([row['floor_over_weight'] for row in of]):.2f} | "
                     f"{mean([janssen(ratio, row['height'], row['floor_over_weight'], options.friction) for row in of]):.2f} |")
    lines += ["", f"Friction {options.friction:g}, wide limit {limit:.4f}. {measuring.made_by('scripts/study/vessels.py')}."]
    return "\n".join(lines)


def profiles(folders):
    """Distances from the wall [d], mean porosity of the shells there."""
    read = [json.loads((folder / "bed.analysis.json").read_text())["radial_profile"]["from_wall"] for folder in folders]
    width = read[0]["width"] / DIAMETER
    values = np.mean([one["values"] for one in read], axis=0)
    return (np.arange(len(values)) + 0.5) * width, 1.0 - values


def turns(x, y):
    """Minima and maxima in turn, beyond a quarter of a diameter: (place, value), of parabolas through three points."""
    found = []
    for k in range(1, len(x) - 1):
        bend = y[k - 1] - 2.0 * y[k] + y[k + 1]
        if x[k] > 0.25 and (y[k] - y[k - 1]) * (y[k + 1] - y[k]) < 0.0 and bend != 0.0:
            shift = 0.5 * (y[k - 1] - y[k + 1]) / bend
            found.append((x[k] + shift * (x[1] - x[0]), y[k] - 0.125 * (y[k - 1] - y[k + 1]) ** 2 / bend))
    return found


def turn_table(x, y, bulk):
    fine = np.linspace(0.0, 4.0, 4001)
    curve = turns(fine, de_klerk(fine, bulk))
    lines = ["| | at [d] | de Klerk | porosity | de Klerk |", "|---|---|---|---|---|"]
    for name, got, wanted in zip(["first minimum", "first maximum", "second minimum", "second maximum"], turns(x, y), curve):
        lines.append(f"| {name} | {got[0]:.2f} | {wanted[0]:.2f} | {got[1]:.3f} | {wanted[1]:.3f} |")
    return "\n".join(lines)


def figure(rows, x, y, bulk, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from packmpi import style
    plt.rcParams.update({"font.size": 9.5})
    _, (left, right) = plt.subplots(1, 2, figsize=(10.5, 3.8))
    share = np.linspace(0.03, 0.256, 200)
    left.fill_between(share, [dense(s) for s in share], [loose(s) for s in share], color="0.9", label="Zou & Yu, dense to loose")
    left.plot(share, [dixon(s) - 0.4 + wide_limit(rows) for s in share], color=style.INK, label="Dixon, at our wide limit")
    left.plot([1.0 / row["ratio"] for row in rows], [row["porosity"] for row in rows], "o", color=style.TARGET, markersize=4, label="packmpi")
    left.set(xlabel="d / D", ylabel="porosity of the bulk")
    left.legend(frameon=False)
    fine = np.linspace(0.0, 5.0, 1000)
    right.plot(fine, de_klerk(fine, bulk), color=style.INK, label="de Klerk")
    right.plot(x[x < 5.0], y[x < 5.0], ".", color=style.TARGET, label=f"packmpi, D/d = {PROFILE_OF:g}")
    right.set(xlabel="distance from the wall [d]", ylabel="porosity of the shell", ylim=(0.1, 1.0))
    right.legend(frameon=False)
    plt.tight_layout()
    plt.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description="Beds of equal spheres in cylinders.")
    parser.add_argument("--ratios", type=float, nargs="+", default=RATIOS, help="D/d")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--friction", type=float, default=0.2)
    parser.add_argument("--program", type=Path, default=measuring.ROOT / "build" / "packmpi")
    parser.add_argument("--results", type=Path, default=measuring.ROOT / "results" / "vessels")
    parser.add_argument("--document", type=Path, default=measuring.ROOT / "doc" / "vessels.md")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the scenes (tests)")
    options = parser.parse_args()
    options.program, options.results = options.program.resolve(), options.results.resolve()
    options.set = [word for value in options.set for word in ("--set", value)]
    folders = {(ratio, seed): made(options, ratio, seed) for ratio in options.ratios for seed in range(1, options.seeds + 1)}
    rows = [row_of(folder, ratio, seed, options.friction) for (ratio, seed), folder in folders.items()]
    of_profile = [folder for (ratio, _), folder in folders.items() if ratio == PROFILE_OF]
    text = table(rows, options)
    if of_profile:
        x, y = profiles(of_profile)
        bulk = mean([row["core_porosity"] for row in rows if row["ratio"] == PROFILE_OF])
        text += "\n\n" + turn_table(x, y, bulk)
        if options.document.parent.name == "doc":
            figure(rows, x, y, bulk, options.document.parent / "images" / "vessels.png")
    print(text)
    if options.document.exists():
        measuring.write_csv(options.document.parent / "data" / "vessels.csv", COLUMNS, rows)
        measuring.write_block(options.document, "vessels", text)


if __name__ == "__main__":
    main()
