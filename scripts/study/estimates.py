#!/usr/bin/python3
"""Makes packs and compares them with what `packmpi estimate` said, after its probe: the table of doc/estimate.md.

usage: scripts/study/estimates.py [--cases WORD ...]       (only cases whose name has one of the words)

Runs build/packmpi, one rank, one pack after the other, in results/estimates: friction, rotation, walls and size
distributions, in 2D and 3D. Three to ten minutes of one core.
"""
import argparse
import json
import re
import subprocess
from pathlib import Path

import measuring
from common import ENVIRONMENT, ROOT, fail

PROGRAM = ROOT / "build" / "packmpi"
FOLDER = ROOT / "results" / "estimates"
PAGE = ROOT / "doc" / "estimate.md"
CUBE = ["container.size=[0.4,0.4,0.4]", "layers.thickness=0.12"]
SQUARE = ["container.size=[0.5,0.4]"]
PERIODIC = 'container.boundary=["periodic","periodic"]'
GRADINGS = {   # of the mean radius, near 20 mm in 3D
    "Gaussian, sd 0.1": '{{distribution="gaussian",mean={r},sd={0.1r},min={0.7r},max={1.3r},weighting="number"}}',
    "uniform 1:2": '{{distribution="uniform",min={0.667r},max={1.333r},weighting="number"}}',
    "uniform 1:3 by mass": '{{distribution="uniform",min={0.5r},max={1.5r},weighting="mass"}}',
    "lognormal, sd 0.3": '{{distribution="lognormal",median={r},log_sd=0.3,min={0.4r},max={2.0r},weighting="number"}}',
    "bidisperse 1:3": '{{distribution="bidisperse",small={0.5r},large={1.5r},large_share=0.7,weighting="mass"}}',
}


def graded(name, radius):
    sizes = re.sub(r"\{([\d.]*)r\}", lambda m: repr(float(m[1] or 1) * radius), GRADINGS[name])
    return ["particles.radius=" + sizes.replace("{{", "{").replace("}}", "}"), 'dynamics.time_step="auto"',
            "layers.attempts=100000"]


def cases():
    for rotation in ("true", "false"):
        spin = ["dynamics.rotation=" + rotation]
        word = "" if rotation == "true" else ", no rotation"
        for friction in (0.0, 0.2, 0.5):
            sets = [f"contact.friction={friction}", *spin]
            yield f"spheres, friction {friction}{word}", "quickstart", [*CUBE, PERIODIC, *sets]
            yield f"discs, friction {friction}{word}", "periodic_2d", [*SQUARE, *sets]
        yield f"spheres between walls{word}", "quickstart", [*CUBE, *spin]
        for name in GRADINGS:
            yield f"spheres, {name}{word}", "quickstart", [*CUBE, PERIODIC, *graded(name, 0.02), *spin]
    for name in ("uniform 1:2", "lognormal, sd 0.3"):
        yield f"discs, {name}", "periodic_2d", [*SQUARE, *graded(name, 0.01)]
    yield "input/quickstart.toml", "quickstart", []
    yield "input/grading.toml", "grading", []


def run(words, codes=(0,)):
    done = subprocess.run([str(PROGRAM), *words], env=ENVIRONMENT, text=True, capture_output=True)
    if done.returncode not in codes:
        fail(f"{' '.join(words)} ended with code {done.returncode}:\n{done.stderr}")
    return done.stdout


def solid_volume(pack, dimension):
    """Of all particles [m3, m2]."""
    import h5py
    import numpy as np
    with h5py.File(pack) as file:
        r = file["particles/radius"][:]
    return float(np.pi * (4.0 / 3.0 * r**3 if dimension == 3 else r**2).sum())


def row(name, scene, sets):
    words = [str(ROOT / "input" / (scene + ".toml")), *(word for one in sets for word in ("--set", one))]
    told = json.loads(run(["estimate", *words, "--json"]))
    run([*words, "--quiet", "--force", "-o", str(FOLDER)])
    summary = json.loads((FOLDER / (scene + ".json")).read_text())
    pack = FOLDER / (scene + ".hdf")
    size = summary["target"]["size"]
    area = size[0] * (size[1] if len(size) == 3 else 1.0)
    got = solid_volume(pack, len(size)) / area / summary["achieved"]["height"]
    fraction = told["fraction"]
    number = told["particles"]
    print(f"{name}: {fraction['value']:.4f} {got:.4f}", flush=True)
    return (f"| {name} | {fraction['value']:.3f} ± {fraction['error']:.3f} | {got:.3f} | {number['value']} "
            f"({number['least']} to {number['most']}) | {summary['achieved']['particles']} | {told['files']['pack']} | "
            f"{pack.stat().st_size} | {told['wall_seconds']:.2g} | {summary['provenance']['wall_seconds']:.2g} |")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--cases", nargs="+", default=[""])
    wanted = options.parse_args().cases
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows = [row(*case) for case in cases() if any(word in case[0] for word in wanted)]
    head = (f"{measuring.made_by('scripts/study/estimates.py')}; one pack a line, seed 1.\n\n"
            "| scene | fraction, estimated | achieved | particles, estimated | achieved | pack, bytes, estimated | achieved | "
            "time, s, estimated | achieved |\n|---|---|---|---|---|---|---|---|---|\n")
    if wanted != [""]:
        print("\n".join(rows))
        return
    measuring.write_block(PAGE, "estimates", head + "\n".join(rows))


if __name__ == "__main__":
    main()
