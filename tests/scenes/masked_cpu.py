#!/usr/bin/env python3
"""The same bits on a CPU without FMA and AVX2: packs, summaries, analyses and series of a few scenes.

usage: masked_cpu.py FOLDER -- packmpi

The C library picks its code for sin, exp, pow ... by CPU, and glibc can be told to take this one for an older one; so can the kernel
(PACKMPI_ARCH). What depends on clocks and names the machine is left out of the comparison. Exit code 77: the mask changes nothing here.
"""
import json
import os
import subprocess
import sys
from pathlib import Path

from run import Run, HERE, with_arguments

MASK = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX2,-AVX,-FMA,-FMA4", "PACKMPI_ARCH": "x86-64"}
# Areas of discs; powers that are no halves; the mean of a Gaussian; softness, window and analysis of graded spheres; friction with memory.
SCENES = ["equal_2d", "near_field_2d", "gaussian", "window", "draft"]
CLOCKED = {"costs", "seal"}   # the seal is of a file with the wall clock in it
CLOCKED_PROVENANCE = {"wall_seconds", "particle_steps_per_second", "architecture"}
PROBE = "import math; print(sum(hash(math.pow(1.0 + k / 7, 2.7)) + hash(math.exp(k / 7000)) for k in range(200000)))"


def masked(mask: dict) -> dict:
    return {**os.environ, **mask}


def probe(mask: dict) -> str:
    return subprocess.run([sys.executable, "-c", PROBE], env=masked(mask), check=True, capture_output=True, text=True).stdout


def left(run: Run) -> dict:
    """What a run left that must be the same everywhere, by name."""
    stem = run.pack.with_suffix("")
    summary = json.loads(stem.with_suffix(".json").read_text())
    analysis = json.loads(stem.with_suffix(".analysis.json").read_text())
    for key in CLOCKED:
        del summary[key]
    for key in CLOCKED_PROVENANCE:
        del summary["provenance"][key]
    return {"digest": run.digest(), "code": run.code, "series": stem.with_suffix(".steps.csv").read_text(),
            "analysis": {key: value for key, value in analysis.items() if key not in CLOCKED},
            **{f"summary, {key}": value for key, value in summary.items()}}


def main() -> int:
    if len(sys.argv) < 4 or sys.argv[2] != "--":
        sys.exit(__doc__)
    folder, command = Path(sys.argv[1]), sys.argv[3:]
    if probe({}) == probe(MASK):
        print("the mask changes nothing: a C library that is not glibc, or a CPU without FMA")
        return 77
    failures = 0
    for name in SCENES:
        scene = HERE / f"{name}.toml"
        text = scene.read_text() + "[output]\nanalysis = true\n"
        runs = [left(Run(scene, text, folder / part / name, ["env", *(f"{k}={v}" for k, v in mask.items()), *command], with_arguments(scene)))
                for part, mask in (("here", {}), ("masked", MASK))]
        for what in runs[0]:
            if runs[0][what] != runs[1][what]:
                failures += 1
                print(f"{name}: {what} differs: {str(runs[0][what])[:300]} and {str(runs[1][what])[:300]}", flush=True)
    print(f"{len(SCENES)} scenes with and without FMA and AVX2, {failures} differences")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
