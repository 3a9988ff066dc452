#!/usr/bin/python3
"""packmpi and LAMMPS on the same scenes, in turn, in the same minutes, on one core each.

  scripts/compare.py [--runs 3] [--beds 107000 964000] [--brick] [--doc doc/performance.md]

Beds: a settled bed of the paper's spheres (rotation on, time step 1e-4 s), written by tests/bench/bed_bench.cpp; both codes
advance the same particles; particle-steps a second, everything in. Brick (--brick): example 5.3 from nothing to the last
layer, wall time and the density that came out. Needs scripts/build.sh all and the Debian package lammps
(scripts/setup.sh --peers). The tables replace the part of the document between its "compare" markers.
"""
import argparse
import datetime
import json
import os
import platform
import re
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LAMMPS = ROOT / "scripts/peers/lammps"
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_hwloc_base_binding_policy="none", OMPI_MCA_btl_vader_single_copy_mechanism="none")
BEGIN, END = "<!-- compare: begin -->", "<!-- compare: end -->"


def run(words, folder):
    """stdout of a command; its wall time [s]."""
    start = time.time()
    done = subprocess.run([str(w) for w in words], cwd=folder, env=ENVIRONMENT, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    if done.returncode not in (0, 3):   # 3: a pack below the asked height, which twelve layers may be
        raise SystemExit(f"{' '.join(map(str, words))}\n{done.stdout}\nended with {done.returncode}")
    return done.stdout, time.time() - start


def lammps_rates(text, atoms):
    """Particle-steps a second of each 'Loop time' but the first, which is the warm-up."""
    loops = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms", text)
    assert all(int(n) == atoms for _, _, n in loops), loops
    return [int(steps) * atoms / float(seconds) for seconds, steps, _ in loops[1:]]


def bed(program, particles, runs, folder):
    """One row: particles, our rates, LAMMPS' rates (three of each a run), and the ratios run by run."""
    ours, theirs, ratios, bytes_each = [], [], [], 0
    steps = 300 if particles < 500000 else 100
    for _ in range(runs):
        data = Path(folder) / "bed.data"
        text, _ = run([program, particles, steps, 3, 1, 0, data], folder)
        mine = float(re.search(r"median (\S+)e6", text)[1]) * 1e6
        atoms = int(re.search(r"(\d+) particles on", text)[1])
        bytes_each = int(re.search(r"(\d+) bytes a particle", text)[1])
        side = float(re.search(r"-0.005 (\S+) xlo xhi", data.read_text()[:400])[1]) - 0.005
        text, _ = run(["lmp", "-in", LAMMPS / "bed.in", "-var", "data", data, "-var", "S", side, "-var", "n", steps,
                       "-var", "warm", steps, "-log", "none"], folder)
        rates = lammps_rates(text, atoms)
        ours.append(mine)
        theirs.append(statistics.median(rates))
        ratios.append(ours[-1] / theirs[-1])
    return {"what": f"bed of {atoms:,}", "ours": ours, "theirs": theirs, "ratios": ratios, "bytes": bytes_each}


def brick_density(dump, height=0.5, radius=0.02):
    """phi between 0.2 and 0.8 H_d of a LAMMPS dump of equal spheres in the unit square, with exact caps."""
    lines = Path(dump).read_text().split("ITEM: ATOMS")[1].split("\n")[1:]
    z = [float(line.split()[-1]) for line in lines if line.strip()]

    def below(level):
        volume = 0.0
        for centre in z:
            h = min(max(level - centre + radius, 0.0), 2 * radius)
            volume += 3.141592653589793 * h * h * (3 * radius - h) / 3
        return volume
    return (below(0.8 * height) - below(0.2 * height)) / (0.6 * height), len(z)


def brick(program, runs, folder):
    """Example 5.3, whole job, seeds 1 .. runs; both make twelve layers."""
    rows = []
    for seed in range(1, runs + 1):
        _, mine = run([program, ROOT / "input/paper_5_3.toml", "-q", "--seed", seed, "--set", "layers.maximum=12",
                       "-o", f"ours{seed}"], folder)
        got = json.loads((Path(folder) / f"ours{seed}/paper_5_3.json").read_text())["got"]
        _, other = run(["lmp", "-in", LAMMPS / "brick.in", "-var", "mol", LAMMPS / "sphere.mol", "-var", "tag", f"s{seed}",
                        "-var", "seed", seed, "-var", "skin", 0.0025, "-var", "maxlay", 12, "-var", "hmax", 0.6, "-log", "none", "-screen", "none"],
                       folder)
        phi, count = brick_density(Path(folder) / f"brick_s{seed}.dump")
        rows.append({"seed": seed, "ours": mine, "theirs": other, "phi_ours": got["phi_bulk"], "phi_theirs": phi,
                     "n_ours": got["particles"], "n_theirs": count})
    return rows


def spread(values, scale=1.0, digits=1):
    values = sorted(v * scale for v in values)
    return f"{statistics.median(values):.{digits}f} ({values[0]:.{digits}f} to {values[-1]:.{digits}f})"


def report(beds, bricks, runs):
    commit = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], text=True, capture_output=True).stdout.strip()
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.machine())
    lmp = re.search(r"LAMMPS \(([^)]*)\)|- (\d+ \w+ \d+)", subprocess.run(["lmp", "-h"], text=True, capture_output=True).stdout)
    version = next(filter(None, lmp.groups())) if lmp else "unknown"
    out = [f"Made by `scripts/compare.py` on {datetime.date.today()}, commit {commit}, {cpu}, one core a run, {runs} runs of each in turn. "
           f"LAMMPS {version} of Debian 12: Hertz contacts, tsuji damping, sliding friction, rotation; no history. "
           "Median (least to most); ratios are taken run by run.", "",
           "| settled bed | packmpi, 1e6 particle-steps/s | LAMMPS | ratio | bytes a particle |", "|---|---|---|---|---|"]
    for row in beds:
        out.append(f"| {row['what']} | {spread(row['ours'], 1e-6)} | {spread(row['theirs'], 1e-6)} | "
                   f"{spread(row['ratios'], 1.0, 2)} | {row['bytes']} |")
    if bricks:
        out += ["", "| example 5.3, whole job | packmpi, s | LAMMPS, s | ratio | phi_bulk, packmpi | LAMMPS | spheres |",
                "|---|---|---|---|---|---|---|"]
        for row in bricks:
            out.append(f"| seed {row['seed']} | {row['ours']:.1f} | {row['theirs']:.1f} | {row['theirs'] / row['ours']:.2f} | "
                       f"{row['phi_ours']:.4f} | {row['phi_theirs']:.4f} | {row['n_ours']}, {row['n_theirs']} |")
    return "\n".join(out)


def write(doc, text):
    doc = Path(doc)
    old = doc.read_text() if doc.exists() else f"# Performance\n\n## Against LAMMPS\n\n{BEGIN}\n{END}\n"
    head, rest = old.split(BEGIN)
    doc.write_text(f"{head}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--beds", type=int, nargs="*", default=[107000, 964000])
    parser.add_argument("--brick", action="store_true")
    parser.add_argument("--build", default=ROOT / "build")
    parser.add_argument("--doc", default=ROOT / "doc/performance.md")
    options = parser.parse_args()
    build = Path(options.build).resolve()
    with tempfile.TemporaryDirectory() as folder:
        beds = [bed(build / "tests/bench/bed_bench", n, options.runs, folder) for n in options.beds]
        bricks = brick(build / "packmpi", options.runs, folder) if options.brick else []
    text = report(beds, bricks, options.runs)
    write(options.doc, text)
    print(text)


if __name__ == "__main__":
    main()
