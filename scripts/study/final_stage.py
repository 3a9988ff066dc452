#!/usr/bin/python3
"""How long the final stage took until the packs of doc/data/presets.csv were at rest, in falls through a layer, and what `packmpi estimate`
foretells of their particle-steps: the figures of doc/estimate.md. Runs no pack; needs a built program.

usage: scripts/study/final_stage.py [--settings draft balanced reference]
"""
import argparse
import json
import math
import re
import statistics
import subprocess

import measuring
import presets
from settling import effective

PROGRAM = measuring.ROOT / "build/packmpi"


def said(command, base, changes, *options):
    return subprocess.run([PROGRAM, command, base, *options, *measuring.options_of(changes)], text=True, capture_output=True,
                          env=measuring.ENVIRONMENT, check=True).stdout


def row(base, name, setting, packs):
    """Foretold over taken particle-steps, and falls that the final stage took, in the mean of the packs."""
    changes = {**presets.SCENES[name][0], **presets.SETTINGS[setting]}
    estimate = json.loads(said("estimate", base, changes, "--json"))
    values = effective(PROGRAM, base, changes)
    step = float(re.search(r"time step ([0-9.e+-]+) s;", said("check", base, changes))[1])
    fall = math.sqrt(2.0 * values["layers"]["thickness"] / values["jamming"]["gravity"])
    spheres = statistics.fmean(float(pack["spheres"]) for pack in packs)
    taken = statistics.fmean(float(pack["particle_steps"]) for pack in packs) / spheres
    foretold = estimate["particle_steps"] / estimate["particles"]["value"]
    final = taken - (foretold - estimate["relaxation_steps"])
    return f"| {name} | {setting} | {final * step / fall:.1f} | {foretold / taken:.2f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--settings", nargs="+", choices=("draft", "balanced", "reference"), default=("draft", "balanced"))
    options = parser.parse_args()
    base = measuring.bare_scene("quickstart", measuring.ROOT / "results/final_stage")
    rows = presets.read_rows(measuring.ROOT / "doc/data/presets.csv")
    print("| scene | preset | final stage, falls | particle-steps, foretold over taken |\n|---|---|---|---|")
    for setting in options.settings:
        for name in presets.SCENES:
            packs = [pack for pack in rows if pack["scene"] == name and pack["setting"] == setting and pack["spheres"]]
            print(row(base, name, setting, packs))


if __name__ == "__main__":
    main()
